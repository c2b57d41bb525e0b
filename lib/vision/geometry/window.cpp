// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/geometry/window.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cerberus::vision {

namespace {

constexpr int kBits = 7, kOne = 1 << kBits;

constexpr bool is_pinhole(double fov) {
  return fov > 0 && fov < std::numbers::pi;
}

double centred(double angle) {
  return std::isnan(angle) ? 0 : std::clamp(angle, -1.5, 1.5);
}

// Position of target sample i in 1/128 source sample, limited to the source.
int position(double start, double scale, int i, int size) {
  const double p = start + (i + 0.5) * scale - 0.5;
  return static_cast<int>(std::clamp(std::floor(p * kOne + 0.5), 0.0, (size - 1.0) * kOne));
}

}  // namespace

WindowGeometry::WindowGeometry(double wide_fov, Size picture, Size window, double fov) {
  if (!is_pinhole(wide_fov) || picture.width <= 0 || picture.height <= 0 || window.width <= 0 ||
      window.height <= 0)
    return;
  focal_ = 0.5 * picture.width / std::tan(0.5 * wide_fov);
  if (fov != 0) {
    if (!is_pinhole(fov)) return;
    scale_ = 2 * focal_ * std::tan(0.5 * fov) / window.width;
  }
  middle_x_ = 0.5 * picture.width;
  middle_y_ = 0.5 * picture.height;
  half_x_ = 0.5 * scale_ * window.width;
  half_y_ = 0.5 * scale_ * window.height;
  // Tolerance in pixels for rounding, so that a window as large as the whole picture fits.
  constexpr double kHair = 1.0 / 256;
  fits_ = half_x_ <= middle_x_ + kHair && half_y_ <= middle_y_ + kHair;
}

double WindowGeometry::fov() const {
  return 2 * std::atan(half_x_ / focal_);
}

double WindowGeometry::pan_reach() const {
  return std::atan(std::max(0.0, middle_x_ - half_x_) / focal_);
}

double WindowGeometry::tilt_reach() const {
  return std::atan(std::max(0.0, middle_y_ - half_y_) / focal_);
}

WindowGeometry::Place WindowGeometry::at(double pan, double tilt) const {
  const double far_x = std::max(0.0, middle_x_ - half_x_), far_y = std::max(0.0, middle_y_ - half_y_);
  const double wanted_x = focal_ * std::tan(centred(pan));
  const double x = std::clamp(wanted_x, -far_x, far_x);
  const double real_pan = std::atan(x / focal_);
  const double wanted_y = focal_ * std::tan(centred(tilt)) / std::cos(real_pan);
  const double y = std::clamp(wanted_y, -far_y, far_y);
  Place place;
  place.left = middle_x_ + x - half_x_;
  place.top = middle_y_ - y - half_y_;
  place.pan = real_pan;
  place.tilt = std::atan(y * std::cos(real_pan) / focal_);
  place.limited = std::abs(wanted_x - x) > 1e-6 || std::abs(wanted_y - y) > 1e-6;
  return place;
}

bool WindowResampler::find_columns(int width, int count, double left, double scale, int channels) {
  columns_.resize(static_cast<std::size_t>(count));
  begin_ = position(left, scale, 0, width) / kOne;
  bool regular = true;
  for (int i = 0; i < count; ++i) {
    const int p = position(left, scale, i, width), x = p / kOne;
    const int next = std::min(x + 1, width - 1);
    Column& column = columns_[static_cast<std::size_t>(i)];
    column = {(x - begin_) * channels, (next - begin_) * channels, p % kOne};
    end_ = next + 1;
    regular = regular && x == begin_ + i && column.weight == columns_[0].weight &&
              (next == x + 1 || column.weight == 0);
  }
  return regular;
}

void WindowResampler::draw(const Samples<const std::uint8_t>& source, const Samples<std::uint8_t>& target,
                           const Grid& grid) {
  if (source.width <= 0 || source.height <= 0 || target.width <= 0 || target.height <= 0) return;
  const int channels = target.channels;
  const bool regular = find_columns(source.width, target.width, grid.left, grid.scale_x, channels);
  const bool dense = source.step == channels && target.step == channels;
  const int wide = (end_ - begin_) * channels, across = target.width * channels;
  // The line has one sample more, because the regular loop also reads the right neighbour of the last sample.
  line_.resize(static_cast<std::size_t>(std::max(wide, across) + channels));
  std::uint16_t* line = line_.data();
  for (int j = 0; j < target.height; ++j) {
    const int p = position(grid.top, grid.scale_y, j, source.height), y = p / kOne;
    const int lower = p % kOne, upper = kOne - lower;
    const std::uint8_t* a =
        source.data + y * source.stride + static_cast<std::ptrdiff_t>(begin_) * source.step;
    const std::uint8_t* b = y + 1 < source.height ? a + source.stride : a;
    if (source.step == channels) {
      for (int k = 0; k < wide; ++k) line[k] = static_cast<std::uint16_t>(a[k] * upper + b[k] * lower);
    } else {
      for (int x = 0, k = 0; x < end_ - begin_; ++x)
        for (int c = 0; c < channels; ++c, ++k) {
          const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x) * source.step + c;
          line[k] = static_cast<std::uint16_t>(a[at] * upper + b[at] * lower);
        }
    }
    std::uint8_t* out = target.data + j * target.stride;
    constexpr int kHalf = 1 << (2 * kBits - 1);
    if (regular && dense) {
      const int right = columns_[0].weight, left = kOne - right;
      const std::uint16_t* next = line + channels;
      for (int k = 0; k < across; ++k)
        out[k] = static_cast<std::uint8_t>((line[k] * left + next[k] * right + kHalf) >> (2 * kBits));
    } else {
      for (int i = 0; i < target.width; ++i) {
        const Column& column = columns_[static_cast<std::size_t>(i)];
        for (int c = 0; c < channels; ++c)
          out[static_cast<std::ptrdiff_t>(i) * target.step + c] =
              static_cast<std::uint8_t>((line[column.first + c] * (kOne - column.weight) +
                                         line[column.second + c] * column.weight + kHalf) >>
                                        (2 * kBits));
      }
    }
  }
}

}  // namespace cerberus::vision
