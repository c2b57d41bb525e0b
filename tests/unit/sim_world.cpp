// SPDX-License-Identifier: LGPL-2.1-or-later
// Persons, bases, cameras and scores of the simulated world against numbers worked out by hand.
#include "sim/asked_base.h"
#include "sim/camera.h"
#include "sim/scenes.h"
#include "sim/zoom_lens.h"

#include <check.h>

#include <cmath>
#include <vector>

#include "sim/score.h"
#include "sim/shuttle.h"
#include "support/suite.h"

using namespace cerberus::sim;
using namespace std::chrono_literals;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;

// 90 at 45 a second and 90 a second squared: .5 s and 11.25 to full speed, 1.5 s of cruise.
START_TEST(a_shuttle_goes_to_and_fro_with_ramps_and_rests) {
  const Shuttle base(90, 45, 90, 2);
  ck_assert_double_eq_tol(base.period(), 9, 1e-12);
  const double known[][2] = {{0, 0},    {2, 0},    {2.25, 2.8125}, {2.5, 11.25}, {3.25, 45}, {4, 78.75},
                             {4.5, 90}, {6.5, 90}, {7, 78.75},     {7.75, 45},   {9, 0},     {11.5, 11.25}};
  for (const auto& [time, position] : known) ck_assert_double_eq_tol(base.at(time), position, 1e-9);
  for (const double position : {0., 5., 11.25, 45., 80., 90.})
    ck_assert_double_eq_tol(base.at(base.passes(position)), position, 1e-9);
}
END_TEST

// 4 of way at 1 a second squared: 2 s up to 2, 2 s down, whatever speed it might reach.
START_TEST(a_short_way_has_no_cruise) {
  const Shuttle line(4, 100, 1);
  ck_assert_double_eq_tol(line.period(), 8, 1e-12);
  ck_assert_double_eq_tol(line.at(2), 2, 1e-12);
  ck_assert_double_eq_tol(line.at(4), 4, 1e-12);
  ck_assert_double_eq_tol(line.at(5), 3.5, 1e-12);
}
END_TEST

// Three metres away the place on the line is 3 tan(bearing).
START_TEST(a_walker_keeps_its_speed_its_acceleration_and_its_line) {
  const Scene near = scene("near", 4);
  double before = 3 * std::tan(near.person(0)), speed_before = 0, fastest = 0, hardest = 0, widest = 0;
  for (int ms = 1; ms < 60000; ++ms) {
    const double place = 3 * std::tan(near.person(ms / 1000.));
    const double speed = (place - before) * 1000;
    if (ms > 1) hardest = std::max(hardest, std::abs(speed - speed_before) * 1000);
    fastest = std::max(fastest, std::abs(speed));
    widest = std::max(widest, std::abs(degrees(near.person(ms / 1000.))));
    before = place;
    speed_before = speed;
  }
  ck_assert_double_eq_tol(fastest, 1.4, .001);
  ck_assert_double_eq_tol(hardest, 1.5, .01);
  ck_assert_double_eq_tol(widest, 60, .01);
}
END_TEST

START_TEST(one_seed_gives_one_person_and_another_seed_another) {
  for (const char* name : kScenes) {
    const Scene a = scene(name, 1), again = scene(name, 1), other = scene(name, 2);
    ck_assert_double_eq(a.person(7.3), again.person(7.3));
    if (!a.sector) ck_assert_double_ne(a.person(7.3), other.person(7.3));
  }
  ck_assert_double_eq_tol(degrees(scene("step", 1).person(3)), 100, 1e-9);
  ck_assert_double_eq_tol(degrees(scene("gyro", 1).base(3.25)), 45, 1e-9);
  ck_assert_double_eq(scene("mix", 1).base(3.25), 0);
}
END_TEST

START_TEST(boxes_have_the_noise_that_is_asked_white_or_wandering) {
  for (const double wander : {0., .3}) {
    CameraTraits traits;
    traits.wander = wander;
    Camera camera(traits, 3);
    double sum = 0, product = 0, before = 0;
    constexpr int kPictures = 20000;
    for (int k = 0; k < kPictures; ++k) {
      const double off = degrees(camera.take(camera.next(), 0, 0, true).off);
      sum += off * off;
      product += off * before;
      before = off;
    }
    ck_assert_double_eq_tol(std::sqrt(sum / kPictures), 1, .05);
    // The correlation of neighbours is exp(-.04 / .3) = .875.
    ck_assert_double_eq_tol(product / sum, wander > 0 ? .875 : 0, .02);
  }
}
END_TEST

START_TEST(a_picture_shows_a_person_within_the_lens_and_how_far_it_turned) {
  CameraTraits traits;
  traits.turn_noise = traits.box_noise = 0;
  Camera camera(traits, 1);
  ck_assert(camera.take(Time{}, radians(28.9), 0, true).seen);
  ck_assert_int_eq(camera.next().count(), Time(40ms).count());
  ck_assert(!camera.take(40ms, radians(-29.1), 0, true).seen);
  ck_assert(!camera.take(80ms, 0, 0, false).seen);
  const Picture turned = camera.take(120ms, radians(5), radians(3), true);
  ck_assert_double_eq_tol(degrees(turned.turn), 3, 1e-9);
  ck_assert_double_eq_tol(degrees(turned.off), 5, 1e-9);
  ck_assert_double_eq_tol(degrees(camera.take(160ms, 0, radians(2), true).turn), -1, 1e-9);
}
END_TEST

// Of 10 judged seconds the first 5 at 40 degrees, out of a picture of 60, and the rest at 2.
START_TEST(a_score_is_of_what_comes_after_the_skipped_time) {
  Score::Parameters parameters;
  parameters.skip = 2;
  Score score(parameters);
  for (int ms = 0; ms < 12000; ++ms) {
    const double t = ms / 1000.;
    score.add(t, radians(t < 7 ? 40 : 2), 0, radians(3));
  }
  ck_assert_double_eq_tol(degrees(score.rms()), std::sqrt((40 * 40 + 2 * 2) / 2.), 1e-6);
  ck_assert_double_eq_tol(score.lost(), .5, 1e-9);
  ck_assert_double_eq_tol(degrees(score.pose_error()), 3, 1e-9);
  ck_assert_double_eq_tol(score.seen().value_or(0), 7, 1e-9);
  ck_assert_double_eq_tol(score.centred().value_or(0), 7, 1e-9);
}
END_TEST

// A camera that swings by `size` to both sides once in two seconds reverses 60 times a minute, if that is seen at all.
START_TEST(reversals_are_counted_above_a_tenth_of_a_degree) {
  for (const double size : {1., .04}) {
    Score score(Score::Parameters{});
    for (int ms = 0; ms < 63000; ++ms)
      score.add(ms / 1000., 0, radians(size * std::sin(M_PI * ms / 1000)), 0);
    ck_assert_double_eq_tol(score.reversals(), size == 1 ? 60 : 0, 1.01);
  }
}
END_TEST

START_TEST(a_camera_that_never_finds_the_person_has_no_time_of_finding) {
  Score score(Score::Parameters{});
  for (int ms = 0; ms < 5000; ++ms) score.add(ms / 1000., radians(50), 0, 0);
  ck_assert(!score.seen() && !score.centred());
  ck_assert_double_eq(score.lost(), 1);
}
END_TEST

// 60 degrees to 30 in tan: log(.57735 / .26795) = .7676, at 1 a second from .15 s on; reports at .5, 1 s.
START_TEST(a_zoom_goes_at_its_speed_after_its_dead_time_and_reports_twice_a_second) {
  ZoomLens lens({});
  lens.elapse(1ms);
  lens.command(radians(30), 1ms);
  lens.elapse(150ms);
  ck_assert_double_eq_tol(degrees(lens.field_of_view()), 60, 1e-9);
  lens.elapse(535ms);  // half of the way: sqrt(.57735 .26795) is 21.47 degrees to each side
  ck_assert_double_eq_tol(degrees(lens.field_of_view()), 2 * 21.47, .1);
  lens.elapse(960ms);
  ck_assert_double_eq_tol(degrees(lens.field_of_view()), 30, 1e-6);
  ck_assert_double_gt(degrees(lens.reported()), 40);
  lens.elapse(1001ms);
  ck_assert_double_eq_tol(degrees(lens.reported()), 30, 1e-6);
}
END_TEST

// 30 a second asked for once: from .2 s on, a ramp of a third of a second, and braked half a second later.
START_TEST(a_base_turns_as_it_is_asked_for_half_a_second) {
  AskedBase base;
  base.ask(radians(30), 0ms);
  std::chrono::milliseconds now{};
  const auto at = [&](std::chrono::milliseconds until) {
    for (; now < until; now += 1ms) base.step(now);
    return degrees(base.yaw());
  };
  ck_assert_double_eq(at(200ms), 0);
  ck_assert_double_eq_tol(at(700ms), 10, .1);  // 5 by the ramp and 5 after it
  ck_assert_double_eq_tol(at(2s), 15, .1);     // 5 more to rest
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "sim_world",
      {a_zoom_goes_at_its_speed_after_its_dead_time_and_reports_twice_a_second,
       a_base_turns_as_it_is_asked_for_half_a_second, a_shuttle_goes_to_and_fro_with_ramps_and_rests,
       a_short_way_has_no_cruise, a_walker_keeps_its_speed_its_acceleration_and_its_line,
       one_seed_gives_one_person_and_another_seed_another,
       boxes_have_the_noise_that_is_asked_white_or_wandering,
       a_picture_shows_a_person_within_the_lens_and_how_far_it_turned,
       a_score_is_of_what_comes_after_the_skipped_time, reversals_are_counted_above_a_tenth_of_a_degree,
       a_camera_that_never_finds_the_person_has_no_time_of_finding});
}
