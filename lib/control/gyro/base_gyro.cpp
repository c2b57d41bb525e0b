// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/gyro/base_gyro.h"

#include <utility>

namespace cerberus::control {

std::string BaseGyro::start(const std::string& which, Calls calls) {
  stop();
  if (which.empty()) return {};
  drivers::GyroSetup setup;
  if (std::string wrong = drivers::parse_gyro(which, setup); !wrong.empty()) return wrong;
  calls_ = std::move(calls);
  bias_.reset();
  runner_.start(setup, {.on_rate = [this](double rate) { measured(rate); }, .on_change = calls_.on_change});
  return {};
}

void BaseGyro::stop() noexcept {
  runner_.stop();
}

void BaseGyro::measured(double rate) {
  const auto now = calls_.now();
  if (!now) return;
  std::optional<double> base;
  {
    const std::lock_guard guard(lock_);
    base = bias_.add(*now, rate);
  }
  if (base) calls_.on_rate(*now, *base);
}

void BaseGyro::frame(Time taken, std::optional<PictureMotion> motion, const vision::Lens& lens,
                     const motion::PanTilt& look, bool rests) {
  if (!calls_.on_rate) return;       // there is no gyro
  if (motion) motion->base_yaw = 0;  // the question is whether the base stands
  const auto turn = motion ? head_turn(*motion, lens, look) : std::nullopt;
  const std::lock_guard guard(lock_);
  bias_.frame(taken, turn, rests);
}

void BaseGyro::robot(Time time, double rate) {
  const std::lock_guard guard(lock_);
  bias_.robot(time, rate);
}

}  // namespace cerberus::control
