// SPDX-License-Identifier: LGPL-2.1-or-later
// The way of a camera to a preset, by which a lost reference is found.
#pragma once

#include <cstdint>

#include "motion/pose.h"

namespace cerberus::drivers::onvif {

class Homing {
 public:
  // longest: after which the camera is there, where its MoveStatus does not say so.
  explicit Homing(motion::Time longest) : longest_(longest) {}
  bool busy() const { return state_ != State::none; }
  bool wanted() const { return state_ == State::wanted; }
  void want() { state_ = State::wanted; }
  void end() { state_ = State::none; }
  void on_sent(motion::Time now) {
    state_ = State::sent;
    sent_ = now;
  }
  // MoveStatus of an inquiry that was sent at `asked`.
  void on_move_status(bool moving, motion::Time asked) {
    if (state_ == State::sent && moving && asked > sent_) state_ = State::moving;
    if (state_ == State::moving && !moving && asked > sent_) state_ = State::there;
  }
  // Once: it is there.
  bool take(motion::Time now) {
    const bool late = (state_ == State::sent || state_ == State::moving) && now - sent_ >= longest_;
    if (!late && state_ != State::there) return false;
    state_ = State::none;
    return true;
  }

 private:
  enum class State : std::uint8_t { none, wanted, sent, moving, there } state_ = State::none;
  motion::Time longest_, sent_{};
};

}  // namespace cerberus::drivers::onvif
