// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/patches.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

namespace {

constexpr int kBlock = 4;  // gradient sums are kept per block of 4 x 4 pixels; a patch is 2 x 2 blocks

// Sums of gx gx, gx gy, gy gy (central differences over two pixels, not halved) of every block, in three planes.
void sum_gradients(GrayView picture, View<std::int32_t> blocks, int across, int down) {
  for (int by = 0; by < down; ++by) {
    std::int32_t* xx = blocks.row(by);
    std::int32_t* xy = blocks.row(down + by);
    std::int32_t* yy = blocks.row(2 * down + by);
    std::fill_n(xx, across, 0), std::fill_n(xy, across, 0), std::fill_n(yy, across, 0);
    for (int y = by * kBlock; y < (by + 1) * kBlock; ++y) {
      const std::uint8_t* above = picture.row(std::max(y - 1, 0));
      const std::uint8_t* row = picture.row(y);
      const std::uint8_t* below = picture.row(std::min(y + 1, picture.height - 1));
      for (int bx = 0; bx < across; ++bx)
        for (int x = bx * kBlock; x < (bx + 1) * kBlock; ++x) {
          const int gx = row[std::min(x + 1, picture.width - 1)] - row[std::max(x - 1, 0)];
          const int gy = below[x] - above[x];
          xx[bx] += gx * gx, xy[bx] += gx * gy, yy[bx] += gy * gy;
        }
    }
  }
}

}  // namespace

void PatchSites::choose(const Pyramid& pyramid, double noise, Image<std::int32_t>& scratch) {
  count = 0;
  const Size size = pyramid.size();
  // Half size where there is enough of it: half the noise, a quarter of the work.
  const int level = pyramid.levels() > 1 && std::min(size.width, size.height) >= 64 ? 1 : 0;
  const GrayView picture = pyramid.level(level);
  const int across = picture.width / kBlock, down = picture.height / kBlock;
  if (across < 2 || down < 2) return;
  scratch.resize({across, 3 * down});
  const View<std::int32_t> blocks = scratch.view();
  sum_gradients(picture, blocks, across, down);
  const int cells_x = std::clamp(size.width / 20, 1, 16), cells_y = std::clamp(size.height / 20, 1, 12);
  const double pixel_noise = noise / (1 << level);
  // Gradients of pure noise have variance 2 noise^2 a pixel (not halved differences).
  const double least = kPatch * kPatch * std::max(16.0, 3 * 2 * pixel_noise * pixel_noise);
  for (int cy = 0; cy < cells_y; ++cy)
    for (int cx = 0; cx < cells_x; ++cx) {
      const int x0 = cx * (across - 1) / cells_x, x1 = std::max((cx + 1) * (across - 1) / cells_x, x0 + 1);
      const int y0 = cy * (down - 1) / cells_y, y1 = std::max((cy + 1) * (down - 1) / cells_y, y0 + 1);
      double best = 0;
      int best_x = 0, best_y = 0;
      for (int y = y0; y < std::min(y1, down - 1); ++y)
        for (int x = x0; x < std::min(x1, across - 1); ++x) {
          const auto window = [&](int plane) {
            const std::int32_t* upper = blocks.row(plane * down + y) + x;
            const std::int32_t* lower = blocks.row(plane * down + y + 1) + x;
            return double(upper[0]) + upper[1] + lower[0] + lower[1];
          };
          const double a = window(0), b = window(1), c = window(2);
          const double spread = std::hypot(0.5 * (a - c), b);
          const double large = 0.5 * (a + c) + spread, small = 0.5 * (a + c) - spread;
          if (large < least) continue;
          const double score = small + 0.05 * large;  // corners before edges, edges before nothing
          if (score > best) best = score, best_x = x, best_y = y;
        }
      if (best <= 0 || count == MotionSamples::kMax) continue;
      const float scale = static_cast<float>(1 << level);
      PatchSite& s = site[count++];
      s.x = (best_x * kBlock + kBlock) * scale - 0.5f;
      s.y = (best_y * kBlock + kBlock) * scale - 0.5f;
      s.region = static_cast<std::uint8_t>(4 * std::min(3, static_cast<int>(4 * s.y / size.height)) +
                                           std::min(3, static_cast<int>(4 * s.x / size.width)));
    }
}

PatchMatch follow_patch(GrayView earlier, GrayView later, int level, const PatchSite& site, float dx,
                        float dy, int rounds) {
  PatchMatch match;
  constexpr int kLast = kPatch + 1;
  if (earlier.width < kLast + 1 || earlier.height < kLast + 1) return match;
  const float scale = 1.0f / static_cast<float>(1 << level), middle = 0.5f * (kPatch - 1);
  const auto corner = [&](float centre, int length) {
    return std::clamp(static_cast<int>(std::lround((centre + 0.5f) * scale - 0.5f - middle)), 1,
                      length - kLast);
  };
  const int x = corner(site.x, earlier.width), y = corner(site.y, earlier.height);
  match.x = x + middle, match.y = y + middle;
  PatchTemplate patch;
  make_template(earlier, x, y, patch);
  if (patch.vv <= kPatch * kPatch * 0.25f) return match;
  // A little stiffness: a patch that shows only an edge stays put along it.
  const float stiff = 0.01f * (patch.xx + patch.yy) + kPatch * kPatch * 0.5f;
  const float gain_x = patch.xv / patch.vv, gain_y = patch.yv / patch.vv;
  match.hxx = patch.xx - gain_x * patch.xv, match.hyy = patch.yy - gain_y * patch.yv;
  match.hxy = patch.xy - gain_x * patch.yv;
  const float xx = match.hxx + stiff, yy = match.hyy + stiff, determinant = xx * yy - match.hxy * match.hxy;
  for (int round = 0;; ++round) {
    const float px = x + dx, py = y + dy;
    if (!(px >= 0 && py >= 0 && px <= later.width - kLast && py <= later.height - kLast)) {
      match.correlation = 0;
      break;
    }
    const PatchProducts p = match_patch(later, px, py, patch);
    const float spread = p.squares - p.sum * p.sum / (kPatch * kPatch);
    match.correlation = spread > 0 ? p.value / std::sqrt(spread * patch.vv) : 0;
    match.noise2 = std::max(spread - p.value * p.value / patch.vv, 0.0f) / (kPatch * kPatch - 4);
    match.dx = dx, match.dy = dy;
    if (round == rounds) break;
    // later(p + d) = gain * earlier(p + e) + offset: regression on gradients and value, value eliminated.
    const float bx = p.x - gain_x * p.value, by = p.y - gain_y * p.value;
    const float ex = (yy * bx - match.hxy * by) / determinant, ey = (xx * by - match.hxy * bx) / determinant;
    const float gain = (p.value - patch.xv * ex - patch.yv * ey) / patch.vv;
    if (!(gain > 0.15f)) break;  // nothing of the patch here
    const float step_x = std::clamp(ex / gain, -2.0f, 2.0f), step_y = std::clamp(ey / gain, -2.0f, 2.0f);
    dx -= step_x, dy -= step_y;
    if (step_x * step_x + step_y * step_y < 0.02f * 0.02f) rounds = round + 1;
  }
  return match;
}

}  // namespace cerberus::vision
