// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/marks/outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cerberus::overlay {

namespace {

constexpr double kCasingOpacity = 0.6, kCoastedOpacity = 0.85;

float covered(float depth) {
  return std::clamp(depth + 0.5f, 0.0f, 1.0f);
}

// Returns the distance from the nearest multiple of the period; `walked` at least minus half a period.
float from_nearest(float walked, float period) {
  return walked - period * static_cast<float>(static_cast<int>(walked / period + 0.5f));
}

}  // namespace

Outline::Outline(double x, double y, double width, double height, double line, LineStyle style, Color color)
    : left_(static_cast<float>(x)),
      top_(static_cast<float>(y)),
      right_(static_cast<float>(x + width)),
      bottom_(static_cast<float>(y + height)),
      radius_(static_cast<float>(std::min({2 * line, width / 2, height / 2}))),
      bend_(radius_ * std::numbers::pi_v<float> / 2),
      style_(style),
      line_color_(color, style == LineStyle::dashed ? kCoastedOpacity : 1),
      casing_color_(Color{}, kCasingOpacity) {
  const double casing = std::max(1.0, 0.6 * line);
  half_ = static_cast<float>((style == LineStyle::dotted ? 1.3 : 1) * line / 2);
  casing_ = static_cast<float>(line / 2 + casing);
  reach_ = casing_ + 1;
  line_word_ = line_color_.over(casing_color_).word();
  casing_word_ = casing_color_.word();
  if (style == LineStyle::dashed) on_ = static_cast<float>(5 * line), period_ = static_cast<float>(9 * line);
  if (style == LineStyle::dotted) period_ = static_cast<float>(2.61 * line);
}

inline Outline::Place Outline::place(float x, float y) const {
  const float cx = std::clamp(x, left_ + radius_, std::max(left_ + radius_, right_ - radius_)),
              cy = std::clamp(y, top_ + radius_, std::max(top_ + radius_, bottom_ - radius_));
  const float dx = x - cx, dy = y - cy;
  const float wide = std::max(right_ - left_ - 2 * radius_, 0.0f),
              high = std::max(bottom_ - top_ - 2 * radius_, 0.0f);
  if (dx != 0 && dy != 0) {
    const float distance = std::sqrt(dx * dx + dy * dy) - radius_;
    if (style_ == LineStyle::solid) return {distance, 0};
    const float across = dx > 0 ? (dy < 0 ? dx : dy) : (dy > 0 ? -dx : -dy);
    const float ahead = dx > 0 ? (dy < 0 ? -dy : dx) : (dy > 0 ? dy : -dx);
    const float angle = std::atan2(across, ahead);  // of the quarter, clockwise
    const float before = dx > 0 ? (dy < 0 ? 0 : bend_ + high)
                                : (dy > 0 ? 2 * bend_ + high + wide : 3 * bend_ + 2 * high + wide);
    return {distance, before + radius_ * angle};
  }
  // Beside a side, or inside: the nearest side counts.
  const float to_left = left_ - x, to_right = x - right_, to_top = top_ - y, to_bottom = y - bottom_;
  const float distance = std::max({to_left, to_right, to_top, to_bottom});
  if (distance == to_right) return {distance, bend_ + y - top_ - radius_};
  if (distance == to_bottom) return {distance, 2 * bend_ + high + right_ - radius_ - x};
  if (distance == to_left) return {distance, 3 * bend_ + high + wide + bottom_ - radius_ - y};
  return {distance, 4 * bend_ + 2 * high + wide + x - left_ - radius_};
}

// Returns the share of a pixel that dashes cover along the line.
inline float Outline::along(float walked) const {
  return covered(on_ / 2 - std::abs(from_nearest(walked - on_ / 2, period_)));
}

// Returns the colour of line over casing, each weighted by its share of the pixel.
inline Premultiplied Outline::shade(float distance, float casing, float line) const {
  const float off = std::abs(distance);
  return (line_color_ * (line * covered(half_ - off)))
      .over(casing_color_ * (casing * covered(casing_ - off)));
}

// Returns the pixel of a line without gaps: colours are mixed only at its edges.
inline std::uint32_t Outline::word_at(float distance) const {
  const float off = std::abs(distance);
  if (off >= casing_ + 0.5f) return 0;
  if (off <= half_ - 0.5f) return line_word_;
  if (off >= half_ + 0.5f && off <= casing_ - 0.5f) return casing_word_;
  return shade(off, 1, 1).word();
}

inline std::uint32_t Outline::word(Place at) const {
  if (std::abs(at.distance) >= reach_) return 0;
  if (style_ == LineStyle::solid) return word_at(at.distance);
  if (style_ == LineStyle::dashed) {
    const float share = along(at.walked);
    return share > 0 ? shade(at.distance, share, share).word() : 0;
  }
  const float to_dot = from_nearest(at.walked, period_);
  return word_at(std::sqrt(to_dot * to_dot + at.distance * at.distance));
}

// Draws the pixels of `part` one by one.
void Outline::draw_exactly(Area area, vision::View<std::uint32_t> picture, Area part) const {
  for (int y = part.y; y < part.y + part.height; ++y) {
    std::uint32_t* row = picture.row(y - area.y) - area.x;
    for (int x = part.x; x < part.x + part.width; ++x)
      row[x] = word(place(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
  }
}

// Draws the pixels of `part`, which lies beside one straight side: lines along the side have one colour, with or
// without gaps.
void Outline::draw_run(Area area, vision::View<std::uint32_t> picture, Area part, bool upright) const {
  const int across = upright ? part.width : part.height, along_side = upright ? part.height : part.width;
  const std::ptrdiff_t step = upright ? picture.stride : 1;
  for (int i = 0; i < across; ++i) {
    const int x = part.x + (upright ? i : 0), y = part.y + (upright ? 0 : i);
    Place at = place(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    if (std::abs(at.distance) >= casing_ + 0.5f) continue;
    const float ahead = place(static_cast<float>(x) + (upright ? 0.5f : 1.5f),
                              static_cast<float>(y) + (upright ? 1.5f : 0.5f))
                                    .walked > at.walked
                            ? 1.0f
                            : -1.0f;
    std::uint32_t* to = picture.row(y - area.y) + (x - area.x);
    const std::uint32_t whole = shade(at.distance, 1, 1).word();
    for (int j = 0; j < along_side; ++j, to += step, at.walked += ahead) {
      if (style_ == LineStyle::solid) {
        *to = whole;
      } else if (style_ == LineStyle::dotted) {
        *to = word(at);
      } else if (const float share = along(at.walked); share >= 1) {
        *to = whole;
      } else if (share > 0) {
        *to = shade(at.distance, share, share).word();
      }
    }
  }
}

void Outline::draw(Area area, vision::View<std::uint32_t> picture) const {
  // Returns the straight part of a side between the corners, from `from` to `to`, whole pixels.
  const auto inner = [&](float low, float high) {
    const int from = static_cast<int>(std::ceil(low + radius_ + reach_)),
              to = static_cast<int>(std::floor(high - radius_ - reach_));
    return std::pair{from, std::max(to, from)};
  };
  const auto [x0, x1] = inner(left_, right_);
  const auto [y0, y1] = inner(top_, bottom_);
  const bool wide = x1 > x0, high = y1 > y0;
  if (!wide || !high) return draw_exactly(area, picture, area);
  const int left = area.x, right = area.x + area.width, top = area.y, bottom = area.y + area.height;
  for (const auto& [from_y, to_y] : {std::pair{top, std::min(y0, bottom)}, {std::max(y1, top), bottom}}) {
    if (to_y <= from_y) continue;
    const int height = to_y - from_y;
    const auto part = [&](int from, int to) {
      return Area{from, from_y, to - from, height}.intersection(area);
    };
    draw_exactly(area, picture, part(left, x0));
    draw_exactly(area, picture, part(x1, right));
    if (const Area run = part(x0, x1); !run.empty()) draw_run(area, picture, run, false);
  }
  for (const auto& [from_x, to_x] : {std::pair{left, std::min(x0, right)}, {std::max(x1, left), right}}) {
    const Area run = Area{from_x, y0, to_x - from_x, y1 - y0}.intersection(area);
    if (!run.empty()) draw_run(area, picture, run, true);
  }
}

}  // namespace cerberus::overlay
