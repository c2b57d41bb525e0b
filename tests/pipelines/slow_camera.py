#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A camera whose controls keep their caller waiting: cerberus-head answers all the same, names a camera that hangs, and sends
it the stop before anything else when it goes on.

    slow_camera.py CERBERUS-HEAD SLOW-CAMERA     (the library of tests/support/slow_camera.cpp)
"""
import os
import pathlib
import socket
import subprocess
import sys
import tempfile

from support import LIMIT

HELPER, CAMERA = map(os.path.abspath, sys.argv[1:3])
OPTIONS = os.environ.get('ASAN_OPTIONS', '')


class Helper:
    def __init__(self, speeds):
        self.near, far = socket.socketpair()
        self.near.settimeout(LIMIT)
        self.lines = self.near.makefile('r')
        self.process = subprocess.Popen(
            [HELPER, 'v4l2', 'device=/dev/video-slow', 'mode=speed', 'pan-speed=60', 'tilt-speed=60'], stdin=far, stdout=far,
            env={**os.environ, 'LD_PRELOAD': CAMERA, 'CERBERUS_SLOW_CAMERA': str(speeds),
                 'ASAN_OPTIONS': OPTIONS + ':verify_asan_link_order=0'})
        far.close()
        self.send('cerberus-head 1 timeout 10 limits -170 170 -90 90 speed 60 60 acceleration 60 60 start 0 0')
        self.until('ready')

    def send(self, line):
        self.near.sendall(f'{line}\n'.encode())

    def until(self, word):
        """The first line that begins with a word; the lines before it are dropped."""
        for line in self.lines:
            if line.startswith(word):
                return line.strip()
        raise AssertionError(f'no {word}: the helper ended')


def main():
    with tempfile.TemporaryDirectory() as folder:
        speeds, wait = pathlib.Path(folder, 'speeds'), pathlib.Path(folder, 'speeds.wait')

        def given():
            return [int(line) for line in speeds.read_text().split()]

        helper = Helper(speeds)
        before = len(given())
        wait.touch()
        helper.send('move at 30 hold')
        while len(given()) == before:
            helper.send('alive')
            helper.until('alive')
        for _ in range(10):  # it waits for the camera
            helper.send('alive')
            helper.until('alive')
        fault = helper.until('fault')
        assert fault.startswith('fault the camera /dev/video-slow does not answer'), fault
        for line in ['stop', 'move at 20 hold', 'move at 10 hold', 'alive']:
            helper.send(line)
        helper.until('alive')
        assert given()[before:] == [30], given()
        wait.unlink()
        helper.until('recovered')
        assert given()[before:] == [30, 0, 10], given()
        helper.near.shutdown(socket.SHUT_WR)
        assert helper.process.wait(LIMIT) == 0
        assert given()[-1] == 0, given()


main()
