#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A network camera whose decoder is too slow gives pictures of now: what is late is left out up to the next keyframe.
Arguments: cerberusd, and the library that makes libavcodec slow. The camera is another one of the same robot."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

from mqtt_client import free_port
from page_client import PATIENCE, Page, Socket

CONFIGURATION = '''
state-folder = "state"
[page]
port = PAGE
[rtsp]
port = STREAM
[[camera]]
name = "yard"
kind = "test"
width = 160
height = 120
framerate = 25
[[camera]]
name = "gate"
kind = "rtsp"
uri = "rtsp://127.0.0.1:STREAM/yard/plain"
'''
WATCHED = 12  # seconds; a delay that grows by two thirds of the time would be 8 s then
MOST = 3500   # ms: .5 s and 1 s of patience, in which it grows by .7 s; the rest is the machine's


def wait_for_log(path, pattern):
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if found := re.search(pattern, path.read_text(errors='replace')):
            return found
        time.sleep(.1)
    raise AssertionError(f'{pattern} is not in {path.read_text()[-3000:]}')


def reports(line):
    """Those of the camera, as often as the page sends them."""
    while True:
        message = line.receive()
        if isinstance(message, tuple):
            line.send(f'ack {message[0]}')
        elif 'number' in message:
            line.send(f'seen {message["number"]}')
            yield next(one for one in message['cameras'] if one['name'] == 'gate')


def main():
    with tempfile.TemporaryDirectory() as name:
        folder, page = pathlib.Path(name), Page(free_port())
        log = folder / 'log'
        (folder / 'robot.toml').write_text(
            CONFIGURATION.replace('PAGE', str(page.port)).replace('STREAM', str(free_port())))
        with open(log, 'w', encoding='utf-8') as to:
            process = subprocess.Popen([sys.argv[1], folder / 'robot.toml'], stdout=to, stderr=to,
                                       env=os.environ | {'LD_PRELOAD': sys.argv[2]})
        try:
            assert page.log_in('owner', wait_for_log(log, r'One-time password .*: ([0-9a-f]{16})')[1]) == 200
            assert page.ask('POST', '/password', {'user': 'owner', 'password': 'long enough'})[0] == 200
            wait_for_log(log, r'gate: \d+ frames were dropped that came late')
            ages, rates, end = [], [], time.monotonic() + WATCHED
            for report in reports(Socket(page)):
                ages.append(report['latency'])
                rates.append(report['rate'])
                if time.monotonic() > end:
                    break
            assert max(ages) < MOST and sum(rates) / len(rates) > 1, (ages, rates)
        except BaseException:
            print(log.read_text(errors='replace')[-5000:], file=sys.stderr)
            raise
        finally:
            process.kill()


main()
