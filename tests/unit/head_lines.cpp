// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/helper/head_lines.h"

#include <cmath>
#include <random>
#include <string>

#include "sensing/angles.h"
#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::motion::AxisCommand;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;
using Kind = AxisCommand::Kind;

namespace {

template <typename Line>
Line parsed(const std::string& text) {
  const auto line = parse_helper_line(text);
  ck_assert_msg(line && std::holds_alternative<Line>(*line), "%s", text.c_str());
  return std::get<Line>(*line);
}

}  // namespace

START_TEST(the_first_line_has_version_timeout_limits_and_start) {
  HeadSetup setup;
  setup.limits.pan = {radians(-170), radians(170), radians(90), radians(600)};
  setup.limits.tilt = {radians(-45), radians(30.5), radians(60), radians(300)};
  setup.pan = radians(12.25);
  assert_text(hello_line(setup, 500ms),
              "cerberus-head 1 timeout 0.5 limits -170 170 -45 30.5 speed 90 60 acceleration 600 300 "
              "start 12.25 0\n");
}
END_TEST

START_TEST(a_move_has_a_command_for_each_axis) {
  assert_text(move_line({Kind::position, radians(30), radians(90)}, {}), "move to 30 90 hold\n");
  assert_text(move_line({Kind::velocity, radians(-20.5), 0}, {Kind::position, 0, radians(1)}),
              "move at -20.5 to 0 1\n");
}
END_TEST

START_TEST(numbers_that_are_none_hold) {
  for (const double wrong : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    assert_text(move_line({Kind::position, wrong, 1}, {Kind::velocity, wrong, 0}), "move hold hold\n");
    assert_text(move_line({Kind::position, 1, wrong}, {}), "move hold hold\n");
  }
}
END_TEST

START_TEST(ready_lists_abilities_and_skips_those_of_later_versions) {
  const HeadAbilities all =
      parsed<ReadyLine>("ready 1 position velocity feedback zoom rate 20 iris").abilities;
  ck_assert(all.position && all.velocity && all.feedback && all.zoom);
  assert_text(ready_line(all), "ready 1 position velocity feedback zoom rate 20");
  ck_assert_double_eq(all.rate, 20);
  const HeadAbilities one = parsed<ReadyLine>("ready 1 velocity").abilities;
  ck_assert(!one.position && one.velocity && !one.feedback && !one.zoom);
}
END_TEST

START_TEST(a_pose_is_in_degrees) {
  const PoseLine pose = parsed<PoseLine>("pose -10.5 20 30 -40 0.15");
  ck_assert_double_eq_tol(degrees(pose.pan.position), -10.5, 1e-9);
  ck_assert_double_eq_tol(degrees(pose.tilt.position), 20, 1e-9);
  ck_assert_double_eq_tol(degrees(pose.pan.speed), 30, 1e-9);
  ck_assert_double_eq_tol(degrees(pose.tilt.speed), -40, 1e-9);
  ck_assert_double_eq(pose.age, 0.15);
}
END_TEST

START_TEST(a_zoom_is_0_to_2) {
  ck_assert_double_eq(parsed<ZoomLine>("zoom 0.25").position, .25);
  assert_text(zoom_line({.position = .25}), "zoom 0.25");
  const auto order = parse_pipeline_line("zoom 0.25");
  ck_assert(order && std::get<ZoomLine>(*order).position == .25);
  for (const char* wrong : {"zoom", "zoom -0.1", "zoom 2.1", "zoom nan", "zoom 0.5 1"})
    ck_assert_msg(!parse_helper_line(wrong) && !parse_pipeline_line(wrong), "%s", wrong);
}
END_TEST

START_TEST(faults_keep_their_words) {
  assert_text(parsed<FaultLine>("fault no port /dev/ttyUSB0: permission denied").text,
              "no port /dev/ttyUSB0: permission denied");
  assert_text(parsed<StoppedLine>("stopped silence").text, "silence");
  parsed<RecoveredLine>("recovered");
  ck_assert(parsed<EmergencyLine>("emergency pressed").pressed);
  ck_assert(!parsed<EmergencyLine>("emergency released").pressed);
}
END_TEST

START_TEST(what_is_no_line_of_the_protocol_is_refused) {
  for (const char* wrong : {"",
                            " ",
                            "ready",
                            "ready 2 position",
                            "ready 1",
                            "ready 1 feedback",
                            "ready 1 position rate 0",
                            "ready 1 position rate nan",
                            "pose 1 2 3 4",
                            "pose 1 2 3 4 -1",
                            "pose nan 0 0 0 0",
                            "pose 1e9 0 0 0 0",
                            "pose 1 2 3 4 5 6",
                            "pose 1,5 0 0 0 0",
                            "fault",
                            "recovered now",
                            "emergency",
                            "emergency perhaps",
                            "READY 1 position",
                            "move at 3 hold"})
    ck_assert_msg(!parse_helper_line(wrong), "'%s'", wrong);
}
END_TEST

START_TEST(what_a_pipeline_writes_a_helper_reads) {
  HeadSetup setup;
  setup.limits.pan = {radians(-100), radians(90), radians(80), radians(500)};
  setup.tilt = radians(-3);
  std::string line = hello_line(setup, 250ms);
  line.pop_back();
  const auto hello = parse_pipeline_line(line);
  ck_assert(hello && std::holds_alternative<HelloLine>(*hello));
  const HeadSetup& read = std::get<HelloLine>(*hello).setup;
  ck_assert_double_eq_tol(degrees(read.limits.pan.from), -100, 1e-9);
  ck_assert_double_eq_tol(degrees(read.limits.tilt.acceleration), 600, 1e-9);
  ck_assert_double_eq_tol(degrees(read.tilt), -3, 1e-9);
  ck_assert(read.helper_timeout == 250ms);
  const auto move = parse_pipeline_line("move to 30 90 at -2.5");
  ck_assert(move && std::holds_alternative<MoveLine>(*move));
  ck_assert(std::get<MoveLine>(*move).pan.kind == Kind::position);
  ck_assert_double_eq_tol(degrees(std::get<MoveLine>(*move).pan.value), 30, 1e-9);
  ck_assert(std::get<MoveLine>(*move).tilt.kind == Kind::velocity);
  for (const char* wrong :
       {"cerberus-head 2 timeout 0.5 limits -1 1 -1 1 speed 1 1 acceleration 1 1 start 0 0",
        "cerberus-head 1 timeout 0 limits -1 1 -1 1 speed 1 1 acceleration 1 1 start 0 0",
        "cerberus-head 1 timeout 0.5 limits 1 -1 -1 1 speed 1 1 acceleration 1 1 start 0 0", "move",
        "move hold", "move to 3 hold", "move to 3 -1 hold", "move hold hold hold", "limits 5 -5 0 0",
        "stop now", "fault x"})
    ck_assert_msg(!parse_pipeline_line(wrong), "%s", wrong);
}
END_TEST

START_TEST(what_a_helper_writes_a_pipeline_reads) {
  const HeadAbilities some = parsed<ReadyLine>(ready_line({true, false, true, 12.5})).abilities;
  ck_assert(some.position && !some.velocity && some.feedback);
  ck_assert_double_eq(some.rate, 12.5);
  const PoseLine pose = parsed<PoseLine>(pose_line({{radians(-7.25), 0, 0}, {0, radians(3), 0}, 0.05}));
  ck_assert_double_eq_tol(degrees(pose.pan.position), -7.25, 1e-9);
  ck_assert_double_eq_tol(degrees(pose.tilt.speed), 3, 1e-9);
  ck_assert_double_eq(pose.age, 0.05);
  ck_assert(!some.home);
  ck_assert(parsed<ReadyLine>(ready_line({false, true, false, 20, true})).abilities.home);
  assert_text(speeds_line({{radians(19), radians(-6)}, 0.125}), "speeds 19 -6 0.125");
  const SpeedsLine speeds = parsed<SpeedsLine>("speeds 19 -6 0.125");
  ck_assert_double_eq_tol(degrees(speeds.speed.tilt), -6, 1e-9);
  ck_assert_double_eq(speeds.age, 0.125);
  assert_text(homed_line({{0, radians(-3)}}), "homed 0 -3");
  ck_assert_double_eq_tol(degrees(parsed<HomedLine>("homed 0 -3").at.tilt), -3, 1e-9);
  for (const char* wrong : {"speeds 1 2", "speeds 1 2 -1", "speeds 1 2 3 4", "homed 1", "homed 1 2 3"})
    ck_assert_msg(!parse_helper_line(wrong), "%s", wrong);
}
END_TEST

START_TEST(any_bytes_are_parsed_without_harm) {
  std::mt19937 random(3);
  const std::string words[] = {"ready", "pose",     "fault", "1",    "-3.5",
                               " ",     "position", "rate",  "\xff", "1e308"};
  for (int k = 0; k < 20000; ++k) {
    std::string text;
    for (unsigned n = random() % 9; n > 0; --n)
      text += words[random() % std::size(words)] + (random() % 2 ? " " : "");
    parse_pipeline_line(text);
    if (const auto line = parse_helper_line(text))
      if (const auto* pose = std::get_if<PoseLine>(&*line)) ck_assert(std::isfinite(pose->pan.position));
  }
}
END_TEST

START_TEST(lines_come_whole_however_their_bytes_arrive) {
  LineBuffer lines;
  lines.append("ready 1 po");
  ck_assert(!lines.take());
  lines.append("sition\npose 1 2");
  assert_text(lines.take().value(), "ready 1 position");
  ck_assert(!lines.take());
  lines.append(" 3 4 0\n\n");
  assert_text(lines.take().value(), "pose 1 2 3 4 0");
  assert_text(lines.take().value(), "");
  ck_assert(!lines.take());
}
END_TEST

START_TEST(a_line_that_is_too_long_is_dropped_whole) {
  LineBuffer lines;
  for (int k = 0; k < 100; ++k) lines.append(std::string(kMostLine, 'x'));
  lines.append("\nready 1 position\n");
  assert_text(lines.take().value(), "ready 1 position");
  const std::string longest(kMostLine - 1, 'y');
  lines.append(longest + "\n");
  assert_text(lines.take().value(), longest.c_str());
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "head_lines", {the_first_line_has_version_timeout_limits_and_start, a_move_has_a_command_for_each_axis,
                     numbers_that_are_none_hold, ready_lists_abilities_and_skips_those_of_later_versions,
                     a_pose_is_in_degrees, a_zoom_is_0_to_2, faults_keep_their_words,
                     what_is_no_line_of_the_protocol_is_refused, what_a_pipeline_writes_a_helper_reads,
                     what_a_helper_writes_a_pipeline_reads, any_bytes_are_parsed_without_harm,
                     lines_come_whole_however_their_bytes_arrive, a_line_that_is_too_long_is_dropped_whole});
}
