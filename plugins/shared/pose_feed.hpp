// SPDX-License-Identifier: LGPL-2.1-or-later
// The poses that a head told, as a frame asks for them: now, or once the head's way until the frame's time is known.
#pragma once

#include <cerberus/pose.h>

#include <condition_variable>
#include <mutex>
#include <string>

#include "motion/pose.h"

namespace cerberus::plugin {

// motion::Pose of radians, times and no name, from and to that of the installed library.
motion::Pose from_c(const CerberusPose& pose);
CerberusPose to_c(const motion::Pose& pose);

class PoseFeed {
 public:
  enum class Answer { known, interrupted, silent };

  // Forgets what was told; until somebody tells, the head looks where `start` does.
  void begin(const motion::Pose& start);
  // Time began anew (a flush): what was told is of the time before, the head is where it was.
  void forget();
  void tell(const motion::Pose& pose);
  // Nothing waits while interrupted; patience runs only while the pipeline plays.
  void interrupt(bool on);
  void play(bool on);

  // Where the head looks at `time`, by what is known.
  motion::Pose at(motion::Time time);
  // Waits until that is certain. The first time after begin() or forget() it is: where the head was. silent: nobody
  // told anything for `patience` of real time; zero or less: never give up.
  Answer wait(motion::Time time, motion::Time patience);

 private:
  std::mutex lock_;
  std::condition_variable news_;
  motion::PoseHistory history_;
  motion::Pose here_;       // as last evaluated
  motion::Time until_{-1};  // known until
  bool first_ = true, interrupted_ = false, playing_ = false;
  unsigned long told_ = 0;  // counts news
};

}  // namespace cerberus::plugin
