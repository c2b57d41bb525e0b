// SPDX-License-Identifier: LGPL-2.1-or-later
// The program that drives a robot's base: it is given lines, and started again when it ends. Main loop's thread; never
// waits for it.
#pragma once

#include <gio/gio.h>

#include <functional>
#include <string>

#include "robot/backoff.h"
#include "robot/base_drive.h"
#include "robot/settings.h"

namespace cerberus::robot {

class BaseOutput {
 public:
  explicit BaseOutput(BaseSettings settings) : settings_(std::move(settings)) {}
  ~BaseOutput();
  BaseOutput(const BaseOutput&) = delete;
  BaseOutput& operator=(const BaseOutput&) = delete;

  // Called with each line that the program is given: metres a second, forwards positive.
  using OnSpeed = std::function<void(double speed)>;
  void set_on_speed(OnSpeed on_speed) { on_speed_ = std::move(on_speed); }

  // Shares of the greatest speeds, -1 to 1; for 500 ms unless it is repeated. False: the program does not run.
  bool drive(double speed, double yaw_rate);
  void stop();
  // A head asks for so many degrees a second; no more than the greatest yaw rate. 0: it asks no more.
  void ask(double yaw_rate);
  // Once a second: starts the program where it does not run.
  void tick();

 private:
  void start();
  void repeat();
  void close();
  void send();
  // Bytes of lines that the program has not read.
  int unread() const;
  void kill(const std::string& why);

  BaseSettings settings_;
  OnSpeed on_speed_;
  BaseDrive drive_;
  Backoff backoff_;
  GSubprocess* program_ = nullptr;
  GOutputStream* input_ = nullptr;  // of program_, not blocking
  guint timer_ = 0;
  bool lags_ = false;  // lines waited a second ago, and none was sent since
};

}  // namespace cerberus::robot
