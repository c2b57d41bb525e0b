#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""cerberusd says why a network camera gives no picture: the address, what happened, and what to do. The cameras are
servers of RTSP (RFC 2326) here that have no stream."""
import pathlib
import re
import signal
import socket
import socketserver
import subprocess
import sys
import tempfile
import threading
import time

from rtsp_client import requests

PATIENCE = 60  # seconds for what takes one on an idle machine

SDP = 'v=0\r\no=- 1 1 IN IP4 127.0.0.1\r\ns=x\r\nt=0 0\r\n'
VIDEO = 'm=video 0 RTP/AVP 96\r\na=rtpmap:96 {}/90000\r\na=control:v\r\n'
AUDIO = 'm=audio 0 RTP/AVP 8\r\na=rtpmap:8 PCMA/8000\r\na=control:a\r\n'

PATHS = {
    '/h265': ('200 OK', SDP + AUDIO + VIDEO.format('H265')),
    '/h264': ('200 OK', SDP + VIDEO.format('H264')),
    '/mpeg4': ('200 OK', SDP + VIDEO.format('MP4V-ES')),
    '/audio': ('200 OK', SDP + AUDIO),
    '/locked': ('401 Unauthorized', ''),
}


class Camera(socketserver.StreamRequestHandler):
    def handle(self):
        for method, uri, fields in requests(self.rfile):
            status, body, more = '200 OK', '', 'Public: DESCRIBE, SETUP, PLAY\r\n'
            if method == 'DESCRIBE':
                status, body = PATHS.get(re.sub('rtsp://[^/]*', '', uri), ('404 Not Found', ''))
                more = f'Content-Type: application/sdp\r\nContent-Length: {len(body)}\r\n'
                if status.startswith('401'):
                    more = 'WWW-Authenticate: Basic realm="camera"\r\n'
            elif method == 'SETUP':
                status = '461 Unsupported Transport'
            self.wfile.write(f'RTSP/1.0 {status}\r\nCSeq: {fields["CSeq"]}\r\n{more}\r\n{body}'.encode())


class Printer(socketserver.StreamRequestHandler):
    def handle(self):
        self.wfile.write(b'220 this is another protocol\r\n' * 3)


def serve(handler):
    server = socketserver.ThreadingTCPServer(('127.0.0.1', 0), handler)
    server.daemon_threads = True
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return server.server_address[1]


def main():
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        closed = probe.getsockname()[1]
    here, other = f'rtsp://127.0.0.1:{serve(Camera)}', f'rtsp://127.0.0.1:{serve(Printer)}/'
    user = 'user = "anna"\npassword-file = "password"\n'
    recorded = f'record-uri = "{here}/none"\n[camera.recorder]\nfolder = "recordings"\n'
    cameras = {
        'closed': (f'rtsp://127.0.0.1:{closed}/a', '', ['the connection is refused']),
        'nobody': ('rtsp://no-such-host.invalid/a', '', ['unknown host']),
        'locked': (here + '/locked', '', ['it asks for a log-in', '"user"']),
        'wrong': (here + '/locked', user, ['refuses the log-in of "anna"']),
        'path': (here + '/none', '', ['no such path']),
        'codec': (here + '/h265', '', ['it sends H265, and "codec" is "h264"', 'codec = "h265"']),
        'other-codec': (here + '/h264', 'codec = "jpeg"\n', ['it sends H264, and "codec" is "jpeg"', 'codec = "h264"']),
        'strange': (here + '/mpeg4', '', ['it sends MP4V-ES', 'set the camera to H.264']),
        'sound': (here + '/audio', '', ['it sends no video, but PCMA (audio)']),
        'printer': (other, '', ['no RTSP server']),
    }
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / 'password').write_text('not hers\n')
        (folder / 'password').chmod(0o600)
        text = 'state-folder = "state"\n[page]\nenabled = false\n'
        for camera, (uri, more, _) in cameras.items():
            text += f'[[camera]]\nname = "{camera}"\nkind = "rtsp"\nuri = "{uri}"\n{more}'
        text += f'[[camera]]\nname = "second"\nkind = "rtsp"\nuri = "{here}/h264"\n{recorded}'
        (folder / 'robot.toml').write_text(text)
        with open(folder / 'log', 'w+', encoding='utf-8') as log:
            process = subprocess.Popen([sys.argv[1], folder / 'robot.toml'], stdout=log, stderr=subprocess.STDOUT)
            try:
                missing, end = dict(cameras), time.monotonic() + PATIENCE
                while missing and time.monotonic() < end:
                    said = (folder / 'log').read_text()
                    for camera, (uri, _, words) in list(missing.items()):
                        for line in re.findall(rf'cerberusd: {camera}: camera: (.*)', said):
                            if line.startswith(uri + ': ') and all(word in line for word in words):
                                missing.pop(camera, None)
                    time.sleep(.1)
                said = (folder / 'log').read_text()
                assert not missing, f'{list(missing)}: {said}'
                # The first failure of each says all of it, and only once.
                for camera, (uri, _, _) in cameras.items():
                    first = re.findall(rf'cerberusd: {camera}: (.*)', said)[0]
                    assert first.startswith(f'camera: {uri}: '), first
                assert f'second: camera: {here}/none: the camera has no such path' in said or \
                    f'second: camera: {here}/h264: ' in said, said
                assert 'not hers' not in said and 'elayed linking' not in said, said
                process.send_signal(signal.SIGTERM)
                assert process.wait(PATIENCE) == 0
            finally:
                process.kill()


main()
