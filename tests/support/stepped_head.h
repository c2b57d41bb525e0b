// SPDX-License-Identifier: LGPL-2.1-or-later
// A head of a real driver in a test's own time and thread: the pipeline's end of the line protocol, the helper's end, the
// driver and its plant, as HelperHead and serve_head() connect them, but without process, socket and clock. Lines arrive
// when they are sent.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "drivers/helper/head_server.h"
#include "drivers/helper/helper_client.h"
#include "support/head_plants.h"

namespace cerberus::tests {

class SteppedHead final : public drivers::Head {
 public:
  using MakePlant = std::function<std::unique_ptr<HeadPlant>(const drivers::HeadSetup&)>;
  explicit SteppedHead(MakePlant make) : make_(std::move(make)) {}

  std::string open(const drivers::HeadSetup& setup) override {
    close();
    client_.emplace([this](std::string line) {
      if (!line.empty()) line.pop_back();  // the line feed
      to_server_.push_back(std::move(line));
    });
    if (std::string wrong = client_->open(setup); !wrong.empty()) return wrong;
    plant_ = make_(setup);
    server_.emplace(plant_->device(), [this](std::string line) { to_client_.push_back(std::move(line)); });
    now_ = next_alive_ = -kLogin;
    plant_->elapse(at_device());
    client_->begin(Time::zero());
    deliver();
    advance(Time::zero());
    open_ = client_->ready();
    return open_ ? std::string() : client_->fault();
  }
  void learn(const motion::SpeedMap& pan, const motion::SpeedMap& tilt) override {
    client_->learn(pan, tilt);
  }
  void close() noexcept override {
    open_ = false;
    server_.reset();
    plant_.reset();
    to_server_.clear();
    to_client_.clear();
  }
  void stop(Time now) noexcept override {
    if (!open_) return;
    advance(now);
    client_->stop(now);
    deliver();
  }
  std::string command(const drivers::HeadCommand& command) override {
    if (!open_) return "the head is not open";
    advance(command.time);
    if (std::string wrong = client_->accept(command); !wrong.empty()) return wrong;
    std::string wrong = client_->execute(now_);
    deliver();
    return wrong;
  }
  std::string limit(Time now, const motion::Limits& limits) override {
    if (!open_) return "the head is not open";
    advance(now);
    std::string wrong = client_->limit(now, limits);
    deliver();
    return wrong;
  }
  std::string home(Time now) override {
    if (!open_) return "the head is not open";
    advance(now);
    std::string wrong = client_->home(now);
    deliver();
    return wrong;
  }
  std::string state(Time time, motion::Pose& pose) override {
    return open_ ? client_->state(time, pose) : "the head is not open";
  }
  bool emergency() override { return open_ && client_->emergency(); }
  bool blocks() const override { return false; }

  // Lets the head, the driver and the hardware work until `time`. The past is left as it is.
  void advance(Time time) {
    while (now_ < time) {
      if (now_ >= next_alive_ && !silent_) {
        to_server_.emplace_back("alive");
        next_alive_ = now_ + client_->setup().helper_timeout / 4;
      }
      deliver();
      const Time device = server_->serve(at_device()),
                 client = silent_ ? motion::kNever : client_->serve(now_);
      Time next = silent_ ? time : std::min(time, next_alive_);
      if (device != motion::kNever) next = std::min(next, device - kSinceBoot);
      if (!silent_) next = std::min(next, client);
      if (deliver()) next = now_;  // the driver answers a line without delay
      now_ = std::min(time, std::max(next, now_ + std::chrono::microseconds(1)));
      plant_->elapse(at_device());
    }
  }
  // The pipeline hangs from now on.
  void fall_silent() { silent_ = true; }
  HeadPlant& plant() { return *plant_; }

 private:
  static constexpr std::chrono::seconds kSinceBoot{1000};  // the device's time at running time 0
  static constexpr std::chrono::seconds kLogin{1};         // before that the head is opened
  Time at_device() const { return now_ + kSinceBoot; }
  // Returns whether there was a line.
  bool deliver() {
    bool any = false;
    while (!to_server_.empty() || !to_client_.empty()) {
      any = true;
      if (!to_server_.empty()) {
        const std::string line = std::exchange(to_server_.front(), {});
        to_server_.pop_front();
        server_->obey(line, at_device());
      } else {
        const std::string line = std::exchange(to_client_.front(), {});
        to_client_.pop_front();
        client_->handle(line, now_);
      }
    }
    return any;
  }

  MakePlant make_;
  std::unique_ptr<HeadPlant> plant_;
  std::optional<drivers::HelperClient> client_;
  std::optional<drivers::HeadServer> server_;
  std::deque<std::string> to_server_, to_client_;
  Time now_{}, next_alive_{};
  bool open_ = false, silent_ = false;
};

}  // namespace cerberus::tests
