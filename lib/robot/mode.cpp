// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/mode.h"

#include <charconv>

namespace cerberus::robot {

std::string_view name(Mode mode) {
  switch (mode) {
    case Mode::armed:
      return "armed";
    case Mode::disarmed:
      return "disarmed";
    case Mode::privacy:
      break;
  }
  return "privacy";
}

std::optional<Mode> mode_of(std::string_view text) {
  for (const Mode mode : {Mode::armed, Mode::disarmed, Mode::privacy})
    if (text == name(mode)) return mode;
  return std::nullopt;
}

std::optional<Due> due(const Schedule& schedule, LocalTime now) {
  std::optional<Due> latest;
  const int minute = now.weekday * kMinutesOfDay + now.minute;
  for (const ScheduleEntry& entry : schedule) {
    for (int day = 0; day < 7; ++day) {
      if ((entry.days >> day & 1) == 0) continue;
      const int begins = day * kMinutesOfDay + entry.minute;
      const int ago = (minute - begins + kMinutesOfWeek) % kMinutesOfWeek;
      if (!latest || ago <= latest->minutes_ago) latest = {entry.mode, ago};
    }
  }
  return latest;
}

void ModeKeeper::set(Mode mode, std::int64_t utc) {
  mode_ = mode;
  since_ = utc;
}

bool ModeKeeper::tick(LocalTime now, std::int64_t utc) {
  const std::optional<Due> latest = due(schedule_, now);
  if (!latest) return false;
  // The entry took effect within the minute that began so many minutes ago.
  const std::int64_t begins = utc - utc % 60 - std::int64_t{60} * latest->minutes_ago;
  if (since_ >= begins) return false;
  const bool changes = mode_ != latest->mode;
  mode_ = latest->mode;
  since_ = begins;
  return changes;
}

std::string ModeKeeper::state() const {
  return std::string(name(mode_)) + ' ' + std::to_string(since_) + '\n';
}

bool ModeKeeper::restore(std::string_view text, std::int64_t utc) {
  const std::size_t blank = text.find(' ');
  const std::optional<Mode> mode = mode_of(text.substr(0, blank));
  std::int64_t since = 0;
  if (mode && blank != text.npos && text.ends_with('\n')) {
    const char* const end = text.data() + text.size() - 1;
    const auto read = std::from_chars(text.data() + blank + 1, end, since);
    if (read.ec == std::errc() && read.ptr == end && since >= 0) {
      set(*mode, since);
      return true;
    }
  }
  set(Mode::privacy, utc);
  return false;
}

}  // namespace cerberus::robot
