// SPDX-License-Identifier: LGPL-2.1-or-later
// The driver stepper-gpio.
#include <cerrno>
#include <cstring>

#include "drivers/stepper/stepper_head.h"
#include "heads/drivers.h"
#if HAVE_STEPPER
#include "drivers/gpio/gpio_port.h"
#endif

namespace cerberus::heads {
namespace {

[[maybe_unused]] std::string read_late_limit(const std::string& text, drivers::Time& limit) {
  const auto milliseconds = drivers::number_of(text);
  if (!milliseconds || *milliseconds < 1 || *milliseconds > 10000)
    return "late-limit=" + text + ": milliseconds, 1 to 10000";
  limit = drivers::Time(static_cast<drivers::Time::rep>(*milliseconds * 1e6));
  return {};
}

}  // namespace

int run_stepper([[maybe_unused]] const std::vector<drivers::OptionWord>& words) {
#if HAVE_STEPPER
  drivers::StepperOptions options;
  std::string emergency_stop, record;
  drivers::Inverted inverted;
  for (const drivers::OptionWord& word : words) {
    const auto& [key, value, has_value] = word;
    std::string wrong;
    if (key == "device")
      options.chip = value;
    else if (key == "pan")
      wrong = drivers::parse_stepper_axis(value, options.pan);
    else if (key == "tilt")
      wrong = drivers::parse_stepper_axis(value, options.tilt);
    else if (key == "release-delay")
      wrong = drivers::parse_release_delay(value, options.release_delay);
    else if (key == "late-limit")
      wrong = read_late_limit(value, options.stale);
    else if (key == "invert")
      wrong = drivers::parse_inverted(word, inverted);
    else if (key == "emergency-stop")
      emergency_stop = value;
    else if (key == "record")
      record = value;
    else
      wrong =
          "\"" + key +
          "\" is no option of stepper-gpio: device, pan, tilt, release-delay, late-limit, emergency-stop, "
          "invert, record";
    if (!wrong.empty()) return fail(wrong);
  }
  options.pan.invert = options.pan.invert || inverted.pan;
  options.tilt.invert = options.tilt.invert || inverted.tilt;
  if (options.chip.empty()) return fail("stepper-gpio needs a GPIO chip (device=gpiochip0)");
  std::FILE* steps = record.empty() ? nullptr : std::fopen(record.c_str(), "we");
  if (!record.empty() && !steps) return fail("record=" + record + ": " + std::strerror(errno));
  be_punctual();
  drivers::StepperHead head(options, std::make_unique<drivers::GpioPort>(options.chip), steps);
  const int status = serve(head, {.emergency_stop = emergency_stop});
  if (steps) std::fclose(steps);
  return status;
#else
  return fail("stepper-gpio needs libgpiod, which this build was made without");
#endif
}

}  // namespace cerberus::heads
