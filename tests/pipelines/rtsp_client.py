# SPDX-License-Identifier: LGPL-2.1-or-later
"""A player's part of RTSP (RFC 2326) with a log-in by digest (RFC 2617) and packets on the connection itself; and the
requests that a server reads."""
import hashlib
import re
import socket
import ssl
import time

PATIENCE = 100  # seconds


def requests(stream):
    """The method, the URI and the header fields of each request without a body, until the connection is closed."""
    while True:
        lines = []
        while (line := stream.readline()) != b'\r\n':
            if not line:
                return
            lines.append(line.decode().strip())
        method, uri, _ = lines[0].split()
        yield method, uri, dict(line.split(': ', 1) for line in lines[1:])


class Rtsp:
    """With `context`, of TLS, by rtsps."""
    context = None

    def __init__(self, port, user='', password=''):
        self.line = socket.create_connection(('127.0.0.1', port), PATIENCE)
        self.scheme = 'rtsp'
        if self.context:
            self.line, self.scheme = self.context.wrap_socket(self.line, server_hostname='127.0.0.1'), 'rtsps'
        self.user, self.password, self.port = user, password, port
        self.number, self.challenge, self.session, self.rest = 0, '', '', b''

    def read(self, size):
        while len(self.rest) < size:
            more = self.line.recv(65536)
            if not more:
                raise ConnectionError('the server closed the connection')
            self.rest += more
        taken, self.rest = self.rest[:size], self.rest[size:]
        return taken

    def packet(self):
        """The channel and the bytes of the next packet."""
        head = self.read(4)
        assert head[:1] == b'$', head
        return head[1], self.read(int.from_bytes(head[2:], 'big'))

    def ask(self, method, path, *headers):
        """Status, headers and body of a request; the second time with the log-in that the server asks for."""
        for last in (False, True):
            self.number += 1
            lines = [f'{method} {self.scheme}://127.0.0.1:{self.port}{path} RTSP/1.0', f'CSeq: {self.number}', *headers]
            if self.session:
                lines.append(f'Session: {self.session}')
            if self.challenge:
                lines.append(self.authorization(method, f'{self.scheme}://127.0.0.1:{self.port}{path}'))
            self.line.sendall(('\r\n'.join(lines) + '\r\n\r\n').encode())
            status, found, body = self.answer()
            if status != 401 or last or not self.user:
                return status, found, body
            self.challenge = re.search(r'WWW-Authenticate: (Digest .*)', found)[1]

    def authorization(self, method, address):
        realm, nonce = (re.search(f'{key}="([^"]*)"', self.challenge)[1] for key in ('realm', 'nonce'))

        def md5(text):
            return hashlib.md5(text.encode()).hexdigest()
        response = md5(f'{md5(f"{self.user}:{realm}:{self.password}")}:{nonce}:{md5(f"{method}:{address}")}')
        return (f'Authorization: Digest username="{self.user}", realm="{realm}", nonce="{nonce}", uri="{address}", '
                f'response="{response}"')

    def answer(self):
        while True:
            head = self.read(1)
            if head != b'$':
                break
            self.read(int.from_bytes(self.read(3)[1:], 'big'))
        while not head.endswith(b'\r\n\r\n'):
            head += self.read(1)
        text = head.decode()
        length = re.search(r'Content-Length: (\d+)', text)
        return int(text.split()[1]), text.replace('\r', ''), self.read(int(length[1])) if length else b''

    def watch(self, path):
        """Plays the first stream of a mount. Returns the status of what was refused, or 200."""
        status, _, body = self.ask('DESCRIBE', path, 'Accept: application/sdp')
        if status != 200:
            return status
        control = re.findall(rb'a=control:(\S+)', body)[1].decode()
        control = control.rsplit('/', 1)[-1]
        status, found, _ = self.ask('SETUP', f'{path}/{control}', 'Transport: RTP/AVP/TCP;unicast;interleaved=0-1')
        if status != 200:
            return status
        self.session = re.search(r'Session: ([^;\s]+)', found)[1]
        return self.ask('PLAY', path, 'Range: npt=0-')[0]

    def frames(self, count):
        """Waits for this many whole pictures, by the marker of their last packets."""
        while count:
            channel, packet = self.packet()
            if channel == 0 and packet[1] & 0x80:
                count -= 1

    def is_closed(self):
        """Reads what is left; True: the server has closed the connection. Raises TimeoutError if it does not."""
        end = time.monotonic() + PATIENCE
        try:
            while time.monotonic() < end:
                self.packet()
        except (ConnectionError, ssl.SSLError):
            return True
        raise TimeoutError('packets come all the time')
