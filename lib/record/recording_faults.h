// SPDX-License-Identifier: LGPL-2.1-or-later
// What keeps recordings from being made or listed, as one state that begins and ends: a disk that does not answer or takes
// nothing, a stream that makes no file, or the index. Each ends by what proves the opposite of it. Times are those of a
// clock that never jumps. Not thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "record/unit.h"

namespace cerberus::record {

class RecordingFaults {
 public:
  struct Parameters {
    // So long a file must have been written without a fault before recording counts as working again. Chosen: several
    // fragments of .4 s. Guarded by the test of a file that fails after its first bytes.
    Time proof = std::chrono::seconds(2);
    // After the disk failed a file, its answer to a trial does not count for so long: where an event goes on, the next file
    // decides. Derived: twice record::Parameters::retry. Guarded by the same test.
    Time settling = std::chrono::seconds(10);
    // Below this the disk is tried out before a recording needs it. Derived: a second of 8 Mbit/s; what a trial takes.
    std::uint64_t least_free = 1 << 20;
    // A disk that has not answered for so long is a fault. Chosen: above the 2 s that the index waits for another program
    // and the 3 s that a muxer waits for audio. Guarded by the tests of a disk that does not answer while it records.
    Time patience = std::chrono::seconds(5);
  };

  RecordingFaults() : RecordingFaults(Parameters{}) {}
  explicit RecordingFaults(const Parameters& parameters) : parameters_(parameters) {}

  // A file could not be written, or not to its end, because of the disk.
  void disk_failed(std::string text, Time now) {
    disk_ = std::move(text);
    failed_at_ = now;
  }
  // ... because of what was to be written: no trial of the disk says anything about that.
  void stream_failed(std::string text) { stream_ = std::move(text); }
  // A file is complete, or has been written for so long.
  void file_complete() { clear_files(); }
  void file_written_for(Time duration) {
    if (duration >= parameters_.proof) clear_files();
  }
  // Whether the folder is to be tried out now. `usable`: it is there and takes files, as far as its mode says; `free`:
  // bytes on its disk; nullopt: not known. `writes`: a file is being written.
  bool must_try(bool usable, std::optional<std::uint64_t> free, bool writes, Time now) const {
    if (!usable || (free && *free < parameters_.least_free)) return true;
    return !disk_.empty() && !writes && (!failed_at_ || now - *failed_at_ >= parameters_.settling);
  }
  // What came of it: what is wrong with the folder; empty: nothing.
  void tried(std::string text) {
    disk_ = std::move(text);
    failed_at_.reset();
  }
  void set_index(std::string text) { index_ = std::move(text); }
  // The disk does not answer; empty: it does.
  void set_silent(std::string text) { silent_ = std::move(text); }
  // Whether something that the disk was asked for at `since` has waited too long.
  bool waits_too_long(Time since, Time now) const { return now - since >= parameters_.patience; }

  // What is wrong; empty: nothing.
  const std::string& text() const {
    for (const std::string* one : {&silent_, &disk_, &stream_})
      if (!one->empty()) return *one;
    return index_;
  }
  // text(), where it is another one than at the last call.
  std::optional<std::string> take_change() {
    if (reported_ == text()) return std::nullopt;
    reported_ = text();
    return reported_;
  }

 private:
  void clear_files() {
    disk_.clear();
    stream_.clear();
    failed_at_.reset();
  }

  Parameters parameters_;
  std::string silent_, disk_, stream_, index_, reported_;
  std::optional<Time> failed_at_;  // of a file, by the disk
};

}  // namespace cerberus::record
