// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/mode.h"

#include <algorithm>
#include <charconv>

namespace cerberus::robot {

namespace {

constexpr std::int64_t kDay = 86400;       // seconds
constexpr std::int64_t kFirstWeekday = 3;  // 1970-01-01 was a Thursday

}  // namespace

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

std::int64_t moment_of(std::int64_t wall, const UtcOffset& offset) {
  // Time zones are at most 14 hours from UTC: a day before and a day after `wall` enclose its moment.
  const std::int64_t before = offset(wall - kDay), after = offset(wall + kDay);
  std::int64_t early = wall - std::max(before, after), late = wall - std::min(before, after);
  for (const std::int64_t moment : {early, late})
    if (moment + offset(moment) == wall) return moment;
  // The clocks skip it: the change lies between both.
  const std::int64_t first = offset(early);
  while (late - early > 1) {
    const std::int64_t middle = early + (late - early) / 2;
    (offset(middle) == first ? early : late) = middle;
  }
  return late;
}

std::optional<Due> due(const Schedule& schedule, std::int64_t utc, const UtcOffset& offset) {
  std::optional<Due> latest;
  std::int64_t latest_wall = 0;
  const std::int64_t local = utc + offset(utc);
  const std::int64_t today = local / kDay - (local % kDay < 0 ? 1 : 0);
  for (const ScheduleEntry& entry : schedule) {
    // Clocks that are set back over midnight have shown times of tomorrow already.
    for (std::int64_t day = today + 1; day >= today - 8; --day) {
      const std::int64_t weekday = ((day + kFirstWeekday) % 7 + 7) % 7;
      if ((entry.days >> weekday & 1) == 0) continue;
      const std::int64_t wall = day * kDay + 60 * entry.minute;
      const std::int64_t moment = moment_of(wall, offset);
      if (moment > utc) continue;
      if (!latest || std::pair(moment, wall) >= std::pair(latest->utc, latest_wall)) {
        latest = {entry.mode, moment};
        latest_wall = wall;
      }
      break;  // the days before are earlier
    }
  }
  return latest;
}

void ModeKeeper::set(Mode mode, std::int64_t utc) {
  mode_ = mode;
  since_ = utc;
}

bool ModeKeeper::tick(std::int64_t utc, const UtcOffset& offset) {
  const std::optional<Due> latest = due(schedule_, utc, offset);
  if (!latest || since_ >= latest->utc) return false;
  const bool changes = mode_ != latest->mode;
  mode_ = latest->mode;
  since_ = latest->utc;
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
