// SPDX-License-Identifier: LGPL-2.1-or-later
// When an encoder that serves many receivers is asked for a keyframe.
#pragma once

#include <chrono>
#include <optional>

namespace cerberus::publish {

// A receiver that joins a running stream shows nothing until the next keyframe (10 s at a GOP of 250 frames), so one is
// asked for. Requests that come together are one, and requests that follow each other closely wait: a keyframe has five
// to ten times the bytes of another frame, and receivers that join again and again must not make every frame one.
class KeyframeRequests {
 public:
  using Time = std::chrono::nanoseconds;  // any clock that does not go back
  struct Parameters {
    // Shortest time between two keyframes that are asked for. Derived: five frames of 25 a second, so that the stream
    // has at most three times its bytes; a receiver waits at most so long.
    Time interval = std::chrono::milliseconds(200);
    // An encoder that has not answered for so long is asked again: its request was lost, as in a pipeline that is not
    // yet playing. Derived: longer than an encoder with frame threads holds frames back (.5 s).
    Time patience = std::chrono::seconds(1);
  };

  KeyframeRequests() = default;
  explicit KeyframeRequests(const Parameters& parameters) : parameters_(parameters) {}

  // A receiver needs a keyframe. Returns whether the encoder is to be asked now.
  bool request(Time now);

  // The encoder gave out a frame. Returns whether it is to be asked now, for a request that had to wait.
  bool frame(Time now, bool keyframe);

 private:
  bool ask(Time now);

  Parameters parameters_;
  bool waiting_ = false;              // a receiver needs a keyframe that was not asked for yet
  bool asked_ = false;                // asked for, and not come yet
  std::optional<Time> last_request_;  // when the encoder was asked last
};

}  // namespace cerberus::publish
