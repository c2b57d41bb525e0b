// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/house/house_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace cerberus::sim {
namespace {

constexpr int kFewest = 4, kMost = 6;
constexpr double kPart = 1.5;  // pixels of turning
// Where the rays of an exposure's parts go through a pixel, from its middle: else edges would move by whole pixels.
constexpr double kShifts[kMost][2] = {{-.125, -.375}, {.375, -.125}, {.125, .375},
                                      {-.375, .125},  {.25, -.25},   {-.25, .25}};
constexpr int kNoises = 1 << 15;
// U and V by tint: surfaces, then skin, hair, shirt, trousers, shoes.
constexpr std::uint8_t kTint[LevelPicture::kTints][2] = {
    {126, 130}, {118, 148}, {112, 142}, {130, 124}, {126, 130}, {128, 128}, {128, 128}, {124, 132},
    {128, 128}, {129, 127}, {114, 150}, {124, 132}, {128, 128}, {131, 126}, {126, 129}};

}  // namespace

HouseCamera::HouseCamera(FloorPlan plan, const Lens& lens, std::uint32_t seed)
    : plan_(std::move(plan)),
      light_(plan_),
      lens_(lens),
      focal_(lens.width / 2. / std::tan(lens.field_of_view / 2)),
      level_(seed),
      seed_(seed) {
  const std::size_t pixels = std::size_t(lens.width) * lens.height;
  sum_.resize(pixels), tints_.resize(pixels);
  for (int i = 0; i < kNoises; i += 2) {  // Box and Muller, 1958
    const double a = (scramble(seed, std::uint32_t(i), 7) + 1.) / 4294967297.,
                 b = scramble(seed, std::uint32_t(i), 8) / 4294967296.;
    const double r = lens.noise * std::sqrt(-2 * std::log(a));
    noise_.push_back(float(r * std::cos(2 * std::numbers::pi * b)));
    noise_.push_back(float(r * std::sin(2 * std::numbers::pi * b)));
  }
}

void HouseCamera::switch_lamp(int lamp, bool on) {
  plan_.lamps[lamp].on = on;
  light_.update(plan_);
}

int HouseCamera::parts(const Pose& begin, const Pose& end) const {
  const double turn = std::hypot(sensing::wrap(end.yaw - begin.yaw), end.pitch - begin.pitch) +
                      std::abs(end.roll - begin.roll) / 2;
  return std::clamp(int(std::ceil(turn * focal_ / kPart)), kFewest, kMost);
}

// Large enough for all four corners of the turned picture.
LevelSize HouseCamera::level_size(const Turned& turned) const {
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (const int corner : {0, 1, 2, 3}) {
    const double x = (corner & 1 ? .5 : -.5) * lens_.width, y = (corner & 2 ? .5 : -.5) * lens_.height;
    const double across = x * turned.cos_roll - y * turned.sin_roll,
                 down = x * turned.sin_roll + y * turned.cos_roll;
    const double ahead = std::max(down * turned.sin_pitch + focal_ * turned.cos_pitch, focal_ / 8);
    const double u = across / ahead * focal_,
                 v = (down * turned.cos_pitch - focal_ * turned.sin_pitch) / ahead * focal_;
    left = std::min(left, u), right = std::max(right, u), top = std::min(top, v),
    bottom = std::max(bottom, v);
  }
  const double half = std::ceil(std::max(-left, right)) + 2, above = std::ceil(-top) + 2;
  return {int(2 * half), int(std::ceil(bottom) + 2 + above), focal_, half, above};
}

void HouseCamera::expose(const Pose& pose, std::span<const Subject> people) {
  const Turned turned{std::cos(pose.roll), std::sin(pose.roll), std::cos(pose.pitch), std::sin(pose.pitch)};
  LevelSize size = level_size(turned);
  const double* shift = kShifts[exposed_ % kMost];
  size.middle_x -= shift[0], size.middle_y -= shift[1];
  if (const LevelSize& now = level_.size(); size.width != now.width || size.height != now.height ||
                                            size.middle_x != now.middle_x || size.middle_y != now.middle_y)
    level_.resize(size);
  level_.draw_rooms(plan_, light_, {pose.x, pose.y, pose.height, pose.yaw});
  drawn_.resize(people.size());
  order_.resize(people.size());
  std::iota(order_.begin(), order_.end(), 0);
  const auto away = [&](int i) {
    return std::hypot(people[i].stance->x - pose.x, people[i].stance->y - pose.y);
  };
  std::ranges::stable_sort(order_, std::greater<>(), away);
  for (const int i : order_) {
    const Subject& person = people[i];
    drawn_[i] = {body_of(*person.stance, person.height), *person.clothes, person.stance->x, person.stance->y};
    level_.draw(drawn_[i], plan_, light_);
  }
  add_up(turned, size.middle_x + shift[0], size.middle_y + shift[1]);
  ++exposed_;
  turned_ = turned, pose_ = pose;
  stances_.clear();
  for (const Subject& person : people) stances_.push_back(*person.stance);
}

void HouseCamera::add_up(const Turned& turned, double middle_x, double middle_y) {
  const LevelSize& size = level_.size();
  const int high = size.height;
  const std::uint8_t *luma = level_.luma(0), *tint = level_.tint(0);
  const bool level = turned.sin_roll == 0 && turned.sin_pitch == 0;
  for (int row = 0; row < lens_.height; ++row)
    for (int column = 0; column < lens_.width; ++column) {
      const double x = column + .5 - lens_.width / 2., y = row + .5 - lens_.height / 2.;
      double u = x, v = y;
      if (!level) {
        const double down = x * turned.sin_roll + y * turned.cos_roll;
        const double scale =
            focal_ / std::max(down * turned.sin_pitch + focal_ * turned.cos_pitch, focal_ / 8);
        u = (x * turned.cos_roll - y * turned.sin_roll) * scale;
        v = (down * turned.cos_pitch - focal_ * turned.sin_pitch) * scale;
      }
      u += middle_x - .5, v += middle_y - .5;
      const int i = std::clamp(int(u), 0, size.width - 2), j = std::clamp(int(v), 0, high - 2);
      const int a = std::clamp(int((u - i) * 16), 0, 16), b = std::clamp(int((v - j) * 16), 0, 16);
      const std::uint8_t* p = luma + std::size_t(i) * high + j;
      const int near = (p[0] * (16 - b) + p[1] * b) * (16 - a) + (p[high] * (16 - b) + p[high + 1] * b) * a;
      const std::size_t pixel = std::size_t(row) * lens_.width + column;
      sum_[pixel] = std::uint16_t(sum_[pixel] + (near >> 4));
      tints_[pixel] = tint[std::size_t(i) * high + j];
    }
}

void HouseCamera::develop(std::vector<std::uint8_t>& i420) {
  const int width = lens_.width, height = lens_.height;
  const std::size_t pixels = std::size_t(width) * height;
  i420.resize(pixels * 3 / 2);
  const float scale = 1.F / float(16 * std::max(1, exposed_));
  for (int row = 0; row < height; ++row) {
    std::uint32_t at = scramble(seed_, pictures_, std::uint32_t(row));
    for (int column = 0; column < width; ++column) {
      const std::size_t pixel = std::size_t(row) * width + column;
      at = at * 1664525U + 1013904223U;
      const float value = float(sum_[pixel]) * scale + noise_[at >> 17];
      i420[pixel] = std::uint8_t(std::clamp(value + .5F, 0.F, 255.F));
    }
  }
  std::uint8_t *u = &i420[pixels], *v = u + pixels / 4;
  for (int row = 0; row < height; row += 2)
    for (int column = 0; column < width; column += 2) {
      int sum_u = 2, sum_v = 2;
      for (const int offset : {0, 1, width, width + 1}) {
        const std::uint8_t* tint = kTint[tints_[std::size_t(row) * width + column + offset]];
        sum_u += tint[0], sum_v += tint[1];
      }
      *u++ = std::uint8_t(sum_u / 4), *v++ = std::uint8_t(sum_v / 4);
    }
  note();
  std::ranges::fill(sum_, std::uint16_t(0));
  exposed_ = 0;
  ++pictures_;
}

// From the level picture to the picture.
HouseCamera::Place HouseCamera::back(double u, double v) const {
  u -= level_.size().middle_x, v -= level_.size().middle_y;
  const double down = v * turned_.cos_pitch + focal_ * turned_.sin_pitch;
  const double ahead = -v * turned_.sin_pitch + focal_ * turned_.cos_pitch;
  const double scale = focal_ / std::max(ahead, 1e-3);
  return {(u * turned_.cos_roll + down * turned_.sin_roll) * scale + lens_.width / 2.,
          (-u * turned_.sin_roll + down * turned_.cos_roll) * scale + lens_.height / 2.};
}

PersonTruth HouseCamera::truth_of(const Body& body) const {
  std::array<LevelPicture::Outline, kLimbs> limbs;
  std::size_t count = 0;
  Bounds picture, level;
  for (const Limb& limb : body.limbs) {
    LevelPicture::Outline& o = limbs[count];
    if (!level_.outline(limb, body, o)) continue;
    ++count;
    for (const auto& [u, v, r] : {std::array{o.ax, o.ay, o.ra}, std::array{o.bx, o.by, o.rb}})
      for (const auto& [x, y] : {std::pair{-r, 0.}, {r, 0.}, {0., -r * o.cap}, {0., r * o.cap}}) {
        level.include({u + x, v + y});
        picture.include(back(u + x, v + y));
      }
  }
  PersonTruth truth;
  if (count == 0) return truth;
  truth.left = picture.left, truth.top = picture.top;
  truth.width = picture.right - picture.left, truth.height = picture.bottom - picture.top;
  truth.visible = visible_share({limbs.data(), count}, level);
  return truth;
}

// Of a grid of samples over the person.
double HouseCamera::visible_share(std::span<const LevelPicture::Outline> limbs, const Bounds& area) const {
  constexpr int kSamples = 48;    // a side
  constexpr double kBeside = .1;  // metres: the sample is beside its pixel's middle, on a limb that is round
  const LevelSize& size = level_.size();
  int all = 0, seen = 0;
  for (int i = 0; i < kSamples * kSamples; ++i) {
    const double u = area.left + (i % kSamples + .5) / kSamples * (area.right - area.left);
    const double v = area.top + (i / kSamples + .5) / kSamples * (area.bottom - area.top);
    double nearest = 1e9;
    for (const LevelPicture::Outline& limb : limbs)
      if (const auto place = limb.at(u, v); place.inside > 0) nearest = std::min(nearest, place.depth);
    if (nearest == 1e9) continue;
    ++all;
    const Place in = back(u, v);
    const bool inside = in.x >= 0 && in.y >= 0 && in.x < lens_.width && in.y < lens_.height && u >= 0 &&
                        v >= 0 && u < size.width && v < size.height;
    if (inside && nearest < level_.depth(int(u))[int(v)] + kBeside) ++seen;
  }
  return all == 0 ? 0 : double(seen) / all;
}

void HouseCamera::note() {
  truth_.clear();
  for (std::size_t i = 0; i < stances_.size(); ++i) {
    PersonTruth truth = truth_of(drawn_[i].body);
    const double x = stances_[i].x - pose_.x, y = stances_[i].y - pose_.y;
    truth.bearing = sensing::wrap(std::atan2(y, x) - pose_.yaw);
    truth.distance = std::hypot(x, y);
    truth.speed = stances_[i].speed;
    truth_.push_back(truth);
  }
}

}  // namespace cerberus::sim
