// SPDX-License-Identifier: LGPL-2.1-or-later
// The law with a lens of 90 degrees over 640x480: f = 320 pixels, so 320 px right of the middle are 45 degrees.
#include "control/law.h"

#include <check.h>

#include <cmath>
#include <limits>

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::control;
using namespace cerberus::motion;
using namespace std::chrono_literals;
using cerberus::fusion::Action;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
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

Goal person(double x, double y = 240, std::uint32_t track = 1) {
  return {Action::track, cerberus::vision::Point{x, y}, {0, 0}, track};
}
// A frame that was taken at `time`, seconds; its command takes effect 100 ms later.
Moment moment(const Pose& capture, const Pose& ahead, double time = 0) {
  return {capture, ahead, {time, time + .1}, {}};
}
Moment moment(const Pose& both, double time = 0) {
  return moment(both, both, time);
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

// Speed with which a head at rest sets out for a target: 40 ms of its acceleration.
constexpr double kSetsOut = 24;

bool holds(const AxisCommand& command) {
  return command.kind == Kind::hold;
}

}  // namespace

START_TEST(a_pixel_is_an_angle_from_where_the_head_looked_when_the_frame_was_taken) {
  Law law;
  // Taken at 10 degrees, seen 45 to the right: 55. By the time of the command the head is at 30.
  const Command command = law.update(person(640), kLens, moment(looking(10), looking(30)));
  assert_goes(command.pan, 55, kSetsOut);
  ck_assert_int_eq(static_cast<int>(command.state), static_cast<int>(State::tracking));
  ck_assert(!command.limited);
}
END_TEST

START_TEST(tilt_follows_as_well) {
  Law law;
  const Command command = law.update(person(320, 240 - 320 * std::tan(radians(20))), kLens,
                                     moment(looking(0, 5), looking(0, 15)));
  assert_goes(command.tilt, 25, kSetsOut);
  ck_assert(holds(command.pan));
}
END_TEST

START_TEST(a_turn_of_the_base_is_taken_off_pan_and_not_off_tilt) {
  Law law;
  // The person stands in the world, 20 degrees to the right and up; the base turns to the right at 20 degrees a second.
  const auto frame = [&](double t) {
    Moment now = moment(looking(0), t);
    now.base = {radians(20 * t), radians(20 * (t + .1)), radians(20)};
    const double off = 20 - 20 * t;
    const double down = 320 * std::tan(radians(20)) / std::cos(radians(off));
    return law.update(person(pixel(off), 240 - down), kLens, now);
  };
  frame(0);
  const Command command = frame(.04);
  // At the time of effect 20 - 20 x .14 = 17.2, and .3 s further on.
  ck_assert_double_eq_tol(degrees(command.pan.value), 17.2 - 20 * .3, 1e-6);
  ck_assert_double_eq_tol(degrees(command.tilt.value), 20, 1e-6);
}
END_TEST

START_TEST(another_person_begins_anew) {
  for (const bool other : {false, true}) {
    Law law;
    for (int k = 0; k < 50; ++k)
      law.update(person(pixel(-20 + 20 * k * .04)), kLens, moment(looking(0), k * .04));
    // As near as boxes may be wrong: the same person goes on, another one stands and is centred.
    const Command command =
        law.update(person(pixel(20.5), 240, other ? 2 : 1), kLens, moment(looking(19), 50 * .04));
    if (other)
      ck_assert_double_eq_tol(degrees(command.pan.value), 19 + 20.5, 1e-6);
    else
      ck_assert_double_gt(degrees(command.pan.value), 22);
  }
}
END_TEST

START_TEST(the_dial_reaches_both_axes) {
  double pan[3] = {}, tilt[3] = {};
  for (const Response response : {Response::calm, Response::normal, Response::fast}) {
    Law law;
    LawOptions options;
    options.response = response;
    law.set_options(options);
    const Command command =
        law.update(person(pixel(2), 240 - 320 * std::tan(radians(2))), kLens, moment(looking(0)));
    pan[static_cast<int>(response)] = command.pan.speed;
    tilt[static_cast<int>(response)] = command.tilt.speed;
  }
  ck_assert(pan[0] < pan[1] && pan[1] < pan[2]);
  ck_assert(tilt[0] < tilt[1] && tilt[1] < tilt[2]);
}
END_TEST

START_TEST(turning_goes_at_full_speed_until_the_stop) {
  Law law;
  const Command right = law.update({Action::turn_right, {}, {}}, kLens, moment(looking(0)));
  ck_assert_int_eq(static_cast<int>(right.pan.kind), static_cast<int>(Kind::velocity));
  ck_assert_double_eq_tol(degrees(right.pan.value), 90, 1e-9);
  ck_assert(holds(right.tilt));
  const Command left = law.update({Action::turn_left, {}, {}}, kLens, moment(looking(0)));
  ck_assert_double_eq_tol(degrees(left.pan.value), -90, 1e-9);
  ck_assert(!left.limited);
  ck_assert(law.update({Action::turn_left, {}, {}}, kLens, moment(looking(-170))).limited);
  ck_assert(!law.update({Action::turn_right, {}, {}}, kLens, moment(looking(-170))).limited);
}
END_TEST

START_TEST(a_search_goes_from_edge_to_edge_the_nearer_one_first) {
  Law law;
  const Goal goal{Action::search, {}, {radians(-30), radians(90)}};
  assert_goes(law.update(goal, kLens, moment(looking(0))).pan, -30, 40);
  assert_goes(law.update(goal, kLens, moment(looking(-20))).pan, -30, 40);
  assert_goes(law.update(goal, kLens, moment(looking(-30))).pan, 90, 40);
  assert_goes(law.update(goal, kLens, moment(looking(0))).pan, 90, 40);
  assert_goes(law.update(goal, kLens, moment(looking(90))).pan, -30, 40);
  // From outside: past the near edge to the far one, without a halt, and fast as far as that edge.
  law.reset();
  assert_goes(law.update(goal, kLens, moment(looking(150))).pan, -30, 90);
  assert_goes(law.update(goal, kLens, moment(looking(89))).pan, -30, 40);
  law.reset();
  assert_goes(law.update(goal, kLens, moment(looking(-150))).pan, 90, 90);
}
END_TEST

START_TEST(a_search_begins_where_the_target_left) {
  for (const double way : {-1., 1.}) {
    Law law;
    for (int k = 0; k < 25; ++k)
      law.update(person(pixel(way * (20 + k))), kLens, moment(looking(0), k * .04));
    // The nearer edge is on the other side.
    const double edge = way * 60, near = way * -20;
    const Goal goal{Action::search, {}, {radians(std::min(edge, near)), radians(std::max(edge, near))}};
    assert_goes(law.update(goal, kLens, moment(looking(0), 1)).pan, edge, 40);
    assert_goes(law.update(goal, kLens, moment(looking(edge), 2)).pan, near, 40);
    // Once: a later search knows nothing of it.
    law.update({}, kLens, moment(looking(0), 3));
    assert_goes(law.update(goal, kLens, moment(looking(0), 4)).pan, near, 40);
  }
}
END_TEST

START_TEST(no_search_begins_where_a_target_left_long_ago) {
  for (const double later : {1., 10.}) {
    Law law;
    for (int k = 0; k < 25; ++k) law.update(person(pixel(20 + k)), kLens, moment(looking(0), k * .04));
    const Goal goal{Action::search, {}, {radians(-20), radians(60)}};
    assert_goes(law.update(goal, kLens, moment(looking(0), 1 + later)).pan, later < 8 ? 60 : -20, 40);
  }
}
END_TEST

START_TEST(a_search_stays_within_the_stops) {
  Law law;
  const Command command =
      law.update({Action::search, {}, {radians(150), radians(250)}}, kLens, moment(looking(169)));
  assert_goes(command.pan, 170, 40);
  ck_assert(command.limited);
  ck_assert(holds(law.update({Action::search, {}, {kNan, 1}}, kLens, moment(looking(0))).pan));
}
END_TEST

START_TEST(zero_returns_both_axes_and_hold_holds_them) {
  Law law;
  const Command zero = law.update({Action::zero, {}, {}}, kLens, moment(looking(90, 10)));
  assert_goes(zero.pan, 0, 40);
  assert_goes(zero.tilt, 0, 40);
  const Command hold = law.update({Action::hold, {}, {}}, kLens, moment(looking(90, 10)));
  ck_assert(holds(hold.pan) && holds(hold.tilt));
  ck_assert_int_eq(static_cast<int>(hold.state), static_cast<int>(State::holding));
}
END_TEST

START_TEST(tracking_without_a_target_or_a_lens_is_holding) {
  Law law;
  ck_assert(holds(law.update({Action::track, {}, {}}, kLens, moment(looking(0))).pan));
  ck_assert(holds(law.update(person(640), Lens(), moment(looking(0))).pan));
  ck_assert(holds(law.update(person(kNan), kLens, moment(looking(0))).pan));
  ck_assert(holds(law.update(person(640), kLens, moment(looking(kNan), looking(0))).pan));
  ck_assert(holds(law.update(person(640), kLens, moment(looking(0), looking(kNan))).pan));
}
END_TEST

// At the stop of 170 degrees: a target at 185 is watched from here; one at 200 is out of what counts as in the picture of an
// unknown lens, 20 degrees, and the place -160 would do, the long way round.
START_TEST(a_target_beyond_the_stop_is_watched_from_it_until_it_leaves_the_picture) {
  Law law;
  const Command near = law.update(person(pixel(15)), kLens, moment(looking(170), looking(160)));
  assert_goes(near.pan, 170, kSetsOut);
  ck_assert(near.limited);
  law.reset();
  const Command far = law.update(person(pixel(30)), kLens, moment(looking(170)));
  assert_goes(far.pan, -160, 90);
  ck_assert(!far.limited && far.round && far.state == State::turning);
}
END_TEST

START_TEST(a_search_after_the_way_round_begins_where_the_target_left) {
  Law law;
  ck_assert(law.update(person(pixel(30)), kLens, moment(looking(170))).round);
  const Goal goal{Action::search, {}, {radians(-60), radians(60)}};
  double time = 0;
  while (law.update(goal, kLens, moment(looking(-20), time)).round) time += .1;
  ck_assert_double_gt(time, 3);
  assert_goes(law.update(goal, kLens, moment(looking(-20), time)).pan, 60, 40);
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
  for (int k = 0; k < 100; ++k) law.update(person(k), kLens, moment(looking(k), .04 * k));
  ck_assert_uint_eq(cerberus::tests::allocations(), before);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "law", {a_pixel_is_an_angle_from_where_the_head_looked_when_the_frame_was_taken, tilt_follows_as_well,
              a_turn_of_the_base_is_taken_off_pan_and_not_off_tilt, another_person_begins_anew,
              the_dial_reaches_both_axes, turning_goes_at_full_speed_until_the_stop,
              a_search_goes_from_edge_to_edge_the_nearer_one_first, a_search_begins_where_the_target_left,
              no_search_begins_where_a_target_left_long_ago, a_search_stays_within_the_stops,
              zero_returns_both_axes_and_hold_holds_them, tracking_without_a_target_or_a_lens_is_holding,
              a_target_beyond_the_stop_is_watched_from_it_until_it_leaves_the_picture,
              a_search_after_the_way_round_begins_where_the_target_left, absurd_options_are_replaced,
              steady_state_allocates_nothing});
}
