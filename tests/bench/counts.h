// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace cerberus::bench {

// Of pixels or boxes.
struct Counts {
  double hit = 0, extra = 0, missed = 0;
  double precision() const { return hit + extra > 0 ? hit / (hit + extra) : 0; }
  double recall() const { return hit + missed > 0 ? hit / (hit + missed) : 0; }
  double f() const { return hit > 0 ? 2 * hit / (2 * hit + extra + missed) : 0; }
};

}  // namespace cerberus::bench
