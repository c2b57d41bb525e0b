// SPDX-License-Identifier: LGPL-2.1-or-later
// Digital lines as the drivers of heads need them: outputs to motors, inputs from switches. gpio_port.h has those of a
// GPIO chip; tests have their own.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "motion/head_limits.h"

namespace cerberus::drivers {

using motion::Time;

class LinePort {
 public:
  virtual ~LinePort() = default;
  // Requests the lines by name or number: outputs take the level that `initial` names (off), inputs are pulled up.
  // Returns what is wrong, naming the chip and the line and what to do; empty: it is open.
  virtual std::string open(const std::vector<std::string>& outputs, const std::vector<bool>& initial,
                           const std::vector<std::string>& inputs) = 0;
  virtual void close() noexcept = 0;
  // Indices count within the names of open(). Both return errno, 0 = no error.
  virtual int set(std::size_t output, bool level) noexcept = 0;
  virtual int get(std::size_t input, bool& level) noexcept = 0;
  // Returns errno if the lines are gone, 0 if they are there. Changes no line.
  virtual int probe() noexcept = 0;
  // Waits for a few microseconds.
  virtual void pause(Time time) noexcept = 0;
};

}  // namespace cerberus::drivers
