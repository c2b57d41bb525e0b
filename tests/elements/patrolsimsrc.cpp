// SPDX-License-Identifier: LGPL-2.1-or-later
// patrolsimsrc in whole pipelines: what its frames carry, what its sensors send, and that a run can be repeated.
#include <glib/gstdio.h>
#include <gst/video/video-overlay-composition.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "support.h"

namespace {

constexpr double kFocal = 277.128;  // pixels: 160 / tan 30 degrees

// The robot stands in the lounge and looks along x; a person crosses 3.5 m before it at 1 m/s, from 23 degrees to the left
// to 35 to the right.
const std::string kStands = "path=\"at 4.5 8.5; wait 1\" ";
const std::string kCrosses = kStands + "walks=\"at 8 7 90; go 8 11 1\" ";

struct Outcome {
  std::vector<GstBuffer*> frames;
  std::vector<std::string> errors;
  std::vector<CerberusPir> readings;  // by messages
  std::size_t least_readings = 0;     // waited for: their thread may be later than the video's
  bool ended = false, may_fail = false;
  ~Outcome() {
    for (GstBuffer* frame : frames) gst_buffer_unref(frame);
  }
  Outcome() = default;
  Outcome(const Outcome&) = delete;
};

// Runs a launch line until its end or an error; keeps what its element `sink` gets.
void run(const std::string& line, Outcome& outcome, const std::function<void(GstElement*)>& prepare = {}) {
  GError* error = nullptr;
  GstElement* pipeline = gst_parse_launch(line.c_str(), &error);
  fail_unless(pipeline && !error, "%s", error ? error->message : "");
  if (GstElement* sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink")) {
    g_signal_connect(sink, "handoff", G_CALLBACK(+[](GstElement*, GstBuffer* buffer, GstPad*, Outcome* to) {
                       to->frames.push_back(gst_buffer_ref(buffer));
                     }),
                     &outcome);
    gst_object_unref(sink);
  }
  if (prepare) prepare(pipeline);
  GstBus* bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  while ((!outcome.ended || outcome.readings.size() < outcome.least_readings) && outcome.errors.empty()) {
    GstMessage* message = gst_bus_timed_pop(bus, 100 * GST_SECOND);
    fail_unless(message, "%s neither ends nor fails", line.c_str());
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS) outcome.ended = true;
    if (g_autoptr(CerberusPir) pir = cerberus_message_parse_pir(message)) outcome.readings.push_back(*pir);
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
      gst_message_parse_error(message, &error, nullptr);
      fail_unless(outcome.may_fail, "%s", error->message);
      outcome.errors.push_back(error->message);
      g_clear_error(&error);
    }
    gst_message_unref(message);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(bus);
  gst_object_unref(pipeline);
}

const std::string kSink = " ! fakesink name=sink signal-handoffs=true";
// All messages of the sensors come before the end: it waits for their thread.
const std::string kSensors = " robot.pir ! fakesink";

std::string error_of(const std::string& properties) {
  Outcome outcome;
  outcome.may_fail = true;
  run("patrolsimsrc num-buffers=3 " + properties + kSink, outcome);
  fail_unless_equals_int(outcome.errors.size(), 1);
  return outcome.errors[0];
}

std::string bytes(GstBuffer* buffer) {
  GstMapInfo map;
  fail_unless(gst_buffer_map(buffer, &map, GST_MAP_READ));
  std::string text(reinterpret_cast<const char*>(map.data), map.size);
  gst_buffer_unmap(buffer, &map);
  return text;
}

std::string all_bytes(const Outcome& outcome) {
  std::string all;
  for (GstBuffer* frame : outcome.frames) all += bytes(frame);
  return all;
}

// Of all frames: where the head looked and the robot was.
std::vector<double> ways(const Outcome& outcome) {
  std::vector<double> all;
  for (GstBuffer* frame : outcome.frames) {
    const CerberusTruth* truth = cerberus_buffer_peek_truth(frame);
    fail_unless(truth);
    all.insert(all.end(), {truth->pan, truth->tilt, truth->base_x, truth->base_y, truth->base_heading});
  }
  return all;
}

CerberusPose pose(double pan, GstClockTime until, const char* head = "head") {
  CerberusPose pose;
  cerberus_pose_init(&pose);
  cerberus_pose_set_head(&pose, head);
  pose.pan = pan;
  pose.valid_until = until;
  return pose;
}

}  // namespace

GST_START_TEST(a_frame_is_a_picture_with_its_time_and_the_truth) {
  Outcome outcome;
  run("patrolsimsrc num-buffers=45 " + kCrosses + kSink, outcome);
  fail_unless(outcome.ended);
  fail_unless_equals_int(outcome.frames.size(), 45);
  double bearing = -90;
  for (guint i = 0; i < 45; ++i) {
    GstBuffer* frame = outcome.frames[i];
    fail_unless_equals_int(gst_buffer_get_size(frame), 320 * 240 * 3 / 2);
    fail_unless_equals_uint64(GST_BUFFER_PTS(frame), gst_util_uint64_scale(i, GST_SECOND, 30));
    const CerberusTruth* truth = cerberus_buffer_peek_truth(frame);
    fail_unless(truth);
    fail_unless_equals_int(truth->n_persons, 1);
    fail_unless_equals_float(truth->base_x, 4.5);
    fail_unless_equals_float(truth->base_y, 8.5);
    const CerberusTruthPerson& person = truth->persons[0];
    fail_unless_equals_int(person.id, 1);
    fail_unless(person.bearing >= bearing);
    bearing = person.bearing;
    const double angle = bearing * G_PI / 180;
    fail_unless(std::abs(person.distance * std::cos(angle) - 3.5) < .03);
    // Its box is where its bearing is, as high as 1.5 to 1.9 m are at 3.5 m, and the person is seen.
    fail_unless(std::abs(person.x + person.width / 2 - (160 + kFocal * std::tan(angle))) < 12);
    fail_unless(person.height > 1.45 * kFocal / 3.7 && person.height < 2 * kFocal / 3.3);
    fail_unless(person.visible > .9);
    const CerberusBase* base = cerberus_buffer_peek_base(frame);
    fail_unless(base && base->yaw_rate == 0 && base->speed == 0 && base->source == CERBERUS_BASE_REPORTED);
    fail_unless(cerberus_buffer_peek_pose(frame) != nullptr);
  }
  const CerberusTruth* last = cerberus_buffer_peek_truth(outcome.frames.back());
  fail_unless(std::abs(last->persons[0].speed - 1) < .05);
}
GST_END_TEST

// 96 x 82 pixels for the office with its margin, 16.8 x 14.4 m: 5.71 pixels a metre.
GST_START_TEST(the_floor_plan_is_in_the_corner_with_the_people_where_the_truth_says) {
  Outcome with, without;
  // The second person is in another room.
  const std::string line =
      "patrolsimsrc num-buffers=30 " + kStands + "walks=\"at 8 7 90; go 8 11 1 | at 2.5 2; wait 1\" ";
  run(line + "inset=true" + kSink, with);
  run(line + kSink, without);
  fail_unless(all_bytes(with) == all_bytes(without));
  fail_if(gst_buffer_get_video_overlay_composition_meta(without.frames[0]));
  for (GstBuffer* frame : with.frames) {
    auto* meta = gst_buffer_get_video_overlay_composition_meta(frame);
    fail_unless(meta && gst_video_overlay_composition_n_rectangles(meta->overlay) == 1);
    auto* drawing = gst_video_overlay_composition_get_rectangle(meta->overlay, 0);
    gint x = 0, y = 0;
    guint width = 0, height = 0;
    gst_video_overlay_rectangle_get_render_rectangle(drawing, &x, &y, &width, &height);
    fail_unless(x == 218 && y == 6 && width == 96 && height == 82, "%d %d %u %u", x, y, width, height);
    const std::string pixels = bytes(
        gst_video_overlay_rectangle_get_pixels_unscaled_argb(drawing, GST_VIDEO_OVERLAY_FORMAT_FLAG_NONE));
    const auto at = [&](double metres_x, double metres_y) {  // BGRA
      const double scale = 96 / 16.8;
      const auto place = std::size_t(int(scale * (metres_y + .4)) * 96 + int(scale * (metres_x + .4)));
      return reinterpret_cast<const guint8*>(pixels.data()) + 4 * place;
    };
    const CerberusTruth* truth = cerberus_buffer_peek_truth(frame);
    const double direction = truth->persons[0].bearing * G_PI / 180, away = truth->persons[0].distance;
    const guint8* person = at(4.5 + away * std::cos(direction), 8.5 + away * std::sin(direction));
    fail_unless(person[2] > 150 && person[1] < 100 && person[0] < 100);
    const guint8 *hidden = at(2.5, 2), *robot = at(4.5, 8.5);
    fail_unless(hidden[2] < 150 && std::abs(hidden[2] - hidden[0]) < 20);
    fail_unless(robot[0] > robot[2] + 60);
  }
}
GST_END_TEST

GST_START_TEST(the_pictures_show_the_person_where_the_truth_says) {
  Outcome with, without;
  run("patrolsimsrc num-buffers=2 noise=0 " + kCrosses + kSink, with);
  run("patrolsimsrc num-buffers=2 noise=0 people=0 " + kStands + kSink, without);
  const CerberusTruthPerson& person = cerberus_buffer_peek_truth(with.frames[0])->persons[0];
  const std::string one = bytes(with.frames[0]), other = bytes(without.frames[0]);
  int inside = 0, outside = 0;
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) {
      if (one[y * 320 + x] == other[y * 320 + x]) continue;
      const bool is_in = x >= person.x - 2 && x <= person.x + person.width + 2 && y >= person.y - 2 &&
                         y <= person.y + person.height + 2;
      // Its shadow lies on the floor around its feet.
      const bool is_shadow = y > person.y + .85 * person.height;
      inside += is_in, outside += !is_in && !is_shadow;
    }
  fail_unless(inside > .3 * person.width * person.height, "%d", inside);
  fail_unless_equals_int(outside, 0);
}
GST_END_TEST

GST_START_TEST(downstream_chooses_size_and_rate) {
  for (const auto& [caps, size, duration] :
       {std::tuple("width=640,height=480,framerate=15/1", 640 * 480 * 3 / 2, GST_SECOND / 15),
        std::tuple("width=162,height=90,framerate=25/1", 164 * 90 + 2 * 84 * 45, GST_SECOND / 25)}) {
    Outcome outcome;
    run("patrolsimsrc num-buffers=3 ! video/x-raw," + std::string(caps) + kSink, outcome);
    fail_unless_equals_int(outcome.frames.size(), 3);
    fail_unless_equals_int(gst_buffer_get_size(outcome.frames[0]), size);
    fail_unless_equals_uint64(GST_BUFFER_PTS(outcome.frames[1]), duration);
  }
}
GST_END_TEST

GST_START_TEST(a_seed_gives_the_same_bytes_each_time_and_another_gives_others) {
  Outcome once, again, other;
  const std::string line = "patrolsimsrc people=3 num-buffers=40 seed=";
  run(line + "7" + kSink, once);
  run(line + "7" + kSink, again);
  run(line + "8" + kSink, other);
  fail_unless_equals_int(once.frames.size(), 40);
  fail_unless(all_bytes(once) == all_bytes(again));
  fail_unless(all_bytes(once) != all_bytes(other));
  fail_unless(ways(once) == ways(again));
}
GST_END_TEST

GST_START_TEST(it_begins_anew_when_it_is_started_again) {
  GstElement* pipeline =
      gst_parse_launch(("patrolsimsrc num-buffers=5" + kSink + " sync=false").c_str(), nullptr);
  GstElement* sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  std::string bytes_of[2];
  for (std::string& to : bytes_of) {
    const gulong id = g_signal_connect(
        sink, "handoff",
        G_CALLBACK(+[](GstElement*, GstBuffer* buffer, GstPad*, std::string* all) { *all += bytes(buffer); }),
        &to);
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    GstBus* bus = gst_element_get_bus(pipeline);
    GstMessage* message = gst_bus_timed_pop_filtered(bus, 60 * GST_SECOND, GST_MESSAGE_EOS);
    fail_unless(message);
    gst_message_unref(message);
    gst_object_unref(bus);
    gst_element_set_state(pipeline, GST_STATE_READY);
    g_signal_handler_disconnect(sink, id);
  }
  fail_unless(!bytes_of[0].empty() && bytes_of[0] == bytes_of[1]);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(sink);
  gst_object_unref(pipeline);
}
GST_END_TEST

GST_START_TEST(videoscale_scales_the_truth_and_a_crop_ends_it) {
  Outcome whole, half, part;
  const std::string line = "patrolsimsrc num-buffers=2 " + kCrosses;
  run(line + kSink, whole);
  run(line + " ! video/x-raw,width=320 ! videoscale ! video/x-raw,width=160,height=240" + kSink, half);
  run(line + " ! videocrop left=40" + kSink, part);
  const CerberusTruthPerson& one = cerberus_buffer_peek_truth(whole.frames[0])->persons[0];
  const CerberusTruth* scaled = cerberus_buffer_peek_truth(half.frames[0]);
  fail_unless(scaled);
  fail_unless_equals_float(scaled->persons[0].x, one.x / 2);
  fail_unless_equals_float(scaled->persons[0].width, one.width / 2);
  fail_unless_equals_float(scaled->persons[0].y, one.y);
  fail_unless_equals_float(scaled->persons[0].height, one.height);
  fail_unless_equals_float(scaled->persons[0].distance, one.distance);
  fail_unless(cerberus_buffer_peek_truth(part.frames[0]) == nullptr);
}
GST_END_TEST

// The head's first pose is received before the second frame is made.
GST_START_TEST(the_camera_looks_where_its_head_does) {
  Outcome outcome;
  const auto answer = [](GstElement* pipeline) {
    GstElement* sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
    GstPad* pad = gst_element_get_static_pad(sink, "sink");
    gst_pad_add_probe(
        pad, GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad* at, GstPadProbeInfo* info, gpointer) {
          const GstClockTime until = GST_BUFFER_PTS(GST_PAD_PROBE_INFO_BUFFER(info)) + GST_SECOND / 30 + 1;
          const CerberusPose other = pose(-30, until, "another"), own = pose(20, until);
          gst_pad_push_event(at, cerberus_event_new_pose(&own));
          gst_pad_push_event(at, cerberus_event_new_pose(&other));
          return GST_PAD_PROBE_OK;
        },
        nullptr, nullptr);
    gst_object_unref(pad);
    gst_object_unref(sink);
  };
  run("patrolsimsrc num-buffers=3 lockstep=on start-pan=5 people=1 " + kStands +
          "walks=\"at 8 8.5; wait 9\"" + kSink,
      outcome, answer);
  fail_unless_equals_int(outcome.frames.size(), 3);
  const double pans[] = {5, 20, 20};
  for (int i = 0; i < 3; ++i) {
    const CerberusTruth* truth = cerberus_buffer_peek_truth(outcome.frames[i]);
    fail_unless(std::abs(truth->pan - pans[i]) < 1e-9, "frame %d: %f", i, truth->pan);
    fail_unless(std::abs(truth->persons[0].bearing + pans[i]) < 1e-6);
    fail_unless_equals_float(cerberus_buffer_peek_pose(outcome.frames[i])->pan, pans[i]);
  }
}
GST_END_TEST

GST_START_TEST(without_a_head_no_frame_waits_and_where_one_is_asked_for_its_absence_is_an_error) {
  Outcome outcome;
  run("patrolsimsrc num-buffers=5" + kSink, outcome);
  fail_unless(outcome.ended);
  const std::string error = error_of("lockstep=on lockstep-timeout=50000000 ");
  fail_unless(error.find("The head \"head\" published no pose") == 0, "%s", error.c_str());
}
GST_END_TEST

// The loop follows the person, and queues change nothing.
GST_START_TEST(a_closed_loop_gives_the_same_way_each_time_with_and_without_queues) {
  const auto line = [](const std::string& queue) {
    return "patrolsimsrc name=robot num-buffers=150 " + kCrosses + " ! " + queue +
           "motiondetect ! pirfusion name=fusion ! tee name=all all. ! queue ! fakesink name=sink "
           "signal-handoffs=true async=false all. ! " +
           queue + "pantiltsink driver=simulated horizontal-fov=60 robot.pir ! " + queue + "fusion.";
  };
  Outcome plain, again, queued;
  run(line(""), plain);
  run(line(""), again);
  run(line("queue ! "), queued);
  fail_unless_equals_int(plain.frames.size(), 150);
  fail_unless(ways(plain) == ways(again));
  fail_unless(ways(plain) == ways(queued));
  double furthest = 0;
  for (GstBuffer* frame : plain.frames)
    furthest = std::max(furthest, std::abs(cerberus_buffer_peek_truth(frame)->pan));
  fail_unless(furthest > 3, "the head stays at %f", furthest);
}
GST_END_TEST

// The sensor ahead sees it, those to the sides do not.
GST_START_TEST(pirfusion_reads_the_sensors_as_it_reads_pirsrc) {
  Outcome outcome;
  run("patrolsimsrc name=robot num-buffers=90 " + kCrosses + " ! pirfusion name=fusion" + kSink +
          " robot.pir ! fusion.",
      outcome);
  fail_unless(outcome.ended);
  fail_unless_equals_int(outcome.frames.size(), 90);
  int ahead = 0, aside = 0;
  for (GstBuffer* frame : outcome.frames) {
    const CerberusFusion* fusion = cerberus_buffer_peek_fusion(frame);
    fail_unless(fusion);
    fail_unless_equals_int(fusion->n_sensors, 3);
    fail_unless_equals_float(fusion->bearings[1], -120);
    ahead += fusion->sensors[0] == 1, aside += fusion->sensors[1] + fusion->sensors[2];
  }
  fail_unless(ahead > 40, "%d", ahead);
  fail_unless_equals_int(aside, 0);
  // At the start and at each change, and of these there is one at least.
  fail_unless(outcome.readings.size() >= 2);
  fail_unless_equals_int(outcome.readings[0].sensors[0], 0);
  fail_unless_equals_int(outcome.readings[1].sensors[0], 1);
}
GST_END_TEST

// The AM312 warms up for 30 s; the SK-11 is active low and warms up for 60 s.
GST_START_TEST(sensors_are_invalid_while_their_module_warms_up) {
  for (const auto& [preset, seconds] : {std::pair("am312", 30), std::pair("sk-11", 60)}) {
    Outcome outcome;
    run("patrolsimsrc name=robot num-buffers=" + std::to_string(seconds * 5 + 20) + " pir-preset=" + preset +
            " pir-bearings=0 " + kCrosses + " ! video/x-raw,width=32,height=24,framerate=5/1" + kSink +
            kSensors,
        outcome);
    fail_unless(outcome.readings.size() >= 2);
    fail_unless_equals_int(outcome.readings[0].sensors[0], 2);
    fail_unless(outcome.readings[1].sensors[0] < 2);
    bool detects = false;
    for (const CerberusPir& pir : outcome.readings) detects = detects || pir.sensors[0] == 1;
    fail_unless(detects, "%s", preset);
    Outcome nobody;
    run("patrolsimsrc name=robot people=0 num-buffers=" + std::to_string(seconds * 5 + 20) +
            " pir-preset=" + preset + " pir-bearings=0 " + kStands +
            " ! video/x-raw,width=32,height=24,framerate=5/1" + kSink + kSensors,
        nobody);
    fail_unless_equals_int(nobody.readings.size(), 2);
    fail_unless_equals_int(nobody.readings[1].sensors[0], 0);
  }
}
GST_END_TEST

// A person who crosses 3.5 m away, at 1 m/s.
GST_START_TEST(a_module_with_a_short_range_does_not_reach) {
  for (const auto& [range, expected] : {std::pair("2", false), std::pair("5", true)}) {
    Outcome outcome;
    run("patrolsimsrc name=robot num-buffers=90 pir-bearings=0 pir-range=" + std::string(range) + " " +
            kCrosses + kSink + kSensors,
        outcome);
    bool detects = false;
    for (const CerberusPir& pir : outcome.readings) detects = detects || pir.sensors[0] == 1;
    fail_unless_equals_int(detects, expected);
  }
}
GST_END_TEST

GST_START_TEST(messages_of_sensors_come_without_a_link) {
  Outcome outcome;
  outcome.least_readings = 2;
  run("patrolsimsrc num-buffers=90 pir-bearings=0,180 " + kCrosses + kSink, outcome);
  fail_unless_equals_int(outcome.readings[0].n_sensors, 2);
}
GST_END_TEST

// A robot that turns by itself passes what is warm: that is doubtful.
GST_START_TEST(what_the_robots_own_turn_triggers_is_doubtful) {
  Outcome outcome;
  run("patrolsimsrc name=robot num-buffers=240 people=0 path=\"at 8 9; turn 360\" ! fakesink" + kSensors,
      outcome);
  int detections = 0;
  for (const CerberusPir& pir : outcome.readings)
    for (guint i = 0; i < pir.n_sensors; ++i)
      if (pir.sensors[i] == 1) {
        ++detections;
        fail_unless(pir.doubtful >> i & 1);
      }
  fail_unless(detections > 0);
}
GST_END_TEST

// The base on the frames says how fast it drives: pirfusion needs no event for that.
GST_START_TEST(what_stands_beside_the_robots_way_is_doubtful_to_pirfusion) {
  Outcome outcome;
  run("patrolsimsrc name=robot num-buffers=450 people=0 pir-bearings=90,-90 path=\"at 1.5 5.3; go 14 5.3\" ! "
      "video/x-raw,width=32,height=24 ! pirfusion name=fusion" +
          kSink + " robot.pir ! fusion.",
      outcome);
  int detections = 0, sure = 0;
  for (GstBuffer* frame : outcome.frames) {
    const CerberusFusion* fusion = cerberus_buffer_peek_fusion(frame);
    const CerberusBase* base = cerberus_buffer_peek_base(frame);
    fail_unless(fusion && base && base->speed <= .6 + 1e-6);
    for (guint i = 0; i < 2; ++i) {
      detections += fusion->sensors[i] == 1;
      sure += fusion->sensors[i] == 1 && !(fusion->doubtful >> i & 1);
    }
  }
  fail_unless(detections > 30, "%d", detections);
  fail_unless_equals_int(sure, 0);
}
GST_END_TEST

GST_START_TEST(both_pads_end) {
  Outcome outcome;
  run("patrolsimsrc name=robot num-buffers=10 people=0 " + kStands +
          "robot.video ! fakesink robot.pir ! fakesink name=sink "
          "signal-handoffs=true",
      outcome);
  fail_unless(outcome.ended);
  // At the start, and every tenth of a second until .3 s.
  fail_unless_equals_int(outcome.frames.size(), 4);
  for (guint i = 0; i < 4; ++i) {
    fail_unless_equals_uint64(GST_BUFFER_PTS(outcome.frames[i]), i * 100 * GST_MSECOND);
    fail_unless_equals_int(gst_buffer_get_size(outcome.frames[i]), 3);
  }
}
GST_END_TEST

// Stopped while both threads run, each in the middle of something.
GST_START_TEST(both_pads_begin_anew_after_a_stop_at_any_moment) {
  GstElement* pipeline = gst_parse_launch(
      "patrolsimsrc name=robot people=1 robot.video ! video/x-raw,width=32,height=24 ! fakesink async=false "
      "robot.pir ! fakesink name=sink signal-handoffs=true async=false",
      nullptr);
  GstElement* sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  struct Seen {
    std::atomic<int> readings = 0;
    std::atomic<bool> from_zero = false;
  } seen;
  g_signal_connect(sink, "handoff", G_CALLBACK(+[](GstElement*, GstBuffer* buffer, GstPad*, Seen* to) {
                     if (to->readings++ == 0) to->from_zero = GST_BUFFER_PTS(buffer) == 0;
                   }),
                   &seen);
  for (int round = 0; round < 10; ++round) {
    seen.readings = 0;
    seen.from_zero = false;
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    for (int wait = 0; seen.readings < 1 + round % 3 && wait < 60000; ++wait) g_usleep(1000);
    fail_unless(seen.readings > 0 && seen.from_zero, "round %d: %d readings", round, int(seen.readings));
    gst_element_set_state(pipeline, GST_STATE_READY);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(sink);
  gst_object_unref(pipeline);
}
GST_END_TEST

GST_START_TEST(settings_that_cannot_be_are_errors_that_name_them) {
  const auto names = [](const std::string& properties, const std::string& words) {
    const std::string error = error_of(properties);
    fail_unless(error.find(words) != std::string::npos, "%s", error.c_str());
  };
  names("plan=/nowhere/house.plan ", "/nowhere/house.plan");
  names("path=\"go 1 1\" ", "path: 'go 1 1' should be at X Y [HEADING]");
  names("walks=\"at 1 1; turn 9\" ", "walks: ' turn 9' should be one of at, go, wait, gesture");
  names("path=\"at 1 2; go 99 2\" ", "the robot's path: no free way leads from 1 2 to 99 2");
  names("pir-bearings=0,north ", "\"north\" is no direction in degrees");
}
GST_END_TEST

GST_START_TEST(a_plan_of_the_users_own_is_read) {
  g_autofree gchar* file = nullptr;
  const int fd = g_file_open_tmp("cerberus-XXXXXX.plan", &file, nullptr);
  fail_unless(fd >= 0);
  close(fd);
  fail_unless(g_file_set_contents(file, "room hall 0 0 6 6\nlamp 3 3\n", -1, nullptr));
  Outcome outcome;
  run("patrolsimsrc num-buffers=3 plan=" + std::string(file) + kSink, outcome);
  fail_unless(outcome.ended);
  fail_unless(std::abs(cerberus_buffer_peek_truth(outcome.frames[0])->base_x - 3) < .1);
  fail_unless(g_file_set_contents(file, "room hall 0 0 6\n", -1, nullptr));
  const std::string error = error_of("plan=" + std::string(file) + " ");
  fail_unless(error.find("line 1: the length is missing") != std::string::npos, "%s", error.c_str());
  g_remove(file);
}
GST_END_TEST

GST_START_TEST(a_frame_that_waits_for_its_head_ends_at_once_when_the_element_stops) {
  GstElement* pipeline =
      gst_parse_launch(("patrolsimsrc lockstep=on lockstep-timeout=0" + kSink).c_str(), nullptr);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  fail_unless_equals_int(gst_element_get_state(pipeline, nullptr, nullptr, 60 * GST_SECOND),
                         GST_STATE_CHANGE_SUCCESS);
  const auto begin = std::chrono::steady_clock::now();
  gst_element_set_state(pipeline, GST_STATE_NULL);
  fail_unless(std::chrono::steady_clock::now() - begin < std::chrono::seconds(5));
  gst_object_unref(pipeline);
}
GST_END_TEST

static Suite* patrolsimsrc_suite() {
  watch_library_log();
  Suite* suite = suite_create("patrolsimsrc");
  TCase* tc = tcase_create("all");
  tcase_set_timeout(tc, 120);
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, a_frame_is_a_picture_with_its_time_and_the_truth);
  tcase_add_test(tc, the_floor_plan_is_in_the_corner_with_the_people_where_the_truth_says);
  tcase_add_test(tc, the_pictures_show_the_person_where_the_truth_says);
  tcase_add_test(tc, downstream_chooses_size_and_rate);
  tcase_add_test(tc, a_seed_gives_the_same_bytes_each_time_and_another_gives_others);
  tcase_add_test(tc, it_begins_anew_when_it_is_started_again);
  tcase_add_test(tc, videoscale_scales_the_truth_and_a_crop_ends_it);
  tcase_add_test(tc, the_camera_looks_where_its_head_does);
  tcase_add_test(tc, without_a_head_no_frame_waits_and_where_one_is_asked_for_its_absence_is_an_error);
  tcase_add_test(tc, a_closed_loop_gives_the_same_way_each_time_with_and_without_queues);
  tcase_add_test(tc, pirfusion_reads_the_sensors_as_it_reads_pirsrc);
  tcase_add_test(tc, sensors_are_invalid_while_their_module_warms_up);
  tcase_add_test(tc, a_module_with_a_short_range_does_not_reach);
  tcase_add_test(tc, messages_of_sensors_come_without_a_link);
  tcase_add_test(tc, what_the_robots_own_turn_triggers_is_doubtful);
  tcase_add_test(tc, what_stands_beside_the_robots_way_is_doubtful_to_pirfusion);
  tcase_add_test(tc, both_pads_end);
  tcase_add_test(tc, both_pads_begin_anew_after_a_stop_at_any_moment);
  tcase_add_test(tc, settings_that_cannot_be_are_errors_that_name_them);
  tcase_add_test(tc, a_plan_of_the_users_own_is_read);
  tcase_add_test(tc, a_frame_that_waits_for_its_head_ends_at_once_when_the_element_stops);
  return suite;
}

GST_CHECK_MAIN(patrolsimsrc);
