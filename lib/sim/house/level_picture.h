// SPDX-License-Identifier: LGPL-2.1-or-later
// What a level camera sees of rooms and people before it is turned, exposed and made noisy. Column after column.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/house/figure.h"
#include "sim/house/floor_plan.h"
#include "sim/house/light.h"
#include "sim/house/textures.h"

namespace cerberus::sim {

struct Eye {
  double x = 0, y = 0, height = .8, yaw = 0;  // metres, radians clockwise from x
};

// Where a level camera's pixels are: the optical axis at (middle_x, middle_y); pixels a unit of tangent.
struct LevelSize {
  int width = 0, height = 0;
  double focal = 0, middle_x = 0, middle_y = 0;
};

struct DrawnPerson {
  Body body;
  Clothes clothes;
  double x = 0, y = 0;
};

class LevelPicture {
 public:
  // Indices of tints: surfaces first, then parts of people.
  static constexpr int kTints = kSurfaces + kParts;

  explicit LevelPicture(std::uint32_t seed);
  void resize(const LevelSize& size);
  void draw_rooms(const FloorPlan& plan, const Light& light, const Eye& eye);
  // The farthest person first; after the rooms.
  void draw(const DrawnPerson& person, const FloorPlan& plan, const Light& light);

  const LevelSize& size() const { return size_; }
  const std::uint8_t* luma(int column) const { return &luma_[std::size_t(column) * size_.height]; }
  const std::uint8_t* tint(int column) const { return &tint_[std::size_t(column) * size_.height]; }
  // Along the optical axis.
  const float* depth(int column) const { return &depth_[std::size_t(column) * size_.height]; }

  // A limb as this picture shows it, in pixels.
  struct Outline {
    double ax, ay, bx, by, ra, rb;  // ends and half widths
    double near_a, near_b;          // metres: depth of the axis at each end
    double deep_a, deep_b;          // metres: half of its depth
    double cap, wide_a, wide_b, length;
    double inverse;  // of the axis' squared length in pixels; 0: it points at the camera
    // How far inside the outline a place is, in pixels, and the depth there.
    struct Place {
      double inside, along;       // inside: -1 for what is half a pixel outside or more
      double across_x, across_y;  // from the axis, of the half width
      double depth;
      double facing = 0;  // 1: the surface faces the camera, 0: it is the outline
    };
    Place at(double x, double y) const;
  };
  // False: too near to the camera or behind it.
  bool outline(const Limb& limb, const Body& body, Outline& out) const;

 private:
  struct Plane {  // level surfaces of one height, row by row
    double up = 0;
    std::vector<float> depth;
    std::vector<std::uint8_t> level;
  };
  struct Segment {
    int space;
    double enter, leave;
    int side, next;
  };

  const Plane& plane(double up);
  int row_of(double up, double depth) const;
  void draw_column(int column, const FloorPlan& plan, const Light& light);
  void draw_things(int column, const Segment& segment, const FloorPlan& plan, const Light& light);
  void draw_upright(int column, double low, double high, double depth, double along, Surface surface,
                    double light);
  void draw_level(int column, double up, double enter, double leave, Surface surface, const Light& light,
                  int space);
  void draw_limb(const Outline& limb, Part part, const Clothes& clothes, double light, int index);
  void draw_shadow(const DrawnPerson& person);

  LevelSize size_;
  Eye eye_;
  double ahead_x_ = 1, ahead_y_ = 0, ray_x_ = 1, ray_y_ = 0;
  std::vector<Texture> textures_;
  std::vector<Plane> planes_;
  std::vector<Segment> segments_;
  std::vector<std::uint8_t> luma_, tint_;
  std::vector<float> depth_;
};

}  // namespace cerberus::sim
