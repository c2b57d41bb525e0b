// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/moving_area.h"

#include <algorithm>

#include "vision/mask.h"
#include "vision/median.h"
#include "vision/morphology.h"
#include "vision/scene_memory.h"

namespace cerberus::vision {

struct MovingArea::State {
  MovingAreaOptions options;
  BitMask now, before;
  Morphology morphology;
  SceneMemory memory;
};

namespace {

// What differs from the scene is where the object is now: it has no leading and no common part. Who asks for one asks
// for the sets of the two differences.
bool uses_memory(const MovingAreaOptions& options) {
  return options.memory && options.area == Area::all;
}

}  // namespace

MovingArea::MovingArea() : state_(std::make_unique<State>()) {}
MovingArea::~MovingArea() = default;
MovingArea::MovingArea(MovingArea&&) noexcept = default;
MovingArea& MovingArea::operator=(MovingArea&&) noexcept = default;

void MovingArea::set_options(const MovingAreaOptions& options) {
  // A memory that was switched off has not seen where the camera went since.
  if (uses_memory(options) != uses_memory(state_->options)) state_->memory.reset();
  state_->options = options;
}
void MovingArea::reset() {
  state_->memory.reset();
}

MovingAreaResult MovingArea::update(const MovingAreaInput& input, MutableGrayView mask) {
  State& s = *state_;
  const Size size = mask.size();
  MovingAreaResult result;
  result.sigma = noise_sigma(*input.histogram);
  result.fuzzy_threshold = fuzzy_threshold(*input.histogram, s.options.threshold);
  result.threshold =
      s.options.noise_floor ? clamp_to_noise(result.fuzzy_threshold, result.sigma) : result.fuzzy_threshold;
  result.ready = input.frames >= 3 && (s.options.area == Area::all || !input.previous.empty());
  if (uses_memory(s.options)) {
    if (input.frames <= 1) s.memory.reset();
    s.memory.update({input.picture, input.current, result.threshold, result.sigma, input.motion, input.still,
                     input.seconds},
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

std::size_t MovingArea::bytes() const {
  const State& s = *state_;
  return s.memory.bytes() + s.now.bytes() + s.before.bytes() + s.morphology.bytes() + sizeof(State);
}

}  // namespace cerberus::vision
