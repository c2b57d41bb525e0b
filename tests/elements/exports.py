#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The installed library exports exactly what its headers declare: no C++, no helpers, nothing forgotten."""
import pathlib
import re
import shutil
import subprocess
import sys

library, headers = sys.argv[1], sys.argv[2:]
if not shutil.which("nm"):
    print("skipped: no nm (package binutils)")
    sys.exit(77)
symbols = subprocess.run(["nm", "-D", "--defined-only", library], check=True, capture_output=True, text=True).stdout
exported = {line.split()[-1] for line in symbols.splitlines()}
declared = set()
for header in headers:
    code = re.sub(r"/\*.*?\*/", "", pathlib.Path(header).read_text("utf-8"), flags=re.S)
    code = re.sub(r"#define(.*\\\n)*.*", "", code)
    declared |= set(re.findall(r"CERBERUS_API\s[^;]*?\b(cerberus_\w+)\s*\(", code))
    for kind, name in re.findall(r"^CERBERUS_DECLARE_(\w+)\(\w+,\s*(\w+)\)", code, flags=re.M):
        functions = {"BOXED": "X_get_type X_init X_new X_copy X_free", "ENUM": "X_get_type X_get_nick",
                     "META": "buffer_set_X buffer_get_X buffer_peek_X X_meta_api_get_type",
                     "MESSAGE": "message_new_X message_is_X message_parse_X",
                     "EVENT": "event_new_X event_is_X event_parse_X"}[kind]
        short = name.removeprefix("cerberus_")
        declared |= {"cerberus_" + function.replace("X", short) for function in functions.split()}
for name in sorted(exported - declared):
    print(f"exported but not declared: {name}")
for name in sorted(declared - exported):
    print(f"declared but not exported: {name}")
print(f"{len(declared)} functions declared, {len(exported)} symbols exported")
sys.exit(0 if declared and exported == declared else 1)
