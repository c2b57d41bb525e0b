#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""mqttpublish against a real mosquitto on loopback, with TLS (where the openssl tool is), passwords and an ACL: a broker
that is absent at the start, a wrong password, a certificate of another CA, killed and started again; retained state, tracks,
last will, orders for the head, 10,000 orders that are refused. With the program cerberusd as argument: the page's list of
cameras, a picture on demand, the newest recording and its deletion. CERBERUS_MESSAGES=10000 publishes so many messages, of
which none may be lost or come in another order. Skipped where mosquitto is not installed."""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

from mqtt_client import BROKER, PATIENCE, Client, free_port, robot_head, start_broker
from page_client import Page, Socket

PASSWORDS = shutil.which('mosquitto_passwd')
OPENSSL = shutil.which('openssl')
ACL = '''user camera
topic write cerberus/front/#
topic write homeassistant/#
topic read cerberus/+/+
topic read cerberus/front/command/+
topic write cerberus/+/command/picture
user reader
topic read #
topic write cerberus/front/command/+
user stranger
topic read #
'''
if not BROKER or not PASSWORDS:
    print('skipped: mosquitto is not installed')
    sys.exit(77)


def make_certificates(folder):
    """An authority, the broker's certificate, and another authority, which signed nothing here."""
    run = lambda *words: subprocess.run([OPENSSL, *words], check=True, capture_output=True, cwd=folder)
    for name in ('ca', 'other'):
        run('req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1', '-nodes', '-days', '2', '-subj',
            f'/CN={name}', '-keyout', f'{name}.key', '-out', f'{name}.pem')
    run('req', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1', '-nodes', '-subj', '/CN=broker', '-keyout',
        'broker.key', '-out', 'broker.csr')
    (folder / 'names').write_text('subjectAltName=IP:127.0.0.1\n')
    run('x509', '-req', '-in', 'broker.csr', '-CA', 'ca.pem', '-CAkey', 'ca.key', '-days', '2', '-extfile', 'names', '-out',
        'broker.pem')
    (folder / 'broker.key').chmod(0o644)


def line(folder, port, password, ca='ca.pem'):
    tls = [f'ca-file={folder / ca}'] if OPENSSL else []
    return ['gst-launch-1.0', '-m', 'videotestsrc', 'is-live=true', 'pattern=ball', '!',
            'video/x-raw,format=GRAY8,width=160,height=120,framerate=10/1', '!', 'motiondetect', '!', 'mqttpublish',
            f'port={port}', 'camera-name=front', 'username=camera', f'password-file={folder / password}', *tls,
            'discovery-prefix=homeassistant', 'commands=move-to stop arm', 'mode=armed', '!', 'pantiltsink']


ROBOT = '''username = "camera"
password-file = "password"
CA
commands = ["picture"]
list-cameras = true
[[camera]]
name = "front"
kind = "test"
width = 160
height = 120
framerate = 10
[camera.recorder]
folder = "recordings"
encoder = "jpegenc"
post-roll = 0
longest-file = 2
'''


def robot(program, folder, port, ca, client):
    """The page of a robot lists the cameras of the broker and shows a picture of one; a deleted event leaves it, too."""
    page = Page(free_port())
    (folder / 'password').chmod(0o600)
    (folder / 'robot.toml').write_text(
        robot_head(page.port, port) + ROBOT.replace('CA', f'ca-file = "{ca}"' if ca else ''))
    with open(folder / 'log', 'w', encoding='utf-8') as log:
        process = subprocess.Popen([program, folder / 'robot.toml'], stdout=log, stderr=log)
    try:
        one_time = re.search(r'One-time password .*: ([0-9a-f]{16})', log_has(folder / 'log', 'One-time password', 'mode armed'))
        assert page.log_in('owner', one_time[1]) == 200
        assert page.ask('POST', '/password', {'user': 'owner', 'password': 'long enough'})[0] == 200
        client.wait('a recording', lambda: '"open":true' in client.retained.get('cerberus/front/event', ''))
        line, end, seen = Socket(page), time.monotonic() + PATIENCE, None
        while not (seen and seen['picture']) and time.monotonic() < end:
            message = line.receive()
            if isinstance(message, tuple):
                line.send(f'ack {message[0]}')
            elif 'number' in message:
                line.send(f'seen {message["number"]}')
                seen = next((one for one in message['fleet'] if one['name'] == 'front' and one['status'] == 'online'
                             and one['event']), None)
                if seen and not seen['picture']:
                    assert page.ask('POST', '/picture', {'camera': 'front'})[0] == 200
        assert seen and seen['picture'] and seen['mode'] == 'armed', seen
        assert page.ask('GET', '/picture/front')[2][:2] == b'\xff\xd8'
        assert 'owner@127.0.0.1 asks for a picture of front' in (folder / 'log').read_text()
        line.send('mode disarmed')
        line.close()
        client.wait('the newest recording', lambda: '"open":false' in client.retained.get('cerberus/front/event', ''))
        events = lambda: json.loads(page.ask('GET', '/events?camera=front')[2])
        while any(event['open'] for event in events()):
            assert time.monotonic() < end
            time.sleep(.1)
        for event in events():
            assert page.ask('POST', '/delete', {'camera': 'front', 'id': event['id']})[0] == 200
        client.wait('no event is left', lambda: client.retained.get('cerberus/front/event') == '')
        process.send_signal(signal.SIGTERM)
        assert process.wait(PATIENCE) == 0
    finally:
        process.kill()


def outbound(folder, port, ca, count):
    """Numbers that mqttpublish publishes as fast as it takes them, while it reports what a camera sees."""
    import gi
    gi.require_version('Gst', '1.0')
    from gi.repository import GLib, Gst
    Gst.init(None)
    words = line(folder, port, 'password')[2:]
    words.insert(words.index('mqttpublish') + 1, 'name=mqtt')
    pipeline = Gst.parse_launchv(words)
    mqtt, refused = pipeline.get_by_name('mqtt'), [0]

    def publish():
        for number in range(count):
            while not mqtt.emit('publish', 'count', GLib.Bytes.new(str(number).encode()), False):
                refused[0] += 1
                time.sleep(.005)
    pipeline.set_state(Gst.State.PLAYING)
    try:
        client = Client(port, ca)
        client.wait('online', lambda: client.retained.get('cerberus/front/status') == 'online')
        begin = time.monotonic()
        threading.Thread(target=publish, daemon=True).start()
        client.wait('every message', lambda: client.counted and client.counted[-1] == count - 1)
        print(f'{count} messages in {time.monotonic() - begin:.1f} s; {count - len(client.counted)} are missing; refused and '
              f'given again: {refused[0]}')
        assert client.counted == list(range(count))
    finally:
        pipeline.set_state(Gst.State.NULL)
    client.wait('offline', lambda: client.retained.get('cerberus/front/status') == 'offline')


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
        for user, password in ((user, f'of the {user}') for user in ('camera', 'reader', 'stranger')):
            subprocess.run([PASSWORDS, '-b', *([] if (folder / 'users').exists() else ['-c']), folder / 'users', user, password],
                           check=True, capture_output=True)
        (folder / 'users').chmod(0o644)
        (folder / 'acl').write_text(ACL)
        (folder / 'acl').chmod(0o644)
        tls, ca = '', None
        if OPENSSL:
            make_certificates(folder)
            tls = ''.join(f'{key} {folder / file}\n' for key, file in (
                ('cafile', 'ca.pem'), ('certfile', 'broker.pem'), ('keyfile', 'broker.key')))
            ca = folder / 'ca.pem'
        (folder / 'mosquitto.conf').write_text(
            f'listener {port} 127.0.0.1\n{tls}allow_anonymous false\npassword_file {folder / "users"}\n'
            f'acl_file {folder / "acl"}\npersistence false\nmax_queued_messages 100000\n')
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
            if OPENSSL:
                with open(folder / 'log-other', 'w', encoding='utf-8') as log:
                    stranger = subprocess.Popen(line(folder, port, 'password', 'other.pem'), stdout=log, stderr=log)
                running.append(stranger)
                log_has(folder / 'log-other', 'The MQTT broker cannot be reached')
                stranger.kill()

            client = Client(port, ca)
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

            # The broker's ACL: another user's orders do not arrive, and no camera writes in another one's name.
            for user, topic in (('stranger', 'cerberus/front/command/arm'), ('camera', 'cerberus/back/status')):
                other = Client(port, ca, user, subscribe=False)
                other.publish(topic, 'online', retain=user == 'camera')
                other.sync()
                other.line.close()
            # A flood of refused orders is reported in part, and what is allowed is carried out after it.
            flood = Client(port, ca, 'reader', subscribe=False)
            for _ in range(10000):
                flood.publish('cerberus/front/command/home', '')
            flood.sync()
            flood.publish('cerberus/front/command/stop', '')
            flood.sync()
            flood.line.close()
            text = log_has(folder / 'log', 'name=(string)stop, done=(boolean)true')
            assert text.count('"home" is refused') < 1000 and text.count('name=(string)arm') == 1
            assert not any(topic.startswith('cerberus/back') for topic in client.retained)

            broker.kill()  # -9: and all it knew is lost
            broker.wait()
            broker = start_broker(folder, port)
            running.append(broker)
            client = Client(port, ca)
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
            if 'CERBERUS_MESSAGES' in os.environ:
                outbound(folder, port, ca, int(os.environ['CERBERUS_MESSAGES']))
            if len(sys.argv) > 1:
                robot(sys.argv[1], folder, port, ca, client)
        except BaseException:
            print((folder / 'log').read_text(errors='replace')[-3000:], file=sys.stderr)
            raise
        finally:
            for process in running:
                process.kill()


main()
