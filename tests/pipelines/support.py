# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the pipeline tests share: running programs that must end, and making small videos."""
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
# Seconds for anything that should take a few; tests/run stretches it as it does for the other tests.
LIMIT = 60 * float(os.environ.get('CK_TIMEOUT_MULTIPLIER', 1))
PATIENCE = 4 * 10**9  # nanoseconds for which a live picture may be late: no frame is repeated or left out before
CRASHES = {-4, -6, -8, -11, 132, 134, 136, 139}


def run(line, env=None, stdin=None):
    """Runs a program to its end: (exit status, all it printed). One that hangs or crashes fails the test."""
    words = line if isinstance(line, list) else line.split()
    done = subprocess.run([str(word) for word in words], timeout=LIMIT, text=True, errors='replace', stdin=stdin,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env={**os.environ, **(env or {})})
    assert done.returncode not in CRASHES, f'{line} crashed ({done.returncode}):\n{done.stdout}'
    return done.returncode, done.stdout


def gst_launch(line, **more):
    """Runs a line of gst-launch. Not by gst-launch-1.0 itself: that of Debian 12 hangs when an error comes at once."""
    return run([sys.executable, TOP / 'tests' / 'pipelines' / 'launch.py', *line.split()], **more)


def without_verify():
    """The environment of a machine that has every plugin but that of personverify, in this folder."""
    folder = pathlib.Path('plugins')
    folder.mkdir()
    for path in pathlib.Path(os.environ['GST_PLUGIN_PATH_1_0']).iterdir():
        if path.is_dir() and path.name != 'verify':
            (folder / path.name).symlink_to(path)
    return {'GST_PLUGIN_PATH_1_0': str(folder.resolve()), 'GST_REGISTRY_1_0': os.path.abspath('registry.bin')}


def must(result):
    status, output = result
    assert status == 0, f'exit status {status}:\n{output}'
    return output


def before_rings(ball_width, ball_height, place, frames, width, height, live, name):
    """The text of a source: a grey ball in a picture of so many pixels, which is laid over rings at a place."""
    def part(pattern, size):
        return (f'videotestsrc num-buffers={frames} is-live={live} {pattern} ! '
                f'video/x-raw,format=AYUV,width={size[0]},height={size[1]},framerate=25/1 ! {name}.')
    left, top, over_width, over_height = place
    return ' '.join([
        part('pattern=zone-plate kx2=12 ky2=12', (width, height)) + 'sink_0',
        part('pattern=ball background-color=0', (ball_width, ball_height)) + 'sink_1',  # that is, a transparent one
        f'compositor name={name} min-upstream-latency={PATIENCE if live else 0} sink_1::xpos={left} sink_1::ypos={top} '
        f'sink_1::width={over_width} sink_1::height={over_height} ! '
        f'video/x-raw,format=AYUV,width={width},height={height} ! videoconvert ! video/x-raw,format=I420'])


def ball(frames=60, width=320, height=240, live=False, name='scene'):
    """The text of a source: a grey ball that bounces in front of a grey wall with rings on it, which stands still."""
    return before_rings(width, height, (0, 0, width, height), frames, width, height, live, name)


# A lens of VIEW degrees that looks straight ahead, CLEARANCE metres above the ground, as robot.launch takes it to be;
# and somebody who runs to and fro before it, at most 2.1 m a second.
VIEW, CLEARANCE, DISTANCE, TALL, WIDE = 60, 0.8, 5, 1.7, 0.5


def person(frames=60, width=320, height=240, live=False, name='scene'):
    """The text of a source: a ball again, but as large in the picture as a person of that size at that distance is.

    It stays on the ground: a picture as high as the ball, 40 pixels, leaves it no room but to the sides.
    """
    metre = width / 2 / math.tan(math.radians(VIEW / 2)) / DISTANCE  # in pixels, at the distance
    top = height / 2 + (CLEARANCE - TALL) * metre
    return before_rings(round(width * 40 / (WIDE * metre)), 40, (0, round(top), width, round(TALL * metre)),
                        frames, width, height, live, name)


def video(path, muxer, scene=ball, **what):
    must(gst_launch(f'{scene(**what)} ! x264enc key-int-max=10 ! {muxer} ! filesink location={path}'))
    return pathlib.Path(path)


def json_lines(path):
    with open(path, encoding='utf-8') as file:
        return [json.loads(line) for line in file]


def all_tests(names, *arguments):
    """Runs every function called test_... in a folder of its own that is gone afterwards; all of them, then judges."""
    failed = []
    for name, function in list(names.items()):
        if not name.startswith('test_'):
            continue
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                function(*arguments)
                print('ok  ', name[5:].replace('_', ' '))
            except (AssertionError, subprocess.SubprocessError, ValueError, KeyError, OSError) as error:
                print('FAIL', name[5:].replace('_', ' '), '-', type(error).__name__, error)
                failed.append(name)
            os.chdir('/')
    raise SystemExit(1 if failed else 0)
