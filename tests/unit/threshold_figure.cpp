// SPDX-License-Identifier: LGPL-2.1-or-later
// The figure in 130 x 120 pixels: too small for text, so that both panels begin at column 1 and are 128 wide. With 64
// levels each is two columns wide: level n covers columns 2 n + 1 and 2 n + 2. The upper panel has rows 1 to 65.008, the
// lower one rows 68.708 to 119: 0.56 of the 114.3 rows that the margins leave, and the rest.
#include "overlay/threshold_figure.h"

#include <check.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "support/suite.h"

using namespace cerberus;
using overlay::Canvas;
using overlay::ThresholdFigure;

namespace {

constexpr int kWidth = 130, kHeight = 120;
constexpr int kAxisRow = 85;  // in the lower panel, where no line is but those of the axis

struct Pixel {
  int red, green, blue;
  bool operator==(const Pixel&) const = default;
};
constexpr Pixel kObject{230, 159, 0};  // 0.902, 0.624, 0
bool is_object(const Pixel& p) {       // rounding within cairo
  return std::abs(p.red - kObject.red) < 3 && std::abs(p.green - kObject.green) < 3 && p.blue < 3;
}
bool is_threshold(const Pixel& p) {  // 1, 0.35, 0.25
  return p.red > 150 && p.green < 100 && p.blue < 80;
}

// A histogram of levels 0 to 40, so that 64 are shown, with seeds up to 10 and from 45 on.
struct Figure {
  vision::Histogram histogram{};
  ThresholdFigure figure;
  std::vector<std::uint32_t> words = std::vector<std::uint32_t>(kWidth * kHeight);

  Figure() {
    histogram[5] = 9;
    figure.histogram = &histogram;
    figure.curves.highest = 40;
    figure.curves.seed_low = 10;
    figure.curves.seed_high = 45;
    figure.fuzzy_threshold = figure.threshold = 20;
  }
  void curves(double beta, double omega) {
    for (int x = 11; x < 45; ++x) {
      figure.curves.beta[static_cast<std::size_t>(x)] = beta;
      figure.curves.omega[static_cast<std::size_t>(x)] = omega;
    }
  }
  void draw() {
    const Canvas canvas{reinterpret_cast<std::uint8_t*>(words.data()), 4 * kWidth, kWidth, kHeight, false};
    ck_assert(overlay::draw_threshold_figure(figure, canvas));
  }
  bool is_paper(int x, int y) const { return at(x, y) == at(0, 0); }  // the corner is outside the panels
  Pixel at(int x, int y) const {
    const std::uint32_t word = words[static_cast<std::size_t>(y * kWidth + x)];
    return {static_cast<int>(word >> 16 & 255), static_cast<int>(word >> 8 & 255),
            static_cast<int>(word & 255)};
  }
};

}  // namespace

// 42 levels and a margin fit into 64: lines at levels 0, 16, 32, 48 and 64.
START_TEST(the_axis_has_a_line_every_sixteen_of_sixty_four_levels_the_last_included) {
  Figure f;
  f.curves(0.25, 0.54);
  f.draw();
  for (int x = 0; x < kWidth; ++x) {
    if (x == 42 || x == 43) continue;  // the threshold
    const bool line = (x - 1) % 32 == 0;
    ck_assert_msg((!f.is_paper(x, kAxisRow)) == line, "column %d", x);
    if (line) ck_assert(f.at(x, kAxisRow) == f.at(1, kAxisRow));
  }
}
END_TEST

// Level 5 begins at 1 + 5 x 128 / levels: columns 21, 11, 6, 4 and 3 for 32, 64, 128, 192 and 256 levels.
START_TEST(the_range_of_levels_is_rounded_up_with_room_for_two) {
  const std::array<std::array<int, 2>, 8> cases{
      {{30, 21}, {31, 11}, {62, 11}, {63, 6}, {126, 6}, {127, 4}, {190, 4}, {191, 3}}};
  for (const auto& [highest, first] : cases) {
    Figure f;
    f.figure.curves.highest = highest;
    f.figure.threshold = f.figure.fuzzy_threshold = -1;
    f.draw();
    int x = 2;  // right of the axis
    while (f.is_paper(x, 50)) ++x;
    ck_assert_int_eq(x, first);
  }
}
END_TEST

// Nine pixels of a level are as high as the panel: log10(9 + 1) of one decade. Two are log10(3) = 0.477 of it high,
// down from row 1 + 64.008 (1 - 0.477) = 34.5.
START_TEST(bars_are_logarithmic_and_have_the_colour_of_their_seed_subset) {
  Figure f;
  f.histogram[30] = f.histogram[50] = 2;
  f.draw();
  for (const int x : {11, 12}) {
    const Pixel background = f.at(x, 50);
    ck_assert_int_gt(background.blue, background.red + 50);  // level 5 is below the first seed
    ck_assert(f.at(x, 20) == background);
  }
  for (const int x : {61, 62}) {
    const Pixel fuzzy = f.at(x, 50);
    ck_assert(!f.is_paper(x, 50));
    ck_assert_int_lt(std::abs(fuzzy.blue - fuzzy.red), 20);  // grey, between the seeds
    ck_assert(f.at(x, 36) == fuzzy && f.is_paper(x, 32));
  }
  const Pixel object = f.at(102, 50);
  ck_assert_int_gt(object.red, object.blue + 50);  // level 50 is above the second seed
  ck_assert(f.is_paper(60, 50) && f.is_paper(64, 50));
}
END_TEST

// The axis of the indices is rounded to tenths and covers at least two of them.
START_TEST(the_indices_of_fuzziness_fill_their_panel) {
  // Both .35: 0.3 to 0.5, a quarter of its 50.292 rows above its lower end at 119: 106.4.
  Figure flat;
  flat.curves(0.35, 0.35);
  flat.draw();
  ck_assert(is_object(flat.at(60, 106)));
  ck_assert(flat.is_paper(60, 100) && flat.is_paper(60, 112));
  // .25 to .54: 0.2 to 0.6. Omega is .85 of the panel high: row 76.25. Beta is .125 high: row 112.7.
  Figure wide;
  wide.curves(0.25, 0.54);
  wide.draw();
  ck_assert(is_object(wide.at(60, 76)));
  const Pixel beta = wide.at(60, 112);
  ck_assert_int_gt(beta.blue, beta.red + 50);
  // Outside the seeds there is none.
  ck_assert(wide.is_paper(12, 76) && wide.is_paper(110, 76));
}
END_TEST

// Levels above 20 are motion: the line lies at column 1 + 21 x 2 = 43, between columns 42 and 43.
START_TEST(the_threshold_is_a_line_right_of_its_level_in_both_panels) {
  Figure f;
  f.curves(0.25, 0.54);
  f.draw();
  for (const int y : {30, kAxisRow}) {
    ck_assert(is_threshold(f.at(42, y)) && is_threshold(f.at(43, y)));
    ck_assert(f.is_paper(41, y) && f.is_paper(44, y));
  }
}
END_TEST

// A threshold that was limited: the fuzzy one, of level 30, is dashed at column 63; the used one is solid.
START_TEST(a_fuzzy_threshold_that_is_not_the_one_used_is_dashed) {
  Figure f;
  f.figure.fuzzy_threshold = 30;
  f.draw();
  int dashed = 0, solid = 0;
  for (int y = 3; y < 63; ++y) {
    dashed += is_threshold(f.at(62, y)) || is_threshold(f.at(63, y)) || f.at(63, y).red > 100;
    solid += is_threshold(f.at(42, y));
  }
  ck_assert_int_eq(solid, 60);
  ck_assert(dashed > 20 && dashed < 50);  // dashes of 4.5 rows, gaps of 3.15
}
END_TEST

START_TEST(an_empty_histogram_has_no_threshold) {
  Figure f;
  f.histogram[5] = 0;
  f.draw();
  for (int y = 3; y < 63; ++y) ck_assert(!is_threshold(f.at(42, y)));
}
END_TEST

START_TEST(a_figure_with_text_stays_within_its_canvas) {
  constexpr int kLarge = 320, kTall = 240, kPadding = 5;
  std::vector<std::uint32_t> words((kLarge + kPadding) * kTall, 0x01020304u);
  Figure f;
  const Canvas canvas{reinterpret_cast<std::uint8_t*>(words.data()), 4 * (kLarge + kPadding), kLarge, kTall,
                      false};
  ck_assert(overlay::draw_threshold_figure(f.figure, canvas));
  for (std::size_t i = 0; i < words.size(); ++i)
    if (i % (kLarge + kPadding) >= kLarge) ck_assert_uint_eq(words[i], 0x01020304u);
}
END_TEST

int main() {
  return tests::run_suite(
      "threshold_figure",
      {the_axis_has_a_line_every_sixteen_of_sixty_four_levels_the_last_included,
       the_range_of_levels_is_rounded_up_with_room_for_two,
       bars_are_logarithmic_and_have_the_colour_of_their_seed_subset,
       the_indices_of_fuzziness_fill_their_panel, the_threshold_is_a_line_right_of_its_level_in_both_panels,
       a_fuzzy_threshold_that_is_not_the_one_used_is_dashed, an_empty_histogram_has_no_threshold,
       a_figure_with_text_stays_within_its_canvas});
}
