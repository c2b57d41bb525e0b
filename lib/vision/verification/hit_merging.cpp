// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/verification/hit_merging.h"

#include <algorithm>
#include <tuple>

namespace cerberus::vision {

namespace {

constexpr double kOnePerson = 0.5;  // intersection over union with the surest hit
constexpr double kWithin = 0.6;     // share of the smaller that lies in the larger one: a part

bool comes_first(const PersonDetection& a, const PersonDetection& b) {
  return std::tuple(-a.score, a.box.x, a.box.y, a.box.width) <
         std::tuple(-b.score, b.box.x, b.box.y, b.box.width);
}

}  // namespace

void merge_hits(std::vector<PersonDetection>& hits, double floor, double apart) {
  std::ranges::sort(hits, comes_first);
  std::size_t kept = 0;
  while (kept < hits.size()) {
    const PersonDetection best = hits[kept];
    double weights = 0;
    Box mean;
    std::size_t left = kept + 1;
    for (std::size_t i = kept; i < hits.size(); ++i) {
      const PersonDetection hit = hits[i];
      const double shared = intersection_over_union(best.box, hit.box);
      if (i == kept || shared > kOnePerson) {
        const double weight = std::max(hit.score - floor, 1e-3);
        weights += weight;
        mean.x += weight * hit.box.x, mean.y += weight * hit.box.y;
        mean.width += weight * hit.box.width, mean.height += weight * hit.box.height;
      } else if (shared <= apart &&
                 overlap_area(best.box, hit.box) < kWithin * std::min(hit.box.area(), best.box.area())) {
        hits[left++] = hit;
      }
    }
    hits[kept++] = {{mean.x / weights, mean.y / weights, mean.width / weights, mean.height / weights},
                    best.score};
    hits.resize(left);
  }
}

}  // namespace cerberus::vision
