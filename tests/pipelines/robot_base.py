#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""cerberusd turns the robot's base as its head asks (base-turn): what the base's program is given while a target is beyond the
head's limits, and that it is stopped at the end. By default nothing is asked for. The target is the ball of the test picture.
While the base drives, its PIR sensors know of it."""
import os
import pathlib
import re
import socket
import signal
import subprocess
import sys
import tempfile
import time

from page_client import Page, Socket

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


DRIVEN = '''
state-folder = "state"
[page]
port = PORT
[base]
command = "sh -c 'cat >> FOLDER/drive'"
max-speed = 0.5
[[camera]]
name = "front"
kind = "test"
width = 160
height = 120
framerate = 10
[camera.detection]
minimum-area = 10000
[camera.fusion]
return-delay = 0
[camera.sensors]
driver = "external"
bearings = "90"
command = "while sleep .3; do echo cerberus-pir 1 1; echo levels 1; done"
[camera.head]
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


def decides(line, rule, order=None):
    """Until the decision is of this rule; the order is repeated meanwhile. Nothing is seen, and the sensor detects all the time."""
    end, found = time.monotonic() + PATIENCE, None
    while found != rule:
        assert time.monotonic() < end, f'{found}, not {rule}'
        if order:
            line.send(order)
        message = line.receive()
        if isinstance(message, tuple):
            line.send(f'ack {message[0]}')
            found = message[1].get('fusion', {}).get('name') if message[1] else None
        elif message and 'number' in message:
            line.send(f'seen {message["number"]}')


def drives(folder):
    """A sensor that detects is followed while the base stands. After three seconds of driving its own motion may hold it."""
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        port = probe.getsockname()[1]
    (folder / 'robot.toml').write_text(DRIVEN.replace('FOLDER', str(folder)).replace('PORT', str(port)))
    log = folder / 'log'
    with open(log, 'w', encoding='utf-8') as out:
        process = subprocess.Popen([CERBERUSD, folder / 'robot.toml'], env=os.environ | {'LC_ALL': 'C'}, stdout=out,
                                   stderr=subprocess.STDOUT)
    try:
        one_time = wait_until(lambda: re.search(r'One-time password .*: ([0-9a-f]{16})\n', log.read_text()),
                              'the one-time password', process)[1]
        page = Page(port)
        assert page.log_in('owner', one_time) == 200
        assert page.ask('POST', '/password', {'user': 'owner', 'password': 'long enough'})[0] == 200
        line = Socket(page)
        decides(line, 'sector')
        decides(line, 'doubt', 'drive 1 0')
        decides(line, 'sector')  # it stands again
        line.close()
        process.send_signal(signal.SIGTERM)
        process.wait(PATIENCE)
    except BaseException:
        print(log.read_text(), file=sys.stderr)
        raise
    finally:
        process.kill()


with tempfile.TemporaryDirectory() as name:
    where = pathlib.Path(name)
    given = run(where, 'base-turn = 30\n', asks)
    rates = [float(re.fullmatch(r'drive 0 (-?[0-9.]+)', line)[1]) for line in given if line != 'stop']
    assert rates and all(1 <= abs(rate) <= 8 for rate in rates), given  # max-yaw-rate
    assert given[-1] == 'stop', given
    assert set(run(where, '', asks_nothing)) <= {'stop'}  # of the end
with tempfile.TemporaryDirectory() as name:
    drives(pathlib.Path(name))
