// SPDX-License-Identifier: LGPL-2.1-or-later
#include "moving_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cerberus::bench {
namespace {

using std::numbers::pi;
using vision::Transform;

constexpr double kShare = 0.75;  // of the scene's sides that the window has
// Of the way from the middle to the scene's edge that the window's middle goes at most; the rest is for roll and sampling.
constexpr double kRoom = 0.95;

// A swing: amplitude and rad/s. By hand: speeds of pan-tilt heads and of a robot's body.
struct Swing {
  double amplitude, speed;
  double at(double seconds, double phase) const { return amplitude * std::sin(speed * seconds + phase); }
};
constexpr double kPanSpeed = 0.25;                           // window widths a second
constexpr Swing kTilt{0.6, 2.3};                             // of the way to the edge
constexpr Swing kZoomPathX{0.8, 0.6}, kZoomPathY{0.5, 0.8};  // the same
constexpr double kZoomIn = 0.25, kZoomPeriod = 2.4;          // beyond 1; s
constexpr Swing kShakeX[]{{0.017, 32}, {0.01, 9}};           // of the window's width
constexpr Swing kShakeY[]{{0.017, 27}, {0.028, 5}};          // of its height
constexpr Swing kRoll{1.2, 12};                              // degrees

// From -1 to 1 and back with a constant speed; period 4.
double to_and_fro(double way) {
  const double at = std::fmod(way, 4);
  return at < 2 ? at - 1 : 3 - at;
}

}  // namespace

MovingView::MovingView(CameraMotion motion, double phase, vision::Size picture)
    : motion_(motion),
      phase_(2 * pi * phase),
      picture_(picture),
      window_{static_cast<int>(kShare * picture.width), static_cast<int>(kShare * picture.height)},
      seen_(picture) {}

void MovingView::set_time(double seconds) {
  const double reach_x = kRoom * (picture_.width - window_.width) / 2,
               reach_y = kRoom * (picture_.height - window_.height) / 2;
  double x = 0, y = 0;  // of the window's middle from the scene's
  double roll = 0;      // radians
  scale_ = 1;
  switch (motion_) {
    case CameraMotion::rest:
      x = reach_x * std::sin(phase_), y = reach_y * std::cos(phase_) / 2;
      break;
    case CameraMotion::pan:
      x = reach_x * to_and_fro(kPanSpeed * window_.width * seconds / reach_x + 2 * phase_ / pi);
      y = reach_y * std::cos(phase_) / 2;
      break;
    case CameraMotion::tilt:
      x = reach_x * std::sin(phase_), y = reach_y * kTilt.at(seconds, phase_);
      break;
    case CameraMotion::zoom:
      x = reach_x * kZoomPathX.at(seconds, phase_), y = reach_y * kZoomPathY.at(seconds, phase_ + pi / 2);
      scale_ = 1 + kZoomIn * (0.5 - 0.5 * std::cos(2 * pi / kZoomPeriod * seconds + phase_));
      break;
    case CameraMotion::shake:
      x = window_.width * (kShakeX[0].at(seconds, phase_) + kShakeX[1].at(seconds, 0));
      y = window_.height * (kShakeY[0].at(seconds, 2 * phase_) + kShakeY[1].at(seconds, 0));
      roll = pi / 180 * kRoll.at(seconds, phase_);
      break;
  }
  const double c = scale_ * std::cos(roll), s = scale_ * std::sin(roll);
  const Transform turned{{c, s, 0, -s, c, 0, 0, 0, 1}};
  to_window_ = Transform::translation(window_.width / 2.0, window_.height / 2.0) * turned *
               Transform::translation(-picture_.width / 2.0 - x, -picture_.height / 2.0 - y);
}

vision::GrayView MovingView::render(vision::GrayView picture) {
  // Transforms of pictures count from the centre of the first pixel.
  warp_.prepare(Transform::translation(-0.5, -0.5) * to_window_ * Transform::translation(0.5, 0.5), picture_);
  warp_.bilinear(picture, seen_.view());
  const vision::GrayView all = seen_.view();
  return {all.data, window_.width, window_.height, all.stride};
}

vision::Box MovingView::to_window(const vision::Box& box) const {
  const vision::Point middle = to_window_.apply({box.x + box.width / 2, box.y + box.height / 2});
  const double half_x = scale_ * box.width / 2, half_y = scale_ * box.height / 2;
  const auto inside = [](double at, int side) { return std::clamp<double>(at, 0, side); };
  const double left = inside(middle.x - half_x, window_.width),
               right = inside(middle.x + half_x, window_.width),
               top = inside(middle.y - half_y, window_.height),
               bottom = inside(middle.y + half_y, window_.height);
  return {left, top, right - left, bottom - top};
}

double MovingView::visible_share(const vision::Box& box) const {
  return to_window(box).area() / (scale_ * scale_ * box.area());
}

}  // namespace cerberus::bench
