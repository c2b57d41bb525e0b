#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Broken files and odd streams: a clear error or a sane result; never a crash, a hang or silence."""
import pathlib
import random

from support import all_tests, ball, gst_launch, json_lines, must, video

TAIL = 'motiondetect ! motionjson ! filesink location=out.jsonl'


# Not decodebin, which in GStreamer 1.22 may keep the demuxer's error to itself and then wait for ever.
DEMUXERS = {'.avi': 'avidemux', '.mp4': 'qtdemux', '.mkv': 'matroskademux'}


def through(path):
    demuxer = DEMUXERS[pathlib.Path(path).suffix]
    return gst_launch(f'filesrc location={path} ! {demuxer} ! h264parse ! avdec_h264 ! videoconvert ! {TAIL}')


def sane(lines, frames):
    """Lines of whole frames in order; each object lies within its frame."""
    assert len(lines) <= frames
    for line in lines:
        for thing in line['objects']:
            assert thing['x'] >= 0 and thing['y'] >= 0, line
            assert thing['x'] + thing['w'] <= line['width'] and thing['y'] + thing['h'] <= line['height'], line


def judge(path, frames):
    pathlib.Path('out.jsonl').unlink(missing_ok=True)
    status, said = through(path)
    if status == 0:
        sane(json_lines('out.jsonl'), frames)
    else:
        assert 'ERROR' in said, said
    return status, said


def test_videos_cut_off_anywhere():
    for name, muxer in (('v.avi', 'avimux'), ('v.mp4', 'mp4mux'), ('v.mkv', 'matroskamux')):
        whole = video(name, muxer).read_bytes()
        for share in (0.02, 0.3, 0.9):
            pathlib.Path('cut-' + name).write_bytes(whole[:int(len(whole) * share)])
            judge('cut-' + name, 60)


def test_videos_with_a_hole():
    chance = random.Random(1)
    for name, muxer in (('v.avi', 'avimux'), ('v.mp4', 'mp4mux'), ('v.mkv', 'matroskamux')):
        data = bytearray(video(name, muxer).read_bytes())
        for _ in range(40):
            data[chance.randrange(200, len(data))] = chance.randrange(256)
        start = len(data) // 2
        data[start:start + len(data) // 10] = bytes(len(data) // 10)
        pathlib.Path('hole-' + name).write_bytes(data)
        judge('hole-' + name, 70)  # a decoder may repeat a frame it could not read


def test_a_file_of_no_bytes():
    pathlib.Path('empty.avi').touch()
    status, said = through('empty.avi')
    assert status != 0 and 'ERROR' in said, said


def test_the_size_changes_in_mid_stream():
    must(gst_launch(f'concat name=c ! {TAIL} {ball(frames=30)} ! c. '
                    f'{ball(frames=30, width=640, height=360, name="wide")} ! c.'))
    lines = json_lines('out.jsonl')
    assert [line['width'] for line in lines] == [320] * 30 + [640] * 30
    sane(lines, 60)
    after = [bool(line['objects']) for line in lines[30:]]
    assert not any(after[:2]), 'a region before three frames of the new size were seen'
    assert any(after), 'nothing was found after the change'


def test_a_stream_smaller_than_the_smallest_is_refused_and_videoscale_helps():
    """The caps of the pads promise what is accepted, so that videoscale in front negotiates by itself."""
    status, said = gst_launch(f'{ball(width=16, height=16)} ! {TAIL}')
    assert status != 0 and 'link' in said, said
    must(gst_launch(f'{ball(width=16, height=16)} ! videoscale ! {TAIL}'))
    assert all(line['width'] >= 32 and line['height'] >= 32 for line in json_lines('out.jsonl'))


def test_interlaced_video_is_refused_and_deinterlace_is_named():
    status, said = gst_launch('videotestsrc num-buffers=10 ! video/x-raw,format=I420,width=320,height=240,'
                              f'interlace-mode=interleaved ! {TAIL}')
    assert status != 0 and 'deinterlace' in said, said


def test_so_is_video_of_single_fields():
    """Also where what follows would not take it; and what is named helps."""
    fields = ('videotestsrc num-buffers=20 ! video/x-raw,format=I420,width=320,height=240,framerate=50/1 ! '
              'interlace field-pattern=1 ! video/x-raw(format:Interlaced),interlace-mode=alternate')
    for line in (TAIL, 'cameramotion ! videoscale ! video/x-raw,width=160 ! fakesink', 'motionview ! fakesink',
                 'virtualptz ! fakesink'):
        status, said = gst_launch(f'{fields} ! {line}')
        assert status != 0 and 'deinterlace' in said, said
    must(gst_launch(f'{fields} ! deinterlace ! {TAIL}'))
    assert len(json_lines('out.jsonl')) >= 20


def test_a_stream_without_a_frame_rate():
    must(gst_launch('videotestsrc num-buffers=60 ! video/x-raw,format=I420,width=320,height=240,framerate=25/1 ! '
                    f'capssetter caps=video/x-raw,framerate=0/1 ! {TAIL}'))
    assert len(json_lines('out.jsonl')) == 60


def test_odd_sizes():
    for width, height in ((33, 35), (32, 32), (641, 37)):
        must(gst_launch(f'{ball(width=width, height=height)} ! {TAIL}'))
        lines = json_lines('out.jsonl')
        assert len(lines) == 60
        sane(lines, 60)


def test_nothing_at_all():
    must(gst_launch(f'{ball(frames=1)} ! identity drop-probability=1 ! {TAIL}'))
    assert pathlib.Path('out.jsonl').read_bytes() == b''


all_tests(globals())
