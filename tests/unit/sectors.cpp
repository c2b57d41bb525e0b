// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sensing/sectors.h"

#include <check.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <vector>

#include "sensing/angles.h"
#include "support/geometry.h"
#include "support/suite.h"

using namespace cerberus::sensing;
using cerberus::tests::geometry;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void assert_arc(const Arc& arc, double from, double width) {
  ck_assert_double_eq_tol(degrees(arc.from), from, 1e-6);
  ck_assert_double_eq_tol(degrees(arc.width), width, 1e-6);
}

}  // namespace

START_TEST(directions_wrap_and_keep_their_meaning) {
  ck_assert_double_eq(wrap(-std::numbers::pi), -std::numbers::pi);
  ck_assert_double_eq(wrap(std::numbers::pi), -std::numbers::pi);
  ck_assert_double_eq(wrap(0.1), 0.1);
  for (int turn = -3; turn <= 3; ++turn)
    for (int angle = -179; angle < 180; ++angle)
      ck_assert_double_eq_tol(wrap(radians(angle + 360 * turn)), radians(angle), 1e-12);
  ck_assert(std::isnan(wrap(kNan)));
  ck_assert(std::isnan(wrap(std::numeric_limits<double>::infinity())));
  // Never pi itself nor beyond -pi, however the rounding falls and however large a pan angle from other elements is.
  ck_assert(wrap(std::nextafter(-std::numbers::pi, -4)) < std::numbers::pi);
  for (double degrees = -1e6 + 100; degrees < 1e6; degrees += 180) {  // odd and even multiples of half a turn
    const double wrapped = wrap(radians(degrees - std::fmod(degrees, 180)));
    ck_assert(wrapped >= -std::numbers::pi && wrapped < std::numbers::pi);
  }
  for (const double far : {3e15, 1e16, 1e300}) {
    ck_assert_double_eq_tol(std::sin(wrap(far)), std::sin(std::remainder(far, 2 * std::numbers::pi)), 1e-12);
    ck_assert_double_eq(wrap(-far), -wrap(far));
  }
}
END_TEST

START_TEST(the_default_geometry_is_the_papers) {
  const Geometry paper;
  ck_assert(paper == geometry({0, -120, 120}, 120));
  assert_arc(paper.sector(0), -60, 120);
  assert_arc(paper.sector(1), -180, 120);
  assert_arc(paper.sector(2), 60, 120);
}
END_TEST

START_TEST(a_geometry_that_cannot_be_is_refused_and_changes_nothing) {
  Geometry sensors;
  const std::vector<double> none, many(kMaxSensors + 1, 0.0), bad{0, kNan}, good{0};
  ck_assert(!sensors.set(none, 1) && !sensors.set(many, 1) && !sensors.set(bad, 1));
  for (const double width : {0.0, -1.0, kNan, 7.0}) ck_assert(!sensors.set(good, width));
  ck_assert(sensors == Geometry());
  ck_assert(sensors.set(std::vector<double>{radians(540)}, radians(360)));
  ck_assert_double_eq_tol(sensors.bearing(0), -std::numbers::pi, 1e-12);
}
END_TEST

START_TEST(sensors_of_different_make_have_each_its_own_width) {
  Geometry sensors;
  const std::vector<double> bearings{radians(-40), radians(60)}, fields{radians(120), radians(90)};
  ck_assert(sensors.set(bearings, fields));
  assert_arc(sensors.sector(0), -100, 120);
  assert_arc(sensors.sector(1), 15, 90);
  const Arcs arcs = overlap(sensors, 0b11);
  ck_assert_int_eq(arcs.count, 1);
  assert_arc(arcs[0], 15, 5);
  const Geometry before = sensors;
  ck_assert(!sensors.set(bearings, std::vector<double>{1}));
  ck_assert(!sensors.set(bearings, std::vector<double>{1, kNan}));
  ck_assert(sensors == before);
}
END_TEST

START_TEST(sectors_overlap_where_all_of_them_look) {
  const Geometry sensors = geometry({0, 45, 90, 170, -170}, 60);
  ck_assert_int_eq(overlap(sensors, 0).count, 0);
  Arcs arcs = overlap(sensors, 0b00011);
  ck_assert_int_eq(arcs.count, 1);
  assert_arc(arcs[0], 15, 15);
  arcs = overlap(sensors, 0b00100);
  ck_assert_int_eq(arcs.count, 1);
  assert_arc(arcs[0], 60, 60);
  ck_assert_int_eq(overlap(sensors, 0b00101).count, 0);
  ck_assert_int_eq(overlap(sensors, 0b00111).count, 0);
  arcs = overlap(sensors, 0b11000);  // across the seam
  ck_assert_int_eq(arcs.count, 1);
  assert_arc(arcs[0], 160, 40);
  ck_assert_int_eq(overlap(sensors, 0b100000).count, 0);  // a sensor there is not
}
END_TEST

START_TEST(sectors_that_touch_meet_on_their_border) {
  const Geometry paper;
  const Arcs left = overlap(paper, 0b011), behind = overlap(paper, 0b110);
  ck_assert_int_eq(left.count, 1);
  assert_arc(left[0], -60, 0);
  ck_assert_int_eq(behind.count, 1);
  assert_arc(behind[0], -180, 0);
  ck_assert_int_eq(overlap(paper, 0b111).count, 0);
}
END_TEST

START_TEST(wide_sectors_meet_twice) {
  Arcs arcs = overlap(geometry({0, 180}, 180), 0b11);
  ck_assert_int_eq(arcs.count, 2);
  assert_arc(arcs[0], -90, 0);
  assert_arc(arcs[1], 90, 0);
  arcs = overlap(geometry({0, 180}, 270), 0b11);
  ck_assert_int_eq(arcs.count, 2);
  assert_arc(arcs[0], -135, 90);
  assert_arc(arcs[1], 45, 90);
}
END_TEST

START_TEST(sensors_that_see_all_around_narrow_nothing) {
  Arcs arcs = overlap(geometry({0, 77, -100}, 360), 0b111);
  ck_assert_int_eq(arcs.count, 1);
  ck_assert_double_eq_tol(degrees(arcs[0].width), 360, 1e-6);
  arcs = overlap(geometry({30, 30}, 90), 0b11);  // two with one view
  ck_assert_int_eq(arcs.count, 1);
  assert_arc(arcs[0], -15, 90);
}
END_TEST

// Against counting directions one by one, half a degree apart, with whole numbers.
START_TEST(overlaps_are_those_of_a_brute_force_count) {
  std::srand(7);
  for (int round = 0; round < 2000; ++round) {
    const int count = 1 + std::rand() % 5;
    const int width = 2 * (1 + std::rand() % 359);  // half degrees, even
    std::vector<double> bearings;
    std::vector<int> middles;
    for (int i = 0; i < count; ++i) {
      middles.push_back(std::rand() % 720);
      bearings.push_back(middles.back() / 2.0);
    }
    const Geometry sensors = geometry(bearings, width / 2.0);
    const auto all = static_cast<SensorBits>((1U << count) - 1);
    const Arcs arcs = overlap(sensors, all);
    for (int direction = 0; direction < 720; ++direction) {
      bool expected = true;
      for (const int middle : middles) {
        const int apart = std::abs(direction - middle) % 720;
        expected = expected && std::min(apart, 720 - apart) * 2 <= width;
      }
      bool found = false;
      for (const Arc& arc : arcs) {
        double offset = degrees(wrap(radians(direction / 2.0) - arc.from));
        if (offset < -1e-4) offset += 360;
        found = found || offset <= degrees(arc.width) + 1e-4;
      }
      if (found != expected) ck_abort_msg("round %d, direction %g", round, direction / 2.0);
    }
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "sectors", {directions_wrap_and_keep_their_meaning, the_default_geometry_is_the_papers,
                  a_geometry_that_cannot_be_is_refused_and_changes_nothing,
                  sensors_of_different_make_have_each_its_own_width, sectors_overlap_where_all_of_them_look,
                  sectors_that_touch_meet_on_their_border, wide_sectors_meet_twice,
                  sensors_that_see_all_around_narrow_nothing, overlaps_are_those_of_a_brute_force_count});
}
