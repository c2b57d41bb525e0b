// SPDX-License-Identifier: LGPL-2.1-or-later
// The track that an application chose itself: followed while it lives, whatever the usual choice would be.
//
// One who is not on a frame is waited for, because who leaves the picture while the
// camera turns comes back with the same identity (vision::TrackOptions::away_time).
// After that, and when it has never been on a frame, the choice has come to nothing.
#pragma once

#include <cstdint>
#include <optional>

#include "fusion/fuser.h"

namespace cerberus::fusion {

class Chosen {
 public:
  static constexpr Time kPatience = std::chrono::seconds(5);

  enum class Answer : std::uint8_t {
    nobody,   // is chosen, or has been here: the usual choice
    here,     // to be followed
    awaited,  // was here: nobody else is to be followed
    lost,     // on no frame for kPatience: nobody is chosen any more. Said once
  };

  void choose(std::uint32_t id) { *this = {}, id_ = id; }  // 0: nobody
  std::uint32_t id() const { return id_; }
  // Time begins anew.
  void restart() { since_.reset(), seen_.reset(); }
  // Once a frame: is the track on it?
  Answer watch(bool here, Time time);

 private:
  std::uint32_t id_ = 0;
  std::optional<Time> since_;  // the first frame that was looked at
  std::optional<Time> seen_;   // the last one that it was on
};

}  // namespace cerberus::fusion
