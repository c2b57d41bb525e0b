#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""cerberusd as a service manager sees it: ready, fed by frames, a camera that fails beside one that works, stopped by
SIGTERM with complete recordings; a network camera whose password changes; and in privacy mode, which survives a restart,
without any."""
import base64
import os
import pathlib
import queue
import re
import signal
import socket
import socketserver
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time

from rtsp_client import requests

PATIENCE = 100  # seconds for what takes one on an idle machine
CERBERUSD = sys.argv[1]

CONFIGURATION = '''
state-folder = "state"
[page]
enabled = false
[[camera]]
name = "good"
kind = "test"
width = 160
height = 120
framerate = 10
[camera.head]
[camera.recorder]
folder = "recordings"
encoder = "jpegenc"
[[camera]]
name = "broken"
kind = "file"
file = "no-video.avi"
'''


LOCKED = '''
[[camera]]
name = "locked"
kind = "rtsp"
uri = "rtsp://127.0.0.1:PORT/main"
user = "anna"
password-file = "password"
codec = "jpeg"
'''


# The same camera with another threshold, and another one in place of the broken one.
RELOADED = CONFIGURATION.split('[[camera]]\nname = "broken"')[0].replace('[camera.head]', """[camera.detection]
minimum-area = 30
[camera.head]
turn-speed = 15""") + '''
[[camera]]
name = "second"
kind = "test"
'''


def free_port():
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        return probe.getsockname()[1]


class LockedCamera(socketserver.StreamRequestHandler):
    """A camera that asks for a log-in (RFC 2326, RFC 7617), keeps it in mind, and has no stream."""
    log_ins = []

    def handle(self):
        for _, _, fields in requests(self.rfile):
            answer = '401 Unauthorized\r\nWWW-Authenticate: Basic realm="camera"'
            if 'Authorization' in fields:
                LockedCamera.log_ins.append(base64.b64decode(fields['Authorization'].split()[1]).decode())
                answer = '404 Not Found'
            self.wfile.write(f'RTSP/1.0 {answer}\r\nCSeq: {fields["CSeq"]}\r\n\r\n'.encode())


class Service:
    def __init__(self, folder):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        path = str(folder / 'notify')
        if os.path.exists(path):
            os.unlink(path)
        self.socket.bind(path)
        # Read at once: a full socket would hold the service up.
        self.reports = queue.Queue()
        threading.Thread(target=self.read, daemon=True).start()
        self.log = open(folder / 'log', 'w+', encoding='utf-8')
        self.process = subprocess.Popen([CERBERUSD, folder / 'robot.toml'], stderr=self.log,
                                        env=os.environ | {'NOTIFY_SOCKET': path})

    def read(self):
        while True:
            self.reports.put(self.socket.recv(4096).decode())

    def wait_for(self, *words):
        """Waits for a report that has all the words."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            try:
                report = self.reports.get(timeout=1)
            except queue.Empty:
                continue
            if all(word in report for word in words):
                return report
        raise AssertionError(f'no report with {words}')

    def reload(self):
        """Returns what is logged until the service is ready again."""
        before = len(pathlib.Path(self.log.name).read_text())
        self.process.send_signal(signal.SIGHUP)
        self.wait_for('RELOADING=1', 'MONOTONIC_USEC=')
        self.wait_for('READY=1')
        return pathlib.Path(self.log.name).read_text()[before:]

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        code = self.process.wait(PATIENCE)
        self.log.seek(0)
        return code, self.log.read()


def rows(folder):
    index = folder / 'recordings' / 'recordings.sqlite'
    if not index.exists():
        return []
    try:
        with sqlite3.connect(f'file:{index}?mode=ro', uri=True) as database:
            return list(database.execute('select file, open, size from recordings'))
    except sqlite3.OperationalError:  # its table is being made
        return []


def wait_until(what, question):
    end = time.monotonic() + PATIENCE
    while not question():
        assert time.monotonic() < end, f'in vain: {what}'
        time.sleep(.05)


def held_up(service, folder):
    """After a machine stood still the camera does not work off the frames of that time: it drops them, and says so."""
    (folder / 'robot.toml').write_text(RELOADED)
    service.reload()
    wait_until('frames', lambda: 'dropped' in pathlib.Path(service.log.name).read_text() or service.wait_for('WATCHDOG=1'))
    before = len(pathlib.Path(service.log.name).read_text())
    service.process.send_signal(signal.SIGSTOP)
    time.sleep(3)
    service.process.send_signal(signal.SIGCONT)
    wait_until('late frames are dropped', lambda: re.search(
        r'cerberusd: good: \d+ frames were dropped that came late', pathlib.Path(service.log.name).read_text()[before:]))


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        server = socketserver.ThreadingTCPServer(('127.0.0.1', 0), LockedCamera)
        server.daemon_threads = True
        threading.Thread(target=server.serve_forever, daemon=True).start()
        (folder / 'robot.toml').write_text(CONFIGURATION + LOCKED.replace('PORT', str(server.server_address[1])))
        (folder / 'password').write_text('the first\n')
        (folder / 'password').chmod(0o600)
        (folder / 'no-video.avi').write_text('this is no video\n')

        service = Service(folder)
        try:
            service.wait_for('READY=1')
            service.wait_for('STATUS=armed', 'good running', 'broken waiting')
            service.wait_for('WATCHDOG=1')
            wait_until('a recording', lambda: rows(folder))
            wait_until('the first password', lambda: 'anna:the first' in LockedCamera.log_ins)
            (folder / 'password').write_text('the second\n')
            log = service.reload()
            assert 'locked: changed, its pipeline starts anew\n' in log and 'good: ' not in log, log
            wait_until('the second password', lambda: 'anna:the second' in LockedCamera.log_ins)
            (folder / 'robot.toml').write_text(RELOADED.replace('minimum-area', 'minimal-area'))
            log = service.reload()
            assert 'is "minimum-area" meant?' in log and 'the robot goes on as before' in log, log
            service.wait_for('STATUS=', 'good running', 'broken', 'configuration refused')
            (folder / 'robot.toml').write_text(RELOADED)
            log = service.reload()
            for line in ('good: changed while it runs', 'broken: removed', 'second: new', 'the configuration is taken'):
                assert f'cerberusd: {line}\n' in log, f'{line} is not in {log}'
            service.wait_for('STATUS=armed, good running, second running')
            # A rate is part of the pipeline.
            (folder / 'robot.toml').write_text(RELOADED.replace('framerate = 10', 'framerate = 15'))
            log = service.reload()
            assert 'good: changed, its pipeline starts anew\n' in log and 'second: ' not in log.split('taken')[0], log
            service.wait_for('WATCHDOG=1')
            # An encoder that is not installed is no reason to be blind.
            if subprocess.run(['gst-inspect-1.0', '--exists', 'nvh264enc'], check=False).returncode != 0:
                (folder / 'robot.toml').write_text(f'{RELOADED}[rtsp]\nport = {free_port()}\nencoder = "nvh264enc"\n')
                log = service.reload()
                assert 'good: RTSP: the encoder nvh264enc is not installed' in log or 'has no RTSP server' in log, log
                service.wait_for('WATCHDOG=1')
            held_up(service, folder)
            code, log = service.stop()
        finally:
            service.process.kill()
        assert code == 0, f'exit code {code}: {log}'
        assert 'a part of GStreamer is missing' not in log and 'the first' not in log and 'the second' not in log, log
        assert 'broken: camera: ' in log and 'it is tried again in 1 s' in log, log
        recorded = rows(folder)
        for file, is_open, size in recorded:
            assert not is_open and (folder / 'recordings' / file).stat().st_size > 0 and size > 0, recorded

        for mode in ('privacy 1763863200\n', 'damaged'):
            (folder / 'state' / 'mode').write_text(mode)
            service = Service(folder)
            try:
                service.wait_for('READY=1')
                service.wait_for('STATUS=privacy, good off, second off')
                service.wait_for('WATCHDOG=1')
                code, log = service.stop()
            finally:
                service.process.kill()
            assert code == 0 and 'mode privacy' in log, log
            assert rows(folder) == recorded, 'privacy mode recorded'
            assert (folder / 'state' / 'mode').read_text().startswith('privacy '), 'a damaged mode file is not replaced'


main()
