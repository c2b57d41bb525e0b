// SPDX-License-Identifier: LGPL-2.1-or-later
// What cameramotion makes of a head's pose.
#include <algorithm>

#include "scene.h"
#include "support.h"

namespace {

CerberusPose pose(double pan, GstClockTime from, GstClockTime until = GST_CLOCK_TIME_NONE) {
  CerberusPose p;
  cerberus_pose_init(&p);
  p.pan = pan;
  p.valid_from = from, p.valid_until = until;
  return p;
}

void send(scene::Line& line, const CerberusPose& p) {
  gst_harness_push_upstream_event(line.harness, cerberus_event_new_pose(&p));
}

double pan_on(GstBuffer* buffer) {
  const CerberusPose* p = cerberus_buffer_peek_pose(buffer);
  const double pan = p ? p->pan : NAN;
  gst_buffer_unref(buffer);
  return pan;
}

const scene::World kWorld;

}  // namespace

GST_START_TEST(a_frame_gets_the_pose_of_its_own_time) {
  scene::Line line("cameramotion");
  fail_unless(std::isnan(pan_on(line.through(scene::grey_buffer(kWorld, 0)))));
  CerberusPose moving = pose(10, scene::kStep, 3 * scene::kStep);
  moving.pan_speed = 50;  // 2 degrees a frame
  send(line, moving);
  send(line, pose(14, 3 * scene::kStep));
  for (const double expected : {10.0, 12.0, 14.0, 14.0}) {
    static int number = 0;
    const double pan = pan_on(line.through(scene::grey_buffer(kWorld, ++number)));
    fail_unless(std::abs(pan - expected) < 1e-9, "frame %d: %g", number, pan);
  }
}
GST_END_TEST

// The pose on a frame is the same piece from the frame's time on: evaluating it later gives the angle of the event.
GST_START_TEST(the_pose_on_a_frame_goes_on_as_the_head_does) {
  scene::Line line("cameramotion");
  CerberusPose braking = pose(10, 0, 10 * scene::kStep);
  braking.pan_speed = 50;
  braking.pan_acceleration = -100;
  braking.moving = TRUE;
  send(line, braking);
  gst_buffer_unref(line.through(scene::grey_buffer(kWorld, 0)));
  GstBuffer* out = line.through(scene::grey_buffer(kWorld, 5));  // 0.2 s
  const CerberusPose* p = cerberus_buffer_peek_pose(out);
  fail_unless(p && p->moving && p->valid_from == 5 * scene::kStep && p->valid_until == 10 * scene::kStep);
  fail_unless(std::abs(p->pan - 18) < 1e-9 && std::abs(p->pan_speed - 30) < 1e-9, "%g, %g", p->pan,
              p->pan_speed);
  double later = 0, expected = 0;
  fail_unless(cerberus_pose_evaluate(p, 8 * scene::kStep, &later, nullptr));
  cerberus_pose_evaluate(&braking, 8 * scene::kStep, &expected, nullptr);
  fail_unless(std::abs(later - expected) < 1e-9, "%g, not %g", later, expected);
  gst_buffer_unref(out);
}
GST_END_TEST

// No event has come since: where the head looks now is not certain, and repeating the frame does not make it so.
GST_START_TEST(an_expired_pose_stays_expired) {
  scene::Line line("cameramotion");
  CerberusPose short_lived = pose(10, 0, 2 * scene::kStep);
  short_lived.pan_speed = 50;
  send(line, short_lived);
  for (const int number : {4, 5}) {
    GstBuffer* in = scene::grey_buffer(kWorld, number);
    if (number == 5) GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_GAP);
    GstBuffer* out = line.through(in);
    const CerberusPose* p = cerberus_buffer_peek_pose(out);
    double pan = 0;
    fail_unless(p && p->valid_until == 2 * scene::kStep, "frame %d", number);
    fail_unless(!cerberus_pose_evaluate(p, number * scene::kStep, &pan, nullptr));
    fail_unless(std::abs(pan - 14) < 1e-9, "%g", pan);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

GST_START_TEST(a_pose_on_the_frame_takes_precedence_over_the_event) {
  scene::Line line("cameramotion");
  send(line, pose(10, 0));
  GstBuffer* buffer = scene::grey_buffer(kWorld, 0);
  const CerberusPose carried = pose(-5, 0);
  cerberus_buffer_set_pose(buffer, &carried);
  fail_unless(pan_on(line.through(buffer)) == -5);
}
GST_END_TEST

GST_START_TEST(another_head_is_not_listened_to_and_every_event_goes_on) {
  scene::Line line("cameramotion");
  CerberusPose other = pose(10, 0);
  cerberus_pose_set_head(&other, "another");
  send(line, other);
  fail_unless(std::isnan(pan_on(line.through(scene::grey_buffer(kWorld, 0)))));
  send(line, pose(7, 0));
  fail_unless(pan_on(line.through(scene::grey_buffer(kWorld, 1))) == 7);
  int passed = 0;
  while (GstEvent* event = gst_harness_try_pull_upstream_event(line.harness)) {
    passed += gst_event_has_name(event, CERBERUS_EVENT_POSE);
    gst_event_unref(event);
  }
  fail_unless_equals_int(passed, 2);
}
GST_END_TEST

GST_START_TEST(poses_of_the_run_before_are_forgotten) {
  scene::Line line("cameramotion");
  send(line, pose(10, 0));
  line.restart();
  fail_unless(std::isnan(pan_on(line.through(scene::grey_buffer(kWorld, 0)))));
}
GST_END_TEST

// A blank wall contains no evidence of camera motion: the head's pose is used. F = 160 / tan 30; a turn of atan(40 /
// F) to the right moves the middle of the picture by 40 pixels to the left.
GST_START_TEST(a_heads_turn_counts_where_the_picture_says_nothing) {
  const double pan = std::atan(40 * std::tan(30 * M_PI / 180) / 160) * 180 / M_PI;
  for (const bool known : {true, false}) {
    scene::Line line(known ? "cameramotion horizontal-fov=60" : "cameramotion");
    const std::vector<std::uint8_t> grey(scene::kWidth * scene::kHeight, 90);
    send(line, pose(0, 0, scene::kStep - 1));
    send(line, pose(pan, scene::kStep));
    double x = 0;
    for (int number = 0; number < 2; ++number) {
      GstBuffer* out =
          line.through(scene::buffer("GRAY8", scene::kWidth, scene::kHeight, grey, number * scene::kStep));
      const double* m = cerberus_buffer_peek_camera_motion(out)->matrix;
      x = (m[0] * 159.5 + m[1] * 119.5 + m[2]) / (m[6] * 159.5 + m[7] * 119.5 + m[8]);
      gst_buffer_unref(out);
    }
    const double expected = known ? 119.5 : 159.5;
    fail_unless(std::abs(x - expected) < 0.01, "the middle goes to %g, not to %g", x, expected);
  }
}
GST_END_TEST

namespace {

// A wall at distance 1, and a person who walks along it, seen by a pinhole camera of this field of view.
struct ZoomedWorld {
  static double focal(double fov) { return scene::kWidth / 2 / std::tan(fov / 2 * M_PI / 180); }
  static double person(int frame) { return -0.75 + 0.012 * frame; }  // the middle, along the wall
  static double bearing(int frame) { return std::atan(person(frame)) * 180 / M_PI; }
  // 60 degrees, and from frame 30 to 60 down to 40.
  static double fov(int frame) {
    const double part = std::clamp((frame - 30) / 30.0, 0.0, 1.0);
    return 2 * std::atan(scene::kWidth / 2 / (focal(60) * std::pow(focal(40) / focal(60), part))) * 180 /
           M_PI;
  }
  static GstBuffer* seen(int frame) {
    std::vector<std::uint8_t> grey;
    grey.reserve(scene::kWidth * scene::kHeight);
    const double f = focal(fov(frame)), wide = focal(60), left = person(frame) - 0.05;
    for (int y = 0; y < scene::kHeight; ++y)
      for (int x = 0; x < scene::kWidth; ++x) {
        const double u = (x - scene::kWidth / 2 + 0.5) / f, v = (y - scene::kHeight / 2 + 0.5) / f;
        const bool figure = u >= left && u < left + 0.1 && v >= -0.12 && v < 0.14;
        grey.push_back(static_cast<std::uint8_t>(
            figure ? 150 + 0.35 * scene::texture((u - left) * wide, v * wide + 200, 5, 77)
                   : 30 + 0.35 * scene::texture(u * wide + 400, v * wide + 400, 9, 1)));
      }
    return scene::buffer("GRAY8", scene::kWidth, scene::kHeight, grey, frame * scene::kStep);
  }
};

struct Bearings {
  int found = 0;
  double worst = 0;  // degrees off
  std::string text;  // of all frames
};
// told: the head's poses say what its zoom sees.
Bearings bearings_of(const std::string& elements, bool told) {
  scene::Line line(elements);
  Bearings result;
  for (int frame = 0; frame < 85; ++frame) {
    CerberusPose head = pose(12, frame * scene::kStep);
    head.tilt = -3;
    head.field_of_view = told ? ZoomedWorld::fov(frame) : 0;
    send(line, head);
    GstBuffer* out = line.through(ZoomedWorld::seen(frame));
    const scene::Regions regions(out);
    result.text += std::to_string(frame) + ": " + regions.text() + "\n";
    double off = NAN;  // of the nearest one
    for (guint i = 0; i < regions.size(); ++i)
      off = std::fmin(off, std::abs(regions[i].bearing - ZoomedWorld::bearing(frame)));
    if (frame >= 25 && off < 5) {
      ++result.found;
      result.worst = std::max(result.worst, off);
    }
    gst_buffer_unref(out);
  }
  return result;
}

}  // namespace

// The head's zoom counts in place of horizontal-fov, and motiondetect gives what the chain gives.
GST_START_TEST(bearings_are_right_while_the_head_zooms) {
  const Bearings one = bearings_of("motiondetect horizontal-fov=60", true);
  fail_unless(one.found >= 50, "in %d of 60 frames", one.found);
  fail_unless(one.worst < 1, "%g degrees off", one.worst);
  const Bearings chain = bearings_of(
      "cameramotion horizontal-fov=60 ! threeframediff ! fuzzythreshold ! "
      "motionregions horizontal-fov=60 ! motiontrack horizontal-fov=60",
      true);
  fail_unless(chain.text == one.text && chain.worst == one.worst);
  const Bearings untold = bearings_of("motiondetect horizontal-fov=60", false);
  fail_unless(untold.worst > 2, "%g", untold.worst);  // what the test is about
}
GST_END_TEST

static Suite* head_pose_suite() {
  watch_library_log();
  Suite* s = suite_create("head_pose");
  TCase* tc = tcase_create("cameramotion");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, a_frame_gets_the_pose_of_its_own_time);
  tcase_add_test(tc, the_pose_on_a_frame_goes_on_as_the_head_does);
  tcase_add_test(tc, an_expired_pose_stays_expired);
  tcase_add_test(tc, a_pose_on_the_frame_takes_precedence_over_the_event);
  tcase_add_test(tc, another_head_is_not_listened_to_and_every_event_goes_on);
  tcase_add_test(tc, poses_of_the_run_before_are_forgotten);
  tcase_add_test(tc, bearings_are_right_while_the_head_zooms);
  tcase_add_test(tc, a_heads_turn_counts_where_the_picture_says_nothing);
  return s;
}

GST_CHECK_MAIN(head_pose)
