// SPDX-License-Identifier: LGPL-2.1-or-later
// The judge is cairo, which strokes the same path.
#include "overlay/marks/outline.h"

#include <cairo.h>
#include <check.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <vector>

#include "overlay/cairo_helpers.h"
#include "support/targets.h"

using namespace cerberus::overlay;

namespace {

constexpr int kWidth = 200, kHeight = 160;
constexpr Area kAll{0, 0, kWidth, kHeight};

struct Case {
  double x, y, width, height, line;
  LineStyle style;
};

std::vector<std::uint32_t> drawn(const Case& c, Area area = kAll) {
  std::vector<std::uint32_t> words(static_cast<std::size_t>(area.width * area.height), 0u);
  Outline(c.x, c.y, c.width, c.height, c.line, c.style, {1, 0.5, 0})
      .draw(area, {words.data(), area.width, area.height, area.width});
  return words;
}

std::vector<std::uint32_t> stroked(const Case& c) {
  std::vector<std::uint32_t> words(static_cast<std::size_t>(kWidth * kHeight), 0u);
  const SurfacePtr surface(cairo_image_surface_create_for_data(
      reinterpret_cast<unsigned char*>(words.data()), CAIRO_FORMAT_ARGB32, kWidth, kHeight, 4 * kWidth));
  const ContextPtr cr(cairo_create(surface.get()));
  rounded_rectangle(cr.get(), c.x, c.y, c.width, c.height, std::min({2 * c.line, c.width / 2, c.height / 2}));
  cairo_set_tolerance(cr.get(), 0.01);  // lengths of arcs decide where dots lie; else some are .2 pixels off
  const double casing = std::max(1.0, 0.6 * c.line);
  // A whole number of dashes or dots fits round the box.
  const double radius = std::min({2 * c.line, c.width / 2, c.height / 2});
  const double round = 2 * (c.width + c.height - 4 * radius) + 2 * std::numbers::pi * radius;
  const double period = c.line * (c.style == LineStyle::dashed ? 9 : 2.61),
               fit = round / std::round(round / period);
  const double dashes[] = {fit * 5 / 9, fit * 4 / 9}, dots[] = {0.01 * c.line, fit - 0.01 * c.line};
  if (c.style == LineStyle::dashed) cairo_set_dash(cr.get(), dashes, 2, 0);
  if (c.style == LineStyle::dotted) {
    cairo_set_dash(cr.get(), dots, 2, 0);
    cairo_set_line_cap(cr.get(), CAIRO_LINE_CAP_ROUND);
  }
  cairo_set_line_width(cr.get(), c.line + 2 * casing);
  set_color(cr.get(), {}, 0.6);
  cairo_stroke_preserve(cr.get());
  cairo_set_line_width(cr.get(), c.style == LineStyle::dotted ? 1.3 * c.line : c.line);
  set_color(cr.get(), {1, 0.5, 0}, c.style == LineStyle::dashed ? 0.85 : 1);
  cairo_stroke(cr.get());
  cairo_surface_flush(surface.get());
  return words;
}

const Case kCases[] = {
    {20, 20, 150, 120, 3, LineStyle::solid},
    {20.3, 20.7, 150.4, 119.6, 3.7, LineStyle::solid},
    {30.25, 25.5, 40, 100.5, 1.3, LineStyle::solid},
    {50, 40, 9, 12, 2, LineStyle::solid},
    {20.3, 20.7, 150.4, 119.6, 3.7, LineStyle::dashed},
    {30, 25, 60, 100, 2, LineStyle::dashed},
    {20.3, 20.7, 150.4, 119.6, 3.7, LineStyle::dotted},
    {30, 25, 60, 100, 2, LineStyle::dotted},
};

int difference(std::uint32_t a, std::uint32_t b) {
  int most = 0;
  for (int shift = 0; shift < 32; shift += 8)
    most = std::max(most, std::abs(static_cast<int>(a >> shift & 255) - static_cast<int>(b >> shift & 255)));
  return most;
}

}  // namespace

START_TEST(a_box_is_what_cairo_strokes) {
  for (const Case& c : kCases) {
    const auto is = drawn(c), should = stroked(c);
    double sum = 0;
    int most = 0, touched = 0, far = 0;
    for (std::size_t i = 0; i < is.size(); ++i) {
      const int d = difference(is[i], should[i]);
      most = std::max(most, d);
      sum += d;
      far += d > 64;
      touched += (is[i] | should[i]) != 0;
    }
    ck_assert_msg(sum / touched < 6 && far * 400 <= touched,
                  "line %g, style %d: mean %.2f, most %d, far %d of %d", c.line, static_cast<int>(c.style),
                  sum / touched, most, far, touched);
  }
}
END_TEST

// Sides are exact, up to rounding: a pixel's share of an upright line is what the line covers of its width.
START_TEST(sides_cover_pixels_as_far_as_they_reach) {
  const auto words = drawn({20.25, 20, 150, 120, 3, LineStyle::solid});
  // Line from 18.75 to 21.75, casing 1.8 to both sides: 16.95 to 23.55.
  const double line[] = {0, 0, 0.25, 1, 1, 0.75, 0, 0}, casing[] = {0.05, 1, 1, 1, 1, 1, 1, 0.55};
  for (int i = 0; i < 8; ++i) {
    const std::uint32_t word = words[static_cast<std::size_t>(80 * kWidth + 16 + i)];
    const double alpha = line[i] + (1 - line[i]) * 0.6 * casing[i];
    ck_assert_int_le(std::abs(static_cast<int>(word >> 24) - static_cast<int>(std::lround(255 * alpha))), 1);
    ck_assert_int_le(
        std::abs(static_cast<int>(word >> 16 & 255) - static_cast<int>(std::lround(255 * line[i]))), 1);
  }
}
END_TEST

// The vectors against the definition, pixel by pixel: boxes of all sizes, lines and places, areas that begin anywhere.
START_TEST(rows_are_drawn_as_pixels_are) {
  std::mt19937 random(11);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int round = 0; round < 150; ++round) {
    const double line = between(0.3, round % 4 == 0 ? 20 : 6);
    const auto style = static_cast<LineStyle>(round % 3);
    const Outline outline(between(0, 60), between(0, 60), between(1, 130), between(1, 130), line, style,
                          {1, 0.5, 0.2});
    const Area area{static_cast<int>(between(-20, 60)), static_cast<int>(between(-20, 60)),
                    1 + static_cast<int>(between(0, 100)), 1 + static_cast<int>(between(0, 100))};
    const auto pixels = static_cast<std::size_t>(area.width * area.height);
    std::vector<std::uint32_t> fast(pixels, 0x12345678u), exact(pixels);  // every pixel is written
    outline.draw(area, {fast.data(), area.width, area.height, area.width});
    outline.draw_exactly(area, {exact.data(), area.width, area.height, area.width});
    for (std::size_t i = 0; i < pixels; ++i)
      if (difference(fast[i], exact[i]) > 2)  // an assertion costs more than a pixel
        ck_abort_msg("round %d, line %g, style %d: %08x, not %08x at %d, %d", round, line,
                     static_cast<int>(style), fast[i], exact[i], static_cast<int>(i) % area.width + area.x,
                     static_cast<int>(i) / area.width + area.y);
  }
}
END_TEST

// What the painter leaves out between the strips of the rim is transparent.
START_TEST(nothing_lies_beyond_the_reaches) {
  for (const double line : {1.0, 3.7, 12.0, 30.0}) {
    const Outline outline(40.3, 30.6, 400, 300, line, LineStyle::solid, {1, 0.5, 0});
    const Area inside = {static_cast<int>(std::ceil(40.3 + outline.inner_reach())),
                         static_cast<int>(std::ceil(30.6 + outline.inner_reach())), 100, 100};
    std::vector<std::uint32_t> words(100 * 100, 1u);
    outline.draw(inside, {words.data(), 100, 100, 100});
    ck_assert(std::ranges::all_of(words, [](std::uint32_t word) { return word == 0; }));
  }
}
END_TEST

// However the frame is cut into areas, dashes and dots join.
START_TEST(parts_are_parts_of_the_whole) {
  for (const Case& c : kCases) {
    const auto whole = drawn(c);
    for (const Area part : {Area{0, 0, kWidth, 40}, Area{0, 40, 60, 80}, Area{150, 33, 50, 100}}) {
      const auto words = drawn(c, part);
      for (int y = 0; y < part.height; ++y)
        for (int x = 0; x < part.width; ++x)
          if (difference(words[static_cast<std::size_t>(y * part.width + x)],
                         whole[static_cast<std::size_t>((y + part.y) * kWidth + x + part.x)]) > 2)
            ck_abort_msg("line %g, style %d: another pixel at %d, %d", c.line, static_cast<int>(c.style), x,
                         y);
    }
  }
}
END_TEST

// Areas whose edges cut through the line of each side, as the frame's do where a box reaches beyond it. The picture has
// other memory beside and below it.
START_TEST(nothing_is_drawn_outside_of_the_area) {
  constexpr int kBeside = 8;
  constexpr std::uint32_t kOther = 0x12345678;
  for (const Case& c : kCases)
    for (int cut = -8; cut <= 8; ++cut) {
      const int left = static_cast<int>(c.x) + cut, right = static_cast<int>(c.x + c.width) + cut;
      const int top = static_cast<int>(c.y) + cut, bottom = static_cast<int>(c.y + c.height) + cut;
      for (const Area& area : {Area{left, 0, kWidth - left, kHeight}, Area{0, 0, right, kHeight},
                               Area{0, top, kWidth, kHeight - top}, Area{0, 0, kWidth, bottom}}) {
        const int stride = area.width + kBeside;
        std::vector<std::uint32_t> words(static_cast<std::size_t>(stride * (area.height + 2)), kOther);
        const cerberus::vision::View<std::uint32_t> picture{words.data() + stride, area.width, area.height,
                                                            stride};
        for (int y = 0; y < area.height; ++y) std::fill_n(picture.row(y), area.width, 0u);
        Outline(c.x, c.y, c.width, c.height, c.line, c.style, {1, 0.5, 0}).draw(area, picture);
        for (int y = -1; y <= area.height; ++y)
          for (int x = y < 0 || y == area.height ? 0 : area.width; x < stride; ++x)
            if (words[static_cast<std::size_t>((y + 1) * stride + x)] != kOther)
              ck_abort_msg("line %g, style %d: drawn at %d, %d", c.line, static_cast<int>(c.style), x, y);
      }
    }
}
END_TEST

int main() {
  return cerberus::tests::run_suite_on_every_target(
      "outline",
      {a_box_is_what_cairo_strokes, sides_cover_pixels_as_far_as_they_reach, rows_are_drawn_as_pixels_are,
       nothing_lies_beyond_the_reaches, parts_are_parts_of_the_whole, nothing_is_drawn_outside_of_the_area});
}
