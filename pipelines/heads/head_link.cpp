// SPDX-License-Identifier: LGPL-2.1-or-later
#include "heads/head_link.h"

#include <poll.h>

#include <chrono>
#include <cstdio>
#include <limits>
#include <thread>
#include <utility>

#include "drivers/head/repeated_start.h"
#include "drivers/helper/helper_head.h"

namespace cerberus::heads {

using namespace drivers;

namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

Time now_is() {
  return std::chrono::duration_cast<Time>(std::chrono::steady_clock::now().time_since_epoch());
}

}  // namespace

double now_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string HeadLink::start(const std::string& driver, const HeadSetup& setup) {
  driver_ = driver;
  setup_ = setup;
  ready_ = false;
  fault_.clear();
  sent_.clear();
  lost_ = false;
  lines_ = {};
  watch_.begin(now_is());
  if (std::string wrong = process_.start(helper_arguments(driver, setup)); !wrong.empty()) return wrong;
  send(hello_line(setup, setup.helper_timeout));
  while (!ready_)
    if (std::string wrong = read(20); !wrong.empty()) return wrong;
  return {};
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
  std::string wrong = read(milliseconds);
  if (!lost_) return wrong;
  kill();
  const std::string not_stopped = start_again();
  return wrong + (not_stopped.empty() ? ", and another one has stopped the head"
                                      : ". Another one was not started: " + not_stopped);
}

std::string HeadLink::read(int milliseconds) {
  if (now_seconds() - alive_ > 0.1) {
    send(std::string(kAlive) + '\n');
    watch_.ask();
    alive_ = now_seconds();
  }
  pollfd wait{process_.fd(), POLLIN, 0};
  ::poll(&wait, 1, milliseconds);
  std::string bytes;
  const bool there = process_.receive(bytes);
  lines_.append(bytes);
  while (const auto text = lines_.take()) {
    const auto line = parse_helper_line(*text);
    if (!line && text->starts_with("pose ")) pose = {{kNoNumber, 0, 0}, {kNoNumber, 0, 0}, 0};
    if (!line) continue;
    watch_.take(*line);
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
  if (!fault_.empty()) return fault_;
  const std::string helper = "the head's helper `" + helper_name(driver_, setup_) + "` ";
  lost_ = ready_ && !there;
  if (!there) return helper + "ended";
  const std::string hung = watch_.judge(now_is(), sent_.find(" at ") != std::string::npos);
  lost_ = !hung.empty();
  return hung.empty() ? "" : helper + "hangs: " + hung + (ready_ ? ". It was killed" : "");
}

std::string HeadLink::finish() {
  std::string wrong;
  stop();
  alive_ = 0;  // whether it hangs just now is asked at once
  do wrong = process_.running() && ready_ ? serve(20) : "";
  while (wrong.empty() && watch_.waits() && ready_ && process_.running());
  process_.finish();
  return wrong;
}

void HeadLink::kill() {
  process_.kill();
  process_.finish();
}

std::string HeadLink::start_again(const std::function<bool()>& pressed) {
  const std::string driver = driver_;
  const HeadSetup setup = setup_;
  const RepeatedStart again{[&] { return start(driver, setup); }, now_seconds, pressed,
                            [] { std::this_thread::sleep_for(std::chrono::milliseconds(10)); },
                            [](const std::string& wrong) {
                              std::fprintf(stderr,
                                           "cerberus-heads: %s. The head may still be turning: cut its power "
                                           "if it does. It is tried again; a key ends that\n",
                                           wrong.c_str());
                            }};
  return again.run();
}

}  // namespace cerberus::heads
