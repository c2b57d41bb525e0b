// SPDX-License-Identifier: LGPL-2.1-or-later
// The pipeline's end of the line protocol (head_lines.h): which lines make a head do what it is commanded, and its pose
// from the lines that come back. No process, no thread and no clock: helper_head.h has them, and a test has its own
// time. All times are running times.
//
// The pose is dead-reckoned: a model of the head (SimulatedHead) carries out the same commands with the same limits and
// latency. Where the helper reports positions, the difference to the model at the time of the measurement corrects it, and
// the model begins at the first one; where they cease, or the head has come to rest after a hold, the model is placed where
// they left it. Positions that part from the commands (motion/report_watch.h) are not believed: the head is stopped, and a
// fault, until parted() was called and a command that moves it follows.
// A helper without positions may report the speeds that its steps give; the pose is then their integral from
// the time at which they take effect (motion/reckoning.h), and the head is made to follow the model.
// A head that only turns at speeds is given the speeds of the model's motion, so it brakes before its limits; one that
// only goes to angles is given the model's angles.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "drivers/head/head.h"
#include "drivers/helper/head_lines.h"
#include "drivers/simulated/simulated_head.h"
#include "motion/reckoning.h"
#include "motion/report_watch.h"

namespace cerberus::drivers {

class HelperClient {
 public:
  using Send = std::function<void(const std::string& line)>;  // with its line feed
  explicit HelperClient(Send send) : send_(std::move(send)) {}

  // The head of the next helpers. Returns what is wrong with the setup; nothing is sent.
  std::string open(const HeadSetup& setup);
  // A helper was started: greets it.
  void begin(Time now);
  // A line of the helper, without its line feed. Returns it if it is one of the protocol.
  std::optional<HelperLine> handle(const std::string& text, Time now);
  // The helper is gone, for this reason, which is reported also where its successor is ready sooner. begin() is for that
  // successor; its head stands until the next command.
  void lose(std::string why);

  // A command is taken over, which the model carries out from now on, and then sent. Both return an error for the user.
  std::string accept(const HeadCommand& command);
  std::string execute(Time now);
  void stop(Time now) noexcept;
  std::string limit(Time now, const motion::Limits& limits);
  // What the head makes of commanded speeds, of commands and of its reports from now on.
  void learn(const motion::SpeedMap& pan, const motion::SpeedMap& tilt) {
    setup_.pan_speeds = pan;
    setup_.tilt_speeds = tilt;
  }
  std::string home(Time now);
  // Sends what is due. Returns when it must be called again at the latest; motion::kNever: not by itself.
  Time serve(Time now);

  std::string state(Time time, motion::Pose& pose);
  bool emergency() { return std::exchange(was_pressed_, pressed_) || pressed_; }
  // Once after the reports have parted from the commands.
  bool parted() { return std::exchange(parted_untold_, false); }
  bool ready() const { return ready_; }
  bool moves_zoom() const { return abilities_.zoom; }
  const std::string& fault() const { return fault_; }
  // As Head::fault(): also while a new helper is not ready.
  std::string fault_at_rest();
  // Whether the head was sent a command that makes it turn now.
  bool turns(Time now);
  const HeadSetup& setup() const { return setup_; }

 private:
  // One axis of a head that reports positions.
  struct Reports {
    motion::ReportWatch watch;
    double correction = 0;  // radians: what to add to the model
    bool rested = false;    // it has come to rest since the last command that moves it, and was placed there
    Time moved{};           // when the model moved last
  };

  void take(const HelperLine& line, Time now);
  void take_pose(const PoseLine& pose, Time now);
  void take_pose(const motion::PanTilt& reported, Time at, Time now);
  void place(Time now, motion::PanTilt by);
  void part(const char* axis, double reported, double commanded, Time now);
  std::string why_idle() const;  // why no command is sent; empty: they are
  void send_command(Time now);
  void send_stop();
  void send_zoom();
  void stand(Time now);
  void follow(Time now);
  void check_homing(Time now);
  double field_of_view() const;  // as in motion::Pose
  bool is_following() const { return ready_ && follows_ && fault_.empty() && parted_.empty(); }
  // Whether the last report is young enough to correct the model with.
  bool is_fresh(Time now) const;
  Time period() const { return Time(static_cast<Time::rep>(1e9 / abilities_.rate)); }

  Send send_;
  HeadSetup setup_;
  SimulatedHead model_;
  HeadAbilities abilities_;
  bool ready_ = false, follows_ = false;
  bool pressed_ = false, was_pressed_ = false;  // the emergency stop: now; since the last emergency()
  std::string fault_;                           // of the head, as the helper reports it
  std::string notice_;                          // what the next execute() returns, once
  std::string loss_;                            // why the helper was lost, until it is reported once
  HeadCommand last_;                            // of the caller
  std::string last_move_;                       // as sent
  Time next_follow_{};
  Reports pan_, tilt_;
  bool adopts_ = true;            // the next report is where the head is, whatever it was commanded
  std::string parted_;            // how the reports have parted from the commands; empty: they have not
  bool parted_untold_ = false;    // to parted()
  std::optional<Time> measured_;  // time of the last report that was believed
  motion::PanTilt reported_;      // its position
  motion::Reckoning reckoning_;   // of a head that reports speeds instead of positions
  bool reckons_ = false;          // it does
  std::optional<double> zoom_;    // position, as the helper reports it
  std::optional<Time> homing_;    // since when the head looks for its reference
};

}  // namespace cerberus::drivers
