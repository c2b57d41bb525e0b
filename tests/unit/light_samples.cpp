// SPDX-License-Identifier: LGPL-2.1-or-later
// Which pixels are samples, computed a second time.
#include "vision/change/light_samples.h"

#include <check.h>

#include <cstdlib>
#include <random>
#include <vector>

#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

struct Pictures {
  explicit Pictures(Size size)
      : reference(size), present(size), spans(static_cast<std::size_t>(size.height)) {
    std::mt19937 random(3);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        reference.view().at(x, y) = static_cast<std::uint8_t>(random());
        present.view().at(x, y) = static_cast<std::uint8_t>(random());
      }
      const int begin = static_cast<int>(random() % static_cast<unsigned>(size.width));
      const int end = begin + static_cast<int>(random() % static_cast<unsigned>(size.width - begin + 1));
      spans[static_cast<std::size_t>(y)] = {begin, end};
    }
  }
  Image<std::uint8_t> reference, present;
  std::vector<RowSpan> spans;
};

const Size kSizes[] = {{1, 1}, {5, 3}, {24, 9}, {100, 17}, {320, 240}, {1921, 31}};

}  // namespace

START_TEST(every_eighth_pixel_of_every_second_row_is_a_sample_where_the_pictures_are_valid) {
  for (const Size size : kSizes)
    for (const bool all : {true, false}) {
      const Pictures p(size);
      LightSamples samples;
      samples.take(p.reference.view(), p.present.view(), all ? std::span<const RowSpan>{} : p.spans);
      ck_assert_int_eq(samples.height(), size.height);
      ck_assert_int_eq(samples.rows(), (size.height + 1) / 2);
      for (int row = 0; row < samples.rows(); ++row) {
        const int y = 2 * row;
        const RowSpan span = all ? RowSpan{0, size.width} : p.spans[static_cast<std::size_t>(y)];
        int x = span.begin + row % 8;
        samples.for_each(row, {512, 256}, [&](auto* level, auto* now, auto* value, int number) {
          ck_assert_int_ge(number, 1);
          ck_assert_int_le(number, kSampleLanes);
          for (int i = 0; i < number; ++i, x += 8) {
            ck_assert_int_lt(x, span.end);
            ck_assert_int_eq(level[i], p.reference.view().at(x, y));
            ck_assert_int_eq(now[i], std::min(2 * level[i] + 1, 255));
            ck_assert_int_eq(value[i], p.present.view().at(x, y));
          }
        });
        ck_assert_int_ge(x, span.end);
      }
    }
}
END_TEST

START_TEST(a_band_is_eight_rows_and_its_thirds_are_those_of_the_picture) {
  for (const Size size : kSizes)
    for (const bool all : {true, false}) {
      const Pictures p(size);
      LightSamples samples;
      samples.take(p.reference.view(), p.present.view(), all ? std::span<const RowSpan>{} : p.spans);
      const std::vector<RowLight> lights(static_cast<std::size_t>(size.height));
      ck_assert_int_eq(samples.bands(), (size.height + 7) / 8);
      for (int band = 0; band < samples.bands(); ++band) {
        LightSums expected;
        for (int y = 8 * band; y < std::min(8 * band + 8, size.height); y += 2) {
          const RowSpan span = all ? RowSpan{0, size.width} : p.spans[static_cast<std::size_t>(y)];
          for (int x = span.begin + y / 2 % 8; x < span.end; x += 8) {
            const int a = p.reference.view().at(x, y), b = p.present.view().at(x, y);
            if (a >= kNearWhite) continue;
            const std::size_t third = x < size.width / 3 ? 0 : x < 2 * size.width / 3 ? 1 : 2;
            ++expected.number[third];
            expected.brighter[third] += b > a;
            expected.darker[third] += b < a;
            expected.level += a;
            expected.misfit += std::min(std::abs(b - a), 16);
          }
        }
        ck_assert(samples.sums_of_band(band, lights) == expected);
      }
    }
}
END_TEST

int main() {
  return run_suite("light_samples",
                   {every_eighth_pixel_of_every_second_row_is_a_sample_where_the_pictures_are_valid,
                    a_band_is_eight_rows_and_its_thirds_are_those_of_the_picture});
}
