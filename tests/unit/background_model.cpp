// SPDX-License-Identifier: LGPL-2.1-or-later
// Noise by brightness, because sensor noise grows with it; content that the camera turns back to.
#include "vision/background/background_model.h"

#include <random>

#include "support/area.h"
#include "support/suite.h"

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

START_TEST(a_faint_object_is_found_in_the_dark_and_bright_noise_is_not) {
  std::mt19937 random(9);
  Image<std::uint8_t> picture(kSize);
  AreaChain chain(kSize);
  for (int k = 0; k < 6; ++k) {
    expose(k, random, picture.view());
    chain.feed(picture.view());
    if (k < 4) continue;
    // With the bright part's noise, or the mean of both, the block would be none; with the dark part's, one pixel in
    // fifty of the bright part would move.
    const int left = left_of_block(k), top = kBlockTop;
    ck_assert_int_ge(count(chain.mask.view(), left, top, left + kBlock, top + kBlock),
                     kBlock * kBlock * 3 / 4);
    ck_assert_int_le(count(chain.mask.view(), kEdge, 0, kSize.width, kSize.height),
                     (kSize.width - kEdge) * kSize.height / 100);
  }
}
END_TEST

// A camera that turns to the right and back, twelve pixels a frame.
constexpr int kAway = 12, kTurn = 12;
int turned(int frame) {
  return kTurn * (frame <= kAway ? frame : 2 * kAway - frame);
}
struct Turn {
  // The picture of one frame, with a person in it from a given frame on.
  Turn(Size size, unsigned seed) : scene(31, 12), coat(32, 12), picture(size), chain(size), random(seed) {}
  // shade: taken from the grey levels of the scene's columns before `lit`.
  void feed(int frame, const Square* person, int shade = 0, int lit = 1000) {
    const int left = turned(frame);
    look(scene, Transform::translation(-left, 0), picture.view());
    if (person) draw(picture.view(), {person->x - left, person->y, person->side}, coat);
    for (int y = 0; y < picture.size().height; ++y)
      for (int x = 0; x < picture.size().width; ++x)
        if (x + left < lit) picture.view().at(x, y) = to_byte(picture.view().at(x, y) - shade);
    add_noise(picture.view(), 1, 3, random);
    chain.feed(picture.view(), Transform::translation(before - left, 0), false);
    before = left;
  }
  Scene scene, coat;
  Image<std::uint8_t> picture;
  AreaChain chain;
  std::mt19937 random;
  int before = 0;
};

START_TEST(a_person_is_found_at_once_when_the_camera_turns_back) {
  const Size size{160, 120};
  Turn turn(size, 5);
  Score score;
  for (int k = 0; k <= 2 * kAway; ++k) {
    // He came while the camera looked elsewhere, and walks on: here he is whole in the picture for the first and second
    // time.
    const Square square{40 + 2.0 * (k - 2 * kAway), 45, 28};
    turn.feed(k, k > kAway ? &square : nullptr);
    const double left = square.x - turned(k);
    if (k > kAway && left >= 0 && left < 30) score.add(turn.chain.mask.view(), {left, 45, 28});
  }
  ck_assert_double_gt(score.hit + score.missed, 28 * 28);
  ck_assert_double_gt(score.f(), 0.8);
}
END_TEST

START_TEST(a_camera_that_turns_back_reports_no_standing_object_as_motion) {
  const Size size{160, 120};
  for (const int shade : {0, 8, 30}) {
    Turn turn(size, 6);
    for (int k = 0; k <= 2 * kAway; ++k) {
      turn.feed(k, nullptr, k > kAway ? shade : 0);
      // The step itself may cost three frames.
      if (k > 2 && (k <= kAway || k > kAway + 3)) ck_assert_int_eq(turn.chain.moving(), 0);
    }
  }
}
END_TEST

START_TEST(shade_that_fell_out_of_view_is_no_motion) {
  const Size size{160, 120};
  Turn turn(size, 7);
  for (int k = 0; k <= 2 * kAway; ++k) {
    turn.feed(k, nullptr, k > kAway ? 30 : 0, turned(kAway));
    ck_assert_int_eq(turn.chain.moving(), 0);
  }
}
END_TEST

int main() {
  return run_suite("scene_memory", {a_faint_object_is_found_in_the_dark_and_bright_noise_is_not,
                                    a_person_is_found_at_once_when_the_camera_turns_back,
                                    a_camera_that_turns_back_reports_no_standing_object_as_motion,
                                    shade_that_fell_out_of_view_is_no_motion});
}
