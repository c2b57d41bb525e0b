#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Reads regions, tracks and camera motion from Python, through GObject introspection.

It is also the example to start from: the class at the end shows how a program gets at each frame's metadata. What
sensors, fusion and head attach and post is read by reads_the_loop.py beside it.
"""
import math
import sys
import unittest

from support import BALL, CAPS, Cerberus, Gst, GstVideo, TIMEOUT, frames, region


class OnAPlainBuffer(unittest.TestCase):
    def setUp(self):
        self.buffer = Gst.Buffer.new_allocate(None, 16, None)

    def test_a_bare_buffer_has_nothing(self):
        self.assertEqual(Cerberus.buffer_get_regions(self.buffer), [])
        self.assertIsNone(Cerberus.buffer_get_camera_motion(self.buffer))
        self.assertFalse(Cerberus.buffer_regions_known(self.buffer))

    def test_nothing_found_is_not_nobody_looked(self):
        self.assertTrue(Cerberus.buffer_set_regions(self.buffer, []))
        self.assertTrue(Cerberus.buffer_regions_known(self.buffer))
        self.assertEqual(Cerberus.buffer_get_regions(self.buffer), [])
        self.assertTrue(Cerberus.buffer_set_regions(self.buffer, [region(id=1, kind=Cerberus.RegionKind.GROUP)]))
        self.assertEqual([r.kind for r in Cerberus.buffer_get_regions(self.buffer)], [Cerberus.RegionKind.GROUP])
        self.assertTrue(Cerberus.buffer_set_regions(self.buffer, None))
        self.assertFalse(Cerberus.buffer_regions_known(self.buffer))

    def test_regions_read_back(self):
        for number in range(1, 4):
            self.assertTrue(Cerberus.buffer_add_region(self.buffer, region(
                id=number, tracked=True, x=10.5 * number, y=2, width=20.25, height=30, confidence=0.5, vx=-3.5,
                age=number * Gst.SECOND, state=Cerberus.RegionState.STOPPED, bearing=12.5)))
        found = Cerberus.buffer_get_regions(self.buffer)
        self.assertEqual([r.id for r in found], [1, 2, 3])
        last = found[2]
        self.assertEqual((last.x, last.y, last.width, last.height), (31.5, 2, 20.25, 30))
        self.assertEqual((last.vx, last.vy, last.confidence, last.bearing), (-3.5, 0, 0.5, 12.5))
        self.assertEqual(last.age, 3 * Gst.SECOND)
        self.assertEqual(last.state, Cerberus.RegionState.STOPPED)
        self.assertTrue(math.isnan(last.distance))
        Cerberus.buffer_remove_regions(self.buffer)
        self.assertEqual(Cerberus.buffer_get_regions(self.buffer), [])
        self.assertEqual(last.id, 3)  # a copy: it outlives what it was read from

    def test_camera_motion_reads_back(self):
        motion = Cerberus.CameraMotion.new()
        self.assertEqual(list(motion.matrix), [1, 0, 0, 0, 1, 0, 0, 0, 1])
        self.assertEqual(motion.from_, Gst.CLOCK_TIME_NONE)  # `from` is a word of Python's
        motion.set_matrix([1, 0, 5, 0, 1, -7, 0, 0, 1])
        motion.confidence = 0.75
        motion.scene_age = 4
        self.assertTrue(Cerberus.buffer_set_camera_motion(self.buffer, motion))
        found = Cerberus.buffer_get_camera_motion(self.buffer)
        self.assertEqual(list(found.matrix), [1, 0, 5, 0, 1, -7, 0, 0, 1])
        self.assertEqual((found.confidence, found.scene_age), (0.75, 4))
        good, x, y = found.apply(10, 20)
        self.assertEqual((good, x, y), (True, 15, 13))
        self.assertTrue(Cerberus.buffer_set_camera_motion(self.buffer, None))
        self.assertIsNone(Cerberus.buffer_get_camera_motion(self.buffer))

    def test_messages_read_back(self):
        moving = [region(id=7, tracked=True, x=1, y=2, width=3, height=4), region(id=8)]
        motion, stamp = Cerberus.Motion.new(), Cerberus.Stamp.new()
        for one in moving:
            motion.add_region(one)
        stamp.running_time = 5 * Gst.SECOND
        stamp.set_camera_name("yard")
        message = Cerberus.message_new_motion(None, stamp, motion)
        self.assertEqual(message.get_structure().get_name(), Cerberus.MESSAGE_MOTION)
        found = Cerberus.message_parse_motion(message)
        self.assertEqual(found.state, Cerberus.MotionState.STARTED)
        self.assertEqual([r.id for r in found.get_regions()], [7, 8])
        back = Cerberus.message_parse_stamp(message)
        self.assertEqual((back.running_time, back.utc, back.camera_name), (5 * Gst.SECOND, Gst.CLOCK_TIME_NONE, "yard"))
        self.assertIsNone(Cerberus.message_parse_motion(Gst.Message.new_eos(None)))
        self.assertFalse(Cerberus.message_is_motion(Gst.Message.new_eos(None)))

    def test_a_track_message_reads_back(self):
        message = Gst.Message.new_element(None, Gst.Structure.from_string(
            "cerberus-track, running-time=(guint64)2000000000, state=left, first=(guint64)1000000000, "
            "last=(guint64)2000000000, object=(GstStructure)[cerberus-object, id=(guint)7, x=1.5]")[0])
        self.assertTrue(Cerberus.message_is_track(message))
        self.assertEqual(message.get_structure().get_string("state"), "left")
        found = Cerberus.message_parse_track(message)
        self.assertEqual(found.state, Cerberus.TrackState.LEFT)
        self.assertEqual((found.region.id, found.region.x), (7, 1.5))
        self.assertEqual((found.first, found.last), (Gst.SECOND, 2 * Gst.SECOND))
        self.assertIsNone(Cerberus.message_parse_motion(message))

    def test_a_stamp_rides_on_a_buffer(self):
        stamp = Cerberus.Stamp.new()
        stamp.utc, stamp.utc_source = 1234567890123456789, Cerberus.UtcSource.REFERENCE_TIMESTAMP
        self.assertTrue(Cerberus.buffer_set_stamp(self.buffer, stamp))
        found = Cerberus.buffer_get_stamp(self.buffer)
        self.assertEqual((found.utc, found.utc_source, found.camera_name),
                         (1234567890123456789, Cerberus.UtcSource.REFERENCE_TIMESTAMP, None))

    def test_structures_read_back(self):
        structure = region(id=3, x=1.5).to_structure()
        self.assertEqual(structure.get_name(), "cerberus-object")
        self.assertEqual(structure.get_double("x"), (True, 1.5))
        self.assertEqual(Cerberus.Region.from_structure(structure).id, 3)

    def test_what_is_read_is_given_back(self):
        """Ten thousand reads leave the process as large as it was."""
        def pages():
            with open("/proc/self/statm", encoding="ascii") as statm:
                return int(statm.read().split()[1])
        Cerberus.buffer_set_camera_motion(self.buffer, Cerberus.CameraMotion.new())
        for number in range(20):
            Cerberus.buffer_add_region(self.buffer, region(id=number))
        def read():
            for _ in range(10000):
                Cerberus.buffer_get_regions(self.buffer)
                Cerberus.buffer_get_camera_motion(self.buffer)
        read()
        before = pages()
        read()
        self.assertLess(pages() - before, 500)  # 200,000 regions leaked would be 9,000 pages

    def test_version_and_formats(self):
        version = Cerberus.version()
        self.assertEqual((version.major, version.minor, version.micro),
                         (Cerberus.VERSION_MAJOR, Cerberus.VERSION_MINOR, Cerberus.VERSION_MICRO))
        self.assertTrue(Cerberus.video_format_is_supported(GstVideo.VideoFormat.NV12))
        self.assertFalse(Cerberus.video_format_is_supported(GstVideo.VideoFormat.V308))


class ThroughAPipeline(unittest.TestCase):
    """Metadata that a pad probe reads, while the pipeline runs, and that reaches the application."""

    def test_a_probe_reads_what_rides_on_the_frame(self):
        # Python's wrapper of a buffer inside a probe holds a second reference, so a probe can read but not annotate.
        seen = []
        list(frames("videotestsrc num-buffers=3 ! video/x-raw,width=64,height=48 ! identity name=mark ! "
                    "appsink name=sink",
                    lambda buffer: seen.append((Cerberus.buffer_get_regions(buffer),
                                                Cerberus.buffer_add_region(buffer, region(id=1))))))
        self.assertEqual(seen, [([], False)] * 3)

    def test_the_truth_of_a_simulated_frame(self):
        line = ('patrolsimsrc num-buffers=2 path="at 4.5 8.5; wait 1" walks="at 8 8.5; wait 9 | at 8 10; wait 9" ! '
                "appsink name=sink")
        for truth in map(Cerberus.buffer_get_truth, frames(line)):
            self.assertEqual((truth.n_persons, truth.base_x), (2, 4.5))
            first, second = truth.get_person(0), truth.get_person(1)
            self.assertEqual((first.id, second.id), (1, 2))
            self.assertAlmostEqual(first.distance, 3.5)
            self.assertAlmostEqual(second.bearing, math.degrees(math.atan2(1.5, 3.5)))
            self.assertIsNone(truth.get_person(2))

    def test_an_application_annotates_and_reads(self):
        pipeline = Gst.parse_launch("appsrc name=source format=time "
                                    "caps=video/x-raw,format=GRAY8,width=64,height=48,framerate=25/1 ! queue ! "
                                    "videoscale ! video/x-raw,width=128,height=96 ! "
                                    "videoconvert ! video/x-raw,format=RGB ! appsink name=sink")
        source, sink = pipeline.get_by_name("source"), pipeline.get_by_name("sink")
        pipeline.set_state(Gst.State.PLAYING)
        buffer = Gst.Buffer.new_wrapped(bytes(64 * 48))
        buffer.pts = 0
        Cerberus.buffer_add_region(buffer, region(id=9, tracked=True, x=8.25, y=16, width=15.5, height=24, vx=10))
        motion = Cerberus.CameraMotion.new()
        motion.set_matrix([1, 0, 3, 0, 1, -2, 0, 0, 1])
        Cerberus.buffer_set_camera_motion(buffer, motion)
        source.push_buffer(buffer)
        source.end_of_stream()
        sample = sink.try_pull_sample(TIMEOUT)
        self.assertIsNotNone(sample)
        out = sample.get_buffer()
        found, = Cerberus.buffer_get_regions(out)
        self.assertEqual((found.id, found.x, found.y, found.width, found.height), (9, 16.5, 32, 31, 48))
        self.assertEqual(found.vx, 20)
        self.assertEqual(list(Cerberus.buffer_get_camera_motion(out).matrix), [1, 0, 6, 0, 1, -4, 0, 0, 1])
        pipeline.set_state(Gst.State.NULL)


def ball_centre(buffer):
    """Where the ball is: the mean place of the bright pixels of a picture that is black otherwise."""
    size, pixels = buffer.get_size(), buffer.extract_dup(0, buffer.get_size())
    bright = [i for i in range(0, size, 3) if pixels[i] > 100]
    return sum(i % 320 for i in bright) / len(bright), sum(i // 320 for i in bright) / len(bright)


class WithMotionDetect(unittest.TestCase):
    """A ball that flies over a test picture, as motiondetect sees it."""

    def test_a_ball_is_seen_tracked_and_told_of(self):
        balls = [ball_centre(buffer) for buffer in frames(f"{BALL} ! appsink name=sink sync=false")]
        seen = []
        messages = []
        pipeline = Gst.parse_launch(
            f"compositor name=mix sink_1::alpha=0.8 ! {CAPS} ! motiondetect ! appsink name=sink sync=false "
            f"videotestsrc pattern=checkers-8 num-buffers=60 ! {CAPS} ! mix.sink_0 {BALL} ! mix.sink_1")
        sink = pipeline.get_by_name("sink")
        pipeline.set_state(Gst.State.PLAYING)
        while sample := sink.try_pull_sample(TIMEOUT):
            buffer = sample.get_buffer()
            seen.append((Cerberus.buffer_get_camera_motion(buffer), Cerberus.buffer_regions_known(buffer),
                         Cerberus.buffer_get_regions(buffer)))
        while message := pipeline.get_bus().pop_filtered(Gst.MessageType.ELEMENT):
            if Cerberus.message_is_motion(message):
                messages.append(message)
        pipeline.set_state(Gst.State.NULL)
        self.assertEqual(len(seen), len(balls))

        # The camera stands: from the second frame on, the transform is exactly identity, and says where it starts.
        self.assertEqual(seen[0][0].scene_age, 1)
        for k, (motion, known, _) in enumerate(seen):
            self.assertIsNotNone(motion, f"frame {k}")
            self.assertTrue(known, f"frame {k}")
        for k in range(1, len(seen)):
            motion = seen[k][0]
            self.assertEqual(motion.scene_age, k + 1)
            self.assertTrue(motion.still)
            self.assertEqual(list(motion.matrix), [1, 0, 0, 0, 1, 0, 0, 0, 1])
            self.assertEqual(round(motion.from_ * 30 / Gst.SECOND), k - 1)


        # The ball is where it is, and keeps one identity. (How good masks and tracks are is not this test's business.)
        followed = {}
        for (x, y), (_, _, regions) in zip(balls, seen):
            for r in regions:
                self.assertTrue(r.tracked)
                self.assertGreaterEqual(r.confidence, 0)
                self.assertLessEqual(r.confidence, 1)
                if r.x < x < r.x + r.width and r.y < y < r.y + r.height:
                    followed.setdefault(r.id, []).append(r)
        track = max(followed.values(), key=len, default=[])
        self.assertGreaterEqual(len(track), 30, f"frames by identity: {({i: len(t) for i, t in followed.items()})}")
        ages = [r.age for r in track]
        self.assertEqual(ages, sorted(set(ages)))

        # And the application was told when it began, with the objects of that very frame.
        first = next(k for k, (_, _, regions) in enumerate(seen) if regions)
        self.assertTrue(messages)
        told = Cerberus.message_parse_motion(messages[0])
        self.assertEqual(told.state, Cerberus.MotionState.STARTED)
        self.assertEqual(round(Cerberus.message_parse_stamp(messages[0]).running_time * 30 / Gst.SECOND), first)
        self.assertEqual([(r.id, r.x, r.y) for r in told.get_regions()], [(r.id, r.x, r.y) for r in seen[first][2]])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
