// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/blend.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include "support/targets.h"
#include "support/wrong.h"

using namespace cerberus::overlay;
using namespace cerberus::vision;
using cerberus::tests::Wrong;

// The definition in floating point, sample by sample of the whole picture.
static double expected(const std::vector<std::uint32_t>& drawing, int dw, int dh, int x, int y,
                       const BlendComponent& c, int u, int v, int before) {
  const int nx = 1 << c.shift_x, ny = 1 << c.shift_y;
  double sum = 0;
  for (int py = v * ny; py < (v + 1) * ny; ++py)
    for (int px = u * nx; px < (u + 1) * nx; ++px) {
      double value = before;
      if (px >= x && px < x + dw && py >= y && py < y + dh) {
        const std::uint32_t p = drawing[(py - y) * dw + px - x];
        const double a = (p >> 24) / 255.0;
        value = c.red * (p >> 16 & 255) + c.green * (p >> 8 & 255) + c.blue * (p & 255) + c.offset * a +
                before * (1 - a);
      }
      sum += value;
    }
  return std::clamp(sum / (nx * ny), 0.0, 255.0);
}

static const BlendComponent kMatrices[] = {
    {nullptr, nullptr, 0, 1, 0, 0, 0.257, 0.504, 0.098, 16},     // Y of BT.601, limited range
    {nullptr, nullptr, 0, 1, 0, 0, -0.148, -0.291, 0.439, 128},  // its Cb
    {nullptr, nullptr, 0, 1, 0, 0, 1, 0, 0, 0},                  // R
    {nullptr, nullptr, 0, 1, 0, 0, 0, 0, 0, 255},                // A
};

START_TEST(every_layout_agrees_with_the_definition) {
  std::mt19937 random(7);
  const auto upto = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int round = 0; round < 400; ++round) {
    BlendComponent c = kMatrices[upto(4)];
    c.shift_x = upto(3), c.shift_y = upto(2), c.step = 1 + upto(4);
    const int width = 1 + upto(40), height = 1 + upto(30);
    const int samples = (width + (1 << c.shift_x) - 1) >> c.shift_x,
              rows = (height + (1 << c.shift_y) - 1) >> c.shift_y;
    c.stride = samples * c.step + upto(9);
    std::vector<std::uint8_t> before(static_cast<std::size_t>(c.stride) * rows), after;
    for (auto& b : before) b = static_cast<std::uint8_t>(upto(256));
    const int dw = 1 + upto(width), dh = 1 + upto(height), x = upto(width - dw + 1),
              y = upto(height - dh + 1);
    std::vector<std::uint32_t> drawing(static_cast<std::size_t>(dw) * dh);
    for (auto& p : drawing) {
      const unsigned a = upto(3) == 0 ? 0 : upto(3) == 0 ? 255 : upto(256);
      p = a << 24;
      for (const int shift : {0, 8, 16}) p |= static_cast<unsigned>(upto(static_cast<int>(a) + 1)) << shift;
    }
    after = before;
    c.data = after.data();
    blend({drawing.data(), dw, dh, dw}, x, y, {&c, 1});
    Wrong drawn, kept;
    for (int v = 0; v < rows; ++v)
      for (int i = 0; i < static_cast<int>(c.stride); ++i) {
        const std::size_t at = static_cast<std::size_t>(v * c.stride + i);
        if (i % c.step == 0 && i / c.step < samples)
          drawn.unless(
              std::abs(after[at] - expected(drawing, dw, dh, x, y, c, i / c.step, v, before[at])) <= 0.51, i,
              v);
        else
          kept.unless(after[at] == before[at], i, v);  // other components, and what lies between rows
      }
    drawn.assert_none("drawn");
    kept.assert_none("not to be touched");
  }
}
END_TEST

// 10 bits: Y of BT.601 in the limited range, 64 + 876 * ..., of white 940; a half of black over 400 is 231.
START_TEST(words_of_sixteen_bits_are_drawn_on_in_either_layout_and_byte_order) {
  const double scale = 876 / 255.0;
  for (const int shift : {0, 6})
    for (const bool swapped : {false, true}) {
      const auto word = [&](int value) {
        const int w = value << shift;
        return static_cast<std::uint16_t>(swapped ? (w << 8 | w >> 8) : w);
      };
      std::vector<std::uint16_t> row{word(400), word(400), word(400), word(400)};
      BlendComponent c{nullptr,       nullptr,       8,  2,  0,     0,      0.299 * scale,
                       0.587 * scale, 0.114 * scale, 64, 10, shift, swapped};
      c.data = reinterpret_cast<std::uint8_t*>(row.data());
      const std::uint32_t drawing[] = {0xffffffff, 0, 0x80000000, 0xffffffff};
      blend({drawing, 3, 1, 3}, 0, 0, {&c, 1});
      ck_assert_uint_eq(row[0], word(940));
      ck_assert_uint_eq(row[1], word(400));
      ck_assert_uint_eq(row[2], word(231));  // 400 * 127 / 255 + 64 * 128 / 255 = 231.3
      ck_assert_uint_eq(row[3], word(400));
      // Chroma of half the width: the mean of both pixels.
      c.shift_x = 1;
      row = {word(400), word(400), word(400), word(400)};
      blend({drawing, 2, 1, 2}, 0, 0, {&c, 1});
      ck_assert_uint_eq(row[0], word(670));
      ck_assert_uint_eq(row[1], word(400));
    }
}
END_TEST

START_TEST(opaque_white_is_white_and_nothing_is_nothing) {
  std::vector<std::uint8_t> y(16, 60), cb(4, 90);
  BlendComponent c[2] = {kMatrices[0], kMatrices[1]};
  c[0].data = y.data(), c[0].stride = 4;
  c[1].data = cb.data(), c[1].stride = 2, c[1].shift_x = c[1].shift_y = 1;
  const std::uint32_t nothing[16] = {};
  blend({nothing, 4, 4, 4}, 0, 0, c);
  ck_assert(std::all_of(y.begin(), y.end(), [](int v) { return v == 60; }));
  ck_assert(std::all_of(cb.begin(), cb.end(), [](int v) { return v == 90; }));
  std::uint32_t white[16];
  std::fill(white, white + 16, 0xffffffffu);
  blend({white, 4, 4, 4}, 0, 0, c);
  ck_assert(std::all_of(y.begin(), y.end(), [](int v) { return v == 235; }));
  ck_assert(std::all_of(cb.begin(), cb.end(), [](int v) { return v == 128; }));
}
END_TEST

// Components of one sampling are blended together: planes with and without alpha, with any sampling of chroma, and
// chroma whose samples take turns.
START_TEST(components_together_are_blended_as_one_by_one) {
  std::mt19937 random(13);
  const auto upto = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  constexpr int kWidth = 52, kHeight = 20, kPlane = 64 * kHeight;
  for (int round = 0; round < 200; ++round) {
    const int shift_x = upto(3), shift_y = upto(2), count = 3 + upto(2);
    const bool turns = upto(2) == 1;
    std::vector<std::uint8_t> before(4 * kPlane);
    for (auto& b : before) b = static_cast<std::uint8_t>(upto(256));
    std::vector<std::uint8_t> together = before, apart = before;
    std::vector<std::uint32_t> drawing(static_cast<std::size_t>(kWidth * kHeight));
    for (auto& p : drawing) p = upto(3) == 0 ? 0xff80c020u : upto(2) == 0 ? 0x80402010u : 0;
    const int x = upto(9), y = upto(5), width = 1 + upto(kWidth - x), height = 1 + upto(kHeight - y);
    const auto components = [&](std::vector<std::uint8_t>& to) {
      std::vector<BlendComponent> all;
      for (const int i : {0, 1, 1, 3}) {
        BlendComponent c = kMatrices[i];
        const bool chroma = i == 1, second = all.size() == 2;
        c.data = to.data() + (turns && second ? kPlane + 1 : static_cast<int>(all.size()) * kPlane);
        c.stride = 64;
        c.step = chroma && turns ? 2 : 1;
        if (chroma) c.shift_x = turns ? 1 : shift_x, c.shift_y = shift_y;
        all.push_back(c);
      }
      all.resize(static_cast<std::size_t>(count));
      return all;
    };
    blend({drawing.data(), width, height, kWidth}, x, y, components(together));
    for (const BlendComponent& c : components(apart))
      blend({drawing.data(), width, height, kWidth}, x, y, {&c, 1});
    ck_assert_msg(together == apart, "round %d: %d components, chroma of 1/%d x 1/%d", round, count,
                  1 << shift_x, 1 << shift_y);
    ck_assert(together != before || width * height < 40);
  }
}
END_TEST

// Every order of four bytes of which one may be none of the picture's: as the components one by one.
START_TEST(pixels_of_four_bytes_are_blended_as_their_components_are) {
  std::mt19937 random(3);
  const auto upto = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  const double colors[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 255}};
  for (int round = 0; round < 300; ++round) {
    int order[4] = {0, 1, 2, 3};
    std::shuffle(order, order + 4, random);
    const int width = 1 + upto(70), height = 1 + upto(4), stride = 4 * width;
    std::vector<std::uint8_t> before(static_cast<std::size_t>(stride) * height + 1);
    for (auto& b : before) b = static_cast<std::uint8_t>(upto(256));
    std::vector<std::uint8_t> together = before, apart = before;
    std::vector<std::uint32_t> drawing(static_cast<std::size_t>(width) * height);
    for (auto& p : drawing) {
      const unsigned a = upto(3) == 0 ? 0 : upto(3) == 0 ? 255 : upto(256);
      p = a << 24;
      for (const int shift : {0, 8, 16}) p |= static_cast<unsigned>(upto(static_cast<int>(a) + 1)) << shift;
    }
    const std::size_t n = 3 + static_cast<std::size_t>(upto(2));
    for (const bool one_by_one : {false, true}) {
      std::vector<BlendComponent> all;
      for (std::size_t i = 0; i < n; ++i) {
        const double* c = colors[i];
        // Not aligned, as memory of others may be.
        std::uint8_t* pixel = (one_by_one ? apart : together).data() + 1;
        all.push_back(
            {pixel + order[i], one_by_one ? nullptr : pixel, stride, 4, 0, 0, c[0], c[1], c[2], c[3]});
      }
      blend({drawing.data(), width, height, width}, 0, 0, all);
    }
    for (std::size_t i = 0; i < before.size(); ++i)
      ck_assert_msg(std::abs(together[i] - apart[i]) <= 0, "byte %zu of %d: %d, not %d", i, width,
                    together[i], apart[i]);
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite_on_every_target(
      "blend", {every_layout_agrees_with_the_definition,
                words_of_sixteen_bits_are_drawn_on_in_either_layout_and_byte_order,
                opaque_white_is_white_and_nothing_is_nothing, components_together_are_blended_as_one_by_one,
                pixels_of_four_bytes_are_blended_as_their_components_are});
}
