// SPDX-License-Identifier: LGPL-2.1-or-later
// The kernels of light against values computed pixel by pixel and by hand, on every vector target of this processor.
#include "vision/change/light_kernels.h"

#include <algorithm>
#include <random>
#include <vector>

#include "support/targets.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

std::vector<std::uint8_t> levels(std::size_t count, unsigned from, std::mt19937& random) {
  std::vector<std::uint8_t> out(count);
  for (auto& level : out) level = static_cast<std::uint8_t>(from + random() % (256 - from));
  return out;
}

RowLight any_light(std::mt19937& random) {
  return {static_cast<std::int32_t>(64 + random() % 900),
          static_cast<std::int32_t>(random() % 20000) - 10000};
}

}  // namespace

// Also by rows that are no multiple of a vector, and in place.
START_TEST(a_row_is_relit_pixel_by_pixel) {
  std::mt19937 random(2);
  for (const int width : {1, 7, 16, 33, 320, 321})
    for (int round = 0; round < 40; ++round) {
      const auto reference = levels(static_cast<std::size_t>(width), round % 2 ? 230 : 0, random),
                 present = levels(static_cast<std::size_t>(width), 0, random);
      RowLight light = any_light(random);
      if (round == 0) light = {};
      if (round % 4 == 1) light.gain *= 16;
      auto with_white = reference, plain = reference;
      relight_row_with_white(with_white.data(), present.data(), light, width, with_white.data());
      relight_row(plain.data(), light, width, plain.data());
      for (std::size_t x = 0; x < plain.size(); ++x) {
        const int then = reference[x],
                  now = std::clamp((then * light.gain + light.offset + 128) >> 8, 0, 255);
        ck_assert_int_eq(plain[x], now);
        const auto [low, high] = std::minmax(then, now);
        const bool near_white = light != RowLight{} && high >= kNearWhite;
        ck_assert_int_eq(with_white[x],
                         near_white ? std::clamp<int>(present[x], low, then >= kWhite ? 255 : high) : now);
      }
    }
}
END_TEST

START_TEST(near_white_is_what_the_present_has_between_what_it_is_in_the_two_lights) {
  const std::uint8_t reference[]{234, 235, 235, 245, 245, 255}, present[]{200, 100, 240, 100, 250, 255};
  std::uint8_t out[6];
  relight_row_with_white(reference, present, {128, 0}, 6, out);
  const std::uint8_t half[]{117, 118, 235,
                            123, 250, 255};  // 245 / 2, rounded up; white may be more than that
  ck_assert(std::equal(out, out + 6, half));
  relight_row_with_white(reference, present, {256, 0}, 6, out);
  ck_assert(std::equal(out, out + 6, reference));
  const std::uint8_t dark[]{117, 118, 118, 150, 150, 117}, seen[]{130, 110, 130, 140, 200, 255};
  relight_row_with_white(dark, seen, {512, 0}, 6, out);
  const std::uint8_t twice[]{234, 118, 130, 150, 200, 234};
  ck_assert(std::equal(out, out + 6, twice));
}
END_TEST

int main() {
  return run_suite_on_every_target("light_kernels",
                                   {a_row_is_relit_pixel_by_pixel,
                                    near_white_is_what_the_present_has_between_what_it_is_in_the_two_lights});
}
