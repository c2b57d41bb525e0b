// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/stream_damage.h"

namespace cerberus::vision {

bool StreamDamage::add(const Unit& unit) {
  const bool lost = unit.after_loss && any_;
  any_ = true;
  predicts_ |= !unit.keyframe;
  // A marked keyframe may be whole and follow the loss, or lack a part itself: only a stream of predicted frames keeps
  // the damage. Where every frame is a keyframe (JPEG), receivers discard incomplete ones.
  if (unit.keyframe) damaged_ = false;
  if (lost && predicts_) damaged_ = true;
  if (unit.keyframe && unit.time) keyframe_ = unit.time;
  if (!keyframe_) keyframe_ = unit.time;
  const bool refreshed =
      unit.time && keyframe_ &&
      std::chrono::duration<double>(*unit.time - *keyframe_).count() > parameters_.longest_gop;
  return damaged_ && !refreshed;
}

}  // namespace cerberus::vision
