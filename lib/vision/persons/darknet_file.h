// SPDX-License-Identifier: LGPL-2.1-or-later
// What OpenCV does not check in the two files of a darknet model. Never reads beyond the text.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "vision/image/image.h"

namespace cerberus::vision {

struct DarknetNetwork {
  Size input;
  int classes = 0;  // of its yolo layers
  // Numbers that its weights are. nullopt: it has layers whose weights are not counted here.
  std::optional<std::uint64_t> weights;
};

// cfg: the text of the configuration (sections [net], [convolutional], ... [yolo]). nullopt, and in `wrong` the end of a
// sentence ("it has no [yolo] layer"): it describes no network that finds boxes in a picture of three planes.
std::optional<DarknetNetwork> read_darknet_cfg(std::string_view cfg, std::string& wrong);

// The size of the network's picture for frames of this size: its sides are multiples of the coarsest cell's. Of the sizes with at
// most as many pixels as `own` (a small network: twice as many), the one that shows the frame largest.
Size darknet_input_for(Size frame, Size own);

// The configuration with this score in each [yolo] layer, below which OpenCV drops boxes; without one it takes .2.
std::string darknet_cfg_with_threshold(std::string_view cfg, double threshold);

// Numbers in a file of weights behind its header (versions 0.1 and later). nullopt: it is no such file.
std::optional<std::uint64_t> count_darknet_weights(std::string_view weights);

}  // namespace cerberus::vision
