#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A pan-tilt head in any language: a helper for `pantiltsink driver=external command="python3 pipelines/heads/example.py"`.

It reads the line protocol (docs/manual/head-protocol.md), drives two axes that are only numbers here, and reports where
they are. What must stay: the head stops when no line has come for the timeout, and when the input ends.
"""
import os, select, sys, time  # noqa: E401

STEP = 0.02  # seconds from one look at the motors to the next


class Motors:
    """Two axes in degrees that follow a position or a speed. Replace it by calls to your hardware."""
    def __init__(self, words):
        at = words.index
        self.set_limits(words[at('limits') + 1:])
        self.most = [float(word) for word in words[at('speed') + 1:at('speed') + 3]]
        self.position = [float(word) for word in words[at('start') + 1:at('start') + 3]]
        self.stop()

    def set_limits(self, words):
        self.limits = tuple(map(float, words[:2])), tuple(map(float, words[2:4]))

    def stop(self):
        self.speed, self.target = [0.0, 0.0], [None, None]  # degrees a second, degrees

    def command(self, axis, words):  # takes hold, to POSITION SPEED or at SPEED off the list
        kind = words.pop(0)
        self.target[axis] = float(words.pop(0)) if kind == 'to' else None
        self.speed[axis] = 0.0 if kind == 'hold' else float(words.pop(0))

    def move(self, seconds):
        for axis in 0, 1:
            speed = max(-self.most[axis], min(self.most[axis], self.speed[axis]))
            way = speed * seconds
            if self.target[axis] is not None:
                left = self.target[axis] - self.position[axis]
                way = max(-abs(way), min(abs(way), left))
            low, high = self.limits[axis]
            self.position[axis] = max(low, min(high, self.position[axis] + way))


def run(motors, timeout):
    pending, heard, last = b'', time.monotonic(), time.monotonic()
    while True:
        if select.select([0], [], [], STEP)[0]:
            if not (piece := os.read(0, 4096)):
                return  # the pipeline has ended
            pending += piece
            heard = time.monotonic()
        *lines, pending = pending.split(b'\n')
        for words in (line.decode().split() for line in lines):
            if words[0] == 'move':
                words.pop(0)
                motors.command(0, words), motors.command(1, words)
            elif words[0] == 'alive':  # within half a second, or the pipeline takes this program for hung
                os.write(1, b'alive\n')
            elif words[0] == 'limits':
                motors.set_limits(words[1:])
            elif words[0] in ('stop', 'quit'):
                motors.stop()
        if time.monotonic() - heard > timeout:
            motors.stop()  # the pipeline hangs
        motors.move(time.monotonic() - last)
        last = time.monotonic()
        os.write(1, b'pose %.3f %.3f %.2f %.2f 0\n' % (*motors.position, *motors.speed))


hello = sys.stdin.buffer.raw.readline().decode().split()
if hello[:2] != ['cerberus-head', '1']:
    sys.exit('not the line protocol of a Cerberus head, version 1')
axes = Motors(hello)
print('ready 1 position velocity feedback alive rate 50', flush=True)
try:
    run(axes, float(hello[hello.index('timeout') + 1]))
except BrokenPipeError:
    pass  # the pipeline has ended
finally:
    axes.stop()
