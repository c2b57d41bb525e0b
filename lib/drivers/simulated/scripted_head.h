// SPDX-License-Identifier: LGPL-2.1-or-later
// A head for tests: it records its calls, and fails or blocks on request. It reaches the commanded position at once.
//
//   script = part {";" part}
//   part   = "record" FD | call [NUMBER] "fail" TEXT | call [NUMBER] "wait" FD
//   call   = "open" | "command" | "state" | "stop" | "close" | "limit"
//
// "record 7" writes a line a call to file descriptor 7: `command 40000000 position 0.5 1.2 hold 0 0` (time in
// nanoseconds, pan, tilt in radians), `limit 40000000 -0.5 0.5 -0.2 0.2` (pan, tilt). "command 3 fail no power" lets
// the third command fail, and all later ones; "stop wait 8" blocks each stop until file descriptor 8 has something to
// read or is closed by its writer. Without a number: the first and all later ones.
#pragma once

#include <array>
#include <vector>

#include "drivers/head/head.h"

namespace cerberus::drivers {

class ScriptedHead final : public Head {
 public:
  std::string open(const HeadSetup& setup) override;
  void close() noexcept override;
  void stop(Time now) noexcept override;
  std::string command(const HeadCommand& command) override;
  std::string limit(Time now, const motion::Limits& limits) override;
  std::string state(Time time, motion::Pose& pose) override;
  bool simulated() const override { return true; }

 private:
  enum Call : unsigned { kOpen, kCommand, kState, kStop, kClose, kLimit, kCalls };
  struct Part {
    Call call;
    unsigned from;     // number of the call from which the part applies, from 1
    int wait_fd;       // -1: fail
    std::string text;  // of the failure
  };
  void obey();
  std::string parse(std::string_view script);
  std::string parse_part(std::string_view part);
  // details: the text of a record after the time.
  std::string play(Call call, Time time, const std::string& details = {});

  std::vector<Part> parts_;
  std::array<unsigned, kCalls> calls_{};
  int record_fd_ = -1;
  bool open_ = false;
  Time commanded_{};
  HeadCommand last_;
  HeadSetup setup_;
  double pan_ = 0, tilt_ = 0;
};

}  // namespace cerberus::drivers
