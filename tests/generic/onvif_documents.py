#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What onvifmeta writes in a loop of camera, sensors and head is valid by the published schema. CERBERUS_ALL=1 looks at
every document, and at those of a whole run of pipelines/demo where its video is (CERBERUS_DATA); else at some."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / 'tests/pipelines'))
from support import LIMIT, ball  # noqa: E402

ONVIF = pathlib.Path(os.environ.get('CERBERUS_ONVIF', TOP.parent / 'shared' / 'onvif'))
FRAMES = 60
LINE = (f'gst-launch-1.0 -q {ball(frames=FRAMES)} ! virtualptz wide-fov=60 horizontal-fov=30 width=160 height=120 ! '
        'motiondetect confirm-time=0 horizontal-fov=30 ! pirfusion name=fusion horizontal-fov=30 ! tee name=t '
        'pirsrc driver=scripted script="0,0,0,0;0.5,0,1,2;60,0,0,0" bearings=0,-20,20 field-of-view=20 ! fusion.pir_0 '
        't. ! queue ! onvifmeta horizontal-fov=30 ! multifilesink location=%04d.xml '
        't. ! queue ! pantiltsink driver=simulated horizontal-fov=30')


def demo_line(video):
    """The demo's line, and onvifmeta behind its tee."""
    start = re.search(r'start="(start-pan=[^"]+)"', (TOP / 'pipelines' / 'demo').read_text('utf-8'))[1]
    line = subprocess.run([TOP / 'pipelines' / 'run', '--print', 'closed-loop', f'FILE={video}', f'START={start}',
                           f'PIR={TOP}/pipelines/closed-loop.csv', 'MP4=demo.mp4', 'JSON=demo.jsonl'],
                          capture_output=True, text=True, check=True).stdout.rstrip()
    view = re.search(r'^# VIEW=(\S+)', (TOP / 'pipelines' / 'closed-loop.launch').read_text('utf-8'), re.M)[1]
    return f'{line} t. ! queue ! onvifmeta horizontal-fov={view} ! multifilesink location=%04d.xml'


WORDS = ('<tt:Object ObjectId', '<tt:PTZStatus>', '<tt:FieldOfView', '<tt:SensorData')


def documents_of(line, folder, *more):
    """The documents that a line writes, which have these words among them."""
    subprocess.run(['/bin/sh', '-c', line], cwd=folder, check=True, timeout=10 * LIMIT, stdout=subprocess.DEVNULL)
    documents = sorted(pathlib.Path(folder).glob('*.xml'))
    text = ''.join(document.read_text('utf-8') for document in documents)
    for word in (*WORDS, *more):
        assert word in text, f'no document has {word}'
    return documents


def check_demo():
    data = pathlib.Path(os.environ.get('CERBERUS_DATA', TOP.parent / 'shared' / 'data'))
    video = data / 'pets09_s2l1_view1' / 'vtest.avi'
    if not video.exists():
        print(f'skipped: the demo, as {video} is missing')
        return
    with tempfile.TemporaryDirectory() as folder:
        documents = documents_of(demo_line(video), folder)
        lines = (pathlib.Path(folder) / 'demo.jsonl').read_text('utf-8').splitlines()
        assert len(documents) == len(lines), f'{len(documents)} documents of {len(lines)} frames'
        result = validate(documents)
        assert result.returncode == 0, result.stderr
    print(f'{len(documents)} documents of the demo are valid')


def validate(files):
    return subprocess.run([ONVIF / 'validate', *files], capture_output=True, text=True, check=False)


def main():
    if not (ONVIF / 'validate').exists() or not shutil.which('xmllint'):
        print(f'skipped: no schemas in {ONVIF} (CERBERUS_ONVIF names their folder), or no xmllint')
        return 77
    with tempfile.TemporaryDirectory() as name:
        documents = documents_of(LINE, name, '<tt:Speed>')
        assert len(documents) == FRAMES, f'{len(documents)} documents of {FRAMES} frames'
        chosen = documents if os.environ.get('CERBERUS_ALL') else documents[::6]
        result = validate(chosen)
        assert result.returncode == 0, result.stderr
        # The schema refuses something at all.
        wrong = pathlib.Path(name) / 'wrong.xml'
        wrong.write_text(documents[-1].read_text('utf-8').replace('tt:PTZStatus', 'tt:PtzStatus'), 'utf-8')
        assert validate([wrong]).returncode != 0, 'the schema takes an unknown element'
    print(f'{len(chosen)} documents are valid')
    if os.environ.get('CERBERUS_ALL'):
        check_demo()
    return 0


sys.exit(main())
