// SPDX-License-Identifier: LGPL-2.1-or-later
// A camera in a house: pictures as a sensor gives them, and the truth about the people in them. A picture is the mean of
// its exposure's parts, each a moment of its own, so that what moves is blurred.
//
//   for (int i = 0, n = camera.parts(at begin, at end); i < n; ++i) camera.expose(pose, people);   moments of the exposure
//   camera.develop(i420);
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "sensing/angles.h"
#include "sim/house/level_picture.h"

namespace cerberus::sim {

struct Pose {
  double x = 0, y = 0, height = .8;     // metres
  double yaw = 0, pitch = 0, roll = 0;  // radians: to the right, up, clockwise
};

struct Lens {
  int width = 320, height = 240;
  double field_of_view = sensing::radians(60);  // over the width
  double noise = 2;                             // standard deviation, grey levels
};

struct PersonTruth {
  double left = 0, top = 0, width = 0, height = 0;  // pixels, of the whole person, inside the picture or not
  double visible = 0;   // share of the person that is in the picture and not hidden
  double bearing = 0;   // radians, from the optical axis' yaw
  double distance = 0;  // metres, in the plan
  double speed = 0;     // metres a second
};

class HouseCamera {
 public:
  struct Subject {
    const Stance* stance;
    const Clothes* clothes;
    double height;
  };
  HouseCamera(FloorPlan plan, const Lens& lens, std::uint32_t seed);

  // A part a pixel and a half of turning, 2 to 6.
  int parts(const Pose& begin, const Pose& end) const;
  void expose(const Pose& pose, std::span<const Subject> people);
  // Y, U and V planes without padding; width and height are even. Afterwards the next exposure begins.
  void develop(std::vector<std::uint8_t>& i420);
  // Of the last part of the exposure, in the order of `people`.
  const std::vector<PersonTruth>& truth() const { return truth_; }
  void switch_lamp(int lamp, bool on);
  const FloorPlan& plan() const { return plan_; }

 private:
  struct Turned {  // from the picture's pixels to the level picture's
    double cos_roll, sin_roll, cos_pitch, sin_pitch;
  };
  LevelSize level_size(const Turned& turned) const;
  void add_up(const Turned& turned, double middle_x, double middle_y);
  struct Place {
    double x, y;
  };
  struct Bounds {
    double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
    void include(const Place& place) {
      left = std::min(left, place.x), right = std::max(right, place.x);
      top = std::min(top, place.y), bottom = std::max(bottom, place.y);
    }
  };
  Place back(double u, double v) const;
  PersonTruth truth_of(const Body& body) const;
  double visible_share(std::span<const LevelPicture::Outline> limbs, const Bounds& area) const;
  void note();

  FloorPlan plan_;
  Light light_;
  Lens lens_;
  double focal_;
  LevelPicture level_;
  std::uint32_t seed_, pictures_ = 0;
  int exposed_ = 0;
  std::vector<std::uint16_t> sum_;  // luma in 1/16, of up to 16 parts
  std::vector<std::uint8_t> tints_;
  Turned turned_{1, 0, 1, 0};  // of the last part, as all below
  Pose pose_;
  std::vector<Stance> stances_;
  std::vector<DrawnPerson> drawn_;
  std::vector<int> order_;
  std::vector<PersonTruth> truth_;
  std::vector<float> noise_;
};

}  // namespace cerberus::sim
