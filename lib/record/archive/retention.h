// SPDX-License-Identifier: LGPL-2.1-or-later
// Which recordings are deleted, from facts alone: by age, by the size of all, by the room on the disk.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "record/unit.h"

namespace cerberus::record {

struct Limits {
  Time age = std::chrono::days(7);  // since its end; zero: no limit
  std::uint64_t total_bytes = 0;    // of all recordings; 0: no limit
  std::uint64_t free_bytes = 0;     // that are to be free on the disk; 0: no limit
};

// What is so at one moment.
struct Surroundings {
  Time utc{};     // by the system's clock, which may jump
  Time steady{};  // by a clock that never jumps
  // On the disk, for this process; nullopt: the folder cannot be reached, and nothing is deleted.
  std::optional<std::uint64_t> free_bytes = 0;
  bool synchronised = true;  // the system's clock is set by another one (NTP)
};

struct Candidate {
  std::int64_t id = 0;
  Time end{};  // UTC; the latest of what is known
  std::uint64_t bytes = 0;
  bool keep = false;  // is never deleted
  bool open = false;  // is being written
};

class Retention {
 public:
  struct Parameters {
    // The system's clock has jumped where it runs ahead of the steady one by more. Chosen: above every correction by
    // NTP while it runs. Guarded by the test of a clock that jumps.
    Time jump = std::chrono::minutes(5);
    // So long after a jump the age does not count: a wrong clock may be put right again before anything is deleted.
    // Chosen: far below the default age. Guarded by the same test.
    Time settling = std::chrono::hours(1);
    // Age does not count either for so long after a start whose newest recording is older than `absence`: the clock may
    // be wrong, or the recorder was off. And for a clock that is not synchronised a time without recordings counts as
    // `absence` at most, unless this object saw it pass: a clock that leaps by years makes no recording older than
    // that. Chosen: a day. Guarded by the tests of clocks that are not synchronised.
    Time absence = std::chrono::days(1);
    // A clock before this time has not been set: no age counts, and nothing is known of the age of recordings with such
    // times. Derived: 2025, before this program was written. Guarded by the test of a clock that was not set.
    Time least_utc = std::chrono::sys_days(std::chrono::year(2025) / 1 / 1).time_since_epoch();
    // Whether deletion makes room is judged after `effect` at the earliest, and by `latest_effect` it must have made
    // `least_effect` of the deleted bytes. Chosen: above the time between two calls of a busy recorder, so that what
    // another program takes meanwhile counts; twice the time after which Btrfs frees blocks (30 s); half.
    // Guarded by the tests of deletions that make no room.
    Time effect = std::chrono::seconds(5), latest_effect = std::chrono::minutes(1);
    double least_effect = .5;
    // Else none is deleted for room until there is enough, or for this time, which doubles up to `longest_pause`. Chosen:
    // a recorder of three cameras at 8 Mbit/s writes 2 GB in the first one. Guarded by the same tests.
    Time pause = std::chrono::minutes(10), longest_pause = std::chrono::days(1);
  };

  Retention() = default;
  explicit Retention(const Parameters& parameters) : parameters_(parameters) {}

  // Returns the ids of `recordings`, which are ordered from oldest to newest, that are to be deleted, oldest first. Size
  // and room are reached by deleting the oldest ones; order decides there, not the clock. None is older than those before
  // it, whatever its end says; an end in the future counts for nothing.
  // Of those that are closed the newest is deleted by age only. A limit that deletion cannot reach, because of kept
  // recordings or of other files on the disk, deletes nothing; nor does the one of room while earlier deletions for it
  // made none, because another program takes it or has a deleted file open.
  std::vector<std::int64_t> expired(std::span<const Candidate> recordings, const Limits& limits,
                                    const Surroundings& now);
  // Which limits the last call could not reach, in words for a user; empty: none, or the same ones as before.
  std::string take_fault();

 private:
  // A deletion for room, at a steady time: the bytes of it, and free and recorded bytes together once it has its effect.
  struct Clearing {
    Time at{};
    std::uint64_t bytes = 0, sum = 0;
  };
  bool clock_is_trusted(std::span<const Candidate> recordings, const Surroundings& now);
  void find_ages(std::span<const Candidate> recordings, const Surroundings& now);
  bool may_clear(const Limits& limits, const Surroundings& now, std::uint64_t sum);

  Parameters parameters_;
  std::optional<Surroundings> before_;
  std::optional<Time> trusted_from_;       // steady
  Time seen_from_{};                       // steady: since then time has passed without a jump
  std::vector<std::optional<Time>> ages_;  // of the recordings; nullopt: unknown
  std::optional<Clearing> clearing_;
  Time cleared_again_ = Time::min(),
       pause_{};  // steady: none is deleted for room before; zero: deletion helped last
  std::string fault_, taken_;
};

}  // namespace cerberus::record
