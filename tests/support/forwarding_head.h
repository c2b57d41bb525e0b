// SPDX-License-Identifier: LGPL-2.1-or-later
// A head that passes everything on to another one: tests override what they watch or change.
#pragma once

#include <memory>
#include <string>

#include "drivers/head/head.h"

namespace cerberus::tests {

class ForwardingHead : public drivers::Head {
 public:
  explicit ForwardingHead(const char* driver = "simulated") : head_(drivers::make_head(driver)) {}
  std::string open(const drivers::HeadSetup& setup) override { return head_->open(setup); }
  void close() noexcept override { head_->close(); }
  void stop(motion::Time now) noexcept override { head_->stop(now); }
  std::string command(const drivers::HeadCommand& command) override { return head_->command(command); }
  std::string limit(motion::Time now, const motion::Limits& limits) override {
    return head_->limit(now, limits);
  }
  std::string state(motion::Time time, motion::Pose& pose) override { return head_->state(time, pose); }
  bool simulated() const override { return head_->simulated(); }
  bool blocks() const override { return head_->blocks(); }

 private:
  std::unique_ptr<drivers::Head> head_;
};

}  // namespace cerberus::tests
