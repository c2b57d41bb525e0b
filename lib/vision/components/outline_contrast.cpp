// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/components/outline_contrast.h"

#include <cstdlib>

namespace cerberus::vision {
namespace {

// Origin unknown where none is given: kept from the first version. Guard of all: mean F of bench-quality, unit-components,
// unit-resting_ghosts.
constexpr struct Parameters {
  // Times as much contrast in one of frame and background, and grey levels a pixel more, for the outline to decide.
  double ratio = 1.3, margin = 2;
  double certain_ratio = 2;
  // swept for a single side: with 2 unit-steady finds strips that people leave.
  double certain_margin = 4;
} kParameters;

}  // namespace

void OutlineContrast::add(GrayView in_frame, GrayView in_background, int row, int out, int in) {
  frame += std::abs(in_frame.at(out, row) - in_frame.at(in, row));
  background += std::abs(in_background.at(out, row) - in_background.at(in, row));
  ++pixels;
}

bool OutlineContrast::is_object() const {
  return frame > kParameters.ratio * background + kParameters.margin * pixels;
}

bool OutlineContrast::is_ghost() const {
  return background > kParameters.ratio * frame + kParameters.margin * pixels;
}

bool OutlineContrast::is_certain_ghost() const {
  return background > kParameters.certain_ratio * frame + kParameters.certain_margin * pixels;
}

bool OutlineContrast::is_certain_object() const {
  return frame > kParameters.certain_ratio * background + kParameters.certain_margin * pixels;
}

bool OutlineContrast::is_side_of_object() const {
  return frame >= kParameters.ratio * background + kParameters.certain_margin * pixels;
}

}  // namespace cerberus::vision
