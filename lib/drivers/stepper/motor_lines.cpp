// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/stepper/motor_lines.h"

#include <array>

namespace cerberus::drivers {
namespace {

// Bits 0 to 3: IN1 to IN4.
constexpr std::array<unsigned, 8> kHalfSteps{0b0001, 0b0011, 0b0010, 0b0110, 0b0100, 0b1100, 0b1000, 0b1001};
constexpr std::size_t kStepLine = 0, kDirectionLine = 1, kEnableLine = 2;

unsigned coils_at(std::int64_t count, bool invert) {
  return kHalfSteps[static_cast<std::size_t>((invert ? -count : count) & 7)];
}

}  // namespace

int MotorLines::show(unsigned coils) {
  // First off, then on: never three coils at once.
  for (const bool level : {false, true})
    for (std::size_t line = 0; line < 4; ++line) {
      const unsigned bit = 1U << line;
      if (((coils ^ lit_) & bit) == 0 || ((coils & bit) != 0) != level) continue;
      if (const int error = set(line, level)) return error;
      lit_ ^= bit;
    }
  return 0;
}

int MotorLines::energise(std::int64_t count) {
  if (energised_) return 0;
  int error = 0;
  if (wiring_.lines == 4) error = show(coils_at(count, wiring_.invert));
  if (wiring_.lines == 3) error = set(kEnableLine, wiring_.enable_high);
  energised_ = error == 0;
  return error;
}

int MotorLines::step(std::int64_t count, int direction) {
  if (wiring_.lines == 4) return show(coils_at(count + direction, wiring_.invert));
  if (direction != direction_) {
    if (const int error = set(kDirectionLine, (direction > 0) != wiring_.invert)) return error;
    direction_ = direction;
    port_->pause(kDirectionSetUp);
  }
  if (const int error = set(kStepLine, true)) return error;
  port_->pause(kStepPulse);
  return set(kStepLine, false);
}

int MotorLines::release() noexcept {
  energised_ = false;
  lit_ = 0;
  direction_ = 0;
  int error = 0;
  const auto off = [&](std::size_t line, bool level) {
    const int failed = set(line, level);
    if (failed != 0 && error == 0) error = failed;
  };
  if (wiring_.lines == 4)
    for (std::size_t line = 0; line < 4; ++line) off(line, false);
  if (wiring_.lines == 3) off(kEnableLine, !wiring_.enable_high);
  if (wiring_.lines != 4) off(kStepLine, false);
  return error;
}

}  // namespace cerberus::drivers
