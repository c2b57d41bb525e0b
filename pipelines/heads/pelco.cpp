// SPDX-License-Identifier: LGPL-2.1-or-later
// The driver pelco-d.
#include "drivers/pelco/pelco_head.h"

#include "heads/drivers.h"

namespace cerberus::heads {
#if HAVE_PELCO
namespace {

constexpr double kMostSpeed = 3600;  // degrees a second, as of pantiltsink

std::string read_word(const drivers::OptionWord& word, drivers::PelcoOptions& options) {
  const std::string& key = word.key;
  if (key == "baud") return read_whole(word, 1, 1000000, options.baud);
  if (key == "address") return read_whole(word, 1, 255, options.address);
  if (key == "pan-speed") return read_number(word, 0, kMostSpeed, options.pan_speed);
  if (key == "tilt-speed") return read_number(word, 0, kMostSpeed, options.tilt_speed);
  if (key == "home-preset") return read_whole(word, 1, 255, options.home_preset);
  if (key == "home-time") return read_number(word, 0, 40, options.home_time);
  if (key != "feedback")
    return "\"" + key +
           "\" is no option of pelco-d: device, baud, address, pan-speed, tilt-speed, feedback, home-preset, "
           "home-time, emergency-stop, invert";
  options.feedback = true;
  return word.has_value ? key + " takes no value" : "";
}

}  // namespace

int run_pelco(const std::vector<drivers::OptionWord>& words) {
  drivers::PelcoOptions options;
  Around around;
  if (const std::string wrong = read_words(words, options, around, read_word); !wrong.empty())
    return fail(wrong);
  if (options.device.empty()) return fail("pelco-d needs a head (device=serial:/dev/ttyUSB0)");
  drivers::PelcoHead head(options);
  return serve(head, around);
}
#else
int run_pelco(const std::vector<drivers::OptionWord>&) {
  return fail("pelco-d was left out of this build");
}
#endif

}  // namespace cerberus::heads
