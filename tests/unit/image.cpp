// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/image/image.h"

#include <check.h>

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

START_TEST(rows_are_zero_and_hold_whole_vectors_of_16_samples) {
  for (const Size size : {Size{1, 1}, Size{33, 35}, Size{64, 2}, Size{65, 3}, Size{320, 240}}) {
    Image<std::uint16_t> image(size);
    const int padded = (size.width + 15) / 16 * 16;
    ck_assert_int_eq(image.view().stride, padded);
    ck_assert_uint_eq(reinterpret_cast<std::uintptr_t>(image.view().data) % 64, 0);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < padded; ++x) ck_assert_int_eq(image.view().at(x, y), 0);
    ck_assert_uint_eq(image.bytes(), static_cast<std::size_t>(padded) * size.height * sizeof(std::uint16_t));
  }
}
END_TEST

START_TEST(resizing_to_the_same_size_keeps_everything) {
  Image<std::uint8_t> image({40, 30});
  image.view().at(39, 29) = 9;
  const std::size_t before = allocations();
  ck_assert(!image.resize({40, 30}));
  ck_assert_uint_eq(allocations() - before, 0);
  ck_assert_int_eq(image.view().at(39, 29), 9);
  ck_assert(image.resize({41, 30}));
  ck_assert_int_eq(image.view().at(39, 29), 0);
  ck_assert(image.size() == (Size{41, 30}));
}
END_TEST

START_TEST(an_empty_image_is_no_memory) {
  Image<std::uint8_t> image;
  ck_assert(image.empty());
  ck_assert(image.view().empty());
  image.resize({5, 5});
  ck_assert(!image.empty());
  image.resize({0, 0});
  ck_assert(image.empty());
  ck_assert_uint_eq(image.bytes(), 0);
}
END_TEST

START_TEST(swapping_swaps_pixels_and_sizes) {
  Image<std::uint8_t> a({3, 2}), b({70, 5});
  a.view().at(2, 1) = 1;
  b.view().at(69, 4) = 2;
  a.swap(b);
  ck_assert_int_eq(a.view().at(69, 4), 2);
  ck_assert_int_eq(b.view().at(2, 1), 1);
}
END_TEST

START_TEST(a_view_steps_by_its_stride_and_may_become_constant) {
  std::uint8_t bytes[12] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  const MutableGrayView view{bytes, 2, 3, 4};
  view.at(1, 2) = 99;
  const GrayView constant = view;
  ck_assert_int_eq(constant.at(0, 1), 4);
  ck_assert_int_eq(bytes[9], 99);
  ck_assert_int_eq(constant.row(2)[1], 99);
  ck_assert(!constant.empty());
}
END_TEST

START_TEST(areas_do_not_overflow) {
  ck_assert_int_eq((Size{65536, 65536}).area(), 4294967296L);
}
END_TEST

int main() {
  return run_suite("image", {rows_are_zero_and_hold_whole_vectors_of_16_samples,
                             resizing_to_the_same_size_keeps_everything, an_empty_image_is_no_memory,
                             swapping_swaps_pixels_and_sizes,
                             a_view_steps_by_its_stride_and_may_become_constant, areas_do_not_overflow});
}
