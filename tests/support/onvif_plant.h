// SPDX-License-Identifier: LGPL-2.1-or-later
// The ONVIF driver and the emulated camera (onvif_camera.h) in a test's own time, without HTTP between them.
#pragma once

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "drivers/onvif/onvif_head.h"
#include "support/head_plants.h"
#include "support/onvif_camera.h"

namespace cerberus::tests {

// Hands requests to the camera, which obeys at once; its answer needs `answer_time`. The answers of the login, which
// waits for them in real time, need none.
class SteppedHttp final : public drivers::onvif::HttpClient {
 public:
  SteppedHttp(OnvifCamera& camera, const SteppedTime& time, std::chrono::milliseconds answer_time)
      : camera_(camera), time_(time), answer_time_(answer_time) {}
  ~SteppedHttp() override { ::close(fd_); }
  void post(const drivers::onvif::HttpRequest& request) override {
    if (request.body.find("ContinuousMove") != std::string::npos) logged_in_ = true;
    if (gone_) {
      answers_.push_back({time_.now() + answer_time_, {request.id, 0, "", "Connection refused"}});
      return;
    }
    const auto path = request.url.find('/', request.url.find("//") + 2);
    const HttpReply reply =
        camera_.answer({path == std::string::npos ? "/" : request.url.substr(path), "", request.body});
    const auto delay = !logged_in_  ? std::chrono::milliseconds(0)
                       : reply.lost ? request.timeout
                                    : answer_time_ + reply.delay;
    drivers::onvif::HttpAnswer answer{request.id, reply.status, reply.body, ""};
    if (reply.lost) answer = {request.id, 0, "", "it timed out"};
    answers_.push_back({time_.now() + delay, std::move(answer)});
    std::ranges::stable_sort(answers_, {}, &Late::due);
  }
  void cancel(unsigned id) override {
    std::erase_if(answers_, [id](const Late& late) { return late.answer.id == id; });
  }
  std::optional<drivers::onvif::HttpAnswer> take() override {
    if (answers_.empty() || answers_.front().due > time_.now()) return std::nullopt;
    auto answer = std::move(answers_.front().answer);
    answers_.pop_front();
    return answer;
  }
  void set_gone(bool gone) { gone_ = gone; }
  int fd() const override { return fd_; }
  const std::string& user() const override { return user_; }
  std::optional<drivers::onvif::UsernameToken> token(const std::string&, bool) override {
    return std::nullopt;
  }
  std::chrono::milliseconds utc() const override { return std::chrono::milliseconds(1'800'000'000'000); }

 private:
  struct Late {
    std::chrono::nanoseconds due;
    drivers::onvif::HttpAnswer answer;
  };
  OnvifCamera& camera_;
  const SteppedTime& time_;
  std::chrono::milliseconds answer_time_;
  bool logged_in_ = false, gone_ = false;
  std::deque<Late> answers_;
  std::string user_;
  int fd_ = ::eventfd(1, EFD_CLOEXEC | EFD_NONBLOCK);  // always readable
};

struct OnvifPlant final : HeadPlant {
  SteppedTime time;
  mutable OnvifCamera camera;
  SteppedHttp* http;  // of the head
  std::optional<drivers::OnvifHead> head;
  // A camera without positions.
  explicit OnvifPlant(std::chrono::milliseconds dead_time = {})
      : OnvifPlant(
            {.move_status = OnvifFaults::MoveStatus::absent, .positions = false, .dead_time = dead_time},
            [](drivers::OnvifOptions& options) { options.feedback = false; }, std::chrono::milliseconds(20)) {
  }
  // adjust: changes the options, which are those of a camera that is turned at speeds.
  OnvifPlant(OnvifFaults faults, const std::function<void(drivers::OnvifOptions&)>& adjust,
             std::chrono::milliseconds answer_time)
      : camera(std::move(faults), &time) {
    drivers::OnvifOptions options;
    must(drivers::onvif::parse_device(camera.device(), options.login.device));
    options.mechanics.full_speed = {OnvifCamera::kPanSpeed, OnvifCamera::kTiltSpeed};
    options.absolute = false;
    if (adjust) adjust(options);
    auto made = std::make_unique<SteppedHttp>(camera, time, answer_time);
    http = made.get();
    head.emplace(std::move(made), options);
  }
  drivers::HeadDevice& device() override { return *head; }
  void elapse(Time now) override { time.set(now); }
  double pan() const override { return camera.pan(); }
  double tilt() const override { return camera.tilt(); }
  double precision() const override { return 1.5; }
  std::size_t actions() const override {
    return static_cast<std::size_t>(camera.count("ContinuousMove") + camera.count("Stop"));
  }
  bool powered() const override { return camera.speed() != 0; }
  void unplug() override { http->set_gone(true); }
  void plug() override { http->set_gone(false); }
};

}  // namespace cerberus::tests
