// SPDX-License-Identifier: LGPL-2.1-or-later
// Column by column: a ray in the plan goes from space to space through the openings; what it met is painted from the far
// end to the near one. Along a ray that is 1 long on the optical axis, its parameter is the depth, and a height h above the
// eye at depth t is h focal / t pixels above the axis: walls and floors are exact.
#include "sim/house/level_picture.h"

#include <algorithm>
#include <cmath>

namespace cerberus::sim {
namespace {

constexpr double kNear = .05;                             // metres: nothing nearer is drawn
constexpr double kNearPerson = .2;                        // metres
constexpr float kEndless = 1e6F;                          // metres
constexpr int kFarthest = 24;                             // spaces along one ray
constexpr double kWallShade[] = {1.12, 1.2, 1.16, 1.06};  // by Opening::Side, as if lit from a window

std::uint8_t grey(double value) {
  return std::uint8_t(std::clamp(value, 0., 255.));
}

// Where a ray from (x, y) along (a, b) crosses a rectangle: parameters of entry and exit; empty if enter > leave.
struct Crossing {
  double enter = -1e9, leave = 1e9;
  int side_in = 0, side_out = 0;  // Opening::Side
};
Crossing cross(const Rectangle& area, double x, double y, double a, double b) {
  Crossing c;
  const auto slab = [&](double low, double high, double at, double step, int side_low, int side_high) {
    if (std::abs(step) < 1e-12) {
      if (at < low || at > high) c.leave = -1e9;
      return;
    }
    double first = (low - at) / step, second = (high - at) / step;
    int in = side_low, out = side_high;
    if (first > second) std::swap(first, second), std::swap(in, out);
    if (first > c.enter) c.enter = first, c.side_in = in;
    if (second < c.leave) c.leave = second, c.side_out = out;
  };
  slab(area.left, area.right, x, a, Opening::left, Opening::right);
  slab(area.top, area.bottom, y, b, Opening::top, Opening::bottom);
  return c;
}

}  // namespace

LevelPicture::LevelPicture(std::uint32_t seed) {
  for (int i = 0; i < kSurfaces; ++i) textures_.emplace_back(Surface(i), scramble(seed, std::uint32_t(i)));
}

void LevelPicture::resize(const LevelSize& size) {
  size_ = size;
  const std::size_t pixels = std::size_t(size.width) * size.height;
  luma_.assign(pixels, 0), tint_.assign(pixels, 0), depth_.assign(pixels, 0);
  planes_.clear();
}

const LevelPicture::Plane& LevelPicture::plane(double up) {
  for (const Plane& plane : planes_)
    if (plane.up == up) return plane;
  Plane made{up, std::vector<float>(size_.height), std::vector<std::uint8_t>(size_.height)};
  const double over = up - eye_.height;
  for (int row = 0; row < size_.height; ++row) {
    const double rise = size_.middle_y - (row + .5);
    const double depth = over * rise > 0 ? over * size_.focal / rise : kEndless;
    made.depth[row] = float(depth);
    // The pixel is depth / focal wide and longer by depth / |over|. At the mean of both, boards across the view flicker.
    const double longer = std::max(1., depth / std::abs(over));
    made.level[row] = std::uint8_t(Texture::level_of(depth / size_.focal * longer));
  }
  planes_.push_back(std::move(made));
  return planes_.back();
}

// The first row whose middle is not above the height.
int LevelPicture::row_of(double up, double depth) const {
  const double y = size_.middle_y - (up - eye_.height) * size_.focal / depth;
  return int(std::clamp(std::ceil(y - .5), 0., double(size_.height)));
}

void LevelPicture::draw_rooms(const FloorPlan& plan, const Light& light, const Eye& eye) {
  if (eye.height != eye_.height) planes_.clear();
  eye_ = eye;
  ahead_x_ = std::cos(eye.yaw), ahead_y_ = std::sin(eye.yaw);
  planes_.reserve(64);
  for (int column = 0; column < size_.width; ++column) {
    const double right = (column + .5 - size_.middle_x) / size_.focal;
    ray_x_ = ahead_x_ - right * ahead_y_, ray_y_ = ahead_y_ + right * ahead_x_;
    draw_column(column, plan, light);
  }
}

void LevelPicture::draw_column(int column, const FloorPlan& plan, const Light& light) {
  segments_.clear();
  int space = plan.space_at(eye_.x, eye_.y);
  double enter = kNear;
  for (int n = 0; space >= 0 && n < kFarthest; ++n) {
    const Crossing c = cross(plan.spaces[space].area, eye_.x, eye_.y, ray_x_, ray_y_);
    const bool upright = c.side_out == Opening::left || c.side_out == Opening::right;
    const double along = upright ? eye_.y + c.leave * ray_y_ : eye_.x + c.leave * ray_x_;
    int next = -1;
    for (const Opening& opening : plan.spaces[space].openings)
      if (opening.side == c.side_out && along > opening.from && along < opening.to) next = opening.space;
    const double leave = std::max(c.leave, enter);
    segments_.push_back({space, enter, leave, c.side_out, next});
    space = next, enter = leave;
  }
  if (segments_.empty() || space >= 0) {  // outside all rooms, or the ray does not end
    const std::size_t first = std::size_t(column) * size_.height;
    std::fill(&luma_[first], &luma_[first] + size_.height, std::uint8_t(0));
    std::fill(&depth_[first], &depth_[first] + size_.height, kEndless);
  }
  for (std::size_t n = segments_.size(); n-- > 0;) {
    const Segment& s = segments_[n];
    const Space& here = plan.spaces[s.space];
    const double x = eye_.x + s.leave * ray_x_, y = eye_.y + s.leave * ray_y_;
    const double low = s.next < 0 ? 0 : plan.spaces[s.next].height;
    if (low < here.height) {
      const bool upright = s.side == Opening::left || s.side == Opening::right;
      draw_upright(column, low, here.height, s.leave, upright ? y : x, here.wall,
                   kWallShade[s.side] * light.at(s.space, x, y));
    }
    draw_level(column, 0, s.enter, s.leave, here.floor, light, s.space);
    draw_level(column, here.height, s.enter, s.leave, here.ceiling, light, s.space);
    draw_things(column, s, plan, light);
  }
}

void LevelPicture::draw_things(int column, const Segment& segment, const FloorPlan& plan,
                               const Light& light) {
  const Space& space = plan.spaces[segment.space];
  if (space.boxes.empty() && space.pillars.empty()) return;
  struct Thing {
    double enter, leave;
    const Furniture* box;
    const Pillar* pillar;
    int side;
  };
  std::array<Thing, 16> things;
  std::size_t count = 0;
  for (const int index : space.boxes) {
    const Furniture& box = plan.boxes[index];
    const Crossing c = cross(box.area, eye_.x, eye_.y, ray_x_, ray_y_);
    if (c.enter < c.leave && c.enter > kNear && count < things.size())
      things[count++] = {c.enter, c.leave, &box, nullptr, c.side_in};
  }
  for (const int index : space.pillars) {
    const Pillar& pillar = plan.pillars[index];
    const double x = pillar.x - eye_.x, y = pillar.y - eye_.y;
    const double length = ray_x_ * ray_x_ + ray_y_ * ray_y_, middle = (x * ray_x_ + y * ray_y_) / length;
    const double square = pillar.radius * pillar.radius / length - (x * x + y * y) / length + middle * middle;
    if (square <= 0 || middle - std::sqrt(square) <= kNear || count == things.size()) continue;
    things[count++] = {middle - std::sqrt(square), middle, nullptr, &pillar, 0};
  }
  std::sort(things.begin(), things.begin() + count,
            [](const Thing& a, const Thing& b) { return a.enter > b.enter; });
  for (std::size_t i = 0; i < count; ++i) {
    const Thing& thing = things[i];
    const double x = eye_.x + thing.enter * ray_x_, y = eye_.y + thing.enter * ray_y_;
    const double bright = light.at(segment.space, x, y);
    if (thing.box) {
      const Furniture& box = *thing.box;
      if (box.height < eye_.height)
        draw_level(column, box.height, thing.enter, thing.leave, box.top, light, segment.space);
      if (box.from > eye_.height)
        draw_level(column, box.from, thing.enter, thing.leave, box.top, light, segment.space);
      const bool upright = thing.side == Opening::left || thing.side == Opening::right;
      draw_upright(column, box.from, box.height, thing.enter, upright ? y : x, box.side,
                   kWallShade[thing.side] * bright);
    } else {
      const Pillar& pillar = *thing.pillar;
      const double around = std::atan2(y - pillar.y, x - pillar.x);
      // Darker where it turns away from the camera.
      const double facing = -((x - pillar.x) * ahead_x_ + (y - pillar.y) * ahead_y_) / pillar.radius;
      draw_upright(column, 0, space.height, thing.enter, around * pillar.radius, pillar.wall,
                   bright * (.6 + .4 * std::max(0., facing)));
    }
  }
}

void LevelPicture::draw_upright(int column, double low, double high, double depth, double along,
                                Surface surface, double light) {
  const int begin = row_of(high, depth), end = row_of(low, depth);
  if (begin >= end) return;
  const Texture& texture = textures_[int(surface)];
  const int level = Texture::level_of(depth / size_.focal), u = int(std::floor(along * Texture::kTexels));
  const double texels = depth / size_.focal * Texture::kTexels;
  double v =
      ((begin + .5 - size_.middle_y) * depth / size_.focal - eye_.height + 16 * 2.56) * Texture::kTexels;
  const std::size_t first = std::size_t(column) * size_.height;
  // A wall is a little brighter towards the lamps.
  const double from_floor = eye_.height - (begin + .5 - size_.middle_y) * depth / size_.focal;
  float bright = float(light * (.84 + .09 * from_floor));
  const float less = float(light * .09 * depth / size_.focal);
  for (int row = begin; row < end; ++row, v += texels, bright -= less)
    luma_[first + row] = std::uint8_t(std::min(255.F, float(texture.at(level, u, int(v))) * bright));
  std::fill(&tint_[first + begin], &tint_[first + end - 1] + 1, std::uint8_t(surface));
  std::fill(&depth_[first + begin], &depth_[first + end - 1] + 1, float(depth));
}

void LevelPicture::draw_level(int column, double up, double enter, double leave, Surface surface,
                              const Light& light, int space) {
  int begin = row_of(up, enter), end = row_of(up, leave);
  if (begin > end) std::swap(begin, end);
  if (begin == end) return;
  const Plane& rows = plane(up);
  const Texture& texture = textures_[int(surface)];
  const std::size_t first = std::size_t(column) * size_.height;
  constexpr double kAway = 160 * 2.56;  // metres: whole periods, so that truncation is downwards
  for (int row = begin; row < end; ++row) {
    const double x = eye_.x + rows.depth[row] * ray_x_, y = eye_.y + rows.depth[row] * ray_y_;
    const int u = int((x + kAway) * Texture::kTexels), v = int((y + kAway) * Texture::kTexels);
    luma_[first + row] =
        std::uint8_t(std::min(255., texture.at(rows.level[row], u, v) * light.at(space, x, y)));
    tint_[first + row] = std::uint8_t(surface);
    depth_[first + row] = rows.depth[row];
  }
}

bool LevelPicture::outline(const Limb& limb, const Body& body, Outline& out) const {
  const auto place = [&](const Point& p, double& x, double& y) {
    const double east = p.x - eye_.x, south = p.y - eye_.y;
    const double depth = east * ahead_x_ + south * ahead_y_, right = south * ahead_x_ - east * ahead_y_;
    if (depth < kNearPerson) return 0.;
    x = size_.middle_x + right * size_.focal / depth;
    y = size_.middle_y - (p.z - eye_.height) * size_.focal / depth;
    return depth;
  };
  out.near_a = place(limb.from, out.ax, out.ay);
  out.near_b = place(limb.to, out.bx, out.by);
  if (out.near_a == 0 || out.near_b == 0) return false;
  // A cross section that is an ellipse, from aside.
  const double across = std::abs(body.sideways_y * ahead_x_ - body.sideways_x * ahead_y_);
  const double square = across * across, flat = limb.flat * limb.flat;
  const double wide = std::sqrt(square + flat * (1 - square)), deep = std::sqrt(1 - square + flat * square);
  out.wide_a = limb.wide_from * wide, out.wide_b = limb.wide_to * wide;
  out.deep_a = limb.wide_from * deep, out.deep_b = limb.wide_to * deep;
  out.ra = out.wide_a * size_.focal / out.near_a, out.rb = out.wide_b * size_.focal / out.near_b;
  out.cap = limb.cap;
  const double square_length = (out.bx - out.ax) * (out.bx - out.ax) + (out.by - out.ay) * (out.by - out.ay);
  out.inverse = square_length > 1e-9 ? 1 / square_length : 0;
  out.length = std::hypot(limb.to.x - limb.from.x, limb.to.y - limb.from.y, limb.to.z - limb.from.z);
  return true;
}

LevelPicture::Outline::Place LevelPicture::Outline::at(double x, double y) const {
  const double lx = bx - ax, ly = by - ay, px = x - ax, py = y - ay;
  const double t = (px * lx + py * ly) * inverse, along = std::clamp(t, 0., 1.);
  const double radius = ra + along * (rb - ra);
  double dx = px - along * lx, dy = py - along * ly;
  if (t != along && cap != 1) {  // beyond an end: only along the axis
    const double beyond = t - along, more = beyond / cap - beyond;
    dx += more * lx, dy += more * ly;
  }
  Place place{-1, along, 0, 0, 0};
  const double square = dx * dx + dy * dy;
  if (square >= (radius + .5) * (radius + .5)) return place;
  const double share = 1 / radius;
  place.across_x = dx * share, place.across_y = dy * share;
  place.inside = radius - std::sqrt(square);
  place.facing = std::sqrt(std::max(0., 1 - square * share * share));
  place.depth = near_a + along * (near_b - near_a) - (deep_a + along * (deep_b - deep_a)) * place.facing;
  return place;
}

void LevelPicture::draw(const DrawnPerson& person, const FloorPlan& plan, const Light& light) {
  draw_shadow(person);
  const int space = plan.space_at(person.x, person.y);
  const double bright = space < 0 ? 1 : light.at(space, person.x, person.y);
  struct Drawn {
    Outline outline;
    Part part;
    int index;
  };
  std::array<Drawn, kLimbs> drawn;
  std::size_t count = 0;
  for (int i = 0; i < kLimbs; ++i) {
    const Limb& limb = person.body.limbs[i];
    if (outline(limb, person.body, drawn[count].outline))
      drawn[count].part = limb.part, drawn[count].index = i, ++count;
  }
  std::stable_sort(drawn.begin(), drawn.begin() + count, [](const Drawn& a, const Drawn& b) {
    return a.outline.near_a + a.outline.near_b > b.outline.near_a + b.outline.near_b;
  });
  for (std::size_t i = 0; i < count; ++i)
    draw_limb(drawn[i].outline, drawn[i].part, person.clothes, bright, drawn[i].index);
}

void LevelPicture::draw_limb(const Outline& limb, Part part, const Clothes& clothes, double light,
                             int index) {
  const double r = std::max(limb.ra, limb.rb) + 1;
  const int left = int(std::clamp(std::floor(std::min(limb.ax, limb.bx) - r), 0., double(size_.width)));
  const int right = int(std::clamp(std::ceil(std::max(limb.ax, limb.bx) + r), 0., double(size_.width)));
  const int top = int(std::clamp(std::floor(std::min(limb.ay, limb.by) - r), 0., double(size_.height)));
  const int bottom = int(std::clamp(std::ceil(std::max(limb.ay, limb.by) + r), 0., double(size_.height)));
  const double albedo = clothes.grey[int(part)], pattern = clothes.pattern[int(part)] / 64;
  const Texture& cloth = textures_[int(Surface::cloth)];
  const int level = Texture::level_of(std::min(limb.near_a, limb.near_b) / size_.focal);
  const int shift = int(scramble(clothes.seed, std::uint32_t(index)) & 255);
  for (int column = left; column < right; ++column) {
    const std::size_t first = std::size_t(column) * size_.height;
    for (int row = top; row < bottom; ++row) {
      const Outline::Place place = limb.at(column + .5, row + .5);
      if (place.inside <= -.5 || place.depth >= depth_[first + row]) continue;
      const double cover = std::min(1., place.inside + .5);
      // Lit from above and a little from the left; darker at the outline, as what is round is.
      const double shade = .56 + .26 * place.facing - .14 * place.across_y - .10 * place.across_x;
      const double wide = limb.wide_a + place.along * (limb.wide_b - limb.wide_a);
      const int u = int((place.across_x * wide + 1) * 130) + shift;
      const int v = int((place.along * limb.length) * 130) + shift;
      double value = albedo * (1 + pattern * (cloth.at(level, u, v) - 128.));
      if (part == Part::shirt && clothes.stripes > 0 && (v - shift) % 16 < 6) value += clothes.stripes;
      value *= shade * 1.25 * light;
      std::uint8_t& pixel = luma_[first + row];
      pixel = grey(pixel + cover * (value - pixel));
      if (cover < .5) continue;
      tint_[first + row] = std::uint8_t(kSurfaces + int(part));
      depth_[first + row] = float(place.depth);
    }
  }
}

// Soft, on the floor below a person.
void LevelPicture::draw_shadow(const DrawnPerson& person) {
  constexpr double kRadius = .55, kDark = .5, kSoft = .22;  // metres; share; metres
  const double east = person.x - eye_.x, south = person.y - eye_.y;
  const double depth = east * ahead_x_ + south * ahead_y_, right = south * ahead_x_ - east * ahead_y_;
  if (depth < kNearPerson + kRadius) return;
  const Plane& floor = plane(0);
  const double near = depth - kRadius;
  const int begin = row_of(0, depth + kRadius), end = row_of(0, near);
  const int from =
      int(std::clamp(size_.middle_x + (right - kRadius) * size_.focal / near, 0., double(size_.width)));
  const int to =
      int(std::clamp(size_.middle_x + (right + kRadius) * size_.focal / near, 0., double(size_.width)));
  for (int column = from; column < to; ++column) {
    const std::size_t first = std::size_t(column) * size_.height;
    const double aside = (column + .5 - size_.middle_x) / size_.focal;
    for (int row = begin; row < end; ++row) {
      const double t = floor.depth[row];
      if (depth_[first + row] != floor.depth[row]) continue;
      const double a = t * aside - right, b = t - depth, square = (a * a + b * b) / (kSoft * kSoft);
      luma_[first + row] = grey(luma_[first + row] * (1 - kDark * std::exp(-square / 2)));
    }
  }
}

}  // namespace cerberus::sim
