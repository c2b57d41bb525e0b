#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs the launch files of pipelines/, with a test source in place of the camera and files in place of screens.

    launch_files.py NAME live|file|444|parsed|head|lines [SERVER]

The source is a bouncing ball: grey, so that any colour in the result was drawn by motionoverlay, and moving, so that
objects are found. Where people are told by their size, it has the shape of one. Networks are the loopback, on ports
that were free a moment ago. Files for hardware that is not here are parsed and not run. SERVER is cerberus-rtsp.
"""
import contextlib
import math
import os
import pathlib
import shlex
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time

from support import DISTANCE, LIMIT, TOP, ball, gst_launch, json_lines, must, person, run, video, without_verify

WIDTH, HEIGHT, FRAMES = 320, 240, 75


STARTED = []  # also what is left of a test that failed


def start(name, *options, **variables):
    line = [str(TOP / 'pipelines' / 'run'), *options, name, *(f'{key}={value}' for key, value in variables.items())]
    STARTED.append(subprocess.Popen(line, cwd=os.getcwd(), start_new_session=True, text=True,
                                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT))
    return STARTED[-1]


def finish(process):
    """What it printed. It must end well, by itself and in time."""
    try:
        output, _ = process.communicate(timeout=LIMIT)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        output, _ = process.communicate()
        sys.exit(f'it did not end within {LIMIT} seconds:\n{output}')
    assert process.returncode == 0, f'exit status {process.returncode}:\n{output}'
    return output


def source(kind, scene=ball):
    if kind == 'live':
        return scene(frames=FRAMES, live=True)
    if kind == '444':  # a camera or a file with colour at full resolution, which most players cannot play as H.264
        return f'{scene(frames=FRAMES)} ! videoconvert ! video/x-raw,format=Y444'
    if not os.path.exists('scene.mp4'):
        video('scene.mp4', 'mp4mux', scene, frames=FRAMES)
    return 'filesrc location=scene.mp4 ! decodebin'


def paced(kind):
    """A source no faster than its clock: who drops what he has no time for shall have some, on a busy machine too."""
    return source(kind) if kind == 'live' else source(kind) + ' ! identity sync=true'


def decode(path, pixel_format='I420'):
    """The frames of a file, through a decoder that knows nothing of how it was made."""
    raw = path + '.raw'
    must(gst_launch(f'filesrc location={path} ! decodebin ! videoconvert ! video/x-raw,format={pixel_format} ! '
                    f'filesink location={raw}'))
    return frames(raw, WIDTH * HEIGHT * 3 // 2)


def frames(path, size):
    data = pathlib.Path(path).read_bytes()
    assert len(data) % size == 0, f'{path}: {len(data)} bytes are no whole number of frames of {size}'
    return [data[k:k + size] for k in range(0, len(data), size)]


def check_players_can_play(path, demuxer):
    """The H.264 in a file is 8 bits, 4:2:0: the only one that browsers and hardware decoders play."""
    status, said = gst_launch(f'filesrc location={path} ! {demuxer} ! h264parse ! '
                              'video/x-h264,chroma-format=4:2:0,bit-depth-luma=(uint)8 ! fakesink')
    assert status == 0, f'{path} is not H.264 of 8 bits, 4:2:0:\n{said}'


def coloured(frame):
    """Whether an I420 frame has a pixel that is clearly not grey."""
    chroma = frame[WIDTH * HEIGHT:]
    return max(chroma) > 160 or min(chroma) < 96


def least(kind):
    """So many frames come through. Live, those are left out for which a busy machine is too late (support.PATIENCE)."""
    return FRAMES // 2 if kind == 'live' else FRAMES - 2


def most(kind):
    """And so many at most: while the ball of a busy machine is late, a live compositor repeats the last of it."""
    return 2 * FRAMES if kind == 'live' else FRAMES + 2


def check_lines(path, kind):
    """The lines are sane, and the ball is in them; their number."""
    lines = json_lines(path)
    count = len(lines)
    assert least(kind) <= count <= most(kind), f'{count} lines'
    assert [line['frame'] for line in lines] == list(range(lines[0]['frame'], lines[0]['frame'] + count))
    assert all(a['pts'] < b['pts'] for a, b in zip(lines, lines[1:])), 'timestamps do not rise'
    assert all((line['width'], line['height']) == (WIDTH, HEIGHT) for line in lines)
    seen = sum(bool(line['objects']) for line in lines)
    assert seen > count // 3, f'the ball was found in {seen} of {count} frames'
    return count


def test_annotate(kind):
    finish(start('annotate', SOURCE=source(kind), MP4='out.mp4', JSON='out.jsonl'))
    count = check_lines('out.jsonl', kind)
    check_players_can_play('out.mp4', 'qtdemux')
    pictures = decode('out.mp4')
    assert len(pictures) == count, f'{len(pictures)} frames in the MP4, {count} lines'
    assert sum(map(coloured, pictures)) > count // 3, 'no boxes were drawn'


def test_live(kind):
    if not any(path.read_text('ascii') == 'connected\n' for path in pathlib.Path('/sys/class/drm').glob('card*/status')):
        status, said = run([TOP / 'pipelines' / 'run', 'live'], env={'DISPLAY': '', 'WAYLAND_DISPLAY': ''})
        assert status == 2 and 'no screen' in said and 'SINK=' in said, said
    finish(start('live', SOURCE=paced(kind), SINK='video/x-raw,format=I420 ! filesink location=out.raw'))
    pictures = frames('out.raw', WIDTH * HEIGHT * 3 // 2)
    assert len(pictures) >= FRAMES // 10, f'{len(pictures)} frames were shown'  # it may drop late ones
    assert any(map(coloured, pictures)), 'no box was shown'


def recorded_file(folder='recordings'):
    """The one file that the recorder wrote into this folder."""
    found = list(pathlib.Path(folder).rglob('*.mp4'))
    assert len(found) == 1, f'not one recording: {found}'
    return str(found[0])


def test_record(kind):
    """The ball moves all the time: one event from the first frame, which lies in its pre-roll, to the last."""
    os.mkdir('recordings')
    finish(start('record', SOURCE=source(kind), FOLDER='recordings', NAME='yard', JSON='out.jsonl'))
    count = check_lines('out.jsonl', kind)
    path = recorded_file()
    assert '_yard_1.mp4' in path, path
    check_players_can_play(path, 'qtdemux')
    pictures = decode(path)
    assert len(pictures) == count, f'{len(pictures)} frames in the recording, {count} lines'
    assert not any(map(coloured, pictures)), 'the recording is not the original picture'


def test_record_streams(kind):
    """A large and a small stream of the same scene, each with its own source."""
    os.mkdir('recordings')
    if kind == 'live':
        small = ball(frames=FRAMES, width=160, height=120, live=True, name='small')
    else:
        small = source(kind) + ' ! videoscale ! video/x-raw,width=160,height=120'
    main_stream = (f'{source(kind)} ! videoconvert ! video/x-raw,format=I420 ! '
                   'x264enc tune=zerolatency key-int-max=25 ! h264parse')
    finish(start('record-streams', MAIN=main_stream, SUB=small, FOLDER='recordings'))
    path = recorded_file()
    check_players_can_play(path, 'qtdemux')
    pictures = decode(path)
    assert least(kind) <= len(pictures) <= most(kind), f'{len(pictures)} frames in the recording'


def test_stages(kind):
    finish(start('stages', SOURCE=source(kind), SINK='video/x-raw,format=GRAY8 ! filesink location=out.raw'))
    width, height = 384, 288
    pictures = frames('out.raw', 3 * width * 2 * height)
    # A live compositor starts when its first input does, and may repeat or skip a frame.
    few, many = (least(kind), most(kind)) if kind == 'live' else (FRAMES, FRAMES)
    assert few <= len(pictures) <= many, f'{len(pictures)} frames'
    for tile, stage in enumerate(('luma', 'difference', 'histogram', 'mask', 'labels', 'result')):
        left, top = tile % 3 * width, tile // 3 * height
        rows = (range(top, top + height))
        shows = sum(len(set(b''.join(picture[y * 3 * width + left:y * 3 * width + left + width] for y in rows))) > 1
                    for picture in pictures)
        assert shows > len(pictures) // 3, f'stage {stage} shows something in {shows} of {len(pictures)} frames'


def test_virtualptz(kind):
    size = 160 * 120 * 3 // 2
    finish(start('virtualptz', SOURCE=paced(kind), WIDE=60, VIEW=32.2, WIDTH=160, HEIGHT=120, PAN=16, TILT=12,
                 PERSONS='', SINK='video/x-raw,format=I420 ! filesink location=out.raw'))
    pictures = frames('out.raw', size)
    assert len(pictures) >= FRAMES // 10, f'{len(pictures)} frames were shown'  # it may drop late ones
    # The wall stands still: where most of the border changes, the window has moved.
    border = [picture[:160 * 8] for picture in pictures]
    changed = max(sum(a != b for a, b in zip(border[0], other)) for other in border)
    assert changed > len(border[0]) // 3, f'the window stands: {changed} of {len(border[0])} pixels change'


def check_the_loop(lines, width, reach):
    """The head turned, and took its target to the middle of the picture where it can turn there."""
    actions = {line['fusion']['action'] for line in lines}
    assert 'track' in actions, f'nobody was tracked: {actions}'
    pans = [line['pose']['pan'] for line in lines]
    assert max(pans) - min(pans) > 3, f'the head turned from {min(pans)} to {max(pans)} degrees only'
    aside = [(each['id'], abs(each['x'] + each['w'] / 2 - width / 2) / width, abs(line['pose']['pan']) < reach)
             for line in lines if line['fusion']['action'] == 'track'
             for each in line['objects'] if each['id'] == line['fusion']['target']]
    nearer = [later < max(0.1, now) for (target, now, turns), (same, later, _) in zip(aside, aside[4:])
              if turns and same == target]
    assert len(nearer) > 5 and sum(nearer) > 0.8 * len(nearer), \
        f'the target came nearer to the middle, or was there, in {sum(nearer)} of {len(nearer)} pictures'


def closed_loop(kind, name, **more):
    pathlib.Path('pir.csv').write_text('0,0,0,0\n0.2,0,0,1\n0.8,0,0,0\n9,0,0,0\n', 'ascii')
    finish(start('closed-loop', SOURCE=source(kind), PIR='pir.csv', MP4=f'{name}.mp4', JSON=f'{name}.jsonl',
                 WIDTH=160, HEIGHT=120, VIEW=32.2, PAN=16, TILT=12, **more))
    check_players_can_play(f'{name}.mp4', 'qtdemux')
    lines = json_lines(f'{name}.jsonl')
    few, many = (least(kind), most(kind)) if kind == 'live' else (FRAMES, FRAMES)
    assert few <= len(lines) <= many, f'{len(lines)} lines'
    assert all(line.keys() >= {'pose', 'pir', 'fusion'} for line in lines), 'a line without pose, sensors or decision'
    return lines


def test_closed_loop(kind):
    lines = closed_loop(kind, 'a')
    if kind == 'live':
        # Nobody waits for a sensor's word there, and when the head obeys depends on the machine.
        assert [0, 0, 1] in [line['pir'] for line in lines], 'the sensors are not those of the file'
        return
    for line in lines:
        seconds = (line['pts'] - lines[0]['pts']) / 1e9
        if abs(seconds - 0.2) > 0.1 and abs(seconds - 0.8) > 0.1:
            assert line['pir'] == [0, 0, int(0.2 < seconds < 0.8)], 'the sensors are not those of the file'
    closed_loop(kind, 'b')
    assert pathlib.Path('a.jsonl').read_bytes() == pathlib.Path('b.jsonl').read_bytes(), 'two runs differ'
    assert lines[0]['pose'] == {'pan': 0, 'tilt': 0, 'moving': False}
    # A ball is no person: only motion alone follows it before a head that turns.
    check_the_loop(closed_loop(kind, 'c', PERSONS=''), 160, 14)


# The robot stands; a person crosses 3.5 m before it at 1 m/s, and begins 1.5 m to the left.
CROSSES = 'path="at 4.5 8.5; wait 1" walks="at 8 7 90; go 8 11 1"'
FOCAL = WIDTH / 2 / math.tan(math.radians(30))  # pixels


def luma(picture, left, top):
    return picture[top * WIDTH + left]


def test_patrol(_):
    """Who crosses the view is found where they are and followed, twice alike; the plan is in the upper right corner."""
    for name in 'ab':
        finish(start('patrol', HOUSE=CROSSES, FRAMES=FRAMES, WIDTH=WIDTH, HEIGHT=HEIGHT, MP4=f'{name}.mp4', JSON=f'{name}.jsonl'))
    assert pathlib.Path('a.jsonl').read_bytes() == pathlib.Path('b.jsonl').read_bytes(), 'two runs differ'
    lines = json_lines('a.jsonl')
    assert len(lines) == FRAMES and all(line.keys() >= {'pose', 'pir', 'fusion'} and len(line['pir']) == 3 for line in lines)
    check_the_loop(lines, WIDTH, 89)
    late = lines[45:]  # 1.5 s: found, and the head has turned
    off = [line['pose']['pan'] + math.degrees(math.atan((each['x'] + each['w'] / 2 - WIDTH / 2) / FOCAL)) -
           math.degrees(math.atan((line['pts'] / 1e9 - 1.5) / 3.5)) for line in late for each in line['objects']]
    assert len(off) > 0.8 * len(late) and sum(abs(angle) < 5 for angle in off) > 0.8 * len(off), off
    check_players_can_play('a.mp4', 'qtdemux')
    pictures = decode('a.mp4')
    assert len(pictures) == FRAMES, f'{len(pictures)} pictures'
    # 96 x 82 pixels for 16.8 x 14.4 m, 6 from the edges: what is no room is dark, the floor of the lounge is bright.
    for picture in pictures:
        assert luma(picture, 218 + 82, 6 + 14) < 60 and luma(picture, 218 + 48, 6 + 74) > 180, 'there is no floor plan'


def free_ports(count):
    """Held until all are found: no two are the same."""
    with contextlib.ExitStack() as held:
        sockets = [held.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) for _ in range(count)]
        for each in sockets:
            each.bind(('127.0.0.1', 0))
        return [each.getsockname()[1] for each in sockets]


def wait_for(what, condition, process):
    until = time.monotonic() + LIMIT
    while not condition():
        if process.poll() is not None:
            sys.exit(f'the receiver ended while waiting for {what}:\n{process.communicate()[0]}')
        if time.monotonic() > until:
            os.killpg(process.pid, signal.SIGKILL)
            sys.exit(f'waited in vain for {what}:\n{process.communicate()[0]}')
        time.sleep(0.02)


def free_port():
    with contextlib.closing(socket.socket()) as held:
        held.bind(('127.0.0.1', 0))
        return held.getsockname()[1]


def stop(process):
    """As by Ctrl-C; it must end well."""
    os.killpg(process.pid, signal.SIGINT)
    return finish(process)


def endless(kind):
    """A source that goes on until the test has what it wants."""
    return source(kind).replace(f'num-buffers={FRAMES} ', '')


def listening(port, protocol='udp'):
    lines = pathlib.Path(f'/proc/net/{protocol}').read_text('ascii').splitlines()[1:]
    return any(line.split()[1].endswith(f':{port:04X}') for line in lines)


def size(path):
    return os.path.getsize(path) if os.path.exists(path) else 0


def rested(*paths):
    """A condition: these files have not grown for a second."""
    last, since = None, 0

    def condition():
        nonlocal last, since
        sizes = [size(path) for path in paths]
        if sizes != last:
            last, since = sizes, time.monotonic()
        return time.monotonic() - since > 1
    return condition


def test_rtp(kind):
    port, json_port = free_ports(2)
    stream = source(kind)
    receiver = start('rtp-receive', ADDRESS='127.0.0.1', PORT=port, JSON_PORT=json_port, JSON='out.jsonl',
                     SINK='video/x-raw,format=I420 ! filesink buffer-mode=unbuffered location=out.raw')
    wait_for('its ports', lambda: listening(port) and listening(json_port), receiver)
    finish(start('rtp-send', SOURCE=stream, HOST='127.0.0.1', PORT=port, JSON_PORT=json_port))
    # Of the pictures, not of the lines, a sender leaves out what would come too late; a live one has time to spare.
    # The decoder keeps a few until the stream ends, which a receiver of UDP never hears of.
    fewest = least(kind) - 5 if kind == 'live' else FRAMES // 10
    wait_for('the frames', lambda: size('out.raw') >= fewest * WIDTH * HEIGHT * 3 // 2, receiver)
    wait_for('the last of them', rested('out.jsonl', 'out.raw'), receiver)
    os.killpg(receiver.pid, signal.SIGINT)
    finish(receiver)
    count = check_lines('out.jsonl', kind)
    pictures = frames('out.raw', WIDTH * HEIGHT * 3 // 2)
    assert fewest <= len(pictures) <= count, f'{len(pictures)} frames were received of {count}'
    assert sum(map(coloured, pictures)) > len(pictures) // 3, 'the received picture has no boxes'


def test_hls(kind):
    """The playlist names the files in order, and they hold every picture, annotated."""
    os.mkdir('web')
    finish(start('hls', SOURCE=paced(kind), FOLDER='web', SECONDS=1, GOP=10, KEEP=0))
    playlist = pathlib.Path('web/live.m3u8').read_text('ascii').splitlines()
    assert playlist[0] == '#EXTM3U' and playlist[-1] == '#EXT-X-ENDLIST', playlist
    files = [f'web/{line}' for line in playlist if line and not line.startswith('#')]
    assert len(files) > 1 and files == sorted(str(path) for path in pathlib.Path('web').glob('*.ts')), files
    pathlib.Path('whole.ts').write_bytes(b''.join(pathlib.Path(path).read_bytes() for path in files))
    pictures = decode('whole.ts')
    assert least(kind) <= len(pictures) <= most(kind), f'{len(pictures)} pictures'
    assert sum(map(coloured, pictures)) > len(pictures) // 3, 'no boxes were drawn'


def test_mjpeg(kind):
    """Two receivers that come while it runs."""
    port = free_port()
    sender = start('mjpeg', SOURCE=endless(kind), PORT=port)
    wait_for('its port', lambda: listening(port, 'tcp'), sender)
    for _ in range(2):
        must(gst_launch(f'tcpclientsrc port={port} ! multipartdemux ! image/jpeg,framerate=25/1 ! jpegdec ! '
                        'videoconvert ! video/x-raw,format=I420 ! identity eos-after=31 ! filesink location=out.raw'))
        pictures = frames('out.raw', WIDTH * HEIGHT * 3 // 2)
        assert len(pictures) == 30 and any(map(coloured, pictures)), f'{len(pictures)} pictures, or no box'
    stop(sender)


def plays(address, settings=''):
    """The first pictures of an RTSP address."""
    must(gst_launch(f'rtspsrc location={address} latency=0 {settings} ! rtph264depay ! h264parse ! avdec_h264 ! '
                    'videoconvert ! video/x-raw,format=I420 ! identity eos-after=31 ! filesink location=out.raw'))
    pictures = frames('out.raw', WIDTH * HEIGHT * 3 // 2)
    assert len(pictures) == 30, f'{len(pictures)} pictures of {address}'
    return pictures


def test_rtsp(kind, program, example=None):
    """Both addresses are played; the stream that is sent is recorded, and a second recorder takes it from the server."""
    for folder in ('recordings', 'far'):
        os.mkdir(folder)
    users = pathlib.Path('users')
    users.write_text('anna:secret\n', 'ascii')
    users.chmod(0o600)
    recorder = ('eventrecorder name=recorder location=recordings coded. ! queue ! h264parse ! recorder.video '
                't. ! queue ! recorder.analysis')
    server = start('rtsp', '--with', program, '--pass', '--port=0', '--pass', '--users=users', SOURCE=endless(kind),
                   RECORDER=recorder, IDLE='identity')
    addresses = [server.stdout.readline().split()[0] for _ in range(2)]
    assert [address.rsplit('/', 1)[1] for address in addresses] == ['plain', 'annotated'], addresses
    login = 'user-id=anna user-pw=secret'
    for address, boxes in zip(addresses, (False, True)):
        assert any(map(coloured, plays(address, login))) == boxes, f'boxes in {address}: {not boxes}'
    # Two streams of a camera: one is recorded as it comes, around what moves in the other.
    stream = f'rtspsrc location={addresses[0]} {login} latency=0 ! rtph264depay !'
    far = start('record-streams', MAIN=f'{stream} h264parse', SUB=f'{stream} avdec_h264', FOLDER='far')
    wait_for('a recording', lambda: any(size(path) > 0 for path in pathlib.Path('far').rglob('*.mp4')), far)
    stop(far)
    stop(server)
    for folder in ('recordings', 'far'):
        path = recorded_file(folder)
        check_players_can_play(path, 'qtdemux')
        assert len(decode(path)) > 5, f'{path} is too short'
    if example:  # a program in C that mounts the same in its own server
        server = subprocess.Popen([example, '0', endless(kind)], start_new_session=True, text=True,
                                  stdout=subprocess.PIPE)
        try:
            assert any(map(coloured, plays(server.stdout.readline().strip()))), 'no boxes in the mount of the example'
        finally:
            server.kill()
            server.communicate()


def parsed(process, missing):
    """The line that was printed is right, but for elements of hardware that is not here."""
    words = shlex.split(finish(process))[2:]  # without gst-launch-1.0 -e
    found = must(run([sys.executable, TOP / 'tests' / 'pipelines' / 'parse.py', *words])).split()
    assert set(found) <= missing, f'{found} are missing'


def printed(*settings, env=None):
    """The line of annotate, and what is said beside it."""
    done = subprocess.run([TOP / 'pipelines' / 'run', '--print', 'annotate', 'FILE=walk.mp4', *settings], timeout=LIMIT,
                          text=True, capture_output=True, check=True, env={**os.environ, **(env or {})})
    return shlex.split(done.stdout), done.stderr


def test_persons(_):
    """Motion and a people detector are in each line where people are looked for; motion alone does where it must."""
    behind = {'personverify': ['!', 'personverify', '!'], 'none': ['!']}

    def follows(line, words):
        place = line.index('motiondetect') + 1
        return line[place:place + len(words)] == words

    is_there = run(['gst-inspect-1.0', 'personverify'])[0] == 0
    line, said = printed()
    assert follows(line, behind['personverify' if is_there else 'none'] + ['tee']), line
    assert is_there != ('personverify is not installed' in said), said
    line, said = printed('PERSONS=')
    assert follows(line, behind['none'] + ['tee']) and not said, (line, said)
    line, said = printed('PERSONS=personverify detector=daimler')
    assert follows(line, ['!', 'personverify', 'detector=daimler', '!', 'tee']) and not said, (line, said)
    for path in (TOP / 'pipelines').glob('*.launch'):
        text = path.read_text('utf-8')
        assert text.count('! motiondetect') == text.count('${PERSONS}'), f'{path.name} has another number of detectors'

    without = without_verify()
    line, said = printed(env=without)
    assert follows(line, behind['none'] + ['tee']), line
    assert said.count('\n') == 1 and 'personverify is not installed: people are found by motion alone' in said, said
    os.environ.update(without)
    said = finish(start('annotate', SOURCE=source('file'), MP4='out.mp4', JSON='out.jsonl'))
    assert 'found by motion alone' in said, said
    check_lines('out.jsonl', 'file')


def test_hardware(_):
    parsed(start('hardware-v4l2', '--print'), {'v4l2h264dec', 'v4l2h264enc'})
    parsed(start('hardware-va', '--print'), {'vah264dec', 'vapostproc', 'vah264enc'})
    parsed(start('hardware-va', '--print', ENCODER='va-lp'), {'vah264dec', 'vapostproc', 'vah264lpenc'})
    parsed(start('hardware-nvenc', '--print'), {'nvh264dec', 'cudadownload', 'nvh264enc'})
    for name in ('x264', 'openh264', 'vp8'):
        parsed(start('rtsp', '--print', ENCODER=name), set())
    encoder = TOP / 'pipelines' / 'encoder'
    assert must(run([encoder, 'x264', 30, 500])).endswith('bitrate=500 key-int-max=30\n')
    # Without GStreamer's own plugins there is none, and it is said which were looked for.
    status, said = run([encoder, 'h264'], env={'GST_PLUGIN_SYSTEM_PATH_1_0': '', 'GST_PLUGIN_PATH_1_0': '',
                                               'GST_REGISTRY_1_0': os.path.abspath('empty.bin')})
    assert status == 2 and 'v4l2h264enc (package' in said and 'openh264enc (package' in said, said


def servo_head():
    """The variables of a head of two servos, on files in place of the kernel's PWM chip."""
    for channel in ('pwm0', 'pwm1'):
        folder = pathlib.Path('pwm', channel)
        folder.mkdir(parents=True)
        for name in ('period', 'duty_cycle', 'enable'):
            (folder / name).write_text('0\n', 'ascii')
    options = "pan='channel=0 pulse=500,2500 range=-90,90' tilt='channel=1'"
    return {'HEAD': f'driver=servo-pwm device={os.getcwd()}/pwm device-options="{options}" latency=80000000',
            'PAN': 85, 'TILT': 30}


def real_head(sensors):
    """The robot turns a head of servos to the sensor that fires, until it is interrupted."""
    nobody = f'videotestsrc is-live=true pattern=black ! video/x-raw,width={WIDTH},height={HEIGHT},framerate=25/1'
    process = start('robot', SOURCE=nobody, SENSORS=sensors, FILE='out.mkv', JSON='out.jsonl', PORT=9, **servo_head())
    width = pathlib.Path('pwm/pwm0/duty_cycle')
    end = time.monotonic() + LIMIT
    while time.monotonic() < end and process.poll() is None:
        if int(width.read_text('ascii').split()[0]) > 1600000:  # 1500 us is straight ahead, 11 us a degree
            break
        time.sleep(0.02)
    else:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        output = process.communicate()[0]
        sys.exit(f'the servo was not turned to the right\n{output}')
    os.killpg(process.pid, signal.SIGINT)
    finish(process)
    enabled = pathlib.Path('pwm/pwm0/enable').read_text('ascii').split()[0]
    assert enabled == '0', 'the servo gets pulses after the end'


def test_robot(kind):
    """With a recording in place of the sensors. The stream drops what is late: all that is sure is that it begins."""
    pathlib.Path('pir.csv').write_text('0,0,0,0\n0.4,0,0,1\n600,0,0,1\n', 'ascii')
    sensors = f'pirsrc driver=replay location=pir.csv is-live={kind != "file"}'
    if kind == 'head':
        return real_head(sensors)
    with contextlib.closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as stream:
        stream.bind(('127.0.0.1', 0))
        stream.settimeout(LIMIT)
        # With nothing else said, who is not of a person's size and speed in metres is nobody.
        finish(start('robot', SOURCE=source(kind, person), SENSORS=sensors, FILE='out.mkv', JSON='out.jsonl',
                     HOST='127.0.0.1', PORT=stream.getsockname()[1]))
        packet = stream.recv(65536)
    assert packet[0] >> 6 == 2 and packet[1] & 127 == 96, f'no RTP of a dynamic type: {packet[:12].hex()}'
    count = check_lines('out.jsonl', kind)
    check_players_can_play('out.mkv', 'matroskademux')
    recorded = decode('out.mkv')
    assert len(recorded) == count, f'{len(recorded)} frames in the recording, {count} lines'
    assert not any(map(coloured, recorded)), 'the recording is not the original picture'
    lines = json_lines('out.jsonl')
    # A person whom only the detector finds has no distance.
    told = [each['distance'] for line in lines for each in line['objects'] if each['distance'] is not None]
    assert len(told) > count // 4, f'{len(told)} distances in {count} lines'
    away = statistics.median(told)
    assert abs(away - DISTANCE) < 1, f'somebody {DISTANCE} m away is told to be {away} m away'
    assert all(line.keys() >= {'pir', 'fusion'} for line in lines), 'a line without sensors or decision'
    # A live sensor that a busy machine keeps silent counts as lost for a while.
    heard = [line['pir'] for line in (lines if kind == 'live' else lines[-1:])]
    assert [0, 0, 1] in heard, 'the sensors are not those of the file'
    actions = {line['fusion']['action'] for line in lines}
    assert actions & {'track', 'turn-right'}, f'nobody looked at what was found: {actions}'


def main():
    name, kind = sys.argv[1:3]
    programs = [os.path.abspath(program) for program in sys.argv[3:]]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            globals()['test_' + name.replace('-', '_')](kind, *programs)
        finally:
            os.chdir('/')
            for process in STARTED:
                if process.poll() is None:
                    os.killpg(process.pid, signal.SIGKILL)


main()
