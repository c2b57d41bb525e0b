// SPDX-License-Identifier: LGPL-2.1-or-later
// Medians of counted grey levels, finer than the levels themselves.
#pragma once

#include <cstddef>
#include <numeric>

namespace cerberus::vision {

// The median of `total` > 0 values of which counts[i] were rounded to the level first + i: a level stands for all values
// within half a level of it, spread evenly. `folded`: they are absolute values, so that level 0 is only half as wide.
// 0 where counts are fewer than said.
template <typename Counts>
double median_of_levels(const Counts& counts, double total, int first = 0, bool folded = false) {
  double below = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double count = counts[i];
    if (count > 0 && below + count >= total / 2) {
      const bool half = folded && i == 0;
      const double low = half ? 0 : first + static_cast<double>(i) - 0.5, width = half ? 0.5 : 1.0;
      return low + width * (total / 2 - below) / count;
    }
    below += count;
  }
  return 0;
}

// Standard deviation of what was counted by its absolute value, if it is normal: 1.4826 x the median (median absolute
// deviation). 0 for no counts.
template <typename Counts>
double noise_sigma(const Counts& counts) {
  return 1.4826 * median_of_levels(counts, std::accumulate(counts.begin(), counts.end(), 0.0), 0, true);
}

}  // namespace cerberus::vision
