// SPDX-License-Identifier: LGPL-2.1-or-later
// Where the head looks while the robot's own motion makes sensors blind.
#include <array>
#include <cmath>
#include <random>
#include <utility>

#include "fuser_stream.h"

using namespace stream;

namespace {

// A robot that has stood without any detection, and then drives on.
struct Drive : Stream {
  explicit Drive(const FuserOptions& options = {}) : Stream(options) {
    frames(6s);
    speed = 1;
    frame();
  }
  // With a head that executes the decisions. Returns how often it left rest.
  int watch(Time duration) {
    int looks = 0;
    bool rests = true;
    for (const Time end = now + duration; now < end;) {
      const Decision& decision = frame();
      const bool rested = std::exchange(rests, decision.action == Action::zero);
      if (rested && !rests) ++looks;
      obey(decision);
    }
    return looks;
  }
};

}  // namespace

START_TEST(the_camera_looks_where_a_sensor_is_blind) {
  Drive drive;
  drive.sensors = {0, 0, 1};
  const Decision& decision = drive.frame();
  ck_assert_int_eq(decision.fired, 0);
  ck_assert_int_eq(decision.doubtful, 0b100);
  assert_says(decision, Action::turn_right, 0, "doubt");
  assert_sector(decision, 60, 170);
  drive.pan = 63;
  drive.frame();
  assert_says(decision, Action::search, 0, "doubt");
  assert_sector(decision, 90, 150);
}
END_TEST

START_TEST(what_was_just_seen_is_left_alone_for_a_while) {
  Drive drive;
  drive.sensors = {1, 0, 0};
  // The lens sees half of this sector with a head at rest: the other half comes in half of the time.
  assert_says(drive.frame(), Action::zero, 7, "zero");
  drive.sensors = {0, 0, 1};
  ck_assert_int_eq(drive.watch(1s), 1);
  const Decision& decision = drive.frame();
  assert_says(decision, Action::turn_right, 0, "doubt");
  // A look begins at a mean age of 4 s: at most 15 a minute.
  const int looks = drive.watch(60s);
  ck_assert_int_ge(looks, 5);
  ck_assert_int_le(looks, 15);
}
END_TEST

START_TEST(a_sensor_that_rests_ends_the_look) {
  Drive drive;
  drive.sensors = {0, 0, 1};
  const Decision& decision = drive.frame();
  assert_says(decision, Action::turn_right, 0, "doubt");
  drive.sensors = {0, 0, 0};
  drive.frame();
  assert_says(decision, Action::zero, 7, "zero");
  drive.sensors = {0, 1, 0};
  drive.frame();
  assert_says(decision, Action::turn_left, 0, "doubt");
}
END_TEST

START_TEST(a_sensor_that_counts_goes_before_one_that_is_blind) {
  Stream stream;
  stream.frames(6s);
  stream.sensors = {0, 1, 0};
  const Decision& decision = stream.frame();
  assert_says(decision, Action::turn_left, 0, "sector");
  stream.speed = 1;
  stream.frame();
  stream.sensors = {0, 1, 1};
  stream.frame();
  ck_assert_int_eq(decision.doubtful, 0b100);
  assert_says(decision, Action::turn_left, 0, "sector");
  stream.sensors = {0, 0, 1};  // the search goes on for a while
  stream.frames(4s);
  assert_says(decision, Action::turn_left, 0, "return");
  stream.frames(2s);
  assert_says(decision, Action::turn_right, 0, "doubt");
}
END_TEST

START_TEST(a_person_who_was_lost_is_waited_for_first) {
  Drive drive;
  drive.tracks = {person(3)};
  drive.sensors = {0, 0, 1};
  const Decision& decision = drive.frame();
  assert_says(decision, Action::track, 1, "camera");
  drive.tracks.clear();
  drive.frames(4s);
  assert_says(decision, Action::hold, 0, "return");
  drive.frames(2s);
  assert_says(decision, Action::turn_right, 0, "doubt");
}
END_TEST

START_TEST(a_table_of_rules_stays_as_it_is_written) {
  Drive drive(paper_options());
  drive.sensors = {0, 0, 1};
  assert_says(drive.frame(), Action::zero, 7, "rule 7");
}
END_TEST

START_TEST(without_a_pan_angle_nothing_is_looked_at) {
  Drive drive;
  drive.pan = kUnknown;
  drive.sensors = {0, 0, 1};
  assert_says(drive.frame(), Action::zero, 7, "zero");
}
END_TEST

START_TEST(other_limits_end_the_look) {
  Drive drive;
  drive.sensors = {0, 0, 1};
  const Decision& decision = drive.frame();
  assert_sector(decision, 60, 170);
  FuserOptions options;
  options.limits = {radians(-90), radians(90)};
  drive.fuser.set_options(options);
  drive.frame();
  assert_says(decision, Action::turn_right, 0, "doubt");
  assert_sector(decision, 60, 90);
  Geometry geometry;
  ck_assert(geometry.set(std::array{0.0, radians(-120), radians(60)}, radians(60)));
  drive.fuser.set_geometry(geometry);
  drive.frame();
  assert_sector(decision, 30, 90);
}
END_TEST

// Each direction of the world comes into the picture again and again while a robot turns to and fro, whose sensors are
// all blind.
START_TEST(a_robot_that_turns_to_and_fro_leaves_no_direction_unseen) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937 random(seed);
    Stream stream;
    std::array<Time, 36> seen{};
    Time worst{}, until{};
    double yaw = 0, rate = 0, last = -40;
    while (stream.now < 300s) {
      if (stream.now >= until) {
        rate = rate == 0 ? last = -last : 0;
        until = stream.now + (rate == 0 ? std::chrono::milliseconds(1000 + random() % 2000) : 2250ms);
      }
      stream.yaw_rate = rate;
      yaw += rate * .04;
      const std::uint8_t blind = stream.now > 7s;
      stream.sensors = {blind, blind, blind};
      stream.obey(stream.frame());
      for (unsigned cell = 0; cell < seen.size(); ++cell) {
        if (std::abs(std::remainder(10. * cell + 5 - yaw - stream.pan, 360)) < 30) seen[cell] = stream.now;
        if (stream.now > 20s) worst = std::max(worst, stream.now - seen[cell]);
      }
    }
    // Two minutes: a head that ignores what it missed never sees some. Seldom it is more than one.
    if (worst > 120s) ck_abort_msg("seed %u: %ld s", seed, static_cast<long>(worst / 1s));
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "doubt_search", {the_camera_looks_where_a_sensor_is_blind, what_was_just_seen_is_left_alone_for_a_while,
                       a_sensor_that_rests_ends_the_look, a_sensor_that_counts_goes_before_one_that_is_blind,
                       a_person_who_was_lost_is_waited_for_first, a_table_of_rules_stays_as_it_is_written,
                       without_a_pan_angle_nothing_is_looked_at, other_limits_end_the_look,
                       a_robot_that_turns_to_and_fro_leaves_no_direction_unseen});
}
