#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""cerberusd --check refuses each file with which a part of the robot would not start, by the line, the key and the value;
what this machine lacks is said, too. A file with such a mistake is refused at the start and at SIGHUP as well."""
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

from support import without_verify

CERBERUSD, HAS = os.path.abspath(sys.argv[1]), sys.argv[2:]
PATIENCE = 60  # seconds for what takes one on an idle machine
FRONT = '[[camera]]\nname = "front"\nkind = "test"\n'  # lines 1 to 3
BACK = '[[camera]]\nname = "back"\nkind = "test"\n'
PATROL = '[[camera]]\nname = "front"\nkind = "patrol"\n'
VISCA = '[camera.head]\ndriver = "visca"\ndevice = "serial:/dev/ttyS9"\n'
GPIO = '[camera.sensors]\ndriver = "gpio"\nlines = "1,2,3"\n'
STEPPER = '[camera.head]\ndriver = "stepper-gpio"\ndevice = "{chip}"\ndevice-options = "pan=\'lines={lines}\'"\n'
SERVO = '[camera.head]\ndriver = "servo-pwm"\ndevice = "pwmchip0"\ndevice-options = "{options}"\n'
PAGE = '[page]\nenabled = false\n'

# A file, the line of its mistake, and words of the message.
MISTAKES = [
    # The seven that were found first.
    (FRONT + '[camera.detection]\nzones = "1,2"\n', 5, ['"zones" of [camera.detection]', '1,2']),
    (FRONT + '[camera.sensors]\ndriver = "gpio"\n', 4, ['lines', 'one GPIO line for each of the 3 sensors']),
    (FRONT + '[camera.sensors]\ndriver = "gpio"\nlines = "17,27,22"\nbearings = "0,90"\n', 6,
     ['"lines" of [camera.sensors]', '17,27,22', 'each of the 2 sensors']),
    (FRONT + '[webhook]\nurl = "https://h/"\nsecret-file = "short"\n', 6, ['secret-file', 'at least 16']),
    (FRONT + '[page]\nport = 8554\n[rtsp]\n', 5, ['"port"', '8554', '[rtsp]']),
    ('[[camera]]\nname = "gate"\nkind = "rtsp"\nuri = "rtsp://h/a"\nrecord-uri = "rtsp://h/b"\n', 5,
     ['record-uri', '[camera.recorder]']),
    (FRONT + VISCA + BACK + VISCA, 12, ['"device"', 'serial:/dev/ttyS9', 'front']),
    (FRONT + '[camera.persons]\nrate = 4\nmodel = "./short"\n', 6, ['"model" of [camera.persons]', 'short']),
    (FRONT + '[camera.persons]\nmodel = "no-such-model.weights"\n', 5, ['"model" of [camera.persons]', 'no-such-model.weights']),
    (FRONT + '[camera.persons]\nmodel = "./no-such-model.weights"\n', 5, ['"model"', 'no-such-model.weights', 'No such file']),
    # Others of their kinds.
    (FRONT + '[camera.detection]\nzones = "door: in 0,0 1,0"\n', 5, ['zones']),
    (FRONT + '[camera.fusion]\nrules-file = "short"\n', 5, ['rules-file', 'short']),
    (FRONT + '[camera.sensors]\ndriver = "gpio"\nlines = "17,17,22"\n', 6, ['lines', '17', 'twice']),
    (FRONT + '[camera.sensors]\ndriver = "gpio"\nlines = "17,27,22"\nleds-red = "5,6,17"\n', 7, ['leds-red', '17', 'twice']),
    (FRONT + '[camera.sensors]\ndriver = "gpio"\nlines = "1,2,3"\n' + BACK +
     '[camera.sensors]\ndriver = "gpio"\nlines = "4,5,3"\n', 12, ['lines', '"3"', 'front']),
    (FRONT + '[camera.sensors]\ndriver = "gpio"\nlines = "1,2,3"\nbearings = "0,left,90"\n', 7, ['bearings', 'left']),
    (FRONT + '[camera.sensors]\ndriver = "evdev"\ndevice = "/dev/input/event3"\ncodes = "BTN_0,BTN_1,key:nine"\n', 7,
     ['codes', 'key:nine']),
    (FRONT + '[camera.sensors]\ndriver = "evdev"\ndevice = "/dev/input/event3"\ncodes = "BTN_0"\n', 7, ['codes', '3 sensors']),
    (FRONT + '[camera.sensors]\ndriver = "iio"\niio-device = "ads1015"\nchannels = "0,1"\n', 7, ['channels', '3 sensors']),
    (FRONT + '[camera.sensors]\ndriver = "external"\n', 4, ['command', 'device']),
    (FRONT + '[camera.sensors]\ndriver = "external"\ncommand = "cat"\ndevice-options = "bauds=3"\n', 7,
     ['device-options', 'bauds']),
    (FRONT + '[camera.sensors]\ndriver = "external"\ncommand = "no-such-program --fast"\n', 6,
     ['command', 'no-such-program']),
    (FRONT + '[camera.sensors]\ndriver = "replay"\n', 4, ['location']),
    (FRONT + '[camera.sensors]\ndriver = "replay"\nlocation = "short"\n', 6, ['location', 'short']),
    (FRONT + '[camera.sensors]\ndriver = "scripted"\nscript = "soon: 1,0,0"\n', 6, ['script', 'soon']),
    (FRONT + '[camera.head]\ndriver = "external"\ncommand = "no-such-program"\n', 6, ['command', 'no-such-program']),
    (FRONT + '[camera.head]\nzoom-table = "one"\n', 5, ['zoom-table', 'one']),
    (FRONT + '[camera.head]\ncalibration = "short"\n', 5, ['calibration', 'short']),
    (FRONT + '[camera.head]\nbase-gyro = "imu rol"\n', 5, ['base-gyro', 'rol']),
    (FRONT + '[camera.head]\ndriver = "visca"\ndevice = "serial:/dev/ttyS9"\ndevice-options = "address=9"\n', 7,
     ['device-options', 'address=9']),
    (FRONT + '[camera.head]\ndriver = "pelco-d"\ndevice = "serial:/dev/ttyS9"\ndevice-options = "colour=blue"\n', 7,
     ['device-options', 'colour']),
    (FRONT + '[camera.head]\ndriver = "pelco-d"\ndevice = "serial:/dev/ttyS9"\ndevice-options = "pan-speed=0"\n', 7,
     ['device-options', 'pan-speed', 'more than 0']),
    (FRONT + '[camera.head]\ndriver = "visca"\ndevice = "serial:/dev/ttyS9"\ndevice-options = "baud=12345"\n', 7,
     ['device-options', 'baud rate 12345']),
    (FRONT + '[camera.head]\ndriver = "visca"\ndevice = "serial:/dev/ttyS9"\ndevice-options = "emergency-stop=17"\n', 7,
     ['device-options', 'emergency-stop=17']),
    (FRONT + '[camera.head]\ndriver = "visca"\ndevice = "serial:/dev/ttyS9"\ndevice-options = "emergency-stop=:17"\n', 7,
     ['device-options', 'emergency-stop=:17']),
    (FRONT + '[camera.head]\ndriver = "visca"\ndevice = "serial:/dev/ttyS9"\ndevice-options = "emergency-stop=gpiochip0:"\n', 7,
     ['device-options', 'emergency-stop=gpiochip0:']),
    (FRONT + '[camera.recorder]\nfolder = "r"\nfile-name = "../%H"\n', 6, ['file-name', '../%H']),
    (FRONT + '[camera.recorder]\nfolder = "r"\ntrigger-zones = "1,2"\n', 6, ['trigger-zones', '1,2']),
    ('[[camera]]\nname = "a"\nkind = "v4l2"\ndevice = "/dev/video7"\n[[camera]]\nname = "b"\nkind = "v4l2"\n'
     'device = "/dev/../dev/video7"\n', 8, ['device', '/dev/video7', '"a"']),
    ('[[camera]]\nname = "a"\nkind = "libcamera"\n[[camera]]\nname = "b"\nkind = "libcamera"\n', 4, ['device', '"a"']),
    ('[[camera]]\nname = "gate"\nkind = "rtsp"\nuri = "rtsp://h:99999/a"\n', 4, ['uri', 'rtsp://h:99999/a']),
    ('[[camera]]\nname = "gate"\nkind = "rtsp"\nuri = "rtsp://"\n', 4, ['uri', 'rtsp://']),
    ('[[camera]]\nname = "gate"\nkind = "rtsp"\nuri = "rtsp://a host/"\n', 4, ['uri', 'a host']),
    (FRONT + '[webhook]\nurl = "https://h:port/"\nsecret-file = "secret"\n', 5, ['url', 'https://h:port/']),
    (FRONT + '[webhook]\nurl = "https://h/"\nsecret-file = "secret"\nca-file = "short"\n', 7, ['ca-file', 'short']),
    (FRONT + '[page]\ntls = true\ncertificate = "short"\ncertificate-key = "secret"\n', 6, ['certificate', 'short']),
    (FRONT + PAGE + '[rtsp]\ntls = true\ncertificate = "short"\ncertificate-key = "secret"\n', 8, ['certificate', 'short']),
    (FRONT + '[page]\nport = 9000\nlisten = "127.0.0.1"\n[rtsp]\nport = 9000\nlisten = "0.0.0.0"\nanyone = true\n', 8,
     ['port', '9000', '[page]']),
    (FRONT + '[mqtt]\nhost = "h"\nusername = "u"\npassword-file = "empty"\n', 7, ['password-file', 'empty']),
    (FRONT + '[mqtt]\nhost = "h"\ntopic-prefix = "homeassistant"\ndiscovery-prefix = "homeassistant"\n', 7,
     ['discovery-prefix', 'homeassistant', 'topic-prefix']),
    (FRONT + '[mqtt]\nhost = "h"\ndiscovery-prefix = "a/+"\n', 6, ['discovery-prefix', 'a/+']),
    (FRONT + '[mqtt]\nhost = "h"\nca-file = "short"\n', 6, ['ca-file', 'short']),
    (FRONT + '[mqtt]\nhost = ""\n', 5, ['host']),
    (FRONT + '[base]\ncommand = "no-such-program"\n', 5, ['command', 'no-such-program']),
    (FRONT + '[base]\ncommand = ""\n', 5, ['command']),
    (FRONT + '[mqtt]\nhost = "mqtt://broker"\n', 5, ['host', 'mqtt://broker']),
    (FRONT + '[camera.recorder]\nfolder = ""\n', 5, ['folder', 'empty']),
    ('[[camera]]\nname = "a"\nkind = "v4l2"\ndevice = ""\n', 4, ['device', 'empty']),
    (FRONT + '[camera.sensors]\nbearings = "0"\n', 4, ['[camera.sensors]', 'driver']),
    (FRONT + '[camera.sensors]\ndriver = "gpio"\nlines = "17,,22"\n', 6, ['lines', '17,,22', 'without a name']),
    (FRONT + '[camera.sensors]\ndriver = "external"\ndevice = "serial:"\n', 6, ['device', 'serial:', 'is no device']),
    (FRONT + '[camera.head]\ndriver = "visca"\ndevice = "ttyUSB0"\n', 6, ['device', 'ttyUSB0', 'serial:/dev/ttyUSB0']),
    (FRONT + '[camera.head]\ndriver = "visca"\ndevice = "udp:camera"\n', 6, ['device', 'udp:camera', 'HOST:PORT']),
    (FRONT + '[camera.head]\ndriver = "stepper-gpio"\ndevice = "gpiochip0"\n', 4, ['drives no motor']),
    (FRONT + '[camera.head]\ndriver = "stepper-gpio"\ndevice = "gpiochip0"\n'
     'device-options = "pan=\'lines=17,18,17,22\'"\n', 7, ['device-options', '17', 'twice']),
    (FRONT + '[camera.head]\ndriver = "servo-pwm"\ndevice = "pwmchip0"\ndevice-options = "pan=\'channel=0\' tilt=\'channel=0\'"\n', 7,
     ['device-options', 'same channel']),
    (FRONT + GPIO + BACK + '[camera.sensors]\ndriver = "gpio"\nlines = "4,5,3"\nchip = "gpiochip0"\n', 12, ['lines', '"3"', 'front']),
    (FRONT + GPIO + STEPPER.format(chip='0', lines='7,8,9,3'), 6, ['lines', '"3"', 'the head of']),
    (FRONT + STEPPER.format(chip='/dev/gpiochip0', lines='1,2,3,4') + BACK + STEPPER.format(chip='gpiochip0', lines='5,6,7,4'), 14,
     ['device-options', '"4"', 'front']),
    (FRONT + SERVO.format(options="pan='channel=0'") + 'pan-min = -45\npan-max = 45\n' + BACK +
     SERVO.format(options="tilt='channel=0'"), 16, ['device-options', 'channel=0', 'front']),
    (FRONT + SERVO.format(options="pan='channel=0 range=-60,60'") + 'pan-min = -60\npan-max = 61\n', 9,
     ['pan-max', 'beyond what the servo reaches', '-60 to 60']),
    (FRONT + SERVO.format(options="tilt='channel=0 trim=5'"), 4, ['tilt-min -45', 'beyond what the servo reaches', '-50 to 40']),
    (FRONT + '[camera.head]\ndriver = "onvif"\ndevice = "http://192.0.2.7"\ndevice-options = "range=-170,170,-30,90"\ntilt-max = 40\n',
     8, ['tilt-max', 'beyond what the camera reaches', '-30 to 90']),
    ('[[camera]]\nname = "w"\nkind = "world"\nfile = "short"\nstart-pan = 80\n[camera.head]\npan-max = 10\n', 7,
     ['start-pan', '80', 'pan-max']),
    (PATROL + '[camera.patrol]\npath = "at 100 100; wait 1"\n', 5, ['"path" of [camera.patrol]', '100 100 is not free']),
    (PATROL + '[camera.patrol]\nseed = 2\nwalks = "go 1 1"\n', 6, ['"walks" of [camera.patrol]']),
    (PATROL + '[camera.patrol]\nplan = "short"\n', 5, ['"plan" of [camera.patrol]', 'short']),
    (PATROL + '[camera.patrol]\nplan = "no.plan"\n', 5, ['"plan"', 'no.plan', 'No such file']),
    (PATROL + '[camera.sensors]\nbearings = "0,left"\n', 5, ['"bearings" of [camera.sensors]', 'left']),
]

# What is no mistake of the file, but keeps a part from starting here and now.
LACKS = [
    ('[[camera]]\nname = "a"\nkind = "v4l2"\ndevice = "/dev/video77"\n', 4, ['device', '/dev/video77']),
    (FRONT + '[camera.recorder]\nfolder = "short/recordings"\n', 5, ['folder', 'short/recordings', 'Not a directory']),
    (FRONT + '[camera.recorder]\nfolder = "/dev/null/recordings"\n', 5, ['folder', '/dev/null/recordings']),
    ('state-folder = "short"\n' + FRONT, 1, ['state-folder', 'short']),
    ('[[camera]]\nname = "a"\nkind = "file"\nfile = "short"\n', 4, ['file', 'short', 'no video']),
    (FRONT + '[camera.sensors]\ndriver = "gpio"\nlines = "1,2,3"\nchip = "gpiochip77"\n', 7, ['chip', 'gpiochip77']),
    (FRONT + '[page]\nlisten = "192.0.2.7"\n', 5, ['listen', '192.0.2.7']),
    (FRONT + VISCA, 6, ['device', '/dev/ttyS9']),
]

RIGHT = [
    FRONT,
    PATROL,
    PATROL + '[camera.patrol]\nwalks = "at 8 7; go 8 11"\n[camera.sensors]\npreset = "am312"\n[camera.head]\n',
    FRONT + '[camera.head]\n[camera.sensors]\ndriver = "scripted"\nscript = "0,0,0,0; 1,1,0,0"\n',
    FRONT + '[camera.persons]\ndetector = "daimler"\nrequire = "person"\n',
    FRONT + '[camera.persons]\nenabled = false\n',
    FRONT + '[camera.recorder]\nfolder = "deep/recordings"\n' + BACK + '[camera.recorder]\nfolder = "deep/recordings"\n',
    FRONT + '[camera.detection]\nzones = "include 0.1,0.1 0.5,0.1 0.5,0.5"\n[base]\ncommand = "sh -c \'cat > /dev/null\'"\n',
    FRONT + '[webhook]\nurl = "https://h:8443/a?b=c"\nsecret-file = "secret"\n',
    FRONT + '[page]\nlisten = "127.0.0.1"\nport = 9000\n[rtsp]\nlisten = "127.0.0.2"\nport = 9000\n',
    '[[camera]]\nname = "gate"\nkind = "rtsp"\nuri = "rtsp://[::1]:8554/a?b=c&d"\nrecord-uri = "rtsp://gate.local/b"\n[rtsp]\n',
]


TLS = '[page]\ntls = true\ncertificate = "CERTIFICATE"\ncertificate-key = "KEY"\n'


def certificates(folder):
    """Two certificates with their keys, which the openssl tool makes; what must be right, and what must not."""
    if not shutil.which('openssl'):
        return
    for name, kind in {'one': ['ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1'], 'two': ['ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1'],
                       'rsa': ['rsa:2048']}.items():
        subprocess.run(['openssl', 'req', '-x509', '-newkey', *kind, '-nodes', '-days', '2', '-subj', f'/CN={name}',
                        '-keyout', folder / f'{name}.key', '-out', folder / f'{name}.pem'], capture_output=True, check=True)
    pair = lambda text, certificate, key: text.replace('CERTIFICATE', f'{certificate}.pem').replace('KEY', f'{key}.key')
    rtsp = PAGE + TLS.replace('[page]', '[rtsp]')
    for certificate, key in (('one', 'one'), ('rsa', 'rsa')):
        RIGHT.extend(FRONT + pair(text, certificate, key) for text in (TLS, rtsp))
    for certificate, key in (('one', 'two'), ('one', 'rsa'), ('rsa', 'one')):
        MISTAKES.append((FRONT + pair(TLS, certificate, key), 6, ['"certificate"', f'{certificate}.pem', f'{key}.key', 'one certificate']))
    MISTAKES.append((FRONT + pair(rtsp, 'one', 'two'), 8, ['"certificate"', 'one.pem', 'two.key']))


def free_port():
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        return probe.getsockname()[1]


def check(folder, text):
    path = folder / 'robot.toml'
    path.write_text(text)
    done = subprocess.run([CERBERUSD, '--check', path], capture_output=True, text=True, timeout=PATIENCE, check=False)
    return done.returncode, done.stdout + done.stderr


def built(text):
    """Whether this build has what a file needs."""
    return all(name in HAS for name, words in {'page': '[page]', 'rtsp': '[rtsp]', 'mqtt': '[mqtt]', 'visca': '"visca"',
                                               'pelco': '"pelco-d"', 'stepper': '"stepper-gpio"', 'servo': '"servo-pwm"', 'gpio': '"gpio"', 'onvif': '"onvif"', 'iio': '"iio"',
                                               'persons': '[camera.persons]'}.items() if words in text)


def checks(folder):
    wrong = []
    for text, line, words in MISTAKES + LACKS:
        if not built(text):
            continue
        code, said = check(folder, text)
        lines = [one for one in said.splitlines() if f'robot.toml:{line}: ' in one]
        if code != 1 or not any(all(word in one for word in words) for one in lines):
            wrong.append(f'{text}line {line}, {words} is not in, exit code {code}:\n{said}')
    for text in RIGHT:
        if not built(text):
            continue
        code, said = check(folder, text)
        if code != 0 or 'no mistake' not in said:
            wrong.append(f'{text}is right, exit code {code}:\n{said}')
    assert not wrong, '\n'.join(wrong)
    assert not (folder / 'deep').exists(), 'a check makes nothing'


def by_motion_alone(folder):
    """Where personverify is missing a camera goes by motion alone, and a line says so; one that must have it lacks it."""
    camera = '[[camera]]\nname = "gate"\nkind = "rtsp"\nuri = "rtsp://127.0.0.1/a"\n'
    alone, by_preset = 'are found by motion alone', '"preset" of [camera.detection]'
    zones = camera + '[camera.detection]\nzones = "include 0,0 1,0 1,1"\n'
    traffic = camera + '[camera.detection]\npreset = "traffic"\n'

    def said(text, status=0):
        code, words = check(folder, text)
        assert code == status, (text, code, words)
        return words
    if 'persons' in HAS:
        assert all(alone not in said(text) for text in (camera, zones, FRONT))
        words = said(traffic)
        assert words.count(alone) == 1 and 'gate' in words and by_preset in words, words
        assert alone not in said(traffic + '[camera.persons]\n')
    before = dict(os.environ)
    os.chdir(folder)
    os.environ.update(without_verify())
    try:
        words = said(camera + camera.replace('gate', 'yard'))
        assert words.count(alone) == 1 and 'personverify is not installed' in words, words
        words = said(FRONT)  # nobody is in a drawn picture
        assert alone not in words, words
        words = said(camera + '[camera.persons]\nenabled = false\n')
        assert 'personverify' not in words, words
        words = said(camera + '[camera.persons]\nrequire = "person"\n', 1)
        assert "robot.toml:1: " in words and 'personverify is not installed' in words and 'enabled = false' in words, words
    finally:
        os.chdir('/')
        os.environ.clear()
        os.environ.update(before)


def start(folder, log):
    return subprocess.Popen([CERBERUSD, folder / 'robot.toml'], stdout=log, stderr=subprocess.STDOUT)


def starts_and_reloads(folder):
    """The start and SIGHUP take the same files as --check, but for what this machine lacks only now."""
    right = f'state-folder = "state"\n[page]\nport = {free_port()}\n{FRONT}'
    (folder / 'robot.toml').write_text(right + '[camera.detection]\nzones = "1,2"\n')
    with open(folder / 'log', 'w+', encoding='utf-8') as log:
        process = start(folder, log)
        assert process.wait(PATIENCE) == 78, 'EX_CONFIG'
    (folder / 'robot.toml').write_text(right + '[camera.recorder]\nfolder = "short/recordings"\n')
    with open(folder / 'log', 'w+', encoding='utf-8') as log:
        process = start(folder, log)

        def wait_for(pattern):
            end = time.monotonic() + PATIENCE
            while not re.search(pattern, (folder / 'log').read_text()):
                assert time.monotonic() < end and process.poll() is None, (pattern, (folder / 'log').read_text())
                time.sleep(.05)
        try:
            wait_for('mode armed')
            for text, line, words in MISTAKES[:4]:
                if not built(text):
                    continue
                (folder / 'robot.toml').write_text(text)
                process.send_signal(signal.SIGHUP)
                wait_for(rf'robot.toml:{line}: .*{re.escape(words[0])}(.|\n)*goes on as before')
                (folder / 'log').write_text('')
            process.send_signal(signal.SIGTERM)
            assert process.wait(PATIENCE) == 0
        finally:
            process.kill()


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for file, text in {'short': 'too short\n', 'secret': 'a secret of 16 letters\n', 'empty': ''}.items():
            (folder / file).write_text(text)
            (folder / file).chmod(0o600)
        certificates(folder)
        checks(folder)
        by_motion_alone(folder)
        starts_and_reloads(folder)


main()
