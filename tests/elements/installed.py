#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The library as other programs use it: installed into a folder, and uninstalled, straight from the build folder.

Both by pkg-config from a C program, and from Python; the installed one needs nothing of the build folder.
"""
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


def use(description, library, program, typelib):
    """A C program and a Python one, by the pkg-config file, the library and the typelib of these folders."""
    flags = run("pkg-config", "--cflags", "--libs", "cerberus-1.0", **description).split()
    run("cc", "-o", program, source, *flags)
    here = {"LD_LIBRARY_PATH": str(library)}
    run(program, **here)
    if typelib and pathlib.Path(PYTHON).exists():
        run(PYTHON, "-c", "import gi; gi.require_version('Cerberus', '1.0'); from gi.repository import Cerberus, Gst; "
            "Gst.init(None); assert not Cerberus.buffer_get_regions(Gst.Buffer())", GI_TYPELIB_PATH=str(typelib), **here)


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
    optional = {"gstreamer-analytics-1.0"}  # where GStreamer has it
    if {word for word in needed if word[0].isalpha()} - optional != {"gstreamer-1.0", "gstreamer-video-1.0"}:
        sys.exit(f"the package needs {needed}")
    use(found, library.parent, root / "program",
        only(root, "Cerberus-1.0.typelib").parent if introspection == "introspection" else None)
    if introspection == "introspection":
        only(root, "Cerberus-1.0.gir")
    here = pathlib.Path(build)
    use({"PKG_CONFIG_PATH": str(here / "meson-uninstalled")}, here / "gst", root / "uninstalled",
        here / "gst" if introspection == "introspection" else None)
