// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/persons/body_boxes.h"

#include <algorithm>
#include <span>
#include <tuple>

namespace cerberus::vision {

namespace {

bool comes_first(const PersonDetection& a, const PersonDetection& b) {
  return std::tuple(-a.score, a.box.x, a.box.y, a.box.width, a.box.height) <
         std::tuple(-b.score, b.box.x, b.box.y, b.box.width, b.box.height);
}

// Greedy: each detection stays that is the same as none before it with a better score.
template <typename Same>
void keep_best(std::vector<PersonDetection>& detections, Same&& same) {
  std::ranges::sort(detections, comes_first);
  std::size_t kept = 0;
  for (const PersonDetection& each : detections)
    if (std::ranges::none_of(std::span(detections).first(kept),
                             [&](const PersonDetection& better) { return same(better.box, each.box); }))
      detections[kept++] = each;
  detections.resize(kept);
}

}  // namespace

void suppress_overlaps(std::vector<PersonDetection>& hits, const BodyBoxParameters& p) {
  keep_best(hits, [&](const Box& a, const Box& b) { return intersection_over_union(a, b) > p.same_window; });
}

bool is_one_body(const Box& a, const Box& b, const BodyBoxParameters& p) {
  const double smaller = std::min(a.area(), b.area());
  return smaller > 0 && overlap_area(a, b) >= p.nested * smaller;
}

void keep_one_box_a_body(std::vector<PersonDetection>& bodies, const BodyBoxParameters& p) {
  keep_best(bodies, [&](const Box& a, const Box& b) { return is_one_body(a, b, p); });
}

void hits_to_bodies(std::vector<PersonDetection>& hits, BodyShare share, const BodyBoxParameters& p) {
  suppress_overlaps(hits, p);
  for (PersonDetection& hit : hits) hit.box = core_of(hit.box, share.width, share.height);
  keep_one_box_a_body(hits, p);
}

}  // namespace cerberus::vision
