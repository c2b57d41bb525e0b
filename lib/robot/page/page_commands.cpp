// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/page/page_commands.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "robot/page/live_settings.h"

namespace cerberus::robot {

namespace {

using Kind = PageCommand::Kind;

// Of motionview, and the annotated picture.
constexpr std::array<std::string_view, 8> kStages{"picture", "luma",   "difference", "previous-difference",
                                                  "mask",    "labels", "histogram",  "burnt-in"};

template <typename Number>
bool read(std::string_view text, Number& number) {
  const auto done = std::from_chars(text.data(), text.data() + text.size(), number);
  return done.ec == std::errc() && done.ptr == text.data() + text.size();
}

// A share of the turning speed; NaN and infinity are none.
bool read_share(std::string_view text, double& share) {
  return read(text, share) && share >= -1 && share <= 1;
}

}  // namespace

std::optional<PageCommand> parse_command(std::string_view line) {
  if (line.size() > kLongestCommand) return std::nullopt;
  std::array<std::string_view, 4> words{};
  std::size_t count = 0;
  for (;;) {
    if (count == words.size()) return std::nullopt;
    const std::size_t end = line.find(' ');
    words[count++] = line.substr(0, end);
    if (end == line.npos) break;
    line.remove_prefix(end + 1);
  }
  PageCommand command;
  const std::string_view verb = words[0];
  const auto is = [&](std::string_view name, std::size_t arguments) {
    return verb == name && count == arguments + 1;
  };
  bool good = false;
  if (is("ack", 1) || is("seen", 1)) {
    command.kind = verb == "ack" ? Kind::ack : Kind::seen;
    good = read(words[1], command.number);
  } else if (is("camera", 1)) {
    command.kind = Kind::camera;
    command.name = words[1];
    good = !command.name.empty();
  } else if (is("stop", 0) || is("home", 0) || is("auto", 0)) {
    command.kind = verb == "stop" ? Kind::stop : verb == "home" ? Kind::home : Kind::automatic;
    good = true;
  } else if (is("turn", 2)) {
    command.kind = Kind::turn;
    good = read_share(words[1], command.pan) && read_share(words[2], command.tilt);
  } else if (is("follow", 1)) {
    command.kind = Kind::follow;
    good = read(words[1], command.number) && command.number >= 1 && command.number <= 0xffffffff;
  } else if (is("drive", 2)) {
    command.kind = Kind::drive;
    good = read_share(words[1], command.pan) && read_share(words[2], command.tilt);
  } else if (is("stage", 1)) {
    command.kind = Kind::stage;
    command.name = words[1];
    good = std::ranges::find(kStages, words[1]) != kStages.end();
  } else if (is("set", 2)) {
    command.kind = Kind::set;
    command.name = words[1];
    const LiveSetting* setting = find_live_setting(words[1]);
    good = setting && read(words[2], command.value) && command.value >= setting->least &&
           command.value <= setting->most;
  } else if (is("mode", 1)) {
    command.kind = Kind::mode;
    const std::optional<Mode> mode = mode_of(words[1]);
    good = mode.has_value();
    command.mode = mode.value_or(Mode::privacy);
  }
  if (!good) return std::nullopt;
  return command;
}

}  // namespace cerberus::robot
