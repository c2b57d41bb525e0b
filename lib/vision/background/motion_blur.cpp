// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/background/motion_blur.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace cerberus::vision {
namespace {

// Origin unknown: kept from the first version. Guard of all: unit-motion_blur and bench-steady.
constexpr struct Parameters {
  int reach = 8;          // pixels at 320 columns: blur to either side
  int row_step = 4;       // sharpness is measured on every so many rows
  int least_pixels = 24;  // of a block that counts
  int texture = 60;       // squared gradient (twice the slope) a pixel, of a block that counts
  int least_blocks = 8;   // for a median
} kParameters;

// Sum of squared gradients of a block's row (m(x+1) - m(x-1), as in background_kernels.h).
int energy(GrayView picture, int y, int begin, int end) {
  const std::uint8_t *here = picture.row(y), *above = picture.row(y - 1), *below = picture.row(y + 1);
  int sum = 0;
  for (int x = begin; x < end; ++x) {
    const int gx = here[x + 1] - here[x - 1], gy = below[x] - above[x];
    sum += gx * gx + gy * gy;
  }
  return sum;
}

// A histogram of ratios in sixteenths of an octave: a median in constant memory.
class RatioCounts {
 public:
  void add(int a, int b) {
    const double octaves = std::log2((a + 1.0) / (b + 1.0));
    ++counts_[static_cast<std::size_t>(std::clamp(std::lround(octaves * kSteps) + kZero, 0L, 2L * kZero))];
    ++count_;
  }
  int count() const { return count_; }
  double median() const {
    long below = 0, step = 0;
    while ((below += counts_[static_cast<std::size_t>(step)]) * 2 <= count_) ++step;
    return std::exp2(static_cast<double>(step - kZero) / kSteps);
  }

 private:
  static constexpr long kSteps = 16, kZero = 4 * kSteps;
  std::array<int, 2 * kZero + 1> counts_{};
  int count_ = 0;
};

// Every entry becomes the least (greatest) of the `window` entries from it on, by doubling.
template <typename Choose>
void slide(std::vector<std::uint8_t>& row, int window, Choose choose) {
  const int count = static_cast<int>(row.size());
  std::uint8_t* v = row.data();
  const auto shift = [&](int by) {
    for (int x = 0; x + by < count; ++x) v[x] = choose(v[x], v[x + by]);
  };
  int covered = 1;
  for (; 2 * covered <= window; covered *= 2) shift(covered);
  if (window > covered) shift(window - covered);
}

std::uint8_t lesser(std::uint8_t a, std::uint8_t b) {
  return a < b ? a : b;
}
std::uint8_t greater(std::uint8_t a, std::uint8_t b) {
  return a > b ? a : b;
}

}  // namespace

void MotionBlur::preallocate(Size picture) {
  reach_ = std::max(2, kParameters.reach * picture.width / 320);
  for (auto* row : {&low_, &high_}) row->resize(static_cast<std::size_t>(picture.width + 2 * reach_));
}

double MotionBlur::sharpness(GrayView frame, GrayView background, GrayView age,
                             std::span<const RowSpan> spans) {
  RatioCounts ratios;
  for (int top = 0; top < frame.height; top += kBackgroundBlock) {
    const int bottom = std::min(top + kBackgroundBlock, frame.height - 1);
    for (int left = 0; left < frame.width; left += kBackgroundBlock) {
      int in_frame = 0, in_background = 0, pixels = 0;
      for (int y = std::max(top, 1); y < bottom; y += kParameters.row_step) {
        int begin = left, end = left + kBackgroundBlock;
        for (const RowSpan& span : spans.subspan(static_cast<std::size_t>(y) - 1, 3)) {
          begin = std::max(begin, span.begin + 1);
          end = std::min(end, span.end - 1);
        }
        if (begin >= end || !age.at(begin, y) || !age.at(end - 1, y)) continue;
        in_frame += energy(frame, y, begin, end);
        in_background += energy(background, y, begin, end);
        pixels += end - begin;
      }
      if (pixels >= kParameters.least_pixels &&
          std::max(in_frame, in_background) > kParameters.texture * pixels)
        ratios.add(in_frame, in_background);
    }
  }
  return ratios.count() < kParameters.least_blocks ? 1 : ratios.median();
}

void MotionBlur::find_range(GrayView sharp, int y) {
  const int first = std::max(0, y - reach_), last = std::min(sharp.height - 1, y + reach_);
  std::fill(low_.begin(), low_.end(), std::uint8_t{255});
  std::fill(high_.begin(), high_.end(), std::uint8_t{0});
  for (int v = first; v <= last; ++v) {
    const std::uint8_t* in = sharp.row(v);
    std::uint8_t *low = low_.data() + reach_, *high = high_.data() + reach_;
    for (int x = 0; x < sharp.width; ++x) {
      low[x] = lesser(low[x], in[x]);
      high[x] = greater(high[x], in[x]);
    }
  }
  slide(low_, 2 * reach_ + 1, lesser);
  slide(high_, 2 * reach_ + 1, greater);
}

void MotionBlur::suppress(GrayView blurred, GrayView sharp,
                          const std::array<std::uint8_t, kBrightness>& tolerance, MutableBitView bits,
                          MutableBitView inner) {
  for (int y = 0; y < bits.height; ++y) {
    std::uint64_t *row = bits.row(y), *within = inner.row(y);
    if (std::all_of(row, row + bits.width, [](std::uint64_t word) { return word == 0; })) continue;
    find_range(sharp, y);
    for (int word = 0; word < bits.width; ++word)
      for (std::uint64_t left = row[word]; left; left &= left - 1) {
        const int x = 64 * word + std::countr_zero(left);
        const int value = blurred.at(x, y), slack = tolerance[sharp.at(x, y) >> 4];
        if (value < low_[static_cast<std::size_t>(x)] - slack ||
            value > high_[static_cast<std::size_t>(x)] + slack)
          continue;
        const std::uint64_t bit = left & -left;
        row[word] &= ~bit;
        within[word] &= ~bit;
      }
  }
}

}  // namespace cerberus::vision
