// SPDX-License-Identifier: LGPL-2.1-or-later
// A head device with its plant and the helper's end of the line protocol in a test's own time: what served_head.h does in
// real time, with the same functions.
#pragma once

#include <deque>
#include <string>
#include <utility>

#include "drivers/helper/head_server.h"
#include "support/head_plants.h"

namespace cerberus::tests {

class SteppedHelper {
 public:
  explicit SteppedHelper(HeadPlant& plant, const char* timeout = "5")
      : plant_(plant),
        server_(plant.device(), [this](std::string line) { lines_.push_back(std::move(line)); }) {
    plant_.elapse(now_);
    say(std::string("cerberus-head 1 timeout ") + timeout +
        " limits -170 170 -45 45 speed 90 90 acceleration 600 600 start 0 0");
    run(std::chrono::seconds(1));  // the login took as long
  }
  Time now() const { return now_; }
  void say(const std::string& line) { server_.obey(line, now_); }
  // The end of the pipeline.
  void hang_up() { hung_up_ = true; }
  // Lets everything work for so long.
  void run(Time length) {
    for (const Time end = now_ + length; now_ < end;) {
      const Time next = hung_up_ ? finish() : server_.serve(now_);
      now_ = std::min(end, std::max(next, now_ + std::chrono::microseconds(1)));
      plant_.elapse(now_);
    }
  }
  // Sends `line` every 10 ms until the condition holds; false after 10 s.
  template <typename Condition>
  bool until(Condition holds, const std::string& line = "alive") {
    for (const Time end = now_ + std::chrono::seconds(10); now_ < end; run(std::chrono::milliseconds(10))) {
      if (holds()) return true;
      say(line);
    }
    return false;
  }
  // Reads until a line begins like this; empty after 10 s.
  std::string line(const std::string& begin) {
    for (const Time end = now_ + std::chrono::seconds(10); now_ < end; run(std::chrono::milliseconds(2))) {
      while (!lines_.empty()) {
        const std::string line = std::exchange(lines_.front(), {});
        lines_.pop_front();
        if (line.starts_with(begin)) return line;
      }
      say("alive");
    }
    return {};
  }
  // The process's exit status, at its end; -1: it does not end.
  int status() {
    for (const Time end = now_ + std::chrono::seconds(10); now_ < end && !finished_;)
      run(std::chrono::milliseconds(1));
    return !finished_ ? -1 : server_.failed() ? 2 : 0;
  }

 private:
  Time finish() {
    if (finished_) return motion::kNever;
    const Time next = server_.finish(now_);
    finished_ = next == motion::kNever;
    return next;
  }

  HeadPlant& plant_;
  drivers::HeadServer server_;
  std::deque<std::string> lines_;  // of the helper
  Time now_ = std::chrono::seconds(1000);
  bool hung_up_ = false, finished_ = false;
};

}  // namespace cerberus::tests
