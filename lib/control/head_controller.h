// SPDX-License-Identifier: LGPL-2.1-or-later
// Drives one head: takes frames, decisions and the application's commands, decides, commands the driver, keeps the
// history of poses, and reports. Thread-safe. The controller adds reports to the caller's DeferredNotifications with
// the lock held, and the caller sends them without it.
//
// All times that are passed are running times. The head's own time never goes back: when running time does (a flush),
// head time continues. clock-driven: the head moves while the clock runs; otherwise its time is that of the frames.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "control/deferred_notifications.h"
#include "control/following/base_request.h"
#include "control/following/base_yaw.h"
#include "control/following/dead_time.h"
#include "control/following/speed_table.h"
#include "control/following/zoom_control.h"
#include "control/law.h"
#include "control/manual_override.h"
#include "control/pose_correction.h"
#include "control/target_selector.h"
#include "control/watchdog.h"
#include "drivers/head/head_runner.h"

namespace cerberus::control {

class HeadController {
 public:
  using Time = motion::Time;
  using Answer = drivers::HeadRunner::Answer;
  using Patience = drivers::HeadRunner::Patience;

  // Takes over a head that is open or being opened. The controller is halted until resume().
  void open(std::unique_ptr<drivers::HeadRunner> runner, const drivers::HeadSetup& setup);
  // Reports that the driver cannot open the head, which may happen at any time.
  void on_refusal(DeferredNotifications& out);
  // Waits for the driver for at most `patience`, then abandons it.
  void close(Patience patience);

  // Applies the limits at once, or when a halt ends. Returns an error text for the user if they are invalid; the old
  // limits then stay in force.
  std::string set_limits(const motion::Limits& limits, std::optional<Time> now);
  // The limits of `law` are ignored: set_limits() sets them.
  void set_options(const LawOptions& law, const fusion::FuserOptions& fuser, Time watchdog);
  // Manual commands are replaced by a stop after this time unless they are repeated; 0: positions never, speeds after
  // kTurnTimeout.
  void set_manual_timeout(Time timeout);
  static constexpr std::chrono::milliseconds kTurnTimeout{500};
  void set_clock_driven(bool on);
  // Clears the frames and the end of the stream (a flush): the next frame begins anew.
  void forget();
  // Publishes the pose at the start, which is valid until the head's latency has passed. interrupted: nothing was published;
  // call again, unless tick() follows.
  Answer announce(Time running, DeferredNotifications& out);

  struct Frame {
    std::optional<Observation> seen;  // nullopt: a gap
    Time running;                     // time at which it was taken
    Time length{};                    // duration until the next one, if known
    Time now{};                       // clock-driven: running time by the clock
    vision::Lens lens;
    vision::Size picture{};               // for keep-size; empty: not known
    std::optional<motion::Pose> capture;  // the head's pose at that time, if the frame carries it
    std::optional<PictureMotion> motion;  // since the frame before, where it was measured
    std::optional<Time> repeats;          // the frame repeats the picture that was taken at this running time
  };
  // Processes a frame. interrupted: call again with the same frame; after any other answer the frame is processed.
  Answer frame(const Frame& frame, DeferredNotifications& out);

  // Processes a decision between two frames; it is used only if the clock drives the head and frames come.
  void on_decision(const FusionDecision& decision, Time now, DeferredNotifications& out);

  // Clock-driven: publishes the pose, checks the watchdog. Returns the time of the next call.
  Time tick(Time now, DeferredNotifications& out);
  // Brakes, within `patience`. Frames are ignored until resume(). now: by the clock, if there is one.
  void halt(const char* reason, std::optional<Time> now, Patience patience, DeferredNotifications& out);
  void resume(std::optional<Time> now, DeferredNotifications& out);
  // Ends the stream: a halt that only forget() and open() end. A manual command expires.
  void end(std::optional<Time> now, Patience patience, DeferredNotifications& out);

  // Manual override until automatic(). Radians; now: as for halt(). False: not possible, as during an emergency stop,
  // which the driver reports; after it the head stays until one of these or automatic() is called.
  bool move(double pan, double tilt, bool relative, std::optional<Time> now, DeferredNotifications& out);
  // Radians a second; expires after the manual timeout.
  bool turn(double pan, double tilt, std::optional<Time> now, DeferredNotifications& out);
  bool stop(std::optional<Time> now, DeferredNotifications& out);
  bool automatic(std::optional<Time> now, DeferredNotifications& out);
  // Chooses the track to follow while it lives; ends a manual override. 0 is refused. decided: as of TargetSelector.
  bool follow(std::uint32_t id, std::optional<Time> now, DeferredNotifications& out, bool decided = false);

  // Interrupts waiting calls, as HeadRunner::interrupt().
  void interrupt(bool on);
  // Returns what the camera saw at this running time as the head's zoom says, radians over the frame's width;
  // `otherwise` where it says nothing.
  double field_of_view(Time running, double otherwise) const;
  // Returns the running time of the last processed frame.
  std::optional<Time> newest() const;

 private:
  Time head_time(Time running);
  Time earliest(std::optional<Time> now);
  void confine_law();
  void remember(std::vector<motion::Pose>& poses);
  Time late_of(const motion::Pose& pose) const;
  motion::Pose driver_pose(Time taken) const;
  Time effect_of(Time now) const;
  // Of the picture since the frame before, less the reported turn of the base.
  std::optional<Turn> picture_turn(const Frame& frame) const;
  Moment moment_of(const Frame& frame, Time now);
  // What the picture of a frame shows of the head's speeds. By the driver's reckoning it was between these times.
  void learn_speeds(Time before, Time taken);
  void correct(const Frame& frame, Time now, DeferredNotifications& out);
  drivers::HeadCommand manual_at(Time now) const;
  void order(drivers::HeadCommand command);
  void publish(const std::vector<motion::Pose>& poses, Time until, DeferredNotifications& out);
  void report(HeadState state, std::string reason, Time head, DeferredNotifications& out);
  void report_manual(Time head, DeferredNotifications& out);
  // ends_order: the order by hand that is in force ends with the fault.
  void report_fault(const std::string& failure, bool ends_order, Time head, DeferredNotifications& out);
  void report_refusal(Time head, DeferredNotifications& out);
  void check(const drivers::HeadRunner::Failure& failure, Time head, DeferredNotifications& out);
  // A manual order that was not repeated in time becomes a stop.
  void end_expired_order(Time now, DeferredNotifications& out);
  drivers::HeadCommand decide(const Frame& frame, Time now, DeferredNotifications& out);
  // Asks the base to turn; 0 ends that, and is sent once.
  void ask_base(double yaw_rate, Time now, DeferredNotifications& out);
  void on_timeout(Time head, DeferredNotifications& out);
  void apply_manual(std::optional<Time> now, DeferredNotifications& out);
  void watch_emergency(Time head, DeferredNotifications& out);
  // After reports that contradict the commands no decision moves the head: it waits for an order.
  void watch_reports();
  void end_manual(const char* reason, std::optional<Time> now, DeferredNotifications& out);
  motion::Pose running(motion::Pose pose) const;

  mutable std::mutex lock_;
  std::shared_ptr<drivers::HeadRunner> runner_;
  drivers::HeadSetup setup_;
  bool limits_wait_ = false;  // for the end of a halt
  Law law_;
  motion::PoseHistory history_;          // in the head's time
  PoseCorrection correction_;            // of a head that the clock drives
  DeadTime dead_time_;                   // of the same
  SpeedTable pan_speeds_, tilt_speeds_;  // of the same
  BaseYaw base_yaw_;                     // below the head
  std::optional<Time> taken_;            // the frame before, in the head's time
  ZoomControl zoom_;
  BaseRequest base_request_;
  double base_asked_ = 0;  // radians a second
  Time base_asked_at_{};   // the head's time
  Watchdog watchdog_;
  TargetSelector selector_;
  ManualOverride manual_;
  bool clock_driven_ = false, halted_ = false, faulty_ = false, silent_ = false;
  bool simulated_ = true;       // the head's poses are exact
  bool homing_ = false;         // the head looks for its reference
  bool sees_turns_ = false;     // frames have come whose picture's motion tells how the camera turned
  Time home_tried_{};           // when it began to
  bool ended_ = false;          // the stream
  Time latest_{}, epoch_{};     // head time of the last command; head time = running time + epoch
  Time published_{};            // head time until which poses were published
  bool zoom_reported_ = false;  // that what the head sees is not known
  bool gyro_reported_ = false;  // that one is missing
  bool fresh_ = true;           // no pose was published since running time may have begun anew
  std::optional<Time> newest_;  // running
  Time timeout_{}, manual_timeout_{};
  Time late_since_ = motion::kNever;
  Status status_;
};

}  // namespace cerberus::control
