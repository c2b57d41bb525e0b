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
    declared |= set(re.findall(r"CERBERUS_API\s[^;]*?\b(cerberus_\w+)\s*\(", code))
    for kind, prefix in re.findall(r"CERBERUS_DECLARE_(\w+)\(\w+,\s*(cerberus_\w+)\)", code):
        functions = {"BOXED": "get_type init new copy free", "ENUM": "get_type get_nick"}[kind].split()
        declared |= {f"{prefix}_{function}" for function in functions}
for name in sorted(exported - declared):
    print(f"exported but not declared: {name}")
for name in sorted(declared - exported):
    print(f"declared but not exported: {name}")
print(f"{len(declared)} functions declared, {len(exported)} symbols exported")
sys.exit(0 if declared and exported == declared else 1)
