#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What lost RTP packets do to the boxes on vtest.avi: eight runs with other packets lost, and one without loss.

    lossy.py [PROBABILITY] [ENCODER] [RECEIVER]    0.02, "x264enc tune=zerolatency" and "rtph264depay"

RECEIVER stands between the network and avdec_h264: "rtph264depay request-keyframe=true ! streamdamage", for example. The
encoder answers its requests for a keyframe.
whole: decoded frames that are undamaged, because no packet of theirs or of any frame back to the last keyframe is lost.
boxes: all that are published. recall: of the people of the ground truth whose box ends before column 735 (IoU >= .5), in all
decoded frames, and in the whole ones, of which the run without loss has the recall in the last column.
"""
import json
import os
import pathlib
import random
import sys
import tempfile

import gi
gi.require_version('Gst', '1.0')
from gi.repository import Gst  # noqa: E402

TOP = pathlib.Path(__file__).resolve().parents[2]
TRUTH_ENDS, RUNS = 735, 8


def overlap(a, b):
    width = min(a[0] + a[2], b[0] + b[2]) - max(a[0], b[0])
    height = min(a[1] + a[3], b[1] + b[3]) - max(a[1], b[1])
    both = max(width, 0) * max(height, 0)
    return both / (a[2] * a[3] + b[2] * b[3] - both)


def found_people(objects, people):
    """How many of the people some box of its own covers."""
    boxes = [tuple(each[key] for key in 'xywh') for each in objects]
    pairs = sorted(((overlap(box, person), i, j) for i, box in enumerate(boxes) for j, person in enumerate(people)),
                   reverse=True)
    used, found = set(), set()
    for share, i, j in pairs:
        if share >= 0.5 and i not in used and j not in found:
            used.add(i)
            found.add(j)
    return len(found)


def truth_of(folder):
    truth = {}
    for line in (folder / 'gt.txt').read_text('utf-8').splitlines():
        frame, _, x, y, width, height, flag = [float(word) for word in line.split(',')[:7]]
        if flag and x + width <= TRUTH_ENDS:
            truth.setdefault(int(frame) - 1, []).append((x, y, width, height))
    return truth


def run(video, encoder, receiver, probability, seed, path):
    """The lines of motionjson, and the times of the damaged frames."""
    chance = random.Random(seed)
    damaged, state = set(), {'damaged': False, 'any': False}
    depayloader, _, rest = receiver.partition(' ')
    pipeline = Gst.parse_launch(
        f'filesrc location={video} ! decodebin ! videoconvert ! video/x-raw,format=I420 ! {encoder} ! rtph264pay ! '
        f'identity name=network ! {depayloader} name=depay {rest} ! avdec_h264 ! motiondetect ! motionjson ! '
        f'filesink location={path}')

    def lose(_pad, _info):
        return Gst.PadProbeReturn.DROP if chance.random() < probability else Gst.PadProbeReturn.OK

    def mark(_pad, info):
        buffer = info.get_buffer()
        lost = buffer.has_flags(Gst.BufferFlags.DISCONT) and state['any']
        state['any'] = True
        if lost or not buffer.has_flags(Gst.BufferFlags.DELTA_UNIT):
            state['damaged'] = lost
        if state['damaged']:
            damaged.add(buffer.pts)
        return Gst.PadProbeReturn.OK

    pipeline.get_by_name('network').get_static_pad('src').add_probe(Gst.PadProbeType.BUFFER, lose)
    pipeline.get_by_name('depay').get_static_pad('src').add_probe(Gst.PadProbeType.BUFFER, mark)
    pipeline.set_state(Gst.State.PLAYING)
    message = pipeline.get_bus().timed_pop_filtered(Gst.CLOCK_TIME_NONE, Gst.MessageType.EOS | Gst.MessageType.ERROR)
    pipeline.set_state(Gst.State.NULL)
    if message.type == Gst.MessageType.ERROR:
        sys.exit(message.parse_error().gerror.message)
    return [json.loads(line) for line in path.read_text('utf-8').splitlines()], damaged


def score(lines, damaged, truth, numbers):
    """Boxes, recall, and recall in frames of which nothing was lost."""
    boxes = found = people = found_whole = people_whole = 0
    for line in lines:
        objects = line['objects'] or []
        there = truth.get(numbers[line['pts']], [])
        hits = found_people([each for each in objects if each['x'] + each['w'] <= TRUTH_ENDS], there)
        boxes += len(objects)
        found, people = found + hits, people + len(there)
        if line['pts'] not in damaged:
            found_whole, people_whole = found_whole + hits, people_whole + len(there)
    return boxes, found / max(people, 1), found_whole / max(people_whole, 1)


def main():
    probability = float(sys.argv[1]) if len(sys.argv) > 1 else 0.02
    encoder = sys.argv[2] if len(sys.argv) > 2 else 'x264enc tune=zerolatency'
    receiver = sys.argv[3] if len(sys.argv) > 3 else 'rtph264depay'
    folder = pathlib.Path(os.environ.get('CERBERUS_DATA', TOP.parent / 'shared' / 'data')) / 'pets09_s2l1_view1'
    if not (folder / 'vtest.avi').exists():
        print(f'skipped: {folder} is missing')
        sys.exit(77)
    Gst.init(None)
    truth = truth_of(folder)
    with tempfile.TemporaryDirectory() as place:
        path = pathlib.Path(place) / 'lines'
        clean, _ = run(folder / 'vtest.avi', encoder, receiver, 0, 0, path)
        numbers = {line['pts']: number for number, line in enumerate(clean)}
        whole = score(clean, set(), truth, numbers)
        print(f'{encoder} | {receiver}, {100 * probability:g} % of the packets lost\n'
              f'{"run":>4}{"frames":>8}{"whole":>7}{"boxes":>8}{"ratio":>7}{"recall":>8}{"of whole":>10}{"lossless":>10}')
        print(f'{"-":>4}{len(clean):8}{len(clean):7}{whole[0]:8}{1:7.2f}{whole[1]:8.3f}{whole[2]:10.3f}{whole[2]:10.3f}')
        scores = []
        for seed in range(1, RUNS + 1):
            lines, damaged = run(folder / 'vtest.avi', encoder, receiver, probability, seed, path)
            seen = {line['pts'] for line in lines} - damaged
            one = (*score(lines, damaged, truth, numbers),
                   score(clean, set(numbers) - seen, truth, numbers)[2], len(seen))
            scores.append(one)
            print(f'{seed:4}{len(lines):8}{one[4]:7}{one[0]:8}{one[0] / whole[0]:7.2f}{one[1]:8.3f}{one[2]:10.3f}'
                  f'{one[3]:10.3f}', flush=True)
        mean = [sum(each) / RUNS for each in zip(*scores)]
        print(f'mean{mean[4]:15.0f}{mean[0]:8.0f}{mean[0] / whole[0]:7.2f}{mean[1]:8.3f}{mean[2]:10.3f}{mean[3]:10.3f}')


main()
