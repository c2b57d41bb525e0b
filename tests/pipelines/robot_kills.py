#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""cerberusd is killed (SIGKILL) at random moments and started again by the rules of its unit: its head stops, the mode stays,
recordings that were finished stay as they were, and those that were not are put right. CERBERUS_KILLS is the number of
kills (2); where it is set, the head must stop within 500 ms and the service be back within 5 s."""
import configparser
import os
import pathlib
import queue
import random
import signal
import socket
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time

PATIENCE = 100  # seconds for what takes one on an idle machine
MOST_STOP, MOST_AWAY = .5, 5  # seconds; of wall-clock time, so on request only
CERBERUSD, UNIT = sys.argv[1:3]
KILLS = int(os.environ.get('CERBERUS_KILLS', '2'))
IS_MEASURED = 'CERBERUS_KILLS' in os.environ
COLUMNS = 'file, camera, begin, "end", size'

CONFIGURATION = '''
state-folder = "state"
[page]
enabled = false
[[camera]]
name = "front"
kind = "test"
width = 160
height = 120
framerate = 10
[camera.head]
driver = "external"
command = "python3 FOLDER/helper.py FOLDER/head"
[camera.recorder]
folder = "recordings"
encoder = "jpegenc"
longest-file = 1
'''

# A head that writes down when it moves and when it stops, as docs/manual/head-protocol.md asks for.
HELPER = '''
import sys, time
log, moves = open(sys.argv[1], 'a', buffering=1), False
sys.stdin.readline()
print('ready 1 position velocity rate 50', flush=True)
log.write(f'{time.monotonic()} open\\n')
for line in sys.stdin:
    words = line.split()
    now_moves = any(word in ('to', 'at') for word in words) if words[0] == 'move' else moves and words[0] not in ('stop', 'quit')
    if now_moves != moves:
        moves = now_moves
        log.write(f'{time.monotonic()} ' + ('moves' if moves else 'stops') + '\\n')
log.write(f'{time.monotonic()} ended\\n')
'''


def wait_until(condition, what):
    end = time.monotonic() + PATIENCE
    while not (result := condition()):
        assert time.monotonic() < end, f'{what} did not happen'
        time.sleep(.01)
    return result


class Supervisor:
    def __init__(self, folder):
        self.folder, self.process = folder, None
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(str(folder / 'notify'))
        self.reports = queue.Queue()
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        while True:
            self.reports.put(self.socket.recv(4096).decode())

    def start(self):
        while not self.reports.empty():
            self.reports.get()
        with open(self.folder / 'log', 'a', encoding='utf-8') as log:
            self.process = subprocess.Popen([CERBERUSD, self.folder / 'robot.toml'], stderr=log,
                                            env=os.environ | {'NOTIFY_SOCKET': str(self.folder / 'notify')})
        self.wait_for('READY=1')

    def wait_for(self, *words):
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            try:
                report = self.reports.get(timeout=1)
            except queue.Empty:
                assert self.process.poll() is None, (self.folder / 'log').read_text()
                continue
            if all(word in report for word in words):
                return
        raise AssertionError(f'no report with {words}: ' + (self.folder / 'log').read_text())


def rows(folder, condition):
    index = folder / 'recordings' / 'recordings.sqlite'
    if not index.exists():
        return set()
    try:
        with sqlite3.connect(f'file:{index}?mode=ro', uri=True) as database:
            return set(database.execute(f'select {COLUMNS} from recordings where {condition}'))
    except sqlite3.OperationalError:  # its table is being made
        return set()


def head_log(folder):
    path = folder / 'head'
    return [line.split() for line in path.read_text().splitlines()] if path.exists() else []


def main(folder):
    unit = configparser.ConfigParser(strict=False, interpolation=None)
    unit.read(UNIT)
    assert unit['Service']['Restart'] == 'always'
    pause = float(unit['Service']['RestartSec'])
    (folder / 'robot.toml').write_text(CONFIGURATION.replace('FOLDER', str(folder)))
    (folder / 'helper.py').write_text(HELPER)
    seed = random.randrange(1 << 32)
    print(f'seed {seed}')
    chance = random.Random(seed)
    supervisor = Supervisor(folder)
    stops, aways, moving = [], [], 0
    mode = 'armed'
    try:
        supervisor.start()
        for number in range(KILLS):
            opened = wait_until(lambda: sum(word == 'open' for _, word in head_log(folder)) > number, 'the head opens')
            assert opened
            # From the first moments to the middle of a recording.
            time.sleep(chance.uniform(0, 3))
            finished = rows(folder, 'not open')
            killed = time.monotonic()
            supervisor.process.send_signal(signal.SIGKILL)
            supervisor.process.wait()
            log = wait_until(lambda: (found := head_log(folder)) and found[-1][1] == 'ended' and found, 'the end of the head')
            was_moving = [word for at, word in log if float(at) < killed and word != 'open'][-1:] == ['moves']
            moving += was_moving
            stops.append(float(log[-1][0]) - killed)
            assert finished <= rows(folder, 'true'), 'a recording that was finished changed'
            state = folder / 'state' / 'mode'
            assert number == 0 or state.read_text() == f'{mode} 1763863200\n', 'the mode changed'
            mode = chance.choice(('armed', 'armed', 'disarmed'))
            state.write_text(f'{mode} 1763863200\n')
            time.sleep(pause)
            supervisor.start()
            aways.append(time.monotonic() - killed)
            supervisor.wait_for(f'STATUS={mode}, front')
            assert finished <= rows(folder, 'not open'), 'a recording that was finished changed'
        supervisor.process.send_signal(signal.SIGTERM)
        assert supervisor.process.wait(PATIENCE) == 0
    finally:
        if supervisor.process:
            supervisor.process.kill()
            supervisor.process.wait()
    assert not rows(folder, 'open'), 'a recording is open that nothing writes'
    for file, *_, size in rows(folder, 'true'):
        assert 0 < (folder / 'recordings' / file).stat().st_size <= size, file
    with sqlite3.connect(folder / 'recordings' / 'recordings.sqlite') as database:
        assert database.execute('pragma integrity_check').fetchone() == ('ok',)
    print(f'{KILLS} kills, {moving} while the head moved: stopped within {max(stops):.3f} s, back within {max(aways):.2f} s, '
          f'{len(rows(folder, "true"))} recordings')
    if IS_MEASURED:
        assert max(stops) <= MOST_STOP and max(aways) <= MOST_AWAY
        assert moving, 'the head never moved: nothing is measured'


with tempfile.TemporaryDirectory() as name:
    main(pathlib.Path(name))
