#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A pan-tilt head on a GRBL 1.1 board, for pantiltsink: X is pan and Y is tilt, in degrees ($100, $101: steps a degree).

    gst-launch-1.0 ... ! pantiltsink driver=external command="python3 pipelines/heads/grbl.py /dev/ttyUSB0"

It turns by short jogs, sent as fast as they are carried out: if this program is killed, the board comes to rest after
those that wait (a quarter of a second). A stop is the jog cancel, and the feed hold where that has not helped.
"""
import os, re, select, sys, termios, time, tty  # noqa: E401

STEP = 0.05  # seconds of one jog
WAITING = 4  # jogs that the board has not accepted yet
CANCEL, HOLD, RESET = b'\x85', b'!', b'\x18'


class Pipeline:
    """Its lines. `alive` is answered as it comes, also while the board is being stopped, which may take a second."""
    def __init__(self):
        self.pending, self.lines, self.heard, self.ended = b'', [], time.monotonic(), False

    def receive(self):
        if self.ended or not select.select([0], [], [], 0)[0]:
            return
        if not (piece := os.read(0, 4096)):
            self.ended = True
            return
        self.heard = time.monotonic()
        *lines, self.pending = (self.pending + piece).split(b'\n')
        for words in (line.decode().split() for line in lines):
            if words == ['alive']:
                print('alive', flush=True)
            elif words:
                self.lines.append(words)

    def take(self):
        lines, self.lines = self.lines, []
        return lines


class Board:
    def __init__(self, path, pipeline):
        self.pipeline = pipeline
        self.fd = os.open(path, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.fd)
        mode = termios.tcgetattr(self.fd)
        mode[4] = mode[5] = termios.B115200
        termios.tcsetattr(self.fd, termios.TCSANOW, mode)
        self.rest, self.state, self.position, self.waiting = b'', '', [0.0, 0.0], 0

    def send(self, data):
        os.write(self.fd, data)

    def receive(self, patience=0.0):  # True: a new position
        if not select.select([self.fd], [], [], patience)[0]:
            return False
        data = os.read(self.fd, 4096)
        if not data:
            raise OSError('the GRBL board is gone')
        *lines, self.rest = (self.rest + data).split(b'\n')
        reported = False
        for line in lines:
            if line.startswith((b'ok', b'error')):
                self.waiting = max(0, self.waiting - 1)
            if status := re.match(rb'<([\w:]+)\|MPos:([-\d.]+),([-\d.]+)', line):
                self.state, reported = status[1].decode(), True
                self.position = [float(status[2]), float(status[3])]
        return reported

    def jog(self, speeds):
        feed = 60 * (speeds[0] ** 2 + speeds[1] ** 2) ** 0.5
        self.send(b'$J=G91 X%.4f Y%.4f F%.1f\n' % (speeds[0] * STEP, speeds[1] * STEP, feed))
        self.waiting += 1

    def stop(self):
        self.send(CANCEL)
        for tries in range(20):  # a second; a jog that is not acknowledged yet may still begin
            self.pipeline.receive()
            self.send(b'?')
            if self.receive(STEP) and self.state not in ('Jog', 'Run', 'Hold:1') and not self.waiting:
                break
            if self.state != 'Hold:1':
                self.send(HOLD if tries > 4 else CANCEL)
        self.waiting = 0
        if self.state == 'Hold:0':  # it stands and keeps its position; without a reset it would carry out no jog again
            self.send(RESET)


def run(board, pipeline, hello):
    low, high, timeout = hello[5:9:2], hello[6:9:2], hello[3]
    speeds, moving = [0.0, 0.0], [0.0, 0.0]
    asked = jogged = time.monotonic()
    while not pipeline.ended:
        select.select([0, board.fd], [], [], STEP / 5)
        now = time.monotonic()
        pipeline.receive()
        for word, *rest in pipeline.take():
            if word == 'move':
                speeds = [float(rest.pop(0)) if rest.pop(0) == 'at' else 0.0 for _ in speeds]
            elif word == 'limits':
                low, high = [float(n) for n in rest[0::2]], [float(n) for n in rest[1::2]]
            elif word in ('stop', 'quit'):
                speeds = [0.0, 0.0]
        if now - pipeline.heard > timeout:
            speeds = [0.0, 0.0]  # the pipeline hangs
        if board.receive():
            print('pose %.3f %.3f 0 0 0.02' % (*board.position,), flush=True)
        # The board still carries out what it has accepted: an axis near its limit gets no further jog.
        wanted = [0.0 if (p + v * WAITING * STEP > b if v > 0 else p + v * WAITING * STEP < a) else v
                  for p, v, a, b in zip(board.position, speeds, low, high)]
        if any(m and not w for m, w in zip(moving, wanted)):
            board.stop()  # also the jogs that wait; an axis that goes on begins anew
            moving = [0.0, 0.0]
        elif any(wanted) and now - jogged >= STEP and board.waiting < WAITING:
            board.jog(wanted)
            moving, jogged = wanted, now
        if now - asked >= 2 * STEP:
            board.send(b'?')
            asked = now


words = sys.stdin.buffer.raw.readline().decode().split()
if words[:2] != ['cerberus-head', '1']:
    sys.exit('not the line protocol of a Cerberus head, version 1')
try:
    cerberus = Pipeline()
    grbl = Board(sys.argv[1], cerberus)
    grbl.stop()
    if grbl.state in ('', 'Alarm'):
        sys.exit(print('fault the GRBL board', 'is in alarm: home it ($H) or unlock it ($X)' if grbl.state else
                       'does not answer', flush=True))
    print('ready 1 velocity feedback alive rate 20', flush=True)
    try:
        run(grbl, cerberus, [float(n) if n[-1].isdigit() else n for n in words])
    finally:
        grbl.stop()
except (OSError, IndexError) as error:
    print('fault', error, flush=True)
