// SPDX-License-Identifier: LGPL-2.1-or-later
// What somebody looks like, in 32 bytes: how bright the coat and how bright the legs are. Enough to tell two people who
// pass each other closely, where their places alone cannot; not enough to find somebody again in a crowd.
//
// The upper and the lower half of an object each have a histogram of the logarithm of their brightness, under the mask
// of what moves: what stands around does not count (or all of a place, where there is no mask). Change of exposure is a
// factor, a shift of the logarithm, and is taken out by BrightnessLevel. Two looks are compared by the share of their
// pixels that are not as bright (one minus the intersection of the histograms; M. J. Swain, D. H. Ballard 1991).
#pragma once

#include <array>
#include <cstdint>

#include "vision/geometry/box.h"
#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

// The analysed picture, and what moves in it (not 0). Where both are known people have looks; appearance_of() reads all of a
// box where the mask is empty.
struct Sight {
  GrayView luma, mask;
  bool known() const { return !luma.empty() && luma.size() == mask.size(); }
};

// How bright the picture is, as a factor of how bright it was at first: exposure and gain, summed up from frame to
// frame.
class BrightnessLevel {
 public:
  BrightnessLevel();
  void reset();
  // motion: frame k-1 to k, pixels of `luma`.
  void update(GrayView luma, const Transform& motion);
  // A frame that nobody has looked at: the next one has nothing to be compared with.
  void skip() { size_ = {}; }

  struct Bin {
    std::uint8_t first, share;  // the lower of two neighbouring bins, and how much of 16 belongs to the next
  };
  // Where a grey level belongs, the factor taken out.
  Bin bin(std::uint8_t grey) const { return bins_[grey]; }

 private:
  static constexpr int kColumns = 12, kRows = 9;
  void make_bins();
  double level_ = 0;     // log2 of the factor
  double made_for_ = 0;  // that of the bins
  Size size_;
  std::array<std::uint8_t, kColumns * kRows> before_{};
  std::array<Bin, 256> bins_;
};

struct AppearanceModel {
  static constexpr int kBands = 2, kBins = 8;
  static constexpr int kAll = 1 << 14;
  // Of kAll in each band; a band without enough pixels is all 0.
  std::array<std::array<std::uint16_t, kBins>, kBands> share{};

  bool known() const;
  // What `seen` adds: as much as `weight`, 0..1, says. A band that was not known is taken over.
  void learn(const AppearanceModel& seen, double weight);
};

// box: pixels of the pictures; may leave them. About `samples` pixels of the box are looked at.
AppearanceModel appearance_of(const Sight& sight, const BrightnessLevel& level, const Box& box, int samples);
// 0 the same, 1 nothing in common; negative where nothing can be compared.
double appearance_distance(const AppearanceModel& a, const AppearanceModel& b);

}  // namespace cerberus::vision
