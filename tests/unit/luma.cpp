// SPDX-License-Identifier: LGPL-2.1-or-later
// The luma reduction against its exact scalar reference, and the reference against hand computation.
#include "vision/image/luma/luma.h"

#include <check.h>

#include <bit>
#include <vector>

#include "support/allocations.h"
#include "support/pictures.h"
#include "support/targets.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

struct Layout {
  const char* name;
  int pixel_stride, first;
  bool rgb;
  int r, g, b;
  int word_shift = 0;
  bool swapped = false;
  int low = 0, span = 0;
};
constexpr Layout kLayouts[] = {{"planar", 1, 0, false, 0, 0, 0},
                               {"YUY2", 2, 0, false, 0, 0, 0},
                               {"UYVY", 2, 1, false, 0, 0, 0},
                               {"RGB", 3, 0, true, 0, 1, 2},
                               {"BGR", 3, 0, true, 2, 1, 0},
                               {"xRGB", 4, 0, true, 1, 2, 3},
                               {"BGRx", 4, 0, true, 2, 1, 0},
                               // Random words also hold more than 10 bits: they count as white.
                               {"P010", 2, 0, false, 0, 0, 0, 8},
                               {"P010 swapped", 2, 0, false, 0, 0, 0, 8, true},
                               {"10 bits", 2, 0, false, 0, 0, 0, 2},
                               {"12 bits swapped", 2, 0, false, 0, 0, 0, 4, true},
                               {"thermal", 2, 0, false, 0, 0, 0, 8, false, 28000, 3000},
                               {"thermal swapped", 2, 0, false, 0, 0, 0, 8, true, 0, 60000},
                               {"part of 10 bits", 2, 0, false, 0, 0, 0, 2, false, 300, 16},
                               {"the end of the range", 2, 0, false, 0, 0, 0, 8, false, 65000, 535}};

// Bytes from the first luma sample to the end of the frame, where the frame's last row has no padding.
std::size_t frame_bytes(const Layout& l, Size size, std::ptrdiff_t stride) {
  const int last = l.rgb ? std::max({l.r, l.g, l.b}) : l.word_shift > 0 ? 1 : 0;
  return static_cast<std::size_t>(stride * (size.height - 1) + (size.width - 1) * l.pixel_stride + last + 1);
}

// The last `bytes` before an unreadable page, all random. Filled once: that costs more than all the scaling.
const std::uint8_t* random_bytes(std::size_t bytes) {
  constexpr std::size_t kMost = 2 << 20;
  static const GuardedBytes memory(kMost);
  static const bool filled = [] {
    std::mt19937 random(7);
    for (std::size_t i = 0; i < kMost; ++i) memory.data()[i] = static_cast<std::uint8_t>(random());
    return true;
  }();
  ck_assert(filled);
  ck_assert_uint_le(bytes, kMost);
  return memory.data() + kMost - bytes;
}

// Scales random pixels whose last sample ends at an unreadable page, and returns the largest error.
int worst_error(const Layout& l, Size from, Size to, int padding) {
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(from.width) * l.pixel_stride + padding;
  const LumaSource source{random_bytes(frame_bytes(l, from, stride)),
                          from.width,
                          from.height,
                          stride,
                          l.pixel_stride,
                          l.rgb,
                          l.r,
                          l.g,
                          l.b,
                          l.word_shift,
                          l.swapped,
                          l.low,
                          l.span};
  const GuardedPicture fast(to, 5);
  Image<std::uint8_t> exact(to);
  LumaScaler().scale(source, fast.view());
  scale_luma_reference(source, exact.view());
  int worst = 0;
  for (int y = 0; y < to.height; ++y)
    for (int x = 0; x < to.width; ++x)
      worst = std::max(worst, std::abs(fast.view().at(x, y) - exact.view().at(x, y)));
  return worst;
}

}  // namespace

START_TEST(the_analysis_size_keeps_the_aspect_and_never_grows) {
  ck_assert(analysis_size({1920, 1080}, 320) == (Size{320, 180}));
  ck_assert(analysis_size({768, 576}, 320) == (Size{320, 240}));
  ck_assert(analysis_size({854, 480}, 320) == (Size{320, 180}));
  ck_assert(analysis_size({33, 35}, 320) == (Size{33, 35}));
  ck_assert(analysis_size({3840, 2160}, 0) == (Size{3840, 2160}));
  ck_assert(analysis_size({3840, 64}, 320) == (Size{320, 16}));  // at least 16 rows
  ck_assert(analysis_size({640, 8}, 320) == (Size{320, 8}));     // but never more than the frame has
}
END_TEST

START_TEST(what_is_analysed_has_at_most_3840_by_2160_pixels_and_3840_to_a_side) {
  ck_assert(analysis_size({7680, 4320}, 320) == (Size{320, 180}));
  ck_assert(analysis_size({7680, 4320}, 0) == (Size{3840, 2160}));
  ck_assert(analysis_size({2160, 3840}, 0) == (Size{2160, 3840}));
  ck_assert(analysis_size({4096, 2160}, 0) == (Size{3840, 2025}));
  ck_assert(analysis_size({4000, 3000}, 0) == (Size{3325, 2494}));  // sqrt(8294400 / 12 million) = .8314
  ck_assert(analysis_size({8192, 8192}, 0) == (Size{2880, 2880}));
  ck_assert(analysis_size({8192, 32}, 0) == (Size{3840, 16}));  // at least 16 rows
  ck_assert(analysis_size({32, 8192}, 0) == (Size{15, 3840}));
  ck_assert(analysis_size({64, 8192}, 60) == (Size{30, 3840}));
}
END_TEST

START_TEST(luma_of_words_is_their_upper_eight_bits_in_either_byte_order) {
  // 10 bits: 940 is nominal white, luma 235; 943 is cut off, not rounded; above 1023 there is nothing but white.
  const std::uint8_t low[] = {0xac, 0x03, 0xaf, 0x03, 0x00, 0x00, 0xff, 0x03, 0xff, 0xff};
  const std::uint8_t high[] = {0xeb, 0x00, 0xeb, 0xc0, 0x00,
                               0x00, 0xff, 0xc0, 0xff, 0xff};  // big-endian P010
  const int expected[] = {235, 235, 0, 255, 255};
  constexpr bool kBig = std::endian::native == std::endian::big;
  std::uint8_t from_low[5], from_high[5];
  LumaScaler().scale({low, 5, 1, 10, 2, false, 0, 0, 0, 2, kBig}, {from_low, 5, 1, 5});
  LumaScaler().scale({high, 5, 1, 10, 2, false, 0, 0, 0, 8, !kBig}, {from_high, 5, 1, 5});
  for (int x = 0; x < 5; ++x) {
    ck_assert_int_eq(from_low[x], expected[x]);
    ck_assert_int_eq(from_high[x], expected[x]);
  }
}
END_TEST

// 256 (word - low) / span: from 1000 on, 512 to 256 levels.
START_TEST(luma_between_two_values_fills_the_range_of_eight_bits) {
  const std::uint16_t words[] = {0, 1000, 1001, 1002, 1256, 1511, 1512, 65535};
  const int expected[] = {0, 0, 0, 1, 128, 255, 255, 255};
  std::uint8_t luma[8];
  LumaSource source{reinterpret_cast<const std::uint8_t*>(words), 8, 1, 16, 2};
  source.word_shift = 8, source.low = 1000, source.span = 512;
  LumaScaler().scale(source, {luma, 8, 1, 8});
  for (int x = 0; x < 8; ++x) ck_assert_int_eq(luma[x], expected[x]);
}
END_TEST

START_TEST(the_largest_frame_is_reduced_without_an_overflow) {
  // 8192 x 8192 white RGBx: the largest sums there are. One row, seen 8192 times.
  const std::vector<std::uint8_t> row(8192 * 4, 255);
  for (const Size size : {Size{320, 320}, Size{48, 48}, Size{2880, 2880}}) {
    Image<std::uint8_t> out(size);
    LumaScaler().scale({row.data(), 8192, 8192, 0, 4, true, 2, 1, 0}, out.view());
    for (int y = 0; y < size.height; y += 7)
      for (int x = 0; x < size.width; x += 7) ck_assert_int_eq(out.view().at(x, y), 255);
  }
}
END_TEST

START_TEST(the_reference_is_the_area_average_computed_by_hand) {
  // 3 x 2 to 2 x 1: the left target pixel sees columns 0 and half of 1.
  const std::uint8_t pixels[] = {10, 20, 30,  //
                                 40, 60, 100};
  std::uint8_t out[2];
  scale_luma_reference({pixels, 3, 2, 3}, {out, 2, 1, 2});
  ck_assert_int_eq(out[0], 30);  // (10 + 40 + (20 + 60) / 2) / 3
  ck_assert_int_eq(out[1], 57);  // (30 + 100 + (20 + 60) / 2) / 3 = 56.67
}
END_TEST

START_TEST(luma_of_rgb_has_the_weights_of_bt_601) {
  const std::uint8_t pixels[] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
  std::uint8_t out[4];
  LumaScaler().scale({pixels, 4, 1, 12, 3, true, 0, 1, 2}, {out, 4, 1, 4});
  ck_assert_int_eq(out[0], 77);   // .299 * 255 = 76.2; in 256ths 76.7
  ck_assert_int_eq(out[1], 149);  // .587 * 255 = 149.7; 149.4
  ck_assert_int_eq(out[2], 29);   // .114 * 255 = 29.1; 28.9
  ck_assert_int_eq(out[3], 255);
}
END_TEST

START_TEST(every_layout_is_within_one_level_of_the_reference_and_inside_its_memory) {
  const Size sizes[][2] = {{{640, 360}, {320, 180}}, {{768, 576}, {320, 240}}, {{854, 480}, {320, 180}},
                           {{33, 35}, {20, 21}},     {{33, 35}, {32, 34}},     {{17, 3}, {16, 1}},
                           {{1, 9}, {1, 2}},         {{9, 1}, {4, 1}},         {{100, 2000}, {16, 16}},
                           {{1280, 16}, {32, 16}},   {{641, 361}, {640, 360}}, {{7, 5}, {1, 1}}};
  for (const Layout& layout : kLayouts)
    for (const auto& [from, to] : sizes)
      for (const int padding : {0, 3, 20000}) {
        if (padding > 3 && from.height > 40) continue;  // megabytes, for the same arithmetic
        const int worst = worst_error(layout, from, to, padding);
        ck_assert_msg(worst <= 1, "%s %dx%d to %dx%d: %d levels off", layout.name, from.width, from.height,
                      to.width, to.height, worst);
      }
}
END_TEST

START_TEST(ratios_beyond_the_vertical_sums_use_the_reference) {
  ck_assert_int_eq(worst_error(kLayouts[0], {3, 1300}, {2, 3}, 0), 0);
}
END_TEST

START_TEST(the_frames_own_size_is_a_plain_copy) {
  for (const Layout& layout : kLayouts)
    for (const Size size : {Size{1, 1}, Size{33, 35}, Size{320, 240}})
      ck_assert_int_eq(worst_error(layout, size, size, 2), 0);
}
END_TEST

START_TEST(a_constant_picture_stays_what_it_is) {
  for (int level = 0; level < 256; ++level) {
    const std::vector<std::uint8_t> pixels(97 * 61, static_cast<std::uint8_t>(level));
    for (const Size size : {Size{96, 60}, Size{40, 25}, Size{7, 3}}) {
      Image<std::uint8_t> out(size);
      LumaScaler().scale({pixels.data(), 97, 61, 97}, out.view());
      long other = 0;  // counted: an assertion for each pixel costs more than the scaling
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) other += out.view().at(x, y) != level;
      ck_assert_int_eq(other, 0);
    }
  }
}
END_TEST

START_TEST(a_picture_may_stand_on_its_head) {
  std::mt19937 random(4);
  Image<std::uint8_t> pixels({64, 40}), down({16, 10}), up({16, 10});
  fill_random(pixels.view(), random);
  LumaScaler scaler;
  const View<std::uint8_t> v = pixels.view();
  scaler.scale({v.data, 64, 40, v.stride}, down.view());
  scaler.scale({v.row(39), 64, 40, -v.stride}, up.view());
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 16; ++x) ck_assert_int_le(std::abs(up.view().at(x, y) - down.view().at(x, 9 - y)), 1);
}
END_TEST

START_TEST(the_steady_state_allocates_nothing_and_a_new_size_is_followed) {
  const std::vector<std::uint8_t> pixels(640 * 480, 50);
  Image<std::uint8_t> out({320, 240}), small({160, 120});
  LumaScaler scaler;
  scaler.scale({pixels.data(), 640, 480, 640}, out.view());
  const std::size_t before = allocations();
  for (int i = 0; i < 5; ++i) scaler.scale({pixels.data(), 640, 480, 640}, out.view());
  ck_assert_uint_eq(allocations() - before, 0);
  scaler.scale({pixels.data(), 320, 240, 1280}, small.view());
  ck_assert_int_eq(small.view().at(159, 119), 50);
  scaler.scale({pixels.data(), 0, 0, 0}, small.view());  // nothing to see: nothing done
  scaler.scale({pixels.data(), 640, 480, 640}, {});
}
END_TEST

int main() {
  return run_suite_on_every_target(
      "luma", {the_analysis_size_keeps_the_aspect_and_never_grows,
               what_is_analysed_has_at_most_3840_by_2160_pixels_and_3840_to_a_side,
               luma_of_words_is_their_upper_eight_bits_in_either_byte_order,
               luma_between_two_values_fills_the_range_of_eight_bits,
               the_largest_frame_is_reduced_without_an_overflow,
               the_reference_is_the_area_average_computed_by_hand, luma_of_rgb_has_the_weights_of_bt_601,
               every_layout_is_within_one_level_of_the_reference_and_inside_its_memory,
               ratios_beyond_the_vertical_sums_use_the_reference, the_frames_own_size_is_a_plain_copy,
               a_constant_picture_stays_what_it_is, a_picture_may_stand_on_its_head,
               the_steady_state_allocates_nothing_and_a_new_size_is_followed});
}
