// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/scene_breaks.h"

namespace cerberus::vision {

bool SceneBreaks::add(bool fresh, bool broken, double seconds) {
  if (fresh) {
    const bool enough = frames_ >= parameters_.frames && seconds_ >= parameters_.seconds;
    broken_ = broken && !enough ? broken_ + 1 : 0;
    frames_ = 1;
    seconds_ = 0;
  } else if (++frames_ > 3) {
    seconds_ += seconds;
  }
  return broken_ >= parameters_.scenes;
}

}  // namespace cerberus::vision
