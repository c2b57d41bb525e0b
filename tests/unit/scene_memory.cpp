// SPDX-License-Identifier: LGPL-2.1-or-later
// What the memory takes for noise: known by brightness, because a sensor's grows with it.
#include "vision/scene_memory.h"

#include <random>

#include "support/pictures.h"
#include "support/suite.h"
#include "vision/moving_area.h"
#include "vision/three_frame_difference.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr Size kSize{320, 240};
// A dark wall and a bright window, with noise of sigma 2 in the dark and 15 in the bright part. From frame 3 on a block
// 13 levels brighter than its ground goes through the dark part.
constexpr int kDark = 40, kBright = 200, kEdge = 240;
constexpr int kBlock = 40, kBlockTop = 100, kContrast = 13;
int left_of_block(int frame) {
  return 10 + 2 * frame;
}
void expose(int frame, std::mt19937& random, MutableGrayView out) {
  std::normal_distribution<double> normal;
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const bool dark = x < kEdge;
      const int in_block = x - left_of_block(frame);
      const bool block =
          frame >= 3 && in_block >= 0 && in_block < kBlock && y >= kBlockTop && y < kBlockTop + kBlock;
      out.at(x, y) = to_byte((dark ? kDark : kBright) + (dark && block ? kContrast : 0) +
                             (dark ? 2 : 15) * normal(random));
    }
}

long count(GrayView mask, int left, int top, int right, int bottom) {
  long n = 0;
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) n += mask.at(x, y) != 0;
  return n;
}

}  // namespace

START_TEST(what_is_faint_is_seen_in_the_dark_and_noise_is_not_in_the_bright) {
  std::mt19937 random(9);
  Image<std::uint8_t> picture(kSize), current(kSize), previous(kSize), mask(kSize);
  ThreeFrameDifference difference;
  MovingArea area;
  Histogram histogram;
  for (int k = 0; k < 6; ++k) {
    expose(k, random, picture.view());
    const auto d = difference.update(picture.view(), {}, current.view(), previous.view(), histogram);
    area.update({.picture = picture.view(),
                 .motion = {},
                 .still = true,
                 .current = current.view(),
                 .previous = previous.view(),
                 .histogram = &histogram,
                 .frames = d.frames},
                mask.view());
    if (k < 4) continue;
    // With the bright part's noise, or the mean of both, the block would be none; with the dark part's, one pixel in
    // fifty of the bright part would move.
    const int left = left_of_block(k), top = kBlockTop;
    ck_assert_int_ge(count(mask.view(), left, top, left + kBlock, top + kBlock), kBlock * kBlock * 3 / 4);
    ck_assert_int_le(count(mask.view(), kEdge, 0, kSize.width, kSize.height),
                     (kSize.width - kEdge) * kSize.height / 100);
  }
}
END_TEST

int main() {
  return run_suite("scene_memory", {what_is_faint_is_seen_in_the_dark_and_noise_is_not_in_the_bright});
}
