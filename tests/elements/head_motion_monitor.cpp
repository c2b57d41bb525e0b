// SPDX-License-Identifier: LGPL-2.1-or-later
// The comparison of head and picture in cameramotion: the yaw rate of the base below the head, and heads that do not
// execute their commands. Pictures of a wall, shifted as a turning camera shows it; degrees everywhere.
#include "scene.h"
#include "support.h"

namespace {

// A 60 degree lens: F = 160 / tan 30. A shift of s pixels is a mean angle of .9069 s / F over the picture: the mean of
// 1 / (1 + (x / F)^2) over its width.
constexpr double kPixels = 160 / 0.57735 / 0.9069 * M_PI / 180;  // a degree

GstBuffer* looking_at(double bearing, int number) {
  scene::World world;
  world.figure = false;
  world.pan = bearing * kPixels;  // of one frame
  return scene::buffer("GRAY8", world.width, world.height, world.picture(1), number * scene::kStep);
}

GstBuffer* blank(int number) {
  const std::vector<std::uint8_t> grey(scene::kWidth * scene::kHeight, 90);
  return scene::buffer("GRAY8", scene::kWidth, scene::kHeight, grey, number * scene::kStep);
}

CerberusPose pose_at(double pan, int number, const char* head = "head") {
  CerberusPose pose;
  cerberus_pose_init(&pose);
  cerberus_pose_set_head(&pose, head);
  pose.pan = pan;
  pose.valid_from = number * scene::kStep;
  return pose;
}

// Where a head looks that sweeps at 40 degrees a second, a second there and one back.
double sweep(int number) {
  const int in = number % 50;
  return 1.6 * (in < 25 ? in : 50 - in);
}

CerberusBase turning_at(double rate) {
  CerberusBase base;
  cerberus_base_init(&base);
  base.yaw_rate = rate;
  base.source = CERBERUS_BASE_REPORTED;
  return base;
}

struct Shown {
  double gain = 1, base = 0;  // gain: of the commanded angle; base: degrees a second
  const char* head = "head";
  bool carried = false;   // the pose comes on the frame
  bool reported = false;  // the application reports that the base turns against the head
  bool blank = false;
};

// The rate on the last frame; NaN: none.
double show(scene::Line& line, const Shown& shown, int from, int to) {
  double rate = NAN;
  for (int k = from; k < to; ++k) {
    const double bearing = shown.gain * sweep(k) + shown.base * 0.04 * k;
    GstBuffer* in = shown.blank ? blank(k) : looking_at(bearing, k);
    const CerberusPose pose = pose_at(sweep(k), k, shown.head);
    if (shown.carried)
      cerberus_buffer_set_pose(in, &pose);
    else
      gst_harness_push_upstream_event(line.harness, cerberus_event_new_pose(&pose));
    if (shown.reported)
      gst_harness_push_upstream_event(line.harness,
                                      base_event((sweep(k - 1) - sweep(k)) / 0.04, k * scene::kStep));
    GstBuffer* out = line.through(in);
    const CerberusBase* base = cerberus_buffer_peek_base(out);
    rate = base ? base->yaw_rate : NAN;
    gst_buffer_unref(out);
  }
  return rate;
}

constexpr char kLens[] = "cameramotion name=motion horizontal-fov=60";

// The one warning's fault; its text must name the head.
std::string fault(scene::Line& line, double* gain) {
  GstMessage* message = gst_bus_pop_filtered(line.bus, GST_MESSAGE_WARNING);
  if (!message) return "";
  GError* error = nullptr;
  gst_message_parse_warning(message, &error, nullptr);
  fail_unless(strstr(error->message, "\"head\""), "%s", error->message);
  g_error_free(error);
  const GstStructure* details = nullptr;
  gst_message_parse_warning_details(message, &details);
  fail_unless(details);
  fail_unless_equals_string(gst_structure_get_string(details, "head"), "head");
  fail_unless_equals_string(gst_structure_get_string(details, "axis"), "pan");
  double travel = 0;
  fail_unless(gst_structure_get_double(details, "travel", &travel) && travel >= 20);
  fail_unless(gst_structure_get_double(details, "gain", gain));
  const std::string result = gst_structure_get_string(details, "fault");
  gst_message_unref(message);
  return result;
}

}  // namespace

GST_START_TEST(a_head_that_executes_its_commands_causes_no_warning_and_its_base_stands) {
  scene::Line line(kLens);
  const double rate = show(line, {}, 0, 170);
  fail_unless(std::abs(rate) < 1, "%g", rate);
  fail_unless(line.messages(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST

GST_START_TEST(a_head_that_does_not_is_warned_of_once) {
  const struct {
    double gain;
    const char* fault;
  } cases[] = {{0, "slips"}, {-1, "reversed"}, {0.5, "scale"}};
  for (const auto& each : cases) {
    scene::Line line(kLens);
    show(line, {.gain = each.gain}, 0, 220);
    double gain = 9;
    const std::string found = fault(line, &gain);
    fail_unless(found == each.fault, "%g: \"%s\"", each.gain, found.c_str());
    fail_unless(std::abs(gain - each.gain) < 0.1, "%g", gain);
    fail_unless(line.messages(GST_MESSAGE_WARNING).empty(), "once");
  }
}
GST_END_TEST

GST_START_TEST(without_a_lens_or_with_a_blank_picture_nothing_is_said) {
  scene::Line unknown("cameramotion"), line(kLens);
  fail_unless(std::isnan(show(unknown, {.gain = -1}, 0, 120)));
  fail_unless(unknown.messages(GST_MESSAGE_WARNING).empty());
  fail_unless(std::isnan(show(line, {.blank = true}, 0, 120)));
  fail_unless(line.messages(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST

GST_START_TEST(a_robots_turning_is_measured_and_no_fault_of_the_head) {
  scene::Line line(kLens);
  for (const double base : {20.0, -12.0}) {
    line.restart();
    const double rate = show(line, {.base = base}, 0, 140);
    fail_unless(std::abs(rate - base) < 1, "%g: %g", base, rate);
  }
  fail_unless(line.messages(GST_MESSAGE_WARNING).empty());
  // A camera without a head.
  scene::Line fixed(kLens);
  double rate = NAN;
  for (int k = 0; k < 10; ++k) {
    GstBuffer* out = fixed.through(looking_at(-0.4 * k, k));
    rate = cerberus_buffer_peek_base(out) ? cerberus_buffer_peek_base(out)->yaw_rate : NAN;
    gst_buffer_unref(out);
  }
  fail_unless(std::abs(rate + 10) < 0.5, "%g", rate);
}
GST_END_TEST

// The picture stands because the robot turns against the head, as the application reports.
GST_START_TEST(a_head_that_turns_against_its_robot_does_not_slip) {
  scene::Line line(kLens);
  show(line, {.gain = 0, .reported = true}, 1, 160);
  fail_unless(line.messages(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST

// Two of the three changes of speed that it takes, and two more: those before are of the other lens.
GST_START_TEST(with_another_lens_the_comparison_begins_anew) {
  scene::Line line(kLens);
  show(line, {.gain = 0.5}, 0, 85);
  GstElement* motion = gst_bin_get_by_name(GST_BIN(line.harness->element), "motion");
  g_object_set(motion, "horizontal-fov", 61.0, nullptr);
  gst_object_unref(motion);
  show(line, {.gain = 0.5}, 85, 145);
  fail_unless(line.messages(GST_MESSAGE_WARNING).empty());
  show(line, {.gain = 0.5}, 145, 180);
  fail_unless_equals_int(line.messages(GST_MESSAGE_WARNING).size(), 1);
}
GST_END_TEST

// The element that made the frames attached the pose that it used: that pose cannot be wrong.
GST_START_TEST(poses_that_came_on_the_frames_are_not_judged) {
  scene::Line line(kLens);
  show(line, {.gain = -1, .carried = true}, 0, 120);
  fail_unless(line.messages(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST

// There is a head, but not the one that is selected: its motion is unknown.
GST_START_TEST(another_heads_pose_on_the_frames_leaves_the_base_unknown) {
  scene::Line line(kLens);
  fail_unless(std::isnan(show(line, {.head = "another", .carried = true}, 0, 20)));
}
GST_END_TEST

GST_START_TEST(what_a_faulty_head_did_is_not_taken_for_the_base) {
  scene::Line line(kLens);
  const double rate = show(line, {.gain = 0}, 0, 160);
  fail_unless(std::isnan(rate), "%g", rate);
}
GST_END_TEST

GST_START_TEST(an_application_knows_its_robot_better) {
  scene::Line line(kLens);
  gst_harness_push_upstream_event(line.harness, base_event(33, 10 * scene::kStep));
  fail_unless(std::abs(show(line, {}, 0, 10)) < 1);
  fail_unless(show(line, {}, 10, 20) == 33);
  // For a second: then it has fallen silent, and what is seen counts.
  fail_unless(show(line, {}, 20, 35) == 33);
  const double later = show(line, {}, 35, 36);
  fail_unless(std::abs(later) < 1, "%g", later);
  // It is passed on, too.
  bool passed = false;
  while (GstEvent* event = gst_harness_try_pull_upstream_event(line.harness)) {
    passed = passed || parse_base(event, nullptr, nullptr);
    gst_event_unref(event);
  }
  fail_unless(passed);
  // What the frame carries stays.
  GstBuffer* in = looking_at(0, 20);
  const CerberusBase carried = turning_at(-4);
  cerberus_buffer_set_base(in, &carried);
  GstBuffer* out = line.through(in);
  fail_unless(cerberus_buffer_peek_base(out)->yaw_rate == -4);
  gst_buffer_unref(out);
  line.restart();
  const double rate = show(line, {}, 0, 12);
  fail_unless(std::abs(rate) < 1, "of the run before: %g", rate);
}
GST_END_TEST

GST_START_TEST(a_base_on_a_buffer_survives_conversion_and_scaling) {
  for (const char* element : {"identity", "videoconvert ! capsfilter caps=video/x-raw,format=I420",
                              "videoscale ! capsfilter caps=video/x-raw,width=160"}) {
    scene::Line line(element);
    GstBuffer* in = blank(0);
    const CerberusBase carried = turning_at(7.5);
    fail_unless(cerberus_buffer_set_base(in, &carried));
    GstBuffer* out = line.through(in);
    g_autoptr(CerberusBase) base = cerberus_buffer_get_base(out);
    fail_unless(base && base->yaw_rate == 7.5 && base->source == CERBERUS_BASE_REPORTED, "%s", element);
    fail_unless(cerberus_buffer_set_base(out, nullptr) && !cerberus_buffer_peek_base(out));
    gst_buffer_unref(out);
  }
}
GST_END_TEST

static Suite* carrier_suite() {
  watch_library_log();
  Suite* s = suite_create("carrier");
  TCase* tc = tcase_create("cameramotion");
  tcase_set_timeout(tc, 60);
  suite_add_tcase(s, tc);
  tcase_add_test(tc, a_head_that_executes_its_commands_causes_no_warning_and_its_base_stands);
  tcase_add_test(tc, a_head_that_does_not_is_warned_of_once);
  tcase_add_test(tc, without_a_lens_or_with_a_blank_picture_nothing_is_said);
  tcase_add_test(tc, a_robots_turning_is_measured_and_no_fault_of_the_head);
  tcase_add_test(tc, a_head_that_turns_against_its_robot_does_not_slip);
  tcase_add_test(tc, with_another_lens_the_comparison_begins_anew);
  tcase_add_test(tc, poses_that_came_on_the_frames_are_not_judged);
  tcase_add_test(tc, another_heads_pose_on_the_frames_leaves_the_base_unknown);
  tcase_add_test(tc, what_a_faulty_head_did_is_not_taken_for_the_base);
  tcase_add_test(tc, an_application_knows_its_robot_better);
  tcase_add_test(tc, a_base_on_a_buffer_survives_conversion_and_scaling);
  return s;
}

GST_CHECK_MAIN(carrier)
