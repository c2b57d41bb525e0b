#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Installs into a folder and uses it as others would: pkg-config, a C program, Python, nothing of the build folder."""
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

build, meson, source, introspection = sys.argv[1:5]
PYTHON = "/usr/bin/python3"


def run(*command, **environment):
    done = subprocess.run(command, env={**os.environ, **environment}, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{shlex.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def only(root, pattern):
    found = sorted(root.rglob(pattern))
    if len(found) != 1:
        sys.exit(f"{pattern} was installed {len(found)} times")
    return found[0]


for tool in ("pkg-config", "cc", shlex.split(meson)[0]):
    if not shutil.which(tool):
        print(f"skipped: no {tool}")
        sys.exit(77)

with tempfile.TemporaryDirectory() as folder:
    root = pathlib.Path(folder)
    run(*shlex.split(meson), "install", "-C", build, "--no-rebuild", "--quiet", "--destdir", folder)
    description = only(root, "cerberus-1.0.pc")
    library = only(root, "libcerberus-1.0.so")
    # The description names the prefix of the real installation; here it lies below `folder`.
    text = description.read_text()
    prefix = next(line.split("=", 1)[1] for line in text.splitlines() if line.startswith("prefix="))
    description.write_text(text.replace(f"prefix={prefix}", f"prefix={folder}{prefix}", 1))
    found = {"PKG_CONFIG_PATH": f"{description.parent}:{os.environ.get('PKG_CONFIG_PATH', '')}"}
    needed = run("pkg-config", "--print-requires", "--print-requires-private", "cerberus-1.0", **found).split()
    if {word for word in needed if word[0].isalpha()} != {"gstreamer-1.0", "gstreamer-video-1.0"}:
        sys.exit(f"the package needs {needed}")
    program = root / "program"
    run("cc", "-o", program, source, *run("pkg-config", "--cflags", "--libs", "cerberus-1.0", **found).split())
    here = {"LD_LIBRARY_PATH": str(library.parent)}
    run(program, **here)
    if introspection == "introspection" and pathlib.Path(PYTHON).exists():
        here["GI_TYPELIB_PATH"] = str(only(root, "Cerberus-1.0.typelib").parent)
        run(PYTHON, "-c", "import gi; gi.require_version('Cerberus', '1.0'); from gi.repository import Cerberus, Gst; "
            "Gst.init(None); assert not Cerberus.buffer_get_regions(Gst.Buffer())", **here)
        only(root, "Cerberus-1.0.gir")
