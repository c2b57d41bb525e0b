#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The page of cerberusd over loopback: first password, every route and message without a session and with the wrong role,
strangers' origins, wrong passwords, pictures with acknowledgements, steering by one at a time, recordings; over TLS with the
self-made certificate where the openssl tool is. Many idle connections; the webhook with a receiver that fails at first."""
import hashlib
import hmac
import http.server
import json
import os
import pathlib
import random
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

from page_client import PATIENCE, Page, Socket
from rtsp_client import Rtsp


def free_port():
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        return probe.getsockname()[1]


CONFIGURATION = '''
name = "the robot"
state-folder = "state"
[page]
port = PORT
[[camera]]
name = "front"
kind = "test"
width = 160
height = 120
framerate = 10
[camera.head]
[camera.recorder]
folder = "recordings"
encoder = "jpegenc"
post-roll = 0
longest-file = 2
'''


RTSP = '''
[rtsp]
port = STREAM
tls = TLS
users-file = "viewers"
encoder = "jpegenc"
'''


WEBHOOK = '''
[webhook]
url = "http://127.0.0.1:HOOK/cerberus"
secret-file = "secret"
topics = ["mode", "event"]
[base]
command = "sh -c 'cat >> FOLDER/drive'"
max-speed = 0.5
'''
SECRET = 'a secret of 24 characters'


class Receiver(http.server.BaseHTTPRequestHandler):
    """A receiver as docs/manual/webhook.md has it, which refuses the first request for lack of time."""
    events, tries, cut = [], [], False

    def do_POST(self):
        body = self.rfile.read(int(self.headers['Content-Length']))
        stamp = self.headers['Cerberus-Timestamp']
        right = hmac.new(SECRET.encode(), stamp.encode() + b'.' + body, hashlib.sha256).hexdigest()
        assert abs(time.time() - int(stamp)) < 300 and self.headers['Cerberus-Signature'] == 'sha256=' + right
        Receiver.tries.append(json.loads(body)['id'])
        first, third = len(Receiver.tries) == 1, len(Receiver.tries) == 3
        if not first:
            Receiver.events.append(json.loads(body))
        self.send_response(503 if first else 200 if third else 204)
        if third:
            self.send_header('Content-Length', '1000000')
        self.end_headers()
        if third:
            self.trickle()

    def trickle(self):
        """A body that does not end is not waited for: only its sender is."""
        try:
            for _ in range(5 * PATIENCE):
                self.wfile.write(b'x')
                time.sleep(.2)
            raise AssertionError('the body was read')
        except OSError:
            Receiver.cut = True

    def log_message(self, *_):
        pass


def webhook():
    has = lambda topic, question: [one for one in Receiver.events if one['topic'] == topic and question(one['data'])]
    assert Receiver.tries[0] == Receiver.tries[1] == Receiver.events[0]['id'], Receiver.tries
    assert Receiver.events[0]['robot'] == 'the robot' and Receiver.events[0]['camera'] == 'front', Receiver.events[0]
    wait_until('privacy by webhook', lambda: has('mode', lambda data: data == 'privacy'))
    wait_until('the end of an answer that does not end', lambda: Receiver.cut)
    wait_until('a recording by webhook', lambda: has('event', lambda data: data and not data['open']))
    assert len({one['id'] for one in Receiver.events}) == len(Receiver.events)


def is_closed(line):
    line.settimeout(0)
    try:
        return line.recv(1) == b''
    except BlockingIOError:
        return False
    except OSError:
        return True


def count_within(seconds, enough, count):
    """count(), once it is enough, or after these seconds."""
    end = time.monotonic() + seconds
    while (found := count()) < enough and time.monotonic() < end:
        time.sleep(.05)
    return found


def idle_connections(page, process):
    """Of one address 48 are accepted, of the trusted proxies 96, so that others have room; they go on when these are gone,
    and so does who left before the answer. What is refused is closed at once; what is silent, after 10 s: a machine that
    needs so long proves nothing."""
    descriptors = lambda: len(os.listdir(f'/proc/{process.pid}/fd'))
    before = descriptors()
    for source, count, most in (('127.0.0.2', 60, 48), ('127.0.0.1', 110, 96)):
        begin = time.monotonic()
        connect = lambda source: socket.create_connection(('127.0.0.1', page.port), PATIENCE, (source, 0))
        lines = [connect(source) for _ in range(count)]
        other = connect('127.0.0.3')
        took = time.monotonic() - begin
        closed = count_within(5, count - most, lambda: sum(is_closed(line) for line in lines))
        if took < 4:
            assert closed == count - most and not is_closed(other), (source, closed, is_closed(other))
        for line in (*lines, other):
            line.close()
        wait_until('they are gone', lambda: descriptors() <= before + 2)
    body = b'user=owner&password=a+guess'
    line = socket.create_connection(('127.0.0.1', page.port), PATIENCE)
    if page.context:
        line = page.context.wrap_socket(line, server_hostname='127.0.0.1')
    line.sendall((f'POST /login HTTP/1.1\r\nHost: {page.host}\r\nOrigin: {page.origin}\r\nContent-Type: '
                  f'application/x-www-form-urlencoded\r\nContent-Length: {len(body)}\r\n\r\n').encode() + body)
    line.close()
    assert json.loads(page.ask('GET', '/session')[2])['role'] == 'owner'


def one_client_of_a_proxy(page):
    """Of the requests that a trusted proxy hands on 48 of one client are open at once; another client has room."""
    def begun(client, body=b''):
        line = socket.create_connection(('127.0.0.1', page.port), PATIENCE)
        if page.context:
            line = page.context.wrap_socket(line, server_hostname='127.0.0.1')
        line.sendall((f'POST /login HTTP/1.1\r\nHost: {page.host}\r\nOrigin: {page.origin}\r\n'
                      f'X-Forwarded-For: {client}\r\nContent-Length: 9\r\n\r\n').encode() + body)
        return line

    begin, refused = time.monotonic(), set()

    def count():
        for line in lines:
            line.settimeout(.001)
            try:
                if line.recv(100).split()[1:2] == [b'503']:
                    refused.add(line)
            except OSError:
                pass  # no answer yet, or the end of the line behind one
        return len(refused)
    lines = [begun('203.0.113.77') for _ in range(48)] + [begun('203.0.113.77', b'user=none') for _ in range(2)]
    other = page.ask('GET', '/session', headers={'X-Forwarded-For': '198.51.100.8'})[0]
    took = time.monotonic() - begin
    found = count_within(5, 2, count)
    if took < 4:  # a body is waited for as long as 10 s
        assert found == 2 and other == 200, (found, other)
    for line in lines:
        line.close()
    wait_until('its requests are over', lambda: page.ask('GET', '/session', headers={'X-Forwarded-For': '203.0.113.77'})[0] == 200)


def may_ask(page):
    try:
        return page.ask('GET', '/session')[0] == 200
    except OSError:
        return False


def wait_until(what, question):
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        answer = question()
        if answer:
            return answer
        time.sleep(.05)
    raise AssertionError(f'in vain: {what}')


def statuses(page, expected):
    """Every route: method, path, form."""
    for (method, path, form), status in expected.items():
        form = dict(form) if form else ({} if method == 'POST' else None)
        got = page.ask(method, path, form)
        assert got[0] == status, f'{method} {path}: {got[0]} where {status} is right: {got[2][:200]}'


ROUTES = [('GET', '/log', None), ('GET', '/picture/front', None), ('POST', '/picture', (('camera', 'front'),)),
          ('GET', '/events', None), ('GET', '/reasons', None), ('GET', '/events/front/1/video', None), ('GET', '/socket', None),
          ('POST', '/keep', (('camera', 'front'), ('id', '1'))), ('POST', '/delete', (('camera', 'front'), ('id', '1'))),
          ('POST', '/password', (('user', 'owner'), ('password', 'another one'))), ('POST', '/logout', None)]


def drips(page):
    """Heads that never end: twenty connections that send a letter now and then are closed in time, and none has an effect
    on another."""
    lines = [socket.create_connection(('127.0.0.1', page.port), PATIENCE) for _ in range(20)]
    for line in lines:
        line.settimeout(0)
        line.send(b'\x16\x03' if page.context else b'GET / HTTP/1.1\r\nX-Slow: ')
    begin, open_lines = time.monotonic(), set(lines)

    def closed(line):
        try:
            line.send(b'\x03' if page.context else b'x')
            return line.recv(100) == b''
        except BlockingIOError:
            return False
        except OSError:
            return True
    while open_lines:
        open_lines = {line for line in open_lines if not closed(line)}
        assert time.monotonic() - begin < 40, f'{len(open_lines)} connections drip on'
        time.sleep(.5)
    assert page.ask('GET', '/session')[0] == 200


def heads(page):
    """HEAD is GET without the body, and no answer names the server's program."""
    for path in ('/', '/session', '/events', '/page.js'):
        status, headers, body = page.ask('GET', path)
        again, same, nothing = page.ask('HEAD', path)
        assert (status, again, nothing) == (200, 200, b'') and same['Content-Type'] == headers['Content-Type'], path
        assert same['Content-Length'] == str(len(body)) == headers['Content-Length'], (path, same)
        assert 'Server' not in headers and 'Server' not in same, headers
    assert page.ask('HEAD', '/login')[0] == 404 and page.ask('GET', '/nothing')[0] == 404


def proxied(port, log):
    """Behind the proxy that the configuration trusts, guesses lock out the one who makes them."""
    stranger, owner = Page(port), Page(port)
    guess = lambda headers: stranger.ask('POST', '/login', {'user': 'owner', 'password': 'a guess'}, headers=headers)[0]
    answers = [guess({'X-Forwarded-For': f'198.51.100.{k}, 203.0.113.5'}) for k in range(8)]
    assert answers[0] == 403 and answers[-1] == 429, answers
    assert guess({'Forwarded': 'for=198.51.100.9, for="203.0.113.5:99"'}) == 429
    status, _, text = owner.ask('POST', '/login', {'user': 'owner', 'password': 'long enough'},
                                headers={'X-Forwarded-For': '198.51.100.7'})
    assert status == 200, text
    for words in ('203.0.113.5 gave a wrong password for the role owner', 'owner@198.51.100.7 logged in'):
        assert words in log(), f'"{words}" is not in the access log'
    # A stranger who comes by a proxy on this machine is not at this machine.
    answer = stranger.ask('GET', '/session', headers={'X-Forwarded-For': '203.0.113.5'})[2]
    assert json.loads(answer)['first'] is False
    # One whom the proxy's headers do not name is not the proxy: the owner on the machine does not wait for such guesses.
    for header in ({'X-Forwarded-For': '203.0.113.6', 'Forwarded': 'for=127.0.0.1'}, {'Forwarded': 'for=unknown'}):
        answers = [guess(header) for _ in range(8)]
        assert answers[-1] == 429, answers
    assert owner.ask('POST', '/login', {'user': 'owner', 'password': 'long enough'})[0] == 200


def devices(program, port, folder):
    """A screen without a keyboard: its token is made on the machine, kept as a hash, and counts until it is revoked."""
    def tool(*words):
        return subprocess.run([program, *words, folder / 'robot.toml'], capture_output=True, text=True, timeout=PATIENCE, check=False)
    if os.geteuid() == 0:  # an administrator's, for a robot that runs as another user
        os.chown(folder / 'state', 65534, 65534)
    made = tool('--make-device-token', '--device', 'screen')
    token = re.search(r'#device=([0-9a-f]{64})\n', made.stdout)[1]
    assert made.returncode == 0 and made.stdout.count(token) == 2, made
    kept = folder / 'state' / 'devices'
    assert (kept.stat().st_uid, kept.stat().st_gid) == ((folder / 'state').stat().st_uid, (folder / 'state').stat().st_gid)
    assert kept.stat().st_mode & 0o777 == 0o600 and token not in kept.read_text() and 'viewer screen ' in kept.read_text()
    assert tool('--make-device-token', '--device', 'screen').returncode == 1
    assert tool('--make-device-token', '--device', 'x', '--role', 'owner').returncode == 1
    assert tool('--list-devices').stdout == 'screen (viewer)\n'
    screen = Page(port)
    assert screen.ask('POST', '/login', {'device': token[:-1]})[0] == 403
    assert screen.ask('POST', '/login', {'device': token})[0] == 200
    assert screen.ask('GET', '/events')[0] == 200 and screen.ask('POST', '/delete', {'camera': 'front', 'id': '1'})[0] == 403
    screen.cookie = None  # what a restart of the robot comes to
    assert screen.ask('GET', '/events')[0] == 401
    session = json.loads(screen.ask('GET', '/session')[2])
    assert session['role'] == 'viewer' and session['device'] is True, session
    line = Socket(screen)
    assert tool('--revoke-device', 'screen').returncode == 0 and tool('--revoke-device', 'screen').returncode == 1
    wait_until('the revoked device is out', lambda: screen.ask('GET', '/events')[0] == 401)
    while line.receive() is not None:
        pass
    assert json.loads(screen.ask('GET', '/session')[2])['role'] is None
    assert screen.ask('POST', '/login', {'device': token})[0] == 403
    answers = [screen.ask('POST', '/login', {'device': 'a guess'})[0] for _ in range(10)]
    assert 429 in answers, answers


def first_password(page, one_time):
    # Nothing but the entrance is open to a stranger.
    statuses(page, {route: 401 for route in ROUTES})
    statuses(page, {('GET', '/', None): 200, ('GET', '/page.js', None): 200, ('GET', '/page.css', None): 200,
                    ('GET', '/state/passwords', None): 404, ('GET', '/../state/passwords', None): 404,
                    ('PUT', '/login', None): 404, ('GET', '/login', None): 404})
    assert json.loads(page.ask('GET', '/session')[2]) == {
        'robot': 'the robot', 'role': None, 'first': True, 'must-set-password': False, 'device': False}
    headers = page.ask('GET', '/')[1]
    assert "frame-ancestors 'none'" in headers['Content-Security-Policy'] and headers['X-Frame-Options'] == 'DENY'
    # The one-time password opens nothing but the form for the first one.
    assert page.log_in('viewer', one_time) == 403 and page.log_in('owner', one_time) == 200
    cookie = page.ask('POST', '/login', {'user': 'owner', 'password': one_time})[1]['Set-Cookie']
    assert 'HttpOnly' in cookie and ('Secure' in cookie) == bool(page.context), cookie
    statuses(page, {route: 403 for route in ROUTES[:-2]})
    statuses(page, {('POST', '/password', (('user', 'viewer'), ('password', 'long enough'))): 403,
                    ('POST', '/password', (('user', 'owner'), ('password', 'short'))): 400})
    assert page.ask('POST', '/password', {'user': 'owner', 'password': 'long enough'})[0] == 200
    for user in ('operator', 'viewer'):
        assert page.ask('POST', '/password', {'user': user, 'password': 'password of ' + user})[0] == 200
    stranger = Page(page.port)
    assert stranger.log_in('owner', one_time) == 403, 'the one-time password counts twice'


def strangers(page):
    """Of a page elsewhere, with the cookie that a browser would not even send."""
    for origin in ('http://evil.example', 'null', None):
        assert page.ask('POST', '/logout', {}, origin)[0] == 403, origin
        try:
            Socket(page, origin).close()
            raise AssertionError(f'a WebSocket from {origin} was opened')
        except PermissionError as refused:
            assert refused.args[0] == 403
    # Another name that leads here.
    assert Page(page.port, 'evil.example').ask('GET', '/')[0] == 403
    assert page.ask('POST', '/login', {'user': 'x' * 5000, 'password': ''})[0] == 413


def reports(line, wanted):
    """Reads, and acknowledges, until wanted(message) is true; returns that."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        message = line.receive()
        assert message is not None, 'closed'
        if isinstance(message, tuple):
            line.send(f'ack {message[0]}')
        elif 'number' in message:
            line.send(f'seen {message["number"]}')
        if wanted(message):
            return message
    raise AssertionError('in vain')


def head_is(line, *states):
    return reports(line, lambda m: isinstance(m, dict) and m.get('cameras') and m['cameras'][0]['head'] in states)


def refused(message):
    return isinstance(message, dict) and 'refused' in message


def pictures(owner):
    line = Socket(owner)
    hello = line.receive()['hello']
    assert hello['role'] == 'owner' and hello['cameras'][0]['name'] == 'front'
    # Two pictures and two reports of state, and then nothing until one is acknowledged.
    seen, numbers = [], []
    while len(numbers) < 2 or len(seen) < 2:
        message = line.receive()
        if isinstance(message, tuple):
            numbers.append(message[0])
            assert message[1]['camera-name'] == 'front' and message[2][:2] == b'\xff\xd8', message[:2]
        else:
            seen.append(message['number'])
    assert numbers == [1, 2] and seen == [1, 2]
    line.line.settimeout(1.5)
    try:
        raise AssertionError(f'more than two at once: {line.receive()}')
    except TimeoutError:
        pass
    line.line.settimeout(PATIENCE)
    line.send('ack 2')
    assert line.receive()[0] == 3
    line.close()


def watch_streams(port):
    """With a log-in both mounts of the camera give pictures, once they are there. Returns the clients, which watch."""
    clients = []
    for mount in ('plain', 'annotated') if port else ():
        clients.append(wait_until(f'the mount {mount}', lambda mount=mount: player(port, f'/front/{mount}')))
        clients[-1].frames(3)
    return clients


def player(port, path):
    client = Rtsp(port, 'anna', 'long enough')
    return client if client.watch(path) == 200 else None


def steering(owner, operator, viewer, stream):
    first, second, third = Socket(owner), Socket(operator), Socket(viewer)
    for order in ('turn 1 0', 'stop', 'home', 'auto', 'follow 1', 'mode disarmed', 'mode privacy', 'stage mask',
                  'drive 1 0', 'set quality 50'):
        third.send(order)
        assert 'viewer' in reports(third, refused)['refused'], order
    for order in ('mode privacy', 'set quality 50'):
        second.send(order)
        assert 'operator' in reports(second, refused)['refused'], order
    third.close()  # who does not answer for 30 s is closed
    # A turn is manual and ends by itself; while one steers no other may, but everyone may stop.
    second.send('turn 0.5 0')
    head_is(first, 'manual', 'limited')
    for _ in range(200):  # on a slow machine either may be the one that has the head
        second.send('turn 0.5 0')
        first.send('turn -1 0')
        if any(refused(reports(line, lambda m: refused(m) or isinstance(m, tuple))) for line in (first, second)):
            break
    else:
        raise AssertionError('two steer at once')
    # A turn that was on its way takes the head again after the stop: the orders are repeated.
    def is_automatic(message):
        if not isinstance(message, dict) or 'cameras' not in message:
            return False
        if message['cameras'][0]['head'] in ('tracking', 'holding', 'zeroing', 'searching', 'turning', 'stopped'):
            return True
        first.send('stop')
        first.send('auto')
        return False
    reports(first, is_automatic)
    second.close()
    first.send('mode disarmed')
    reports(first, lambda m: isinstance(m, dict) and m.get('mode') == 'disarmed')
    before = reports(first, lambda m: isinstance(m, tuple) and m[1])[1]['frame']
    watching = watch_streams(stream)
    if stream:
        assert Rtsp(stream).watch('/front/plain') == 401 and Rtsp(stream, 'anna', 'guess').watch('/front/plain') == 401
    first.send('mode privacy')
    # Nothing is shown from now on, also while the head parks.
    reports(first, lambda m: isinstance(m, dict) and m.get('mode') == 'privacy')
    assert not stream or Rtsp(stream, 'anna', 'long enough').watch('/front/plain') == 404, 'privacy has a stream'
    assert all(client.is_closed() for client in watching), 'privacy shows a stream'
    reports(first, lambda m: isinstance(m, dict) and m.get('mode') == 'privacy' and m['cameras'][0]['state'] == 'off')
    assert owner.ask('GET', '/events?camera=front')[0] == 403, 'privacy shows events'
    second = Socket(operator)
    second.send('mode armed')
    assert 'operator' in reports(second, refused)['refused'], 'who may not begin privacy ended it'
    # What was drawn while privacy began is never shown: the first facts are those of a new stream.
    first.send('mode disarmed')
    first.send('camera front')
    first_facts = reports(first, lambda m: isinstance(m, tuple))[1]
    watch_streams(stream)
    assert first_facts is None or first_facts['frame'] < before, 'a picture from before privacy is shown after it'
    for wrong in ('nonsense', 'ack 1000000', 'seen 1000000'):
        third = Socket(viewer)
        third.send(wrong)
        try:
            while third.receive() is not None:
                pass
        except ConnectionError:
            pass
        third.close()
    for line in (first, second):
        line.close()


def reload_while_parking(owner, process, folder):
    """Settings that change while the head parks count where privacy ends before it has."""
    log, file, line = folder / 'log', folder / 'robot.toml', Socket(owner)
    before = reports(line, lambda m: isinstance(m, tuple) and m[1])[1]['frame']
    count = log.read_text().count('cerberusd: mode privacy')
    line.send('mode privacy')
    wait_until('privacy', lambda: log.read_text().count('cerberusd: mode privacy') > count)
    file.write_text(file.read_text().replace('framerate = 10', 'framerate = 11'))
    process.send_signal(signal.SIGHUP)
    wait_until('the other settings', lambda: 'front: changed, its pipeline starts anew' in log.read_text())
    line.send('mode disarmed')
    after = reports(line, lambda m: isinstance(m, tuple) and m[1])[1]['frame']
    assert after < before, 'the pipeline of the old settings goes on'
    line.close()


def stop_outlasts_a_restart(owner, process, folder):
    """A head that was stopped by hand stands, too, when the camera's pipeline starts anew, until it is given back."""
    log, file, line = folder / 'log', folder / 'robot.toml', Socket(owner)
    camera = lambda test: reports(line, lambda m: isinstance(m, dict) and 'cameras' in m and test(m['cameras'][0]))['cameras'][0]
    line.send('stop')
    camera(lambda one: one['stopped'] and one['head'] == 'manual')
    count = log.read_text().count('front: changed, its pipeline starts anew')
    file.write_text(file.read_text().replace('framerate = 11', 'framerate = 12'))
    process.send_signal(signal.SIGHUP)
    wait_until('the other settings', lambda: log.read_text().count('front: changed, its pipeline starts anew') > count)
    before = reports(line, lambda m: isinstance(m, tuple) and m[1])[1]['frame']
    reports(line, lambda m: isinstance(m, tuple) and m[1] and m[1]['frame'] != before)
    for _ in range(3):
        one = camera(lambda one: one['state'] == 'running' and one['rate'] > 0)
        assert one['stopped'] and one['head'] == 'manual', one
    line.send('auto')
    camera(lambda one: not one['stopped'] and one['head'] != 'manual')
    line.close()


def base(owner, operator, folder):
    """A drive that is not repeated ends by itself; STOP ends one at once, also another's until that lets go, and so does
    the end of the page. Orders are repeated: a program of the base that gets no processor time is started anew."""
    drive = folder / 'drive'
    line = Socket(operator)
    wait_until('the program of the base', drive.exists)
    before = len(drive.read_text())  # stops of other tests
    lines = lambda: drive.read_text()[before:]

    def settled():
        """Ends with a stop, and nothing comes any more."""
        earlier = lines()
        time.sleep(.6)
        return earlier.endswith('stop\n') and earlier == lines()

    def repeated(orders, question):
        def sent(_):
            for order in orders:
                line.send(order)
            return question()
        reports(line, sent)
    repeated(['drive 0.5 -1'], lambda: lines().startswith('drive 0.25 -45\n'))
    wait_until('the end of a drive', settled)
    assert re.fullmatch(r'((drive 0.25 -45\n)+stop\n)+', lines()), lines()
    count = lines().count('stop')
    repeated(['drive -1 0', 'stop'], lambda: lines().count('stop') > count)
    repeated(['drive 1 0'], lambda: 'drive 0.5 0' in lines())
    # Of another session: what was moving is refused, for longer than the head is held, until it lets go.
    other = Socket(owner)
    other.send('stop')
    is_refused = lambda m: refused(m) or line.send('drive 1 0')
    reports(line, is_refused)
    wait_until('the stop of another', settled)
    stopped, end = lines(), time.monotonic() + 2.5  # the head is held for 2 s
    while time.monotonic() < end:
        reports(line, is_refused)
    assert settled() and lines() == stopped, lines()
    other.close()
    line.send('drive 0 0')
    before = len(drive.read_text())
    repeated(['drive 1 0'], lambda: 'drive 0.5 0' in lines())
    line.close()
    wait_until('the end with the page', settled)


def stages(owner):
    """The picture of another stage, the settings and the log of an owner."""
    line = Socket(owner)
    line.send('stage mask')
    reports(line, lambda m: isinstance(m, dict) and m.get('cameras') and m['cameras'][0]['stage'] == 'mask')
    reports(line, lambda m: isinstance(m, tuple))
    line.send('stage picture')
    line.send('set quality 30')
    line.send('set return-delay 60')
    reports(line, lambda m: isinstance(m, dict) and m.get('cameras') and m['cameras'][0]['stage'] == 'picture')
    line.close()
    log = wait_until('the log', lambda: 'sets quality of front to 30' in owner.ask('GET', '/log')[2].decode())
    assert log
    wait_until('a long time', lambda: 'sets return-delay of front to 60' in owner.ask('GET', '/log')[2].decode())


def many_sockets(viewer):
    """Four sockets of a session are open, a fifth one is closed."""
    lines = [Socket(viewer) for _ in range(4)]
    assert all('hello' in line.receive() for line in lines)
    fifth = Socket(viewer)
    assert fifth.receive() is None
    for line in [*lines, fifth]:
        line.close()


def recordings(owner, operator, viewer, folder):
    rows = wait_until('an event', lambda: [row for row in json.loads(owner.ask('GET', '/events?camera=front')[2])
                                           if not row['open']])
    identity = str(rows[-1]['id'])
    form = {'camera': 'front', 'id': identity}
    status, headers, whole = viewer.ask('GET', f'/events/front/{identity}/video')
    assert status == 200 and headers['Content-Type'] == 'video/x-matroska' and whole[:4] == b'\x1a\x45\xdf\xa3'
    # A file of several chunks: it comes whole, or at most 1 MiB of it.
    path = max((folder / 'recordings').rglob('*.mkv'), key=lambda one: one.read_bytes() == whole)
    with open(path, 'ab') as file:
        file.write(random.Random(1).randbytes(3 << 20))
    whole = path.read_bytes()
    video, size = f'/events/front/{identity}/video', len(whole)
    assert viewer.ask('GET', video)[2] == whole
    for asked, first, last in (('4-9', 4, 9), ('7-', 7, (1 << 20) + 6), (f'{size - 5}-', size - 5, size - 1),
                               ('-5', size - 5, size - 1)):
        status, headers, part = viewer.ask('GET', video, headers={'Range': f'bytes={asked}'})
        assert status == 206 and part == whole[first:last + 1], asked
        assert headers['Content-Range'] == f'bytes {first}-{last}/{size}', headers
    assert viewer.ask('GET', video, headers={'Range': f'bytes={size}-'})[0] == 416
    assert viewer.ask('GET', video, headers={'Range': 'bytes=0-1,3-4'})[2] == whole
    assert viewer.ask('GET', f'/events/front/{identity}/picture')[2][:2] == b'\xff\xd8'
    for path in ('/events/front/999999/video', '/events/back/1/video', f'/events/front/{identity}/..', '/events/front',
                 f'/events/front/{identity}/%2e%2e%2f'):
        assert viewer.ask('GET', path)[0] in (400, 404), path
    assert viewer.ask('POST', '/keep', form | {'keep': '1'})[0] == 403
    assert operator.ask('POST', '/keep', form | {'keep': '1'})[0] == 200
    assert [row['keep'] for row in json.loads(viewer.ask('GET', '/events?camera=front')[2])
            if str(row['id']) == identity] == [True]
    # What is asked of the list, the index answers.
    ask = lambda words: [str(row['id']) for row in json.loads(viewer.ask('GET', f'/events?camera=front&{words}')[2])]
    everything = ask('')
    assert ask('kept=1') == [identity] and ask('kept=1&reason=nothing') == []
    assert ask('most=1') == everything[:1] and ask(f'below={everything[0]}&most=200') == everything[1:]
    row = next(row for row in rows if str(row['id']) == identity)
    assert identity in ask(f'from={row["begin"]}&until={row["begin"] + 1}') and identity not in ask(f'until={row["begin"]}')
    reasons = json.loads(viewer.ask('GET', '/reasons?camera=front')[2])
    assert 'track' in reasons and everything and all(ask(f'reason={reason}') for reason in reasons), reasons
    saved = time.strftime('front_%Y-%m-%d_%H-%M-%S.mkv', time.localtime(row['begin'] // 1000))
    assert row['name'] == saved and saved in viewer.ask('GET', video)[1]['Content-Disposition'], (row, saved)
    assert operator.ask('POST', '/delete', form)[0] == 403 and viewer.ask('POST', '/delete', form)[0] == 403
    assert owner.ask('POST', '/delete', form)[0] == 200
    assert viewer.ask('GET', f'/events/front/{identity}/video')[0] == 404
    assert owner.ask('POST', '/delete', form)[0] == 409
    assert viewer.ask('POST', '/password', {'user': 'owner', 'password': 'taken over'})[0] == 403


def wrong_passwords(port):
    tries = [Page(port).log_in('owner', 'guess') for _ in range(11)]
    # Two were given before to this account: by a stranger, and on a connection that was closed.
    assert tries[:3] == [403] * 3 and 429 in tries[3:], tries


def main():
    with tempfile.TemporaryDirectory() as name:
        folder, port = pathlib.Path(name), free_port()
        receiver = http.server.HTTPServer(('127.0.0.1', 0), Receiver)
        threading.Thread(target=receiver.serve_forever, daemon=True).start()
        (folder / 'secret').write_text(SECRET + '\n')
        (folder / 'secret').chmod(0o600)
        stream = free_port() if sys.argv[2] == 'rtsp' else None
        (folder / 'viewers').write_text('anna:long enough\n')
        (folder / 'viewers').chmod(0o600)
        tls = shutil.which('openssl')
        page = f'port = {port}\ntrusted-proxy = "127.0.0.1"\n' + ('tls = true' if tls else '')
        (folder / 'robot.toml').write_text(CONFIGURATION.replace('port = PORT', page)
                                           + WEBHOOK.replace('HOOK', str(receiver.server_port)).replace('FOLDER', name)
                                           + (RTSP.replace('STREAM', str(stream)).replace('TLS', str(bool(tls)).lower()) if stream else ''))
        with open(folder / 'log', 'w+', encoding='utf-8') as log:
            taken = socket.create_server(('127.0.0.1', port))
            process = subprocess.Popen([sys.argv[1], folder / 'robot.toml'], stdout=log, stderr=subprocess.STDOUT)
            try:
                # The robot runs while its page's port is in use, and opens the page later.
                wait_until('a port in use', lambda: 'the page cannot listen at' in (folder / 'log').read_text())
                taken.close()
                one_time = wait_until('the one-time password', lambda: re.search(
                    r'One-time password .*: ([0-9a-f]{16})\n', (folder / 'log').read_text()))[1]
                if tls:
                    Page.certificate = folder / 'state' / 'page-certificate.pem'
                    assert (folder / 'state' / 'page-key.pem').stat().st_mode & 0o777 == 0o600
                owner = Page(port)
                Rtsp.context = owner.context
                first_password(owner, one_time)
                operator, viewer = Page(port), Page(port)
                assert operator.log_in('operator', 'password of operator') == 200
                assert viewer.log_in('viewer', 'password of viewer') == 200
                strangers(owner)
                heads(owner)
                proxied(port, (folder / 'log').read_text)
                devices(sys.argv[1], port, folder)
                pictures(owner)
                steering(owner, operator, viewer, stream)
                reload_while_parking(owner, process, folder)
                stop_outlasts_a_restart(owner, process, folder)
                many_sockets(viewer)
                base(owner, operator, folder)
                stages(owner)
                assert operator.ask('GET', '/log')[0] == 403 and viewer.ask('POST', '/picture', {'camera': 'x'})[0] == 404
                recordings(owner, operator, viewer, folder)
                webhook()
                idle_connections(owner, process)
                one_client_of_a_proxy(owner)
                drips(owner)
                assert viewer.ask('POST', '/logout', {})[0] == 200 and viewer.ask('GET', '/events')[0] == 401
                wrong_passwords(port)
                process.send_signal(signal.SIGTERM)
                code = process.wait(PATIENCE)
                text = (folder / 'log').read_text()
                assert code == 0, text
                assert (folder / 'state' / 'passwords').stat().st_mode & 0o777 == 0o600
                for words in ('owner@127.0.0.1 logged in', '127.0.0.1 gave a wrong password for the role owner', 'operator@127.0.0.1 steers front', 'owner@127.0.0.1 deleted',
                              'owner@127.0.0.1 sets mode privacy'):
                    assert words in text, f'"{words}" is not in the access log: {text}'
                for secret in ('long enough', 'password of operator', 'password of viewer', 'guess'):
                    assert secret not in text, f'"{secret}" is in the log'
            except BaseException:
                print((folder / 'log').read_text(), file=sys.stderr)
                raise
            finally:
                process.kill()


if __name__ == '__main__':
    main()
