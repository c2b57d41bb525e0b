// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/background/component_origins.h"

#include <algorithm>
#include <bit>

namespace cerberus::vision {
namespace {

constexpr int kBeside = 2;  // pixels to either side: what moves is found again where it has moved on

}  // namespace

void ComponentOrigins::preallocate(Size picture) {
  for (auto* bits : {&differed_, &here_}) bits->resize(bit_mask_size(picture));
  begin();
}

void ComponentOrigins::begin() {
  for (auto* bits : {&differed_, &here_}) bits->fill_bytes(0);
}

void ComponentOrigins::add(const Run& run, Before& before) const {
  const std::uint64_t *differed = differed_.view().row(run.row), *here = here_.view().row(run.row);
  const int end = std::min(run.end + kBeside, 64 * differed_.view().width);
  for_words(std::max(run.first - kBeside, 0), end, [&](int word, std::uint64_t ones) {
    before.any += std::popcount(differed[word] & ones);
    before.here += std::popcount(here[word] & ones);
  });
}

void ComponentOrigins::note(const Run& run, Origin origin) {
  const std::uint64_t* differed = differed_.view().row(run.row);
  std::uint64_t* here = here_.view().row(run.row);
  for_words(run.first, run.end, [&](int word, std::uint64_t ones) {
    if (origin == Origin::found) here[word] &= ~ones;
    if (origin == Origin::here) here[word] |= ones & ~differed[word];
  });
}

void ComponentOrigins::step(BitView differs, BitView gone) {
  subtract(differs, gone, differed_.view());
  intersect(here_.view(), differed_.view(), here_.view());
}

}  // namespace cerberus::vision
