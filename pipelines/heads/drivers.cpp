// SPDX-License-Identifier: LGPL-2.1-or-later
#include "heads/drivers.h"

#include <sched.h>
#include <sys/prctl.h>

#include <cmath>
#include <cstdio>
#include <memory>

#include "drivers/head/emergency_stop.h"
#include "drivers/helper/helper_loop.h"
#include "heads/one_program.h"
#include "text/numbers.h"
#if HAVE_GPIOD
#include "drivers/gpio/gpio_port.h"
#endif

namespace cerberus::heads {

namespace {

bool& checks() {
  static bool only = false;
  return only;
}

}  // namespace

int fail(const std::string& text) {
  std::printf("fault %s\n", text.c_str());
  std::fflush(stdout);
  return 2;
}

void warn(const std::string& text) {
  std::fprintf(stderr, "cerberus-head: warning: %s\n", text.c_str());
}

std::string read_number(const drivers::OptionWord& word, double least, double most, double& number) {
  const auto read = drivers::number_of(word.value);
  if (!read || *read < least || *read > most)
    return word.key + "=" + word.value + ": a number, " + text::significant(least, 4).string() + " to " +
           text::significant(most, 4).string();
  number = *read;
  return {};
}

std::string read_whole(const drivers::OptionWord& word, int least, int most, int& number) {
  const auto read = drivers::number_of(word.value);
  if (!read || *read < least || *read > most || *read != std::floor(*read))
    return word.key + "=" + word.value + ": a whole number, " + std::to_string(least) + " to " +
           std::to_string(most);
  number = static_cast<int>(*read);
  return {};
}

void only_check() {
  checks() = true;
}

namespace {

int serve(drivers::HeadDevice& device) {
  if (!checks()) return drivers::serve_head(0, 1, device, give_up_place);
  const std::string wrong = device.check();
  return wrong.empty() ? 0 : fail(wrong);
}

}  // namespace

int serve(drivers::HeadDevice& turned, const Around& around) {
  drivers::InvertedHead inverted(turned, around.inverted);
  drivers::HeadDevice& device = around.inverted.any() ? inverted : turned;
  const std::string& emergency_stop = around.emergency_stop;
  if (emergency_stop.empty()) return serve(device);
#if HAVE_GPIOD
  const std::size_t sign = emergency_stop.rfind(':');
  if (sign == 0 || sign == emergency_stop.npos || sign + 1 == emergency_stop.size())
    return fail("emergency-stop=" + emergency_stop + ": name it as CHIP:LINE, gpiochip0:17");
  drivers::EmergencyStop guarded(device, std::make_unique<drivers::GpioPort>(emergency_stop.substr(0, sign)),
                                 emergency_stop.substr(sign + 1));
  return serve(guarded);
#else
  return fail("emergency-stop needs libgpiod, which this build was made without");
#endif
}

Run find_driver(const std::string& name) {
  if (name == "visca") return run_visca;
  if (name == "pelco-d") return run_pelco;
  if (name == "onvif") return run_onvif;
  if (name == "stepper-gpio") return run_stepper;
  if (name == "servo-pwm") return run_servo;
  if (name == "v4l2") return run_v4l2;
  return nullptr;
}

void be_punctual() {
  ::prctl(PR_SET_TIMERSLACK, 1UL);  // nanoseconds; 50 us by default
  const sched_param priority{10};   // above everything ordinary, below the kernel's own threads (50)
  ::sched_setscheduler(0, SCHED_FIFO, &priority);  // refused without permission: steps are later then
}

}  // namespace cerberus::heads
