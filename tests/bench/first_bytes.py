#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""How soon the first bytes of a recording are on the disk after its trigger, and its first frames.

    first_bytes.py [EVENTS]

A live stream of 640x480 at 25 frames a second, and events at random moments. With 2 s of pre-roll the ring fills a fragment
(.4 s) at once; without a pre-roll a file begins with the last keyframe. The first frames can be played
once the first fragment is there (its index, moov). Judged: both within 100 ms, or .5 s, of every event.
"""
import os
import random
import sys
import tempfile
import time

import gi
gi.require_version('Gst', '1.0')
from gi.repository import Gst  # noqa: E402

CASES = (('pre-roll 2 s, keyframes every s', 2, 25, .1), ('no pre-roll, keyframes only', 0, 1, .5),
         ('no pre-roll, keyframes every s', 0, 25, .5))
LONGEST = 20  # seconds


def wait_for(condition, what):
    end = time.monotonic() + LONGEST
    while not condition():
        if time.monotonic() > end:
            sys.exit(f'{what} did not come within {LONGEST} s')
        time.sleep(.0003)
    return time.monotonic()


def has_ended(bus):
    message = bus.pop_filtered(Gst.MessageType.ELEMENT)
    return bool(message) and message.get_structure().get_string('state') == 'ended'


def content(path):
    try:
        with open(path, 'rb') as file:
            return file.read()
    except FileNotFoundError:
        return b''


def size(path):
    return os.stat(path).st_size if os.path.exists(path) else 0


def measure(events, pre_roll, gop):
    """Seconds from each trigger to the first byte, and to the first fragment."""
    first, frames = [], []
    with tempfile.TemporaryDirectory() as folder:
        pipeline = Gst.parse_launch(
            f'eventrecorder name=recorder location={folder} file-name={{event}} trigger-track=false join=0 '
            f'pre-roll={pre_roll * Gst.SECOND} post-roll=0 videotestsrc is-live=true pattern=ball ! '
            f'video/x-raw,format=I420,width=640,height=480,framerate=25/1 ! x264enc tune=zerolatency '
            f'speed-preset=ultrafast key-int-max={gop} ! h264parse ! recorder.video')
        recorder, bus = pipeline.get_by_name('recorder'), pipeline.get_bus()
        pipeline.set_state(Gst.State.PLAYING)
        if pipeline.get_state(LONGEST * Gst.SECOND)[0] == Gst.StateChangeReturn.FAILURE:
            sys.exit('the pipeline does not play')
        time.sleep(pre_roll + 2)
        for event in range(1, events + 1):
            path = f'{folder}/{event}.mp4'
            start = time.monotonic()
            recorder.emit('start-event', 'bench')
            first.append(wait_for(lambda: size(path) > 0, 'the first byte') - start)
            frames.append(wait_for(lambda: b'moov' in content(path), 'the first fragment') - start)
            recorder.emit('stop-event')
            wait_for(lambda: has_ended(bus), 'the end of the file')  # then the next trigger begins another one
            time.sleep(random.random())
        pipeline.set_state(Gst.State.NULL)
    return sorted(first), sorted(frames)


def main():
    Gst.init(None)
    if not Gst.ElementFactory.find('x264enc'):
        print('skipped: x264enc is missing')
        sys.exit(77)
    events, missed = int(sys.argv[1]) if len(sys.argv) > 1 else 20, False
    print(f'{"ms after the trigger":36}{"median":>8}{"most":>8}   ({events} events each)')
    for name, pre_roll, gop, limit in CASES:
        first, frames = measure(events, pre_roll, gop)
        missed |= max(first + frames) > limit
        for what, times in (('first byte', first), ('first frames', frames)):
            print(f'{name + ": " + what:50}{1000 * times[len(times) // 2]:8.1f}{1000 * times[-1]:8.1f}')
    sys.exit(int(missed))


main()
