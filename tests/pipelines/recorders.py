#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The example recorders of pipelines/recorder record what moves, and nothing that cannot be played.

    recorders.py RECORDER-PROGRAM
"""
import pathlib
import re
import sqlite3
import sys

from support import TOP, all_tests, json_lines, must, run, video

FRAMES = 60


def recorders(program):
    return [program], [sys.executable, TOP / 'pipelines' / 'recorder' / 'recorder.py']


def check_recording(line, clip, folder):
    folder.mkdir()
    output = must(run([*line, clip.absolute().as_uri(), folder]))
    ended = re.findall(r'^ended (\S+) \(track \d+\) ([\d.]+) s, (\d+) bytes$', output, re.M)
    assert len(ended) == 1, output
    path = pathlib.Path(ended[0][0])
    assert folder in path.parents and path.stat().st_size > 0, output
    # The clip is shorter than the pre-roll: all of it is in the file, each frame once.
    decoded = must(run(['/usr/bin/env', 'gst-launch-1.0', '-q', 'filesrc', f'location={path}', '!', 'decodebin', '!',
                        'videoconvert', '!', 'video/x-raw,format=GRAY8', '!', 'filesink', 'location=decoded']))
    assert pathlib.Path('decoded').stat().st_size == FRAMES * 320 * 240, decoded
    assert any(each['objects'] for each in json_lines(path.with_suffix('.jsonl')))
    index = folder / 'recordings.sqlite'
    if index.exists():
        rows = sqlite3.connect(index).execute('SELECT file, open FROM recordings').fetchall()
        assert rows == [(str(path.relative_to(folder)), 0)], rows


def test_both_record_a_file_around_what_moves_in_it(program):
    clip = video('clip.mp4', 'mp4mux', frames=FRAMES)
    for number, line in enumerate(recorders(program)):
        check_recording(line, clip, pathlib.Path(f'folder{number}').absolute())


def test_both_name_what_is_wrong(program):
    for line in recorders(program):
        status, output = run([*line, 'file:///nowhere/clip.mp4', '.'])
        assert status == 1 and 'nowhere' in output, output
        status, output = run([*line, 'file:///nowhere/clip.mp4'])
        assert status != 0 and 'URI FOLDER' in output, output


def test_both_are_short(_program):
    for name in ('recorder.cpp', 'recorder.py'):
        assert len((TOP / 'pipelines' / 'recorder' / name).read_text('utf-8').splitlines()) < 150, name


all_tests(dict(globals()), str(pathlib.Path(sys.argv[1]).absolute()))
