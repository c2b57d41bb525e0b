// SPDX-License-Identifier: LGPL-2.1-or-later
// A room that a still camera sees with 25 frames a second, and the chain that is shown it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "support/chain.h"
#include "support/sensor.h"
#include "vision/image/image.h"

namespace cerberus::tests {

// How bright the empty room is: a wall, a floor with boards.
inline float room(int x, int y) {
  if (y >= 150 && y < 154) return 60;
  return y < 150 ? 190.0f - 0.06f * static_cast<float>(x) : 110.0f + 12.0f * static_cast<float>(x / 9 % 2);
}

class RoomCamera {
 public:
  static constexpr vision::Size kSize{320, 240};

  // The chain's next frame, with brightness(x, y) and the sensor's noise.
  template <typename Brightness>
  const Chain& see(Brightness&& brightness) {
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        picture_[static_cast<std::size_t>(y) * kSize.width + x] = brightness(x, y);
    expose(picture_.data(), kSize.width, {}, noise_, frame_.view());
    chain_.step({frame_.view().data, kSize.width, kSize.height, frame_.view().stride}, 1.0 / 25);
    return chain_;
  }

 private:
  Chain chain_;
  Noise noise_;
  vision::Image<std::uint8_t> frame_{kSize};
  std::vector<float> picture_ = std::vector<float>(static_cast<std::size_t>(kSize.area()));
};

}  // namespace cerberus::tests
