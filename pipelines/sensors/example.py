#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""PIR sensors in any language: a sender for `pirsrc driver=external command="python3 pipelines/sensors/example.py"`.

It writes the line protocol (docs/manual/sensor-protocol.md) and pretends that somebody walks round the robot once in
twelve seconds: each of three sensors sees 120 degrees. Replace sees() by calls to your hardware.
"""
import select
import sys
import time

SENSORS = 3
TURN = 12.0  # seconds of a walk round the robot
LOOK = 0.02  # seconds from one look at the sensors to the next
HEARTBEAT = 1.0  # seconds after which the levels are repeated, so that they count as known


def sees(seconds):
    """The levels of all sensors, ahead, left and right, as a list of 0 and 1."""
    bearing = seconds / TURN * 360 % 360  # of the walker, clockwise from straight ahead
    middles = 0, 240, 120
    return [int(abs((bearing - middle + 180) % 360 - 180) <= 60) for middle in middles]


def run():
    print('cerberus-pir 1', SENSORS, flush=True)
    begin, said, last = time.monotonic(), -HEARTBEAT, None
    while True:
        now = time.monotonic() - begin
        levels = sees(now)
        if levels != last or now - said >= HEARTBEAT:
            print('levels', *levels, flush=True)
            said, last = now, levels
        # The pipeline sends nothing; the end of the input is its end.
        if select.select([sys.stdin], [], [], LOOK)[0] and not sys.stdin.readline():
            return


try:
    run()
except BrokenPipeError:
    sys.stderr.close()  # the pipeline has ended: no complaint at the exit
