// SPDX-License-Identifier: LGPL-2.1-or-later
// The driver servo-pwm.
#include "drivers/servo/servo_head.h"

#include "drivers/stepper/stepper_options.h"
#include "heads/drivers.h"

namespace cerberus::heads {

int run_servo([[maybe_unused]] const std::vector<drivers::OptionWord>& words) {
#if HAVE_SERVO
  drivers::ServoOptions options;
  std::string emergency_stop;
  drivers::Inverted inverted;
  for (const drivers::OptionWord& word : words) {
    const auto& [key, value, has_value] = word;
    std::string wrong;
    if (key == "device") {
      options.chip = drivers::pwm_chip_folder(value);
    } else if (key == "pan") {
      wrong = drivers::parse_servo_axis(value, options.pan);
    } else if (key == "tilt") {
      wrong = drivers::parse_servo_axis(value, options.tilt);
    } else if (key == "release-delay") {
      wrong = drivers::parse_release_delay(value, options.release_delay);
    } else if (key == "frequency") {
      const auto hertz = drivers::number_of(value);
      if (!hertz || *hertz < 20 || *hertz > 400)
        wrong = "frequency=" + value + ": pulses a second, 20 to 400";
      else
        options.period = drivers::Time(static_cast<drivers::Time::rep>(1e9 / *hertz));
    } else if (key == "invert") {
      wrong = drivers::parse_inverted(word, inverted);
    } else if (key == "emergency-stop") {
      emergency_stop = value;
    } else {
      wrong =
          "\"" + key +
          "\" is no option of servo-pwm: device, pan, tilt, frequency, release-delay, emergency-stop, invert";
    }
    if (!wrong.empty()) return fail(wrong);
  }
  if (options.chip.empty()) return fail("servo-pwm needs a PWM chip (device=pwmchip0)");
  options.pan.invert = options.pan.invert || inverted.pan;
  options.tilt.invert = options.tilt.invert || inverted.tilt;
  drivers::ServoHead head(options);
  return serve(head, {.emergency_stop = emergency_stop});
#else
  return fail("servo-pwm was left out of this build");
#endif
}

}  // namespace cerberus::heads
