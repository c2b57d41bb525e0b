// SPDX-License-Identifier: LGPL-2.1-or-later
// cerberus-head in the virtual machine, and the lines that it sends. All that waits waits long: the machine is emulated.
#pragma once

#include <poll.h>

#include <chrono>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "../support/suite.h"
#include "../support/text.h"
#include "drivers/helper/head_lines.h"
#include "drivers/helper/helper_process.h"
#include "sensing/angles.h"

namespace simulated {

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;
using Clock = std::chrono::steady_clock;

inline std::string program;  // cerberus-head

inline double milliseconds(Clock::duration time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

// The helper, and the lines that it sends.
class Helper {
 public:
  Helper(std::vector<std::string> words, const HeadSetup& setup) {
    words.insert(words.begin(), program);
    assert_text(process_.start(words), "");
    send(hello_line(setup, 10s));
    expect("ready");
  }
  void send(const std::string& line) { ck_assert(process_.send(line)); }
  // Waits for a line that begins with `word`, and returns it.
  std::string expect(const std::string& word) {
    for (const auto end = Clock::now() + 60s; Clock::now() < end;) {
      while (const auto line = lines_.take()) {
        if (const auto parsed = parse_helper_line(*line))
          if (const auto* pose = std::get_if<PoseLine>(&*parsed)) pan_ = degrees(pose->pan.position);
        if (line->starts_with(word)) return *line;
      }
      pollfd wait{process_.fd(), POLLIN, 0};
      ::poll(&wait, 1, 1000);
      std::string bytes;
      process_.receive(bytes);
      lines_.append(bytes);
      process_.send("alive\n");
    }
    ck_abort_msg("the helper never sent '%s'", word.c_str());
  }
  // Waits until it says that it looks there.
  void arrive(double pan) {
    for (const auto end = Clock::now() + 60s; Clock::now() < end;) {
      expect("pose");
      if (std::abs(pan_ - pan) < 0.05) return;
    }
    ck_abort_msg("the head is at %g, not at %g", pan_, pan);
  }

 private:
  HelperProcess process_;
  LineBuffer lines_;
  double pan_ = 0;
};

}  // namespace simulated
