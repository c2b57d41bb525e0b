// SPDX-License-Identifier: LGPL-2.1-or-later
// Free ways through a floor plan, on cells of 10 cm. Metres.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/house/floor_plan.h"

namespace cerberus::sim {

struct Spot {
  double x = 0, y = 0;
};

class Ways {
 public:
  // clearance: from walls, furniture and pillars.
  Ways(const FloorPlan& plan, double clearance);

  // With the clearance around it.
  bool free(const Spot& spot) const { return at(free_, spot); }
  // The straight line between both is free.
  bool leads(const Spot& from, const Spot& to) const { return straight(free_, from, to); }
  // Nothing as high as a robot stands between both.
  bool sees(const Spot& from, const Spot& to) const { return straight(open_, from, to); }
  // The corners of a short way without its begin, the end last; empty: there is none.
  std::vector<Spot> way(const Spot& from, const Spot& to) const;
  // The free cells of a space.
  std::vector<Spot> places(const Space& space) const;

 private:
  static constexpr double kCell = .1;  // metres
  using Cells = std::vector<std::uint8_t>;

  int index(const Spot& spot) const;
  Spot middle(int index) const;
  bool at(const Cells& cells, const Spot& spot) const;
  bool straight(const Cells& cells, const Spot& from, const Spot& to) const;

  double left_ = 0, top_ = 0;
  int columns_ = 0, rows_ = 0;
  Cells free_;
  Cells open_;  // no wall, no pillar, nothing that is higher than a robot's sensors
};

}  // namespace cerberus::sim
