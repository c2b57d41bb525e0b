#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Every program that is installed says its version, which is meson's: versions.py VERSION PROGRAM ..."""
import pathlib
import subprocess
import sys

for program in sys.argv[2:]:
    done = subprocess.run([program, '--version'], capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=60, check=False)
    assert (done.returncode, done.stdout) == (0, f'{pathlib.Path(program).name} {sys.argv[1]}\n'), (program, done)
