#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""How many cameras a core analyses and records: H.264 at 25 frames a second, decoded, analysed, and all of it recorded.

    cameras.py [FRAMES]

The pictures are those of vtest.avi, scaled. CPU is that of the process (user and system, all threads); the decoder's part
is that of a pipeline that only decodes.
"""
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
RATE = 25
# Width, height, kilobits a second of the encoder: what cameras are usually set to.
SIZES = ((320, 240, 512), (1280, 720, 3000), (1920, 1080, 6000))
QUEUE = 'queue max-size-buffers=0 max-size-bytes=0 max-size-time=0'
LINES = {
    'decode': 'avdec_h264 ! fakesink',
    'decode and detect': 'avdec_h264 ! motiondetect ! fakesink',
    'decode, detect and record': f'tee name=t eventrecorder name=r location={{folder}} '
                                 f't. ! {QUEUE} ! r.video t. ! {QUEUE} ! avdec_h264 ! motiondetect ! r.analysis',
}


def launch(line):
    """Seconds of CPU of a pipeline from its start to its end."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(['gst-launch-1.0', '-q', *line.split()], check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    frames = int(sys.argv[1]) if len(sys.argv) > 1 else 750
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
            for name, line in LINES.items():
                spent = launch(f'filesrc location={clip} ! matroskademux ! h264parse ! {line.format(folder=folder)}')
                each = max(spent - start, 1e-9) / frames
                print(f'  {name:26}{1000 * each:12.2f}{1 / (each * RATE):16.1f}')


main()
