#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the page of cerberusd costs, and how old its picture is on a canvas of Chromium, at 1280x720 and 25 frames a second.

    page.py CERBERUSD [PICTURE_WIDTH ...]

The camera is a pipe (a file of kind YUV4MPEG) with the pictures of vtest.avi. Each frame carries the time at which its
first byte is written, as black and white blocks; a script in the page reads them back from the canvas before each of the
browser's own frames (requestAnimationFrame). Latency is the difference of both clocks, to 1 ms: it contains the way
through the pipe, detection, drawing, JPEG, WebSocket, the browser's decoder, and up to 17 ms until its next frame.
A viewer's CPU is that of cerberusd while a page is open minus that while none is, in pairs. Then pages stall, are reloaded
and vanish, 50 of each: memory, latency of another page, and moves of the head are compared with those of before.
"""
import fcntl
import mmap
import multiprocessing
import os
import pathlib
import re
import signal
import socket
import statistics
import struct
import subprocess
import sys
import tempfile
import time

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / 'tests' / 'pipelines'))
from page_client import Page, Socket  # noqa: E402
from robot_browser import Visit, browser  # noqa: E402
from robot_page import free_port  # noqa: E402

WIDTH, HEIGHT, RATE = 1280, 720, 25
DEFAULT = 640       # picture-width, for which MOST_CPU is promised
PICTURES = 100      # of the video, which are repeated
BITS, BLOCK = 48, 16  # 40 bits of microseconds, 8 of their sum; pixels
MOST_LATENCY, MOST_CPU = 30, 6          # ms, percent of a core
MOST_MORE_LATENCY, MOST_MORE_MEMORY = 5, 5  # ms, MiB
TIMES = 50
PAIRS, PAIR = 5, 5  # of CPU; seconds of each half
SETPIPE_SIZE = 1031
BLOCKSIZE = 4096   # of filesrc
HEADER = f'YUV4MPEG2 W{WIDTH} H{HEIGHT} F{RATE}:1 Ip A1:1 C420jpeg\n'.encode()

CONFIGURATION = '''
state-folder = "state"
[page]
port = PORT
picture-width = PICTURE
[[camera]]
name = "front"
kind = "file"
file = "video"
[camera.head]
driver = "external"
command = "sh -c 'read hello; echo ready 1 position velocity rate 50; cat >> FOLDER/head'"
'''

READER = '''
window.ages = [];
let last = -1;
const canvas = document.getElementById('picture');
function look() {
  const block = BLOCK * canvas.width / WIDTH;
  const data = canvas.getContext('2d').getImageData(0, Math.floor(canvas.height - block / 2), canvas.width, 1).data;
  let micros = 0, sum = 0, check = 0;
  for (let k = 0; k < 48; ++k) {
    const bit = data[4 * Math.floor((k + .5) * block)] > 127 ? 1 : 0;
    if (k < 40) micros = micros * 2 + bit;
    else check = check * 2 + bit;
  }
  for (let rest = micros; rest > 0; rest = Math.floor(rest / 256)) sum += rest % 256;
  if (sum % 256 === check && micros !== last) {
    last = micros;
    const now = Math.round((Date.now() + .5) * 1000) % 2 ** 40;
    window.ages.push((now - micros) / 1000);
  }
  requestAnimationFrame(look);
}
look();
'''.replace('BLOCK', str(BLOCK)).replace('WIDTH', str(WIDTH))


def stamp(frame):
    """Writes the time of now into the last rows of a frame."""
    micros = (time.time_ns() // 1000) % (1 << 40)
    value = micros << 8 | sum(micros.to_bytes(5, 'big')) % 256
    row = b''.join((b'\xeb' if value >> (BITS - 1 - k) & 1 else b'\x10') * BLOCK for k in range(BITS))
    for y in range(HEIGHT - BLOCK, HEIGHT):
        frame[y * WIDTH:y * WIDTH + len(row)] = row


def camera(pipe, pictures):
    """Writes frames at their times until nothing reads them any more."""
    size = WIDTH * HEIGHT * 3 // 2
    with open(pictures, 'rb') as file:
        data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    try:
        with open(pipe, 'wb', buffering=0) as out:
            fcntl.fcntl(out, SETPIPE_SIZE, 1 << 20)
            number, start, sent, skip, begin = 0, None, 0, 0, HEADER + b'FRAME\n'
            while True:
                picture = bytearray(data[number % PICTURES * size:(number % PICTURES + 1) * size])
                if start:
                    time.sleep(max(0, start + number / RATE - time.monotonic()))
                stamp(picture)
                number += 1
                # filesrc waits for whole blocks: the first bytes of the next picture fill the last one of this.
                piece = begin + picture[skip:] + b'FRAME\n'
                skip = -(sent + len(piece)) % BLOCKSIZE
                piece += data[number % PICTURES * size:number % PICTURES * size + skip]
                sent += len(piece)
                left = memoryview(piece)
                while left:
                    left = left[out.write(left):]
                # The pipeline is made while it takes the first frame: those after it are never early.
                start = start or time.monotonic()
                begin = b''
    except BrokenPipeError:
        pass


class Robot:
    def __init__(self, program, folder, picture):
        self.folder, self.port = folder, free_port()
        # The settings want a file; this one is over at once, and what is opened after it is the pipe.
        size = WIDTH * HEIGHT * 3 // 2
        with open(folder.parent / 'pictures', 'rb') as pictures:
            (folder / 'video').write_bytes(HEADER + b'FRAME\n' + pictures.read(size))
        os.mkfifo(folder / 'pipe')
        (folder / 'head').touch()
        (folder / 'robot.toml').write_text(CONFIGURATION.replace('PORT', str(self.port)).replace('FOLDER', str(folder))
                                           .replace('PICTURE', str(picture)))
        self.source = multiprocessing.Process(target=camera, args=(folder / 'pipe', folder.parent / 'pictures'), daemon=True)
        with open(folder / 'log', 'w', encoding='utf-8') as log:
            self.process = subprocess.Popen([program, folder / 'robot.toml'], stdout=log, stderr=subprocess.STDOUT)
        try:
            self.source.start()
            self.one_time = self.one_time_password()
            os.replace(folder / 'pipe', folder / 'video')
        except BaseException:
            self.close()
            raise

    def close(self):
        try:
            self.process.send_signal(signal.SIGTERM)
            self.process.wait(60)
        finally:
            self.process.kill()
            if self.source.pid:
                self.source.kill()

    def one_time_password(self):
        while self.process.poll() is None:
            found = re.search(r'One-time password .*: ([0-9a-f]{16})\n', (self.folder / 'log').read_text())
            if found:
                return found[1]
            time.sleep(.05)
        raise AssertionError((self.folder / 'log').read_text())

    def cpu(self):
        """Seconds, of all threads."""
        fields = pathlib.Path(f'/proc/{self.process.pid}/stat').read_text().rsplit(')', 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')

    def memory(self):
        """MiB, the least of 2 s."""
        least = 1e9
        for _ in range(20):
            text = pathlib.Path(f'/proc/{self.process.pid}/status').read_text()
            least = min(least, int(re.search(r'VmRSS:\s+(\d+)', text)[1]) / 1024)
            time.sleep(.1)
        return least

    def moves(self):
        """Orders to move that the head was given (docs/manual/head-protocol.md)."""
        return len(re.findall('^move .*(to|at)', (self.folder / 'head').read_text(), re.M))


def watcher(port, cookie, order):
    """A page in a process of its own that acknowledges at once, until `order` is closed."""
    page = Page(port)
    page.cookie = cookie
    line = Socket(page)
    while not order.is_set():
        message = line.receive()
        if isinstance(message, tuple):
            line.send(f'ack {message[0]}')
        elif 'number' in message:
            line.send(f'seen {message["number"]}')
    line.close()


def cpu_of_viewer(robot, page):
    """Percent of a core: of each pair."""
    shares = []
    for _ in range(PAIRS):
        halves = []
        for watched in (False, True):
            order = multiprocessing.Event()
            viewer = multiprocessing.Process(target=watcher, args=(robot.port, page.cookie, order), daemon=True)
            if watched:
                viewer.start()
            time.sleep(1)
            before, begin = robot.cpu(), time.monotonic()
            time.sleep(PAIR)
            halves.append(100 * (robot.cpu() - before) / (time.monotonic() - begin))
            order.set()
            if watched:
                viewer.join()
        shares.append(halves)
    return shares


def ages(driver, seconds):
    """The ages of the pictures on the canvas, ms, while so many seconds pass."""
    driver.execute_script('window.ages = []')
    time.sleep(seconds)
    return driver.execute_script('return window.ages')


def described(found):
    ordered = sorted(found)
    return (f'median {statistics.median(ordered):.1f} ms, 95 % below {ordered[len(ordered) * 95 // 100]:.1f} ms, '
            f'most {ordered[-1]:.1f} ms ({len(ordered)} pictures)')


def watch(driver, visit):
    visit.wait('a picture', visit.has_picture)
    driver.execute_script(READER)


def stalls(page):
    """A page that reads nothing after its first picture."""
    line = Socket(page)
    line.line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    while not isinstance(line.receive(), tuple):
        pass
    time.sleep(.3)
    line.close()


def vanishes(page):
    """A page that acknowledges some pictures and whose connection breaks (a reset, as of a process that was killed)."""
    line = Socket(page)
    for _ in range(6):
        message = line.receive()
        if isinstance(message, tuple):
            line.send(f'ack {message[0]}')
    line.line.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack('ii', 1, 0))
    line.close()


def measure(program, folder, picture):
    robot, driver, missed = Robot(program, folder, picture), None, []

    def judged(text, value, most, promised=True):
        right = value <= most
        print(f'  {text}' + ('' if right else f'   MISSED: {most} is asked' if promised else
                             f'   {most} is promised at {DEFAULT}'), flush=True)
        if promised and not right:
            missed.append(text)
    try:
        print(f'picture-width {picture}')
        owner = Page(robot.port)
        assert owner.log_in('owner', robot.one_time) == 200
        assert owner.ask('POST', '/password', {'user': 'owner', 'password': 'long enough'})[0] == 200
        line = Socket(owner)  # nothing of the video moves the head from now on
        line.send('stop')
        time.sleep(3)
        line.close()
        shares = cpu_of_viewer(robot, owner)
        share = statistics.median(after - before for before, after in shares)
        judged(f'one viewer: {share:.1f} % of a core (cerberusd {statistics.median(row[0] for row in shares):.0f} % without; '
               f'pairs {", ".join(f"{after - before:.1f}" for before, after in shares)})', share, MOST_CPU, promised=picture <= DEFAULT)
        driver = browser()
        visit = Visit(driver, robot.port)
        visit.log_in('owner', 'long enough')
        watch(driver, visit)
        ages(driver, 3)
        before = ages(driver, 20)
        judged(f'frame to canvas: {described(before)}', statistics.median(before), MOST_LATENCY)
        for _ in range(2):  # what is allocated once is no leak
            stalls(owner)
            vanishes(owner)
            driver.refresh()
            watch(driver, visit)
        memory, moves = robot.memory(), robot.moves()
        for name, act in (('stalled', lambda: stalls(owner)), ('reloaded', driver.refresh), ('vanished', lambda: vanishes(owner))):
            for _ in range(TIMES):
                act()
                if name == 'reloaded':
                    visit.wait('a picture', visit.has_picture)
            if name == 'reloaded':
                watch(driver, visit)
            ages(driver, 1)
            after = ages(driver, 10)
            more = statistics.median(after) - statistics.median(before)
            judged(f'{name} {TIMES} times: another page {described(after)}', more, MOST_MORE_LATENCY)
            more = robot.memory() - memory
            judged(f'{name} {TIMES} times: {more:+.1f} MiB of {memory:.0f}', more, MOST_MORE_MEMORY)
        judged(f'orders to move the head in that time: {robot.moves() - moves}', robot.moves() - moves, 0)
    except BaseException:
        print((folder / 'log').read_text(), file=sys.stderr)
        raise
    finally:
        try:
            if driver:
                driver.quit()
        finally:
            robot.close()
    return missed


def main():
    data = pathlib.Path(os.environ.get('CERBERUS_DATA', TOP.parent / 'shared' / 'data'))
    source = data / 'pets09_s2l1_view1' / 'vtest.avi'
    if not source.exists():
        print(f'skipped: {source} is missing')
        sys.exit(77)
    missed = []
    with tempfile.TemporaryDirectory() as name:
        subprocess.run(['gst-launch-1.0', '-q', *f'filesrc location={source} ! decodebin ! identity eos-after={PICTURES} ! '
                        f'videoconvert ! videoscale ! video/x-raw,format=I420,width={WIDTH},height={HEIGHT},'
                        f'pixel-aspect-ratio=1/1 ! filesink location={name}/pictures'.split()], check=True)
        size = pathlib.Path(name, 'pictures').stat().st_size
        assert size == PICTURES * WIDTH * HEIGHT * 3 // 2, size
        for picture in [int(one) for one in sys.argv[2:]] or [DEFAULT, WIDTH]:
            folder = pathlib.Path(name, str(picture))
            folder.mkdir()
            missed += measure(sys.argv[1], folder, picture)
    sys.exit(1 if missed else 0)


if __name__ == '__main__':
    main()
