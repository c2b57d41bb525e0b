// SPDX-License-Identifier: LGPL-2.1-or-later
// Appearance model of an object in 32 bytes: the brightness of its upper and of its lower half. Enough to distinguish
// two people who pass each other closely, where their positions do not; not enough to find a person in a crowd.
//
// Either half has a histogram of the logarithm of the brightness under the foreground mask (or of the whole box, where
// there is no mask). A change of exposure is a factor, a shift of the logarithm, and is taken out by BrightnessLevel.
// Two appearances are compared by the share of pixels that differ in brightness (one minus the intersection of the
// histograms; M. J. Swain, D. H. Ballard 1991).
#pragma once

#include <array>
#include <cstdint>

#include "vision/geometry/box.h"
#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

// Origins: chosen by hand where no other stands. Guard: tests/unit (appearance_model, coats), MOTA 70 on PETS09-S2L1.
struct AppearanceParameters {
  double dark = 8;  // grey levels added before the logarithm: noise in the dark is no difference
};

// The analysed picture and its foreground mask (not 0), of one size. appearance_of() reads all of a box where the mask
// is empty.
struct Sight {
  GrayView luma, mask;
  GrayView
      background{};  // as the model had learnt it before this picture, of a camera that stands; else empty
  bool known() const { return !luma.empty() && luma.size() == mask.size(); }
};

// Brightness of the picture relative to the first frame (exposure and gain), accumulated from frame to frame.
class BrightnessLevel {
 public:
  BrightnessLevel() : BrightnessLevel(AppearanceParameters()) {}
  explicit BrightnessLevel(const AppearanceParameters& parameters);
  const AppearanceParameters& parameters() const { return parameters_; }
  void reset();
  // motion: frame k-1 to k, pixels of `luma`.
  void update(GrayView luma, const Transform& motion);
  // A frame without picture: the next one has nothing to be compared with.
  void skip() { size_ = {}; }

  struct Bin {
    std::uint8_t first, share;  // the lower of two neighbouring bins, and how much of 16 belongs to the next
  };
  // Of a grey level, the brightness factor taken out.
  Bin bin(std::uint8_t grey) const { return bins_[grey]; }

 private:
  static constexpr int kColumns = 12, kRows = 9;
  void make_bins();
  AppearanceParameters parameters_;
  double level_ = 0;  // log2 of the factor
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
  // Moves towards `seen` by `weight`, 0..1. A band that was not known is copied.
  void learn(const AppearanceModel& seen, double weight);
};

// box: pixels of the pictures; may leave them. About `samples` pixels of the box are read.
AppearanceModel appearance_of(const Sight& sight, const BrightnessLevel& level, const Box& box, int samples);
// 0 the same, 1 nothing in common; negative: no band is known in both.
double appearance_distance(const AppearanceModel& a, const AppearanceModel& b);

}  // namespace cerberus::vision
