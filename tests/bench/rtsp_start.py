#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""How soon a new RTSP client has a keyframe at a GOP of 250, that is with one every 10 s.

    rtsp_start.py CERBERUS-RTSP [CLIENTS]

A live 640x480 at 25 frames a second, x264enc. Clients come one after the other at random moments, while another one watches
all the time. Times are those from the first request, DESCRIBE, to the last packet of the keyframe that the client receives.
Judged: .6 s, of every client.
"""
import pathlib
import random
import re
import subprocess
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / 'pipelines'))
from rtsp_client import Rtsp  # noqa: E402

LIMIT = .6
LINE = ('videotestsrc is-live=true pattern=ball ! video/x-raw,format=I420,width=640,height=480,framerate=25/1 ! '
        'x264enc tune=zerolatency speed-preset=ultrafast key-int-max=250 ! h264parse ! appsink name=plain')
IDR, SINGLE_TIME, FRAGMENT = 5, 24, 28  # types of NAL units (H.264), and of payloads that hold several or a part (RFC 6184)


def keyframe_ends(packet):
    """Whether the packet is the last one of a picture (its marker), and whether it has a part of an IDR picture."""
    payload = packet[12 + 4 * (packet[0] & 15):]
    kind = payload[0] & 31
    kinds = {payload[1] & 31} if kind == FRAGMENT else {kind}
    if kind == SINGLE_TIME:
        at, kinds = 1, set()
        while at + 2 < len(payload):
            kinds.add(payload[at + 2] & 31)
            at += 2 + int.from_bytes(payload[at:at + 2], 'big')
    return bool(packet[1] & 0x80), IDR in kinds


def seconds_to_keyframe(port):
    client = Rtsp(port)
    begin = time.monotonic()
    status = client.watch('/plain')
    assert status == 200, status
    while True:
        channel, packet = client.packet()
        if channel == 0 and keyframe_ends(packet) == (True, True):
            client.line.close()
            return time.monotonic() - begin


def main():
    clients = int(sys.argv[2]) if len(sys.argv) > 2 else 20
    server = subprocess.Popen([sys.argv[1], '--port', '0', *LINE.split()], stdout=subprocess.PIPE, text=True)
    try:
        port = int(re.search(r':(\d+)/plain', server.stdout.readline())[1])
        other = Rtsp(port)
        assert other.watch('/plain') == 200
        threading.Thread(target=other.is_closed, daemon=True).start()  # reads until the server ends
        times = []
        for _ in range(clients):
            time.sleep(.2 + random.random())
            times.append(seconds_to_keyframe(port))
    finally:
        server.kill()
        server.wait()
    times.sort()
    print(f'a whole keyframe after the first request: median {times[len(times) // 2]:.3f} s, at most {times[-1]:.3f} s '
          f'({clients} clients, a keyframe every 10 s)')
    sys.exit(int(times[-1] > LIMIT))


main()
