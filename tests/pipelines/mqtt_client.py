# SPDX-License-Identifier: LGPL-2.1-or-later
"""A mosquitto on loopback, and a client that is not the one under test."""
import json
import shutil
import socket
import ssl
import struct
import subprocess
import time

PATIENCE = 100  # seconds
BROKER = shutil.which('mosquitto') or shutil.which('mosquitto', path='/usr/sbin')


class Client:
    """A client after MQTT 3.1.1, QoS 0, as far as needed here."""

    def __init__(self, port, ca=None, user='reader', subscribe=True):
        self.line = socket.create_connection(('127.0.0.1', port), PATIENCE)
        if ca:
            self.line = ssl.create_default_context(cafile=ca).wrap_socket(self.line, server_hostname='127.0.0.1')
        text = lambda words: struct.pack('>H', len(words)) + words
        self.packet(0x10, text(b'MQTT') + bytes([4, 0xc2]) + struct.pack('>H', 600)
                    + text(b'test of ' + user.encode()) + text(user.encode()) + text(b'of the ' + user.encode()))
        kind, body = self.read()
        if (kind, body[1]) != (0x20, 0):
            raise PermissionError(body)
        if subscribe:
            self.packet(0x82, struct.pack('>H', 1) + text(b'#') + b'\0')
        self.retained, self.tracks, self.counted, self.answered = {}, [], [], False

    def packet(self, kind, body):
        size, length = b'', len(body)
        while True:
            size += bytes([length % 128 | (128 if length >= 128 else 0)])
            length //= 128
            if not length:
                break
        self.line.sendall(bytes([kind]) + size + body)

    def take(self, size):
        data = b''
        while len(data) < size:
            more = self.line.recv(size - len(data))
            if not more:
                raise ConnectionError('closed')
            data += more
        return data

    def read(self):
        kind, size, shift = self.take(1)[0], 0, 0
        while True:
            byte = self.take(1)[0]
            size |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return kind, self.take(size)

    def wait(self, what, question):
        """Reads until question() is true."""
        end = time.monotonic() + PATIENCE
        while not question():
            assert time.monotonic() < end, f'in vain: {what}; {self.retained}'
            kind, body = self.read()
            self.answered = self.answered or kind == 0xd0
            if kind & 0xf0 == 0x30:
                size, = struct.unpack('>H', body[:2])
                topic, payload = body[2:2 + size].decode(), body[2 + size:]
                if topic.endswith('/track'):
                    self.tracks.append(json.loads(payload))
                elif topic.endswith('/count'):
                    self.counted.append(int(payload))
                else:
                    self.retained[topic] = payload.decode(errors='replace')

    def wait_for_retained(self):
        """Reads everything that was sent before the broker's next answer."""
        self.answered = False
        self.packet(0xc0, b'')
        self.wait('an answer', lambda: self.answered)

    def publish(self, topic, payload, retain=False):
        self.packet(0x31 if retain else 0x30, struct.pack('>H', len(topic)) + topic.encode() + payload.encode())

    def sync(self):
        """Returns when the broker has taken everything that was sent."""
        self.packet(0xc0, b'')
        while self.read()[0] != 0xd0:
            pass


HEAD = '''
state-folder = "state"
[page]
port = PAGE
[mqtt]
host = "127.0.0.1"
port = BROKER
'''


def robot_head(page, broker):
    """The first lines of a robot's configuration, with these ports; its [mqtt] goes on."""
    return HEAD.replace('PAGE', str(page)).replace('BROKER', str(broker))


def free_port():
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        return probe.getsockname()[1]


def start_broker(folder, port):
    process = subprocess.Popen([BROKER, '-c', folder / 'mosquitto.conf'], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        try:
            socket.create_connection(('127.0.0.1', port), 1).close()
            return process
        except OSError:
            time.sleep(.05)
    raise AssertionError('the broker does not start')
