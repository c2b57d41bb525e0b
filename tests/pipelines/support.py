# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the pipeline tests share: running programs that must end, and making small videos."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
LIMIT = 60  # seconds for anything that should take a few
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


def must(result):
    status, output = result
    assert status == 0, f'exit status {status}:\n{output}'
    return output


def ball(frames=60, width=320, height=240, live=False, name='scene'):
    """The text of a source: a grey ball that bounces in front of a grey wall with rings on it, which stands still."""
    part = ('videotestsrc num-buffers={frames} is-live={live} {what} ! video/x-raw,format=AYUV,width={width},'
            'height={height},framerate=25/1 ! {name}.')
    return ' '.join([
        part.format(what='pattern=zone-plate kx2=12 ky2=12', **locals()),
        part.format(what='pattern=ball background-color=0', **locals()),  # that is, a transparent one
        f'compositor name={name} ! video/x-raw,format=AYUV,width={width},height={height} ! videoconvert ! '
        'video/x-raw,format=I420'])


def video(path, muxer, **what):
    must(gst_launch(f'{ball(**what)} ! x264enc key-int-max=10 ! {muxer} ! filesink location={path}'))
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
