// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/ego_motion/patches.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

namespace {

constexpr int kBlock = 4;  // gradient sums are kept per block of 4 x 4 pixels; a patch is 2 x 2 blocks

constexpr float kMiddle = 0.5f * (kPatch - 1);  // of a patch, from its corner

// Where no origin stands it is unknown: kept from the first version. Guard of all: bench-camera_motion and
// tests/unit/patches.
constexpr struct Parameters {
  // Choice of patches.
  int halved = 64;  // pixels of the shorter side from which the half-size picture is read: half the noise, a
                    // quarter of the work
  int cell = 20;    // pixels: side of a cell, which has one patch at most
  int least_cell = 8;   // pixels: of a small picture, so that several parts of it have patches
  int least_cells = 4;  // in either direction of such a picture
  int most_cells_x = 16, most_cells_y = 12;
  double least_gradient = 16.0;  // grey levels squared a pixel: texture
  double noise_gradient = 3;     // times that of noise, which has 2 noise^2 a pixel (not halved differences)
  double edge =
      0.05;  // of the larger gradient in a patch's score: prefers corners to edges, and edges to no texture
  // Matching.
  float least_variance = 0.25f;  // grey levels squared a pixel: a patch with less is not matched
  float stiff = 0.01f;           // of the gradient sums, and
  float stiff_pixel = 0.5f;  // grey levels squared a pixel: a patch with an edge only does not move along it
  float least_gain = 0.15f;  // contrast, in that of the patch: with less it is not at this place
  float most_step = 2.0f;    // pixels in a round
  float converged = 0.03f;   // pixels: a smaller step is the last
} kParameters;

constexpr int kMargin = 1;  // blocks start one pixel inside, so that every pixel has all its neighbours

// x, y: centre of a patch of `side` pixels.
bool touches(std::span<const Box> boxes, double x, double y, double side) {
  const Box patch{x - side / 2, y - side / 2, side, side};
  return std::ranges::any_of(boxes, [&](const Box& b) { return overlap_area(b, patch) > 0; });
}

}  // namespace

void PatchSites::choose(const Pyramid& pyramid, double noise, Image<std::int32_t>& scratch,
                        std::span<const Box> excluded) {
  const Parameters& q = kParameters;
  count = 0;
  const Size size = pyramid.size();
  const int level = pyramid.levels() > 1 && std::min(size.width, size.height) >= q.halved ? 1 : 0;
  const GrayView picture = pyramid.level(level);
  const int across = (picture.width - 2 * kMargin) / kBlock, down = (picture.height - 2 * kMargin) / kBlock;
  if (across < 2 || down < 2) return;
  const auto cells = [&](int length, int most) {
    return std::clamp(length / q.cell, std::clamp(length / q.least_cell, 1, q.least_cells), most);
  };
  const int cells_x = cells(size.width, q.most_cells_x), cells_y = cells(size.height, q.most_cells_y);
  // Three planes beside one another, each with the rows of blocks that one row of cells reads: its own, one more, and
  // the last of the row before.
  const int depth = down / cells_y + 3;
  scratch.resize({3 * across, depth});
  const auto blocks = [&, view = scratch.view()](int plane, int y) {
    return view.row(y % depth) + static_cast<std::ptrdiff_t>(plane) * across;
  };
  size_ = size;
  constexpr int kSide = PatchFollower::kSide;
  kept_.resize({kSide * kSide, cells_x * cells_y});
  int known = 0;  // rows of blocks
  const double pixel_noise = noise / (1 << level);
  const double least =
      kPatch * kPatch * std::max(q.least_gradient, q.noise_gradient * 2 * pixel_noise * pixel_noise);
  const double scale = 1 << level;
  const auto centre = [&](int block) { return (kMargin + (block + 1) * kBlock) * scale - 0.5; };
  for (int cy = 0; cy < cells_y; ++cy) {
    const int y0 = cy * (down - 1) / cells_y, y1 = std::max((cy + 1) * (down - 1) / cells_y, y0 + 1);
    for (; known < std::min(y1 + 1, down); ++known)
      sum_gradient_blocks(picture, kMargin, kMargin + kBlock * known, across, blocks(0, known),
                          blocks(1, known), blocks(2, known));
    for (int cx = 0; cx < cells_x; ++cx) {
      const int x0 = cx * (across - 1) / cells_x, x1 = std::max((cx + 1) * (across - 1) / cells_x, x0 + 1);
      double best = 0;
      int best_x = 0, best_y = 0;
      for (int y = y0; y < std::min(y1, down - 1); ++y) {
        const std::int32_t *upper = blocks(0, y), *lower = blocks(0, y + 1);
        for (int x = x0; x < std::min(x1, across - 1); ++x) {
          const auto window = [&](int plane) {
            const int i = plane * across + x;
            return double(upper[i]) + upper[i + 1] + lower[i] + lower[i + 1];
          };
          const double a = window(0), b = window(1), c = window(2);
          // Not even an ideal corner with so much gradient would be a better one.
          const double half = 0.5 * (a + c);
          if (half + q.edge * half <= best) continue;
          const double spread = std::sqrt(0.25 * (a - c) * (a - c) + b * b);
          const double large = half + spread, small = half - spread;
          if (large < least) continue;
          const double score = small + q.edge * large;
          if (score <= best) continue;
          if (!excluded.empty() && touches(excluded, centre(x), centre(y), kPatch << level)) continue;
          best = score, best_x = x, best_y = y;
        }
      }
      if (best <= 0 || count == MotionSamples::kMax) continue;
      PatchSite& s = site[count++];
      s.x = static_cast<float>(centre(best_x));
      s.y = static_cast<float>(centre(best_y));
      s.region = static_cast<std::uint8_t>(4 * std::min(3, static_cast<int>(4 * s.y / size.height)) +
                                           std::min(3, static_cast<int>(4 * s.x / size.width)));
    }
  }
  for (int i = 0; i < count; ++i)
    if (const auto corner = PatchFollower::corner_on(size, 0, site[i]))
      for (int y = 0; y < kSide; ++y)
        std::copy_n(pyramid.level(0).row(corner->y - 1 + y) + corner->x - 1, kSide,
                    kept_.view().row(i) + kSide * y);
}

void PatchSites::exclude(std::span<const Box> excluded) {
  if (excluded.empty()) return;
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    if (touches(excluded, site[i].x, site[i].y, kPatch)) continue;
    if (kept < i) {
      site[kept] = site[i];
      std::copy_n(kept_.view().row(i), kept_.size().width, kept_.view().row(kept));
    }
    ++kept;
  }
  count = kept;
}

PatchFollower PatchSites::follower(int i) const {
  constexpr int kSide = PatchFollower::kSide;
  const auto corner = PatchFollower::corner_on(size_, 0, site[i]);
  return corner ? PatchFollower({kept_.view().row(i), kSide, kSide, kSide}, *corner)
                : PatchFollower({}, 0, site[i]);
}

std::optional<PatchFollower::Corner> PatchFollower::corner_on(Size size, int level, const PatchSite& site) {
  if (size.width < kSide || size.height < kSide) return std::nullopt;
  const float scale = 1.0f / static_cast<float>(1 << level);
  const auto corner = [&](float centre, int length) {
    return std::clamp(static_cast<int>((centre + 0.5f) * scale - kMiddle), 1, length - kPatch - 1);
  };
  return Corner{corner(site.x, size.width), corner(site.y, size.height)};
}

PatchFollower::PatchFollower(GrayView earlier, int level, const PatchSite& site) {
  if (const auto corner = corner_on(earlier.size(), level, site))
    begin({earlier.row(corner->y - 1) + corner->x - 1, kSide, kSide, earlier.stride}, *corner);
}

void PatchFollower::begin(GrayView part, const Corner& corner) {
  corner_x_ = corner.x, corner_y_ = corner.y;
  match_.x = static_cast<float>(corner_x_) + kMiddle, match_.y = static_cast<float>(corner_y_) + kMiddle;
  make_template(part, 1, 1, patch_);
  textured_ = patch_.vv > kPatch * kPatch * kParameters.least_variance;
  if (!textured_) return;
  per_value_ = 1 / patch_.vv;
  gain_x_ = patch_.xv * per_value_, gain_y_ = patch_.yv * per_value_;
  match_.hxx = patch_.xx - gain_x_ * patch_.xv, match_.hyy = patch_.yy - gain_y_ * patch_.yv;
  match_.hxy = patch_.xy - gain_x_ * patch_.yv;
  const float stiff = kParameters.stiff * (patch_.xx + patch_.yy) + kPatch * kPatch * kParameters.stiff_pixel;
  const float xx = match_.hxx + stiff, yy = match_.hyy + stiff;
  const float per_determinant = 1 / (xx * yy - match_.hxy * match_.hxy);
  ixx_ = yy * per_determinant, ixy_ = -match_.hxy * per_determinant, iyy_ = xx * per_determinant;
}

PatchMatch PatchFollower::follow(GrayView later, float dx, float dy, int rounds) const {
  constexpr int kLast = kPatch + 1;
  constexpr float kPixels = kPatch * kPatch;
  const Parameters& q = kParameters;
  PatchMatch match = match_;
  if (!textured_) return match;
  const float right = static_cast<float>(later.width - kLast), low = static_cast<float>(later.height - kLast);
  PatchProducts p;
  for (int round = 0;; ++round) {
    const float px = static_cast<float>(corner_x_) + dx, py = static_cast<float>(corner_y_) + dy;
    if (!(px >= 0 && py >= 0 && px <= right && py <= low)) return match;
    p = match_patch(later, px, py, patch_);
    if (round == rounds) break;
    // later(p + d) = gain * earlier(p + e) + offset: regression on gradients and value, value eliminated.
    const float bx = p.x - gain_x_ * p.value, by = p.y - gain_y_ * p.value;
    const float ex = ixx_ * bx + ixy_ * by, ey = ixy_ * bx + iyy_ * by;  // times the gain
    const float gain = (p.value - patch_.xv * ex - patch_.yv * ey) * per_value_;
    if (!(gain > q.least_gain)) break;  // the patch is not at this place
    const float per_gain = 1 / gain;
    const float step_x = std::max(-q.most_step, std::min(q.most_step, ex * per_gain));
    const float step_y = std::max(-q.most_step, std::min(q.most_step, ey * per_gain));
    dx -= step_x, dy -= step_y;
    if (step_x * step_x + step_y * step_y < q.converged * q.converged)
      break;  // converged: the products of this place remain valid after the step
  }
  const float spread = p.squares - p.sum * p.sum / kPixels;
  match.inside = true;
  match.dx = dx, match.dy = dy;
  match.correlation = spread > 0 ? p.value / std::sqrt(spread * patch_.vv) : 0;
  match.noise2 = std::max(spread - p.value * p.value * per_value_, 0.0f) / (kPixels - 4);
  return match;
}

}  // namespace cerberus::vision
