// SPDX-License-Identifier: LGPL-2.1-or-later
// Labelling against a flood fill that shares no line with it, and against pictures small enough to count by
// hand.
#include "vision/labelling.h"

#include <check.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <utility>
#include <vector>

using namespace cerberus::vision;

namespace {

// '#' moves; rows must have equal lengths.
Image<std::uint8_t> draw(const std::vector<std::string>& rows) {
  Image<std::uint8_t> mask({static_cast<int>(rows[0].size()), static_cast<int>(rows.size())});
  for (std::size_t y = 0; y < rows.size(); ++y)
    for (std::size_t x = 0; x < rows[y].size(); ++x)
      mask.view().at(static_cast<int>(x), static_cast<int>(y)) = rows[y][x] == '#' ? 255 : 0;
  return mask;
}

// Reference: flood fill with an explicit stack, one component after another in reading order.
std::vector<Component> flood(GrayView mask, std::vector<int>& labels) {
  std::vector<Component> found;
  labels.assign(static_cast<std::size_t>(mask.width) * mask.height, 0);
  std::vector<std::pair<int, int>> stack;
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) {
      if (mask.at(x, y) == 0 || labels[static_cast<std::size_t>(y) * mask.width + x] != 0) continue;
      Component c{x, y, x + 1, y + 1, 0, 0, 0};
      const int label = static_cast<int>(found.size()) + 1;
      labels[static_cast<std::size_t>(y) * mask.width + x] = label;
      stack.push_back({x, y});
      while (!stack.empty()) {
        const auto [px, py] = stack.back();
        stack.pop_back();
        ++c.area;
        c.sum_x += px;
        c.sum_y += py;
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

void compare_with_flood(GrayView mask) {
  std::vector<int> expected;
  const std::vector<Component> reference = flood(mask, expected);
  Labeller labeller;
  const auto components = labeller.find(mask);
  ck_assert_uint_eq(components.size(), reference.size());
  for (std::size_t i = 0; i < reference.size(); ++i) {
    ck_assert_int_eq(components[i].left, reference[i].left);
    ck_assert_int_eq(components[i].right, reference[i].right);
    ck_assert_int_eq(components[i].top, reference[i].top);
    ck_assert_int_eq(components[i].bottom, reference[i].bottom);
    ck_assert_uint_eq(components[i].area, reference[i].area);
    ck_assert_uint_eq(components[i].sum_x, reference[i].sum_x);
    ck_assert_uint_eq(components[i].sum_y, reference[i].sum_y);
  }
  Image<std::uint16_t> labels(mask.size());
  labels.fill_bytes(0xff);  // old contents must not shine through
  labeller.write(labels.view());
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x)
      ck_assert_int_eq(labels.view().at(x, y),
                       std::min(expected[static_cast<std::size_t>(y) * mask.width + x], 65535));
}

}  // namespace

START_TEST(an_empty_mask_has_no_components) {
  Image<std::uint8_t> mask({37, 5});
  Labeller labeller;
  ck_assert_uint_eq(labeller.find(mask.view()).size(), 0);
  ck_assert_uint_eq(labeller.find(GrayView{}).size(), 0);
}
END_TEST

START_TEST(two_shapes_have_the_box_area_and_centroid_counted_by_hand) {
  const auto mask = draw({
      "..........",
      ".##.....#.",
      ".##....#..",
      "......#...",
  });
  Labeller labeller;
  const auto found = labeller.find(mask.view());
  ck_assert_uint_eq(found.size(), 2);
  ck_assert_int_eq(found[0].left, 1);
  ck_assert_int_eq(found[0].top, 1);
  ck_assert_int_eq(found[0].right, 3);
  ck_assert_int_eq(found[0].bottom, 3);
  ck_assert_uint_eq(found[0].area, 4);
  ck_assert_double_eq_tol(found[0].centroid().x, 1.5, 1e-12);
  ck_assert_double_eq_tol(found[0].centroid().y, 1.5, 1e-12);
  // A diagonal is one component (8-connected).
  ck_assert_uint_eq(found[1].area, 3);
  ck_assert_int_eq(found[1].left, 6);
  ck_assert_int_eq(found[1].right, 9);
  ck_assert_int_eq(found[1].bottom, 4);
  ck_assert_double_eq_tol(found[1].centroid().x, 7.0, 1e-12);
  ck_assert_double_eq_tol(found[1].centroid().y, 2.0, 1e-12);
}
END_TEST

START_TEST(arms_that_meet_late_are_one_component_with_the_earliest_label) {
  const auto mask = draw({
      "#.#.#...#",
      "#.#.#....",
      "#.#.#..#.",
      "#########",
  });
  Labeller labeller;
  const auto found = labeller.find(mask.view());
  ck_assert_uint_eq(found.size(), 2);
  ck_assert_uint_eq(found[0].area, 19);
  ck_assert_uint_eq(found[1].area, 1);
  ck_assert_int_eq(found[1].left, 8);
}
END_TEST

START_TEST(any_value_but_zero_moves) {
  Image<std::uint8_t> mask({24, 1});
  const std::uint8_t row[24] = {0, 1, 128, 255, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 1, 0, 0, 0, 0, 2};
  std::memcpy(mask.view().row(0), row, sizeof row);
  Labeller labeller;
  const auto found = labeller.find(mask.view());
  ck_assert_uint_eq(found.size(), 4);
  ck_assert_uint_eq(found[0].area, 3);
  ck_assert_uint_eq(found[1].area, 9);
  ck_assert_uint_eq(found[2].area, 1);
  ck_assert_uint_eq(found[3].area, 1);
}
END_TEST

START_TEST(random_masks_of_odd_sizes_agree_with_the_flood_fill) {
  std::mt19937 random(20);
  const int sizes[][2] = {{1, 1}, {1, 9}, {7, 1}, {8, 8}, {9, 3}, {31, 17}, {64, 5}, {65, 33}, {130, 70}};
  for (const auto& s : sizes)
    for (int density : {3, 20, 40, 60, 97}) {
      Image<std::uint8_t> mask({s[0], s[1]});
      mask.fill_bytes(0xff);  // the padding beyond the width must not count
      for (int y = 0; y < s[1]; ++y)
        for (int x = 0; x < s[0]; ++x)
          mask.view().at(x, y) = static_cast<int>(random() % 100) < density ? 255 : 0;
      compare_with_flood(mask.view());
    }
}
END_TEST

START_TEST(more_than_65535_components_are_all_counted_and_share_the_last_label) {
  // Single pixels two apart: 300 * 240 = 72000 components.
  Image<std::uint8_t> mask({600, 480});
  for (int y = 0; y < 480; y += 2)
    for (int x = 0; x < 600; x += 2) mask.view().at(x, y) = 255;
  compare_with_flood(mask.view());
  Labeller labeller;
  ck_assert_uint_eq(labeller.find(mask.view()).size(), 72000);
}
END_TEST

START_TEST(nothing_beyond_the_last_pixel_is_read) {
  // The picture ends exactly at the end of a page; the next page may not be touched.
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  auto* memory = static_cast<std::uint8_t*>(
      mmap(nullptr, 2 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
  ck_assert_ptr_ne(memory, MAP_FAILED);
  ck_assert_int_eq(mprotect(memory + page, page, PROT_NONE), 0);
  const int width = 29, height = 11;
  std::uint8_t* data = memory + page - width * height;
  std::memset(data, 255, width * height);
  Labeller labeller;
  ck_assert_uint_eq(labeller.find({data, width, height, width}).size(), 1);
  std::memset(data, 0, width * height);
  ck_assert_uint_eq(labeller.find({data, width, height, width}).size(), 0);
  munmap(memory, 2 * page);
}
END_TEST

START_TEST(a_second_picture_of_the_same_kind_allocates_nothing) {
  Image<std::uint8_t> mask({320, 240});
  std::mt19937 random(3);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) mask.view().at(x, y) = random() % 4 ? 0 : 255;
  Labeller labeller;
  labeller.find(mask.view());
  const std::size_t bytes = labeller.bytes();
  const Run* runs = labeller.runs().data();
  labeller.find(mask.view());
  ck_assert_uint_eq(labeller.bytes(), bytes);
  ck_assert_ptr_eq(labeller.runs().data(), runs);
}
END_TEST

int main() {
  Suite* suite = suite_create("labelling");
  TCase* tests = tcase_create("components");
  tcase_add_test(tests, an_empty_mask_has_no_components);
  tcase_add_test(tests, two_shapes_have_the_box_area_and_centroid_counted_by_hand);
  tcase_add_test(tests, arms_that_meet_late_are_one_component_with_the_earliest_label);
  tcase_add_test(tests, any_value_but_zero_moves);
  tcase_add_test(tests, random_masks_of_odd_sizes_agree_with_the_flood_fill);
  tcase_add_test(tests, more_than_65535_components_are_all_counted_and_share_the_last_label);
  tcase_add_test(tests, nothing_beyond_the_last_pixel_is_read);
  tcase_add_test(tests, a_second_picture_of_the_same_kind_allocates_nothing);
  suite_add_tcase(suite, tests);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
