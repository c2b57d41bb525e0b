// SPDX-License-Identifier: LGPL-2.1-or-later
// The lines of one stepper motor and what they do for a step. No I/O: LinePort (line_port.h) sets them.
//
// Four lines are the coils of a unipolar motor behind a driver such as ULN2003, in the order of the half-step table
//   phase   0 1 2 3 4 5 6 7
//   IN1     1 1 . . . . . 1
//   IN2     . 1 1 1 . . . .
//   IN3     . . . 1 1 1 . .
//   IN4     . . . . . 1 1 1
// so that exactly one line changes with each half-step. Two or three lines are STEP, DIR and EN of a driver such as
// A4988, DRV8825 or TMC2209; EN is active low unless the options say otherwise.
#pragma once

#include <cstddef>
#include <cstdint>

#include "drivers/stepper/line_port.h"

namespace cerberus::drivers {

struct MotorWiring {
  std::size_t first = 0;     // index of its first line in the port
  int lines = 0;             // 4: coils; 3: STEP, DIR, EN; 2: STEP, DIR
  bool invert = false;       // the motor turns the other way round
  bool enable_high = false;  // EN switches the motor on with 1
};

// Timing of STEP / DIR: the largest of A4988 (1 us, 200 ns), DRV8825 (1.9 us, 650 ns) and TMC2209 (100 ns, 20 ns).
inline constexpr Time kStepPulse{2000}, kDirectionSetUp{1000};

class MotorLines {
 public:
  MotorLines(const MotorWiring& wiring, LinePort& port) : wiring_(wiring), port_(&port) {}

  // Whether the motor can be switched off: coils, or an EN line.
  bool releases() const { return wiring_.lines != 2; }
  bool energised() const { return energised_; }
  // Switches the motor on at the phase of `count` steps. Returns errno, 0 = no error, as do the others.
  int energise(std::int64_t count);
  // Steps from `count` to count + direction (1 or -1); the motor is energised.
  int step(std::int64_t count, int direction);
  // Switches the motor off. All lines are tried, whatever fails.
  int release() noexcept;

 private:
  int set(std::size_t line, bool level) noexcept { return port_->set(wiring_.first + line, level); }
  int show(unsigned phase);

  MotorWiring wiring_;
  LinePort* port_;
  bool energised_ = false;
  unsigned lit_ = 0;   // coils that are on, as bits
  int direction_ = 0;  // on the DIR line; 0: not set yet
};

}  // namespace cerberus::drivers
