#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""`pipelines/setup person` against a server on loopback: what it stores, and that it stores nothing where it fails.

The files are made here, and their sums stand in a copy of the script in place of the published ones.
"""
import hashlib
import http.server
import os
import pathlib
import shutil
import stat
import subprocess
import tempfile
import threading

from support import TOP, LIMIT, all_tests

CFG, WEIGHTS = 'yolo-fastest-1.1_body.cfg', 'yolo-fastest-1.1_body.weights'
PUBLISHED = {CFG: '045b8e276ebe3924474da8c866b7e709159ea067137b5d66bf9dd560411b2c1a',
             WEIGHTS: '5bbb6d878f6e2eb3deee39e91dc6f9b39700e99ec83fa94d258670a554949728'}
CONTENT = {CFG: b'[net]\nwidth=320\n', WEIGHTS: bytes(range(256)) * 600}
DOWNLOADERS = ('curl', 'wget', 'python3')
# What the script and its downloaders run.
COMMANDS = ('bash', 'cut', 'dirname', 'env', 'mkdir', 'mktemp', 'mv', 'rm', 'sed', 'sh', 'sha256sum')


class Server:
    """Serves what is in `files`, and counts the requests."""
    def __init__(self, files):
        server = self

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_GET(self):
                server.asked.append(self.path)
                body = server.files.get(self.path.rpartition('/')[2])
                self.send_response(200 if body is not None else 404)
                self.send_header('Content-Length', str(len(body or b'')))
                self.end_headers()
                self.wfile.write(body or b'')

            def log_message(self, *_):
                pass

        self.files, self.asked = dict(files), []
        self.http = http.server.ThreadingHTTPServer(('127.0.0.1', 0), Handler)
        self.url = f'http://127.0.0.1:{self.http.server_port}/body'
        threading.Thread(target=self.http.serve_forever, daemon=True).start()

    def close(self):
        self.http.shutdown()
        self.http.server_close()


class Place:
    """A copy of the script with the sums of CONTENT, a server, and a folder to store into."""
    def __enter__(self):
        self.work = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.work.name)
        text = (TOP / 'pipelines' / 'setup').read_text()
        for name, published in PUBLISHED.items():
            assert published in text, f'the sum of {name} is another one'
            text = text.replace(published, hashlib.sha256(CONTENT[name]).hexdigest())
        self.script = self.folder / 'pipelines' / 'setup'
        self.script.parent.mkdir()
        self.script.write_text(text)
        self.script.chmod(0o755)
        self.server = Server(CONTENT)
        self.models = self.folder / 'data' / 'cerberus' / 'models'
        return self

    def __exit__(self, *_):
        self.server.close()
        self.work.cleanup()

    def run(self, *words, **environment):
        """(exit status, all that it says). A variable that is None is not set."""
        there = {'PATH': os.environ['PATH'], 'HOME': '/nowhere', 'XDG_DATA_HOME': str(self.folder / 'data'),
                 'CERBERUS_PERSON_URL': self.server.url, 'no_proxy': '127.0.0.1', **environment}
        done = subprocess.run([self.script, 'person', *words], timeout=LIMIT, text=True,
                              env={name: value for name, value in there.items() if value is not None},
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        return done.returncode, done.stdout

    def only(self, downloader):
        """A PATH on which no other downloader is."""
        path = self.folder / f'only-{downloader}'
        path.mkdir()
        for command in (*COMMANDS, downloader):
            where = shutil.which(command, path='/usr/bin:/bin')
            if where:
                (path / command).symlink_to(where)
        return str(path)

    def stored(self, folder=None):
        folder = folder or self.models
        return {path.name: path.read_bytes() for path in folder.iterdir()} if folder.exists() else {}


def refused(result, *what):
    status, said = result
    assert status == 1, said
    for words in what:
        assert words in said, f'no "{words}" in:\n{said}'


def test_both_files_are_stored_where_the_desktop_keeps_data():
    with Place() as place:
        status, said = place.run()
        assert status == 0, said
        assert place.stored() == CONTENT
        assert 'licence' in said and f'model={place.models / WEIGHTS}' in said, said
        assert place.server.asked == [f'/body/{CFG}', f'/body/{WEIGHTS}']
        assert stat.S_IMODE((place.models / WEIGHTS).stat().st_mode) & 0o444 == 0o444


def test_a_folder_may_be_named_and_without_one_it_is_in_the_home():
    with Place() as place:
        named, home = place.folder / 'a folder', place.folder / 'home'
        assert place.run(str(named))[0] == 0
        assert place.stored(named) == CONTENT
        assert place.run(HOME=str(home), XDG_DATA_HOME=None)[0] == 0
        assert place.stored(home / '.local/share/cerberus/models') == CONTENT
        refused(place.run(HOME=None, XDG_DATA_HOME=None), 'FOLDER')


def test_each_downloader_does():
    for downloader in DOWNLOADERS:
        with Place() as place:
            if not shutil.which(downloader, path='/usr/bin:/bin'):
                print(f'skipped: no {downloader}')
                continue
            status, said = place.run(PATH=place.only(downloader))
            assert status == 0, said
            assert place.stored() == CONTENT
            del place.server.files[WEIGHTS]
            (place.models / WEIGHTS).unlink()
            refused(place.run(PATH=str(place.folder / f'only-{downloader}')), WEIGHTS, '404', 'Nothing was stored')
    with Place() as place:
        refused(place.run(PATH=place.only('true')), 'neither curl nor wget nor python3')


def test_what_is_there_already_is_not_downloaded_again():
    with Place() as place:
        assert place.run()[0] == 0
        place.server.asked.clear()
        status, said = place.run()
        assert status == 0 and 'already' in said and 'licence' in said, said
        assert place.server.asked == []


def test_a_damaged_file_is_replaced():
    with Place() as place:
        assert place.run()[0] == 0
        (place.models / WEIGHTS).write_bytes(b'')
        assert place.run()[0] == 0
        assert place.stored() == CONTENT


def test_a_file_with_another_sum_is_not_stored():
    for name in CONTENT:
        with Place() as place:
            place.server.files[name] += b'.'
            refused(place.run(), name, 'not the file that is expected', 'Nothing was stored')
            assert place.stored() == {}


def test_what_was_there_stays_where_the_new_one_is_wrong():
    with Place() as place:
        place.models.mkdir(parents=True)
        (place.models / WEIGHTS).write_bytes(b'mine')
        place.server.files[WEIGHTS] = b'<html>'
        refused(place.run(), 'not the file that is expected')
        assert place.stored() == {WEIGHTS: b'mine'}


def test_without_a_network_nothing_is_stored():
    with Place() as place:
        place.server.close()
        refused(place.run(), 'could not download', 'Nothing was stored')
        assert place.stored() == {}


def test_a_full_disk_and_a_folder_that_cannot_be_written_are_named():
    with Place() as place:
        # A file may be no longer than 100 kB; who ignores the signal gets an error instead.
        limited = place.folder / 'limited'
        limited.write_text(f'#!/bin/bash\nulimit -f 100\ntrap "" XFSZ\nexec "{place.script}" "$@"\n')
        limited.chmod(0o755)
        place.script = limited
        refused(place.run(), 'is the disk full?', 'Nothing was stored')
        assert place.stored() == {}
        refused(place.run('/proc/models'), 'cannot write to /proc/models')


all_tests(globals())
