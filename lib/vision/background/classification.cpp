// SPDX-License-Identifier: LGPL-2.1-or-later
// What of a frame is not the scene: compared with the memory pixel by pixel, and judged part by part.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <optional>

#include "vision/background/background_state.h"
#include "vision/geometry/registration.h"
#include "vision/image/mask.h"
#include "vision/image/median.h"

namespace cerberus::vision {
namespace {

constexpr double kLeastSigma = 0.7;      // grey levels: rounding alone makes 0.3, compression more
constexpr int kClosing = 9;              // side of the closing at 320 columns
constexpr double kUnreliable = 1.5;      // pixels of registration error above which the memory is learnt anew
constexpr double kMostUnreliable = 0.1;  // share of the blocks up to which a memory fits the frame
constexpr double kBlurred = 0.8;  // sharpness from which on blur is the motion's, not the interpolation's

// A block's ages, at most kRelearn.
void relearn(MutableGrayView age, int left, int top) {
  const int columns = std::min(kBackgroundBlock, age.width - left),
            bottom = std::min(top + kBackgroundBlock, age.height);
  for (int y = top; y < bottom; ++y) {
    std::uint8_t* row = age.row(y) + left;
    for (int x = 0; x < columns; ++x) row[x] = std::min(row[x], kRelearn);
  }
}

// Noise by brightness from sampled absolute differences.
class NoiseSamples {
 public:
  void add(int brightness, int difference) {
    if (difference < kLevels) ++counts_[brightness >> 4][difference];
  }
  // None if there are too few samples.
  std::optional<double> sigma(int k) const {
    if (std::accumulate(counts_[k].begin(), counts_[k].end(), 0u) < 40) return std::nullopt;
    return noise_sigma(counts_[k]);
  }

 private:
  static constexpr int kLevels = 64;
  // 32 bits: a sixteenth of 3840 x 2160 pixels may all be alike.
  std::array<std::array<std::uint32_t, kLevels>, kBrightness> counts_{};
};

}  // namespace

// sigma of frame - memory by brightness. While the memory is young its own noise and the frame's cannot be told apart
// there, and D(k) stands in: sqrt(1/2) of its sigma, times sqrt(1 + 1 / age) for a mean of that many frames.
void BackgroundModel::State::learn_noise(const BackgroundInput& in) {
  const bool start = frames < 8;
  NoiseSamples samples;
  const auto spans = warp.spans();
  const auto k = light.known();
  for (int y = 1 + frames % 4; y < size.height; y += 4) {
    const RowSpan span = spans[static_cast<std::size_t>(y)];
    const std::uint8_t *f = present.view().row(y), *m = k.row(y), *a = age.view().row(y);
    const std::uint64_t* now = moved.view().row(y);
    for (int x = span.begin + frames / 4 % 4; x < span.end; x += 4) {
      if (start)
        samples.add(in.picture.at(x, y), in.difference.at(x, y));
      else if (a[x] > 2 && !(now[x / 64] >> (x % 64) & 1))
        samples.add(m[x], std::abs(f[x] - m[x]));
    }
  }
  const double plain = std::max(in.sigma * std::sqrt(0.5), kLeastSigma);
  const double young = std::sqrt(0.5) * std::sqrt(1 + 1.0 / std::max(frames - 1, 1));
  double last = plain;
  for (int c = 0; c < kBrightness; ++c) {
    const auto measured = samples.sigma(c);
    if (start)
      sigma[c] = measured ? std::max(*measured * young, kLeastSigma) : last;
    else if (measured)
      sigma[c] += 0.1 * (std::max(*measured, kLeastSigma) - sigma[c]);
    last = sigma[c];  // a class nobody has seen is at least as noisy as the next darker one
  }
}

// Clears what this frame does not show.
void BackgroundModel::State::leave_valid(MutableBitView bits) const {
  for (int y = 0; y < bits.height; ++y) {
    const RowSpan span = warp.spans()[static_cast<std::size_t>(y)];
    clear_bits(bits.row(y), 0, span.begin);
    clear_bits(bits.row(y), span.end, 64 * bits.width);
  }
}

void BackgroundModel::State::compare(const BackgroundInput& in) {
  CompareLimits limits;
  limits.registered = !in.still;
  for (int c = 0; c < kBrightness; ++c)
    limits.noise[c] = static_cast<std::uint8_t>(std::min(std::lround(16 * sigma[c]), 255L));
  // Mean of |e| of normal noise: 0.8 sigma.
  const double noise = 0.8 * std::max(in.sigma * std::sqrt(0.5), kLeastSigma);
  const bool unsettled = frames < kUnsettledFrames;
  unreliable = 0;
  const auto k = light.known();
  CompareRow row;
  row.width = size.width;
  row.tolerance = tolerance.view().data;
  for (int y = 0; y < size.height; ++y) {
    const int by = y / kBackgroundBlock;
    if (in.still && y == 0) {
      std::fill_n(tolerance.view().data, size.width, std::uint8_t{16});  // a pixel
    } else if (!in.still && y % kBackgroundBlock == 0) {
      // The registration error around a block: |e| over gradient where nothing moves, of the 3 x 3 blocks; twice its
      // mean, since the tail counts (twice that while the memory has errors of its own). One pixel at least:
      // interpolation and aliasing make that much. Whether the memory is still good there is judged by what noise
      // alone does not explain.
      for (int bx = 0; bx < columns; ++bx) {
        double ge = 0, gg = 0, n = 0;
        for (int v = std::max(by - 1, 0); v <= std::min(by + 1, rows - 1); ++v)
          for (int u = std::max(bx - 1, 0); u <= std::min(bx + 1, columns - 1); ++u) {
            const BlockSums& b = blocks[static_cast<std::size_t>(v) * columns + u];
            ge += b.ge;
            gg += b.gg;
            n += b.n;
          }
        // Gradients are doubled: |e| / g = 2 ge / gg.
        const double error = unsettled ? std::clamp(4 * 2 * ge / (gg + 400), 2.0, 4.0)
                                       : std::clamp(2 * 2 * ge / (gg + 400), 1.0, 3.0);
        // sum of g <= sqrt(n x sum of g^2)
        const double beyond_noise = 2 * 2 * (ge - noise * std::sqrt(gg * n)) / (gg + 400);
        if (beyond_noise > kUnreliable) {
          ++unreliable;
          relearn(age.view(), bx * kBackgroundBlock, y);
        }
        std::fill_n(tolerance.view().data + bx * kBackgroundBlock,
                    std::min(kBackgroundBlock, size.width - bx * kBackgroundBlock),
                    static_cast<std::uint8_t>(std::lround(16 * error)));
      }
    }
    row.present = present.view().row(y);
    row.above = k.row(y - 1), row.memory = k.row(y), row.below = k.row(y + 1);
    row.spread = spread.view().row(y), row.age = age.view().row(y);
    row.moved = moved.view().row(y), row.quiet = quiet.view().row(y);
    compare_row(row, limits, weak.view().row(y), strong.view().row(y));
  }
  leave_valid(weak.view());
  leave_valid(strong.view());
  if (!in.still) forgive_blur();
}

// A camera that moves blurs its pictures, a camera that shakes blurs some of them. The other way round, a memory that
// is still young may be of blurred frames; later it is softer than a frame for other reasons.
void BackgroundModel::State::forgive_blur() {
  const GrayView frame = present.view(), memory = light.known();
  const double sharpness = blur.sharpness(frame, memory, age.view(), warp.spans());
  const bool memory_blurred = sharpness > 1 / kBlurred && frames < kUnsettledFrames;
  if (sharpness >= kBlurred && !memory_blurred) return;
  constexpr CompareLimits limits;  // what is noise to the comparison is so here
  std::array<std::uint8_t, kBrightness> tolerance;
  for (int c = 0; c < kBrightness; ++c)
    tolerance[c] =
        static_cast<std::uint8_t>(std::clamp(limits.weak_sigmas * sigma[c], limits.weak_least / 16.0, 255.0));
  blur.forgive(memory_blurred ? memory : frame, memory_blurred ? frame : memory, tolerance, weak.view(),
               strong.view());
}

// strong := the mask, closed; plain: as it is published. weak := what must not be learnt. absorb := what is to be taken
// over.
void BackgroundModel::State::decide(const BackgroundInput& in) {
  const int w = size.width;
  const MutableBitView seeds = strong.view();
  morphology.vote(weak.view(), w, 4);  // four of nine: noise is lonely
  morphology.vote(seeds, w, 4);
  morphology.reconstruct(seeds, weak.view());
  std::memcpy(weak.view().data, seeds.data, weak.bytes());
  const ClassificationPlanes planes{
      present.view(), light.known(), age.view(),
      quiet.view(),   in.still,      !in.still && unreliable < kMostUnreliable * columns * rows,
      warp.spans()};
  const bool young = parts.judge(planes, windows, seeds, absorb.view());
  const int side = std::max(3, kClosing * w / 320 | 1);
  std::memcpy(plain().data, seeds.data, moved.bytes());
  morphology.close(seeds, w, side);
  leave_valid(seeds);
  unite(weak.view(), seeds, weak.view());
  morphology.dilate(weak.view(), w, 3);
  if (young) parts.join(planes, windows, seeds, plain());
  parts.join_fronts(planes, seeds, plain());
}

}  // namespace cerberus::vision
