// SPDX-License-Identifier: LGPL-2.1-or-later
// The track that the application chose: it is the target while it lives, whatever the automatic choice would be.
//
// A chosen track that is on no frame is awaited, because a person who leaves the picture while the camera turns
// reappears with the same identity (vision::TrackOptions::away_time). After kPatience the override ends, also for a
// track that has never been on a frame.
#pragma once

#include <cstdint>
#include <optional>

#include "fusion/fuser.h"

namespace cerberus::fusion {

class TargetOverride {
 public:
  static constexpr Time kPatience = std::chrono::seconds(5);

  enum class Answer : std::uint8_t {
    none,     // no override, or its track has not been on a frame yet: the usual choice
    here,     // the track is on the frame: follow it
    awaited,  // the track was on a frame before: follow no other one
    lost,     // the track was on no frame for kPatience: the override has ended. Returned once
  };

  void choose(std::uint32_t id) { *this = {}, id_ = id; }  // 0 ends the override
  std::uint32_t id() const { return id_; }
  // Running time begins anew; the override stays.
  void restart() { since_.reset(), seen_.reset(); }
  // Once a frame. here: whether the track is on it; time: running time of the frame.
  Answer watch(bool here, Time time);

 private:
  std::uint32_t id_ = 0;
  std::optional<Time> since_;  // the first frame since choose()
  std::optional<Time> seen_;   // the last frame with the track
};

}  // namespace cerberus::fusion
