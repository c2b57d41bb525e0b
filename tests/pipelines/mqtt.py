#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""mqttpublish against a real mosquitto on loopback: a broker that is absent at the start, a wrong password, killed and
started again; retained state, tracks, last will, orders for the head. Skipped where mosquitto is not installed."""
import json
import pathlib
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

PATIENCE = 100  # seconds
BROKER = shutil.which('mosquitto') or shutil.which('mosquitto', path='/usr/sbin')
PASSWORDS = shutil.which('mosquitto_passwd')
if not BROKER or not PASSWORDS:
    print('skipped: mosquitto is not installed')
    sys.exit(77)


class Client:
    """A client after MQTT 3.1.1, QoS 0, as far as needed here."""

    def __init__(self, port, user=b'reader', password=b'of the reader'):
        self.line = socket.create_connection(('127.0.0.1', port), PATIENCE)
        text = lambda words: struct.pack('>H', len(words)) + words
        self.packet(0x10, text(b'MQTT') + bytes([4, 0xc2]) + struct.pack('>H', 600) + text(b'test') + text(user) + text(password))
        kind, body = self.read()
        if (kind, body[1]) != (0x20, 0):
            raise PermissionError(body)
        self.packet(0x82, struct.pack('>H', 1) + text(b'#') + b'\0')
        self.retained, self.tracks = {}, []

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
            if kind & 0xf0 == 0x30:
                size, = struct.unpack('>H', body[:2])
                topic, payload = body[2:2 + size].decode(), body[2 + size:]
                if topic.endswith('/track'):
                    self.tracks.append(json.loads(payload))
                else:
                    self.retained[topic] = payload.decode()

    def publish(self, topic, payload, retain=False):
        self.packet(0x31 if retain else 0x30, struct.pack('>H', len(topic)) + topic.encode() + payload.encode())


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


def line(folder, port, password):
    return ['gst-launch-1.0', '-m', 'videotestsrc', 'is-live=true', 'pattern=ball', '!',
            'video/x-raw,format=GRAY8,width=160,height=120,framerate=10/1', '!', 'motiondetect', '!', 'mqttpublish',
            f'port={port}', 'camera-name=front', 'username=camera', f'password-file={folder / password}',
            'discovery-prefix=homeassistant', 'commands=move-to stop arm', 'mode=armed', '!', 'pantiltsink']


def log_has(path, *words):
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        text = path.read_text(errors='replace')
        if all(word in text for word in words):
            return text
        time.sleep(.1)
    raise AssertionError(f'{words} are not in {path.read_text(errors="replace")[-3000:]}')


def main():
    with tempfile.TemporaryDirectory() as name:
        folder, port = pathlib.Path(name), free_port()
        folder.chmod(0o755)  # a broker that drops root's rights reads its files still
        for user, password in (('camera', 'of the camera'), ('reader', 'of the reader')):
            subprocess.run([PASSWORDS, '-b', *([] if (folder / 'users').exists() else ['-c']), folder / 'users', user, password],
                           check=True, capture_output=True)
        (folder / 'users').chmod(0o644)
        (folder / 'mosquitto.conf').write_text(
            f'listener {port} 127.0.0.1\nallow_anonymous false\npassword_file {folder / "users"}\npersistence false\n')
        (folder / 'password').write_text('of the camera\n')
        (folder / 'wrong').write_text('of nobody\n')

        running = []
        try:
            with open(folder / 'log', 'w', encoding='utf-8') as log:
                camera = subprocess.Popen(line(folder, port, 'password'), stdout=log, stderr=log)
            running.append(camera)
            log_has(folder / 'log', 'The MQTT broker cannot be reached; it is tried again')
            broker = start_broker(folder, port)
            running.append(broker)
            with open(folder / 'log-wrong', 'w', encoding='utf-8') as log:
                stranger = subprocess.Popen(line(folder, port, 'wrong'), stdout=log, stderr=log)
            running.append(stranger)
            log_has(folder / 'log-wrong', 'The MQTT broker cannot be reached')
            stranger.kill()

            client = Client(port)
            has = lambda topic, *words: all(word in client.retained.get('cerberus/front/' + topic, '') for word in words)
            client.wait('state', lambda: has('status', 'online') and has('state', '"motion":true') and has('mode', 'armed'))
            client.wait('a track', lambda: any(one['event'] in ('appeared', 'updated') and one['id'] > 0 for one in client.tracks))
            client.wait('discovery', lambda: 'homeassistant/binary_sensor/cerberus_front/motion/config' in client.retained)

            # Orders: what is allowed is carried out, the rest refused with a warning.
            client.publish('cerberus/front/command/home', '')
            client.publish('cerberus/front/command/move-to', 'everywhere')
            log_has(folder / 'log', '"home" is refused: it is not among', '"move-to" is refused: its payload is pan and tilt')
            client.publish('cerberus/front/command/arm', '')
            client.publish('cerberus/front/command/move-to', '12 3')
            log_has(folder / 'log', 'name=(string)move-to, done=(boolean)true', 'name=(string)arm, done=(boolean)false')
            client.wait('the head', lambda: has('pantilt', '"pan":12,"tilt":3,"moving":false'))

            broker.kill()  # -9: and all it knew is lost
            broker.wait()
            broker = start_broker(folder, port)
            running.append(broker)
            client = Client(port)
            client.wait('everything retained, again', lambda: has('status', 'online') and has('state', 'motion')
                        and has('mode', 'armed') and has('pantilt', '"pan":12'))
            camera.kill()
            client.wait('the last will', lambda: has('status', 'offline'))

            with open(folder / 'log', 'w', encoding='utf-8') as log:
                camera = subprocess.Popen(line(folder, port, 'password'), stdout=log, stderr=log)
            running.append(camera)
            client.wait('online', lambda: has('status', 'online'))
            log_has(folder / 'log', 'Setting pipeline to PLAYING')  # an earlier interrupt is an error to gst-launch-1.0
            camera.send_signal(signal.SIGINT)
            client.wait('offline at the end', lambda: has('status', 'offline'))
            assert camera.wait(PATIENCE) == 0
        except BaseException:
            print((folder / 'log').read_text(errors='replace')[-3000:], file=sys.stderr)
            raise
        finally:
            for process in running:
                process.kill()


main()
