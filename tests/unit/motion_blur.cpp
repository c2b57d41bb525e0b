// SPDX-License-Identifier: LGPL-2.1-or-later
// Blurred edges are no foreground; objects that move in a blurred frame are.
#include "vision/background/motion_blur.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "support/allocations.h"
#include "support/area.h"
#include "support/masks.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr Size kSize{320, 240};

// A street with hard edges: dark with bright marks, 2 to 5 pixels wide, and posts.
Image<std::uint8_t> street(std::uint32_t seed) {
  std::mt19937 random(seed);
  Image<std::uint8_t> out(kSize);
  out.fill_bytes(90);
  const auto v = out.view();
  for (int i = 0; i < 60; ++i) {
    const int x = static_cast<int>(random() % 300), y = static_cast<int>(random() % 200);
    const int w = 2 + static_cast<int>(random() % 20), h = 2 + static_cast<int>(random() % 30);
    const auto grey = static_cast<std::uint8_t>(random() % 2 ? 30 : 190);
    for (int b = y; b < std::min(y + h, kSize.height); ++b)
      for (int a = x; a < std::min(x + w, kSize.width); ++a) v.at(a, b) = grey;
  }
  return out;
}

// Seen while the camera moves from (0, 0) to (dx, dy): the mean along the way.
Image<std::uint8_t> blurred(const Image<std::uint8_t>& picture, double dx, double dy) {
  const auto in = picture.view();
  Image<std::uint8_t> out(kSize);
  constexpr int kSteps = 24;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      int sum = 0;
      for (int k = 0; k < kSteps; ++k) {
        const double along = (k + 0.5) / kSteps - 0.5;
        sum += in.at(std::clamp(static_cast<int>(std::lround(x + along * dx)), 0, kSize.width - 1),
                     std::clamp(static_cast<int>(std::lround(y + along * dy)), 0, kSize.height - 1));
      }
      out.view().at(x, y) = static_cast<std::uint8_t>((sum + kSteps / 2) / kSteps);
    }
  return out;
}

Image<std::uint8_t> with_noise(const Image<std::uint8_t>& picture, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  Image<std::uint8_t> out(kSize);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      out.view().at(x, y) = to_byte(picture.view().at(x, y) + normal(random));
  return out;
}

void put(Image<std::uint8_t>& picture, const Square& s, std::uint8_t grey) {
  for (int y = 0; y < s.side; ++y)
    for (int x = 0; x < s.side; ++x)
      picture.view().at(static_cast<int>(s.x) + x, static_cast<int>(s.y) + y) = grey;
}

struct Blur {
  MotionBlur blur;
  Image<std::uint8_t> age{kSize};
  std::vector<RowSpan> spans{static_cast<std::size_t>(kSize.height), RowSpan{0, kSize.width}};
  Blur() {
    blur.preallocate(kSize);
    age.fill_bytes(10);
  }
  double sharpness(const Image<std::uint8_t>& frame, const Image<std::uint8_t>& memory) {
    return blur.sharpness(frame.view(), memory.view(), age.view(), spans);
  }
};

}  // namespace

START_TEST(sharpness_is_below_one_in_a_blurred_frame_and_above_one_over_a_blurred_background) {
  Blur b;
  const auto sharp = street(1), soft = blurred(sharp, 10, 4);
  ck_assert_double_eq_tol(b.sharpness(sharp, sharp), 1, 1e-9);
  const double less = b.sharpness(soft, sharp), more = b.sharpness(sharp, soft);
  ck_assert_double_lt(less, 0.6);
  ck_assert_double_eq_tol(less * more, 1, 0.1);
  // Pixels without age are not compared; a blank wall has too little texture.
  b.age.fill_bytes(0);
  ck_assert_double_eq(b.sharpness(soft, sharp), 1);
  b.age.fill_bytes(10);
  Image<std::uint8_t> blank(kSize);
  blank.fill_bytes(80);
  ck_assert_double_eq(b.sharpness(blank, blank), 1);
}
END_TEST

// A lively object before a third of the street is not blur.
START_TEST(moving_objects_do_not_affect_the_sharpness) {
  Blur b;
  const auto scene = street(2);
  auto frame = street(2);
  const auto other = blurred(street(3), 14, 0);
  for (int y = 60; y < 200; ++y)
    for (int x = 100; x < 260; ++x) frame.view().at(x, y) = other.view().at(x, y);
  ck_assert_double_eq_tol(b.sharpness(frame, scene), 1, 0.02);
}
END_TEST

START_TEST(pixels_that_blur_explains_are_suppressed_and_no_others) {
  Blur b;
  const auto sharp = street(4);
  auto soft = blurred(sharp, 12, 5);
  const Square person{150, 100, 24};
  put(soft, person, 250);
  BitMask bits(bit_mask_size(kSize)), inner(bit_mask_size(kSize));
  const auto differ = [&](int least, MutableBitView out) {
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        if (std::abs(soft.view().at(x, y) - sharp.view().at(x, y)) > least) set_bits(out.row(y), x, x + 1);
  };
  bits.fill_bytes(0), inner.fill_bytes(0);
  differ(6, bits.view()), differ(20, inner.view());
  ck_assert_int_gt(count(bits.view()), 3000);
  std::array<std::uint8_t, kBrightness> tolerance;
  tolerance.fill(6);
  b.blur.suppress(soft.view(), sharp.view(), tolerance, bits.view(), inner.view());
  // All of the person is left in both masks, and nothing else.
  ck_assert_int_eq(count(bits.view()), person.side * person.side);
  ck_assert_int_eq(count(inner.view()), person.side * person.side);
  for (int y = 100; y < 124; ++y)
    for (int x = 150; x < 174; ++x) ck_assert(bits.view().row(y)[x / 64] >> (x % 64) & 1);
}
END_TEST

// A darker one is outside the range as well, and noise within the tolerance is not.
START_TEST(the_range_has_two_ends_and_a_tolerance_by_brightness) {
  Blur b;
  Image<std::uint8_t> sharp(kSize), soft(kSize);
  sharp.fill_bytes(100), soft.fill_bytes(100);
  const auto v = soft.view();
  v.at(10, 10) = 107, v.at(20, 10) = 93, v.at(30, 10) = 106, v.at(40, 10) = 94;
  sharp.view().at(300, 200) = 200;
  v.at(300 - 8, 200) = 206, v.at(300, 200 + 8) = 160,
                v.at(300 - 9, 200) = 160;  // 8 pixels are drawn together
  BitMask bits(bit_mask_size(kSize)), inner(bit_mask_size(kSize));
  for (auto* mask : {&bits, &inner})
    for (int y = 0; y < kSize.height; ++y) {
      std::fill_n(mask->view().row(y), mask->view().width, 0);
      set_bits(mask->view().row(y), 0, kSize.width);
    }
  std::array<std::uint8_t, kBrightness> tolerance{};
  tolerance[100 / 16] = 6, tolerance[200 / 16] = 0;
  b.blur.suppress(v, sharp.view(), tolerance, bits.view(), inner.view());
  const auto left = [&](int x, int y) { return bits.view().row(y)[x / 64] >> (x % 64) & 1; };
  ck_assert_int_eq(count(bits.view()), 3);
  ck_assert(left(10, 10) && left(20, 10) && left(300 - 9, 200));
  ck_assert_int_eq(count(inner.view()), 3);
}
END_TEST

// The whole chain with a shaking camera. Every third frame is blurred; first after 20 sharp ones, then from the second
// on.
START_TEST(blurred_frames_have_no_foreground_but_moving_objects) {
  for (const int first : {20, 1}) {
    const auto scene = street(5);
    AreaChain chain(kSize);
    long wrong = 0, seen = 0;
    int frames = 0;
    for (int k = 0; k < 40; ++k) {
      auto frame = k >= first && k % 3 == 1 ? blurred(scene, 11, 6) : blurred(scene, 0, 0);
      const Square person{20.0 + 4 * k, 100, 24};
      put(frame, person, 250);
      const auto noisy = with_noise(frame, static_cast<std::uint32_t>(k));
      chain.feed(noisy.view(), Transform::translation(0.01, 0), false);
      if (k < 4) continue;
      ++frames;
      for (int y = 0; y < kSize.height; ++y)
        for (int x = 0; x < kSize.width; ++x) {
          if (!chain.mask.view().at(x, y)) continue;
          const bool near = x > person.x - 20 && x < person.x + 44 && y > 80 && y < 144;
          wrong += !near, seen += near;
        }
    }
    ck_assert_msg(wrong < 20L * frames, "from frame %d on: %ld pixels of %d frames belong to no person",
                  first, wrong, frames);
    ck_assert_int_gt(seen, frames * 24 * 24 * 2 / 3);
  }
}
END_TEST

START_TEST(nothing_is_allocated) {
  Blur b;
  const auto sharp = street(6), soft = blurred(sharp, 12, 5);
  BitMask bits(bit_mask_size(kSize)), inner(bit_mask_size(kSize));
  bits.fill_bytes(255), inner.fill_bytes(255);
  std::array<std::uint8_t, kBrightness> tolerance{};
  const std::size_t before = allocations();
  b.sharpness(soft, sharp);
  b.blur.suppress(soft.view(), sharp.view(), tolerance, bits.view(), inner.view());
  ck_assert_uint_eq(allocations() - before, 0);
  ck_assert_uint_gt(b.blur.bytes(), 2 * 320);
}
END_TEST

int main() {
  return run_suite(
      "motion_blur",
      {sharpness_is_below_one_in_a_blurred_frame_and_above_one_over_a_blurred_background,
       moving_objects_do_not_affect_the_sharpness, pixels_that_blur_explains_are_suppressed_and_no_others,
       the_range_has_two_ends_and_a_tolerance_by_brightness,
       blurred_frames_have_no_foreground_but_moving_objects, nothing_is_allocated});
}
