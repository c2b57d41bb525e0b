#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Reads what sensors, fusion and head tell from Python, through GObject introspection: pose, base and decision on the
frames, the messages on the bus, the lines of motionjson.

The class at the end is the example: the whole loop, closed on a test picture, and a program that listens to it.
"""
import json
import math
import pathlib
import sys
import tempfile
import unittest

from support import CAPS, Cerberus, Gst, TIMEOUT, frames

SECOND = Gst.SECOND


def readings(sensors):
    """The PIR readings of a GLib.Bytes as a list: 0 nothing, 1 motion, 2 invalid."""
    return list(sensors.get_data())


def stamp(seconds):
    """The stamp of something that happened at that running time."""
    result = Cerberus.Stamp.new()
    result.running_time = seconds * SECOND
    return result


class OnAPlainBuffer(unittest.TestCase):
    def setUp(self):
        self.buffer = Gst.Buffer.new_allocate(None, 16, None)

    def test_a_bare_buffer_has_nothing(self):
        self.assertIsNone(Cerberus.buffer_get_pose(self.buffer))
        self.assertIsNone(Cerberus.buffer_get_base(self.buffer))
        self.assertIsNone(Cerberus.buffer_get_fusion(self.buffer))

    def test_a_pose_reads_back_and_is_evaluated(self):
        pose = Cerberus.Pose.new()
        self.assertEqual((pose.head, pose.pan, pose.tilt, pose.moving, pose.settled), ("head", 0, 0, False, True))
        pose.set_head("attic")
        pose.pan, pose.tilt, pose.pan_speed, pose.pan_acceleration = -30.5, 4, 10, -2
        pose.valid_from, pose.valid_until = 2 * SECOND, 3 * SECOND
        pose.source, pose.moving, pose.settled = Cerberus.PoseSource.MEASURED, True, False
        self.assertTrue(Cerberus.buffer_set_pose(self.buffer, pose))
        found = Cerberus.buffer_get_pose(self.buffer)
        self.assertEqual((found.head, found.pan, found.tilt, found.pan_speed, found.tilt_speed, found.pan_acceleration),
                         ("attic", -30.5, 4, 10, 0, -2))
        self.assertEqual((found.valid_from, found.valid_until), (2 * SECOND, 3 * SECOND))
        self.assertEqual((found.source, found.moving, found.settled), (Cerberus.PoseSource.MEASURED, True, False))
        within, pan, tilt = found.evaluate(2 * SECOND + SECOND // 2)
        self.assertEqual((within, pan, tilt), (True, -30.5 + 10 * 0.5 - 2 * 0.5 ** 2 / 2, 4))
        self.assertFalse(found.evaluate(5 * SECOND)[0])
        back = Cerberus.event_parse_pose(Cerberus.event_new_pose(found))
        self.assertEqual((back.head, back.pan, back.valid_until), ("attic", -30.5, 3 * SECOND))

    def test_a_base_reads_back(self):
        base = Cerberus.Base.new()
        base.yaw_rate, base.source, base.valid_from = -12.5, Cerberus.BaseSource.REPORTED, 7
        self.assertTrue(Cerberus.buffer_set_base(self.buffer, base))
        found = Cerberus.buffer_get_base(self.buffer)
        self.assertEqual((found.yaw_rate, found.source), (-12.5, Cerberus.BaseSource.REPORTED))
        back = Cerberus.event_parse_base(Cerberus.event_new_base(found))
        self.assertEqual((back.yaw_rate, back.valid_from), (-12.5, 7))

    def test_a_decision_reads_back(self):
        fusion = Cerberus.Fusion.new()
        self.assertEqual(fusion.action, Cerberus.FusionAction.HOLD)
        self.assertTrue(math.isnan(fusion.pan) and math.isnan(fusion.sector_from) and math.isnan(fusion.sector_to))
        self.assertEqual(readings(fusion.get_sensors()), [])
        fusion.rule, fusion.action, fusion.target = 3, Cerberus.FusionAction.SEARCH, 9
        fusion.pan, fusion.sector_from, fusion.sector_to = -5.5, 60, 180
        fusion.limited, fusion.camera_found, fusion.doubtful = True, True, 4
        self.assertTrue(Cerberus.buffer_set_fusion(self.buffer, fusion))
        found = Cerberus.buffer_get_fusion(self.buffer)
        self.assertEqual((found.rule, found.action, found.target), (3, Cerberus.FusionAction.SEARCH, 9))
        self.assertEqual((found.pan, found.sector_from, found.sector_to), (-5.5, 60, 180))
        self.assertEqual((found.limited, found.camera_found, found.doubtful), (True, True, 4))
        message = Cerberus.message_new_fusion(None, stamp(8), found)
        self.assertEqual(message.get_structure().get_name(), Cerberus.MESSAGE_FUSION)
        told = Cerberus.message_parse_fusion(message)
        self.assertEqual((told.rule, told.action, told.target, Cerberus.message_parse_stamp(message).running_time),
                         (3, Cerberus.FusionAction.SEARCH, 9, 8 * SECOND))

    def test_what_the_head_does_reads_back(self):
        message = Gst.Message.new_element(None, Gst.Structure.from_string(
            'cerberus-pantilt, running-time=(guint64)6000000000, state=limited, reason="the stop is near", '
            'head=attic, pan=20.0, tilt=-3.0')[0])
        self.assertTrue(Cerberus.message_is_pantilt(message))
        found = Cerberus.message_parse_pantilt(message)
        self.assertEqual((found.pose.head, found.pose.pan, found.pose.tilt), ("attic", 20, -3))
        self.assertEqual((found.state, found.reason), (Cerberus.PantiltState.LIMITED, "the stop is near"))
        self.assertEqual(found.pose.valid_from, 6 * SECOND)

    def test_another_message_is_none_of_ours(self):
        stranger = Gst.Message.new_eos(None)
        self.assertIsNone(Cerberus.message_parse_pir(stranger))
        self.assertIsNone(Cerberus.message_parse_fusion(stranger))
        self.assertIsNone(Cerberus.message_parse_pantilt(stranger))


class WithATurningRobot(unittest.TestCase):
    """The application tells how the robot turns, by an event upstream; frames and sensors know it from then on."""

    def test_what_it_tells_is_on_the_frames_and_in_the_lines(self):
        pipeline = Gst.parse_launch(f"appsrc name=source caps={CAPS} format=time ! motiondetect ! pirfusion ! "
                                    "tee name=t "
                                    "t. ! queue ! motionjson ! appsink name=lines sync=false "
                                    "t. ! queue ! appsink name=frames sync=false")
        source, lines, sink = map(pipeline.get_by_name, ("source", "lines", "frames"))
        pipeline.set_state(Gst.State.PLAYING)
        told, written = [], []
        for number in range(4):
            if number == 2:
                turning = Cerberus.Base.new()
                turning.yaw_rate, turning.valid_from = 20, 2 * SECOND // 30
                sink.send_event(Cerberus.event_new_base(turning))
            buffer = Gst.Buffer.new_wrapped(bytes(320 * 240))
            buffer.pts = number * SECOND // 30
            source.push_buffer(buffer)
            base = Cerberus.buffer_get_base(sink.try_pull_sample(TIMEOUT).get_buffer())
            told.append(base.yaw_rate if base and base.source == Cerberus.BaseSource.REPORTED else None)
            line = lines.try_pull_sample(TIMEOUT).get_buffer()
            written.append(json.loads(line.extract_dup(0, line.get_size())).get("base", {}).get("yaw-rate"))
        pipeline.set_state(Gst.State.NULL)
        self.assertEqual(told, [None, None, 20, 20])
        self.assertEqual(written, [None, None, 20, 20])


# A wide picture with nobody in it; the sensor on the right sees somebody from 1 s to 2 s.
WIDE, WINDOW = 60, 32.2  # degrees that 640 pixels show, and the middle 320 of them
REACH = 12
SCRIPT = "0,0,0,0; 1,0,0,1; 2,0,0,0; 4,0,0,0"
DEBOUNCE, RETURN_DELAY = 0.02, 0.3
LOOP = f"""
    videotestsrc num-buffers=120 pattern=black ! video/x-raw,format=GRAY8,width=640,height=240,framerate=30/1 !
    virtualptz wide-fov={WIDE} width=320 height=240 ! motiondetect !
    pirfusion name=fusion horizontal-fov={WINDOW} pan-min=-{REACH} pan-max={REACH}
        return-delay={round(RETURN_DELAY * SECOND)} ! tee name=t
    pirsrc driver=scripted min-pulse=0 bearings=0,-20,20 field-of-view=20 script="{SCRIPT}" ! queue ! fusion.pir_0
    t. ! queue ! pantiltsink driver=simulated horizontal-fov={WINDOW} pan-min=-{REACH} pan-max={REACH}
    t. ! queue ! motionjson ! filesink location=%s
    t. ! queue ! appsink name=sink sync=false
"""


class WithTheWholeLoop(unittest.TestCase):
    """PIR sensors, fusion and a simulated head that moves a window over a wide picture."""

    @classmethod
    def setUpClass(cls):
        cls.seen, messages = [], []
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "lines.json")
            for buffer in frames(LOOP % file, messages=messages):
                cls.seen.append((buffer.pts / SECOND, Cerberus.buffer_get_pose(buffer),
                                 Cerberus.buffer_get_fusion(buffer)))
            cls.lines = [json.loads(line) for line in file.read_text("utf-8").splitlines()]
        def found(parse):
            """What `parse` reads of the messages, each with the message's running time."""
            return [(one, Cerberus.message_parse_stamp(message).running_time) for message in messages
                    if (one := parse(message))]
        cls.pir, cls.fusion, cls.pantilt = map(found, (
            Cerberus.message_parse_pir, Cerberus.message_parse_fusion, Cerberus.message_parse_pantilt))

    def test_each_frame_knows_what_the_sensors_said_then(self):
        self.assertEqual(len(self.seen), 120)
        for time, _, fusion in self.seen:
            self.assertEqual(readings(fusion.get_sensors()), [0, 0, int(1 <= time < 2 + DEBOUNCE)], f"at {time:.3f} s")
            self.assertEqual(fusion.doubtful, 0)

    def test_each_frame_knows_where_the_head_looked_and_why(self):
        A = Cerberus.FusionAction
        for time, pose, fusion in self.seen:
            self.assertEqual(pose.head, "head")
            self.assertAlmostEqual(fusion.pan, pose.pan, places=6)
            self.assertLessEqual(abs(pose.pan), REACH + 1e-9)
            if time < RETURN_DELAY:
                self.assertEqual((fusion.action, fusion.rule_name), (A.HOLD, "return"))
            elif time < 1 or time > 2.4:
                self.assertEqual((fusion.action, fusion.target, fusion.camera_found), (A.ZERO, 0, False))
            elif time < 2:
                self.assertIn(fusion.action, (A.TURN_RIGHT, A.SEARCH))
                # What the head reaches of the sensor's sector, 10 to 30; where to search, of that.
                self.assertAlmostEqual(fusion.sector_to, REACH, places=6)
                if fusion.action == A.TURN_RIGHT:
                    self.assertAlmostEqual(fusion.sector_from, 20 - 20 / 2, places=6)
        self.assertIn(A.TURN_RIGHT, [fusion.action for _, _, fusion in self.seen])
        pans = {round(30 * time): pose.pan for time, pose, _ in self.seen}
        self.assertEqual(pans[30], 0)
        self.assertGreater(pans[50], 5)
        self.assertAlmostEqual(pans[119], 0, places=3)

    def test_every_change_is_a_message(self):
        self.assertEqual([(time / SECOND, readings(pir.get_sensors())) for pir, time in self.pir],
                         [(0, [0, 0, 0]), (1, [0, 0, 1]), (2 + DEBOUNCE, [0, 0, 0])])
        changes = [(time, fusion) for k, (time, _, fusion) in enumerate(self.seen)
                   if k == 0 or fusion.action != self.seen[k - 1][2].action]
        told = {time / SECOND: fusion.action for fusion, time in self.fusion}
        for time, fusion in changes:
            self.assertEqual(told[time], fusion.action)
        S = Cerberus.PantiltState
        states = [pantilt.state for pantilt, _ in self.pantilt]
        self.assertIn(S.TURNING, states)
        self.assertIn(S.ZEROING, states)
        for pantilt, time in self.pantilt:
            self.assertEqual(pantilt.pose.head, "head")
            if pantilt.state == S.TURNING:
                self.assertEqual(round(30 * time / SECOND), 30)

    def test_the_lines_say_what_the_frames_carry(self):
        self.assertEqual(len(self.lines), len(self.seen))
        for line, (time, pose, fusion) in zip(self.lines, self.seen):
            self.assertEqual(line["pts"] / SECOND, time)
            self.assertEqual(set(line["pose"]), {"pan", "tilt", "moving"})
            self.assertAlmostEqual(line["pose"]["pan"], pose.pan, places=2)
            self.assertAlmostEqual(line["pose"]["tilt"], pose.tilt, places=2)
            self.assertIs(line["pose"]["moving"], pose.moving)
            self.assertEqual(line["pir"], readings(fusion.get_sensors()))
            self.assertEqual(line["fusion"], {"rule": fusion.rule, "name": fusion.rule_name,
                                              "action": fusion.action.value_nick,
                                              "target": fusion.target or None})
        self.assertIn(True, [line["pose"]["moving"] for line in self.lines])


class WithARecording(unittest.TestCase):
    def test_what_motionjson_wrote_is_replayed_as_it_was(self):
        def lines(sensors):
            buffers = frames('videotestsrc num-buffers=40 pattern=black ! '
                             'video/x-raw,format=GRAY8,width=64,height=64,framerate=20/1 ! pirfusion name=fusion ! '
                             'motionjson ! appsink name=sink sync=false '
                             f'pirsrc min-pulse=0 debounce=0 {sensors} ! queue ! fusion.pir_0')
            return b"".join(buffer.extract_dup(0, buffer.get_size()) for buffer in buffers)

        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "night.json")
            file.write_bytes(lines('script="0,2,0,1; 0.5,2,1,2; 0.7,1,1,2; 1,0,2,2; 1.2,0,1,0; 2,0,1,0"'))
            again = lines(f"driver=replay location={file}")
            told, again = ([json.loads(line)["pir"] for line in text.splitlines()]
                           for text in (file.read_bytes(), again))
        expected = [[2, 0, 1]] * 10 + [[2, 1, 2]] * 4 + [[1, 1, 2]] * 6 + [[0, 2, 2]] * 4 + [[0, 1, 0]] * 16
        self.assertEqual(told, expected)
        self.assertEqual(again, expected)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
