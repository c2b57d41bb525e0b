#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""cerberusd turns the robot's base as its head asks (base-turn): what the base's program is given while a target is beyond the
head's limits, and that it is stopped at the end. By default nothing is asked for. The target is the ball of the test picture."""
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

PATIENCE = 100  # seconds for what takes one on an idle machine
CERBERUSD = sys.argv[1]
CONFIGURATION = '''
state-folder = "state"
[page]
enabled = false
[base]
command = "sh -c 'cat >> FOLDER/drive'"
max-yaw-rate = 8
[[camera]]
name = "front"
kind = "test"
width = 160
height = 120
framerate = 25
[camera.head]
driver = "simulated"
pan-min = -4
pan-max = 4
'''


def wait_until(condition, what, process):
    end = time.monotonic() + PATIENCE
    while not (result := condition()):
        assert time.monotonic() < end, f'{what} did not happen'
        assert process.poll() is None, 'cerberusd ended'
        time.sleep(.02)
    return result


def run(folder, head, look):
    drive = folder / 'drive'
    drive.write_text('')
    (folder / 'robot.toml').write_text(CONFIGURATION.replace('FOLDER', str(folder)) + head)
    process = subprocess.Popen([CERBERUSD, folder / 'robot.toml'], env=os.environ | {'LC_ALL': 'C'})
    try:
        look(lambda: drive.read_text().splitlines(), process)
        process.send_signal(signal.SIGTERM)
        process.wait(PATIENCE)
    finally:
        process.kill()
    return drive.read_text().splitlines()


def asks(lines, process):
    wait_until(lambda: any(line.startswith('drive 0 ') for line in lines()), 'a request', process)
    wait_until(lambda: 'stop' in lines(), 'the end of a request', process)


def asks_nothing(lines, process):
    """As long as the first request took in the other run, and more."""
    time.sleep(5)
    assert lines() == [], lines()


with tempfile.TemporaryDirectory() as name:
    where = pathlib.Path(name)
    given = run(where, 'base-turn = 30\n', asks)
    rates = [float(re.fullmatch(r'drive 0 (-?[0-9.]+)', line)[1]) for line in given if line != 'stop']
    assert rates and all(1 <= abs(rate) <= 8 for rate in rates), given  # max-yaw-rate
    assert given[-1] == 'stop', given
    assert set(run(where, '', asks_nothing)) <= {'stop'}  # of the end
