#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Every gst-launch line and Python program of the documentation runs, but for what a test machine does not have.

Lines are taken from the fenced blocks of the pages here and in docs/, and from the |[ ... ]| blocks of the elements'
SECTION comments. Cameras become a test source, files that are read become a small video, windows become a fakesink. Of
`./pipelines/run` it is only judged whether it can make its line: tests/pipelines run those.
"""
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / 'pipelines'))
from support import LIMIT, TOP  # noqa: E402

BALL = 'videotestsrc num-buffers=30 pattern=ball ! video/x-raw,format=I420,width=320,height=240,framerate=25/1'
NEEDS_HARDWARE = ('nvarguscamerasrc', 'nvvidconv', 'nvvideoconvert', 'vapostproc', 'v4l2convert', 'glupload')

REAL_DRIVER = re.compile(r'\bdriver=(?!simulated|scripted|replay)')


def blocks(path, language='(?:sh|shell|bash)?'):
    text = path.read_text('utf-8')
    if path.suffix == '.md':
        yield from re.findall(rf'^```{language}\n(.*?)^```', text, re.S | re.M)
    else:
        for comment in re.findall(r'/\*\*\n(.*?)\*/', text, re.S):
            comment = '\n'.join(re.sub(r'^\s*\* ?', '', line) for line in comment.splitlines())
            yield from re.findall(r'\|\[(?:\s*<!--.*?-->)?(.*?)\]\|', comment, re.S)


PAGES = [*sorted(TOP.glob('*.md')), *sorted((TOP / 'docs').rglob('*.md')), *sorted((TOP / 'plugins').rglob('*.cpp'))]
PAGES = [path for path in PAGES if path.parent != TOP / 'docs' / 'elements']  # those repeat the comments


def lines():
    for path in PAGES:
        for block in blocks(path):
            for line in block.replace('\\\n', ' ').splitlines():
                line = line.strip().removeprefix('$ ')
                if line.startswith('gst-launch-1.0 '):
                    yield path.relative_to(TOP), line


def launch_files():
    """Every `./pipelines/run ...` in a block or in the text, as what prints its line."""
    for path in PAGES:
        if path.suffix == '.md':
            for call in re.findall(r'\./pipelines/run( [^`\n]*)', path.read_text('utf-8')):
                words = shlex.split(call.replace('NAME', 'annotate'))
                if words[0] not in ('--list', '--print', '--help'):
                    words.insert(0, '--print')
                yield path.relative_to(TOP), [TOP / 'pipelines' / 'run', *words]


def programs():
    for path in PAGES:
        if path.suffix == '.md':
            for block in blocks(path, 'python'):
                yield path.relative_to(TOP), re.sub(r'location=\S+', 'location=ball.mkv', block)


def stand_in(line):
    """The words of the line with stand-ins for what is not here."""
    words, result = shlex.split(line), []
    source = ''
    for word in words:
        if word in ('v4l2src', 'libcamerasrc', 'autovideosrc'):
            source = 'camera'
            result += shlex.split(BALL.replace('videotestsrc', 'videotestsrc is-live=true'))
        elif word in ('filesrc', 'uridecodebin', 'videotestsrc', 'patrolsimsrc', 'udpsrc', 'playbin'):
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
            endless = source in ('videotestsrc', 'patrolsimsrc')
            if word == '!' and endless and not any(each.startswith('num-buffers') for each in result):
                result.append('num-buffers=30')
            if word == '!':
                source = ''
            result.append(word)
    return result


def goes_well(words):
    """Runs to its end; what went wrong, else nothing."""
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=LIMIT, errors='replace')
    except subprocess.TimeoutExpired:
        return 'it did not end'
    return '' if done.returncode == 0 and 'Traceback' not in done.stderr else done.stdout[-2000:] + done.stderr


def main():
    found, failed = 0, 0

    def judge(name, words):
        nonlocal found, failed
        found += 1
        wrong = goes_well(words)
        print('FAIL' if wrong else 'ok  ', name)
        if wrong:
            failed += 1
            print(f'  run as: {shlex.join(map(str, words))}\n  {wrong}')

    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        make = f'gst-launch-1.0 -q {BALL} ! x264enc ! matroskamux ! filesink location=ball.mkv'
        subprocess.run(make.split(), check=True, timeout=LIMIT)
        missing = [name for name in ('personverify', 'mqttpublish')
                   if subprocess.run(['gst-inspect-1.0', name], capture_output=True, check=False).returncode != 0]
        for path, line in lines():
            if any(name in line for name in missing):
                print(f'skip {path}: {line} (the element is not built)')
            elif any(name in line for name in NEEDS_HARDWARE) or REAL_DRIVER.search(line):
                print(f'skip {path}: {line} (its hardware is not here)')
            else:
                judge(f'{path}: {line}', stand_in(line))
        for path, words in launch_files():
            judge(f'{path}: {shlex.join(map(str, words[1:]))}', words)
        for path, program in programs():
            if 'import hailo' in program:
                print(f'skip {path}: a program (its hardware is not here; tests/python/boxes_of_others.py runs it)')
                continue
            judge(f'{path}: a program', ['/usr/bin/python3', '-c', program])
        os.chdir('/')
    print(f'{found} lines and programs')
    # Pages without any would make this test pass for nothing.
    sys.exit(1 if failed or found < 8 else 0)


main()
