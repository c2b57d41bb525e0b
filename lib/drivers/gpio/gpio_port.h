// SPDX-License-Identifier: LGPL-2.1-or-later
// Lines of a GPIO chip for the drivers of heads.
#pragma once

#include <string>
#include <utility>

#include "drivers/gpio/gpio_lines.h"
#include "drivers/stepper/line_port.h"

namespace cerberus::drivers {

class GpioPort final : public LinePort {
 public:
  // chip: a path, a name (gpiochip0), a number or a label.
  explicit GpioPort(std::string chip) : wanted_(std::move(chip)) {}
  std::string open(const std::vector<std::string>& outputs, const std::vector<bool>& initial,
                   const std::vector<std::string>& inputs) override;
  void close() noexcept override { lines_.close(); }
  int set(std::size_t output, bool level) noexcept override { return lines_.set(output, level); }
  int get(std::size_t input, bool& level) noexcept override { return lines_.level(input, level); }
  int probe() noexcept override { return lines_.probe(); }
  // Spins: no timer of the kernel is that short.
  void pause(Time time) noexcept override;

 private:
  std::string wanted_, chip_;
  GpioLines lines_;
};

}  // namespace cerberus::drivers
