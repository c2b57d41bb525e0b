// SPDX-License-Identifier: LGPL-2.1-or-later
#include "moving_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cerberus::bench {
namespace {

using std::numbers::pi;
using vision::Transform;

constexpr double kShare = 0.75;     // of the picture's sides that the window has
constexpr double kPanSpeed = 0.25;  // window widths a second

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

void MovingView::point(double seconds) {
  // Room for the window's middle; the rest is for the shake's roll and the interpolation.
  constexpr double kRoom = 0.95;
  const double reach_x = kRoom * (picture_.width - window_.width) / 2,
               reach_y = kRoom * (picture_.height - window_.height) / 2;
  double x = 0, y = 0;  // of the window's middle from the picture's
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
      x = reach_x * std::sin(phase_), y = 0.6 * reach_y * std::sin(2.3 * seconds + phase_);
      break;
    case CameraMotion::zoom:
      x = 0.8 * reach_x * std::sin(0.6 * seconds + phase_),
      y = reach_y * std::cos(0.8 * seconds + phase_) / 2;
      scale_ = 1 + 0.25 * (0.5 - 0.5 * std::cos(2 * pi / 2.4 * seconds + phase_));
      break;
    case CameraMotion::shake:
      x = 0.017 * window_.width * std::sin(32 * seconds + phase_) +
          0.01 * window_.width * std::sin(9 * seconds);
      y = 0.017 * window_.height * std::sin(27 * seconds + 2 * phase_) +
          0.028 * window_.height * std::sin(5 * seconds);
      roll = 1.2 * pi / 180 * std::sin(12 * seconds + phase_);
      break;
  }
  const double c = scale_ * std::cos(roll), s = scale_ * std::sin(roll);
  const Transform turned{{c, s, 0, -s, c, 0, 0, 0, 1}};
  to_window_ = Transform::translation(window_.width / 2.0, window_.height / 2.0) * turned *
               Transform::translation(-picture_.width / 2.0 - x, -picture_.height / 2.0 - y);
}

vision::GrayView MovingView::see(vision::GrayView picture) {
  // Transforms of pictures count from the centre of the first pixel.
  warp_.prepare(Transform::translation(-0.5, -0.5) * to_window_ * Transform::translation(0.5, 0.5), picture_);
  warp_.bilinear(picture, seen_.view());
  const vision::GrayView all = seen_.view();
  return {all.data, window_.width, window_.height, all.stride};
}

vision::Box MovingView::see(const vision::Box& box) const {
  const vision::Point middle = to_window_.apply({box.x + box.width / 2, box.y + box.height / 2});
  const double half_x = scale_ * box.width / 2, half_y = scale_ * box.height / 2;
  const auto inside = [](double at, int side) { return std::clamp<double>(at, 0, side); };
  const double left = inside(middle.x - half_x, window_.width),
               right = inside(middle.x + half_x, window_.width),
               top = inside(middle.y - half_y, window_.height),
               bottom = inside(middle.y + half_y, window_.height);
  return {left, top, right - left, bottom - top};
}

double MovingView::visible(const vision::Box& box) const {
  return see(box).area() / (scale_ * scale_ * box.area());
}

}  // namespace cerberus::bench
