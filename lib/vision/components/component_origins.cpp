// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/components/component_origins.h"

#include <algorithm>
#include <bit>

namespace cerberus::vision {
namespace {

// Origin unknown: kept from the first version. Guard: unit-component_origins.
constexpr struct Parameters {
  int beside = 2;  // pixels to either side where a component that moved on is found again
} kParameters;

}  // namespace

void ComponentOrigins::preallocate(Size picture) {
  for (auto* bits : {&differed_, &inside_}) bits->resize(bit_mask_size(picture));
  reset();
}

void ComponentOrigins::reset() {
  for (auto* bits : {&differed_, &inside_}) bits->fill_bytes(0);
}

void ComponentOrigins::add_overlap(const Run& run, Overlap& overlap) const {
  const std::uint64_t *differed = differed_.view().row(run.row), *inside = inside_.view().row(run.row);
  const int end = std::min(run.end + kParameters.beside, 64 * differed_.view().width);
  for_words(std::max(run.first - kParameters.beside, 0), end, [&](int word, std::uint64_t ones) {
    overlap.differed += std::popcount(differed[word] & ones);
    overlap.inside += std::popcount(inside[word] & ones);
  });
}

void ComponentOrigins::record(const Run& run, Origin origin) {
  if (origin == Origin::outside) return;
  const std::uint64_t* differed = differed_.view().row(run.row);
  std::uint64_t* inside = inside_.view().row(run.row);
  for_words(run.first, run.end,
            [&](int word, std::uint64_t ones) { inside[word] |= ones & ~differed[word]; });
}

void ComponentOrigins::step(BitView differs, BitView gone) {
  subtract(differs, gone, differed_.view());
  intersect(inside_.view(), differed_.view(), inside_.view());
}

void ComponentOrigins::forget(BitView gone) {
  step(differed_.view(), gone);
}

}  // namespace cerberus::vision
