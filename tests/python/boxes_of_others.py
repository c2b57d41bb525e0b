# SPDX-License-Identifier: LGPL-2.1-or-later
"""The manual's program for Hailo, with a stand-in for the module `hailo`: what motiondetect tracks becomes a person, as the
stand-in finds one there at every tenth frame."""
import json
import pathlib
import re
import sys
import tempfile
import types
import unittest

from support import BALL, Gst, frames

MANUAL = pathlib.Path(__file__).resolve().parents[2] / 'docs' / 'manual' / 'metadata.md'
WIDTH, HEIGHT, INTERVAL = 320, 240, 10


class Detection:
    def __init__(self, label, x, y, w, h):
        self.get_label, self.get_confidence = lambda: label, lambda: 0.9
        self.get_bbox = lambda: types.SimpleNamespace(
            xmin=lambda: x / WIDTH, ymin=lambda: y / HEIGHT, width=lambda: w / WIDTH, height=lambda: h / HEIGHT)


def lines_of(pipeline):
    buffers = list(frames(f'{pipeline} ! motiondetect ! motionjson ! appsink name=sink sync=false'))
    return [json.loads(buffer.extract_dup(0, buffer.get_size())) for buffer in buffers]


class Program(unittest.TestCase):
    def test_its_boxes_are_persons(self):
        alone = lines_of(BALL)
        self.assertTrue(all(len(line['objects']) == 1 for line in alone[INTERVAL:]))
        self.assertTrue(all(each['witnesses'] == ['motion'] for line in alone for each in line['objects'] or []))
        count = 0

        def objects(kind):
            self.assertEqual(kind, 'detection')
            found = [Detection('car', -8, -8, 30, 20)]
            for each in alone[count - 1]['objects'] or [] if (count - 1) % INTERVAL == 0 else []:
                found.append(Detection('person', *(each[key] for key in 'xywh')))
            return found

        def roi_of(buffer):
            nonlocal count
            self.assertIsInstance(buffer, Gst.Buffer)
            count += 1
            return types.SimpleNamespace(get_objects_typed=objects)

        sys.modules['hailo'] = types.SimpleNamespace(get_roi_from_buffer=roi_of, HAILO_DETECTION='detection')
        programs = re.findall(r'^```python\n(.*?)^```', MANUAL.read_text('utf-8'), re.S | re.M)
        program, = (each for each in programs if 'import hailo' in each)
        with tempfile.TemporaryDirectory() as folder:
            lines = pathlib.Path(folder) / 'lines'
            program, changed = re.subn(r'^DETECTOR = \(.*?\)$', f"DETECTOR = '{BALL} ! queue'", program, flags=re.S | re.M)
            self.assertEqual((changed, program.count('fdsink')), (1, 1))
            exec(program.replace('fdsink', f'filesink location={lines}'), {'__name__': 'program'})
            both = [json.loads(line) for line in lines.read_text('utf-8').splitlines()]
        self.assertEqual((count, len(both)), (len(alone), len(alone)))
        for line in both[2 * INTERVAL + 1:]:
            person, = line['objects']
            self.assertEqual((person['type'], person['witnesses']), ('person', ['motion', 'person']))
        self.assertEqual(len({each['id'] for line in both for each in line['objects'] or []}), 1)


unittest.main(argv=sys.argv[:1])
