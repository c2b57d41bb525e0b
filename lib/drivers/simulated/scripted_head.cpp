// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/simulated/scripted_head.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <optional>

#include "drivers/simulated/gate.h"
#include "text/numbers.h"

namespace cerberus::drivers {

namespace {

using motion::AxisCommand;

constexpr std::array<std::string_view, 6> kNames{"open", "command", "state", "stop", "close", "limit"};

// Cuts the next word off `text`.
std::string_view word(std::string_view& text) {
  const auto begin = std::min(text.find_first_not_of(' '), text.size());
  text.remove_prefix(begin);
  const std::string_view first = text.substr(0, text.find(' '));
  text.remove_prefix(first.size());
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  return first;
}

std::optional<int> number(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

void append(std::string& line, double value) {
  line.append(1, ' ').append(text::exact(value));
}

void append(std::string& line, const AxisCommand& command) {
  static constexpr std::array<std::string_view, 3> kKinds{" hold", " position", " velocity"};
  line.append(kKinds[static_cast<unsigned>(command.kind)]);
  append(line, command.value);
  append(line, command.speed);
}

void write_all(int fd, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(fd, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;  // the reader has closed the descriptor
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

double follow(double position, const AxisCommand& command, const motion::AxisLimits& limits) {
  if (!std::isfinite(command.value)) return position;
  if (command.kind == AxisCommand::Kind::position) return limits.clamp(command.value);
  if (command.kind == AxisCommand::Kind::velocity && command.value != 0)
    return command.value > 0 ? limits.to : limits.from;
  return position;
}

}  // namespace

std::string ScriptedHead::parse_part(std::string_view part) {
  const std::string whole(part);
  const std::string_view first = word(part);
  if (first.empty()) return {};
  if (first == "record") {
    const auto fd = number(word(part));
    if (!fd) return "script: '" + whole + "' wants a file descriptor";
    record_fd_ = *fd;
    return {};
  }
  const auto call = std::ranges::find(kNames, first);
  if (call == kNames.end()) return "script: '" + std::string(first) + "' is neither record nor a call";
  std::string_view what = word(part);
  unsigned from = 1;
  if (const auto count = number(what)) {
    from = static_cast<unsigned>(*count);
    what = word(part);
  }
  const auto which = static_cast<Call>(call - kNames.begin());
  if (what == "fail") {
    parts_.push_back({which, from, -1, part.empty() ? "the script lets it fail" : std::string(part)});
    return {};
  }
  const auto fd = number(part);
  if (what != "wait" || !fd) return "script: '" + whole + "' neither fails nor waits for a file descriptor";
  parts_.push_back({which, from, *fd, {}});
  return {};
}

std::string ScriptedHead::parse(std::string_view script) {
  parts_.clear();
  record_fd_ = -1;
  while (!script.empty()) {
    const std::string_view part = script.substr(0, script.find(';'));
    script.remove_prefix(std::min(part.size() + 1, script.size()));
    if (std::string wrong = parse_part(part); !wrong.empty()) return wrong;
  }
  return {};
}

std::string ScriptedHead::play(Call call, Time time, const std::string& details) {
  const unsigned count = ++calls_[call];
  if (record_fd_ >= 0 && call != kState) {
    std::string line(kNames[call]);
    line.append(" ").append(std::to_string(time.count())).append(details);
    write_all(record_fd_, line.append("\n"));
  }
  for (const Part& part : parts_) {
    if (part.call != call || count < part.from) continue;
    if (part.wait_fd < 0) return part.text;
    wait_at(part.wait_fd);
  }
  return {};
}

std::string ScriptedHead::open(const HeadSetup& setup) {
  if (std::string wrong = motion::check(setup.limits); !wrong.empty()) return wrong;
  if (std::string wrong = motion::check_start(setup.limits, setup.pan, setup.tilt); !wrong.empty())
    return wrong;
  if (std::string wrong = parse(setup.script); !wrong.empty()) return wrong;
  calls_ = {};
  if (std::string failure = play(kOpen, {}); !failure.empty()) return failure;
  setup_ = setup;
  commanded_ = {};
  last_ = {};
  pan_ = setup.pan;
  tilt_ = setup.tilt;
  open_ = true;
  return {};
}

void ScriptedHead::close() noexcept {
  if (!open_) return;
  play(kClose, commanded_);
  open_ = false;
}

void ScriptedHead::stop(Time now) noexcept {
  if (!open_) return;
  commanded_ = std::max(commanded_, now);
  play(kStop, commanded_);
  last_ = {};
}

void ScriptedHead::obey() {
  pan_ = setup_.limits.pan.clamp(follow(pan_, last_.pan, setup_.limits.pan));
  tilt_ = setup_.limits.tilt.clamp(follow(tilt_, last_.tilt, setup_.limits.tilt));
}

std::string ScriptedHead::command(const HeadCommand& command) {
  if (!open_) return "the scripted head is not open";
  if (command.time < commanded_) return "a stale command: it was given before the last one";
  std::string details;
  append(details, command.pan);
  append(details, command.tilt);
  if (std::string failure = play(kCommand, command.time, details); !failure.empty()) return failure;
  commanded_ = command.time;
  last_ = command;
  obey();
  return {};
}

std::string ScriptedHead::limit(Time now, const motion::Limits& limits) {
  if (!open_) return "the scripted head is not open";
  commanded_ = std::max(commanded_, now);
  std::string details;
  for (const double stop : {limits.pan.from, limits.pan.to, limits.tilt.from, limits.tilt.to})
    append(details, stop);
  if (std::string failure = play(kLimit, commanded_, details); !failure.empty()) return failure;
  setup_.limits = limits;
  obey();
  return {};
}

std::string ScriptedHead::state(Time time, motion::Pose& pose) {
  if (!open_) return "the scripted head is not open";
  if (std::string failure = play(kState, time); !failure.empty()) return failure;
  pose = {};
  pose.from = time;
  pose.pan.position = pan_;
  pose.tilt.position = tilt_;
  return {};
}

}  // namespace cerberus::drivers
