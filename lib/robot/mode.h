// SPDX-License-Identifier: LGPL-2.1-or-later
// What the robot may do at present, and the weekly schedule that changes it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cerberus::robot {

enum class Mode : std::uint8_t {
  armed,     // watches, follows and records
  disarmed,  // watches and follows; no event begins
  privacy,   // the cameras are off, nothing is recorded or shown, the head is parked
};

std::string_view name(Mode mode);
std::optional<Mode> mode_of(std::string_view name);

constexpr int kMinutesOfDay = 24 * 60, kMinutesOfWeek = 7 * kMinutesOfDay;

struct ScheduleEntry {
  std::uint8_t days = 0x7f;  // bit 0: Monday ... bit 6: Sunday
  int minute = 0;            // of the day, local time
  Mode mode = Mode::armed;
};
using Schedule = std::vector<ScheduleEntry>;

// A moment of local time.
struct LocalTime {
  int weekday = 0;  // 0: Monday
  int minute = 0;   // of the day
};

// The entry that took effect last at or before `now`, a week back at most; of two at one minute the later one in the
// file. nullopt: the schedule is empty.
struct Due {
  Mode mode = Mode::armed;
  int minutes_ago = 0;
};
std::optional<Due> due(const Schedule& schedule, LocalTime now);

// Which mode is in force: what was set by hand holds until the next entry of the schedule takes effect. It survives a
// restart as the text of state().
class ModeKeeper {
 public:
  ModeKeeper(Mode start, Schedule schedule) : mode_(start), schedule_(std::move(schedule)) {}

  Mode mode() const { return mode_; }
  // Sets the mode by hand at `utc` (seconds since 1970).
  void set(Mode mode, std::int64_t utc);
  // Applies the schedule. Returns whether the mode changed. Entries that took effect before the last change do not
  // count.
  bool tick(LocalTime now, std::int64_t utc);

  // "armed 1763863200\n": the mode and when it was set.
  std::string state() const;
  // Takes up what state() gave. What is not such a text counts as privacy that was set by hand at `utc`: the safe side.
  // Returns whether it was one.
  bool restore(std::string_view text, std::int64_t utc);

 private:
  Mode mode_;
  std::int64_t since_ = 0;  // seconds since 1970; 0: never set
  Schedule schedule_;
};

}  // namespace cerberus::robot
