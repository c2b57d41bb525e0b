// SPDX-License-Identifier: LGPL-2.1-or-later
// From differences to the foreground mask: threshold, set algebra (paper Eq. 3, M(k-1), M(k)) and, in preset `default`,
// a registered background model.
#pragma once

#include <memory>
#include <span>

#include "vision/background/mechanisms.h"
#include "vision/change/fuzzy_threshold.h"
#include "vision/geometry/box.h"
#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

enum class Area { leading, common, all };  // M(k), M(k-1), D(k)

struct ForegroundMaskOptions {
  FuzzyThresholdOptions threshold;
  Area area = Area::all;
  bool noise_floor = true;       // clamp Th to the measured noise
  bool background_model = true;  // use the background model; only where area is all
};

struct ForegroundMaskInput {
  GrayView picture;     // F(k), analysis pixels
  Transform motion;     // frame k-1 to k
  bool still = false;   // the camera stands
  GrayView current{};   // D(k)
  GrayView previous{};  // D(k-1); empty: missing, only area=all works without
  const Histogram* histogram = nullptr;
  int frames = 0;                   // DifferenceResult::frames
  double seconds = 0;               // since frame k-1; 0: unknown
  std::span<const Box> excluded{};  // see BackgroundInput
  ForegroundMechanisms mechanisms{};
};

struct ForegroundMaskResult {
  int threshold = 0;        // Th used
  int fuzzy_threshold = 0;  // Th as fuzziness alone chooses it
  double sigma = 0;         // noise of the plain difference
  bool ready = false;       // false until three frames of the scene have come: the mask is empty
};

class ForegroundMask {
 public:
  ForegroundMask();
  ~ForegroundMask();
  ForegroundMask(ForegroundMask&&) noexcept;
  ForegroundMask& operator=(ForegroundMask&&) noexcept;

  void set_options(const ForegroundMaskOptions& options);
  void reset();
  // mask := 0 or 255 a pixel, not closed: RegionFinder needs the gaps between people and closes it.
  ForegroundMaskResult update(const ForegroundMaskInput& input, MutableGrayView mask);
  // BackgroundModel::background(); empty where no model is used.
  GrayView background() const;
  std::size_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cerberus::vision
