# SPDX-License-Identifier: LGPL-2.1-or-later
"""A browser's part of the page's protocol: requests with a session cookie, and WebSockets after RFC 6455."""
import base64
import http.client
import json
import os
import socket
import ssl
import struct
import urllib.parse

PATIENCE = 100  # seconds


class Page:
    """With `certificate`, the file of a self-made one, over TLS."""
    certificate = None

    def __init__(self, port, host=None):
        self.port, self.cookie, self.device = port, None, None
        self.host = host or f'127.0.0.1:{port}'
        self.context = ssl.create_default_context(cafile=self.certificate) if self.certificate else None
        self.origin = f'http{"s" if self.context else ""}://{self.host}'

    def ask(self, method, path, form=None, origin='own', headers=(), source='127.0.0.1'):
        """Status, headers and body of one request."""
        how = {'timeout': PATIENCE, 'source_address': (source, 0)}
        line = http.client.HTTPConnection('127.0.0.1', self.port, **how)
        if self.context:
            line = http.client.HTTPSConnection('127.0.0.1', self.port, context=self.context, **how)
        send = {'Host': self.host} | dict(headers)
        cookies = ['other=1'] + [f'{key}={value}' for key, value in
                                 (('cerberus', self.cookie), ('cerberus-device', self.device)) if value]
        if len(cookies) > 1:
            send['Cookie'] = '; '.join(cookies)
        if origin:
            send['Origin'] = self.origin if origin == 'own' else origin
        body = None
        if form is not None:
            body = urllib.parse.urlencode(form)
            send['Content-Type'] = 'application/x-www-form-urlencoded'
        line.request(method, path, body, send)
        answer = line.getresponse()
        text = answer.read()
        found = dict(answer.getheaders())
        line.close()
        for name, value in answer.getheaders():
            key, _, cookie = value.split(';')[0].partition('=')
            if name == 'Set-Cookie' and key == 'cerberus':
                self.cookie = cookie or None
            elif name == 'Set-Cookie' and key == 'cerberus-device':
                assert 'HttpOnly' in value and 'SameSite=Strict' in value, value
                self.device = cookie or None
        return answer.status, found, text

    def log_in(self, user, password):
        return self.ask('POST', '/login', {'user': user, 'password': password})[0]


class Socket:
    """Raises PermissionError with the status where the server refuses."""

    def __init__(self, page, origin='own'):
        self.line = socket.create_connection(('127.0.0.1', page.port), PATIENCE)
        if page.context:
            self.line = page.context.wrap_socket(self.line, server_hostname='127.0.0.1')
        key = base64.b64encode(os.urandom(16)).decode()
        lines = ['GET /socket HTTP/1.1', f'Host: {page.host}', 'Upgrade: websocket', 'Connection: Upgrade',
                 f'Sec-WebSocket-Key: {key}', 'Sec-WebSocket-Version: 13']
        if page.cookie:
            lines.append(f'Cookie: cerberus={page.cookie}')
        if origin:
            lines.append(f'Origin: {page.origin if origin == "own" else origin}')
        self.line.sendall(('\r\n'.join(lines) + '\r\n\r\n').encode())
        self.rest = b''
        head = self.until(b'\r\n\r\n').decode()
        status = int(head.split()[1])
        if status != 101:
            self.line.close()
            raise PermissionError(status)

    def until(self, mark):
        while mark not in self.rest:
            more = self.line.recv(65536)
            if not more:
                raise ConnectionError('closed')
            self.rest += more
        head, self.rest = self.rest.split(mark, 1)
        return head

    def take(self, size):
        while len(self.rest) < size:
            more = self.line.recv(65536)
            if not more:
                raise ConnectionError('closed')
            self.rest += more
        taken, self.rest = self.rest[:size], self.rest[size:]
        return taken

    def receive(self):
        """The next message: text as JSON, a picture as (number, facts, JPEG), None where the server closes."""
        while True:
            first, second = self.take(2)
            size = second & 127
            if size == 126:
                size, = struct.unpack('>H', self.take(2))
            elif size == 127:
                size, = struct.unpack('>Q', self.take(8))
            payload = self.take(size)
            kind = first & 15
            if kind == 1:
                return json.loads(payload)
            if kind == 2:
                number, length = struct.unpack('>QI', payload[:12])
                return number, json.loads(payload[12:12 + length]) if length else None, payload[12 + length:]
            if kind == 8:
                return None

    def send(self, text):
        data, mask = text.encode(), os.urandom(4)
        assert len(data) < 126 or len(data) < 65536
        size = bytes([128 | len(data)]) if len(data) < 126 else bytes([254]) + struct.pack('>H', len(data))
        self.line.sendall(b'\x81' + size + mask + bytes(b ^ mask[k % 4] for k, b in enumerate(data)))

    def close(self):
        self.line.close()
