// SPDX-License-Identifier: LGPL-2.1-or-later
// A head of known table, dead time and play is measured by frames at 25 a second; and the file of what was measured.
#include "control/trials/calibration.h"
#include "control/trials/timeout_trial.h"

#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <random>
#include <string>

#include "drivers/head/head_calibration.h"
#include "drivers/head/repeated_start.h"
#include "drivers/simulated/simulated_head.h"
#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::control;
using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::motion::SpeedMap;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;
using Kind = cerberus::motion::AxisCommand::Kind;

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

struct Known {
  double gain = 1;       // actual / commanded speed
  double left = 1;       // and as much times that to the left
  double left_from = 0;  // degrees a second, as commanded: `left` counts from there on
  double fastest = 1e3;  // degrees a second, whatever is commanded
  double backlash = 0;   // degrees
  Time dead_time = 0ms;
  double noise = 0;     // degrees a frame
  int blind_from = -1;  // frames from here on are not measured
};

AxisCalibration measured(const Known& known, double reach = 60) {
  SimulatedHead head;
  HeadSetup setup;
  setup.latency = known.dead_time;
  setup.backlash = radians(known.backlash);
  setup.limits.pan.acceleration = radians(3000);  // ramps of at most 11 ms: half of it is dead time
  assert_text(head.open(setup), "");
  AxisCalibration axis(radians(reach), radians(90));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> noise(-known.noise, known.noise);
  double before = 0, error = 0;
  int frame = 0;
  for (Time now = 0s;; now += 40ms, ++frame) {
    const auto speed = axis.command(now);
    if (!speed) break;
    const Kind kind = *speed == 0 ? Kind::hold : Kind::velocity;
    const double left = *speed < -radians(known.left_from) ? known.left : 1;
    const double turns =
        left * std::clamp(known.gain * *speed, -radians(known.fastest), radians(known.fastest));
    assert_text(head.command({now, {kind, turns, 0}, {}}), "");
    cerberus::motion::Pose pose;
    assert_text(head.state(now, pose), "");
    const double wrong = radians(noise(random));
    const bool blind = known.blind_from >= 0 && frame >= known.blind_from;
    axis.add(now, blind ? kUnknown : pose.pan.position - before + wrong - error);
    before = pose.pan.position;
    error = wrong;
    ck_assert_double_le(std::abs(degrees(pose.pan.position)), 1.1 * reach * std::max(1.0, known.gain));
  }
  return axis;
}

}  // namespace

// Tolerances: speeds 1 %, dead time 10 ms (5 ms of it the ramp), backlash .05 degrees.
START_TEST(table_dead_time_and_backlash_are_recovered) {
  const AxisCalibration axis = measured({.gain = 0.8, .backlash = 0.6, .dead_time = 150ms});
  assert_text(axis.problem(), "");
  const auto points = axis.speeds().points();
  ck_assert_uint_eq(points.size(), 4);  // 2, 4, 8, 16; 32 degrees a second do not fit twice into 60 degrees
  for (const auto& point : points) ck_assert_double_eq_tol(point.actual / point.commanded, 0.8, 0.008);
  ck_assert_double_eq_tol(axis.dead_time(), 0.15, 0.01);
  ck_assert_double_eq_tol(degrees(axis.backlash()), 0.6, 0.05);
}
END_TEST

START_TEST(a_head_without_play_has_none) {
  const AxisCalibration axis = measured({.dead_time = 60ms});
  ck_assert_double_eq_tol(axis.dead_time(), 0.06, 0.01);
  ck_assert_double_lt(degrees(axis.backlash()), 0.05);
}
END_TEST

// .05 degrees of noise a frame: speeds 5 %, dead time 15 ms, backlash .15 degrees.
START_TEST(noise_of_the_picture_is_averaged) {
  const AxisCalibration axis =
      measured({.gain = 1.2, .backlash = 0.4, .dead_time = 200ms, .noise = 0.05}, 90);
  const auto points = axis.speeds().points();
  for (const auto& point : points) ck_assert_double_eq_tol(point.actual / point.commanded, 1.2, 0.06);
  ck_assert_double_eq_tol(axis.dead_time(), 0.2, 0.015);
  ck_assert_double_eq_tol(degrees(axis.backlash()), 0.4, 0.15);
}
END_TEST

// A head whose turns to the left are slower by a quarter: each speed has two runs at v and two at .75 v.
START_TEST(it_is_known_how_far_the_runs_lay_apart) {
  const AxisCalibration even = measured({.gain = 0.8, .backlash = 0.6, .dead_time = 150ms});
  const SpeedMap evenly = even.speeds();
  ck_assert_uint_eq(evenly.points().size(), 4);
  for (const auto& point : evenly.points()) {
    const Spread runs = even.speed_runs(point.commanded);
    ck_assert_int_eq(runs.runs, 4);
    ck_assert_double_le(runs.least, point.actual);
    ck_assert_double_ge(runs.most, point.actual);
    ck_assert_double_lt(runs.most - runs.least, .01 * point.actual);
  }
  ck_assert_int_eq(even.dead_time_runs().runs, 8);
  ck_assert_double_eq_tol(even.dead_time_runs().least, 0.15, 0.02);
  ck_assert_double_eq_tol(even.dead_time_runs().most, 0.15, 0.02);
  ck_assert_int_eq(even.backlash_runs().runs, 7);
  ck_assert_double_eq_tol(degrees(even.backlash_runs().most), 0.6, 0.1);
  ck_assert(even.far_apart().commanded == 0 && even.far_apart().share == 0);

  const AxisCalibration uneven = measured({.left = 0.75});
  const SpeedMap unevenly = uneven.speeds();
  ck_assert_uint_eq(unevenly.points().size(), 4);
  for (const auto& point : unevenly.points()) {
    const Spread runs = uneven.speed_runs(point.commanded);
    ck_assert_double_eq_tol(runs.most / point.commanded, 1, 0.01);
    ck_assert_double_eq_tol(runs.least / point.commanded, 0.75, 0.01);
    ck_assert_double_eq_tol(point.actual / point.commanded, 0.875, 0.01);
  }
  ck_assert_double_eq_tol(uneven.far_apart().share, .25 / .875, .02);
  const AxisCalibration noisy =
      measured({.gain = 1.2, .backlash = 0.4, .dead_time = 200ms, .noise = 0.05}, 90);
  ck_assert_double_gt(noisy.dead_time_runs().most - noisy.dead_time_runs().least, 0.002);
}
END_TEST

// 16 degrees a second turn it at its fastest 8 to the right and at 4 to the left: their mean is in no table.
START_TEST(runs_that_lie_apart_at_a_speed_that_brings_nothing_are_known_too) {
  const AxisCalibration axis = measured({.left = 0.5, .left_from = 12, .fastest = 8});
  ck_assert_double_eq_tol(degrees(axis.speeds().points().back().commanded), 8, 1e-9);
  ck_assert_double_eq_tol(degrees(axis.far_apart().commanded), 16, 1e-9);
  ck_assert_double_eq_tol(axis.far_apart().share, 4. / 6, .02);
}
END_TEST

START_TEST(runs_are_named_with_their_ends) {
  Spread spread;
  assert_text(spread.text(1, 1), "0 runs");
  spread.add(4.25);
  assert_text(spread.text(1, 1), "1 run");
  spread.add(4);
  spread.add(-0.5);
  assert_text(spread.text(.5, 1), "3 runs, -1 to 8.5");
}
END_TEST

START_TEST(what_cannot_be_measured_ends_with_the_reason) {
  ck_assert(measured({.blind_from = 50}).problem().find("needs light") != std::string::npos);
  ck_assert(measured({.gain = 3}).problem().find("went further") != std::string::npos);
  AxisCalibration narrow(radians(2), radians(90));
  ck_assert(!narrow.command(0s));
  ck_assert(narrow.problem().find("no room") != std::string::npos);
}
END_TEST

// The helper is killed: nothing stops a device that has no Timeout. 1 s with a helper, 3 s without, 5 s in which the
// next one may start, and a dead time of .5 s: 38 degrees at 4 degrees a second, 19 at 2.
START_TEST(the_trial_of_the_device_s_own_timeout_stays_within_the_limits) {
  const auto wide = plan_timeout_trial({}, 0, radians(40));
  ck_assert(wide);
  ck_assert_double_eq_tol(degrees(wide->speed), 4, 1e-9);
  ck_assert_double_eq_tol(degrees(plan_timeout_trial({}, 0, radians(37))->speed), 2, 1e-9);
  ck_assert(!plan_timeout_trial({}, 0, radians(18)));
  // Towards the farther end, which leaves 33 + 6 degrees.
  ck_assert_double_eq_tol(degrees(plan_timeout_trial({}, radians(6), radians(33))->speed), -4, 1e-9);
  ck_assert_double_eq_tol(degrees(plan_timeout_trial({}, radians(-6), radians(33))->speed), 4, 1e-9);
  // A device whose step for 4 degrees a second makes 7 of it would go 66.5 degrees, and 28.5 at that for 2.
  const SpeedMap fast({{radians(2), radians(3)}, {radians(4), radians(7)}});
  ck_assert_double_eq_tol(degrees(plan_timeout_trial(fast, 0, radians(60))->speed), 2, 1e-9);
  for (double reach = 1; reach < 80; reach += 0.7)
    for (double at = -reach; at <= reach; at += 0.3)
      if (const auto trial = plan_timeout_trial(fast, radians(at), radians(reach)))
        ck_assert_double_le(std::abs(at + 9.5 * degrees(fast.actual(trial->speed))), reach + 1e-9);
}
END_TEST

namespace {

// A head at 4 degrees a second in 25 frames a second, whose helper is killed after 1 s, and which stops `stops` seconds
// later. Returns how the trial ends, and when.
struct Trial {
  TimeoutWatch::End end;
  double at, stopped_after;
};
struct Gap {
  double from = 1e9, to = 1e9;  // seconds: frames that are not measured
};
Trial tried(double stops, double reach = 40, bool seen = true, double key = 1e9, const Gap& gap = {}) {
  TimeoutWatch watch({radians(4), 1}, 0, radians(reach));
  for (int frame = 1;; ++frame) {
    const double now = 0.04 * frame;
    if (frame == 25) watch.kill(now);
    watch.add(now, !seen || (now > gap.from && now < gap.to) ? kUnknown
                   : now <= 1 + stops                        ? radians(0.16)
                                                             : radians(0.001));
    if (now >= key) watch.press_key();
    const auto end = watch.end(now);
    if (end != TimeoutWatch::End::none)
      return {end, now, end == TimeoutWatch::End::stopped ? watch.stopped_after() : -1};
    ck_assert_double_lt(now, 20);
  }
}

}  // namespace

START_TEST(a_head_without_its_helper_stops_goes_on_or_was_not_seen) {
  using End = TimeoutWatch::End;
  const Trial timeout = tried(1.4);
  ck_assert(timeout.end == End::stopped);
  ck_assert_double_eq_tol(timeout.stopped_after, 1.4, 0.041);
  ck_assert(tried(0).end == End::stopped && tried(0).stopped_after < 0.041);
  const Trial endless = tried(100);
  ck_assert(endless.end == End::turns);
  ck_assert_double_eq_tol(endless.at, 4, 0.041);
  const Trial narrow = tried(100, 6);  // it is at its end after 1.5 s
  ck_assert(narrow.end == End::turns);
  ck_assert_double_eq_tol(narrow.at, 1.5, 0.081);
  ck_assert(tried(100, 40, false).end == End::unseen);
}
END_TEST

START_TEST(frames_that_are_not_measured_are_no_rest) {
  using End = TimeoutWatch::End;
  constexpr double kNoKey = 1e9;
  // It turns all the time, and the picture loses it for 2 s after the kill.
  ck_assert(tried(100, 40, true, kNoKey, {1.01, 3.01}).end == End::turns);
  // It stops after 1.4 s in a gap that ends 2 s after the kill: it is known to have stopped by then.
  const Trial late = tried(1.4, 40, true, kNoKey, {1.01, 3.01});
  ck_assert(late.end == End::stopped);
  ck_assert_double_eq_tol(late.stopped_after, 2, 0.081);
  // A single frame without motion before the gap is none either.
  const Trial once = tried(0, 40, true, kNoKey, {1.05, 3.01});
  ck_assert(once.end == End::stopped);
  ck_assert_double_eq_tol(once.stopped_after, 2, 0.081);
  // Nothing is measured after the kill.
  ck_assert(tried(100, 40, true, kNoKey, {1.01, 99}).end == End::unseen);
  ck_assert(tried(0, 40, true, kNoKey, {1.01, 99}).end == End::unseen);
}
END_TEST

START_TEST(a_key_ends_the_trial_and_nothing_is_said_of_the_head) {
  for (const double key : {0.5, 2.0}) {
    const Trial ended = tried(1.9, 40, true, key);
    ck_assert(ended.end == TimeoutWatch::End::key);
    ck_assert_double_eq_tol(ended.at, key, 0.041);
  }
}
END_TEST

namespace {

// Starts of helpers in the test's own time, each of which takes `lasts` seconds; the first that works is number `good`.
struct Starts {
  double now = 100, lasts = 0, key_at = 1e9;
  int good = 0, starts = 0, reports = 0;
  std::string run() {
    const RepeatedStart repeated{[this] {
                                   now += lasts;
                                   return ++starts == good ? "" : std::string("it does not answer");
                                 },
                                 [this] { return now; }, [this] { return now >= key_at; },
                                 [this] { now += 0.01; },
                                 [this](const std::string& wrong) {
                                   assert_text(wrong, "it does not answer");
                                   ++reports;
                                 }};
    return repeated.run();
  }
};
constexpr char kTurns[] =
    "it does not answer. THE HEAD MAY STILL BE TURNING, and nothing stops it: cut its power";

}  // namespace

START_TEST(a_helper_is_started_once_a_second_until_one_answers) {
  Starts starts;
  starts.good = 3;
  assert_text(starts.run(), "");
  ck_assert_int_eq(starts.starts, 3);
  ck_assert_int_eq(starts.reports, 2);
  ck_assert_double_eq_tol(starts.now, 102, 0.05);
}
END_TEST

START_TEST(a_helper_that_never_answers_is_given_up_after_a_minute_or_at_a_key_with_a_warning) {
  Starts never;
  assert_text(never.run(), kTurns);
  ck_assert_double_ge(never.now, 160);
  ck_assert_int_le(never.starts, 61);
  ck_assert_int_ge(never.starts, 59);
  Starts slow;
  slow.lasts = 5;  // it waits for each of them
  assert_text(slow.run(), kTurns);
  ck_assert_int_eq(slow.starts, 12);
  Starts key;
  key.key_at = 103.5;
  assert_text(key.run(), kTurns);
  ck_assert_int_eq(key.starts, 4);
  ck_assert_double_eq_tol(key.now, 103.5, 0.05);
}
END_TEST

START_TEST(a_speed_map_goes_both_ways) {
  const SpeedMap map({{1, 2}, {3, 3}});
  ck_assert_double_eq(map.actual(0.5), 1);
  ck_assert_double_eq(map.actual(-2), -2.5);
  ck_assert_double_eq(map.actual(6), 6);  // beyond: in the last proportion
  ck_assert_double_eq(map.command_for(2.5), 2);
  ck_assert_double_eq(map.command_for(-1), -0.5);
  ck_assert_double_eq(SpeedMap().actual(-7), -7);
  ck_assert(!SpeedMap::is_valid({{1, 2}, {2, 2}}));
  ck_assert(!SpeedMap::is_valid({{0, 2}}));
}
END_TEST

namespace {

constexpr char kText[] =
    "cerberus-calibration = 1\ndriver = visca\ndevice = serial:/dev/ttyUSB0\ndead-time = 0.152\n"
    "pan-backlash = 0.3\ntilt-backlash = 0.1\npan-speeds = 4:4.2 16:15.1\nstops-alone = 1.4\n";

std::string wrong_with(const std::string& text) {
  HeadCalibration calibration;
  return parse_calibration(text, calibration);
}

}  // namespace

START_TEST(a_calibration_is_written_and_read) {
  HeadCalibration read;
  assert_text(parse_calibration(kText, read), "");
  assert_text(read.device, "serial:/dev/ttyUSB0");
  ck_assert(read.dead_time == 152ms);
  ck_assert_double_eq_tol(degrees(read.pan_backlash), 0.3, 1e-12);
  ck_assert_double_eq_tol(degrees(read.pan.actual(radians(4))), 4.2, 1e-9);
  ck_assert(read.tilt.points().empty());
  ck_assert_double_eq(*read.stops_alone, 1.4);
  assert_text(calibration_text(read), kText);
}
END_TEST

START_TEST(wrong_calibrations_are_refused_with_the_line) {
  assert_text(wrong_with(""), "there is no line `cerberus-calibration = 1`: it is no calibration of a head");
  assert_text(wrong_with("cerberus-calibration = 2"),
              "line 1: this version of Cerberus reads calibrations of version 1");
  assert_text(wrong_with("cerberus-calibration = 1\n# a comment\n\nspeed = 3"),
              "line 4: a calibration has no \"speed\"");
  assert_text(wrong_with("hello"), "line 1: \"hello\" is no `key = value`");
  assert_text(wrong_with("dead-time = 0,15"), "line 1: \"0,15\" cannot be dead-time: write seconds, 0 to 5");
  assert_text(wrong_with("dead-time = nan"), "line 1: \"nan\" cannot be dead-time: write seconds, 0 to 5");
  assert_text(
      wrong_with("pan-speeds = 4:4 3:5"),
      "line 1: \"4:4 3:5\" cannot be pan-speeds: write pairs COMMANDED:ACTUAL in degrees a second, both "
      "rising, parted by blanks: 1:0.9 10:9.5");
  assert_text(wrong_with("cerberus-calibration = 1"), "it does not name its driver and device");
}
END_TEST

START_TEST(a_calibration_of_another_device_is_refused_by_name) {
  const std::string path = "/tmp/cerberus-calibration-" + std::to_string(::getpid());
  std::ofstream(path) << kText;
  HeadCalibration read;
  assert_text(read_calibration(path, "visca", "serial:/dev/ttyUSB0", read), "");
  const std::string wrong = read_calibration(path, "visca", "udp:192.0.2.7:52381", read);
  ck_assert_msg(wrong.find("was measured with the visca head at serial:/dev/ttyUSB0") != std::string::npos,
                "%s", wrong.c_str());
  std::remove(path.c_str());
  ck_assert(read_calibration(path, "visca", "x", read).find("cannot be read: No such file") !=
            std::string::npos);
  ck_assert(read_calibration("/tmp", "visca", "x", read).find("cannot be read") != std::string::npos);
}
END_TEST

START_TEST(a_device_is_named_without_its_password) {
  assert_text(calibrated_device("onvif", "http://me:secret@192.0.2.9/onvif", ""), "http://192.0.2.9/onvif");
  assert_text(calibrated_device("external", "", "/opt/head.py --password=secret"), "/opt/head.py");
  assert_text(calibrated_device("visca", "udp:192.0.2.7:52381", ""), "udp:192.0.2.7:52381");
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "calibration",
      {table_dead_time_and_backlash_are_recovered, a_head_without_play_has_none,
       noise_of_the_picture_is_averaged, it_is_known_how_far_the_runs_lay_apart,
       runs_that_lie_apart_at_a_speed_that_brings_nothing_are_known_too, runs_are_named_with_their_ends,
       what_cannot_be_measured_ends_with_the_reason,
       the_trial_of_the_device_s_own_timeout_stays_within_the_limits,
       a_head_without_its_helper_stops_goes_on_or_was_not_seen, frames_that_are_not_measured_are_no_rest,
       a_key_ends_the_trial_and_nothing_is_said_of_the_head,
       a_helper_is_started_once_a_second_until_one_answers,
       a_helper_that_never_answers_is_given_up_after_a_minute_or_at_a_key_with_a_warning,
       a_speed_map_goes_both_ways, a_calibration_is_written_and_read,
       wrong_calibrations_are_refused_with_the_line, a_calibration_of_another_device_is_refused_by_name,
       a_device_is_named_without_its_password});
}
