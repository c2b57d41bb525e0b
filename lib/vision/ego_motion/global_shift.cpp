// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/ego_motion/global_shift.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "vision/ego_motion/motion_kernels.h"

namespace cerberus::vision {

namespace {

// Relief values are 128 +- 64, the border 255 against padding 0 or relief: any pixel without a partner adds
// exactly kLimit, which is subtracted afterwards.
constexpr int kMiddle = 128, kRange = 64, kLimit = 63;
constexpr int kStride = 96, kBorder = 16;  // of the later picture: 16 columns left and right of 64
// Origin unknown: kept from the first version. Guard: bench-camera_motion.
constexpr struct Parameters {
  double mean_relief = 24;  // grey levels: mean amount to which a relief is amplified,
  double most_gain = 12;    // by this factor at most
  int reach = 4;            // 1/n of either side: the largest shift
  int apart = 2;            // pixels in either direction: a second shift so close is the first
} kParameters;

}  // namespace

void Relief::build(GrayView picture) {
  // A very long and narrow picture cannot be reduced to kMaxSide: it has no relief, and no shift is found.
  const bool fits = picture.width <= kMaxSide && picture.height <= kMaxSide;
  const Size size = fits ? picture.size() : Size{};
  values_.resize(size);
  std::array<int, kMaxSide * kMaxSide> stands_out;
  std::array<int, kMaxSide> columns;
  long total = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      columns[x] = 0;
      for (int j = -2; j <= 2; ++j) columns[x] += picture.at(x, std::clamp(y + j, 0, size.height - 1));
    }
    for (int x = 0; x < size.width; ++x) {
      int sum = 0;
      for (int i = -2; i <= 2; ++i) sum += columns[std::clamp(x + i, 0, size.width - 1)];
      const int value = 25 * picture.at(x, y) - sum;
      stands_out[y * size.width + x] = value;
      total += std::abs(value);
    }
  }
  contrast_ = size.area() ? total / 25.0 / size.area() : 0;
  const Parameters& q = kParameters;
  const double gain = std::min(q.most_gain, contrast_ > 0 ? q.mean_relief / contrast_ : q.most_gain) / 25;
  const int gain16 = static_cast<int>(gain * 65536);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const int value = (static_cast<std::int64_t>(stands_out[y * size.width + x]) * gain16) >> 16;
      values_.view().at(x, y) = static_cast<std::uint8_t>(kMiddle + std::clamp(value, -kRange, kRange));
    }
}

std::array<Shift, 2> ShiftSearch::run(const Relief& earlier, const Relief& later) {
  const Parameters& q = kParameters;
  const Size size = earlier.size();
  if (size != later.size() || size.area() == 0) return {};
  const int rx = std::min(size.width / q.reach, kBorder), ry = std::min(size.height / q.reach, kBorder);
  const int columns = 2 * rx + 1, rows = 2 * ry + 1;
  alignas(64) std::array<std::uint8_t, kStride * Relief::kMaxSide> bordered;  // for every shift
  bordered.fill(255);
  for (int y = 0; y < size.height; ++y)
    std::copy_n(later.values_.view().row(y), size.width, &bordered[y * kStride + kBorder]);
  const GrayView first = earlier.values_.view();
  const int padded = static_cast<int>(first.stride);
  std::array<float, (2 * kBorder + 1) * (2 * kBorder + 1)> map;
  for (int dy = -ry; dy <= ry; ++dy)
    for (int dx = -rx; dx <= rx; ++dx) {
      const int begin = std::max(0, -dy), end = std::min(size.height, size.height - dy);
      const std::uint32_t sum =
          truncated_difference(first.row(begin), padded, &bordered[(begin + dy) * kStride + kBorder + dx],
                               kStride, padded, end - begin, kLimit);
      const int partners = (size.width - std::abs(dx)) * (end - begin);
      const int without = padded * (end - begin) - partners;
      map[(dy + ry) * columns + dx + rx] =
          static_cast<float>(sum - static_cast<std::uint32_t>(kLimit * without)) /
          static_cast<float>(partners) / static_cast<float>(q.mean_relief);
    }
  const auto at = [&](int dx, int dy) { return map[(dy + ry) * columns + dx + rx]; };
  // Vertex of the parabola through three neighbours.
  const auto vertex = [](float a, float b, float c) {
    const float curve = a - 2 * b + c;
    return curve > 0 ? std::clamp(0.5f * (a - c) / curve, -0.5f, 0.5f) : 0.0f;
  };
  std::array<Shift, 2> best;
  int first_x = 0, first_y = 0;
  for (int rank = 0; rank < 2; ++rank) {
    int bx = 0, by = 0;
    float least = 1e9f;
    for (int dy = -ry; dy < -ry + rows; ++dy)
      for (int dx = -rx; dx <= rx; ++dx) {
        if (rank == 1 && std::abs(dx - first_x) <= q.apart && std::abs(dy - first_y) <= q.apart) continue;
        if (at(dx, dy) < least) least = at(dx, dy), bx = dx, by = dy;
      }
    const float fx = std::abs(bx) < rx ? vertex(at(bx - 1, by), least, at(bx + 1, by)) : 0.0f;
    const float fy = std::abs(by) < ry ? vertex(at(bx, by - 1), least, at(bx, by + 1)) : 0.0f;
    best[rank] = {bx + double{fx}, by + double{fy}, double{least}};
    first_x = bx, first_y = by;
  }
  return best;
}

}  // namespace cerberus::vision
