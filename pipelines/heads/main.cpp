// SPDX-License-Identifier: LGPL-2.1-or-later
// cerberus-head: the helper process that drives a real head for pantiltsink. It reads the line protocol
// (docs/manual/head-protocol.md) from its standard input. It lives on when the pipeline is killed, for as long as it
// takes to stop the head.
#include <chrono>
#include <csignal>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/head/head_place.h"
#include "drivers/helper/head_server.h"
#include "heads/drivers.h"
#include "heads/one_program.h"

namespace {

constexpr char kDrivers[] = "visca, pelco-d, onvif, stepper-gpio, servo-pwm or v4l2";

// The helper of a pipeline that has just ended may still be stopping its head. Less than the time after which a helper
// that is silent at its start counts as failed (5 s).
constexpr std::chrono::milliseconds kPatience =
    cerberus::drivers::kStopPatience + std::chrono::milliseconds(200);

// The place of the head that these words mean.
std::string place_of(const std::string& driver, const std::vector<cerberus::drivers::OptionWord>& words) {
  std::string device;
  for (const auto& word : words)
    if (word.key == "device") device = word.value;
  return cerberus::drivers::head_place(driver, device, words);
}

int help() {
  std::printf(
      "cerberus-head DRIVER --device=DEVICE [WORD ...]\n"
      "Drives a pan-tilt head by the lines of docs/manual/head-protocol.md; pantiltsink and cerberus-heads "
      "run it. With --check in front it only says what is wrong with the words.\n"
      "DRIVER: %s. WORDS: device-options of pantiltsink, one an argument.\n",
      kDrivers);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  namespace heads = cerberus::heads;
  // The end of the input stops the head and ends the program. A signal meant for the pipeline must not end it before.
  for (const int number : {SIGINT, SIGHUP, SIGTERM, SIGPIPE}) std::signal(number, SIG_IGN);
  const bool checks = argc > 1 && std::string_view(argv[1]) == "--check";
  if (checks) {
    ++argv;
    --argc;
    heads::only_check();
  }
  const std::string driver = argc > 1 ? argv[1] : "";
  if (driver == "--version") {
    std::printf("cerberus-head %s\n", CERBERUS_VERSION);
    return 0;
  }
  if (driver == "--help" || driver == "-h") return help();
  const heads::Run run = heads::find_driver(driver);
  if (!run) return heads::fail("there is no head driver \"" + driver + "\": take " + kDrivers);
  std::vector<cerberus::drivers::OptionWord> words;
  for (int i = 2; i < argc; ++i) words.push_back(cerberus::drivers::option_word(argv[i]));
  if (checks) return run(words);
  if (const std::string wrong = heads::hold_place(place_of(driver, words), kPatience); !wrong.empty())
    return heads::fail(wrong);
  return run(words);
}
