// SPDX-License-Identifier: LGPL-2.1-or-later
// The base's turning out of the picture's motion and the head's.
#include "control/base_rate.h"

#include <check.h>

#include <cmath>
#include <limits>

#include "support/suite.h"

using namespace cerberus;
using namespace cerberus::control;
using namespace cerberus::motion;
using sensing::degrees;
using sensing::radians;
using vision::Lens;
using vision::Size;
using vision::Transform;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr Size kSize{320, 240};
const Lens kLens(radians(60), kSize);

PanTilt look(double pan, double tilt = 0) {
  return {radians(pan), radians(tilt)};
}

// Frames of `step` seconds, all the same.
class Frames {
 public:
  explicit Frames(double step = 0.04) : step_(step) {}
  // Degrees a second.
  void run(int count, double base, double head = 0) {
    for (int i = 0; i < count; ++i) {
      now_ += std::chrono::duration_cast<Time>(std::chrono::duration<double>(step_));
      rate_.add(now_, step_, radians(base) * step_, radians(head));
    }
  }
  double rate() const { return degrees(rate_.at(now_)); }
  double rate_after(Time time) const { return degrees(rate_.at(now_ + time)); }
  void reset() { rate_.reset(); }

 private:
  double step_;
  Time now_{};
  BaseRate rate_;
};

}  // namespace

// The picture of a camera that turns to the right goes to the left: tan(8 degrees) F pixels, F = 160 / tan(30 degrees).
START_TEST(a_picture_that_goes_left_is_a_base_that_turns_right) {
  const double shift = std::tan(radians(8)) * 160 / std::tan(radians(30));
  const Turn turn = base_turn(Transform::translation(-shift, 0), kLens, kSize, {}, {});
  // In the middle it is 8 degrees; the mean over the picture is less, as pixels at the border are narrower.
  ck_assert_double_gt(degrees(turn.yaw), 7);
  ck_assert_double_lt(degrees(turn.yaw), 8);
  ck_assert_double_eq_tol(turn.pitch, 0, radians(0.3));
  const Turn down = base_turn(Transform::translation(0, -10), kLens, kSize, {}, {});
  ck_assert_double_lt(down.pitch,
                      radians(-1.5));  // a point that moves up is seen from a camera that turns down
}
END_TEST

// The exact motion of a turning head (Lens::turn has tests of its own) leaves nothing, wherever it looks; that of a
// head that stands on a turning base leaves the base.
START_TEST(a_heads_own_turn_leaves_nothing_and_a_bases_turn_remains) {
  for (const double tilt : {0.0, -20.0, 30.0})
    for (const double head : {0.0, 3.0, -5.0})
      for (const double base : {0.0, 1.0, -4.0}) {
        // The camera turns by both about the same vertical axis.
        const Transform motion =
            kLens.turn(radians(10), radians(tilt), radians(10 + head + base), radians(tilt + 1));
        const Turn turn = base_turn(motion, kLens, kSize, look(10, tilt), look(10 + head, tilt + 1));
        ck_assert_double_eq_tol(degrees(turn.yaw), base, 1e-9);
        ck_assert_double_eq_tol(turn.pitch, 0, 1e-9);
      }
}
END_TEST

// A similarity fits a pan by the mean shift over the picture; taken as an angle in the middle that is 11 % too much for
// 60 degrees: the mean of 1 + (x / F)^2.
START_TEST(a_mean_shift_is_taken_as_the_mean_angle) {
  const double pan = radians(3);
  const Transform exact = kLens.turn(0, 0, pan, 0);
  double shift = 0;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      shift += exact.apply({static_cast<double>(x), static_cast<double>(y)}).x - x;
  shift /= kSize.area();
  ck_assert_double_gt(-shift, 1.1 * std::tan(pan) * kLens.focal_length());
  const Turn turn = base_turn(Transform::translation(shift, 0), kLens, kSize, {}, {});
  ck_assert_double_eq_tol(turn.yaw, pan, 0.02 * pan);
}
END_TEST

START_TEST(an_unknown_lens_or_pose_gives_no_turn) {
  ck_assert(std::isnan(base_turn({}, {}, kSize, {}, {}).yaw));
  ck_assert(std::isnan(base_turn({}, kLens, kSize, {kNan, 0}, {}).yaw));
}
END_TEST

START_TEST(a_steady_turn_is_known_after_three_frames) {
  for (const double step : {0.01, 1 / 30.0, 0.2}) {
    Frames frames(step);
    frames.run(2, 20);
    ck_assert(std::isnan(frames.rate()));
    frames.run(1, 20);
    ck_assert_double_eq_tol(frames.rate(), 20, 1e-6);
    frames.run(200, -45);
    ck_assert_double_eq_tol(frames.rate(), -45, 1e-6);
  }
}
END_TEST

START_TEST(a_frame_measured_wrongly_and_a_shaking_camera_are_no_turn) {
  Frames frames;
  frames.run(20, 0);
  frames.run(1, 300);
  ck_assert_double_eq_tol(frames.rate(), 0, 1e-9);
  for (int i = 0; i < 40; ++i) {
    frames.run(1, i % 2 ? 20 : -20);  // four fifths of a degree there and back
    if (i > 8) ck_assert_double_lt(std::abs(frames.rate()), 5);
  }
}
END_TEST

// By hand: of eight the lowest and the highest two are left out, and 0, 4, 8 and 8 have the mean 5 (their median is 6).
START_TEST(the_rate_is_the_mean_of_the_middle_half) {
  Frames frames(0.03);
  for (const double rate : {8.0, 0.0, 90.0, 4.0, 0.0, 8.0, -50.0, 8.0}) frames.run(1, rate);
  ck_assert_double_eq_tol(frames.rate(), 5, 1e-9);
}
END_TEST

START_TEST(time_that_does_not_go_on_begins_anew) {
  for (const auto later : {0, -40}) {
    BaseRate rate;
    Time now{};
    for (int k = 0; k < 5; ++k) rate.add(now += std::chrono::milliseconds(40), 0.04, radians(1), 0);
    ck_assert(!std::isnan(rate.at(now)));
    now += std::chrono::milliseconds(later);
    rate.add(now, 0.04, radians(1), 0);
    ck_assert(std::isnan(rate.at(now)));
  }
}
END_TEST

START_TEST(while_a_head_starts_or_brakes_nothing_new_is_believed) {
  Frames frames;
  frames.run(10, 0);
  // A head that is three frames late, 90 degrees a second: the picture stands although the head was commanded to turn.
  frames.run(3, -90, 90);
  frames.run(10, 0, 90);
  ck_assert_double_eq_tol(frames.rate(), 0, 1e-9);
  frames.run(3, 90, 0);
  ck_assert_double_eq_tol(frames.rate(), 0, 1e-9);
  // A steady head hides nothing.
  frames.run(20, 15, 0);
  ck_assert_double_eq_tol(frames.rate(), 15, 1e-9);
}
END_TEST

START_TEST(what_was_seen_grows_stale_and_is_forgotten) {
  Frames frames;
  frames.run(10, 20);
  ck_assert_double_eq_tol(frames.rate_after(std::chrono::milliseconds(400)), 20, 1e-9);
  ck_assert(std::isnan(frames.rate_after(std::chrono::seconds(1))));
  frames.run(30, kNan);
  ck_assert(std::isnan(frames.rate()));
  frames.run(10, 7);
  ck_assert_double_eq_tol(frames.rate(), 7, 1e-9);
  frames.reset();
  ck_assert(std::isnan(frames.rate()));
  frames.run(0, 0);
  BaseRate rate;
  for (int i = 0; i < 5; ++i) rate.add(Time(1), 0, 1, 0);  // frames without a distance
  ck_assert(std::isnan(rate.at(Time(1))));
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "base_rate",
      {a_picture_that_goes_left_is_a_base_that_turns_right,
       a_heads_own_turn_leaves_nothing_and_a_bases_turn_remains, a_mean_shift_is_taken_as_the_mean_angle,
       an_unknown_lens_or_pose_gives_no_turn, a_steady_turn_is_known_after_three_frames,
       a_frame_measured_wrongly_and_a_shaking_camera_are_no_turn, the_rate_is_the_mean_of_the_middle_half,
       time_that_does_not_go_on_begins_anew, while_a_head_starts_or_brakes_nothing_new_is_believed,
       what_was_seen_grows_stale_and_is_forgotten});
}
