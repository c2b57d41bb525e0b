#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a broker retains is true: motion ends where frames stop and where the pipeline ends; a recorder that fails says so, on
the page and in the log, too; a camera, a head and a recorder that leave the configuration take their topics and what Home
Assistant found with them, by SIGHUP and by a restart, and so does all that is left at another broker. Orders whose numbers are none of a head's are refused, with an answer.
Argument: the program cerberusd. Skipped where mosquitto is not installed."""
import json
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from mqtt_client import BROKER, PATIENCE, Client, free_port, robot_head, start_broker
from page_client import Page, Socket

if not BROKER:
    print('skipped: mosquitto is not installed')
    sys.exit(77)

PUBLISHED = '''discovery-prefix = "homeassistant"
commands = ["move-to", "move-by", "follow"]
'''
CAMERA = '''
[[camera]]
name = "NAME"
kind = "test"
width = 160
height = 120
framerate = 10
'''
PARTS = '''
[camera.head]
[camera.recorder]
folder = "recordings"
encoder = "jpegenc"
post-roll = 0
longest-file = 2
'''
camera = lambda name, parts='': CAMERA.replace('NAME', name) + parts


def fresh(port, name):
    """What the broker retains about a camera now."""
    client = Client(port)
    client.wait_for_retained()
    client.line.close()
    return {topic: payload for topic, payload in client.retained.items() if name in topic and payload}


def frames_stop(port):
    """Motion is false where frames stop, true again where they go on, and false when the pipeline ends."""
    import gi
    gi.require_version('Gst', '1.0')
    from gi.repository import Gst
    Gst.init(None)
    pipeline = Gst.parse_launch(
        'videotestsrc is-live=true pattern=ball ! video/x-raw,format=GRAY8,width=160,height=120,framerate=10/1 ! motiondetect ! '
        f'valve name=valve ! mqttpublish port={port} camera-name=valve ! fakesink')
    client = Client(port)
    state = lambda: json.loads(client.retained.get('cerberus/valve/state', 'null'))
    pipeline.set_state(Gst.State.PLAYING)
    try:
        client.wait('motion', lambda: state() and state()['motion'])
        pipeline.get_by_name('valve').set_property('drop', True)
        client.wait('no motion without frames', lambda: state() == {'motion': False, 'objects': 0})
        client.wait('the end of the track', lambda: client.tracks[-1]['event'] == 'left')
        pipeline.get_by_name('valve').set_property('drop', False)
        client.wait('motion again', lambda: state()['motion'])
    finally:
        pipeline.set_state(Gst.State.NULL)
    client.wait('the end', lambda: client.retained['cerberus/valve/status'] == 'offline')
    assert state() == {'motion': False, 'objects': 0}, 'motion lasts longer than the pipeline'


def wait_for_log(path, pattern):
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if found := re.search(pattern, path.read_text(errors='replace')):
            return found
        time.sleep(.05)
    raise AssertionError(f'{pattern} is not in {path.read_text()[-3000:]}')


def page_says(line, question):
    """Reads reports of the page until question(camera front) is true."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        message = line.receive()
        if isinstance(message, tuple):
            line.send(f'ack {message[0]}')
        elif 'number' in message:
            line.send(f'seen {message["number"]}')
            if question(next(one for one in message['cameras'] if one['name'] == 'front')):
                return
    raise AssertionError('in vain')


def recording_fails(page, client, folder, log):
    recording = lambda: json.loads(client.retained.get('cerberus/front/recording', 'null'))
    client.wait('a recording', lambda: recording() == {'recording': True, 'fault': ''})
    shutil.rmtree(folder / 'recordings')
    client.wait('a fault', lambda: recording()['fault'])
    assert not recording()['recording'] and str(folder / 'recordings') in recording()['fault'], recording()
    assert wait_for_log(log, r'cerberusd: front: recording fails: .*recordings.* takes no recordings: No such file')
    line = Socket(page)
    page_says(line, lambda front: 'takes no recordings' in front['recording-fault'] and 'takes no' in front['fault']
              and not front['recording'])
    (folder / 'recordings').mkdir()
    client.wait('a recording, again', lambda: recording() == {'recording': True, 'fault': ''})
    page_says(line, lambda front: front['recording'] and not front['recording-fault'])
    line.close()
    assert wait_for_log(log, 'cerberusd: front: recording works again')


def orders(port, client):
    for order in ('move-to 1e9 0', 'move-to 0 -1e9', 'move-by 361 0', 'move-to nan 0', 'move-to inf 0', 'move-to 1', 'follow 0',
                  'follow -1', 'follow 1e30', 'follow nan'):
        name, numbers = order.split(' ', 1)
        client.retained.pop('cerberus/front/refused', None)
        client.publish(f'cerberus/front/command/{name}', numbers)
        client.wait(f'an answer to {order}', lambda: 'cerberus/front/refused' in client.retained)
        answer = json.loads(client.retained['cerberus/front/refused'])
        assert answer['command'] == name and 'its payload is' in answer['error'], answer
        time.sleep(1)  # ten at once are answered, and then one a second


def main():
    with tempfile.TemporaryDirectory() as name:
        folder, port, page = pathlib.Path(name), free_port(), Page(free_port())
        folder.chmod(0o755)
        (folder / 'mosquitto.conf').write_text(f'listener {port} 127.0.0.1\nallow_anonymous true\npersistence false\n')
        file, log = folder / 'robot.toml', folder / 'log'
        write = lambda *cameras, to=port: file.write_text(robot_head(page.port, to) + PUBLISHED + ''.join(cameras))
        running = []

        def start():
            with open(log, 'w', encoding='utf-8') as to:
                running.append(subprocess.Popen([sys.argv[1], file], stdout=to, stderr=to))
            return running[-1]
        try:
            running.append(start_broker(folder, port))
            frames_stop(port)
            client = Client(port)
            write(camera('front', PARTS), camera('back', PARTS.replace('"recordings"', '"others"')))
            robot = start()
            one_time = wait_for_log(log, r'One-time password .*: ([0-9a-f]{16})')[1]
            assert page.log_in('owner', one_time) == 200
            assert page.ask('POST', '/password', {'user': 'owner', 'password': 'long enough'})[0] == 200
            found = lambda camera, *entities: all(
                client.retained.get(f'homeassistant/{entity.replace("/", f"/cerberus_{camera}/")}/config') for entity in entities)
            client.wait('both cameras and their parts', lambda: all(
                found(one, 'binary_sensor/motion', 'sensor/pan', 'binary_sensor/recording', 'binary_sensor/recording_fault')
                for one in ('front', 'back')))
            orders(port, client)
            recording_fails(page, client, folder, log)

            # A camera and a head that are removed while it runs, beside others that stay.
            write(camera('front', PARTS.replace('[camera.head]', '')))
            robot.send_signal(signal.SIGHUP)
            wait_for_log(log, 'what removed cameras or parts left at the broker is cleared')
            assert fresh(port, 'back') == {}, fresh(port, 'back')
            left = fresh(port, 'front')
            assert not any(word in topic for topic in left for word in ('pantilt', '/pan/', '/tilt/')), left
            assert left['cerberus/front/status'] == 'online' and any('/motion/' in topic for topic in left), left
            robot.send_signal(signal.SIGTERM)
            assert robot.wait(PATIENCE) == 0
            left = fresh(port, 'front')
            assert left['cerberus/front/status'] == 'offline' and '"motion":false' in left['cerberus/front/state'], left
            assert '"recording":false' in left['cerberus/front/recording'], left

            # A camera that has another name at the next start.
            write(camera('gate'))
            robot = start()
            wait_for_log(log, 'what removed cameras or parts left at the broker is cleared')
            assert fresh(port, 'front') == {}, fresh(port, 'front')
            client = Client(port)  # the broker closed the one before: the last one has the same name
            client.wait('the other camera', lambda: found('gate', 'binary_sensor/motion'))

            # Another broker, while it runs and by a restart: nothing stays at the one before.
            other = free_port()
            (folder / 'other').mkdir()
            (folder / 'other' / 'mosquitto.conf').write_text(f'listener {other} 127.0.0.1\nallow_anonymous true\npersistence false\n')
            running.append(start_broker(folder / 'other', other))
            write(camera('gate'), to=other)
            robot.send_signal(signal.SIGHUP)
            cleared = 'what removed cameras or parts left at the broker 127.0.0.1 is cleared'
            wait_for_log(log, cleared)
            assert fresh(port, 'gate') == {}, fresh(port, 'gate')
            client = Client(other)
            client.wait('the camera at the other broker', lambda: found('gate', 'binary_sensor/motion'))
            robot.send_signal(signal.SIGTERM)
            assert robot.wait(PATIENCE) == 0
            write(camera('gate'))
            robot = start()
            wait_for_log(log, cleared)
            assert fresh(other, 'gate') == {}, fresh(other, 'gate')
            client = Client(port)
            client.wait('the camera at the first broker', lambda: found('gate', 'binary_sensor/motion'))
            robot.send_signal(signal.SIGTERM)
            assert robot.wait(PATIENCE) == 0
        except BaseException:
            print(log.read_text(errors='replace')[-5000:] if log.exists() else '', file=sys.stderr)
            raise
        finally:
            for process in running:
                process.kill()


if __name__ == '__main__':
    main()
