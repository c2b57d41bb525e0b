// SPDX-License-Identifier: LGPL-2.1-or-later
// The drivers of cerberus-head, whose options are words (drivers/helper/option_words.h), and what all drivers share.
#pragma once

#include <string>
#include <vector>

#include "drivers/head/inverted_head.h"
#include "drivers/helper/head_device.h"
#include "drivers/helper/option_words.h"

namespace cerberus::heads {

// Prints `fault TEXT`, which the pipeline reads from standard output. Returns the exit status.
int fail(const std::string& text);

// Writes a warning to standard error, which is the pipeline's.
void warn(const std::string& text);

// The number of `word`, least to most. Returns what is wrong; then `number` is unchanged.
std::string read_number(const drivers::OptionWord& word, double least, double most, double& number);
std::string read_whole(const drivers::OptionWord& word, int least, int most, int& number);

// What stands between the pipeline and the device.
struct Around {
  std::string emergency_stop;    // "CHIP:LINE" of a normally closed contact; empty: there is none
  drivers::Inverted inverted{};  // axes
};

// Reads the words of a driver: `device`, `emergency-stop` and `invert` here, all others by read_word(word, options).
// Returns what is wrong with the first one that cannot be read.
template <typename Options>
std::string read_words(const std::vector<drivers::OptionWord>& words, Options& options, Around& around,
                       std::string (*read_word)(const drivers::OptionWord&, Options&)) {
  for (const drivers::OptionWord& word : words) {
    if (word.key == "device") {
      options.device = word.value;
    } else if (word.key == "emergency-stop") {
      around.emergency_stop = word.value;
    } else if (word.key == "invert") {
      if (std::string wrong = parse_inverted(word, around.inverted); !wrong.empty()) return wrong;
    } else if (std::string wrong = read_word(word, options); !wrong.empty()) {
      return wrong;
    }
  }
  return {};
}

// From now on serve() returns at once: the words are read, and no device is opened.
void only_check();

// Serves the device until the end.
int serve(drivers::HeadDevice& device, const Around& around);

// One driver. Returns the process's exit status.
using Run = int (*)(const std::vector<drivers::OptionWord>& words);
int run_visca(const std::vector<drivers::OptionWord>& words);
int run_pelco(const std::vector<drivers::OptionWord>& words);
int run_onvif(const std::vector<drivers::OptionWord>& words);
int run_stepper(const std::vector<drivers::OptionWord>& words);
int run_servo(const std::vector<drivers::OptionWord>& words);
int run_v4l2(const std::vector<drivers::OptionWord>& words);

// The driver of that name; nullptr: there is none.
Run find_driver(const std::string& name);

// Asks the kernel to wake this process on time: real-time priority where that is permitted, and exact timers.
void be_punctual();

}  // namespace cerberus::heads
