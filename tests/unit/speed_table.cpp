// SPDX-License-Identifier: LGPL-2.1-or-later
// What is learnt of a head whose speeds are not those that were commanded: degrees a second, frames of 40 ms.
#include "control/following/speed_table.h"

#include <check.h>

#include <cmath>
#include <functional>
#include <random>

#include "support/suite.h"

using cerberus::control::SpeedTable;
using cerberus::motion::SpeedMap;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;

namespace {

constexpr double kFastest = 60, kStep = .04;

using Speed = std::function<double(double)>;  // what the head makes of a command

Speed power(double scale, double exponent) {
  return [=](double commanded) {
    return std::copysign(scale * kFastest * std::pow(std::abs(commanded) / kFastest, exponent), commanded);
  };
}

struct Head {
  Speed real = power(1, 1);
  SpeedMap known;
  double noise = .03;  // degrees a frame
  SpeedTable table;
  int changes = 0;

  // Commands between these speeds, half a second each, in both directions; a driver that is given each new map.
  Head& turn(double seconds, double slowest = 4, double fastest = 50, unsigned seed = 1) {
    table.reset(known, radians(kFastest));
    std::mt19937 random(seed);
    std::normal_distribution<double> gauss(0, noise);
    std::uniform_real_distribution<double> between(std::log(slowest), std::log(fastest));
    SpeedMap driver = known;
    double commanded = 0;
    for (int k = 0; k * kStep < seconds; ++k) {
      if (k % 12 == 0) commanded = std::exp(between(random)) * (k % 24 == 0 ? 1 : -1);
      const double seen = real(commanded) + gauss(random) / kStep;
      table.add(kStep, driver.actual(radians(commanded)), radians(seen));
      if (!table.changed()) continue;
      driver = table.map();
      ++changes;
    }
    return *this;
  }
  double learnt(double commanded) const { return degrees(table.map().actual(radians(commanded))); }
};

}  // namespace

START_TEST(scale_and_bend_of_a_table_are_found_in_seconds) {
  for (const double scale : {.75, 1., 1.25})
    for (const double exponent : {.8, 1., 1.4}) {
      Head head;
      head.real = power(scale, exponent);
      head.turn(15);
      for (const double commanded : {5., 12., 30., 55.})
        ck_assert_msg(std::abs(std::log(head.learnt(commanded) / head.real(commanded))) < .1,
                      "%g, %g: %g instead of %g", scale, exponent, head.learnt(commanded),
                      head.real(commanded));
    }
}
END_TEST

START_TEST(a_calibration_is_kept_as_long_as_it_is_right) {
  Head head;
  head.real = power(.8, 1.3);
  std::vector<cerberus::motion::SpeedPoint> points;
  for (int k = 1; k <= 12; ++k) points.push_back({radians(5 * k), radians(head.real(5 * k))});
  head.known = SpeedMap(points);
  head.turn(30);
  for (const double commanded : {10., 30., 55.})
    ck_assert_double_eq_tol(head.learnt(commanded) / head.real(commanded), 1, .1);
}
END_TEST

START_TEST(the_driver_is_not_bothered_by_noise) {
  Head head;
  head.turn(60);
  ck_assert_int_le(head.changes, 12);  // one in five seconds
}
END_TEST

// By a lens that sees less than is told, every turn seems to be slower than it is.
START_TEST(a_wrong_lens_makes_no_head_much_faster_than_its_limit) {
  Head head;
  head.real = power(.2, 1);
  head.noise = .01;
  head.turn(600, 20, 50);
  ck_assert_double_lt(head.learnt(kFastest), .6 * kFastest);
  ck_assert_double_gt(head.learnt(kFastest), .35 * kFastest);
}
END_TEST

START_TEST(speeds_that_the_picture_does_not_show_teach_nothing) {
  Head slow;  // less than the noise of a frame
  slow.turn(60, .1, 1.5);
  ck_assert_int_eq(slow.changes, 0);
  Head stuck;
  stuck.real = [](double) { return 0; };
  stuck.turn(60);
  for (const double commanded : {5., 30.}) ck_assert_double_gt(stuck.learnt(commanded), commanded / 3);
  Head reversed;
  reversed.real = power(-1, 1);
  reversed.turn(60, 10, 50);
  ck_assert_int_eq(reversed.changes, 0);
}
END_TEST

START_TEST(absurd_frames_are_left_out) {
  SpeedTable table;
  table.add(kStep, 1, 1);  // nothing is known of the axis
  ck_assert(!table.changed());
  table.reset({}, radians(kFastest));
  for (const double bad : {0., -1., std::nan("")}) {
    table.add(bad, 1, 2);
    table.add(kStep, bad, 2);
    table.add(kStep, 1, bad);
  }
  table.add(kStep, 1, 1e300);
  ck_assert(!table.changed());
  ck_assert(table.map().points().empty());
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "speed_table",
      {scale_and_bend_of_a_table_are_found_in_seconds, a_calibration_is_kept_as_long_as_it_is_right,
       the_driver_is_not_bothered_by_noise, a_wrong_lens_makes_no_head_much_faster_than_its_limit,
       speeds_that_the_picture_does_not_show_teach_nothing, absurd_frames_are_left_out});
}
