// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/house/ways.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>

namespace cerberus::sim {
namespace {

constexpr double kSensors = .8;  // metres: the height of the paper's sensors
constexpr double kTallest = 2;   // metres: people are at most 1.9 m tall, and walk below what hangs higher

// Of a place to what stands there; 0: inside it.
double distance(const Rectangle& area, double x, double y) {
  return std::hypot(std::max({area.left - x, 0., x - area.right}),
                    std::max({area.top - y, 0., y - area.bottom}));
}

}  // namespace

Ways::Ways(const FloorPlan& plan, double clearance) {
  double right = -1e9, bottom = -1e9;
  left_ = top_ = 1e9;
  for (const Space& space : plan.spaces) {
    left_ = std::min(left_, space.area.left), top_ = std::min(top_, space.area.top);
    right = std::max(right, space.area.right), bottom = std::max(bottom, space.area.bottom);
  }
  columns_ = int(std::ceil((right - left_) / kCell)), rows_ = int(std::ceil((bottom - top_) / kCell));
  const std::size_t cells = std::size_t(columns_) * rows_;
  free_.resize(cells), open_.resize(cells);
  const auto blocked = [&](double x, double y, double near, double above, double below) {
    return std::ranges::any_of(plan.boxes,
                               [&](const Furniture& b) {
                                 return b.height > above && b.from < below && distance(b.area, x, y) <= near;
                               }) ||
           std::ranges::any_of(plan.pillars, [&](const Pillar& p) {
             return std::hypot(p.x - x, p.y - y) <= p.radius + near;
           });
  };
  // Walls are where no space is: all around a free place there is one.
  constexpr int kAround = 24;
  const auto walled = [&](double x, double y) {
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2 * std::numbers::pi * i / kAround;
      if (plan.space_at(x + clearance * std::cos(angle), y + clearance * std::sin(angle)) < 0) return true;
    }
    return false;
  };
  for (std::size_t i = 0; i < cells; ++i) {
    const auto [x, y] = middle(int(i));
    if (plan.space_at(x, y) < 0) continue;
    open_[i] = !blocked(x, y, 0, kSensors, kSensors);
    free_[i] = !blocked(x, y, clearance, 0, kTallest) && !walled(x, y);
  }
}

int Ways::index(const Spot& spot) const {
  const int column = int(std::floor((spot.x - left_) / kCell)),
            row = int(std::floor((spot.y - top_) / kCell));
  return column < 0 || row < 0 || column >= columns_ || row >= rows_ ? -1 : row * columns_ + column;
}

Spot Ways::middle(int index) const {
  return {left_ + (index % columns_ + .5) * kCell, top_ + (index / columns_ + .5) * kCell};
}

bool Ways::at(const Cells& cells, const Spot& spot) const {
  const int i = index(spot);
  return i >= 0 && cells[i] != 0;
}

// From cell to cell along the line (Amanatides and Woo, 1987).
bool Ways::straight(const Cells& cells, const Spot& from, const Spot& to) const {
  const double x = (from.x - left_) / kCell, y = (from.y - top_) / kCell;
  const double along_x = (to.x - from.x) / kCell, along_y = (to.y - from.y) / kCell;
  int column = int(std::floor(x)), row = int(std::floor(y));
  const int left =
      std::abs(int(std::floor(x + along_x)) - column) + std::abs(int(std::floor(y + along_y)) - row);
  // The line's share at the next border of cells, and from one border to the next.
  const auto next = [](double at, double along) {
    return along == 0 ? 1e9 : (along > 0 ? std::floor(at) + 1 - at : at - std::floor(at)) / std::abs(along);
  };
  double next_x = next(x, along_x), next_y = next(y, along_y);
  for (int i = 0;; ++i) {
    if (column < 0 || row < 0 || column >= columns_ || row >= rows_ || !cells[row * columns_ + column])
      return false;
    if (i == left) return true;
    if (next_x < next_y)
      column += along_x > 0 ? 1 : -1, next_x += 1 / std::abs(along_x);
    else
      row += along_y > 0 ? 1 : -1, next_y += 1 / std::abs(along_y);
  }
}

// The A* algorithm (Hart, Nilsson, Raphael, 1968) over eight neighbours; then corners that a straight line avoids go.
std::vector<Spot> Ways::way(const Spot& from, const Spot& to) const {
  if (!free(from) || !free(to)) return {};
  const int begin = index(from), end = index(to);
  constexpr int kFar = std::numeric_limits<int>::max(), kStraight = 10, kDiagonal = 14;
  std::vector<int> cost(free_.size(), kFar), before(free_.size(), -1);
  const auto least = [&](int i) {
    const int x = std::abs(i % columns_ - end % columns_), y = std::abs(i / columns_ - end / columns_);
    return kStraight * std::max(x, y) + (kDiagonal - kStraight) * std::min(x, y);
  };
  using Entry = std::pair<int, int>;  // cost at least, cell
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  cost[begin] = 0;
  open.push({least(begin), begin});
  while (!open.empty() && open.top().second != end) {
    const auto [whole, here] = open.top();
    open.pop();
    if (whole > cost[here] + least(here)) continue;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const int column = here % columns_ + dx, row = here / columns_ + dy;
        if (column < 0 || row < 0 || column >= columns_ || row >= rows_) continue;
        const int next = row * columns_ + column;
        const int more = cost[here] + (dx != 0 && dy != 0 ? kDiagonal : kStraight);
        const bool corner = !free_[here + dx] || !free_[here + dy * columns_];  // not past one
        if (!free_[next] || corner || more >= cost[next]) continue;
        cost[next] = more, before[next] = here;
        open.push({more + least(next), next});
      }
  }
  if (open.empty()) return {};
  std::vector<Spot> cells{to};
  for (int i = before[end]; i >= 0 && i != begin; i = before[i]) cells.push_back(middle(i));
  std::ranges::reverse(cells);
  std::vector<Spot> corners;
  Spot here = from;
  for (std::size_t next = 0; next < cells.size(); ++next) {
    while (next + 1 < cells.size() && straight(free_, here, cells[next + 1])) ++next;
    corners.push_back(here = cells[next]);
  }
  return corners;
}

std::vector<Spot> Ways::places(const Space& space) const {
  std::vector<Spot> places;
  for (std::size_t i = 0; i < free_.size(); ++i)
    if (const Spot spot = middle(int(i)); free_[i] && space.area.contains(spot.x, spot.y))
      places.push_back(spot);
  return places;
}

}  // namespace cerberus::sim
