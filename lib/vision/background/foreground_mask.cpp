// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/background/foreground_mask.h"

#include <algorithm>

#include "vision/background/background_model.h"
#include "vision/image/mask.h"
#include "vision/image/median.h"
#include "vision/image/morphology.h"

namespace cerberus::vision {

struct ForegroundMask::State {
  ForegroundMaskOptions options;
  BitMask now, before;
  Morphology morphology;
  BackgroundModel background;
};

namespace {

// The difference from the background has no leading and no common part: those are sets of the two frame differences.
bool uses_background(const ForegroundMaskOptions& options) {
  return options.background_model && options.area == Area::all;
}

}  // namespace

ForegroundMask::ForegroundMask() : state_(std::make_unique<State>()) {}
ForegroundMask::~ForegroundMask() = default;
ForegroundMask::ForegroundMask(ForegroundMask&&) noexcept = default;
ForegroundMask& ForegroundMask::operator=(ForegroundMask&&) noexcept = default;

void ForegroundMask::set_options(const ForegroundMaskOptions& options) {
  // A model that was switched off has lost the camera's motion since.
  if (uses_background(options) != uses_background(state_->options)) state_->background.reset();
  state_->options = options;
}
void ForegroundMask::reset() {
  state_->background.reset();
}

ForegroundMaskResult ForegroundMask::update(const ForegroundMaskInput& input, MutableGrayView mask) {
  State& s = *state_;
  const Size size = mask.size();
  ForegroundMaskResult result;
  result.sigma = noise_sigma(*input.histogram);
  result.fuzzy_threshold = fuzzy_threshold(*input.histogram, s.options.threshold);
  result.threshold =
      s.options.noise_floor ? clamp_to_noise(result.fuzzy_threshold, result.sigma) : result.fuzzy_threshold;
  result.ready = input.frames >= 3 && (s.options.area == Area::all || !input.previous.empty());
  if (uses_background(s.options)) {
    if (input.frames <= 1) s.background.reset();
    s.background.update({input.picture, input.current, result.threshold, result.sigma, input.motion,
                         input.still, input.seconds, input.excluded, input.mechanisms},
                        mask);
    if (result.ready) return result;
  }
  if (!result.ready) {
    for (int y = 0; y < mask.height; ++y) std::fill_n(mask.row(y), mask.width, std::uint8_t{0});
    return result;
  }
  s.now.resize(bit_mask_size(size));
  // Eq. 3 with one Th for both differences, then M(k-1) and M(k).
  binarise(input.current, result.threshold, s.now.view());
  if (s.options.area != Area::all) {
    s.before.resize(bit_mask_size(size));
    binarise(input.previous, result.threshold, s.before.view());
    if (s.options.area == Area::common)
      intersect(s.now.view(), s.before.view(), s.now.view());
    else
      subtract(s.now.view(), s.before.view(), s.now.view());
  }
  if (s.options.noise_floor) s.morphology.vote(s.now.view(), size.width, 5);
  unpack(s.now.view(), mask);
  return result;
}

GrayView ForegroundMask::background() const {
  return uses_background(state_->options) ? state_->background.background() : GrayView{};
}

std::size_t ForegroundMask::bytes() const {
  const State& s = *state_;
  return s.background.bytes() + s.now.bytes() + s.before.bytes() + s.morphology.bytes() + sizeof(State);
}

}  // namespace cerberus::vision
