#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A recorder in one file, to begin an own one with: records the encoded video of a camera or a file as it came, around
what moves in it, prints what it records, and lists at the end what the index has.

    recorder.py rtsp://192.168.1.64/main /var/lib/recordings
    recorder.py file:///home/me/yard.mp4 .

SIGUSR1 begins an event, SIGUSR2 ends it. Ctrl-C ends the program: open files are completed first.
"""
import pathlib
import signal
import sqlite3
import sys

import gi
gi.require_version('Gst', '1.0')
from gi.repository import GLib, Gst  # noqa: E402  (the version must be required before the import)

# Encoded video goes to the recorder; a decoded branch is analysed. Queues without limits: the recorder, not a full
# queue, decides what is kept.
QUEUE = 'queue max-size-buffers=0 max-size-bytes=0 max-size-time=0'
PIPELINE = f'''
    urisourcebin name=source ! parsebin ! video/x-h264 ! tee name=encoded
    eventrecorder name=recorder pre-roll=3000000000 post-roll=3000000000
    encoded. ! {QUEUE} ! h264parse ! recorder.video
    encoded. ! {QUEUE} ! avdec_h264 ! videoconvert ! motiondetect ! recorder.analysis'''


class Recorder:
    def __init__(self, uri, folder):
        self.uri, self.folder = uri, pathlib.Path(folder)
        self.status = 0
        self.loop = GLib.MainLoop()
        self.pipeline = Gst.parse_launch(PIPELINE)  # raises where an element is missing
        self.pipeline.get_by_name('source').set_property('uri', uri)
        self.recorder = self.pipeline.get_by_name('recorder')
        self.recorder.set_property('location', str(folder))
        self.bus = self.pipeline.get_bus()
        self.bus.add_signal_watch()
        self.bus.connect('message', self.on_message)
        for number, action in ((signal.SIGINT, self.finish), (signal.SIGTERM, self.finish),
                               (signal.SIGUSR1, lambda: self.recorder.emit('start-event', 'manual')),
                               (signal.SIGUSR2, lambda: self.recorder.emit('stop-event'))):
            GLib.unix_signal_add(GLib.PRIORITY_HIGH, number, self.call, action)

    @staticmethod
    def call(action):
        action()
        return GLib.SOURCE_CONTINUE

    def finish(self):
        """EOS passes through the pipeline, so that the recorder completes its files; its message ends the loop."""
        self.pipeline.send_event(Gst.Event.new_eos())

    def on_message(self, _bus, message):
        if message.type == Gst.MessageType.ELEMENT:
            self.on_facts(message.get_structure())
        elif message.type == Gst.MessageType.WARNING:
            print(message.parse_warning().gerror.message, file=sys.stderr)
        elif message.type == Gst.MessageType.ERROR:
            print(f'{self.uri}: {message.parse_error().gerror.message}', file=sys.stderr)
            self.status = 1
            self.loop.quit()
        elif message.type == Gst.MessageType.EOS:
            self.loop.quit()

    def on_facts(self, facts):
        if facts.get_name() != 'cerberus-recording':
            return
        line = [facts.get_string('state'), facts.get_string('location') or '-', f"({facts.get_string('reason') or '-'})"]
        if facts.has_field('duration'):
            line += [f"{facts.get_value('duration') / Gst.SECOND:.1f} s,", f"{facts.get_value('size')} bytes"]
        print(*line, flush=True)

    def run(self):
        self.pipeline.set_state(Gst.State.PLAYING)  # a failure is an error message on the bus
        self.loop.run()
        self.pipeline.set_state(Gst.State.NULL)
        self.bus.remove_signal_watch()
        return self.status

    def events(self):
        """Rows of the index: other programs may read it at any time, too."""
        index = self.folder / 'recordings.sqlite'
        if not index.exists():  # a build without SQLite, or a start that failed
            return []
        with sqlite3.connect(f'file:{index}?mode=ro', uri=True) as connection:
            return connection.execute('SELECT event, file, tracks, "end" - "begin", open FROM recordings').fetchall()


def main():
    if len(sys.argv) != 3:
        sys.exit(f'usage: {sys.argv[0]} URI FOLDER')
    Gst.init(None)
    try:
        recorder = Recorder(*sys.argv[1:])
    except GLib.Error as error:
        sys.exit(error.message)
    status = recorder.run()
    for event, file, tracks, duration, is_open in recorder.events():
        print(f'event {event}: {file}, {duration / Gst.SECOND:.1f} s, tracks {tracks or "-"}'
              f'{", open" if is_open else ""}')
    sys.exit(status)


if __name__ == '__main__':
    main()
