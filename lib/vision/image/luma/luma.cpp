// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/image/luma/luma.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "vision/image/luma/luma_kernels.h"

namespace cerberus::vision {

namespace {

// Weight of each of the bytes that make one pixel's luma, in 256ths.
struct ByteWeight {
  int offset, weight;
};
using PixelWeights = std::array<ByteWeight, 3>;

PixelWeights pixel_weights(const LumaSource& s) {
  if (!s.rgb) return {{{0, 256}, {0, 0}, {0, 0}}};
  return {{{s.r, 77}, {s.g, 150}, {s.b, 29}}};
}

// Area averaging along one axis in units of 1 / target source samples: source sample i covers [i t, (i + 1)
// t), target sample j covers [j s, (j + 1) s); their overlap is a whole number.
std::int64_t overlap(int i, int j, int source, int target) {
  const std::int64_t low = std::max<std::int64_t>(std::int64_t{i} * target, std::int64_t{j} * source);
  const std::int64_t high =
      std::min<std::int64_t>(std::int64_t{i + 1} * target, std::int64_t{j + 1} * source);
  return std::max<std::int64_t>(high - low, 0);
}

int first_source(int j, int source, int target) {
  return static_cast<int>(std::int64_t{j} * source / target);
}

// Returns one past the last source sample that overlaps target sample j.
int end_source(int j, int source, int target) {
  return static_cast<int>((std::int64_t{j + 1} * source + target - 1) / target);
}

// Luma of one word of 16 bits.
std::uint8_t word_luma(const std::uint8_t* bytes, const LumaSource& s, const WordStretch& stretch) {
  std::uint16_t word;
  std::memcpy(&word, bytes, sizeof word);
  if (s.swapped) word = static_cast<std::uint16_t>(word << 8 | word >> 8);
  if (stretch.span == 0) return static_cast<std::uint8_t>(std::min(255, word >> s.word_shift));
  const auto above = static_cast<std::uint32_t>(std::clamp(word - s.low, 0, s.span)) << stretch.shift;
  return static_cast<std::uint8_t>(std::min(255U, above * stretch.factor >> 16));
}

void copy(const LumaSource& s, MutableGrayView target) {
  const WordStretch stretch = stretch_of(s.low, s.span);
  for (int y = 0; y < target.height; ++y) {
    const std::uint8_t* in = s.data + y * s.stride;
    std::uint8_t* out = target.row(y);
    if (s.word_shift > 0) {
      for (int x = 0; x < s.width; ++x, in += s.pixel_stride) out[x] = word_luma(in, s, stretch);
    } else if (!s.rgb && s.pixel_stride == 1) {
      std::memcpy(out, in, static_cast<std::size_t>(s.width));
    } else if (!s.rgb) {
      for (int x = 0; x < s.width; ++x, in += s.pixel_stride) out[x] = *in;
    } else {
      for (int x = 0; x < s.width; ++x, in += s.pixel_stride)
        out[x] = static_cast<std::uint8_t>((77 * in[s.r] + 150 * in[s.g] + 29 * in[s.b] + 128) >> 8);
    }
  }
}

bool same_layout(const LumaSource& a, const LumaSource& b) {
  return a.width == b.width && a.height == b.height && a.pixel_stride == b.pixel_stride && a.rgb == b.rgb &&
         a.r == b.r && a.g == b.g && a.b == b.b && (a.word_shift > 0) == (b.word_shift > 0);
}

// Distance between two pixels in a row of vertical averages, in samples: the pixel stride for bytes, 1 for words.
int sum_stride(const LumaSource& s) {
  return s.word_shift > 0 ? 1 : s.pixel_stride;
}

}  // namespace

Size analysis_size(Size frame, int analysis_width) {
  Size size = frame;
  if (analysis_width > 0 && analysis_width < frame.width) {
    const double height = static_cast<double>(frame.height) * analysis_width / frame.width;
    size = {analysis_width, std::min(frame.height, std::max(16, static_cast<int>(std::lround(height))))};
  }
  const double side = kMaximumAnalysisSide, area = kMaximumAnalysisArea;
  const double scale = std::min({1.0, side / size.width, side / size.height, std::sqrt(area / size.area())});
  if (scale == 1) return size;
  // Rounded down: 16 rows of the largest width are far below the area.
  return {std::max(1, static_cast<int>(scale * size.width)),
          std::min(frame.height, std::max(16, static_cast<int>(scale * size.height)))};
}

void LumaScaler::prepare_rows(int source_height, int target_height) {
  rows_.resize({target_height, 1});
  // Uses as many fraction bits as keep the weighted sum within 16 bits: the weights add up to (128, 256], plus 1 by
  // rounding.
  const double ratio = static_cast<double>(source_height) / target_height;
  shift_ = 0;
  while (shift_ < 8 && ratio * (2 << shift_) <= 256.0) ++shift_;
  const double unit = static_cast<double>(1 << shift_) / target_height;
  for (int y = 0; y < target_height; ++y) {
    Rows& r = rows_.view().at(y, 0);
    r.first = first_source(y, source_height, target_height);
    r.count = end_source(y, source_height, target_height) - r.first;
    const auto weight = [&](int i) {
      return static_cast<std::uint16_t>(std::lround(unit * overlap(i, y, source_height, target_height)));
    };
    r.first_weight = weight(r.first);
    r.last_weight = r.count > 1 ? weight(r.first + r.count - 1) : 0;
    const int sum = r.first_weight + r.last_weight + (std::max(r.count - 2, 0) << shift_);
    r.reciprocal = static_cast<std::uint16_t>(std::min(65535, (65536 * 128 + sum - 1) / sum));
  }
}

void LumaScaler::prepare_columns(const LumaSource& source, int target_width) {
  const PixelWeights pixel = pixel_weights(source);
  int last_byte = 0;  // of a pixel
  for (const ByteWeight& p : pixel) last_byte = std::max(last_byte, p.offset);
  const int stride = sum_stride(source);
  used_ = (source.width - 1) * stride + last_byte + 1;
  int longest = 0;
  for (int j = 0; j < target_width; ++j)
    longest = std::max(
        longest, end_source(j, source.width, target_width) - first_source(j, source.width, target_width));
  blocks_ = (longest * stride + 7) / 8;
  first_.resize({target_width, 1});
  weights_.resize({target_width * blocks_ * 8, 1});
  weights_.fill_bytes(0);
  column_sums_.resize({used_ + 8 * blocks_, 1});
  column_sums_.fill_bytes(0);
  for (int j = 0; j < target_width; ++j) {
    const int first = first_source(j, source.width, target_width);
    const int end = end_source(j, source.width, target_width);
    first_.view().at(j, 0) = first * stride;
    std::int16_t* weights = weights_.view().data + static_cast<std::ptrdiff_t>(j) * blocks_ * 8;
    // Cumulative rounding: the weights add up to 2^14 exactly.
    double exact = 0;
    int given = 0;
    for (int i = first; i < end; ++i)
      for (const ByteWeight& p : pixel) {
        exact += 16384.0 * p.weight / 256 * overlap(i, j, source.width, target_width) / source.width;
        const int now = static_cast<int>(std::lround(exact));
        weights[(i - first) * stride + p.offset] += static_cast<std::int16_t>(now - given);
        given = now;
      }
  }
}

void LumaScaler::prepare(const LumaSource& source, Size target) {
  if (same_layout(source, source_) && target == target_) return;
  prepare_rows(source.height, target.height);
  prepare_columns(source, target.width);
  source_ = source;
  target_ = target;
}

void LumaScaler::scale(const LumaSource& source, MutableGrayView target) {
  if (target.empty() || source.width <= 0 || source.height <= 0) return;
  if (source.width == target.width && source.height == target.height) return copy(source, target);
  // The vertical sums would exceed 16 bits: use the reference. No real video has this ratio.
  if (source.height / 256 >= target.height) return scale_luma_reference(source, target);
  prepare(source, target.size());
  for (int y = 0; y < target.height; ++y) {
    const Rows& r = rows_.view().at(y, 0);
    average_rows(
        {source.data + r.first * source.stride, source.stride, r.count, shift_, r.first_weight, r.last_weight,
         r.reciprocal, source.word_shift, source.swapped, stretch_of(source.low, source.span)},
        used_, column_sums_.view().data);
    average_columns(column_sums_.view().data, first_.view().data, weights_.view().data, blocks_, target.width,
                    target.row(y));
  }
}

void scale_luma_reference(const LumaSource& source, MutableGrayView target) {
  const PixelWeights pixel = pixel_weights(source);
  const WordStretch stretch = stretch_of(source.low, source.span);
  const std::int64_t whole = std::int64_t{256} * source.width * source.height;
  for (int y = 0; y < target.height; ++y)
    for (int x = 0; x < target.width; ++x) {
      std::int64_t total = 0;
      for (int v = first_source(y, source.height, target.height);
           v < end_source(y, source.height, target.height); ++v)
        for (int u = first_source(x, source.width, target.width);
             u < end_source(x, source.width, target.width); ++u) {
          const std::uint8_t* p = source.data + v * source.stride + std::ptrdiff_t{u} * source.pixel_stride;
          const std::int64_t area =
              overlap(v, y, source.height, target.height) * overlap(u, x, source.width, target.width);
          if (source.word_shift > 0)
            total += area * 256 * word_luma(p, source, stretch);
          else
            for (const ByteWeight& w : pixel) total += area * w.weight * p[w.offset];
        }
      target.at(x, y) = static_cast<std::uint8_t>((total + whole / 2) / whole);
    }
}

}  // namespace cerberus::vision
