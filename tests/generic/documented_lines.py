#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Every gst-launch line of the documentation runs, word for word but for what a test machine does not have.

Lines are taken from the fenced blocks of README.md and docs/ and from the |[ ... ]| blocks of the elements' SECTION
comments. Cameras become a test source, files that are read become a small video, windows become a fakesink.
"""
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
BALL = 'videotestsrc num-buffers=30 pattern=ball ! video/x-raw,width=320,height=240,framerate=25/1'
NEEDS_HARDWARE = ('nvarguscamerasrc', 'nvvidconv', 'nvvideoconvert', 'vapostproc', 'v4l2convert', 'glupload')


def blocks(path):
    text = path.read_text('utf-8')
    if path.suffix == '.md':
        yield from re.findall(r'^```(?:sh|shell|bash)?\n(.*?)^```', text, re.S | re.M)
    else:
        for comment in re.findall(r'/\*\*\n(.*?)\*/', text, re.S):
            comment = '\n'.join(re.sub(r'^\s*\* ?', '', line) for line in comment.splitlines())
            yield from re.findall(r'\|\[(?:\s*<!--.*?-->)?(.*?)\]\|', comment, re.S)


def lines():
    pages = [TOP / 'README.md', *sorted((TOP / 'docs').rglob('*.md')), *sorted((TOP / 'plugins').rglob('*.cpp'))]
    for path in pages:
        if not path.exists() or path.parts[-2] == 'elements' and path.suffix == '.md':
            continue  # the element pages repeat the comments
        for block in blocks(path):
            for line in block.replace('\\\n', ' ').splitlines():
                line = line.strip().removeprefix('$ ')
                if line.startswith('gst-launch-1.0 '):
                    yield path.relative_to(TOP), line


def stand_in(line):
    """The words of the line with stand-ins for what is not here."""
    words, result = shlex.split(line), []
    source = ''
    for word in words:
        if word in ('v4l2src', 'libcamerasrc', 'autovideosrc'):
            source = 'camera'
            result += shlex.split(BALL.replace('videotestsrc', 'videotestsrc is-live=true'))
        elif word in ('filesrc', 'uridecodebin', 'videotestsrc', 'udpsrc', 'playbin'):
            source = word
            result.append(word)
        elif source == 'camera' and word.startswith(('device=', 'camera-name=')):
            continue
        elif source == 'filesrc' and word.startswith('location='):
            result.append('location=ball.mkv')
        elif source == 'uridecodebin' and word.startswith('uri='):
            result.append('uri=file://' + os.path.abspath('ball.mkv'))
        elif re.fullmatch(r'(auto|xv|x|gl|wayland)(image|video)?sink', word):
            result.append('fakesink')
        elif word.startswith('sync=') and result[-1] == 'fakesink':
            continue
        else:
            if word == '!' and source == 'videotestsrc' and not any(each.startswith('num-buffers') for each in result):
                result.append('num-buffers=30')
            if word == '!':
                source = ''
            result.append(word)
    return result


def main():
    found, failed = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        subprocess.run(['gst-launch-1.0', '-q', *f'{BALL} ! x264enc ! matroskamux ! filesink location=ball.mkv'.split()],
                       check=True, timeout=60)
        for path, line in lines():
            found += 1
            if any(name in line for name in NEEDS_HARDWARE):
                print(f'skip {path}: {line} (its hardware is not here)')
                continue
            words = stand_in(line)
            try:
                done = subprocess.run(words, capture_output=True, text=True, timeout=60, errors='replace')
                wrong = '' if done.returncode == 0 else done.stdout + done.stderr
            except subprocess.TimeoutExpired:
                wrong = 'it did not end'
            print('FAIL' if wrong else 'ok  ', f'{path}: {line}')
            if wrong:
                failed += 1
                print(f'  run as: {shlex.join(words)}\n  {wrong}')
        os.chdir('/')
    print(f'{found} lines')
    # A page without lines would make this test pass for nothing.
    sys.exit(1 if failed or found < 3 else 0)


main()
