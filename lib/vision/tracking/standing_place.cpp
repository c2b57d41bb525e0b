// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/standing_place.h"

#include <cmath>
#include <cstdlib>

namespace cerberus::vision {

// A small box has fewer cells than there is room for; the others are 0. What is outside the picture is left out.
StandingPlace::Cells StandingPlace::cells_of(GrayView picture) const {
  Cells cells{};
  const int columns = std::clamp(static_cast<int>(box_.width) / kCell, 1, kColumns);
  const int rows = std::clamp(static_cast<int>(box_.height) / kCell, 1, kRows);
  const auto edge = [](double from, double extent, int k, int count, int most) {
    return static_cast<int>(std::lround(std::clamp(from + extent * k / count, 0.0, 1.0 * most)));
  };
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int x0 = edge(box_.x, box_.width, c, columns, picture.width),
                x1 = edge(box_.x, box_.width, c + 1, columns, picture.width),
                y0 = edge(box_.y, box_.height, r, rows, picture.height),
                y1 = edge(box_.y, box_.height, r + 1, rows, picture.height);
      long sum = 0;
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) sum += picture.at(x, y);
      const long pixels = static_cast<long>(x1 - x0) * (y1 - y0);
      if (pixels > 0)
        cells[static_cast<std::size_t>(r) * kColumns + c] = static_cast<std::uint8_t>(sum / pixels);
    }
  return cells;
}

double StandingPlace::difference(GrayView picture) const {
  const Cells now = cells_of(picture);
  int sum = 0;
  for (std::size_t i = 0; i < now.size(); ++i) sum += std::abs(now[i] - before_[i]);
  return sum;
}

void StandingPlace::begin(const Box& box, GrayView background) {
  forget();
  box_ = box;
  before_ = cells_of(background);
}

void StandingPlace::carry(const Transform& motion) {
  const Point first = motion.apply({box_.x, box_.y}), last = motion.apply({box_.right(), box_.bottom()});
  box_ = {first.x, first.y, last.x - first.x, last.y - first.y};
  if (!(box_.width > 0 && box_.height > 0) || !std::isfinite(box_.area())) forget();
}

void StandingPlace::learn(GrayView picture) {
  filled_ += (difference(picture) - filled_) / ++frames_;
}

bool StandingPlace::left(GrayView picture) const {
  return 2 * difference(picture) < filled_;
}

}  // namespace cerberus::vision
