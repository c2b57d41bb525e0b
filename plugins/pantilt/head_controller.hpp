// SPDX-License-Identifier: LGPL-2.1-or-later
// Between frames, the application's wishes and a head: decides, commands, remembers
// where the head looked, and says what is to be told to others. Thread-safe; what
// it tells is put into the caller's outbox, to be sent off without any lock held.
//
// Times in and out are running times. The head's own time never
// goes back: where running time does (a flush), it goes on.
#pragma once

#include <gst/gst.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "control/law.h"
#include "control/watchdog.h"
#include "deferred_notifications.hpp"
#include "drivers/head/head_runner.h"
#include "target_selector.hpp"

namespace cerberus::plugin {

class HeadController {
 public:
  using Time = motion::Time;
  using Answer = drivers::HeadRunner::Answer;

  // The head is open or being opened.
  void open(std::unique_ptr<drivers::HeadRunner> runner, const drivers::HeadSetup& setup);
  // What there is to be told of a head that could not be opened, however late.
  void hear(DeferredNotifications& out);
  // Gives the driver the rest of its patience, then leaves it to itself.
  void close(drivers::HeadRunner::Patience patience);

  // While the head is there; at once, and in a halt when that ends.
  // What is wrong with them, once; then they stay as they were.
  std::string set_limits(const motion::Limits& limits, std::optional<Time> now);
  // The limits are not those of `law`.
  void set_options(const control::LawOptions& law, const fusion::FuserOptions& fuser, Time watchdog);
  // clock_driven: the head moves while the clock runs, and tick() is called; otherwise its time is that of the frames.
  void set_clock_driven(bool on);
  // Forgets the frames so far, and that they were over (flush): the next one begins anew.
  void forget();
  // Where the head looks at the start, valid until its latency allows something else. interrupted: call again.
  Answer announce(Time running, DeferredNotifications& out);

  struct Frame {
    GstBuffer* buffer;  // nullptr: a gap
    Time running;       // when it was taken
    Time length{};      // until the next one, as far as known
    Time now{};         // clock-driven: running time by the clock
    vision::Lens lens;
    std::optional<motion::Pose> capture;  // where the head looked then, if the frame says so
  };
  // interrupted: call again. Other answers: done with it.
  Answer frame(const Frame& frame, DeferredNotifications& out);

  // What was decided between two frames, if the clock drives the head and frames are obeyed.
  void heed(const CerberusFusion& fusion, Time now, DeferredNotifications& out);

  // Lets the clock's time pass. Returns when it wants to be called again.
  Time tick(Time now, DeferredNotifications& out);
  // Brakes, in the time that patience gives. Frames are not obeyed until resume(). now: by the clock, if there is one.
  void halt(const char* reason, std::optional<Time> now, drivers::HeadRunner::Patience patience,
            DeferredNotifications& out);
  void resume(std::optional<Time> now, DeferredNotifications& out);
  // The stream is over: a halt that only forget() and open() end;
  // nothing moves the head meanwhile. An order by hand ends, too.
  void end(std::optional<Time> now, drivers::HeadRunner::Patience patience, DeferredNotifications& out);

  // Manual override until automatic(). now: as for halt(). false: not possible.
  bool move(double pan, double tilt, bool relative, std::optional<Time> now, DeferredNotifications& out);
  bool stay(std::optional<Time> now, DeferredNotifications& out);
  bool automatic(std::optional<Time> now, DeferredNotifications& out);
  // The track to be followed while it lives; the frames decide again. 0 is none.
  bool follow(guint id, std::optional<Time> now, DeferredNotifications& out);

  void interrupt(bool on);
  // When the last frame was taken that counted.
  std::optional<Time> newest() const;

 private:
  Time head_time(Time running);
  Time earliest(std::optional<Time> now);
  void confine_law();
  void remember(const std::vector<motion::Pose>& poses);
  void publish(const std::vector<motion::Pose>& poses, Time until, DeferredNotifications& out);
  void say(const char* state, std::string reason, Time head, DeferredNotifications& out);
  void complain(const std::string& failure, Time head, DeferredNotifications& out);
  void report_refusal(Time head, DeferredNotifications& out);
  void check(const std::string& failure, Time head, DeferredNotifications& out);
  drivers::HeadCommand decide(const Frame& frame, Time now, DeferredNotifications& out);
  bool override(const char* reason, const drivers::HeadCommand& command, std::optional<Time> now,
                DeferredNotifications& out);
  void lapse(const char* reason);
  void stand(Time head, DeferredNotifications& out);
  void say_by_hand(Time head, DeferredNotifications& out);
  void give_back(const char* reason, std::optional<Time> now, DeferredNotifications& out);
  motion::Pose running(motion::Pose pose) const;

  mutable std::mutex lock_;
  std::shared_ptr<drivers::HeadRunner> runner_;
  drivers::HeadSetup setup_;
  motion::Limits asked_;      // by set_limits()
  bool limits_wait_ = false;  // for the end of a halt
  control::Law law_;
  motion::PoseHistory history_;  // of the head's time
  control::Watchdog watchdog_;
  TargetSelector pilot_;
  bool clock_driven_ = false, halted_ = false, manual_ = false, faulty_ = false, silent_ = false;
  bool ended_ = false;           // the stream
  drivers::HeadCommand wanted_;  // by hand
  const char* hand_ = "";        // why
  Time told_{}, epoch_{};        // head time of the last command; head time = running time + epoch
  Time published_{};             // head time until which poses were told
  bool fresh_ = true;            // nothing was told since running time may have begun anew
  std::optional<Time> newest_;   // running
  Time timeout_{};
  Time late_since_ = motion::kNever;
  Status status_;
};

}  // namespace cerberus::plugin
