// SPDX-License-Identifier: LGPL-2.1-or-later
// pantiltsink whose limits change while it plays: they apply at once, and the head stays safe.
#include <algorithm>

#include "head_rig.h"

namespace {

using namespace head_rig;

struct Axis {
  const char* property;
  double from, limit;  // where the head is sent, and how far it may go then
  double CerberusPose::* position;
};
constexpr Axis kStops[] = {{"pan-min", -100, -30, &CerberusPose::pan},
                           {"pan-max", 100, 30, &CerberusPose::pan},
                           {"tilt-min", -40, -10, &CerberusPose::tilt},
                           {"tilt-max", 40, 10, &CerberusPose::tilt}};

void send(Rig& rig, const Axis& axis) {
  const bool pan = axis.position == &CerberusPose::pan;
  fail_unless(rig.call("move-to", pan ? axis.from : 0, pan ? 0 : axis.from));
}

GST_START_TEST(a_head_that_is_beyond_a_new_limit_returns_to_it_from_the_next_frame_on) {
  for (const Axis& axis : kStops) {
    Rig rig;
    send(rig, axis);
    auto poses = act(rig, CERBERUS_FUSION_HOLD, 0, 75);
    fail_unless(std::fabs(poses.back().*axis.position - axis.from) < 1e-9);
    fail_unless(rig.call("stop"));  // it is to stay where it is, and may not
    poses = act(rig, CERBERUS_FUSION_HOLD, 75, 1);
    const GstClockTime published = poses.back().valid_until;
    g_object_set(rig.element, axis.property, axis.limit, nullptr);
    poses = act(rig, CERBERUS_FUSION_HOLD, 76, 1);
    // Published poses stay valid; the return begins after them.
    fail_unless_equals_uint64(poses.front().valid_from, published);
    fail_unless(poses.back().moving, "%s", axis.property);
    double last = axis.from;
    for (const CerberusPose& pose : act(rig, CERBERUS_FUSION_HOLD, 77, 75)) {
      fail_unless(std::fabs(pose.*axis.position) <= std::fabs(last) + 1e-9);
      last = pose.*axis.position;
    }
    fail_unless(std::fabs(last - axis.limit) < 1e-9, "%s: %g", axis.property, last);
    fail_unless(rig.warnings().empty());
  }
}
GST_END_TEST

GST_START_TEST(a_head_on_its_way_beyond_a_new_limit_stops_at_it) {
  for (const Axis& axis : kStops) {
    Rig rig("max-speed=20");
    send(rig, axis);
    act(rig, CERBERUS_FUSION_HOLD, 0, 5);  // at less than 4 degrees
    g_object_set(rig.element, axis.property, axis.limit, nullptr);
    const auto poses = act(rig, CERBERUS_FUSION_HOLD, 5, 150);
    for (const CerberusPose& pose : poses)
      fail_unless(std::fabs(pose.*axis.position) <= std::fabs(axis.limit) + 1e-9);
    fail_unless(std::fabs(poses.back().*axis.position - axis.limit) < 1e-9);
    // And none of the application's is obeyed any further.
    send(rig, axis);
    fail_unless(rig.messages().back().reason.find("as far as the limit") != std::string::npos);
    for (const CerberusPose& pose : act(rig, CERBERUS_FUSION_HOLD, 155, 25))
      fail_unless(std::fabs(pose.*axis.position) <= std::fabs(axis.limit) + 1e-9);
  }
}
GST_END_TEST

GST_START_TEST(a_turn_to_the_stop_ends_at_the_new_stop) {
  Rig rig("pan-max=20");
  auto poses = act(rig, CERBERUS_FUSION_TURN_RIGHT, 0, 50);
  fail_unless(std::fabs(poses.back().pan - 20) < 1e-9);
  std::string states = rig.states();
  fail_unless_equals_string(states.c_str(), "turning limited");
  g_object_set(rig.element, "pan-max", 40.0, nullptr);
  poses = act(rig, CERBERUS_FUSION_TURN_RIGHT, 50, 50);
  fail_unless(std::fabs(poses.back().pan - 40) < 1e-9);
  states = rig.states();
  fail_unless_equals_string(states.c_str(), "turning limited");
}
GST_END_TEST

// From 40 to 10 degrees a second at 600 a second squared takes 50 ms.
GST_START_TEST(a_new_speed_holds_after_the_latency_and_braking) {
  Rig rig;
  fail_unless(rig.call("move-to", 150, 0));
  act(rig, CERBERUS_FUSION_HOLD, 0, 25);
  g_object_set(rig.element, "max-speed", 10.0, nullptr);
  act(rig, CERBERUS_FUSION_HOLD, 25, 1);
  for (const CerberusPose& pose : act(rig, CERBERUS_FUSION_HOLD, 26, 4)) {
    if (pose.valid_from < 1240 * GST_MSECOND)
      continue;  // commanded at 0.96, in effect at 1.02, from 90 in 133 ms
    fail_unless(std::fabs(pose.pan_speed - 10) < 1e-6, "%g", pose.pan_speed);
  }
  g_object_set(rig.element, "max-speed", 80.0, nullptr);
  double fastest = 0;
  for (const CerberusPose& pose : act(rig, CERBERUS_FUSION_TURN_RIGHT, 30, 25))
    fastest = std::max(fastest, pose.pan_speed);
  fail_unless(fastest > 10);
}
GST_END_TEST

GST_START_TEST(a_new_acceleration_holds_for_the_next_turn) {
  Rig rig;
  act(rig, CERBERUS_FUSION_HOLD, 0, 1);
  g_object_set(rig.element, "max-acceleration", 100.0, nullptr);
  double most = 0;
  for (const CerberusPose& pose : act(rig, CERBERUS_FUSION_TURN_RIGHT, 1, 5))
    most = std::max(most, pose.pan_acceleration);
  fail_unless(std::fabs(most - 100) < 1e-6, "%g", most);
}
GST_END_TEST

GST_START_TEST(limits_that_cannot_be_are_warned_of_and_change_nothing) {
  Rig rig("pan-max=20");
  act(rig, CERBERUS_FUSION_TURN_RIGHT, 0, 25);
  g_object_set(rig.element, "pan-max", -10.0, nullptr);
  std::string text = rig.warnings();
  fail_unless(text ==
                  "pan-min -170 and pan-max -10 exclude 0: the head could not return to where it looks "
                  "straight ahead. The limits stay as they were.\n",
              "%s", text.c_str());
  g_object_set(rig.element, "turn-speed", 30.0, nullptr);  // another property: no second message
  text = rig.warnings();
  fail_unless(text.empty(), "%s", text.c_str());
  auto poses = act(rig, CERBERUS_FUSION_TURN_RIGHT, 25, 25);
  fail_unless(std::fabs(poses.back().pan - 20) < 1e-9);
  g_object_set(rig.element, "pan-max", 25.0, nullptr);
  fail_unless(rig.warnings().empty());
  poses = act(rig, CERBERUS_FUSION_TURN_RIGHT, 50, 25);
  fail_unless(std::fabs(poses.back().pan - 25) < 1e-9);
}
GST_END_TEST

GST_START_TEST(a_refused_limit_reads_as_the_one_in_force) {
  Rig rig("pan-min=-60");
  const auto value = [&rig](const char* name) {
    double value = 0;
    g_object_get(rig.element, name, &value, nullptr);
    return value;
  };
  g_object_set(rig.element, "pan-min", 20.0, nullptr);
  fail_unless(rig.warnings().find("pan-min 20 and pan-max 170 exclude 0") == 0);
  fail_unless_equals_float(value("pan-min"), -60);
  g_object_set(rig.element, "pan-min", 20.0, nullptr);  // once more: it is refused once more
  fail_unless(!rig.warnings().empty());
  g_object_set(rig.element, "pan-min", -30.0, nullptr);
  fail_unless(rig.warnings().empty());
  fail_unless_equals_float(value("pan-min"), -30);
  const auto poses = act(rig, CERBERUS_FUSION_TURN_LEFT, 0, 40);
  fail_unless(std::fabs(poses.back().pan + 30) < 1e-9);
  // Before a head is open nothing is in force: the error at the start names what was set.
  gst_element_set_state(rig.element, GST_STATE_NULL);
  g_object_set(rig.element, "pan-min", 20.0, nullptr);
  fail_unless_equals_float(value("pan-min"), 20);
}
GST_END_TEST

GST_START_TEST(the_ranges_hold_what_a_head_accepts) {
  Rig rig;
  for (const char* name : {"max-speed", "max-acceleration"}) {
    auto* spec = G_PARAM_SPEC_DOUBLE(g_object_class_find_property(G_OBJECT_GET_CLASS(rig.element), name));
    for (const double most : {spec->minimum, spec->maximum}) {
      g_object_set(rig.element, name, most, nullptr);
      const std::string text = rig.warnings();
      fail_unless(text.empty(), "%s=%g: %s", name, most, text.c_str());
    }
  }
}
GST_END_TEST

GST_START_TEST(in_a_pause_the_head_stays_and_the_limits_count_afterwards) {
  Rig rig("start-pan=50");
  act(rig, CERBERUS_FUSION_HOLD, 0, 5);
  gst_element_set_state(rig.element, GST_STATE_PAUSED);
  rig.poses();
  g_object_set(rig.element, "pan-max", 30.0, nullptr);
  fail_unless(rig.poses().empty());
  gst_element_set_state(rig.element, GST_STATE_PLAYING);
  const auto poses = act(rig, CERBERUS_FUSION_HOLD, 5, 25);
  fail_unless_equals_float(poses.front().pan, 50);
  fail_unless(std::fabs(poses.back().pan - 30) < 1e-9);
}
GST_END_TEST

GST_START_TEST(published_poses_stay_valid) {
  Rig rig("start-pan=50");
  constexpr GstClockTime kSlow = GST_SECOND / 2;  // published until the next one: longer than the latency
  rig.push(frame_at(0, kSlow));
  fail_unless_equals_uint64(rig.poses().back().valid_until, kSlow);
  g_object_set(rig.element, "pan-max", 30.0, nullptr);
  rig.push(frame_at(kSlow, kSlow));
  const auto poses = rig.poses();
  fail_unless_equals_uint64(poses.front().valid_from, kSlow);
  fail_unless_equals_float(poses.front().pan, 50);
  fail_unless(poses.front().moving);
}
GST_END_TEST

GST_START_TEST(a_real_head_receives_limits_when_the_pause_ends) {
  Pipe record;
  Rig rig("driver=scripted latency=0 script=\"record " + record.writer() + "\"", Source::live);
  fail_unless(record.line().starts_with("open"));
  fail_unless(rig.call("move-to", 90, 0));
  fail_unless(record.line().starts_with("command"));
  gst_element_set_state(rig.element, GST_STATE_PAUSED);
  fail_unless(record.line().starts_with("stop"));
  g_object_set(rig.element, "pan-max", 45.0, nullptr);
  gst_element_set_state(rig.element, GST_STATE_PLAYING);
  fail_unless(record.line().starts_with("limit"));  // once
  fail_unless(record.line().starts_with("command"));
}
GST_END_TEST

// Without a frame, while the clock runs and the application has the head in its hand.
GST_START_TEST(with_a_clock_a_limit_counts_without_a_frame) {
  Pipe record;
  Rig rig("driver=scripted latency=0 script=\"record " + record.writer() + "\"", Source::live);
  fail_unless(record.line().starts_with("open"));
  fail_unless(rig.call("move-to", 90, 0));
  fail_unless(record.line().starts_with("command"));
  g_object_set(rig.element, "pan-max", 45.0, nullptr);
  const std::string limit = record.line();
  fail_unless(limit.starts_with("limit ") && limit.find(" 0.7853") != std::string::npos, "%s", limit.c_str());
  // The driver may answer later than the element waits; the element queries it again when the clock has advanced.
  for (double pan = 0; std::fabs(pan - 45) > 1e-9; rig.crank())
    for (const CerberusPose& pose : rig.poses()) pan = pose.pan;
}
GST_END_TEST

GST_START_TEST(a_driver_that_refuses_limits_is_warned_of) {
  Rig rig("driver=scripted script=\"limit fail no memory\"");
  act(rig, CERBERUS_FUSION_HOLD, 0, 1);
  g_object_set(rig.element, "pan-max", 45.0, nullptr);
  for (int k = 1; k < 5; ++k) act(rig, CERBERUS_FUSION_TURN_RIGHT, k, 1);
  const std::string text = rig.warnings();
  fail_unless(text == "The head \"head\" fails: no memory\n", "%s", text.c_str());
}
GST_END_TEST

GST_START_TEST(what_is_read_at_the_start_says_so) {
  const std::vector<std::string> start{"zoom-table",     "keep-size",      "lock-zoom",  "base-gyro",
                                       "calibration",    "camera-name",    "command",    "device",
                                       "device-options", "helper-timeout", "driver",     "head",
                                       "script",         "start-pan",      "start-tilt", "latency",
                                       "step-size",      "backlash",       "noise",      "seed"};
  GstElement* element = gst_element_factory_make("pantiltsink", nullptr);
  guint count = 0;
  GParamSpec** specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(element), &count);
  std::size_t found = 0;
  for (guint k = 0; k < count; ++k) {
    if (specs[k]->owner_type != G_OBJECT_TYPE(element)) continue;
    const bool at_start = std::ranges::find(start, specs[k]->name) != start.end();
    fail_unless(!(specs[k]->flags & GST_PARAM_MUTABLE_READY) == !at_start, "%s", specs[k]->name);
    fail_unless(!(specs[k]->flags & GST_PARAM_MUTABLE_PLAYING) == at_start, "%s", specs[k]->name);
    found += at_start;
  }
  fail_unless_equals_int(found, start.size());
  g_free(specs);
  gst_object_unref(element);
}
GST_END_TEST

Suite* pantiltsink_limits_suite() {
  Suite* suite = suite_create("pantiltsink with other limits");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_test(tests, a_head_that_is_beyond_a_new_limit_returns_to_it_from_the_next_frame_on);
  tcase_add_test(tests, a_head_on_its_way_beyond_a_new_limit_stops_at_it);
  tcase_add_test(tests, a_turn_to_the_stop_ends_at_the_new_stop);
  tcase_add_test(tests, a_new_speed_holds_after_the_latency_and_braking);
  tcase_add_test(tests, a_new_acceleration_holds_for_the_next_turn);
  tcase_add_test(tests, limits_that_cannot_be_are_warned_of_and_change_nothing);
  tcase_add_test(tests, a_refused_limit_reads_as_the_one_in_force);
  tcase_add_test(tests, the_ranges_hold_what_a_head_accepts);
  tcase_add_test(tests, in_a_pause_the_head_stays_and_the_limits_count_afterwards);
  tcase_add_test(tests, published_poses_stay_valid);
  tcase_add_test(tests, a_real_head_receives_limits_when_the_pause_ends);
  tcase_add_test(tests, with_a_clock_a_limit_counts_without_a_frame);
  tcase_add_test(tests, a_driver_that_refuses_limits_is_warned_of);
  tcase_add_test(tests, what_is_read_at_the_start_says_so);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(pantiltsink_limits);
