// SPDX-License-Identifier: LGPL-2.1-or-later
// The stepper driver on lines that record their edges, with motors that follow the lines (support/fake_lines.h).
#include "drivers/stepper/stepper_head.h"

#include <algorithm>
#include <cerrno>

#include "drivers/head/emergency_stop.h"
#include "drivers/helper/head_server.h"
#include "support/fake_lines.h"
#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;
using cerberus::tests::CoilMotor;
using cerberus::tests::FakeLines;
using cerberus::tests::FakePort;
using cerberus::tests::LineEdge;
using cerberus::tests::StepMotor;
using Kind = cerberus::motion::AxisCommand::Kind;
using Command = cerberus::motion::AxisCommand;

namespace {

constexpr char kCoils[] = "lines=1,2,3,4";

StepperOptions options(const std::string& pan, const std::string& tilt = "") {
  StepperOptions options;
  options.chip = "chip0";
  assert_text(parse_stepper_axis(pan, options.pan), "");
  if (!tilt.empty()) assert_text(parse_stepper_axis(tilt, options.tilt), "");
  return options;
}

// A head, its lines and its pan motor, whose angle works its switch.
class Bench {
 public:
  explicit Bench(const StepperOptions& with) : head(with, std::make_unique<FakePort>(lines)) {}
  explicit Bench(const std::string& pan) : Bench(options(pan)) {}

  void open(const HeadSetup& setup = {}) {
    assert_text(head.open(setup, lines.now), "");
    follow();
  }
  // Calls tick() whenever it asks for that.
  void run(Time length) {
    const Time end = lines.now + length;
    while (lines.now < end) {
      const Time next = head.tick(lines.now);
      ck_assert(next >= lines.now);
      follow();
      if (const auto pose = head.take_pose(lines.now)) last = *pose;
      lines.now = std::min(end, next);
    }
    head.tick(lines.now);
    follow();
  }
  void move(const Command& pan, const Command& tilt = {}) { head.move(pan, tilt, lines.now); }
  void go(double pan_degrees) { move({Kind::position, radians(pan_degrees), radians(40)}); }
  bool lit() const {
    for (std::size_t k = 0; k < 4; ++k)
      if (lines.levels[k]) return true;
    return false;
  }
  void follow() {
    for (; seen < lines.edges.size(); ++seen) {
      replayed.levels.resize(lines.levels.size());
      const LineEdge& edge = lines.edges[seen];
      replayed.levels[edge.line] = edge.level;
      // Edges of the same moment, as both coils going off, move nothing on their way.
      const bool last_one = seen + 1 == lines.edges.size() || lines.edges[seen + 1].time != edge.time;
      if (last_one) motor.follow(replayed);
    }
    if (lines.inputs.empty()) return;
    const double at = motor.half_steps() * 360 / 4075.7728395 + zero;
    lines.inputs[0] = at <= -100;  // normally closed: open, pulled up, when it is pressed
  }
  double angle() const { return motor.half_steps() * 360 / 4075.7728395; }

  FakeLines lines, replayed;
  StepperHead head;
  CoilMotor motor;
  PoseLine last;
  double zero = 0;  // where the head really looks at the start, degrees
  std::size_t seen = 0;
};

}  // namespace

START_TEST(ninety_degrees_are_1019_half_steps_in_order_and_then_the_coils_are_off) {
  Bench bench(kCoils);
  bench.open();
  ck_assert(!bench.lit());
  bench.go(90);
  ck_assert_uint_eq(bench.lines.edges.size(), 1);  // on at once: the phase in which it rests
  bench.run(3s);
  ck_assert_int_eq(bench.motor.half_steps(), 1019);
  ck_assert_double_eq_tol(bench.angle(), 90, 0.0883 / 2);
  ck_assert_double_eq_tol(degrees(bench.last.pan.position), 90, 0.0883 / 2);
  ck_assert(bench.lit());
  const Time last_step = bench.lines.edges.back().time;
  // One edge each: one to begin with, and no three coils at once.
  ck_assert_uint_eq(bench.lines.edges.size(), 1 + 1019);
  bench.run(1s);
  ck_assert(!bench.lit());
  ck_assert_int_eq((bench.lines.edges.back().time - last_step).count(), Time(1s).count());
  // The position is not lost.
  bench.go(0);
  bench.run(5s);
  ck_assert_int_eq(bench.motor.half_steps(), 0);
  ck_assert_double_eq_tol(bench.last.pan.position, 0, 1e-9);
}
END_TEST

START_TEST(coils_that_are_never_released_stay_on_after_a_stop_and_go_off_with_the_head) {
  StepperOptions never = options(kCoils);
  never.release_delay.reset();
  Bench bench(never);
  bench.open();
  bench.go(90);
  bench.run(500ms);
  bench.head.stop(bench.lines.now);
  ck_assert(bench.head.stopping());
  bench.run(2s);
  ck_assert(!bench.head.stopping());
  ck_assert(bench.lit());
  bench.head.release(bench.lines.now);  // an emergency stop
  bench.follow();
  ck_assert(!bench.lit());
  FakeLines lines;
  {
    StepperHead head(never, std::make_unique<FakePort>(lines));
    head.open({}, 0s);
    head.move({Kind::velocity, 1, 0}, {}, 0s);
    ck_assert(lines.levels[0]);
  }
  for (std::size_t k = 0; k < 4; ++k) ck_assert(!lines.levels[k]);
}
END_TEST

START_TEST(coils_that_are_never_released_go_off_after_a_silence_and_at_the_end_and_not_at_a_stop) {
  for (const char* last : {"stop", "silence", "end", "stop and end", "stop and silence"}) {
    const std::string how = last;
    StepperOptions never = options(kCoils);
    never.release_delay.reset();
    Bench bench(never);
    HeadServer server(bench.head, [](const std::string&) {});
    const auto run = [&](Time length, bool ended, bool alive) {
      for (const Time end = bench.lines.now + length; bench.lines.now < end;) {
        if (alive) server.obey("alive", bench.lines.now);
        const Time next = ended ? server.finish(bench.lines.now) : server.serve(bench.lines.now);
        if (next == cerberus::motion::kNever && ended) break;
        bench.lines.now = std::min({end, next, bench.lines.now + 10ms});
      }
    };
    server.obey(
        "cerberus-head 1 timeout 0.5 limits -170 170 -45 45 speed 90 90 acceleration 600 600 start 0 0", 0s);
    server.obey("move at 20 hold", bench.lines.now);
    run(300ms, false, true);
    ck_assert(bench.lit());
    if (how.starts_with("stop")) server.obey("stop", bench.lines.now);
    run(2s, how == "end", how.starts_with("stop"));
    ck_assert_msg(bench.lit() == how.starts_with("stop"), "%s", last);
    if (how == "stop and end") run(2s, true, false);
    if (how == "stop and silence") run(2s, false, false);
    ck_assert_msg(bench.lit() == (how == "stop"), "%s", last);
  }
}
END_TEST

START_TEST(the_coils_follow_the_table_of_half_steps) {
  Bench bench(kCoils);
  bench.open();
  bench.move({Kind::position, radians(8 * 360 / 4075.7728395), 1});
  std::string table;
  std::size_t edges = 0;
  for (int k = 0; k < 100000 && bench.head.tick(bench.lines.now) < 10s; ++k) {
    if (bench.lines.edges.size() != edges) {
      for (std::size_t line = 0; line < 4; ++line) table += bench.lines.levels[line] ? '1' : '.';
      table += ' ';
      edges = bench.lines.edges.size();
    }
    bench.lines.now += 100us;
    if (bench.lines.now > 900ms) break;
  }
  // As the motor's data sheet has it; the first is where it rested.
  assert_text(table, "1... 11.. .1.. .11. ..1. ..11 ...1 1..1 1... ");
}
END_TEST

START_TEST(an_inverted_motor_turns_the_other_way) {
  Bench bench("lines=1,2,3,4 invert");
  bench.open();
  bench.go(10);
  bench.run(2s);
  ck_assert_int_eq(bench.motor.half_steps(), -113);  // 10 x 4075.77 / 360 = 113.2
  ck_assert_double_eq_tol(degrees(bench.last.pan.position), 10, 0.05);
}
END_TEST

START_TEST(step_and_direction_are_pulsed_with_their_times_and_enabled_only_to_move) {
  Bench bench("lines=1,2,3 steps=3200");
  bench.open();
  ck_assert(bench.lines.levels[2]);  // EN high: off
  StepMotor motor;
  bench.go(45);
  ck_assert(!bench.lines.levels[2]);
  for (const double target : {45.0, -9.0}) {
    bench.go(target);
    bench.run(4s);
  }
  FakeLines replay;
  replay.levels = {false, false, true};
  for (const LineEdge& edge : bench.lines.edges) {
    if (edge.line == 1) ck_assert(!replay.levels[0]);  // DIR changes between pulses
    replay.levels[edge.line] = edge.level;
    motor.follow(replay, edge);
  }
  ck_assert_int_eq(motor.steps(), -80);  // -9 / 360 x 3200
  ck_assert(bench.lines.levels[2]);      // off again
  // 400 + 480 pulses of 2 us, 2 changes of direction with 1 us before the pulse.
  ck_assert_int_eq(std::ranges::count(bench.lines.pauses, Time(2us)), 880);
  ck_assert_int_eq(std::ranges::count(bench.lines.pauses, Time(1us)), 2);
}
END_TEST

START_TEST(a_schedule_that_is_late_is_refused_and_said) {
  Bench bench(kCoils);
  bench.open();
  bench.go(90);
  bench.run(1s);
  const int there = bench.motor.half_steps();
  bench.lines.now += 300ms;  // the process was stopped
  bench.run(300ms);
  ck_assert_int_eq(bench.motor.half_steps(), there);
  ck_assert_msg(bench.head.fault().find("300 ms late") != std::string::npos ||
                    bench.head.fault().find("29") != std::string::npos,
                "'%s'", bench.head.fault().c_str());
  bench.run(300ms);
  assert_text(bench.head.fault(), "");
  bench.go(90);  // and goes on from where it is
  bench.run(4s);
  ck_assert_int_eq(bench.motor.half_steps(), 1019);
}
END_TEST

START_TEST(a_stop_brakes_within_a_quarter_of_a_second_and_switches_off) {
  Bench bench(kCoils);
  HeadSetup slow;
  slow.limits.pan.acceleration = radians(30);  // would take 1.3 s
  bench.open(slow);
  bench.go(90);
  bench.run(2s);
  ck_assert(bench.lit());
  bench.head.stop(bench.lines.now);
  ck_assert(bench.head.stopping());
  bench.run(280ms);
  ck_assert(!bench.lit());
  ck_assert(!bench.head.stopping());
  // The braking was counted: the position is right.
  bench.run(300ms);
  ck_assert_double_eq_tol(degrees(bench.last.pan.position), bench.angle(), 1e-6);
  bench.go(0);
  bench.run(5s);
  ck_assert_int_eq(bench.motor.half_steps(), 0);
}
END_TEST

START_TEST(the_end_of_the_driver_switches_off) {
  FakeLines lines;
  {
    StepperHead head(options(kCoils), std::make_unique<FakePort>(lines));
    head.open({}, 0s);
    head.move({Kind::velocity, 1, 0}, {}, 0s);
    ck_assert(lines.levels[0]);
  }
  ck_assert(!lines.levels[0] && !lines.levels[1] && !lines.levels[2] && !lines.levels[3]);
  ck_assert(!lines.open);
}
END_TEST

START_TEST(an_end_stop_gives_the_position) {
  Bench bench("lines=1,2,3,4 end-stop=9@-100 homing-speed=20");
  bench.zero = -37;  // it is taken to look ahead
  bench.lines.inputs = {false};
  bench.open();
  ck_assert(bench.head.busy());
  bench.go(25);  // waits
  bench.run(30s);
  ck_assert(!bench.head.busy());
  assert_text(bench.head.fault(), "");
  ck_assert_double_eq_tol(bench.angle() + bench.zero, 25, 0.2);  // one step, and the switch's own
  ck_assert(!bench.lit());
}
END_TEST

START_TEST(a_switch_that_is_pressed_at_the_start_is_left_first) {
  Bench bench("lines=1,2,3,4 end-stop=9@-100 homing-speed=20");
  bench.zero = -104;
  bench.lines.inputs = {true};
  bench.open();
  bench.run(30s);
  ck_assert(!bench.head.busy());
  ck_assert_double_eq_tol(bench.angle() + bench.zero, 0, 0.2);
}
END_TEST

START_TEST(a_switch_that_is_never_pressed_ends_the_search_and_is_said) {
  Bench bench("lines=1,2,3,4 end-stop=9@-100 homing-speed=50");
  bench.zero = 10000;
  bench.lines.inputs = {false};
  bench.open();
  bench.run(30s);
  ck_assert_msg(bench.head.fault().find("did not find its end stop") != std::string::npos, "'%s'",
                bench.head.fault().c_str());
  ck_assert(!bench.lit());
  const int there = bench.motor.half_steps();
  bench.go(10);
  bench.run(5s);
  ck_assert_int_eq(bench.motor.half_steps(), there);  // it does not know where it is
}
END_TEST

START_TEST(an_end_stop_on_the_way_stops_the_axis) {
  Bench bench("lines=1,2,3,4 end-stop=9@-100 homing-speed=20");
  bench.zero = -90;
  bench.lines.inputs = {false};
  bench.open();
  bench.run(20s);
  bench.zero -= 30;  // it was turned by hand: it looks 30 degrees further left than it is taken to
  bench.go(-95);
  bench.run(10s);
  ck_assert(bench.angle() + bench.zero > -100.2);
  ck_assert_double_eq_tol(degrees(bench.last.pan.position), bench.angle() + bench.zero, 0.3);
}
END_TEST

START_TEST(an_axis_that_was_stopped_while_it_homed_moves_only_when_it_is_sent_somewhere) {
  for (const bool released : {false, true}) {
    Bench bench("lines=1,2,3,4 end-stop=9@-100 homing-speed=20");
    bench.zero = -37;
    bench.lines.inputs = {false};
    bench.open();
    bench.run(1s);
    ck_assert(bench.head.busy());
    if (released)
      bench.head.release(bench.lines.now);
    else
      bench.head.stop(bench.lines.now);
    bench.run(300ms);
    ck_assert(!bench.head.busy() && !bench.lit());
    const int there = bench.motor.half_steps();
    bench.move({});  // as the control law does in its dead band, and a fault's end
    bench.head.limit({}, bench.lines.now);
    bench.run(2s);
    ck_assert(!bench.head.busy());
    ck_assert_int_eq(bench.motor.half_steps(), there);
    bench.go(25);
    ck_assert(bench.head.busy());
    bench.run(30s);
    ck_assert_double_eq_tol(bench.angle() + bench.zero, 25, 0.2);
  }
}
END_TEST

START_TEST(a_hard_stop_is_run_against_only_when_asked_for) {
  Bench quiet(kCoils);
  quiet.open();
  quiet.run(5s);
  ck_assert_uint_eq(quiet.lines.edges.size(), 0);
  Bench bench("lines=1,2,3,4 hard-stop=-175 homing-speed=50");
  bench.open();
  bench.run(20s);
  // 1.1 x 340 degrees to the left, wherever it was, and 175 back: the axis slips at the stop, which the bench has not.
  ck_assert_double_eq_tol(bench.angle(), -374 + 175, 0.2);
  ck_assert_double_eq_tol(bench.last.pan.position, 0, 1e-3);
}
END_TEST

START_TEST(a_chip_that_goes_away_is_reported_and_used_again) {
  Bench bench(kCoils);
  bench.open();
  bench.go(90);
  bench.run(1s);
  bench.lines.set_error = ENODEV;
  bench.lines.open_error = "There is no GPIO chip";
  bench.run(10ms);
  ck_assert_msg(bench.head.fault().find("chip0 does not answer any more") != std::string::npos, "'%s'",
                bench.head.fault().c_str());
  bench.go(20);
  bench.run(2s);
  bench.lines.set_error = 0;
  bench.lines.open_error.clear();
  bench.run(1100ms);
  assert_text(bench.head.fault(), "");
  const int there = bench.motor.half_steps();
  bench.run(1s);
  ck_assert_int_eq(bench.motor.half_steps(), there);  // it stands until the next move
}
END_TEST

START_TEST(both_axes_move_at_once) {
  StepperOptions both = options(kCoils, "lines=5,6,7,8 invert");
  Bench bench(both);
  bench.open();
  CoilMotor tilt(4);
  bench.move({Kind::position, radians(30), 1}, {Kind::position, radians(-20), 1});
  bench.run(3s);
  FakeLines replay;
  replay.levels.resize(8);
  for (const LineEdge& edge : bench.lines.edges) {
    replay.levels[edge.line] = edge.level;
    tilt.follow(replay);
  }
  ck_assert_int_eq(bench.motor.half_steps(), 340);  // 30 x 4075.77 / 360 = 339.6
  ck_assert_int_eq(tilt.half_steps(), 226);
}
END_TEST

START_TEST(an_open_contact_switches_off_and_a_closed_one_moves_nothing) {
  FakeLines lines, contact;
  contact.inputs = {false};
  StepperHead head(options(kCoils), std::make_unique<FakePort>(lines));
  EmergencyStop guarded(head, std::make_unique<FakePort>(contact), "17");
  assert_text(guarded.open({}, 0s), "");
  const auto run = [&](Time length) {
    for (const Time end = lines.now + length; lines.now < end;)
      lines.now = std::min(end, guarded.tick(lines.now));
  };
  const auto lit = [&] { return lines.levels[0] || lines.levels[1] || lines.levels[2] || lines.levels[3]; };
  guarded.move({Kind::velocity, 0.5, 0}, {}, lines.now);
  run(500ms);
  ck_assert(lit());
  contact.inputs[0] = true;
  run(6ms);
  ck_assert(!lit());
  ck_assert_msg(guarded.fault().find("emergency stop is pressed") != std::string::npos, "'%s'",
                guarded.fault().c_str());
  guarded.move({Kind::velocity, 0.5, 0}, {}, lines.now);
  guarded.limit({}, lines.now);
  run(500ms);
  ck_assert(!lit());
  contact.inputs[0] = false;
  run(500ms);
  assert_text(guarded.fault(), "");
  ck_assert(!lit());  // until the next move
  guarded.move({Kind::velocity, 0.5, 0}, {}, lines.now);
  run(100ms);
  ck_assert(lit());
  contact.get_error = ENODEV;  // nothing is known of it
  run(6ms);
  ck_assert(!lit());
}
END_TEST

START_TEST(a_contact_whose_chip_was_away_is_read_again) {
  FakeLines lines, contact;
  contact.inputs = {false};
  StepperHead head(options(kCoils), std::make_unique<FakePort>(lines));
  EmergencyStop guarded(head, std::make_unique<FakePort>(contact), "17");
  assert_text(guarded.open({}, 0s), "");
  Time now{};
  const auto run = [&](Time length) {
    for (const Time end = now + length; now < end;) now = std::min(end, guarded.tick(now));
  };
  run(1s);
  contact.open = false;  // reading its line fails from now on
  contact.open_error = "There is no GPIO chip";
  run(3s);
  ck_assert(guarded.emergency());
  ck_assert_msg(guarded.fault().find("cannot be read") != std::string::npos, "'%s'", guarded.fault().c_str());
  contact.open_error.clear();
  run(1060ms);  // tried once a second, and closed for 50 ms
  ck_assert(!guarded.emergency());
  assert_text(guarded.fault(), "");
}
END_TEST

START_TEST(options_that_cannot_be_are_named) {
  StepperAxisOptions axis;
  assert_text(parse_stepper_axis("", axis), "lines= is missing: name four coils, or STEP,DIR or STEP,DIR,EN");
  assert_text(parse_stepper_axis("lines=1,2,3,4 enable-high=1", axis),
              "enable-high=1: enable-high takes no value");
  assert_text(parse_stepper_axis("lines=1", axis), "lines=1: name four coils, or STEP,DIR or STEP,DIR,EN");
  assert_text(parse_stepper_axis("lines=1,,3,4", axis),
              "lines=1,,3,4: name four coils, or STEP,DIR or STEP,DIR,EN");
  assert_text(parse_stepper_axis("lines=1,2", axis),
              "steps= is missing: motor steps for one turn of the camera, microsteps and gears included");
  assert_text(parse_stepper_axis("lines=1,2,3,4 steps=nan", axis),
              "steps=nan: a number of steps, 1 to 1000000");
  assert_text(parse_stepper_axis("lines=1,2,3,4 end-stop=5", axis),
              "end-stop=5: LINE@DEGREES, where the switch is pressed; not 0");
  assert_text(parse_stepper_axis("lines=1,2,3,4 end-stop=5@-90 hard-stop=-95", axis),
              "end-stop and hard-stop exclude each other");
  ck_assert(parse_stepper_axis("lines=1,2,3,4 speed=5", axis).find("\"speed\" is no option") == 0);
  assert_text(parse_stepper_axis("lines=1,2,3,4", axis), "");
  ck_assert_double_eq_tol(axis.steps, 4075.77, 0.005);
  std::optional<Time> delay;
  assert_text(parse_release_delay("never", delay), "");
  ck_assert(!delay);
  assert_text(parse_release_delay("0.25", delay), "");
  ck_assert(delay == Time(250ms));
  ck_assert(!parse_release_delay("-1", delay).empty());
  FakeLines lines;
  StepperHead none(StepperOptions{}, std::make_unique<FakePort>(lines));
  ck_assert(none.open({}, 0s).find("drives no motor") != std::string::npos);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "stepper_head", {ninety_degrees_are_1019_half_steps_in_order_and_then_the_coils_are_off,
                       coils_that_are_never_released_stay_on_after_a_stop_and_go_off_with_the_head,
                       coils_that_are_never_released_go_off_after_a_silence_and_at_the_end_and_not_at_a_stop,
                       the_coils_follow_the_table_of_half_steps,
                       an_inverted_motor_turns_the_other_way,
                       step_and_direction_are_pulsed_with_their_times_and_enabled_only_to_move,
                       a_schedule_that_is_late_is_refused_and_said,
                       a_stop_brakes_within_a_quarter_of_a_second_and_switches_off,
                       the_end_of_the_driver_switches_off,
                       an_end_stop_gives_the_position,
                       a_switch_that_is_pressed_at_the_start_is_left_first,
                       a_switch_that_is_never_pressed_ends_the_search_and_is_said,
                       an_end_stop_on_the_way_stops_the_axis,
                       a_hard_stop_is_run_against_only_when_asked_for,
                       a_chip_that_goes_away_is_reported_and_used_again,
                       both_axes_move_at_once,
                       an_open_contact_switches_off_and_a_closed_one_moves_nothing,
                       a_contact_whose_chip_was_away_is_read_again,
                       an_axis_that_was_stopped_while_it_homed_moves_only_when_it_is_sent_somewhere,
                       options_that_cannot_be_are_named});
}
