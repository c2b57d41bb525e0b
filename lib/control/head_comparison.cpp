// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/head_comparison.h"

#include <limits>
#include <utility>

namespace cerberus::control {
namespace {

using motion::PanTilt;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

}  // namespace

void HeadComparison::forget_faults() {
  pan_.reset();
  tilt_.reset();
}

std::optional<vision::Transform> HeadComparison::expect(const Head& head, const vision::Lens& lens) {
  before_ = std::exchange(now_, head);
  comparable_ = false;
  if (!before_.look || !now_.look || !lens.known()) return std::nullopt;
  return lens.turn(before_.look->pan, before_.look->tilt, now_.look->pan, now_.look->tilt);
}

double HeadComparison::base_rate(const Picture& picture, const vision::Lens& lens) {
  if (picture.fresh) base_.reset();
  if (!lens.known()) return kUnknown;
  // Without a head, or before its first pose, the head is assumed to stand.
  const bool known = before_.look.has_value() == now_.look.has_value();
  constexpr PanTilt kStrange{kUnknown, kUnknown};
  const PanTilt from = known ? before_.look.value_or(PanTilt{}) : kStrange;
  const PanTilt to = known ? now_.look.value_or(PanTilt{}) : kStrange;
  turn_ = {kUnknown, kUnknown};
  if (picture.confidence >= parameters_.least_confidence && picture.motion.is_sane(picture.size))
    turn_ = base_turn(picture.motion, lens, picture.size, from, to);
  pan_turn_ = to.pan - from.pan;
  tilt_turn_ = to.tilt - from.tilt;
  comparable_ = now_.commanded && before_.commanded && now_.name == before_.name;

  // What a faulty head really did is not known.
  const double turn = pan_.fault() != SlipFault::none && pan_turn_ != 0 ? kUnknown : turn_.yaw;
  base_.add(picture.time, picture.seconds, turn, pan_turn_ / picture.seconds);
  return base_.at(picture.time);
}

HeadComparison::Faults HeadComparison::faults(double seconds, double reported) {
  if (!comparable_) return {};
  return {pan_.add(seconds, turn_.yaw + pan_turn_ - reported * seconds, pan_turn_),
          tilt_.add(seconds, turn_.pitch + tilt_turn_, tilt_turn_)};
}

}  // namespace cerberus::control
