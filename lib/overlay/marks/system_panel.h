// SPDX-License-Identifier: LGPL-2.1-or-later
// A panel in the upper left corner: the head's angles, the sensors as the paper's lights (red: detects, blue: does not,
// grey: no valid reading) with their numbers, in the order of their bearings from left to right, the rule and the
// action. Drawn again only when its content changes.
#pragma once

#include <string>
#include <vector>

#include "overlay/picture.h"
#include "overlay/scene.h"

namespace cerberus::overlay {

class SystemPanel {
 public:
  // font: size of the text, pixels. Returns a patch without pixels if nothing of the system is known.
  const Patch& patch(const System& system, double font, Area frame, PicturePool& pool);
  void clear() { *this = {}; }

 private:
  Patch draw(Area frame, PicturePool& pool) const;

  Area frame_;
  double font_ = 0;
  std::string lines_[2];  // angles; decision
  std::vector<Light> lights_;
  Patch patch_;
};

}  // namespace cerberus::overlay
