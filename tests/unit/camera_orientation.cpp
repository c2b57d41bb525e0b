// SPDX-License-Identifier: LGPL-2.1-or-later
// Which way a camera looks, against turns that are known; and how much larger things are beside a picture's middle.
#include "vision/geometry/camera_orientation.h"

#include <check.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr Size kFrame{640, 480};
constexpr double kDegree = std::numbers::pi / 180;
const Lens kLens(60 * kDegree, kFrame);
// A camera of unknown lens is treated as if it had this one.
const Lens kUnknown(OrientationEstimate::kUnknownFov, kFrame);

void assert_looks(const OrientationEstimate& heading, double pan, double tilt) {
  ck_assert_double_eq_tol(heading.gaze().pan / kDegree, pan, 1e-6);
  ck_assert_double_eq_tol(heading.gaze().tilt / kDegree, tilt, 1e-6);
}

// Degrees; in one of the two directions only, or the middle's path is not that of a plain sum.
Transform turn(const Lens& lens, double pan, double tilt) {
  return lens.turn(0, 0, pan * kDegree, tilt * kDegree);
}

}  // namespace

START_TEST(without_a_head_the_motion_of_the_picture_gives_the_orientation) {
  OrientationEstimate heading;
  ck_assert(heading.update({}, {}, kFrame));  // the first frame: straight ahead
  assert_looks(heading, 0, 0);
  ck_assert(!heading.update({}, turn(kUnknown, 3, 0), kFrame));
  assert_looks(heading, 3, 0);
  heading.update({}, turn(kUnknown, 0, 2), kFrame);
  heading.update({}, turn(kUnknown, 0, 2), kFrame);
  assert_looks(heading, 3, 4);
  heading.update({}, turn(kUnknown, -5, 0), kFrame);
  heading.update({}, turn(kUnknown, 0, -6), kFrame);
  assert_looks(heading, -2, -2);
  heading.update({}, {}, kFrame);
  assert_looks(heading, -2, -2);
}
END_TEST

START_TEST(a_head_that_speaks_is_believed_and_where_it_stops_the_picture_goes_on) {
  OrientationEstimate heading;
  heading.update({}, {}, kFrame);
  heading.update({}, turn(kUnknown, 3, 0), kFrame);
  // It jumps: what was placed before is nowhere.
  ck_assert(heading.update(CameraOrientation{kLens, 20 * kDegree, -5 * kDegree}, {}, kFrame));
  assert_looks(heading, 20, -5);
  // While the head reports its pose, the motion of the picture is not used.
  ck_assert(!heading.update(CameraOrientation{kLens, 21 * kDegree, -5 * kDegree}, turn(kLens, 9, 0), kFrame));
  assert_looks(heading, 21, -5);
  ck_assert(!heading.update({}, turn(kLens, 4, 0), kFrame));
  assert_looks(heading, 25, -5);
  ck_assert(heading.update(CameraOrientation{kLens, 0, 0}, {}, kFrame));
}
END_TEST

START_TEST(another_size_of_frame_begins_anew) {
  OrientationEstimate heading;
  heading.update({}, {}, kFrame);
  heading.update({}, turn(kUnknown, 3, 0), kFrame);
  ck_assert(heading.update({}, {}, {320, 240}));
  assert_looks(heading, 0, 0);
}
END_TEST

START_TEST(what_is_no_number_turns_nothing) {
  OrientationEstimate heading;
  heading.update({}, {}, kFrame);
  heading.update(CameraOrientation{kLens, NAN, 0}, turn(kUnknown, 3, 0), kFrame);
  assert_looks(heading, 3, 0);
  heading.update(CameraOrientation{Lens(), 1, 1}, {}, kFrame);  // of an unknown lens
  assert_looks(heading, 3, 0);
  heading.update({}, Transform{{1, 0, NAN, 0, 1, 0, 0, 0, 1}}, kFrame);
  assert_looks(heading, 3, 0);
}
END_TEST

// cos^-1.5 of the angle to the axis, by hand: 60 degrees 2.8284, 30 degrees 1.2408; from 75 degrees on .26^-1.5.
START_TEST(things_beside_the_middle_are_larger) {
  const double end = std::pow(0.26, -1.5);
  const struct {
    double pan, tilt, bearing, elevation, larger;
  } cases[] = {{0, 0, 0, 0, 1},         {20, 30, 20, 30, 1},     {-100, -40, -100, -40, 1},
               {10, 0, 70, 0, 2.8284},  {10, 0, -50, 0, 2.8284}, {170, 0, -130, 0, 2.8284},
               {0, 0, 0, 30, 1.2408},   {0, 30, 0, 0, 1.2408},   {0, -30, 0, 0, 1.2408},
               {0, 30, 0, -30, 2.8284}, {0, 30, 90, 90, 2.8284}, {0, 0, 80, 0, end},
               {0, 0, 179, 0, end},     {0, 0, 0, -90, end}};
  for (const auto& c : cases) {
    const CameraOrientation gaze{kLens, c.pan * kDegree, c.tilt * kDegree};
    ck_assert_double_eq_tol(gaze.magnification({c.bearing * kDegree, c.elevation * kDegree}), c.larger, 1e-3);
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite("heading",
                                    {without_a_head_the_motion_of_the_picture_gives_the_orientation,
                                     a_head_that_speaks_is_believed_and_where_it_stops_the_picture_goes_on,
                                     another_size_of_frame_begins_anew, what_is_no_number_turns_nothing,
                                     things_beside_the_middle_are_larger});
}
