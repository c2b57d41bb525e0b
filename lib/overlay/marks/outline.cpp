// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/marks/outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cerberus::overlay {

namespace {

constexpr double kCasingOpacity = 0.6, kCoastedOpacity = 0.85;
// In widths of the line: length of dashes and of the gaps between them, distance of dots.
constexpr float kDash = 5, kGap = 4, kDots = 2.61f;

float covered(float depth) {
  return std::clamp(depth + 0.5f, 0.0f, 1.0f);
}

// Returns the distance from the nearest multiple of the period; `walked` at least minus half a period.
float from_nearest(float walked, float period) {
  return walked - period * static_cast<float>(static_cast<int>(walked / period + 0.5f));
}

// Returns the first pixel whose centre lies at `at` or beyond.
int first_from(float at) {
  return static_cast<int>(std::ceil(at - 0.5f));
}

}  // namespace

Outline::Outline(double x, double y, double width, double height, double line, LineStyle style, Color color)
    : left_(static_cast<float>(x)),
      top_(static_cast<float>(y)),
      right_(static_cast<float>(x + width)),
      bottom_(static_cast<float>(y + height)) {
  const double casing = std::max(1.0, 0.6 * line);
  line_.style = style;
  line_.radius = static_cast<float>(std::min({2 * line, width / 2, height / 2}));
  line_.half = static_cast<float>((style == LineStyle::dotted ? 1.3 : 1) * line / 2);
  line_.casing = static_cast<float>(line / 2 + casing);
  line_.color = {color, style == LineStyle::dashed ? kCoastedOpacity : 1};
  line_.casing_opacity = kCasingOpacity;
  bend_ = line_.radius * std::numbers::pi_v<float> / 2;
  wide_ = std::max(right_ - left_ - 2 * line_.radius, 0.0f);
  high_ = std::max(bottom_ - top_ - 2 * line_.radius, 0.0f);
  reach_ = line_.casing + 1;
  if (style == LineStyle::solid) return;
  const float all = 4 * bend_ + 2 * high_ + 2 * wide_,
              wanted = static_cast<float>(line) * (style == LineStyle::dashed ? kDash + kGap : kDots);
  line_.period = all / std::max(1.0f, std::round(all / wanted));
  line_.on = line_.period * kDash / (kDash + kGap);
}

double Outline::inner_reach() const {
  // The arc's inner edge has its corner-most point on the diagonal.
  const float edge = std::max(line_.radius - line_.casing, 0.0f);
  return std::max(reach_, line_.radius - edge * std::numbers::sqrt2_v<float> / 2 + 1);
}

Outline::Place Outline::place(float x, float y) const {
  const float radius = line_.radius;
  const float cx = std::clamp(x, left_ + radius, std::max(left_ + radius, right_ - radius)),
              cy = std::clamp(y, top_ + radius, std::max(top_ + radius, bottom_ - radius));
  const float dx = x - cx, dy = y - cy;
  if (dx != 0 && dy != 0) {
    const float across = dx > 0 ? (dy < 0 ? dx : dy) : (dy > 0 ? -dx : -dy);
    const float ahead = dx > 0 ? (dy < 0 ? -dy : dx) : (dy > 0 ? dy : -dx);
    const float angle = std::atan2(across, ahead);  // of the quarter, clockwise
    const float before = dx > 0 ? (dy < 0 ? 0 : bend_ + high_)
                                : (dy > 0 ? 2 * bend_ + high_ + wide_ : 3 * bend_ + 2 * high_ + wide_);
    return {std::sqrt(dx * dx + dy * dy) - radius, before + radius * angle};
  }
  // Beside a side, or inside: the nearest side counts.
  const float to_left = left_ - x, to_right = x - right_, to_top = top_ - y, to_bottom = y - bottom_;
  const float distance = std::max({to_left, to_right, to_top, to_bottom});
  if (distance == to_right) return {distance, bend_ + y - top_ - radius};
  if (distance == to_bottom) return {distance, 2 * bend_ + high_ + right_ - radius - x};
  if (distance == to_left) return {distance, 3 * bend_ + high_ + wide_ + bottom_ - radius - y};
  return {distance, 4 * bend_ + 2 * high_ + wide_ + x - left_ - radius};
}

// Returns the share of a pixel that dashes cover along the line.
float Outline::along(float walked) const {
  return covered(line_.on / 2 - std::abs(from_nearest(walked - line_.on / 2, line_.period)));
}

// Returns the colour of line over casing, each weighted by its share of the pixel.
std::uint32_t Outline::word(Place at) const {
  float off = std::abs(at.distance);
  if (off >= reach_) return 0;
  const float part = line_.style == LineStyle::dashed ? along(at.walked) : 1;
  if (line_.style == LineStyle::dotted) off = std::hypot(off, from_nearest(at.walked, line_.period));
  const Premultiplied casing(Color{}, line_.casing_opacity);
  return (line_.color * (part * covered(line_.half - off)))
      .over(casing * (part * covered(line_.casing - off)))
      .word();
}

void Outline::draw_exactly(Area area, vision::View<std::uint32_t> picture) const {
  for (int y = 0; y < area.height; ++y) {
    std::uint32_t* row = picture.row(y);
    for (int x = 0; x < area.width; ++x)
      row[x] = word(place(static_cast<float>(area.x + x) + 0.5f, static_cast<float>(area.y + y) + 0.5f));
  }
}

Quarter Outline::quarter(bool lower, bool right) const {
  const float x = right ? std::max(right_ - line_.radius, left_ + line_.radius) : left_ + line_.radius,
              y = lower ? std::max(bottom_ - line_.radius, top_ + line_.radius) : top_ + line_.radius;
  const float all = 4 * bend_ + 2 * high_ + 2 * wide_;
  const float upper_right = 0, lower_right = 2 * bend_ + high_, lower_left = lower_right + wide_,
              upper_left = all - wide_;
  const float walked = lower ? (right ? lower_right : lower_left) : (right ? upper_right : upper_left);
  return {.x = x,
          .y = y,
          .outward_x = right ? 1.0f : -1.0f,
          .outward_y = lower ? 1.0f : -1.0f,
          .walked = walked,
          .walked_level = !lower && right ? all : walked,
          .direction = lower == right ? -1.0f : 1.0f};
}

// Draws a row above or below the upright sides.
void Outline::draw_level(Area area, int y, std::uint32_t* row) const {
  const bool lower = y >= first_from((top_ + bottom_) / 2);
  const int begin = area.x, end = area.x + area.width;
  int from = first_from((left_ + right_) / 2), to = from;
  const Quarter left = quarter(lower, false), right = quarter(lower, true);
  if (line_.style == LineStyle::solid && wide_ > 0)  // between the corners all pixels are equal
    from = first_from(left.x), to = std::max(first_from(right.x), from);
  from = std::clamp(from, begin, end), to = std::clamp(to, begin, end);
  draw_quarter_row(line_, left, begin, y, from - begin, row);
  if (to > from) {
    draw_quarter_row(line_, left, from, y, 1, row + (from - begin));
    std::fill(row + (from - begin), row + (to - begin), row[from - begin]);
  }
  draw_quarter_row(line_, right, to, y, end - to, row + (to - begin));
}

// Draws pixels beside an upright side: rows without a gap are equal.
void Outline::draw_upright(Side& side, int x, int y, int pixels, std::uint32_t* row) const {
  const Quarter& q = side.quarter;
  const float below = q.outward_y * (q.y - static_cast<float>(y) - 0.5f);
  const float part = line_.style == LineStyle::dashed ? along(q.walked + q.direction * (bend_ + below)) : 1;
  const bool whole = part >= 1 && line_.style != LineStyle::dotted;
  if (whole && side.whole) {
    std::copy_n(side.whole, pixels, row);
  } else if (part <= 0) {
    std::fill_n(row, pixels, 0);
  } else {
    draw_quarter_row(line_, q, x, y, pixels, row);
    if (whole) side.whole = row;
  }
}

void Outline::draw(Area area, vision::View<std::uint32_t> picture) const {
  if (line_.radius < line_.casing + 0.5f) return draw_exactly(area, picture);
  const int begin = area.x, end = area.x + area.width, middle = first_from((left_ + right_) / 2);
  const int inner_left = std::clamp(std::min(first_from(left_ + reach_), middle), begin, end),
            inner_right = std::clamp(std::max(first_from(right_ - reach_), middle), begin, end);
  const int upright = first_from(top_ + line_.radius), level = first_from(bottom_ - line_.radius);
  Side left{quarter(false, false)}, right{quarter(false, true)};
  for (int i = 0; i < area.height; ++i) {
    const int y = area.y + i;
    std::uint32_t* row = picture.row(i);
    if (y < upright || y >= level) {
      draw_level(area, y, row);
      continue;
    }
    draw_upright(left, begin, y, inner_left - begin, row);
    std::fill(row + (inner_left - begin), row + (inner_right - begin), 0u);
    draw_upright(right, inner_right, y, end - inner_right, row + (inner_right - begin));
  }
}

}  // namespace cerberus::overlay
