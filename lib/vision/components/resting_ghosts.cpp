// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/components/resting_ghosts.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "vision/components/outline_contrast.h"

namespace cerberus::vision {
namespace {

// Guard of all: unit-resting_ghosts, MOTA on TUD-Stadtmitte (bench-quality), where two people who stood at the start
// leave ghosts: -.03 without this; its recall before a camera that moves (bench-moving_people): .16 without.
constexpr struct Parameters {
  double least_area = 1 / 640.0;  // of the picture: what is smaller has too short an outline
  double least_seen = 0.25;  // of the outline that borders on the background; whoever passes hides the rest
} kParameters;

constexpr std::size_t kMostComponents = 64;  // more are rain or snow

struct Outline {             // of one component, its left and right sides
  int pixels = 0;            // all of them
  OutlineContrast contrast;  // of those that border on the background
};

std::uint32_t count(BitView bits) {
  std::uint32_t pixels = 0;
  for (int y = 0; y < bits.height; ++y)
    for (int word = 0; word < bits.width; ++word)
      pixels += static_cast<std::uint32_t>(std::popcount(bits.row(y)[word]));
  return pixels;
}

}  // namespace

void RestingGhosts::remove(const Pictures& pictures, int rested, Labeller& labeller, MutableBitView mask,
                           MutableBitView absorb) {
  binarise(pictures.quiet, rested - 1, places_.view());
  intersect(places_.view(), mask, places_.view());
  const Parameters& p = kParameters;
  const auto least = static_cast<std::uint32_t>(p.least_area * pictures.frame.size().area());
  if (count(places_.view()) < least) return;  // mostly so, and cheaper than labelling
  const auto components = labeller.find(places_.view(), pictures.frame.width, least);
  if (components.size() > kMostComponents) return;
  std::array<Outline, kMostComponents> outlines{};
  for (const Run& r : labeller.runs()) {
    Outline& outline = outlines[r.component];
    const RowSpan visible = pictures.visible.of(r.row);
    const auto look = [&](int out, int in) {
      ++outline.pixels;
      if (std::min(out, in) < visible.begin || std::max(out, in) >= visible.end ||
          bit_at(mask.row(r.row), out))
        return;
      if (!pictures.age.empty() && pictures.age.at(out, r.row) == 0) return;  // nothing is known there
      outline.contrast.add(pictures.frame, pictures.background, r.row, out, in);
    };
    look(r.first - 2, r.first + 1);
    look(r.end + 1, r.end - 2);
  }
  for (const Run& r : labeller.runs()) {
    const Outline& outline = outlines[r.component];
    if (outline.contrast.pixels < p.least_seen * outline.pixels || !outline.contrast.is_certain_ghost())
      continue;
    clear_bits(mask.row(r.row), r.first, r.end);
    set_bits(absorb.row(r.row), r.first, r.end);
  }
}

}  // namespace cerberus::vision
