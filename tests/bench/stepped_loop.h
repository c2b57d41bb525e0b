// SPDX-License-Identifier: LGPL-2.1-or-later
// The closed loop with a driver of a real head in step with the frames: the head's controller, both ends of the line
// protocol, the driver and its emulated head (tests/support/stepped_head.h) take the place of pantiltsink, its helper
// process and the hardware. Their time is that of the frames. Nothing depends on the load of the machine.
#pragma once

#include <cerberus/cerberus.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "control/head_controller.h"
#include "in_window.h"
#include "sensing/angles.h"
#include "shared/camera_path.hpp"
#include "shared/clock_times.hpp"
#include "shared/poses.hpp"
#include "shared/tracks.hpp"
#include "support/stepped_head.h"

namespace cerberus::bench {

class SteppedLoop {
  // action(reports): what the controller reports is sent afterwards. In front of its callers, whose types follow from it.
  template <typename Act>
  auto act(Act action) {
    control::DeferredNotifications reports(queue_, name_);
    const auto send = [&] {
      reports.send(
          [this](const char*, const motion::Pose& pose) {
            published_ = plugin::to_c(pose);
            published_->head = "head";
            if (out_) gst_pad_push_event(out_, cerberus_event_new_pose(&*published_));
          },
          [](const char*, const control::Notice& notice) {
            if (const auto* fault = std::get_if<control::Fault>(&notice))
              std::fprintf(stderr, "bench: %s\n", fault->what.c_str());
          });
    };
    if constexpr (std::is_void_v<decltype(action(reports))>) {
      action(reports);
      send();
    } else {
      const auto result = action(reports);
      send();
      return result;
    }
  }

 public:
  using Time = motion::Time;

  // latency: what the pipeline takes the head's dead time for.
  SteppedLoop(tests::SteppedHead::MakePlant make, Time latency) {
    drivers::HeadSetup setup;
    setup.limits.pan.from = -sensing::radians(kPan);
    setup.limits.pan.to = sensing::radians(kPan);
    setup.limits.tilt.from = -sensing::radians(kTilt);
    setup.limits.tilt.to = sensing::radians(kTilt);
    setup.latency = latency;
    auto head = std::make_unique<tests::SteppedHead>(std::move(make));
    head_ = head.get();
    auto runner = std::make_unique<drivers::HeadRunner>(std::move(head), nullptr);
    if (runner->open(setup, kPatience) != drivers::HeadRunner::Answer::done)
      tests::must(runner->refusal() + " (the emulated head)");
    controller_.open(std::move(runner), setup);
    controller_.set_clock_driven(true);
    controller_.set_options({}, {}, kWatchdog);
    tests::must(controller_.set_limits(setup.limits, std::nullopt));
    act([&](auto& out) { controller_.resume(Time::zero(), out); });
  }
  ~SteppedLoop() { controller_.close(kPatience); }

  // Before the frame that is taken at `time`. Degrees: where the head looks, and the greater error of the pose that
  // was published.
  struct Look {
    double pan = 0, tilt = 0;
    std::optional<double> error;
  };
  Look look_at(Time time) {
    advance(time);
    Look look{head_->plant().pan(), head_->plant().tilt(), std::nullopt};
    if (!published_) return look;
    double pan = 0, tilt = 0;
    cerberus_pose_evaluate(&*published_, plugin::clock_time(time), &pan, &tilt);
    look.error = std::max(std::abs(pan - look.pan), std::abs(tilt - look.tilt));
    return look;
  }
  // The frame has been analysed. out: the pad that poses are sent from, upstream.
  void on_frame(GstBuffer* buffer, GstPad* out) {
    out_ = out;
    const Time taken = plugin::time_of(GST_BUFFER_PTS(buffer));
    advance(taken + kAnalysis);
    plugin::read_tracks(buffer, tracks_);
    const CerberusFusion* fusion = cerberus_buffer_peek_fusion(buffer);
    control::HeadController::Frame frame;
    frame.seen.emplace(tracks_, fusion ? std::optional(decision_of(*fusion)) : std::nullopt);
    frame.running = taken;
    frame.length = plugin::time_of(GST_BUFFER_DURATION(buffer));
    frame.now = now_;
    frame.lens = vision::Lens(sensing::radians(kFov), kSize);
    frame.motion = motion_of(buffer);
    taken_ = taken;
    act([&](auto& reports) { controller_.frame(frame, reports); });
  }
  bool stop() {
    return act([&](auto& out) { return controller_.stop(now_, out); });
  }
  bool follow(guint track) {
    return act([&](auto& out) { return controller_.follow(track, now_, out); });
  }

 private:
  static constexpr std::chrono::seconds kPatience{10};
  static constexpr std::chrono::milliseconds kWatchdog{500};
  // From the capture of a frame until its tracks reach the controller. derived: detection of 320x240 on a small board
  static constexpr std::chrono::milliseconds kAnalysis{20};
  static constexpr vision::Size kSize{static_cast<int>(kWindowWidth), static_cast<int>(kWindowHeight)};

  static control::FusionDecision decision_of(const CerberusFusion& fusion) {
    control::FusionDecision decision;
    decision.made.action = static_cast<fusion::Action>(fusion.action);
    decision.made.rule = fusion.rule;
    decision.made.rule_name = fusion.rule_name;
    decision.made.target = fusion.target;
    decision.made.sector = {sensing::radians(fusion.sector_from), sensing::radians(fusion.sector_to)};
    decision.decided = plugin::known_time(fusion.decided);
    return decision;
  }
  std::optional<control::PictureMotion> motion_of(GstBuffer* buffer) {
    const CerberusCameraMotion* motion = cerberus_buffer_peek_camera_motion(buffer);
    const auto step = camera_.next(plugin::path_point(buffer), plugin::clock_time(taken_), kSize);
    if (!motion || step.link != vision::CameraFollower::Link::follows || !taken_) return std::nullopt;
    return control::PictureMotion{step.motion.transform, motion->confidence, kSize, 0};
  }
  void advance(Time time) {
    for (; next_tick_ <= time; next_tick_ = std::max(next_tick_, now_ + std::chrono::milliseconds(1))) {
      now_ = std::max(now_, next_tick_);
      head_->advance(now_);
      next_tick_ = act([&](auto& out) { return controller_.tick(now_, out); });
    }
    now_ = std::max(now_, time);
    head_->advance(now_);
  }

  tests::SteppedHead* head_;
  control::NotificationQueue queue_;
  std::atomic<const char*> name_ = "head";
  control::HeadController controller_;
  std::vector<fusion::Track> tracks_;
  vision::CameraFollower camera_;
  std::optional<Time> taken_;
  Time now_{}, next_tick_{};
  std::optional<CerberusPose> published_;
  GstPad* out_ = nullptr;
};

}  // namespace cerberus::bench
