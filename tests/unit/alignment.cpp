// SPDX-License-Identifier: LGPL-2.1-or-later
// Alignment to the background recovers known motions, and moving objects do not bias it.
#include "vision/background/alignment.h"

#include <check.h>

#include <vector>

#include "support/motions.h"
#include "support/pictures.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr Size kSize{320, 240};
constexpr int kColumns = 20, kRows = 15;

// The sums of frame(q) = scene seen after `motion` against background = scene.
std::vector<BlockSums> sums(const Scene& scene, const Transform& motion, bool object) {
  Image<std::uint8_t> memory({kSize.width + 32, kSize.height + 2}), present(kSize), age(kSize), quiet(kSize);
  age.fill_bytes(9);
  quiet.fill_bytes(9);
  const auto whole = memory.view();
  look(scene, Transform::translation(16, 1), {whole.data, kSize.width + 32, kSize.height + 2, whole.stride});
  look(scene, motion, present.view());
  if (object)
    for (int y = 60; y < 180; ++y)
      for (int x = 100; x < 180; ++x) present.view().at(x, y) = to_byte(scene.at(x + 40, y + 33));
  std::vector<BlockSums> blocks;
  for (int by = 0; by < kRows; ++by)
    for (int bx = 0; bx < kColumns; ++bx)
      blocks.push_back(block_sums({present.view(),
                                   {whole.data + whole.stride + 16, kSize.width, kSize.height, whole.stride},
                                   age.view(),
                                   quiet.view(),
                                   std::max(16 * by, 1),
                                   std::min(16 * by + 16, kSize.height - 1),
                                   2,
                                   3},
                                  16 * bx, 1, kSize.width - 1));
  return blocks;
}

// frame(p) = scene(motion^-1 p), so frame(motion q) = scene(q): the correction is the motion itself.
void assert_recovers(const Transform& motion, bool object, double tolerance) {
  const auto correction = align_to_background(sums(Scene(12), motion, object), kColumns, kSize);
  ck_assert(correction.has_value());
  const Transform error = *correction * motion.inverse();
  ck_assert_double_le(error.corner_motion(kSize), tolerance);
}

}  // namespace

START_TEST(a_translation_is_recovered) {
  assert_recovers(Transform::translation(0.7, -0.4), false, 0.1);
}
END_TEST

START_TEST(a_turn_about_the_centre_is_recovered) {
  const Transform centre = Transform::translation(159.5, 119.5);
  assert_recovers(centre * similarity(1.003, 0.003, 0.2, 0) * centre.inverse(), false, 0.15);
}
END_TEST

START_TEST(a_perspective_is_recovered) {
  const Transform centre = Transform::translation(159.5, 119.5);
  assert_recovers(centre * Transform{{1, 0, 0, 0, 1, 0, 2e-5, -1e-5, 1}} * centre.inverse(), false, 0.2);
}
END_TEST

START_TEST(an_object_does_not_bias_the_alignment) {
  assert_recovers(Transform::translation(0.5, 0.3), true, 0.15);
}
END_TEST

START_TEST(no_correction_below_the_least) {
  ck_assert(!align_to_background(sums(Scene(12), {}, false), kColumns, kSize));
  ck_assert(
      !align_to_background(std::vector<BlockSums>(kColumns * kRows), kColumns, kSize));  // no measured pixel
}
END_TEST

int main() {
  return run_suite("scene_alignment", {a_translation_is_recovered, a_turn_about_the_centre_is_recovered,
                                       a_perspective_is_recovered, an_object_does_not_bias_the_alignment,
                                       no_correction_below_the_least});
}
