// SPDX-License-Identifier: LGPL-2.1-or-later
// Which frames of a running encoded stream one receiver gets.
#pragma once

#include <cstddef>

namespace cerberus::publish {

// A receiver is the pipeline that packs the frames of a mount for all of its clients. It gets one keyframe at once,
// from which its description is made; then nothing until a client plays, for frames that wait would be old by then;
// and from the next keyframe on every frame. A receiver that takes no frames away (a paused client) is cut off at the
// limit and begins again at a keyframe.
class StreamGate {
 public:
  // Frames that may wait in a receiver. Derived: 1 s of 30 frames a second, more than the jitter of a busy machine.
  static constexpr std::size_t kMostWaiting = 30;

  // A client of the receiver plays.
  void play() {
    if (state_ == State::kDescribed) state_ = State::kNeedsKeyframe;
    played_ = true;
  }

  // Returns whether this frame goes to the receiver, which holds `waiting` frames that it has not sent yet.
  bool pass(bool keyframe, std::size_t waiting) {
    if (state_ == State::kFlowing && waiting >= kMostWaiting) state_ = State::kNeedsKeyframe;
    if (state_ == State::kFlowing) return true;
    if (!keyframe || !wants_keyframe(waiting)) return false;
    state_ = played_ ? State::kFlowing : State::kDescribed;
    return true;
  }

  // Returns whether the receiver can go on at a keyframe only, and has room for it. (The keyframe of its description
  // may still wait.)
  bool wants_keyframe(std::size_t waiting) const {
    return state_ == State::kNew || (state_ == State::kNeedsKeyframe && waiting <= 1);
  }

 private:
  enum class State { kNew, kDescribed, kNeedsKeyframe, kFlowing };
  State state_ = State::kNew;
  bool played_ = false;
};

}  // namespace cerberus::publish
