// SPDX-License-Identifier: LGPL-2.1-or-later
// Tracks of people whom a turning camera leaves, and finds again.
#include "unit/walkers.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

// A camera of 90 degrees that turns, and people at bearings: f = 320 pixels.
struct Turning {
  static constexpr double kDegree = std::numbers::pi / 180;
  Lens lens{90 * kDegree, kFrame};
  Tracker tracker;
  bool head = true;  // reports its pose; else only the camera's motion is known
  double pan = 0;    // degrees
  std::vector<Track> tracks;

  // 10 frames a second; persons at these bearings, degrees, level, of 7 by 17.4 degrees (40 x 98 pixels in
  // the middle), as far as the picture shows them.
  void step(double to, std::vector<double> people) {
    std::vector<Region> regions;
    for (const double bearing : people) {
      const auto at = [&](double side, double up) {
        return lens.project({(bearing + side) * kDegree, up * kDegree}, to * kDegree, 0);
      };
      const auto left = at(-3.5, 0), right = at(3.5, 0), top = at(0, 8.7), foot = at(0, -8.7);
      if (!left || !right || !top || !foot) continue;
      const double x0 = std::max(left->x, 0.0), x1 = std::min<double>(right->x, kFrame.width);
      if (x1 - x0 >= 8) regions.push_back(person((x0 + x1) / 2, 240, 0.9, x1 - x0, foot->y - top->y));
    }
    const Transform motion = to == pan ? Transform{} : lens.turn(pan * kDegree, 0, to * kDegree, 0);
    pan = to;
    const auto found =
        tracker.update(regions, motion, 0.1, kFrame,
                       head ? std::optional(CameraOrientation{lens, to * kDegree, 0}) : std::nullopt);
    tracks.assign(found.begin(), found.end());
  }
  void watch(double from, double speed, int frames) {
    for (int k = 0; k < frames; ++k) step(pan, {from + speed * k});
  }
  void turn(double to, double by, std::vector<double> people = {}) {
    const double way = to - pan, sign = way < 0 ? -1 : 1;
    for (int k = static_cast<int>(std::abs(way) / by + 0.5); k > 0; --k) step(pan + sign * by, people);
  }
  std::uint32_t id() const { return tracks.empty() ? 0 : tracks[0].id; }
};

}  // namespace

START_TEST(an_off_screen_track_keeps_its_identity_when_the_camera_returns) {
  for (const bool head : {true, false}) {
    Turning camera;
    camera.head = head;
    camera.watch(-20, 1.5, 20);  // 15 degrees a second, to 8.5
    const std::uint32_t id = camera.id();
    ck_assert_uint_gt(id, 0);
    camera.turn(-90, 6, {9});  // 1.6 s; left behind after half of it
    ck_assert_uint_eq(camera.tracks.size(), 0);
    camera.turn(-18, 6, {14});  // 1.2 s; walked on a little
    camera.step(-18, {14.5});
    ck_assert_uint_eq(camera.tracks.size(), 1);
    ck_assert_uint_eq(camera.id(), id);
    ck_assert(camera.tracks[0].state == TrackState::seen);
  }
}
END_TEST

START_TEST(a_track_behind_the_camera_keeps_its_identity) {
  Turning camera;
  camera.watch(-30, 1.5, 20);
  const std::uint32_t id = camera.id();
  ck_assert_uint_gt(id, 0);
  camera.turn(168, 12);  // the person is out of every picture, behind the camera
  ck_assert_uint_eq(camera.tracks.size(), 0);
  camera.turn(0, 12, {12});
  ck_assert_uint_eq(camera.tracks.size(), 1);
  ck_assert_uint_eq(camera.id(), id);
}
END_TEST

START_TEST(a_person_in_another_place_is_a_new_track) {
  Turning camera;
  camera.watch(-30, 1.5, 20);
  const std::uint32_t id = camera.id();
  camera.turn(-60, 6, {-1});
  for (int k = 0; k < 5; ++k)
    camera.step(-60, {-80.0 + k});  // no person walks four body lengths in half a second
  ck_assert_uint_eq(camera.tracks.size(), 1);
  ck_assert_uint_ne(camera.id(), id);
}
END_TEST

START_TEST(an_off_screen_track_ends_after_the_away_time) {
  for (const double seconds : {3.0, 8.0}) {
    Turning camera;
    camera.watch(-30, 1.5, 20);
    const std::uint32_t id = camera.id();
    camera.turn(-90, 10, {0});
    for (int k = 0; k < 10 * seconds - 18; ++k) camera.step(-90, {});
    camera.turn(0, 10, {10});
    for (int k = 0; k < 5; ++k) camera.step(0, {10.0 + 0.8 * k});
    ck_assert_uint_eq(camera.tracks.size(), 1);
    ck_assert_int_eq(camera.id() == id, seconds < 5);
  }
}
END_TEST

START_TEST(a_person_who_leaves_the_picture_of_a_still_camera_returns_as_a_new_track) {
  Turning camera;
  camera.head = false;
  camera.watch(0, 2, 22);
  const std::uint32_t id = camera.id();
  ck_assert_uint_gt(id, 0);
  for (int k = 22; k < 30; ++k) camera.step(0, {2.0 * k});  // out at 45 degrees
  ck_assert_uint_eq(camera.tracks.size(), 0);
  for (int k = 0; k < 8; ++k) camera.step(0, {46 - 2.0 * k});
  ck_assert_uint_eq(camera.tracks.size(), 1);
  ck_assert_uint_ne(camera.id(), id);
}
END_TEST

// The identity of a person who walks out to the right of a head that stands, or to the left (side -1), and that of the
// person who comes in after so many seconds: at the bearing `from`, 20 degrees a second, into a picture that looks along
// `pan` by then.
struct Met {
  std::uint32_t before = 0, after = 0;
};
Met walks_out(double seconds, double from, double pan = 0, double side = 1, bool head = true) {
  Turning camera;
  camera.head = head;
  if (!head) camera.turn(6, 6), camera.turn(0, 6);
  Met met;
  for (int k = 0; k < 22; ++k) camera.step(0, {side * 2 * k});
  met.before = camera.id();
  ck_assert_uint_gt(met.before, 0);
  for (int k = 22; k < 30; ++k) camera.step(0, {side * 2 * k});  // out at 45 degrees
  const int frames = static_cast<int>(10 * seconds);
  const double step = pan / std::max(1.0, frames / 2.0);
  for (int k = 0; k < frames; ++k) camera.step(k < frames / 2 ? camera.pan + step : camera.pan, {});
  ck_assert_uint_eq(camera.tracks.size(), 0);
  const double speed = from > camera.pan ? -2 : 2;
  for (int k = 0; k < 8; ++k) camera.step(camera.pan, {from + speed * k});
  ck_assert_uint_eq(camera.tracks.size(), 1);
  met.after = camera.id();
  return met;
}

START_TEST(a_person_who_walks_out_of_a_head_s_picture_is_expected_back_at_that_side) {
  for (const bool head : {true, false})
    for (const double side : {1.0, -1.0}) {
      for (const double seconds : {1.0, 10.0, 28.0}) {
        const Met same = walks_out(seconds, side * 46, 0, side, head),
                  other = walks_out(seconds, side * -46, 0, side, head);
        ck_assert_uint_eq(same.before, same.after);
        ck_assert_uint_ne(other.before, other.after);
      }
      const Met late = walks_out(31, side * 46, 0, side, head);
      ck_assert_uint_ne(late.before, late.after);
      // The head turns back meanwhile, by 60 degrees: the place at 46 degrees is 106 degrees aside, behind the camera.
      const Met turned = walks_out(8, side * -14, side * -60, side, head);
      ck_assert_uint_eq(turned.before, turned.after);
      const Met behind = walks_out(8, side * -106, side * -60, side, head);
      ck_assert_uint_ne(behind.before, behind.after);
    }
}
END_TEST

int main() {
  return run_suite("turning",
                   {an_off_screen_track_keeps_its_identity_when_the_camera_returns,
                    a_track_behind_the_camera_keeps_its_identity, a_person_in_another_place_is_a_new_track,
                    an_off_screen_track_ends_after_the_away_time,
                    a_person_who_leaves_the_picture_of_a_still_camera_returns_as_a_new_track,
                    a_person_who_walks_out_of_a_head_s_picture_is_expected_back_at_that_side});
}
