// SPDX-License-Identifier: LGPL-2.1-or-later
// Which frames of a live camera are too old to be analysed: a head that follows a picture of seconds ago turns to where
// nobody is any more. Time is a parameter.
#pragma once

#include <chrono>
#include <cstdint>
#include <utility>

namespace cerberus::robot {

class LateFrames {
 public:
  using Duration = std::chrono::nanoseconds;

  struct Parameters {
    // Chosen: a person who walks (1.5 m/s) at 5 m has turned by 9 degrees in it, a quarter of a usual picture, and frames
    // of a machine that keeps up are 10 to 100 ms old (docs/manual/robot.md). Guard: the test "cerberusd".
    Duration limit = std::chrono::milliseconds(500);
    // So often a frame is analysed however late it is: a slow machine sees something, and the watchdog too.
    Duration least = std::chrono::seconds(1);
    // So long encoded frames may be late before they are dropped to the next keyframe: what a network held up comes at
    // once, and a decoder that is fast enough makes up for it without a gap. Chosen: 3 s of 25 frames a second take .4 s at
    // 5 ms each. Guarded by the test of decoders that are too slow and fast enough.
    Duration patience = std::chrono::seconds(1);
    Duration collect = std::chrono::seconds(1);  // after the first one, so that a report has the others too
    Duration quiet = std::chrono::minutes(1);    // between two reports
  };

  LateFrames() = default;
  explicit LateFrames(const Parameters& parameters) : parameters_(parameters) {}

  // Whether a frame is left out that is `age` old, beyond what its source holds back by itself.
  bool drop(Duration age, Duration now) {
    if (age <= parameters_.limit || now - analysed_ >= parameters_.least) {
      analysed_ = now;
      return false;
    }
    return count(now);
  }
  // The same in front of the decoder, which is what may be too slow: what follows a frame that is left out cannot be
  // decoded, up to the next keyframe. A late keyframe is left out as well, unless frames have been for `least`.
  bool drop_encoded(Duration age, bool keyframe, Duration now) {
    const bool late = age > parameters_.limit;
    if (skipping_) {
      if (!keyframe || (late && now - skips_since_ < parameters_.least)) return count(now);
      skipping_ = late_ = false;
      return false;
    }
    if (late && !late_) late_since_ = now;
    late_ = late;
    if (!late || now - late_since_ < parameters_.patience) return false;
    skipping_ = true;
    skips_since_ = now;
    return count(now);
  }
  // The number of frames to report now; 0: none.
  std::uint64_t report(Duration now) {
    if (dropped_ == 0 || now - since_ < parameters_.collect || now - said_ < parameters_.quiet) return 0;
    said_ = now;
    return std::exchange(dropped_, 0);
  }

 private:
  bool count(Duration now) {
    if (dropped_++ == 0) since_ = now;
    return true;
  }

  Parameters parameters_;
  bool late_ = false, skipping_ = false;  // encoded frames
  Duration late_since_{}, skips_since_{};
  Duration analysed_{}, since_{}, said_ = -parameters_.quiet;
  std::uint64_t dropped_ = 0;  // and not reported
};

}  // namespace cerberus::robot
