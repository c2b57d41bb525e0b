// SPDX-License-Identifier: LGPL-2.1-or-later
#include "heads/head_link.h"

#include <poll.h>

#include <chrono>
#include <csignal>

#include "drivers/helper/helper_head.h"

namespace cerberus::heads {

using namespace drivers;

double now_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string HeadLink::start(const std::string& driver, const HeadSetup& setup) {
  ready_ = false;
  fault_.clear();
  sent_.clear();
  lines_ = {};
  if (std::string wrong = process_.start(helper_arguments(driver, setup)); !wrong.empty()) return wrong;
  send(hello_line(setup, setup.helper_timeout));
  for (const double end = now_seconds() + kStartPatience; now_seconds() < end && !ready_;)
    if (std::string wrong = serve(20); !wrong.empty()) return wrong;
  return ready_ ? "" : "the head's helper does not answer";
}

void HeadLink::send(const std::string& line) {
  process_.send(line);
}

void HeadLink::turn(double pan, double tilt) {
  using Kind = motion::AxisCommand::Kind;
  const auto command = [](double speed) {
    return speed == 0 ? motion::AxisCommand{} : motion::AxisCommand{Kind::velocity, speed, 0};
  };
  std::string line = move_line(command(pan), command(tilt));
  if (line == sent_) return;
  send(line);
  sent_ = std::move(line);
}

std::string HeadLink::serve(int milliseconds) {
  if (now_seconds() - alive_ > 0.1) {
    send("alive\n");
    alive_ = now_seconds();
  }
  pollfd wait{process_.fd(), POLLIN, 0};
  ::poll(&wait, 1, milliseconds);
  std::string bytes;
  const bool there = process_.receive(bytes);
  lines_.append(bytes);
  while (const auto text = lines_.take()) {
    const auto line = parse_helper_line(*text);
    if (!line) continue;
    if (const auto* came = std::get_if<ReadyLine>(&*line)) {
      abilities_ = came->abilities;
      ready_ = true;
    } else if (const auto* reported = std::get_if<FaultLine>(&*line)) {
      fault_ = reported->text;
    } else if (std::get_if<RecoveredLine>(&*line)) {
      fault_.clear();
    } else if (const auto* at = std::get_if<PoseLine>(&*line)) {
      pose = *at;
    }
  }
  return !fault_.empty() ? fault_ : there ? "" : "the head's helper ended";
}

void HeadLink::kill() {
  if (process_.pid() > 0) ::kill(process_.pid(), SIGKILL);
  process_.finish();
}

}  // namespace cerberus::heads
