#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A program that runs in a German locale writes 0,5 where C writes 0.5. The JSON lines must not notice."""
import json
import locale
import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / 'pipelines'))
from support import LIMIT, ball  # noqa: E402

LINE = f'gst-launch-1.0 -q {ball(frames=40)} ! motiondetect horizontal-fov=60 preset=traffic ! motionjson ! filesink'


def lines(name, **environment):
    subprocess.run([*LINE.split(), f'location={name}'], check=True, timeout=LIMIT, env={**os.environ, **environment})
    return pathlib.Path(name).read_bytes()


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    made = subprocess.run(['localedef', '-i', 'de_DE', '-f', 'UTF-8', './de_DE.UTF-8'], capture_output=True, text=True)
    if not pathlib.Path('de_DE.UTF-8/LC_NUMERIC').exists():
        print('no German locale can be made (package locales):', made.stderr.strip())
        sys.exit(77)
    os.environ['LOCPATH'] = folder
    locale.setlocale(locale.LC_NUMERIC, 'de_DE.UTF-8')
    assert locale.localeconv()['decimal_point'] == ',', 'the locale does not work, so this would prove nothing'
    here = lines('c.jsonl', LC_ALL='C')
    there = lines('de.jsonl', LC_ALL='de_DE.UTF-8', LANG='de_DE.UTF-8', LANGUAGE='de')
    parsed = [json.loads(line) for line in here.splitlines()]
    numbers = [value for line in parsed for thing in line['objects'] for value in thing.values()]
    assert any(isinstance(value, float) and value % 1 for value in numbers), 'no number with a fraction to compare'
    assert here == there, 'the German lines differ'
    os.chdir('/')
