#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""How many cameras a core analyses and records: H.264 at 25 frames a second, decoded, analysed, and all of it recorded;
and what of it is the recorder.

    cameras.py [FRAMES [PAIRS]]

The pictures are those of vtest.avi, scaled. CPU is that of the process (user and system, all threads); the decoder's part
is that of a pipeline that only decodes. The recorder's part, at 1280x720: the median of the differences of PAIRS (7) pairs,
of a pipeline with it and the same one with fakesinks in its place, in turns. Judged: at most 2 % of a core.
"""
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
RATE = 25
# Width, height, kilobits a second of the encoder: what cameras are usually set to.
SIZES = ((320, 240, 512), (1280, 720, 3000), (1920, 1080, 6000))
MOST = 2  # percent of a core, of the recorder
QUEUE = 'queue max-size-buffers=0 max-size-bytes=0 max-size-time=0'
LINES = {
    'decode': 'avdec_h264 ! fakesink',
    'decode and detect': 'avdec_h264 ! motiondetect ! fakesink',
    'decode, detect and record': f'tee name=t eventrecorder name=r location={{folder}} '
                                 f't. ! {QUEUE} ! r.video t. ! {QUEUE} ! avdec_h264 ! motiondetect ! r.analysis',
}
WITHOUT = f'tee name=t t. ! {QUEUE} ! fakesink t. ! {QUEUE} ! avdec_h264 ! motiondetect ! fakesink'


def launch(line):
    """Seconds of CPU of a pipeline from its start to its end."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(['gst-launch-1.0', '-q', *line.split()], check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def recorder_percent(read, folder, frames, pairs):
    """The median of what the recorder adds, and the least and the most, in percent of a core at the stream's rate."""
    added = []
    for pair in range(pairs):
        lines = (LINES['decode, detect and record'].format(folder=folder), WITHOUT)
        spent = {line: launch(f'{read} ! {line}') for line in (lines if pair % 2 else reversed(lines))}
        added.append(100 * RATE * (spent[lines[0]] - spent[WITHOUT]) / frames)
    return statistics.median(added), min(added), max(added)


def main():
    frames = int(sys.argv[1]) if len(sys.argv) > 1 else 750
    pairs = int(sys.argv[2]) if len(sys.argv) > 2 else 7
    data = pathlib.Path(os.environ.get('CERBERUS_DATA', TOP.parent / 'shared' / 'data'))
    source = data / 'pets09_s2l1_view1' / 'vtest.avi'
    if not source.exists():
        print(f'skipped: {source} is missing')
        sys.exit(77)
    print(f'{"":28}{"ms a frame":>12}{"cameras a core":>16}   ({RATE} frames a second each)')
    with tempfile.TemporaryDirectory() as folder:
        for width, height, bitrate in SIZES:
            clip = pathlib.Path(folder) / f'{width}.mkv'
            launch(f'filesrc location={source} ! decodebin ! identity eos-after={frames} ! videoconvert ! videoscale ! '
                   f'video/x-raw,format=I420,width={width},height={height},pixel-aspect-ratio=1/1 ! '
                   f'videorate max-rate={RATE} ! x264enc bitrate={bitrate} speed-preset=veryfast key-int-max=50 ! '
                   f'h264parse ! matroskamux ! filesink location={clip}')
            start = launch(f'filesrc location={clip} ! matroskademux ! identity eos-after=2 ! h264parse ! fakesink')
            print(f'{width}x{height}')
            read = f'filesrc location={clip} ! matroskademux ! h264parse'
            for name, line in LINES.items():
                spent = launch(f'{read} ! {line.format(folder=folder)}')
                each = max(spent - start, 1e-9) / frames
                print(f'  {name:26}{1000 * each:12.2f}{1 / (each * RATE):16.1f}')
            if width == 1280:
                median, least, most = recorder_percent(read, folder, frames, pairs)
                print(f'  the recorder: {median:.2f} % of a core ({least:.2f} to {most:.2f}, {pairs} pairs)')
    sys.exit(int(median > MOST))


main()
