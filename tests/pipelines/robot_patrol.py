#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The shipped patrol.toml: its robot starts without any hardware or file, patrols in real time, and its page shows the picture
with the floor plan, the sensors for the radar, the head and the people."""
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

from page_client import PATIENCE, Page, Socket
from robot_page import free_port, wait_until
from support import TOP, all_tests, gst_launch, must

SHIPPED = (TOP / 'pipelines' / 'robot' / 'patrol.toml').read_text('utf-8')
# A person crosses 3.5 m before the robot, which stands; shorter than to wait for the patrol to meet one.
CROSSES = '[camera.patrol]\npath = "at 4.5 8.5; wait 1"\nwalks = "at 8 7 90; go 8 11 1"\n\n[camera.persons]\nenabled = false\n\n[camera.detection]'


def watch(port, one_time, until, seconds):
    """The pictures with their facts as the page gets them, until one with these facts has come, and for so long."""
    owner = Page(port)
    assert owner.log_in('owner', one_time) == 200
    assert owner.ask('POST', '/password', {'user': 'owner', 'password': 'long enough'})[0] == 200
    line, seen, begin = Socket(owner), [], time.monotonic()
    hello = line.receive()['hello']
    while not any(until(facts) for facts, _, _ in seen) or time.monotonic() - begin < seconds:
        assert time.monotonic() - begin < PATIENCE, seen[-1:] and seen[-1][0]
        message = line.receive()
        if isinstance(message, tuple):
            line.send(f'ack {message[0]}')
            if message[1]:
                seen.append((message[1], message[2], time.monotonic()))
        elif 'number' in message:
            line.send(f'seen {message["number"]}')
    return hello['cameras'], seen


def gray(picture):
    """The rows of a JPEG of 640 x 480."""
    pathlib.Path('picture.jpg').write_bytes(picture)
    must(gst_launch('filesrc location=picture.jpg ! jpegdec ! videoconvert ! video/x-raw,format=GRAY8,width=640,height=480 ! '
                    'filesink location=picture.raw'))
    data = pathlib.Path('picture.raw').read_bytes()
    assert len(data) == 640 * 480, len(data)
    return [data[k:k + 640] for k in range(0, len(data), 640)]


def patrols(program, configuration, until, seconds=0):
    port = free_port()
    pathlib.Path('robot.toml').write_text(configuration.replace('../../demo-output/patrol', 'state') + f'[page]\nport = {port}\n')
    must((subprocess.run([program, '--check', 'robot.toml'], check=False).returncode, 'the file is refused'))
    with open('log', 'w', encoding='utf-8') as log, \
            subprocess.Popen([program, 'robot.toml'], stdout=log, stderr=subprocess.STDOUT) as process:
        try:
            one_time = wait_until('the one-time password', lambda: re.search(
                r'One-time password .*: ([0-9a-f]{16})\n', pathlib.Path('log').read_text()))[1]
            found = watch(port, one_time, until, seconds)
            process.send_signal(signal.SIGTERM)
            assert process.wait(PATIENCE) == 0, pathlib.Path('log').read_text()
            return found
        except BaseException:
            print(pathlib.Path('log').read_text(), file=sys.stderr)
            raise
        finally:
            process.kill()


def test_as_it_is_shipped(program):
    """It drives: the picture changes; the head and three sensors are there, and the plan is in the corner."""
    (camera,), seen = patrols(program, SHIPPED, lambda facts: facts.get('pose') and len(facts.get('pir', ())) == 3
                              and facts['pts'] > 2e9)
    assert camera['head'] and camera['bearings'] == '0,-120,120' and (camera['sensor-fov'], camera['sensor-range']) == (120, 12), camera
    (_, before, _), (facts, picture, _) = seen[0], seen[-1]
    assert (facts['width'], facts['height']) == (640, 480) and facts['fusion'], facts
    # 192 x 165 pixels for 16.8 x 14.4 m, 13 from the edges: what is no room is dark, the floor of the lounge is bright.
    rows = gray(picture)
    assert rows[13 + 27][435 + 165] < 60 and rows[13 + 147][435 + 91] > 180, 'there is no floor plan in the picture'
    changed = [abs(a - b) for one, other in zip(gray(before)[200:], rows[200:]) for a, b in zip(one, other)]
    # Noise and JPEG alone: 2.2; driving: 14; measured.
    assert sum(changed) > 4 * len(changed), f'the camera stands still: {sum(changed) / len(changed)} levels'


def test_the_page_shows_whom_it_finds_in_real_time(program):
    house = re.sub(r'\[camera.patrol\].*\[camera.detection\]', CROSSES, SHIPPED, flags=re.S)
    house = house.replace('640', '320').replace('480', '240')
    started = time.monotonic()
    _, seen = patrols(program, house, lambda facts: facts.get('objects') and facts['fusion']['action'] == 'track'
                      and any(facts['pir']), 3)
    # Frames of this size are made many times faster, by motion alone. What a busy machine has missed it catches up.
    last, _, end = seen[-1]
    assert last['pts'] / 1e9 < end - started, f'{last["pts"] / 1e9} s in {end - started} s'


all_tests(globals(), pathlib.Path(sys.argv[1]).resolve())
