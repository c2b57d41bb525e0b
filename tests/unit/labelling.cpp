// SPDX-License-Identifier: LGPL-2.1-or-later
// Labelling against a flood fill that shares no line with it, and against pictures small enough to count by
// hand.
#include "vision/image/labelling.h"

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "support/allocations.h"
#include "support/masks.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

using Gray = Image<std::uint8_t>;

std::span<const Component> find(Labeller& labeller, Gray& mask, std::uint32_t least = 1) {
  BitMask bits = packed(mask.view());
  const auto found = labeller.find(bits.view(), mask.size().width, least);
  unpack(bits.view(), mask.view());
  return found;
}

constexpr Labeller::Limits kAll{65535, 65535};

// Reference: flood fill with an explicit stack, one component after another in reading order.
std::vector<Component> flood(GrayView mask, std::vector<int>& labels) {
  std::vector<Component> found;
  labels.assign(static_cast<std::size_t>(mask.width) * mask.height, 0);
  std::vector<std::pair<int, int>> stack;
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) {
      if (mask.at(x, y) == 0 || labels[static_cast<std::size_t>(y) * mask.width + x] != 0) continue;
      Component c{x, y, x + 1, y + 1, 0};
      const int label = static_cast<int>(found.size()) + 1;
      labels[static_cast<std::size_t>(y) * mask.width + x] = label;
      stack.push_back({x, y});
      while (!stack.empty()) {
        const auto [px, py] = stack.back();
        stack.pop_back();
        ++c.area;
        c.left = std::min(c.left, px);
        c.right = std::max(c.right, px + 1);
        c.top = std::min(c.top, py);
        c.bottom = std::max(c.bottom, py + 1);
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            const int qx = px + dx, qy = py + dy;
            if (qx < 0 || qy < 0 || qx >= mask.width || qy >= mask.height || mask.at(qx, qy) == 0) continue;
            int& l = labels[static_cast<std::size_t>(qy) * mask.width + qx];
            if (l == 0) {
              l = label;
              stack.push_back({qx, qy});
            }
          }
      }
      found.push_back(c);
    }
  return found;
}

// Components of fewer than `least` pixels are gone from everywhere.
void compare_with_flood(Gray mask, std::uint32_t least = 1) {
  std::vector<int> labels;
  std::vector<Component> expected = flood(mask.view(), labels);
  std::vector<int> number(expected.size() + 1, 0);
  Labeller labeller(kAll);
  const auto components = find(labeller, mask, least);
  int kept = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (expected[i].area < least) continue;
    number[i + 1] = ++kept;
    ck_assert_uint_ge(components.size(), kept);
    const Component& c = components[kept - 1];
    ck_assert_int_eq(c.left, expected[i].left);
    ck_assert_int_eq(c.right, expected[i].right);
    ck_assert_int_eq(c.top, expected[i].top);
    ck_assert_int_eq(c.bottom, expected[i].bottom);
    ck_assert_uint_eq(c.area, expected[i].area);
  }
  ck_assert_uint_eq(components.size(), kept);
  const Size size = mask.size();
  Image<std::uint16_t> written(size);
  written.fill_bytes(0xff);  // old contents must not shine through
  labeller.write(written.view());
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const int wanted = number[labels[static_cast<std::size_t>(y) * size.width + x]];
      ck_assert_int_eq(written.view().at(x, y), wanted);
      ck_assert_int_eq(mask.view().at(x, y), wanted ? 255 : 0);
    }
}

}  // namespace

START_TEST(an_empty_mask_has_no_components) {
  Gray mask({37, 5}), none;
  Labeller labeller;
  ck_assert_uint_eq(find(labeller, mask).size(), 0);
  ck_assert_uint_eq(find(labeller, none).size(), 0);
}
END_TEST

START_TEST(two_shapes_have_the_box_and_area_counted_by_hand) {
  auto mask = drawn({
      "..........",
      ".##.....#.",
      ".##....#..",
      "......#...",
  });
  Labeller labeller;
  const auto found = find(labeller, mask);
  ck_assert_uint_eq(found.size(), 2);
  ck_assert_int_eq(found[0].left, 1);
  ck_assert_int_eq(found[0].top, 1);
  ck_assert_int_eq(found[0].right, 3);
  ck_assert_int_eq(found[0].bottom, 3);
  ck_assert_uint_eq(found[0].area, 4);
  // A diagonal is one component (8-connected).
  ck_assert_uint_eq(found[1].area, 3);
  ck_assert_int_eq(found[1].left, 6);
  ck_assert_int_eq(found[1].right, 9);
  ck_assert_int_eq(found[1].bottom, 4);
}
END_TEST

START_TEST(arms_that_meet_late_are_one_component_with_the_earliest_label) {
  auto mask = drawn({
      "#.#.#...#",
      "#.#.#....",
      "#.#.#..#.",
      "#########",
  });
  Labeller labeller;
  const auto found = find(labeller, mask);
  ck_assert_uint_eq(found.size(), 2);
  ck_assert_uint_eq(found[0].area, 19);
  ck_assert_uint_eq(found[1].area, 1);
  ck_assert_int_eq(found[1].left, 8);
}
END_TEST

START_TEST(random_masks_of_odd_sizes_agree_with_the_flood_fill) {
  std::mt19937 random(20);
  const Size sizes[] = {{1, 1},   {1, 9},  {7, 1},   {8, 8},    {63, 3},
                        {31, 17}, {64, 5}, {65, 33}, {130, 70}, {192, 9}};
  for (const Size size : sizes)
    for (const int percent : {3, 20, 40, 60, 97, 100})
      for (const std::uint32_t least : {1u, 2u, 9u})
        compare_with_flood(random_mask(size, percent, random), least);
}
END_TEST

START_TEST(a_picture_cut_into_too_many_runs_loses_its_thin_parts_only) {
  // Stripes of one column everywhere, and a block of 39 x 30: 160 runs a row where there is room for 10.
  Gray mask({320, 240});
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) {
      const bool block = x >= 101 && x < 140 && y >= 50 && y < 80;
      mask.view().at(x, y) = block || x % 2 ? 255 : 0;
    }
  Labeller labeller;
  const auto found = find(labeller, mask);
  ck_assert_uint_eq(found.size(), 1);
  ck_assert_int_eq(found[0].left, 101);
  ck_assert_int_eq(found[0].right, 140);
  ck_assert_int_eq(found[0].top, 50);
  ck_assert_int_eq(found[0].bottom, 80);
  ck_assert_uint_eq(found[0].area, 1170);
  ck_assert_int_eq(mask.view().at(120, 60), 255);
  ck_assert_int_eq(mask.view().at(11, 60), 0);
  // Even where nothing is thin: as many runs as rows, in a narrow picture.
  Gray narrow({8, 2000});
  narrow.fill_bytes(0xff);
  ck_assert_uint_eq(find(labeller, narrow).size(), 1);
}
END_TEST

START_TEST(too_many_components_lose_the_small_ones_first) {
  // 32 x 24 specks of 2 x 2 where there is room for 300 components, and three blocks of 8 x 8 among them.
  Gray mask({320, 240});
  const auto fill = [&](int left, int top, int side) {
    for (int y = top; y < top + side; ++y)
      for (int x = left; x < left + side; ++x) mask.view().at(x, y) = 255;
  };
  for (int j = 0; j < 24; ++j)
    for (int i = 0; i < 32; ++i) fill(10 * i, 10 * j, i == j && i < 3 ? 8 : 2);
  Labeller labeller;
  const auto found = find(labeller, mask);
  ck_assert_uint_eq(found.size(), 3);
  for (int i = 0; i < 3; ++i) ck_assert_int_eq(found[i].left, 10 * i);
  ck_assert_int_eq(mask.view().at(100, 0), 0);
  // With room for all of them all are there.
  for (int j = 0; j < 24; ++j)
    for (int i = 0; i < 32; ++i) fill(10 * i, 10 * j, 2);
  Labeller roomy(kAll);
  ck_assert_uint_eq(find(roomy, mask).size(), 768);
}
END_TEST

START_TEST(no_picture_of_a_size_that_was_seen_takes_memory) {
  std::mt19937 random(3);
  const Size size{320, 240};
  Labeller labeller;
  BitMask bits(bit_mask_size(size));
  labeller.find(bits.view(), size.width);
  const std::size_t before = cerberus::tests::allocations(), bytes = labeller.bytes();
  for (int percent = 0; percent <= 100; percent += 5) {
    for (int y = 0; y < size.height; ++y)
      for (int i = 0; i < bits.size().width; ++i)
        for (int b = 0; b < 64; ++b) {
          const std::uint64_t bit = std::uint64_t{1} << b;
          bits.view().row(y)[i] &= ~bit;
          if (static_cast<int>(random() % 100) < percent) bits.view().row(y)[i] |= bit;
        }
    labeller.find(bits.view(), size.width);
  }
  ck_assert_uint_eq(cerberus::tests::allocations(), before);
  ck_assert_uint_eq(labeller.bytes(), bytes);
  ck_assert_uint_lt(bytes, size.area() / 2);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "labelling",
      {an_empty_mask_has_no_components, two_shapes_have_the_box_and_area_counted_by_hand,
       arms_that_meet_late_are_one_component_with_the_earliest_label,
       random_masks_of_odd_sizes_agree_with_the_flood_fill,
       a_picture_cut_into_too_many_runs_loses_its_thin_parts_only,
       too_many_components_lose_the_small_ones_first, no_picture_of_a_size_that_was_seen_takes_memory});
}
