// SPDX-License-Identifier: LGPL-2.1-or-later
// The law with a lens of 90 degrees over 640x480: f = 320 pixels, so 320 px right of the middle are 45 degrees.
#include "control/law.h"

#include <check.h>

#include <cmath>
#include <limits>
#include <random>

#include "drivers/simulated/simulated_head.h"
#include "support/allocations.h"
#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::control;
using namespace cerberus::motion;
using namespace std::chrono_literals;
using cerberus::fusion::Action;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;
using cerberus::vision::Lens;
using Kind = AxisCommand::Kind;

namespace {

const Lens kLens(radians(90), {640, 480});
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Pose looking(double pan, double tilt = 0) {
  Pose pose;
  pose.pan.position = radians(pan);
  pose.tilt.position = radians(tilt);
  return pose;
}

Goal person(double x, double y = 240) {
  return {Action::track, cerberus::vision::Point{x, y}, {0, 0}};
}
// Pixels right of the middle for an angle to the right.
double pixel(double angle) {
  return 320 + 320 * std::tan(radians(angle));
}

void assert_goes(const AxisCommand& command, double position, double speed) {
  ck_assert_int_eq(static_cast<int>(command.kind), static_cast<int>(Kind::position));
  ck_assert_double_eq_tol(degrees(command.value), position, 1e-9);
  ck_assert_double_eq_tol(degrees(command.speed), speed, 1e-9);
}

bool holds(const AxisCommand& command) {
  return command.kind == Kind::hold;
}

}  // namespace

START_TEST(a_pixel_is_an_angle_from_where_the_head_looked_when_the_frame_was_taken) {
  Law law;
  // Taken at 10 degrees, seen 45 to the right: 55. By the time of the command the head is at 30: 25 to go at gain 4.
  const Command command = law.update(person(640), kLens, looking(10), looking(30));
  assert_goes(command.pan, 55, 4 * 25);
  ck_assert_int_eq(static_cast<int>(command.state), static_cast<int>(State::tracking));
  ck_assert(!command.limited);
}
END_TEST

START_TEST(tilt_follows_as_well) {
  Law law;
  const Command command =
      law.update(person(320, 240 - 320 * std::tan(radians(20))), kLens, looking(0, 5), looking(0, 15));
  assert_goes(command.tilt, 25, 4 * 10);
  ck_assert(holds(command.pan));
}
END_TEST

// Rest begins below 0.7 degrees and ends above 3.
START_TEST(the_dead_band_has_two_thresholds) {
  Law law;
  ck_assert(!holds(law.update(person(pixel(0.8)), kLens, looking(0), looking(0)).pan));  // a new target
  ck_assert(holds(law.update(person(pixel(0.6)), kLens, looking(0), looking(0)).pan));
  ck_assert(holds(law.update(person(pixel(0.8)), kLens, looking(0), looking(0)).pan));
  ck_assert(holds(law.update(person(pixel(-2.9)), kLens, looking(0), looking(0)).pan));
  ck_assert(!holds(law.update(person(pixel(3.1)), kLens, looking(0), looking(0)).pan));
  ck_assert(!holds(law.update(person(pixel(0.8)), kLens, looking(0), looking(0)).pan));
  ck_assert(holds(law.update(person(pixel(0.6)), kLens, looking(0), looking(0)).pan));
}
END_TEST

// A standing person, boxes with a noise of 1 degree, 33 frames a second, a minute: a plain band of 0.5 degrees
// reverses hundreds of times, this one hardly ever.
START_TEST(a_head_before_a_standing_person_rests) {
  for (const bool plain : {false, true}) {
    LawOptions options;
    if (plain) options.dead_band_start = options.dead_band_stop = radians(0.5);
    Law law;
    law.set_options(options);
    cerberus::drivers::SimulatedHead head;
    cerberus::drivers::HeadSetup setup;
    setup.latency = 60ms;
    assert_text(head.open(setup), "");
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 1);
    int reversals = 0;
    double direction = 0;
    for (int k = 0; k < 33 * 60; ++k) {
      const Time now = k * 30ms;
      Pose capture, ahead;
      head.state(now, capture);
      head.state(now + setup.latency, ahead);
      const double off = 20 - degrees(capture.pan.position) + noise(random);
      const Command command = law.update(person(pixel(off)), kLens, capture, ahead);
      assert_text(head.command({now, command.pan, command.tilt}), "");
      if (k > 33 && capture.pan.speed * direction < 0) ++reversals;
      if (capture.pan.speed != 0) direction = capture.pan.speed;
    }
    Pose end;
    head.state(61s, end);
    ck_assert_double_eq_tol(degrees(end.pan.position), 20, 3);
    if (plain)
      ck_assert_int_gt(reversals, 100);
    else
      ck_assert_int_le(reversals, 10);
  }
}
END_TEST

START_TEST(turning_goes_at_turn_speed_until_the_stop) {
  Law law;
  const Command right = law.update({Action::turn_right, {}, {}}, kLens, looking(0), looking(0));
  ck_assert_int_eq(static_cast<int>(right.pan.kind), static_cast<int>(Kind::velocity));
  ck_assert_double_eq_tol(degrees(right.pan.value), 40, 1e-9);
  ck_assert(holds(right.tilt));
  const Command left = law.update({Action::turn_left, {}, {}}, kLens, looking(0), looking(0));
  ck_assert_double_eq_tol(degrees(left.pan.value), -40, 1e-9);
  ck_assert(!left.limited);
  ck_assert(law.update({Action::turn_left, {}, {}}, kLens, looking(-170), looking(-170)).limited);
  ck_assert(!law.update({Action::turn_right, {}, {}}, kLens, looking(-170), looking(-170)).limited);
}
END_TEST

START_TEST(a_search_goes_from_edge_to_edge_the_nearer_one_first) {
  Law law;
  const Goal goal{Action::search, {}, {radians(-30), radians(90)}};
  assert_goes(law.update(goal, kLens, looking(0), looking(0)).pan, -30, 40);
  assert_goes(law.update(goal, kLens, looking(-20), looking(-20)).pan, -30, 40);
  assert_goes(law.update(goal, kLens, looking(-30), looking(-30)).pan, 90, 40);
  assert_goes(law.update(goal, kLens, looking(0), looking(0)).pan, 90, 40);
  assert_goes(law.update(goal, kLens, looking(90), looking(90)).pan, -30, 40);
  // From outside: past the near edge to the far one, without a halt.
  law.reset();
  assert_goes(law.update(goal, kLens, looking(150), looking(150)).pan, -30, 40);
  law.reset();
  assert_goes(law.update(goal, kLens, looking(-150), looking(-150)).pan, 90, 40);
}
END_TEST

START_TEST(a_search_stays_within_the_stops) {
  Law law;
  const Command command =
      law.update({Action::search, {}, {radians(150), radians(250)}}, kLens, looking(169), looking(169));
  assert_goes(command.pan, 170, 40);
  ck_assert(command.limited);
  ck_assert(holds(law.update({Action::search, {}, {kNan, 1}}, kLens, looking(0), looking(0)).pan));
}
END_TEST

START_TEST(zero_returns_both_axes_and_hold_holds_them) {
  Law law;
  const Command zero = law.update({Action::zero, {}, {}}, kLens, looking(90, 10), looking(90, 10));
  assert_goes(zero.pan, 0, 40);
  assert_goes(zero.tilt, 0, 40);
  const Command hold = law.update({Action::hold, {}, {}}, kLens, looking(90, 10), looking(90, 10));
  ck_assert(holds(hold.pan) && holds(hold.tilt));
  ck_assert_int_eq(static_cast<int>(hold.state), static_cast<int>(State::holding));
}
END_TEST

START_TEST(tracking_without_a_target_or_a_lens_is_holding) {
  Law law;
  ck_assert(holds(law.update({Action::track, {}, {}}, kLens, looking(0), looking(0)).pan));
  ck_assert(holds(law.update(person(640), Lens(), looking(0), looking(0)).pan));
  ck_assert(holds(law.update(person(kNan), kLens, looking(0), looking(0)).pan));
  ck_assert(holds(law.update(person(640), kLens, looking(kNan), looking(0)).pan));
  ck_assert(holds(law.update(person(640), kLens, looking(0), looking(kNan)).pan));
}
END_TEST

// At the stop of 170 degrees: a target at 185 cannot be centred from either side and is watched from here; at 200 the
// place -160 would do, the long way round.
START_TEST(a_target_beyond_the_stop_is_watched_from_it_until_turning_round_reaches_it) {
  Law law;
  const Command near = law.update(person(pixel(15)), kLens, looking(170), looking(160));
  assert_goes(near.pan, 170, 4 * 10);
  ck_assert(near.limited);
  const Command far = law.update(person(pixel(30)), kLens, looking(170), looking(170));
  assert_goes(far.pan, -160, 4 * 330);
  ck_assert(!far.limited);
}
END_TEST

START_TEST(absurd_options_are_replaced) {
  Law law;
  LawOptions options;
  options.gain = kNan;
  options.turn_speed = -5;
  options.dead_band_start = 0;
  options.dead_band_stop = kNan;
  law.set_options(options);
  ck_assert_double_eq(law.options().gain, LawOptions{}.gain);
  ck_assert_double_eq(law.options().turn_speed, LawOptions{}.turn_speed);
  ck_assert_double_ge(law.options().dead_band_start, law.options().dead_band_stop);
}
END_TEST

START_TEST(steady_state_allocates_nothing) {
  Law law;
  const std::size_t before = cerberus::tests::allocations();
  for (int k = 0; k < 100; ++k) law.update(person(k), kLens, looking(k), looking(k));
  ck_assert_uint_eq(cerberus::tests::allocations(), before);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "law", {a_pixel_is_an_angle_from_where_the_head_looked_when_the_frame_was_taken, tilt_follows_as_well,
              the_dead_band_has_two_thresholds, a_head_before_a_standing_person_rests,
              turning_goes_at_turn_speed_until_the_stop, a_search_goes_from_edge_to_edge_the_nearer_one_first,
              a_search_stays_within_the_stops, zero_returns_both_axes_and_hold_holds_them,
              tracking_without_a_target_or_a_lens_is_holding,
              a_target_beyond_the_stop_is_watched_from_it_until_turning_round_reaches_it,
              absurd_options_are_replaced, steady_state_allocates_nothing});
}
