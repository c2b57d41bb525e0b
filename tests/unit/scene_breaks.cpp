// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/scene_breaks.h"

#include <check.h>

#include "support/suite.h"

using cerberus::vision::SceneBreaks;

namespace {

// One scene of `frames` frames of 100 ms. Returns what its last frame brings.
bool scene(SceneBreaks& breaks, int frames, bool broken = true) {
  bool reported = breaks.add(true, broken, 0);
  for (int k = 1; k < frames; ++k) reported = breaks.add(false, false, .1);
  return reported;
}

}  // namespace

START_TEST(eight_scenes_in_a_row_that_break_too_early_are_reported) {
  SceneBreaks breaks;
  ck_assert(!scene(breaks, 2, false));
  for (int k = 1; k < 8; ++k) ck_assert(!scene(breaks, 2));
  ck_assert(scene(breaks, 2));
}
END_TEST

// Five frames of 100 ms have .2 s from the third one on, four of them have .1 s.
START_TEST(a_scene_of_five_frames_and_two_tenths_of_a_second_is_long_enough) {
  for (const int frames : {4, 5}) {
    SceneBreaks breaks;
    bool reported = false;
    for (int k = 0; k < 20; ++k) reported = scene(breaks, frames);
    ck_assert_int_eq(reported, frames == 4);
  }
}
END_TEST

START_TEST(many_frames_within_a_moment_are_too_short_a_scene) {
  SceneBreaks breaks;
  bool reported = false;
  for (int k = 0; k < 9; ++k) {
    breaks.add(true, true, 0);
    for (int frame = 1; frame < 10; ++frame) reported = breaks.add(false, false, .02);  // .14 s
  }
  ck_assert(reported);
}
END_TEST

START_TEST(a_scene_that_ends_with_a_cut_of_the_picture_starts_the_count_anew) {
  SceneBreaks breaks;
  for (int k = 0; k < 7; ++k) scene(breaks, 2);
  ck_assert(!scene(breaks, 2, false));
  for (int k = 1; k < 8; ++k) ck_assert(!scene(breaks, 2));
  ck_assert(scene(breaks, 2));
}
END_TEST

int main() {
  return cerberus::tests::run_suite("scene_breaks",
                                    {eight_scenes_in_a_row_that_break_too_early_are_reported,
                                     a_scene_of_five_frames_and_two_tenths_of_a_second_is_long_enough,
                                     many_frames_within_a_moment_are_too_short_a_scene,
                                     a_scene_that_ends_with_a_cut_of_the_picture_starts_the_count_anew});
}
