#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What onvifmeta writes in a loop of camera, sensors and head is valid by the published schema. CERBERUS_ALL=1 looks at
every document, else at some."""
import os
import pathlib
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


def validate(files):
    return subprocess.run([ONVIF / 'validate', *files], capture_output=True, text=True, check=False)


def main():
    if not (ONVIF / 'validate').exists() or not shutil.which('xmllint'):
        print(f'skipped: no schemas in {ONVIF} (CERBERUS_ONVIF names their folder), or no xmllint')
        return 77
    with tempfile.TemporaryDirectory() as name:
        subprocess.run(['/bin/sh', '-c', LINE], cwd=name, check=True, timeout=LIMIT)
        documents = sorted(pathlib.Path(name).glob('*.xml'))
        text = ''.join(document.read_text('utf-8') for document in documents)
        assert len(documents) == FRAMES, f'{len(documents)} documents of {FRAMES} frames'
        for word in ('<tt:Object ObjectId', '<tt:PTZStatus>', '<tt:FieldOfView', '<tt:SensorData', '<tt:Speed>'):
            assert word in text, f'no document has {word}'
        chosen = documents if os.environ.get('CERBERUS_ALL') else documents[::6]
        result = validate(chosen)
        assert result.returncode == 0, result.stderr
        # The schema refuses something at all.
        wrong = pathlib.Path(name) / 'wrong.xml'
        wrong.write_text(documents[-1].read_text('utf-8').replace('tt:PTZStatus', 'tt:PtzStatus'), 'utf-8')
        assert validate([wrong]).returncode != 0, 'the schema takes an unknown element'
    print(f'{len(chosen)} documents are valid')
    return 0


sys.exit(main())
