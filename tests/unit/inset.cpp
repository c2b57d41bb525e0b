// SPDX-License-Identifier: LGPL-2.1-or-later
// Sizes and shares of pixels worked out by hand.
#include "overlay/inset.h"

#include <check.h>

#include <array>

#include "support/suite.h"

using namespace cerberus::overlay;
using namespace cerberus::vision;

namespace {

// 8 x 4 pixels with 3 more to each row that are not the picture's; the alpha is 0x80, the colours are 200, 104, 40.
struct Picture {
  static constexpr std::uint32_t kPixel = 0x80c86828u, kOpaque = 0xffc86828u, kBeyond = 0x01020304u;
  std::array<std::uint32_t, 44> words;
  Picture() {
    for (int i = 0; i < 44; ++i) words[static_cast<std::size_t>(i)] = i % 11 < 8 ? kPixel : kBeyond;
  }
  View<std::uint32_t> view() { return {words.data(), 8, 4, 11}; }
  std::uint32_t at(int x, int y) { return view().at(x, y); }
};

}  // namespace

START_TEST(it_takes_three_tenths_of_the_width_or_four_of_the_height_in_the_scenes_shape) {
  const auto is = [](Size scene, Size frame, Size expected) {
    const Size size = inset_size(scene, frame);
    ck_assert_int_eq(size.width, expected.width);
    ck_assert_int_eq(size.height, expected.height);
  };
  is({768, 576}, {640, 480}, {192, 144});     // 0.25
  is({1080, 1920}, {360, 300}, {68, 120});    // a sixteenth, by the height
  is({3840, 2160}, {1600, 900}, {480, 270});  // an eighth
  is({320, 240}, {80, 60}, {24, 18});
  is({320, 240}, {76, 57}, {});     // 23 wide: nothing to be seen
  is({1000, 100}, {500, 400}, {});  // 15 high
  is({0, 0}, {640, 480}, {});
}
END_TEST

START_TEST(the_place_stays_as_it_is_in_a_white_line_and_the_rest_is_dimmed) {
  Picture picture;
  mark_place(picture.view(), {3, 1, 6, 3}, 1);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) {
      const bool inside = x >= 3 && x < 6 && y >= 1 && y < 3, line = x >= 2 && x < 7 && !inside;
      // 0.65 of 200, 104, 40 is 130, 67.6, 26.
      ck_assert_uint_eq(picture.at(x, y), inside ? Picture::kOpaque : line ? 0xffffffffu : 0xff82441au);
    }
  for (std::size_t i = 0; i < 44; ++i)
    if (i % 11 >= 8) ck_assert_uint_eq(picture.words[i], Picture::kBeyond);
}
END_TEST

START_TEST(a_line_between_pixels_is_shared_among_them) {
  Picture picture;
  mark_place(picture.view(), {3.25, 0, 6, 4}, 1);
  // Column 2: outside for a quarter, line for three: 200 x 0.25 x 0.65 + 255 x 0.75 = 223.75, 208.15, 197.75.
  ck_assert_uint_eq(picture.at(2, 1), 0xffe0d0c6u);
  // Column 3: line for a quarter, inside for three: 200 x 0.75 + 255 x 0.25 = 213.75, 141.75, 93.75.
  ck_assert_uint_eq(picture.at(3, 1), 0xffd68e5eu);
}
END_TEST

START_TEST(a_place_beyond_the_picture_marks_nothing_beyond_it) {
  Picture picture;
  mark_place(picture.view(), {-5, -5, 50, 50}, 2);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) ck_assert_uint_eq(picture.at(x, y), Picture::kOpaque);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "inset",
      {it_takes_three_tenths_of_the_width_or_four_of_the_height_in_the_scenes_shape,
       the_place_stays_as_it_is_in_a_white_line_and_the_rest_is_dimmed,
       a_line_between_pixels_is_shared_among_them, a_place_beyond_the_picture_marks_nothing_beyond_it});
}
