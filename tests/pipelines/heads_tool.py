#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""cerberus-heads as a user runs it: nothing moves before Enter, the first key ends it, ports are only asked if named.

    heads_tool.py CERBERUS-HEADS CERBERUS-HEAD 1|0     (1: the driver visca was built)
"""
import os
import pty
import re
import select
import signal
import subprocess
import sys
import tempfile
import time

from support import LIMIT, TOP, all_tests, run

TOOL, HELPER = map(os.path.abspath, sys.argv[1:3])
HAVE_VISCA = sys.argv[3] == '1'
EXAMPLE = ['--command', f'{sys.executable} {TOP}/pipelines/heads/example.py']


class Terminal:
    """A terminal in which the tool runs."""
    def __init__(self, *words):
        self.far, near = pty.openpty()
        self.process = subprocess.Popen([TOOL, *words], stdin=near, stdout=near, stderr=near)
        os.close(near)
        self.said = ''

    def read(self):
        if select.select([self.far], [], [], .05)[0]:
            try:
                self.said += os.read(self.far, 4096).decode()
            except OSError:  # it ended
                pass

    def until(self, pattern):
        end = time.monotonic() + LIMIT
        while not re.search(pattern, self.said):
            assert time.monotonic() < end, f'no {pattern} in:\n{self.said}'
            self.read()

    def press(self, keys):
        os.write(self.far, keys)

    def status(self):
        end = time.monotonic() + LIMIT
        while self.process.poll() is None:
            assert time.monotonic() < end, f'it goes on:\n{self.said}'
            self.read()
        self.read()
        os.close(self.far)
        return self.process.returncode

    def pan(self):
        """The last angle that the head reported; none before it was opened."""
        angles = re.findall(r'pan (-?[0-9.]+) tilt', self.said)
        return float(angles[-1]) if angles else None


def test_it_says_that_the_head_will_move_and_the_first_key_ends_it():
    terminal = Terminal('move', 'external', *EXAMPLE, '--pan=0.5', '--seconds=60')  # 30 degrees in all
    terminal.until('Press Enter to begin; the first key then ends it')
    assert 'The head will turn at 0.5 degrees a second to the right and 0 up, for 60 s' in terminal.said
    assert terminal.pan() is None
    terminal.press(b'\n')
    terminal.until(r'pan (0\.[1-9]|[1-9])')
    terminal.press(b'x')
    assert terminal.status() == 0
    assert terminal.pan() < 25, terminal.said


def test_without_enter_nothing_moves():
    terminal = Terminal('move', 'external', *EXAMPLE, '--pan=5')
    terminal.until('Press Enter')
    terminal.press(b'n\n')
    assert terminal.status() == 1
    assert terminal.pan() is None


def test_a_helper_that_hangs_or_crashes_is_replaced_by_one_that_stops_the_head():
    for way, said in ((signal.SIGSTOP, 'hangs: it has not answered `alive` for 0.5 s. It was killed'), (signal.SIGKILL, 'ended')):
        check_that_another_one_stops_the_head(way, said)


def check_that_another_one_stops_the_head(way, said):
    terminal = Terminal('move', 'external', *EXAMPLE, '--yes', '--pan=0.5', '--seconds=60')
    terminal.until(r'pan (0\.[1-9]|[1-9])')
    with open(f'/proc/{terminal.process.pid}/task/{terminal.process.pid}/children', encoding='ascii') as file:
        helper, = map(int, file.read().split())
    os.kill(helper, way)
    assert terminal.status() == 1
    assert re.search(r'helper `\S*python\S*` ' + said + ', and another one has stopped the head', terminal.said), terminal.said
    assert not os.path.exists(f'/proc/{helper}')


# A head of numbers that turns for ten seconds at most, and reports what `says` makes of its angle.
LIAR = """
import os, select, sys, time
print('ready 1 velocity feedback alive', flush=True)
pan, speed, last, k = 0.0, 0.0, time.monotonic(), 0
while True:
    if select.select([0], [], [], .05)[0]:
        for words in map(str.split, os.read(0, 4096).decode().splitlines() or sys.exit()):
            if words[0] == 'alive':
                print('alive', flush=True)
            if words[0] in ('move', 'stop'):
                speed = float(words[2]) if words[1:2] == ['at'] else 0.0
    now = time.monotonic()
    pan, last, k = pan + speed * (now - last), now, k + 1
    open('FILE', 'w').write(str(pan))
    print('pose', SAYS, '0 0 0 0', flush=True)
"""


def test_a_move_ends_at_the_limits_or_where_the_reports_part_from_it():
    ends, parts = 'stopped at the limits', 'the head reports .* as pan, and its speed leads to '
    with tempfile.TemporaryDirectory() as folder:
        for says, speed, limit, text, most in (('pan', 10, 10, ends, 25), ('-pan', 10, 10, ends, 25),
                                               ('pan', -10, 10, ends, 25), ('-pan', -10, 10, ends, 25),
                                               ('-pan', 20, 90, parts, 40), ('0', 12, 90, parts, 45),
                                               ('pan if k % 2 else 29', 2, 30, parts, 20), ("float('nan')", 10, 90, parts, 20)):
            liar, angle = os.path.join(folder, 'liar.py'), os.path.join(folder, 'angle')
            with open(liar, 'w', encoding='utf-8') as file:
                file.write(LIAR.replace('FILE', angle).replace('SAYS', says))
            status, said = run([TOOL, 'move', 'external', '--command', f'{sys.executable} {liar}', '--yes', '--seconds=12',
                                f'--pan={speed}', f'--limits={-limit},{limit},-20,20'])
            assert status == (1 if text == parts else 0) and re.search(text, said), (says, speed, said)
            with open(angle, encoding='utf-8') as file:
                turned = float(file.read())
            assert 0 < turned * speed / abs(speed) < most, (says, speed, turned)


def test_a_port_is_asked_if_it_is_named():
    far, near = pty.openpty()
    status, said = run([TOOL, 'list', 'serial:' + os.ttyname(near)])
    assert status == 1 and 'no answer' in said, said
    assert bytes.fromhex('81090612ff') in os.read(far, 4096)
    os.close(near)
    os.close(far)


def test_one_program_drives_a_head_and_a_killed_one_frees_it():
    camera = [HELPER, 'visca', '--device=udp:127.0.0.1:9']  # nothing is sent before the pipeline's first line
    with subprocess.Popen(camera, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as first:
        end, said = time.monotonic() + LIMIT, ''
        while not said and time.monotonic() < end:  # until the first one was faster than the second
            said = run([*camera, 'address=01'], stdin=subprocess.DEVNULL)[1]  # 1 is the usual address
        assert f'fault another program (process {os.getpid()}) drives the head at udp:127.0.0.1:9 address 1 ' \
            'already: end it first' in said, said
        begin = time.monotonic()
        run([*camera, 'address=01'], stdin=subprocess.DEVNULL)
        assert time.monotonic() - begin < 3  # at once: a pipeline waits 5 s for a helper
        status, said = run([TOOL, 'list', 'udp:127.0.0.1:9'])
        assert status == 1 and f'another program (process {os.getpid()}) drives the head' in said, said
        assert run([*camera, 'address=2'], stdin=subprocess.DEVNULL)[1] == ''
        first.kill()
    assert run(camera, stdin=subprocess.DEVNULL)[1] == ''


def test_a_program_whose_pipeline_has_ended_is_waited_for():
    far, near = pty.openpty()  # a camera that answers nothing: it is sent its stop for half a second
    camera = [HELPER, 'visca', '--device=serial:' + os.ttyname(near), '--no-feedback']
    with subprocess.Popen(camera, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL) as first:
        first.stdin.write(b'cerberus-head 1 timeout 5 limits -170 170 -45 45 speed 90 90 acceleration 600 600 '
                          b'start 0 0\n')
        first.stdin.flush()
        assert select.select([far], [], [], LIMIT)[0], 'the camera was sent nothing'
        first.stdin.close()
        assert run(camera, stdin=subprocess.DEVNULL)[1] == ''
    os.close(near)
    os.close(far)


def messages_of(driver, line, is_one, *words):
    """What the driver sends to a serial line for a line of the pipeline, until is_one(bytes) holds."""
    far, near = pty.openpty()
    device = 'serial:' + os.ttyname(near)
    sent = b''
    with subprocess.Popen([HELPER, driver, f'--device={device}', *words],
                          stdin=subprocess.PIPE, stdout=subprocess.DEVNULL) as helper:
        helper.stdin.write(b'cerberus-head 1 timeout 5 limits -170 170 -45 45 speed 90 90 acceleration 600 600 '
                           b'start 0 0\n')
        end = time.monotonic() + LIMIT
        while not is_one(sent):
            assert time.monotonic() < end, f'{driver} {words} sent {sent.hex()}'
            helper.stdin.write(line)
            helper.stdin.flush()
            if select.select([far], [], [], .05)[0]:
                sent += os.read(far, 4096)
        helper.kill()
    os.close(near)
    os.close(far)


def test_each_axis_of_each_driver_can_be_inverted():
    # To the right and up, by the protocols' own bytes: VISCA 02 right 01 left, 01 up 02 down; Pelco-D 02 right 04 left,
    # 08 up 10 down.
    for words, visca, pelco in (([], '0201', '0a'), (['--invert=pan'], '0101', '0c'), (['--invert=tilt'], '0202', '12'),
                                (['--invert'], '0102', '14')):
        messages_of('visca', b'move at 19 at 18\n', lambda sent: re.search(
            bytes.fromhex('81010601') + b'..' + bytes.fromhex(visca + 'ff'), sent, re.DOTALL), '--no-feedback', *words)
        messages_of('pelco-d', b'move at 19 at 9\n', lambda sent: bytes.fromhex('ff0100' + pelco) in sent, *words)


def test_what_cannot_be_is_named():
    for words, text in ((['--limits=a,b,c,d', '--pan=5'], '--limits=a,b,c,d: four numbers of degrees'),
                        (['--limits=10,60,-20,20', '--pan=5'], 'exclude 0'),
                        (['--seconds=100'], '--seconds is up to 60')):
        status, said = run([TOOL, 'move', 'external', *EXAMPLE, '--yes', *words])
        assert status == 2 and text in said, said
    status, said = run([TOOL, 'calibrate', 'external', *EXAMPLE, '--yes'])
    assert status == 1 and '--horizontal-fov is needed' in said, said


def test_words_of_a_driver_that_cannot_be_are_named():
    turned = ["pan=lines=1,2,3,4", 'device=gpiochip0'], ['pan=channel=0', 'device=pwmchip0']
    for words, text in ((['onvif', 'device=http://h', 'range=-170,170,x,-30,90'], 'range is four numbers'),
                        (['onvif', 'device=http://h', 'range=-170,170,-30,90,'], 'range is four numbers'),
                        (['onvif', 'device=http://h', 'range=-170,170,-30,90'], ''),
                        (['v4l2', 'device=/dev/video9', 'mode=speed', 'pan-speed=60'], 'have no unit'),
                        (['v4l2', 'device=/dev/video9', 'mode=speed', 'pan-speed=60', 'tilt-speed=60'], ''),
                        (['stepper-gpio', *turned[0], 'invert=pan'], ''),
                        (['stepper-gpio', *turned[0], 'invert=no'], 'invert=pan, invert=tilt'),
                        (['servo-pwm', *turned[1], 'invert=pan', 'invert=tilt'], ''),
                        (['servo-pwm', *turned[1], 'invert=no'], 'invert=pan, invert=tilt'),
                        (['servo-pwm', *turned[1], 'frequency=500'], 'frequency=500'),
                        (['servo-pwm', 'device=pwmchip0', 'pan=channel=0 pulse=500,2600', 'frequency=400'],
                         'does not end before the next one')):
        status, said = run([HELPER, '--check', *words])
        if re.search('left out of this build|build was made without', said):
            continue
        assert (status == 0) == (text == '') and text in said, (words, said)


if not HAVE_VISCA:
    print('skipped: one program drives a head, inverted axes (this build has no driver visca)')
    del test_one_program_drives_a_head_and_a_killed_one_frees_it
    del test_a_program_whose_pipeline_has_ended_is_waited_for
    del test_each_axis_of_each_driver_can_be_inverted
all_tests(globals())
