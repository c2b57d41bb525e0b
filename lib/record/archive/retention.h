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
    // be wrong, or the recorder was off. Chosen: a day.
    Time absence = std::chrono::days(1);
  };

  Retention() = default;
  explicit Retention(const Parameters& parameters) : parameters_(parameters) {}

  // Returns the ids of `recordings`, which are ordered from oldest to newest, that are to be deleted, oldest first. Size
  // and room are reached by deleting the oldest ones; order decides there, not the clock. None is older than those before
  // it, whatever its end says; an end in the future counts for nothing.
  // Of those that are closed the newest is deleted by age only. A limit that deletion cannot reach, because of kept
  // recordings or of other files on the disk, deletes nothing.
  std::vector<std::int64_t> expired(std::span<const Candidate> recordings, const Limits& limits,
                                    const Surroundings& now);
  // Which limits the last call could not reach, in words for a user; empty: none, or the same ones as before.
  std::string take_fault();

 private:
  bool clock_is_trusted(std::span<const Candidate> recordings, const Surroundings& now);

  Parameters parameters_;
  std::optional<Surroundings> before_;
  std::optional<Time> trusted_from_;  // steady
  std::string fault_, taken_;
};

}  // namespace cerberus::record
