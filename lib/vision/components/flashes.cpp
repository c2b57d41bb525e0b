// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/components/flashes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "vision/image/preallocate.h"

namespace cerberus::vision {
namespace {

// Guard of all: unit-rain.
constexpr struct Parameters {
  double least_area = 1 / 2560.0;  // of the picture: smaller ones are noise
  // S/s: so far an object may be beside where it was a frame ago. derived: somebody who runs, 9 km/h.
  double speed = 1.5;
  // Flashes a frame that are usual, mean of a second. measured: at most 1.1 where people walk, 4 with six streaks.
  double usual = 2;
  // s: a mean of less is not taken. Objects of a young scene flash as well: without it MOTA on TUD-Stadtmitte is .15 lower.
  double start = 0.3;
} kParameters;

}  // namespace

void Flashes::preallocate(Size picture, std::size_t components) {
  for (auto* bits : {&before_, &goes_on_}) bits->resize(bit_mask_size(picture));
  vision::preallocate(covered_, components);
  reset();
}

void Flashes::reset() {
  for (auto* bits : {&before_, &goes_on_}) bits->fill_bytes(255);  // no component is new
  flashes_ = seconds_ = 0;
  fresh_ = 0;
}

void Flashes::find(Size picture, BitView mask, std::span<const Component> components,
                   std::span<const Run> runs, double seconds) {
  const Parameters& p = kParameters;
  covered_.assign(components.size(), {});
  for (const Run& r : runs) {
    const Component& c = components[r.component];
    const int beside = static_cast<int>(std::lround(p.speed * seconds * std::max(c.width(), c.height())));
    const int first = std::max(r.first - beside, 0), end = std::min(r.end + beside, 64 * mask.width);
    const auto covered = [&](const BitMask& bits) {
      const std::uint64_t* row = bits.view().row(r.row);
      int pixels = 0;
      for_words(first, end, [&](int word, std::uint64_t ones) { pixels += std::popcount(row[word] & ones); });
      return static_cast<std::uint32_t>(std::min(pixels, r.end - r.first));
    };
    covered_[r.component].before += covered(before_);
    covered_[r.component].goes_on += covered(goes_on_);
  }
  count(mask, seconds);
  fresh_ = 0;
  for (std::size_t i = 0; i < components.size(); ++i)
    fresh_ +=
        is_new(covered_[i].before, components[i]) && components[i].area >= p.least_area * picture.area();
  std::memcpy(before_.view().data, mask.data, before_.bytes());
  goes_on_.fill_bytes(0);
  for (const Run& r : runs)
    if (!is_new(covered_[r.component].before, components[r.component]))
      set_bits(goes_on_.view().row(r.row), r.first, r.end);
}

// Of the new components one frame ago those have flashed whose places are as before now.
void Flashes::count(BitView mask, double seconds) {
  const Parameters& p = kParameters;
  long pixels = 0, gone = 0;
  for (int y = 0; y < mask.height; ++y)
    for (int word = 0; word < mask.width; ++word) {
      const std::uint64_t fresh = before_.view().row(y)[word] & ~goes_on_.view().row(y)[word];
      pixels += std::popcount(fresh);
      gone += std::popcount(fresh & ~mask.row(y)[word]);
    }
  const double flashed =
      pixels > 0 ? static_cast<double>(fresh_) * static_cast<double>(gone) / static_cast<double>(pixels) : 0;
  seconds_ += seconds;
  flashes_ += (flashed - flashes_) * std::min(1.0, seconds / std::clamp(seconds_, p.start, 1.0));
}

bool Flashes::is_new(std::uint32_t covered, const Component& component) {
  return 2 * covered < component.area;
}

bool Flashes::is_flash(std::size_t i, const Component& component) const {
  return flashes_ > kParameters.usual && is_new(covered_[i].goes_on, component);
}

}  // namespace cerberus::vision
