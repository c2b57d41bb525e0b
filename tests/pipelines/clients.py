#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Whether others read what is served and written: ffmpeg and GStreamer read every stream and file, and each picture is
compared with the one that went into the encoder.

    clients.py WHAT PICTURES [PROGRAM]

WHAT is one of the tests below. PICTURES makes numbered pictures and compares them (pictures.cpp). The clients of a
stream watch at the same time. Without ffmpeg GStreamer reads alone, and the test counts as skipped. PROGRAM is cerberus-rtsp or cerberusd.
"""
import os
import pathlib
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

from page_client import Page, Socket
from rtsp_client import Rtsp
from support import LIMIT, TOP, gst_launch, must, run

WIDTH, HEIGHT, RATE = 320, 240, 25
SOME, MANY = 150, 900  # pictures of a file, and of a stream that lasts until its clients have what they need
NEEDED = 100            # pictures that the client of a stream takes
PICTURES = os.path.abspath(sys.argv[2])
I420 = 'videoconvert ! video/x-raw,format=I420'
# By way of RGB, since videoconvert of GStreamer 1.22 keeps the range where the matrix stays; JPEG has the full one.
LIMITED = f'videoconvert ! video/x-raw,format=BGRx ! {I420},colorimetry=bt601'
RTP = {'h264': 'rtph264depay wait-for-keyframe=true ! h264parse ! avdec_h264',
       'h265': 'rtph265depay ! h265parse ! avdec_h265',
       'vp8': 'rtpvp8depay wait-for-keyframe=true ! vp8dec',
       'jpeg': f'rtpjpegdepay ! jpegdec ! {LIMITED}'}
ENOUGH = f'! identity eos-after={NEEDED + 1}'  # a stream that is read by GStreamer ends there
H264 = ('x264', 1), ('x264', 4), ('openh264', 1), ('openh264', 4)  # encoder, slices a picture
STARTED = []  # also what is left of a test that failed


def start(line):
    STARTED.append(subprocess.Popen([str(word) for word in line], start_new_session=True, text=True,
                                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT))
    return STARTED[-1]


def launch_file(name, *options, **variables):
    """By motion alone: live, the frame from which on a look of a people detector counts differs from run to run."""
    return start([TOP / 'pipelines' / 'run', *options, name, 'PERSONS=', *(f'{key}={value}' for key, value in variables.items())])


def ended(process):
    """What it printed. It must end well, by itself and in time."""
    output, _ = process.communicate(timeout=LIMIT)
    assert process.returncode == 0, f'{process.args} ended with {process.returncode}:\n{output}'
    return output


def stop(process):
    """As by Ctrl-C."""
    os.killpg(process.pid, signal.SIGINT)
    return ended(process)


def pictures(count, paced=False, width=WIDTH, height=HEIGHT):
    """A source of so many numbered pictures, which are also in the file scene.raw."""
    must(run([PICTURES, 'make', width, height, count, 'scene.raw']))
    must(gst_launch(f'filesrc location=scene.raw ! rawvideoparse width={width} height={height} format=i420 '
                    f'framerate={RATE}/1 ! matroskamux ! filesink location=scene.mkv'))
    return 'filesrc location=scene.mkv ! decodebin' + (' ! clocksync' if paced else '')


def draw(elements='motiondetect ! motionoverlay'):
    """The same pictures with what these elements draw into them, in the file drawn.raw."""
    must(gst_launch(f'filesrc location=scene.mkv ! decodebin ! videoconvert ! {elements} ! {I420} ! '
                    'filesink location=drawn.raw'))


def encoder(name, slices=1, gop=RATE):
    """The line of an encoder of pipelines/encoder, with so many slices a picture; and H.265, as cameras send it."""
    if name == 'x265':
        return ('x265enc tune=zerolatency speed-preset=ultrafast '
                f'key-int-max={gop} option-string=slices={slices} ! h265parse')
    line = must(run([TOP / 'pipelines' / 'encoder', '--line', name, gop, 2000])).strip()
    return line + {'x264': f' threads={slices} sliced-threads=true',
                   'openh264': f' slice-mode=n-slices num-slices={slices}'}.get(name, '')


def lost_datagrams():
    """How many the kernel has dropped so far because a socket's buffer was full: UDP promises no more, on a busy machine."""
    names, values = (line.split() for line in pathlib.Path('/proc/net/snmp').read_text('ascii').splitlines()
                     if line.startswith('Udp:'))
    return int(values[names.index('RcvbufErrors')])


class Readers:
    """Programs that read pictures at the same time."""

    def __init__(self, width=WIDTH, height=HEIGHT):
        self.all, self.size, self.lost = [], (width, height), lost_datagrams()

    def add(self, name, before, least, line):
        raw = f'reader{len(self.all)}.raw'
        self.all.append((name, before, raw, least, start([str(word).replace('OUTPUT', raw) for word in line])))

    def judge(self, name, before, raw, least, process):
        said = ended(process)
        status, report = run([PICTURES, 'compare', *self.size, before, raw, least])
        print(f'{name}: {report.splitlines()[-1]}', flush=True)
        return f'{name}:\n{said}{report}' if status != 0 else ''

    def ffmpeg(self, name, before, least, *source):
        if shutil.which('ffmpeg'):
            self.add(f'{name} by ffmpeg', before, least,
                     ['ffmpeg', '-nostdin', '-y', '-v', 'error', *source, '-map', '0:v', '-fps_mode', 'passthrough',
                      '-frames:v', least, '-f', 'rawvideo', '-pix_fmt', 'yuv420p', 'OUTPUT'])

    def gstreamer(self, name, before, least, line, count=''):
        self.add(f'{name} by GStreamer', before, least,
                 [sys.executable, TOP / 'tests' / 'pipelines' / 'launch.py',
                  *f'{line} ! {I420} {count} ! filesink location=OUTPUT'.split()])

    def compare(self):
        """Judges all of them when they have ended."""
        wrong = []
        for *what, process in self.all:
            report = self.judge(*what, process)
            if report and any('udp' in word for word in process.args) and lost_datagrams() > self.lost:
                print(f'the kernel dropped datagrams that their reader was too slow for: {what[0]} reads once more')
                report = self.judge(*what, start(process.args))
            wrong += [report] if report else []
        assert not wrong, '\n'.join(wrong)


def watch(readers, address, before, encoding, protocol, by='both'):
    """An RTSP address is read by both, or by one."""
    name = f'{address.rsplit("/", 1)[1]}, {encoding} over {protocol}'
    if by != 'GStreamer':
        readers.ffmpeg(name, before, NEEDED, '-rtsp_transport', protocol, '-i', address)
    if by != 'ffmpeg':
        line = f'rtspsrc location={address} latency=0 protocols={protocol} ! {RTP[encoding]}'
        readers.gstreamer(name, before, NEEDED, line, ENOUGH)


def test_rtsp(program, example=None):
    source = pictures(MANY, paced=True)
    draw()
    for name, slices in (*H264, ('vp8', 1), ('jpeg', 1), ('x265', 4)):
        if name == 'x265' and run(['gst-inspect-1.0', '--exists', 'x265enc'])[0] != 0:
            print('x265enc is not installed: H.265 is not tried')
            continue
        server = launch_file('rtsp', '--with', program, '--pass', '--port=0', SOURCE=source,
                             ENCODER=encoder(name, slices, gop=250))
        addresses = [server.stdout.readline().split()[0] for _ in range(2)]
        encoding = {'x265': 'h265', 'vp8': 'vp8', 'jpeg': 'jpeg'}.get(name, 'h264')
        readers = Readers()
        print(f'{name}, slices: {slices}')
        if name == 'x265':  # rtph265depay cannot wait for a keyframe: one client each, which begins with one
            watch(readers, addresses[0], 'scene.raw', encoding, 'tcp', by='ffmpeg')
            watch(readers, addresses[1], 'drawn.raw', encoding, 'udp', by='GStreamer')
        for address, before, protocols in zip(addresses, ('scene.raw', 'drawn.raw'), ('tcp udp', 'udp tcp')):
            for protocol in protocols.split()[:{'x264': 2, 'x265': 0}.get(name, 1)]:
                watch(readers, address, before, encoding, protocol)
        readers.compare()
        stop(server)
    if example:  # a program in C that mounts the same in its own server
        server = start([example, '0', source])
        address = server.stdout.readline().strip()
        for by in ('ffmpeg', 'GStreamer'):  # its source is a file, which a second client that joins may start anew
            readers = Readers()
            watch(readers, address, 'drawn.raw', 'h264', 'tcp', by=by)
            readers.compare()


def free_port(kind=socket.SOCK_STREAM):
    with socket.socket(socket.AF_INET, kind) as held:
        held.bind(('127.0.0.1', 0))
        return held.getsockname()[1]


def wait_until(condition, process):
    until = time.monotonic() + LIMIT
    while not condition():
        assert process.poll() is None, f'it ended:\n{process.communicate()[0]}'
        assert time.monotonic() < until, 'waited in vain'
        time.sleep(0.02)


def is_served(port, path):
    try:
        return Rtsp(port).ask('DESCRIBE', path, 'Accept: application/sdp')[0] == 200
    except OSError:
        return False


def test_rtp():
    """Receivers that come while the stream is on its way, and are told no more than that it is H.264."""
    source = pictures(MANY, paced=True)
    draw()
    for name, slices in (('x264', 4), ('openh264', 4)):
        readers, senders = Readers(), []
        for reads in ('ffmpeg', 'GStreamer'):
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as early:
                early.bind(('127.0.0.1', 0))
                early.settimeout(LIMIT)
                port = early.getsockname()[1]
                senders.append(launch_file('rtp-send', SOURCE=source, PORT=port, ENCODER=encoder(name, slices),
                                           JSON_PORT=free_port(socket.SOCK_DGRAM)))
                early.recv(65536)  # the first keyframe is gone
            if reads == 'ffmpeg':
                pathlib.Path(f'{name}.sdp').write_text(
                    f'v=0\no=- 0 0 IN IP4 127.0.0.1\ns=-\nc=IN IP4 127.0.0.1\nt=0 0\nm=video {port} RTP/AVP 96\n'
                    'a=rtpmap:96 H264/90000\n', 'ascii')
                readers.ffmpeg(name, 'drawn.raw', NEEDED, '-protocol_whitelist', 'file,udp,rtp', '-i', f'{name}.sdp')
            else:
                line = (f'udpsrc address=127.0.0.1 port={port} '
                        'caps=application/x-rtp,media=video,clock-rate=90000,encoding-name=H264 ! rtpjitterbuffer')
                readers.gstreamer(name, 'drawn.raw', NEEDED, f'{line} ! {RTP["h264"]}', ENOUGH)
        readers.compare()
        for sender in senders:
            stop(sender)


def is_open(port):
    lines = pathlib.Path('/proc/net/tcp').read_text('ascii').splitlines()[1:]
    return any(line.split()[1].endswith(f':{port:04X}') for line in lines)


def test_mjpeg():
    source = pictures(MANY, paced=True)
    draw()
    port = free_port()
    sender = launch_file('mjpeg', SOURCE=source, PORT=port)
    wait_until(lambda: is_open(port), sender)
    readers = Readers()
    readers.ffmpeg('MJPEG', 'drawn.raw', NEEDED, '-i', f'tcp://127.0.0.1:{port}')
    line = f'tcpclientsrc port={port} ! multipartdemux ! image/jpeg,framerate={RATE}/1 ! jpegdec'
    readers.gstreamer('MJPEG', 'drawn.raw', NEEDED, f'{line} ! {LIMITED}', ENOUGH)
    readers.compare()
    stop(sender)


def read_file(readers, name, path, before, least, is_jpeg=False):
    readers.ffmpeg(name, before, least, '-i', path)
    convert = f' ! {LIMITED}' if is_jpeg else ''
    readers.gstreamer(name, before, least, f'filesrc location={path} ! decodebin{convert}')


def recording(folder):
    found = [path for path in pathlib.Path(folder).rglob('*.m*') if path.suffix in ('.mp4', '.mkv')]
    assert found, f'no recording in {folder}'
    return str(min(found))


def test_files():
    source = pictures(SOME)
    draw()
    pathlib.Path('pir.csv').write_text('0,0,0,0\n', 'ascii')
    readers = Readers()
    ended(launch_file('annotate', SOURCE=source))
    read_file(readers, 'annotate', 'annotated.mp4', 'drawn.raw', SOME)
    # Its recorder bridges 5 s of a slow encoder: less than this scene, if it came at once.
    ended(launch_file('robot', SOURCE=f'{source} ! clocksync', SENSORS='pirsrc driver=replay location=pir.csv is-live=true',
                      FILE='robot.mkv', JSON=os.devnull, PORT=9, ENCODER=encoder('x264', 4)))
    read_file(readers, 'robot', 'robot.mkv', 'scene.raw', SOME)
    for name, slices in H264:
        title = f'{name}-{slices}'
        os.mkdir(title)
        ended(launch_file('record', SOURCE=source, FOLDER=title, JSON=os.devnull, ENCODER=encoder(name, slices)))
        read_file(readers, f'record, {title}', recording(title), 'scene.raw', SOME)
    os.mkdir('web')
    # The playlist names the newest five files: all of this scene.
    ended(launch_file('hls', SOURCE=f'{source} ! clocksync', FOLDER='web', SECONDS=2, KEEP=0,
                      ENCODER=encoder('x264', 4)))
    readers.ffmpeg('hls', 'drawn.raw', SOME, '-i', 'web/live.m3u8')
    playlist = pathlib.Path('web/live.m3u8').read_text('ascii').split()
    parts = [pathlib.Path('web', line).read_bytes() for line in playlist if line.endswith('.ts')]
    pathlib.Path('whole.ts').write_bytes(b''.join(parts))
    readers.gstreamer('hls', 'drawn.raw', SOME, 'filesrc location=whole.ts ! decodebin')
    readers.compare()


def test_odd(program):
    """H.264 has no odd width or height: the last column or row is scaled away, and nothing else changes."""
    few = 50
    for width, height in ((641, 481), (984, 737)):
        even = width // 2 * 2, height // 2 * 2
        large = (width + 7) // 8 * 8, (height + 7) // 8 * 8  # rawvideoparse takes the lines of others to be padded
        whole = pictures(few, width=large[0], height=large[1])
        must(gst_launch(f'{whole} ! videocrop right={large[0] - even[0]} bottom={large[1] - even[1]} ! {I420} ! '
                        'filesink location=even.raw'))
        source = f'{whole} ! videocrop right={large[0] - width} bottom={large[1] - height}'
        must(gst_launch(f'{source} ! avenc_ffv1 ! matroskamux ! filesink location=odd.mkv'))
        readers = Readers(*even)
        ended(launch_file('annotate', SOURCE=source))
        must(run(['test', '-s', 'annotated.mp4']))
        for name in ('x264', 'openh264'):
            folder = f'{name}-{width}'
            os.mkdir(folder)
            ended(launch_file('record', SOURCE=source, FOLDER=folder, JSON=os.devnull, ENCODER=encoder(name)))
            read_file(readers, f'{width}x{height}, {name}', recording(folder), 'even.raw', few)
        folder = f'robot-{width}'
        pathlib.Path('robot.toml').write_text(robot('odd.mkv', free_port(), folder, 'x264enc', 'openh264enc'), 'ascii')
        server = start([program, 'robot.toml'])
        wait_until(lambda: sum(path.stat().st_size for path in pathlib.Path(folder).rglob('*.mp4')) > 10000, server)
        os.killpg(server.pid, signal.SIGTERM)
        ended(server)
        readers.gstreamer(f'{width}x{height}, cerberusd', 'even.raw', 1,
                          f'filesrc location={recording(folder)} ! decodebin')
        readers.compare()


ROBOT = """
state-folder = "state"
[page]
enabled = false
[rtsp]
port = PORT
encoder = "SHOWN"
[[camera]]
name = "yard"
kind = "file"
file = "FILE"
[camera.persons]
enabled = false
[camera.recorder]
folder = "FOLDER"
encoder = "RECORDED"
"""


def test_resized():
    """A stream whose size changes is annotated, and recorded by the robot, without a damaged picture, each in its size."""
    sizes, each = ((320, 240), (640, 480), (320, 240)), 40
    stream = b''
    for width, height in sizes:
        must(gst_launch(f'{pictures(each, width=width, height=height)} ! videoconvert ! x264enc ! '
                        'video/x-h264,stream-format=byte-stream ! filesink location=part.h264'))
        stream += pathlib.Path('part.h264').read_bytes()
    pathlib.Path('stream.h264').write_bytes(stream)
    source = 'filesrc location=stream.h264 ! decodebin'
    must(gst_launch(f'{source} ! videoconvert ! motiondetect ! motionoverlay ! {I420} ! filesink location=drawn.raw'))
    must(gst_launch(f'{source} ! {I420} ! filesink location=plain.raw'))
    pathlib.Path('pir.csv').write_text('0,0,0,0\n', 'ascii')
    ended(launch_file('annotate', SOURCE=source))
    ended(launch_file('robot', SOURCE=source, SENSORS='pirsrc driver=replay location=pir.csv is-live=true',
                      FILE='robot.mkv', JSON=os.devnull, PORT=9, ENCODER=encoder('x264', 4)))
    compare_sizes('annotated.mp4', 'drawn.raw', sizes, each)
    compare_sizes('robot.mkv', 'plain.raw', sizes, each)


def compare_sizes(path, before, sizes, each):
    """A file with `each` pictures of every size."""
    must(gst_launch(f'filesrc location={path} ! decodebin ! {I420} ! filesink location=GStreamer.raw'))
    if shutil.which('ffmpeg'):
        must(run(f'ffmpeg -nostdin -y -v error -i {path} -noautoscale -fps_mode passthrough -f rawvideo '
                 '-pix_fmt yuv420p ffmpeg.raw'))
    for name in ('GStreamer', 'ffmpeg') if shutil.which('ffmpeg') else ('GStreamer',):
        with open(before, 'rb') as first, open(f'{name}.raw', 'rb') as found:
            for width, height in sizes:
                for file, part in ((first, 'before.raw'), (found, 'after.raw')):
                    pathlib.Path(part).write_bytes(file.read(each * width * height * 3 // 2))
                print(f'{path}, {width}x{height} by {name}:')
                print(must(run([PICTURES, 'compare', width, height, 'before.raw', 'after.raw', each])))
            assert not found.read(), 'more pictures than there were'


def turn(path):
    """Writes into an MP4 of one track that it is shown a quarter turn clockwise (ISO/IEC 14496-12, 8.3.2), as
    telephones do."""
    data = bytearray(pathlib.Path(path).read_bytes())
    at = data.index(b'tkhd') + 44  # version 0: the matrix is behind 40 bytes
    data[at:at + 36] = struct.pack('>9i', 0, 0x10000, 0, -0x10000, 0, 0, WIDTH << 16, 0, 0x40000000)
    pathlib.Path(path).write_bytes(data)


def test_turned(program):
    """A video of a telephone that was held upright is shown upright, whatever it is read for."""
    whole = pictures(SOME)
    must(gst_launch(f'{whole} ! videoconvert ! videoflip video-direction=90l ! x264enc ! mp4mux ! '
                    'filesink location=phone.mp4'))
    turn('phone.mp4')
    source = 'filesrc location=phone.mp4 ! decodebin'
    must(gst_launch(f'{source} ! videoconvert ! videoflip video-direction=90r ! motiondetect ! motionoverlay ! {I420} ! '
                    'filesink location=drawn.raw'))
    readers = Readers()
    os.mkdir('recordings')
    ended(launch_file('record', SOURCE=source, FOLDER='recordings', JSON=os.devnull, ENCODER=encoder('x264')))
    read_file(readers, 'record, turned', recording('recordings'), 'scene.raw', SOME)
    ended(launch_file('annotate', SOURCE=source))
    read_file(readers, 'annotate, turned', 'annotated.mp4', 'drawn.raw', SOME)
    ended(launch_file('live', SOURCE=source, SINK=f'{I420} ! filesink location=live.raw'))
    must(run([PICTURES, 'compare', WIDTH, HEIGHT, 'drawn.raw', 'live.raw', 1]))
    pathlib.Path('robot.toml').write_text(robot('phone.mp4', free_port(), 'yard', 'x264enc', 'x264enc'), 'ascii')
    server = start([program, 'robot.toml'])
    wait_until(lambda: sum(path.stat().st_size for path in pathlib.Path('yard').rglob('*.mp4')) > 10000, server)
    os.killpg(server.pid, signal.SIGTERM)
    ended(server)
    read_file(readers, 'cerberusd, turned', recording('yard'), 'scene.raw', 1)
    readers.compare()


LEVELS = {16: 0, 126: 128, 235: 255}  # black, grey and white, in the range of video, and what an RGB picture shows


def check_levels(name, jpeg):
    pathlib.Path('bands.jpg').write_bytes(jpeg)
    check_bands(name, 'bands.jpg', LEVELS.values())


def check_bands(name, file, levels):
    """Three bands in the first picture of a file have their levels, by ffmpeg."""
    must(run(f'ffmpeg -nostdin -y -v error -i {file} -frames:v 1 -f rawvideo -pix_fmt rgb24 bands.rgb'))
    line = pathlib.Path('bands.rgb').read_bytes()[3 * WIDTH * HEIGHT // 4:]
    for band, level in enumerate(levels):
        at = 3 * (WIDTH * (2 * band + 1) // 6)
        print(f'{name}: {level} is {list(line[at:at + 3])}')
        assert all(abs(each - level) <= 3 for each in line[at:at + 3]), f'{name}: a level of {level} is wrong'


def first_jpeg(data):
    start_of, end_of = data.index(b'\xff\xd8'), data.index(b'\xff\xd9')
    return data[start_of:end_of + 2]


def test_ranges():
    """The JPEGs of a camera have the full range of levels, and no encoder makes them darker or brighter."""
    if not shutil.which('ffmpeg'):
        sys.exit(77)
    levels = 30, 128, 225
    row = b''.join(bytes([level] * 3) * (WIDTH * (band + 1) // 3 - WIDTH * band // 3) for band, level in enumerate(levels))
    pathlib.Path('bands.raw').write_bytes(row * HEIGHT * 5)
    must(gst_launch(f'filesrc location=bands.raw ! rawvideoparse width={WIDTH} height={HEIGHT} format=rgb framerate={RATE}/1 ! '
                    f'{encoder("jpeg")} ! matroskamux ! filesink location=bands.mkv'))
    for name in ('x264', 'openh264', 'vp8'):
        # Files that say nothing of the range themselves, as RTP does not.
        bare = 'avmux_ivf' if name == 'vp8' else 'h264parse ! video/x-h264,stream-format=byte-stream'
        must(gst_launch(f'filesrc location=bands.mkv ! matroskademux ! jpegdec ! videoconvertscale ! video/x-raw,format=I420 ! '
                        f'{encoder(name)} ! {bare} ! filesink location=encoded.{name}'))
        check_bands(name, f'encoded.{name}', levels)


def test_levels(program):
    """JPEGs are as black and as white as the video, which has another range: of pipelines/encoder, MJPEG, the page."""
    if not shutil.which('ffmpeg'):
        sys.exit(77)
    row = b''.join(bytes([level]) * (WIDTH * (band + 1) // 3 - WIDTH * band // 3) for band, level in enumerate(LEVELS))
    pathlib.Path('bands.raw').write_bytes((row * HEIGHT + b'\x80' * (WIDTH * HEIGHT // 2)) * 500)
    must(gst_launch(f'filesrc location=bands.raw ! rawvideoparse width={WIDTH} height={HEIGHT} format=i420 '
                    'framerate=10/1 ! matroskamux ! filesink location=bands.mkv'))
    source = 'filesrc location=bands.mkv ! decodebin'
    must(gst_launch(f'{source} ! {encoder("jpeg")} ! filesink location=encoded.jpg'))
    check_levels('ENCODER=jpeg', first_jpeg(pathlib.Path('encoded.jpg').read_bytes()))
    port = free_port()
    sender = launch_file('mjpeg', SOURCE=f'{source} ! clocksync', PORT=port)
    wait_until(lambda: is_open(port), sender)
    with socket.create_connection(('127.0.0.1', port)) as line:
        data = b''
        while b'\xff\xd9' not in data:
            data += line.recv(65536)
    check_levels('MJPEG', first_jpeg(data))
    stop(sender)
    server, watching = watch_page(program, 'bands.mkv')
    check_levels('page', next_picture(watching))
    os.killpg(server.pid, signal.SIGTERM)
    server.communicate(timeout=LIMIT)


def watch_page(program, file):
    """A cerberusd that shows this video as a camera's, and a browser's socket to its page."""
    port = free_port()
    pathlib.Path('robot.toml').write_text(f'state-folder = "state"\n[page]\nport = {port}\n[[camera]]\n'
                                          f'name = "yard"\nkind = "file"\nfile = "{file}"\n[camera.persons]\nenabled = false\n', 'ascii')
    server = start([program, 'robot.toml'])
    line = server.stdout.readline()
    while 'One-time password' not in line:
        line = server.stdout.readline()
        assert line, 'no password'
    page = Page(port)
    assert page.log_in('owner', re.search(r'([0-9a-f]{16})\n', line)[1]) == 200
    assert page.ask('POST', '/password', {'user': 'owner', 'password': 'long enough'})[0] == 200
    return server, Socket(page)


def next_picture(watching):
    """The next JPEG of the page, which is acknowledged as a browser does."""
    message = watching.receive()
    while not isinstance(message, tuple):
        message = watching.receive()
    watching.send(f'ack {message[0]}')
    return message[2]


def test_page(program):
    """The pictures of the page, one JPEG behind the other."""
    pictures(MANY)
    draw('motiondetect ! pirfusion ! motionoverlay crosshair=true')
    server, watching = watch_page(program, 'scene.mkv')
    pathlib.Path('page.mjpeg').write_bytes(b''.join(next_picture(watching) for _ in range(NEEDED)))
    os.killpg(server.pid, signal.SIGTERM)
    server.communicate(timeout=LIMIT)
    readers = Readers()
    readers.ffmpeg('page', 'drawn.raw', NEEDED, '-f', 'mjpeg', '-i', 'page.mjpeg')
    readers.gstreamer('page', 'drawn.raw', NEEDED, f'filesrc location=page.mjpeg ! jpegparse ! jpegdec ! {LIMITED}')
    readers.compare()


def robot(file, port, folder, recorded, shown):
    """The file of a cerberusd that shows this video as a camera's, with these encoders."""
    text = ROBOT
    for word, value in (('FILE', file), ('PORT', port), ('FOLDER', folder), ('RECORDED', recorded), ('SHOWN', shown)):
        text = text.replace(word, str(value))
    return text


def test_cerberusd(program):
    """Its streams, by both transports: the plain one is what its recorder writes."""
    pictures(MANY, paced=True)
    draw('motiondetect ! pirfusion ! motionoverlay crosshair=true')
    for recorded, shown, plain, annotated in (('h264', 'openh264', 'tcp', 'udp'), ('openh264enc', 'h264', 'udp', 'tcp'),
                                              ('jpegenc', 'vp8enc', 'tcp', 'udp')):
        port, folder, encodings = free_port(), recorded, {'vp8enc': 'vp8', 'jpegenc': 'jpeg'}
        pathlib.Path('robot.toml').write_text(robot('scene.mkv', port, folder, recorded, shown), 'ascii')
        server = start([program, 'robot.toml'])
        wait_until(lambda: is_served(port, '/yard/annotated'), server)
        readers = Readers()
        watch(readers, f'rtsp://127.0.0.1:{port}/yard/plain', 'scene.raw', encodings.get(recorded, 'h264'), plain)
        watch(readers, f'rtsp://127.0.0.1:{port}/yard/annotated', 'drawn.raw', encodings.get(shown, 'h264'), annotated)
        readers.compare()
        os.killpg(server.pid, signal.SIGTERM)
        ended(server)
        readers = Readers()
        read_file(readers, f'recording, {recorded}', recording(folder), 'scene.raw', NEEDED, recorded == 'jpegenc')
        readers.compare()


def main():
    what, program = sys.argv[1], [os.path.abspath(name) for name in sys.argv[3:]]
    if not shutil.which('ffmpeg'):
        print('ffmpeg is not installed: only GStreamer reads, and the test counts as skipped')
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            globals()['test_' + what](*program)
        finally:
            os.chdir('/')
            for process in STARTED:
                if process.poll() is None:
                    os.killpg(process.pid, signal.SIGKILL)
    if not shutil.which('ffmpeg'):
        sys.exit(77)


main()
