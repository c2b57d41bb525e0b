// SPDX-License-Identifier: LGPL-2.1-or-later
// Medians of counted grey levels, finer than the levels themselves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>

namespace cerberus::vision {

// Returns the median of `total` > 0 values, in grey levels, of which counts[i] were rounded to the level first + i: the
// values of a level are assumed to be spread evenly within half a level of it. `folded`: the values are absolute, so
// that level 0 is only half as wide. Returns 0 if the counts add up to less than half of `total`. Of 64-bit elements
// only the lower 32 bits are used.
template <typename Counts>
double median_of_levels(const Counts& counts, std::int64_t total, int first = 0, bool folded = false) {
  std::int64_t below = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const std::int64_t count = static_cast<std::uint32_t>(counts[i]);
    if (2 * (below + count) >= total && count > 0) {
      const bool half = folded && i == 0;
      const double low = half ? 0 : first + static_cast<double>(i) - 0.5, width = half ? 0.5 : 1.0;
      return low + width * (static_cast<double>(total) / 2 - static_cast<double>(below)) /
                       static_cast<double>(count);
    }
    below += count;
  }
  return 0;
}

// Returns the standard deviation, in grey levels, of normally distributed values from the histogram of their absolute
// values: 1.4826 x the median (median absolute deviation). 0 for no counts.
template <typename Counts>
double noise_sigma(const Counts& counts) {
  return 1.4826 *
         median_of_levels(counts, std::accumulate(counts.begin(), counts.end(), std::int64_t{0}), 0, true);
}

}  // namespace cerberus::vision
