// SPDX-License-Identifier: LGPL-2.1-or-later
// The helper's end of the line protocol (head_lines.h): what a device does for the lines of a pipeline, and which lines
// report it. No descriptor and no clock: helper_loop.h connects both, and a test has its own time.
//
// The device stops when no line has come for the timeout of the first line, and is left as at the end of the pipeline
// (HeadDevice::leave()): also one that rests, since a commanded stop may have left its motors on. A line after a silence
// that stopped a device at work brings `stopped silence` first, and the next `move` is obeyed again. Lines that are not of
// the protocol are skipped.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "drivers/helper/head_device.h"

namespace cerberus::drivers {

// How long the process waits at its end for the device to acknowledge the stop.
inline constexpr std::chrono::milliseconds kStopPatience{4500};

class HeadServer {
 public:
  using Send = std::function<void(std::string line)>;  // without its line feed
  HeadServer(HeadDevice& device, Send send) : device_(device), send_(std::move(send)) {}

  // Carries out a line of the pipeline, without its line feed.
  void obey(const std::string& text, Time now);
  // Lets the device work, stops it after a silence, and reports. Returns when it must be called again at the latest.
  Time serve(Time now);

  // The line has ended: stops the device, in the first call. Returns when it must be called again at the latest;
  // motion::kNever: the device stands, or kStopPatience is over.
  Time finish(Time now);

  bool greeted() const { return greeted_; }  // the device was opened, or could not be
  bool failed() const { return failed_; }    // it could not be
  bool ended() const { return ended_; }      // by `quit`, or failed

 private:
  bool at_work() const { return obeyed_ || (device_.busy() && !silent_); }
  void report(Time now);

  HeadDevice& device_;
  Send send_;
  motion::Limits limits_;
  Time timeout_{}, last_line_{};
  bool greeted_ = false, ended_ = false, failed_ = false;
  bool obeyed_ = false;   // a line that may move the head was carried out and no stop came after it
  bool silent_ = false;   // the timeout is over since the last line
  bool stopped_ = false;  // it stopped a head at work, which the next line reports
  bool emergency_ = false;
  std::string fault_;
  std::optional<double> zoom_;  // as sent
  std::optional<Time> finish_by_;
};

}  // namespace cerberus::drivers
