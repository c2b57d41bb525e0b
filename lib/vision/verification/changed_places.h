// SPDX-License-Identifier: LGPL-2.1-or-later
// Where the picture of a camera that stands has changed within some frames: places where a person may be whom no track shows yet.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vision/geometry/transform.h"
#include "vision/verification/look_schedule.h"
#include "vision/verification/verification_parameters.h"

namespace cerberus::vision {

class ChangedPlaces {
 public:
  void reset();
  // Compares `now` with the picture some frames `earlier`, cell by cell; both of one size. earlier is empty where
  // there is none, or the camera has moved since: nothing counts as changed then. seconds: since the last update.
  void update(GrayView now, GrayView earlier, double seconds, const VerificationParameters& p);
  // Share of `box`, pixels, that has changed, 0 to 1.
  double share(const Box& box) const;
  // Boxes, in pixels, around the changed cells that are near each other, but for those below `hidden` (boxes, pixels);
  // doubt: seconds since a look there. Valid until the next call.
  std::span<const LookTarget> places(std::span<const Box> hidden, const VerificationParameters& p);
  // `region`, pixels, is looked at.
  void looked(const Box& region);

 private:
  struct Cell {
    bool changed = false, free = false;
    double since_look = 0;
  };
  Cell& at(int column, int row) { return cells_[static_cast<std::size_t>(row) * columns_ + column]; }
  const Cell& at(int column, int row) const {
    return cells_[static_cast<std::size_t>(row) * columns_ + column];
  }
  Box grown(int column, int row);

  int columns_ = 0, rows_ = 0;
  std::vector<Cell> cells_;
  std::vector<double> differences_, sorted_;
  std::vector<int> waiting_;
  std::vector<LookTarget> places_;
};

}  // namespace cerberus::vision
