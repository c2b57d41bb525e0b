// SPDX-License-Identifier: LGPL-2.1-or-later
// Masks of bits and their morphology against the definitions and hand-made pictures.
#include "vision/image/morphology.h"

#include <check.h>

#include <random>
#include <vector>

#include "support/allocations.h"
#include "support/masks.h"
#include "support/pictures.h"
#include "support/targets.h"
#include "support/wrong.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

const std::vector<Size> kSizes{{1, 1},   {2, 3},   {33, 35},  {63, 9}, {64, 8},
                               {65, 17}, {127, 5}, {130, 40}, {1, 50}, {200, 1}};

Image<std::uint8_t> random_mask(Size size, unsigned percent, unsigned seed) {
  std::mt19937 random(seed);
  return cerberus::tests::random_mask(size, percent, random);
}

void assert_same(BitView bits, GrayView expected) {
  Image<std::uint8_t> got(expected.size());
  unpack(bits, got.view());
  Wrong pixels, beyond;
  for (int y = 0; y < expected.height; ++y) {
    for (int x = 0; x < expected.width; ++x)
      pixels.unless(got.view().at(x, y) == (expected.at(x, y) ? 255 : 0), x, y);
    beyond.unless((bits.row(y)[bits.width - 1] & ~last_word_bits(expected.width)) == 0, expected.width, y);
  }
  pixels.assert_none("mask");
  beyond.assert_none("bits beyond the width");
}

}  // namespace

START_TEST(a_mask_survives_packing_at_every_size) {
  for (const Size size : kSizes) {
    const auto mask = random_mask(size, 50, 3);
    const auto bits = packed(mask.view());
    assert_same(bits.view(), mask.view());
    long set = 0;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) set += mask.view().at(x, y) != 0;
    ck_assert_int_eq(count(bits.view()), set);
  }
}
END_TEST

// Bit by bit, with nothing readable or writable beyond the picture.
START_TEST(masks_are_spread_and_packed_as_they_are_defined) {
  std::mt19937 random(7);
  for (const Size size : kSizes) {
    const GuardedPicture picture(size), back(size);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) picture.view().at(x, y) = static_cast<std::uint8_t>(random());
    BitMask bits(bit_mask_size(size));
    binarise(picture.view(), 127, bits.view());
    unpack(bits.view(), back.view());
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < 64 * bits.view().width; ++x) {
        const bool in = x < size.width && picture.view().at(x, y) > 127;
        ck_assert_int_eq(bits.view().at(x / 64, y) >> (x % 64) & 1, in);
        if (x < size.width) ck_assert_int_eq(back.view().at(x, y), in ? 255 : 0);
      }
  }
}
END_TEST

START_TEST(binarise_is_strictly_above_the_threshold) {
  Image<std::uint8_t> d({67, 1});
  for (int x = 0; x < 67; ++x) d.view().at(x, 0) = static_cast<std::uint8_t>(x * 3);
  BitMask bits(bit_mask_size(d.size()));
  binarise(d.view(), 30, bits.view());  // Eq. 3: 30 is 0, 33 is 1
  for (int x = 0; x < 67; ++x) ck_assert_int_eq(bits.view().at(x / 64, 0) >> (x % 64) & 1, x > 10);
  binarise(d.view(), 255, bits.view());
  ck_assert_int_eq(count(bits.view()), 0);
}
END_TEST

START_TEST(set_algebra_follows_the_three_frames) {
  // One row: D(k) holds what moved from k-1 to k, D(k-1) from k-2 to k-1.
  const auto now = packed(drawn({"..###.##"}).view()), before = packed(drawn({".###...#"}).view());
  BitMask out(now.size());
  intersect(now.view(), before.view(), out.view());  // M(k-1)
  assert_same(out.view(), drawn({"..##...#"}).view());
  subtract(now.view(), out.view(), out.view());  // M(k) = D(k) - M(k-1), in place
  assert_same(out.view(), drawn({"....#.#."}).view());
  unite(now.view(), before.view(), out.view());
  assert_same(out.view(), drawn({".####.##"}).view());
}
END_TEST

START_TEST(dilation_and_erosion_agree_with_the_definition) {
  Morphology morphology;
  for (const Size size : kSizes)
    for (const int side : {1, 2, 3, 5, 11, 12, 31, 141}) {
      const auto mask = random_mask(size, side < 4 ? 40 : 5, static_cast<unsigned>(side));
      Image<std::uint8_t> expected(size);
      auto bits = packed(mask.view());
      morphology.dilate(bits.view(), size.width, side);
      dilate_reference(mask.view(), side, expected.view());
      assert_same(bits.view(), expected.view());
      const auto dense = random_mask(size, side < 4 ? 60 : 96, static_cast<unsigned>(side) + 1);
      bits = packed(dense.view());
      morphology.erode(bits.view(), size.width, side);
      erode_reference(dense.view(), side, expected.view());
      assert_same(bits.view(), expected.view());
    }
}
END_TEST

START_TEST(closing_fills_gaps_and_opening_drops_specks) {
  Morphology morphology;
  auto mask = packed(drawn({"#..#....", "........", "........", "........"}).view());
  morphology.close(mask.view(), 8, 3);  // a gap of two is closed, and the border neither adds nor takes
  assert_same(mask.view(), drawn({"####....", "........", "........", "........"}).view());
  mask = packed(drawn({"###.....", "###..#..", "###....."}).view());
  morphology.open(mask.view(), 8, 3);
  assert_same(mask.view(), drawn({"###.....", "###.....", "###....."}).view());
}
END_TEST

START_TEST(closing_never_removes_and_opening_never_adds) {
  Morphology morphology;
  for (const Size size : kSizes) {
    const auto mask = packed(random_mask(size, 30, 9).view());
    BitMask closed(mask.size()), opened(mask.size()), both(mask.size());
    unite(mask.view(), mask.view(), closed.view());
    unite(mask.view(), mask.view(), opened.view());
    morphology.close(closed.view(), size.width, 7);
    morphology.open(opened.view(), size.width, 3);
    subtract(mask.view(), closed.view(), both.view());
    ck_assert_int_eq(count(both.view()), 0);
    subtract(opened.view(), mask.view(), both.view());
    ck_assert_int_eq(count(both.view()), 0);
  }
}
END_TEST

START_TEST(vote_counts_the_neighbourhood) {
  Morphology morphology;
  for (const Size size : kSizes)
    for (const int least : {1, 4, 5, 9}) {
      const auto mask = random_mask(size, 60, 21);
      auto bits = packed(mask.view());
      morphology.vote(bits.view(), size.width, least);
      Image<std::uint8_t> expected(size);
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
          int n = 0;
          for (int v = std::max(y - 1, 0); v <= std::min(y + 1, size.height - 1); ++v)
            for (int u = std::max(x - 1, 0); u <= std::min(x + 1, size.width - 1); ++u)
              n += mask.view().at(u, v) != 0;
          expected.view().at(x, y) = mask.view().at(x, y) && n >= least ? 255 : 0;
        }
      assert_same(bits.view(), expected.view());
    }
}
END_TEST

START_TEST(reconstruction_keeps_the_parts_that_hold_a_seed) {
  const auto within = drawn({"##..###.", "..#...#.", "#..##.#.", "#.....#."});
  auto seeds = packed(drawn({"........", "........", "...#....", ".......#"}).view());
  Morphology morphology;
  morphology.reconstruct(seeds.view(), packed(within.view()).view());
  // 8-connected: (3,2)-(2,1)-(1,0); the seed outside `within` counts for nothing.
  assert_same(seeds.view(), drawn({"##......", "..#.....", "...##...", "........"}).view());
}
END_TEST

START_TEST(reconstruction_agrees_with_flooding_on_random_pictures) {
  Morphology morphology;
  for (const Size size : kSizes)
    for (const int percent : {30, 45, 60}) {
      const auto within = random_mask(size, percent, 4);
      const auto seed = random_mask(size, 2, 5);
      auto bits = packed(seed.view());
      morphology.reconstruct(bits.view(), packed(within.view()).view());
      Image<std::uint8_t> expected(size);
      std::vector<std::pair<int, int>> open;
      const auto visit = [&](int x, int y) {
        if (x < 0 || y < 0 || x >= size.width || y >= size.height) return;
        if (!within.view().at(x, y) || expected.view().at(x, y)) return;
        expected.view().at(x, y) = 255;
        open.emplace_back(x, y);
      };
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
          if (seed.view().at(x, y)) visit(x, y);
      while (!open.empty()) {
        const auto [x, y] = open.back();
        open.pop_back();
        for (int v = -1; v <= 1; ++v)
          for (int u = -1; u <= 1; ++u) visit(x + u, y + v);
      }
      assert_same(bits.view(), expected.view());
    }
}
END_TEST

START_TEST(a_second_picture_of_the_same_size_allocates_nothing) {
  Morphology morphology;
  auto mask = packed(random_mask({320, 240}, 20, 1).view());
  const auto within = packed(random_mask({320, 240}, 50, 2).view());
  const auto work = [&] {
    morphology.close(mask.view(), 320, 11);
    morphology.open(mask.view(), 320, 5);
    morphology.vote(mask.view(), 320, 4);
    morphology.reconstruct(mask.view(), within.view());
  };
  work();
  const auto before = allocations();
  work();
  ck_assert_uint_eq(allocations(), before);
}
END_TEST

START_TEST(the_bits_of_a_word_and_of_a_row_of_words) {
  ck_assert_uint_eq(bits_between(0, 64), ~std::uint64_t{0});
  ck_assert_uint_eq(bits_between(0, 1), 1);
  ck_assert_uint_eq(bits_between(63, 64), std::uint64_t{1} << 63);
  ck_assert_uint_eq(bits_between(4, 7), 0x70);
  std::uint64_t row[3] = {};
  set_bits(row, 60, 130);
  ck_assert_uint_eq(row[0], std::uint64_t{0xf} << 60);
  ck_assert_uint_eq(row[1], ~std::uint64_t{0});
  ck_assert_uint_eq(row[2], 3);
}
END_TEST

int main() {
  return run_suite_on_every_target(
      "morphology",
      {the_bits_of_a_word_and_of_a_row_of_words, a_mask_survives_packing_at_every_size,
       masks_are_spread_and_packed_as_they_are_defined, binarise_is_strictly_above_the_threshold,
       set_algebra_follows_the_three_frames, dilation_and_erosion_agree_with_the_definition,
       closing_fills_gaps_and_opening_drops_specks, closing_never_removes_and_opening_never_adds,
       vote_counts_the_neighbourhood, reconstruction_keeps_the_parts_that_hold_a_seed,
       reconstruction_agrees_with_flooding_on_random_pictures,
       a_second_picture_of_the_same_size_allocates_nothing});
}
