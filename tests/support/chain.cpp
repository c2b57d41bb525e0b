// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/chain.h"

namespace cerberus::tests {

using namespace vision;

const char* Chain::stage_name(std::size_t stage) {
  static constexpr std::array names{"luma",    "camera motion", "differences", "threshold and moving area",
                                    "regions", "tracks"};
  return names.at(stage);
}

void Chain::begin(const LumaSource& frame, double seconds) {
  frame_ = frame;
  seconds_ = seconds;
  const Size size = vision::analysis_size({frame.width, frame.height}, analysis_width_);
  luma_.resize(size);
  current_.resize(size);
  if (mask_.resize(size))
    scaled_.reserve(static_cast<std::size_t>(size.area() / 256) + 256);  // more than there are
}

void Chain::run_stage(std::size_t stage) {
  const Size frame{frame_.width, frame_.height};
  switch (stage) {
    case 0:
      scaler_.scale(frame_, luma_.view());
      break;
    case 1:
      motion_result_ = motion_.update(luma_.view());
      if (motion_result_.scene_age == 1) {
        forget();
      }
      break;
    case 2:
      difference_result_ =
          difference_.update(luma_.view(), motion_result_.transform, current_.view(), {}, histogram_);
      break;
    case 3:
      area_result_ = area_.update({.picture = luma_.view(),
                                   .motion = motion_result_.transform,
                                   .still = motion_result_.still,
                                   .current = current_.view(),
                                   .histogram = &histogram_,
                                   .frames = difference_result_.frames,
                                   .seconds = seconds_,
                                   .excluded = burnt_in_.boxes()},
                                  mask_.view());
      if (burnt_in_on_ && burnt_in_.update({luma_.view(), current_.view(), area_result_.threshold,
                                            motion_result_.transform, motion_result_.still, seconds_},
                                           mask_.view()))
        if (!motion_result_.still) area_.reset();
      break;
    case 4: {
      found_ = regions_.update(mask_.view(), {}, motion_result_.transform);
      const double sx = static_cast<double>(frame.width) / luma_.size().width;
      const double sy = static_cast<double>(frame.height) / luma_.size().height;
      scaled_.assign(found_.begin(), found_.end());
      for (Region& r : scaled_) r.box = {r.box.x * sx, r.box.y * sy, r.box.width * sx, r.box.height * sy};
      break;
    }
    case 5:
      tracks_ = tracker_.update(scaled_, motion_result_.transform.rescaled(luma_.size(), frame), seconds_,
                                frame, {}, {luma_.view(), mask_.view()});
      break;
  }
}

void Chain::step(const LumaSource& frame, double seconds) {
  begin(frame, seconds);
  for (std::size_t s = 0; s < kStages; ++s) run_stage(s);
}

void Chain::reset() {
  motion_.reset();
  forget();
}

void Chain::forget() {
  difference_.reset();
  area_.reset();
  regions_.reset();
  burnt_in_.reset();
  tracker_.reset();
}

std::size_t Chain::bytes() const {
  return motion_.bytes() + difference_.bytes() + area_.bytes() + regions_.bytes() + luma_.bytes() +
         current_.bytes() + mask_.bytes();
}

}  // namespace cerberus::tests
