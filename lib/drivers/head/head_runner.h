// SPDX-License-Identifier: LGPL-2.1-or-later
// Runs a head on a thread of its own, so that the caller's wait is bounded by its patience and not by the driver. A
// head that never blocks has no thread and answers within the call, whatever the load of the machine.
//
// Requests do not queue up. Of the requests made while the driver was busy only the newest command is executed, and a
// stop cancels the commands before it. A driver that blocks for ever keeps its thread, its device and its lease until
// it returns; then it stops, closes and ends by itself, even if the runner was destroyed before.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "drivers/head/head.h"
#include "drivers/head/head_lease.h"
#include "drivers/worker.h"

namespace cerberus::drivers {

class HeadRunner {
 public:
  using Patience = drivers::Patience;
  enum class Answer : std::uint8_t {
    done,
    failed,       // the driver reported an error; failure() returns it
    late,         // no answer yet; the request continues
    interrupted,  // interrupt(true) was called
  };
  struct Failure {
    std::string what;    // the driver's error; empty: none
    unsigned order = 0;  // of the last command that was executed until then (HeadCommand::order)
  };
  // moved: called when the head was opened, stopped or commanded; refused: called when it cannot be opened, even if
  // that is found late. Both are called on the worker's thread if there is one, and must not block nor call the runner.
  // A head whose earlier lease is being returned is opened as soon as it is; refused after 10 s. A runner
  // that is destroyed meanwhile opens nothing.
  HeadRunner(std::unique_ptr<Head> head, std::shared_ptr<HeadLease> lease, std::function<void()> moved = {},
             std::function<void()> refused = {});
  // Gives the driver close_patience to stop and close.
  ~HeadRunner();
  HeadRunner(const HeadRunner&) = delete;
  HeadRunner& operator=(const HeadRunner&) = delete;
  void set_close_patience(Patience patience) { close_patience_ = patience; }

  bool simulated() const { return simulated_; }
  Answer open(const HeadSetup& setup, Patience patience);
  Answer stop(Time now, Patience patience);
  // Passes the command to the driver and returns without waiting.
  void command(const HeadCommand& command);
  // Lets the head look for its reference, without waiting. A refusal is a failure().
  void home(Time now);
  // Passes what was learnt, without waiting (Head::learn()).
  void learn(const motion::SpeedMap& pan, const motion::SpeedMap& tilt);
  // Passes limits as command() does. A waiting command is executed within the new limits only: a head that refuses them
  // is stopped, and the limits are passed again before each command.
  void limit(Time now, const motion::Limits& limits);
  // Executes `command`, if there is one, then returns in `poses` the pieces of the trajectory from `from` until `until`
  // (at least one, at most 64). Simultaneous calls are served one after the other.
  Answer ask(const std::optional<HeadCommand>& command, Time from, Time until,
             std::vector<motion::Pose>& poses, Patience patience);

  // true: waiting and later calls of ask() return at once, until interrupt(false) was called as often.
  void interrupt(bool on);
  // Returns the driver's last error since the last call.
  Failure failure();
  // Returns, once, why the head could not be opened; all other requests then fail for this reason. Empty: it is open,
  // or being opened.
  std::string refusal();
  // Returns whether the driver executed the last command and answered the last query of its state.
  bool healthy() const;
  // Returns whether the head's emergency stop was pressed at the last request.
  bool emergency() const;
  // Returns, once, whether the head's reports have parted from its commands (Head::parted()). Commands that were given
  // before that are not executed.
  bool parted();
  // Returns false while a request is in progress.
  bool idle() const;

 private:
  struct Core;
  Answer wait(std::unique_lock<std::mutex>& guard, unsigned long ticket, Patience patience,
              bool interruptible);

  std::shared_ptr<Core> core_;
  std::optional<Worker> worker_;
  bool simulated_;
  Patience close_patience_ = std::chrono::milliseconds(80);
};

}  // namespace cerberus::drivers
