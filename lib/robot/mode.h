// SPDX-License-Identifier: LGPL-2.1-or-later
// What the robot may do at present, and the weekly schedule that changes it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cerberus::robot {

enum class Mode : std::uint8_t {
  armed,     // watches, follows and records
  disarmed,  // watches and follows; no event begins
  privacy,   // the cameras are off, nothing is recorded or shown, the head is parked
};

std::string_view name(Mode mode);
std::optional<Mode> mode_of(std::string_view name);

struct ScheduleEntry {
  std::uint8_t days = 0x7f;  // bit 0: Monday ... bit 6: Sunday
  int minute = 0;            // of the day, local time
  Mode mode = Mode::armed;
};
using Schedule = std::vector<ScheduleEntry>;

// Local time minus UTC in seconds, at a moment in seconds since 1970: the machine's time zone.
using UtcOffset = std::function<std::int64_t(std::int64_t utc)>;

// The moment at which clocks first show `wall`, a local time as seconds since 1970-01-01 00:00 local time. At the end of
// summer time clocks show some times twice: the first one counts. At its begin they skip some: the moment of the change
// counts.
std::int64_t moment_of(std::int64_t wall, const UtcOffset& offset);

// The entry that took effect last at or before `utc`, a week back at most; of two at one moment the one of the later local
// time, then the later one in the file. nullopt: the schedule is empty.
struct Due {
  Mode mode = Mode::armed;
  std::int64_t utc = 0;  // when it took effect, seconds since 1970
};
std::optional<Due> due(const Schedule& schedule, std::int64_t utc, const UtcOffset& offset);

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
  bool tick(std::int64_t utc, const UtcOffset& offset);
  // Takes another schedule; it counts from the next tick().
  void set_schedule(Schedule schedule) { schedule_ = std::move(schedule); }

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
