// SPDX-License-Identifier: LGPL-2.1-or-later
// The columns that a frame covers in the coordinates of the background model: what lies beyond has no picture.
#pragma once

#include <span>

#include "vision/geometry/warp.h"

namespace cerberus::vision {

struct VisibleColumns {
  std::span<const RowSpan> rows;  // empty: all columns of every row
  int width = 0;                  // of the picture

  RowSpan of(int row) const { return rows.empty() ? RowSpan{0, width} : rows[static_cast<std::size_t>(row)]; }
};

}  // namespace cerberus::vision
