// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/best_moment.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace cerberus::record {

namespace {

// The part of the box that lies in the frame, in whole pixels.
struct Part {
  int left, top, right, bottom;
  bool empty() const { return left >= right || top >= bottom; }
};

Part part_of(const vision::Box& box, vision::Size frame) {
  const auto limited = [](double value, int most) {
    return static_cast<int>(std::clamp(std::isfinite(value) ? value : 0.0, 0.0, static_cast<double>(most)));
  };
  return {limited(box.x, frame.width), limited(box.y, frame.height), limited(box.right(), frame.width),
          limited(box.bottom(), frame.height)};
}

}  // namespace

double sharpness(vision::GrayView luma, const vision::Box& box, const BestMomentParameters& parameters) {
  Part part = part_of(box, luma.size());
  part.right = std::min(part.right, luma.width - 1);  // a neighbour to the right and below
  part.bottom = std::min(part.bottom, luma.height - 1);
  if (part.empty()) return 0;
  const double area = static_cast<double>(part.right - part.left) * (part.bottom - part.top);
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(area / parameters.most_samples))));
  long sum = 0, count = 0;
  for (int y = part.top; y < part.bottom; y += step)
    for (int x = part.left; x < part.right; x += step, ++count)
      sum += std::abs(luma.at(x, y) - luma.at(x + 1, y)) + std::abs(luma.at(x, y) - luma.at(x, y + 1));
  return static_cast<double>(sum) / static_cast<double>(2 * count);
}

double view_score(const vision::Box& box, vision::Size frame, double sharpness,
                  const BestMomentParameters& parameters) {
  const Part part = part_of(box, frame);
  if (part.empty()) return 0;
  const double width = part.right - part.left, height = part.bottom - part.top;
  const double share = width * height / static_cast<double>(frame.area());
  const double dx = (part.left + part.right - frame.width) / 2.0;
  const double dy = (part.top + part.bottom - frame.height) / 2.0;
  const double distance = std::hypot(dx, dy) / (std::hypot(frame.width, frame.height) / 2);
  // A picture of an even surface still shows where the object is.
  const double sharp = (sharpness + 1) / (sharpness + 1 + parameters.half_sharp);
  return std::sqrt(share) * sharp * (1 - parameters.corner_loss * distance);
}

}  // namespace cerberus::record
