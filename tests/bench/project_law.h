// SPDX-License-Identifier: LGPL-2.1-or-later
// This project's law as pantiltsink runs it: HeadController before a head behind the line protocol.
#pragma once

#include <atomic>
#include <functional>
#include <span>

#include "closed_loop.h"
#include "control/head_controller.h"
#include "line_head.h"

namespace cerberus::bench {

class ProjectLaw final : public FollowingLaw {
 public:
  // lens: of a camera with a zoom, which keeps the person's size.
  ProjectLaw(const sim::HeadKind& kind, sim::PanHead& machine, const sim::CameraTraits& camera,
             sim::ZoomLens* lens = nullptr);
  ~ProjectLaw() override;
  void on_picture(const Seen& seen, Time now) override;
  void elapse(Time now) override;
  double look(Time time) override { return published_.at(time).pan.position; }
  double asks_base() override { return asks_base_; }
  // What sensor fusion decides for the tracks of a picture that was taken at a time.
  using Decide = std::function<fusion::Decision(Time taken, std::span<const fusion::Track>)>;
  void decide_with(Decide decide) { decide_ = std::move(decide); }

 private:
  template <typename F>
  void act(F f) {
    control::DeferredNotifications out(queue_, name_);
    f(out);
    out.send([this](const char*, const motion::Pose& pose) { published_.add(pose); },
             [this](const char*, const control::Notice& notice) {
               if (const auto* request = std::get_if<control::BaseTurnRequest>(&notice))
                 asks_base_ = request->yaw_rate;
             });
  }

  vision::Lens lens_;
  Time frame_length_;
  double pixel_turn_;  // radians: the mean turn of a picture that moves by a pixel
  LineHead* head_ = nullptr;
  control::NotificationQueue queue_;
  std::atomic<const char*> name_{"head"};
  control::HeadController controller_;
  motion::PoseHistory published_;
  Time next_tick_{}, next_serve_{};
  double field_of_view_;  // where the head's zoom says nothing
  double asks_base_ = 0;
  Decide decide_;
};

}  // namespace cerberus::bench
