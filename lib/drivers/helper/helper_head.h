// SPDX-License-Identifier: LGPL-2.1-or-later
// A head that a helper process drives (head_lines.h). The driver `external` runs HeadSetup::command by /bin/sh; a
// driver of a real head runs `HeadSetup::helper DRIVER --device=... OPTIONS`.
//
// The process of the pipeline may die at any moment; the helper then sees the end of its input and stops the head. It
// stops it as well when no line has come for helper-timeout. A thread here sends `alive` four times in that time.
// A helper that hangs (helper_watch.h) may have left its head turning: it is killed, and another one is started at once,
// which stops the head as it opens it.
//
// helper_client.h has what is sent and what becomes of the answers.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/head/head.h"
#include "drivers/worker.h"

namespace cerberus::drivers {

class HelperHead final : public Head {
 public:
  // driver: "external", or the name of a driver of the helper program.
  explicit HelperHead(std::string driver) : driver_(std::move(driver)) {}
  ~HelperHead() override;

  std::string check(const HeadSetup& setup) const override;
  std::string open(const HeadSetup& setup) override;
  void close() noexcept override;
  void stop(Time now) noexcept override;
  std::string command(const HeadCommand& command) override;
  std::string limit(Time now, const motion::Limits& limits) override;
  void learn(const motion::SpeedMap& pan, const motion::SpeedMap& tilt) override;
  std::string home(Time now) override;
  std::string state(Time time, motion::Pose& pose) override;
  bool emergency() override;
  bool parted() override;
  std::string fault() override;

 private:
  void leave(std::chrono::steady_clock::duration patience) noexcept;
  struct Core;
  std::string driver_;
  std::shared_ptr<Core> core_;
  std::optional<Worker> worker_;
};

// The helper's name for messages. Never its whole command: arguments may hold a password.
std::string helper_name(const std::string& driver, const HeadSetup& setup);
// The program that serves the driver of this name, and its arguments.
std::vector<std::string> helper_arguments(const std::string& driver, const HeadSetup& setup);

}  // namespace cerberus::drivers
