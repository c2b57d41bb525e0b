// SPDX-License-Identifier: LGPL-2.1-or-later
// The poses that a head publishes, as a frame asks for them: at once, or when the head's motion is known up to the
// frame's time. Thread-safe.
#pragma once

#include <condition_variable>
#include <mutex>

#include "motion/pose.h"

namespace cerberus::motion {

class PoseFeed {
 public:
  enum class Answer { known, interrupted, silent };

  // Drops all poses; until the first one is received the head looks where `start` does.
  void begin(const Pose& start);
  // Running time began anew (a flush): earlier poses are dropped, and the head stays where it was.
  void forget();
  void add(const Pose& pose);
  // Nothing waits while interrupted; patience runs only while the pipeline plays.
  void interrupt(bool on);
  void play(bool on);

  // Where the head looks at `time`, by the poses received so far.
  Pose at(Time time);
  // Waits until at(`time`) is final. The first time after begin() or forget() it is: where the head was. silent: no pose
  // was received for `patience` of real time; zero or less: without end.
  Answer wait(Time time, Time patience);

 private:
  std::mutex lock_;
  std::condition_variable news_;
  PoseHistory history_;
  Pose here_;       // as last evaluated
  Time until_{-1};  // known until
  bool first_ = true, interrupted_ = false, playing_ = false;
  unsigned long news_count_ = 0;
};

}  // namespace cerberus::motion
