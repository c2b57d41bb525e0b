// SPDX-License-Identifier: LGPL-2.1-or-later
// Decides which frames of an encoded stream decode to damaged pictures because a part of the stream is lost: all from
// the loss to the next keyframe, because each is predicted from the one before it. Decoders conceal what is missing and
// do not mark it. Not thread-safe.
#pragma once

#include <chrono>
#include <optional>

namespace cerberus::vision {

class StreamDamage {
 public:
  using Time = std::chrono::nanoseconds;

  // Guarded by unit-frame_history.
  struct Parameters {
    // Without a keyframe for so many seconds, the pictures are refreshed in another way (intra refresh), which the
    // stream does not mark: none counts as damaged then. Derived: 250 frames, the longest usual GOP, at 10 a second.
    double longest_gop = 25;
  };

  // The stream begins anew (segment, flush): the mark on its first frame is no loss.
  void begin() { *this = {}; }

  struct Unit {
    bool after_loss = false;   // marked by the receiver: something before it, or in it, is lost (DISCONT)
    bool keyframe = false;     // predicted from no other frame
    std::optional<Time> time;  // of decoding or presentation, where known
  };
  // Adds the next unit of the stream, a frame or a part of one. Returns whether its picture is damaged.
  bool add(const Unit& unit);

 private:
  Parameters parameters_;
  bool any_ = false, predicts_ = false;  // a unit has come; one that is predicted from others
  bool damaged_ = false;
  std::optional<Time> keyframe_;
};

}  // namespace cerberus::vision
