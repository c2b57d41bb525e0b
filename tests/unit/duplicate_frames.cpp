// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/duplicate_frames.h"

#include <check.h>

#include "support/suite.h"

using namespace cerberus;
using namespace cerberus::vision;

namespace {

GrayPicture picture(int level, int odd = 0, Size size = {33, 17}) {
  static threads::Pool<Image<std::uint8_t>> pool;
  GrayPicture result = pool.take();
  result->resize(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) result->view().row(y)[x] = static_cast<std::uint8_t>(level);
  result->view().row(size.height - 1)[size.width - 1] = static_cast<std::uint8_t>(level + odd);
  return result;
}

}  // namespace

// Pictures 3, 4, 5, each three times.
START_TEST(the_same_picture_after_one_that_moved_is_a_duplicate) {
  DuplicateFrames frames;
  ck_assert(!frames.repeats(picture(1), false, false));
  ck_assert(!frames.repeats(picture(2), true, true));
  for (int level = 3; level < 6; ++level) {
    ck_assert(!frames.repeats(picture(level), true, true));
    ck_assert(frames.repeats(picture(level), true, true));
    ck_assert(frames.repeats(picture(level), true, true));
  }
}
END_TEST

START_TEST(one_sample_makes_another_picture) {
  DuplicateFrames frames;
  frames.repeats(picture(1), false, false);
  frames.repeats(picture(2), true, true);
  ck_assert(!frames.repeats(picture(2, 1), true, true));
}
END_TEST

START_TEST(a_still_scene_has_no_duplicates) {
  DuplicateFrames frames;
  ck_assert(!frames.repeats(picture(1), false, false));
  for (int k = 0; k < 10; ++k) ck_assert(!frames.repeats(picture(1), true, true));
}
END_TEST

// When it has been repeated for too long, it counts as a picture, and the scene as still.
START_TEST(a_freeze_becomes_a_still_scene) {
  DuplicateFrames frames;
  frames.repeats(picture(1), false, false);
  frames.repeats(picture(2), true, true);
  ck_assert(frames.repeats(picture(2), true, true));
  ck_assert(!frames.repeats(picture(2), true, false));
  ck_assert(!frames.repeats(picture(2), true, true));
}
END_TEST

START_TEST(the_first_picture_of_a_scene_and_another_size_repeat_nothing) {
  DuplicateFrames frames;
  frames.repeats(picture(1), false, false);
  frames.repeats(picture(2), true, true);
  ck_assert(!frames.repeats(picture(2), false, true));
  frames.repeats(picture(3), true, true);
  ck_assert(!frames.repeats(picture(3, 0, {17, 33}), true, true));
  frames.repeats(picture(4, 0, {17, 33}), true, true);
  frames.forget();
  ck_assert(!frames.repeats(picture(4, 0, {17, 33}), true, true));
}
END_TEST

int main() {
  return tests::run_suite(
      "duplicate_frames",
      {the_same_picture_after_one_that_moved_is_a_duplicate, one_sample_makes_another_picture,
       a_still_scene_has_no_duplicates, a_freeze_becomes_a_still_scene,
       the_first_picture_of_a_scene_and_another_size_repeat_nothing});
}
