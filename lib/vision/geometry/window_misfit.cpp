// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/geometry/window_misfit.h"

#include "text/numbers.h"

namespace cerberus::vision {
namespace {

std::string size_text(Size size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height) + " pixels";
}

std::string fov_text(double degrees) {
  return " that sees " + text::significant(degrees, 4).string() + " degrees";
}

}  // namespace

std::string window_misfit(Size picture, double picture_fov, Size window, double window_fov) {
  const bool natural = window_fov == 0;
  return "A window of " + size_text(window) + (natural ? "" : fov_text(window_fov)) +
         " does not fit into the picture of " + size_text(picture) + (natural ? "" : fov_text(picture_fov)) +
         ".";
}

}  // namespace cerberus::vision
