// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/gpio/gpio_port.h"

#include <chrono>

#include "drivers/gpio/gpio_chip.h"

namespace cerberus::drivers {

std::string GpioPort::open(const std::vector<std::string>& outputs, const std::vector<bool>& initial,
                           const std::vector<std::string>& inputs) {
  lines_.close();
  if (const SensorError error = open_gpio_chip(lines_, wanted_, chip_)) return error.text;
  std::vector<unsigned> out, in;
  if (const SensorError error = line_offsets(lines_, chip_, outputs, {}, out)) return error.text;
  if (const SensorError error = line_offsets(lines_, chip_, inputs, out, in)) return error.text;
  if (!out.empty())
    if (const int error = lines_.request_outputs(out, initial))
      return lines_refused(lines_, chip_, error, out).text;
  if (!in.empty())
    if (const int error = lines_.request_inputs(in, LineBias::pull_up))
      return lines_refused(lines_, chip_, error, in).text;
  return {};
}

void GpioPort::pause(Time time) noexcept {
  const auto end = std::chrono::steady_clock::now() + time;
  while (std::chrono::steady_clock::now() < end) {
  }
}

}  // namespace cerberus::drivers
