// SPDX-License-Identifier: LGPL-2.1-or-later
// A head on a thread of its own: whoever drives it waits as long as he wants to and not as long as the driver does. A
// head that never blocks has no thread: its answer is there at once, whatever else the machine does.
//
// Requests do not queue up. Of what was asked for while the driver was busy the newest command
// counts, and a stop beats the commands before it: nothing is caught up with. A driver that
// blocks for ever keeps its thread, its device and its lease (whatever they are) until it
// returns, then stops, closes and ends by itself; the runner's owner may be long gone.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "drivers/head/head.h"
#include "drivers/worker.h"

namespace cerberus::drivers {

class HeadRunner {
 public:
  using Patience = drivers::Patience;
  enum class Answer : std::uint8_t {
    done,
    failed,       // the driver said no; failure() tells why
    late,         // no answer yet; it goes on
    interrupted,  // somebody called interrupt(true)
  };
  // moved: called when the head was opened, stopped or commanded; refused: when it cannot be opened, however late. On
  // the worker's thread if there is one; must not block nor call the runner.
  HeadRunner(std::unique_ptr<Head> head, std::shared_ptr<void> lease, std::function<void()> moved = {},
             std::function<void()> refused = {});
  // Gives the driver close_patience to stop and close.
  ~HeadRunner();
  HeadRunner(const HeadRunner&) = delete;
  HeadRunner& operator=(const HeadRunner&) = delete;
  void set_close_patience(Patience patience) { close_patience_ = patience; }

  bool simulated() const { return simulated_; }
  Answer open(const HeadSetup& setup, Patience patience);
  Answer stop(Time now, Patience patience);
  // Hands over and returns.
  void command(const HeadCommand& command);
  // As command(). A command that waits is carried out within the new limits, and none without them: a head that refuses
  // them is stopped, and asked again before each command.
  void limit(Time now, const motion::Limits& limits);
  // Carries out `command`, if there is one, then asks for the pieces of the way from `from` until `until` (one piece at
  // least, 64 at most). Two who ask at once are answered one after the other.
  Answer ask(const std::optional<HeadCommand>& command, Time from, Time until,
             std::vector<motion::Pose>& poses, Patience patience);

  // true: who waits in ask() returns at once, and so do all later calls of it, until as many calls with false came.
  void interrupt(bool on);
  // What the driver complained of since the last call; empty: nothing.
  std::string failure();
  // Why the head could not be opened, which is what everything
  // else fails of then; once. Empty: it is open, or being opened.
  std::string refusal();
  // The driver carried out the last command, and told its state when last asked.
  bool healthy() const;
  // False while a request is on its way.
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
