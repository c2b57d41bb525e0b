// SPDX-License-Identifier: LGPL-2.1-or-later
#include "project_law.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace cerberus::bench {

namespace {

using sensing::radians;
using std::chrono::milliseconds;

constexpr vision::Size kPicture{640, 360};
constexpr double kBaseTurn = radians(30);    // what bases are asked for at most
constexpr double kSectorHalf = radians(30);  // of what a sensor sees, as the fuser pulls it in by half a lens

Time time_of(double seconds) {
  return Time(static_cast<Time::rep>(std::llround(seconds * 1e9)));
}

void must(bool done, const char* what) {
  if (done) return;
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

drivers::HeadSetup setup_for(const sim::HeadKind& kind, const sim::PanHead& machine) {
  constexpr int kMeasured = 12;  // speeds, of a calibration
  const sim::HeadTraits& traits = kind.traits;
  drivers::HeadSetup setup;
  motion::AxisLimits& pan = setup.limits.pan;
  pan = {radians(-170), radians(170), traits.speed, traits.acceleration};
  setup.latency = time_of(kind.told_dead_time);
  if (!kind.calibrated) return setup;
  std::vector<motion::SpeedPoint> points;
  for (int k = 1; k <= kMeasured; ++k) {
    const double commanded = traits.speed * k / kMeasured;
    points.push_back({commanded, machine.true_speed(commanded)});
  }
  setup.pan_speeds = motion::SpeedMap(points);
  setup.play.pan = traits.play;
  pan.speed = machine.true_speed(traits.speed);
  return setup;
}

}  // namespace

ProjectLaw::ProjectLaw(const sim::HeadKind& kind, sim::PanHead& machine, const sim::CameraTraits& camera,
                       sim::ZoomLens* lens)
    : lens_(camera.field_of_view, kPicture),
      frame_length_(time_of(1 / camera.frames)),
      field_of_view_(camera.field_of_view) {
  pixel_turn_ = control::base_turn(vision::Transform::translation(-1, 0), lens_, kPicture, {}, {}).yaw;
  drivers::HeadSetup setup = setup_for(kind, machine);
  setup.moves_zoom = lens != nullptr;
  if (lens) must(setup.zoom_table.parse("0 60; 1 4").empty(), "the zoom's table is none");
  auto head = std::make_unique<LineHead>(kind, machine, lens, setup.zoom_table);
  head_ = head.get();
  auto runner = std::make_unique<drivers::HeadRunner>(std::move(head), nullptr);
  must(runner->open(setup, std::chrono::seconds(10)) == drivers::HeadRunner::Answer::done,
       "the simulated head does not open");
  controller_.open(std::move(runner), setup);
  controller_.set_clock_driven(true);
  control::LawOptions options;
  options.base_turn = kBaseTurn;
  controller_.set_options(options, {}, milliseconds(500));
  controller_.set_limits(setup.limits, std::nullopt);
  act([&](auto& out) { controller_.resume(Time::zero(), out); });
}

ProjectLaw::~ProjectLaw() {
  controller_.close(milliseconds(10));
}

void ProjectLaw::elapse(Time now) {
  if (now >= next_serve_) next_serve_ = head_->serve(now);
  if (now >= next_tick_) act([&](auto& out) { next_tick_ = controller_.tick(now, out); });
}

void ProjectLaw::on_picture(const Seen& seen, Time now) {
  elapse(now);
  const sim::Picture& picture = seen.picture;
  if (const double view = controller_.field_of_view(picture.taken, field_of_view_); view != field_of_view_) {
    field_of_view_ = view;
    lens_ = vision::Lens(view, kPicture);
    pixel_turn_ = control::base_turn(vision::Transform::translation(-1, 0), lens_, kPicture, {}, {}).yaw;
  }
  std::vector<fusion::Track> tracks;
  if (picture.seen) {
    fusion::Track track;
    track.id = 1;
    track.width = 40;
    track.height = seen.height > 0 ? std::min(1., seen.height) * kPicture.height : 100;
    const double focal = kPicture.width / 2. / std::tan(picture.field_of_view / 2);  // the true one
    track.x = kPicture.width / 2. + focal * std::tan(picture.off) - track.width / 2;
    track.y = kPicture.height / 2. - track.height / 2;
    track.age = std::chrono::seconds(2);
    tracks.push_back(track);
  }
  std::optional<control::FusionDecision> decision;
  if (decide_) decision.emplace().made = decide_(picture.taken, tracks);
  if (seen.sector) {
    decision.emplace();
    decision->made.action = fusion::Action::search;
    decision->made.rule_name = "sector";
    decision->made.sector = {seen.bearing - kSectorHalf, seen.bearing + kSectorHalf};
  }
  control::HeadController::Frame frame;
  frame.seen.emplace(control::Observation{tracks, decision});
  frame.running = picture.taken;
  frame.length = frame_length_;
  frame.now = now;
  frame.lens = lens_;
  frame.picture = kPicture;
  const auto moved = vision::Transform::translation(-picture.turn / pixel_turn_, 0);
  frame.motion = control::PictureMotion{moved, 1, kPicture, seen.base_turn, seen.base_reported};
  act([&](auto& out) { controller_.frame(frame, out); });
  next_serve_ = now;
}

}  // namespace cerberus::bench
