// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/background/foreground_classification.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <optional>

#include "vision/background/background_light.h"
#include "vision/geometry/registration.h"
#include "vision/image/median.h"

namespace cerberus::vision {
namespace {

// Origin unknown where none is given: kept from the first version. Guard of all: mean F of bench-quality.
constexpr struct Parameters {
  double least_sigma = 0.7;  // grey levels. measured: rounding alone makes 0.3, compression more
  double noise_rate = 0.1;   // share by which the noise follows a frame's
  int noise_start = 8;       // frames for which D(k) stands in for frame - background
  int noise_samples = 40;    // pixels of a brightness from which its noise counts as measured
  int noise_age = 2;         // frames: younger pixels of the model are too noisy themselves
  int noise_step = 4;        // every so many pixels of every so many rows are sampled; all within 16 frames
  double mean_error = 0.8;   // derived: mean of |e| of normal noise of sigma 1

  // Registration error. Pixels; twice the mean error, since the tail counts, and twice that for a young model, which
  // has errors of its own.
  double tolerance_factor = 2, young_tolerance_factor = 4;
  double least_tolerance = 1, most_tolerance = 3;  // measured: interpolation and aliasing make a pixel
  double young_least_tolerance = 2, young_most_tolerance = 4;
  double regularisation = 400;  // squared doubled gradient, added to a block's sum
  double unreliable = 1.5;      // pixels of error beyond noise from which a block of the model is learnt anew
  double most_unreliable = 0.1;  // share of such blocks up to which the model fits the frame
  double blurred = 0.8;          // sharpness below which blur is the motion's, not the interpolation's
  int neighbours = 4;            // of nine pixels that must agree: single pixels are noise
  int closing = 9;               // pixels at 320 columns: side of the closing
  int margin = 3;                // pixels: side of the dilation of what is not learnt
} kParameters;

// Limits the ages of a block to kRelearn.
void relearn(MutableGrayView age, int left, int top) {
  const int columns = std::min(kBackgroundBlock, age.width - left),
            bottom = std::min(top + kBackgroundBlock, age.height);
  for (int y = top; y < bottom; ++y) {
    std::uint8_t* row = age.row(y) + left;
    for (int x = 0; x < columns; ++x) row[x] = std::min(row[x], kRelearn);
  }
}

// Clears the bits that the frame does not cover.
void clear_outside(MutableBitView bits, std::span<const RowSpan> spans) {
  for (int y = 0; y < bits.height; ++y) {
    const RowSpan span = spans[static_cast<std::size_t>(y)];
    clear_bits(bits.row(y), 0, span.begin);
    clear_bits(bits.row(y), span.end, 64 * bits.width);
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
    if (std::accumulate(counts_[k].begin(), counts_[k].end(), 0) < kParameters.noise_samples)
      return std::nullopt;
    return noise_sigma(counts_[k]);
  }

 private:
  static constexpr int kLevels = 64;
  // 32 bits: a sixteenth of 3840 x 2160 pixels may all be alike.
  std::array<std::array<std::uint32_t, kLevels>, kBrightness> counts_{};
};

// Noise of a single frame from that of a difference of two.
double frame_sigma(double difference_sigma) {
  return std::max(difference_sigma * std::sqrt(0.5), kParameters.least_sigma);
}

}  // namespace

void ForegroundClassification::preallocate(Size picture) {
  tolerance_.resize({picture.width, 1});
  for (auto* bits : {&weak_, &strong_}) bits->resize(bit_mask_size(picture));
  components_.preallocate(picture);
  blur_.preallocate(picture);
}

void ForegroundClassification::reset() {
  components_.reset();
}

void ForegroundClassification::classify(const ClassificationInput& in, MutableBitView mask,
                                        MutableBitView absorb) {
  measure_noise(in, mask);
  compare(in, mask);
  decide(in, mask, absorb);
}

// In the first frames the noise of the model and that of the frame cannot be separated in their difference. D(k) is
// used instead: sqrt(1/2) of its sigma, times sqrt(1 + 1 / age) for a mean of that many frames.
void ForegroundClassification::measure_noise(const ClassificationInput& in, BitView moved) {
  const Parameters& p = kParameters;
  const bool start = in.frames < p.noise_start;
  NoiseSamples samples;
  for (int y = 1 + in.frames % p.noise_step; y < in.frame.height; y += p.noise_step) {
    const RowSpan span = in.spans[static_cast<std::size_t>(y)];
    const std::uint8_t *f = in.frame.row(y), *b = in.background.row(y), *age = in.model.age.row(y);
    const std::uint64_t* now = moved.row(y);
    for (int x = span.begin + in.frames / p.noise_step % p.noise_step; x < span.end; x += p.noise_step) {
      if (start)
        samples.add(in.picture.at(x, y), in.difference.at(x, y));
      else if (age[x] > p.noise_age && !bit_at(now, x))
        samples.add(b[x], std::abs(f[x] - b[x]));
    }
  }
  const double young = std::sqrt(0.5) * std::sqrt(1 + 1.0 / std::max(in.frames - 1, 1));
  double darker = frame_sigma(in.sigma);
  for (int c = 0; c < kBrightness; ++c) {
    const auto measured = samples.sigma(c);
    if (start)
      noise_[c] = measured ? std::max(*measured * young, p.least_sigma) : darker;
    else if (measured)
      noise_[c] += p.noise_rate * (std::max(*measured, p.least_sigma) - noise_[c]);
    darker = noise_[c];  // a brightness without samples starts with the noise of the next darker one
  }
}

void ForegroundClassification::compare(const ClassificationInput& in, BitView moved) {
  CompareLimits limits;
  limits.registered = !in.still;
  for (int c = 0; c < kBrightness; ++c)
    limits.noise[c] = static_cast<std::uint8_t>(std::min(std::lround(16 * noise_[c]), 255L));
  unreliable_ = 0;
  CompareRow row;
  row.width = in.frame.width;
  row.ticks = in.frames % windows_.tick == 0;
  row.tolerance = tolerance_.view().data;
  if (in.still) std::fill_n(tolerance_.view().data, row.width, std::uint8_t{16});  // a pixel
  for (int y = 0; y < in.frame.height; ++y) {
    if (!in.still && y % kBackgroundBlock == 0) measure_tolerance(in, y / kBackgroundBlock);
    row.frame = in.frame.row(y);
    row.above = in.background.row(y - 1), row.background = in.background.row(y),
    row.below = in.background.row(y + 1);
    row.spread = in.model.spread.row(y), row.age = in.model.age.row(y);
    row.moved = moved.row(y), row.quiet = in.model.quiet.row(y);
    compare_row(row, limits, weak_.view().row(y), strong_.view().row(y));
  }
  clear_outside(weak_.view(), in.spans);
  clear_outside(strong_.view(), in.spans);
  if (!in.still && in.mechanisms.motion_blur) suppress_blur(in);
}

// The registration error around each block of a row: |e| over gradient where nothing moves, of 3 x 3 blocks. The part
// of it that noise does not explain decides whether the model is still valid there.
void ForegroundClassification::measure_tolerance(const ClassificationInput& in, int block_row) {
  const Parameters& p = kParameters;
  const bool unsettled = in.frames < kUnsettledFrames;
  const double noise = p.mean_error * frame_sigma(in.sigma);
  const int width = in.frame.width, top = block_row * kBackgroundBlock;
  for (int bx = 0; bx < in.columns; ++bx) {
    double ge = 0, gg = 0, n = 0;
    for (int v = std::max(block_row - 1, 0); v <= std::min(block_row + 1, in.rows - 1); ++v)
      for (int u = std::max(bx - 1, 0); u <= std::min(bx + 1, in.columns - 1); ++u) {
        const BlockSums& b = in.blocks[static_cast<std::size_t>(v) * in.columns + u];
        ge += b.ge;
        gg += b.gg;
        n += b.n;
      }
    // Gradients are doubled: |e| / g = 2 ge / gg.
    const double factor = unsettled ? p.young_tolerance_factor : p.tolerance_factor;
    const double error = std::clamp(factor * 2 * ge / (gg + p.regularisation),
                                    unsettled ? p.young_least_tolerance : p.least_tolerance,
                                    unsettled ? p.young_most_tolerance : p.most_tolerance);
    // sum of g <= sqrt(n x sum of g^2)
    const double beyond_noise =
        p.tolerance_factor * 2 * (ge - noise * std::sqrt(gg * n)) / (gg + p.regularisation);
    const int left = bx * kBackgroundBlock;
    if (beyond_noise > p.unreliable) {
      ++unreliable_;
      relearn(in.model.age, left, top);
    }
    std::fill_n(tolerance_.view().data + left, std::min(kBackgroundBlock, width - left),
                static_cast<std::uint8_t>(std::lround(16 * error)));
  }
}

// A camera that moves blurs its frames, a camera that shakes blurs some of them. The other way round, a young model may
// be made of blurred frames; an older one is softer than a frame for other reasons.
void ForegroundClassification::suppress_blur(const ClassificationInput& in) {
  const double sharpness = blur_.sharpness(in.frame, in.background, in.model.age, in.spans);
  const bool background_blurred = sharpness > 1 / kParameters.blurred && in.frames < kUnsettledFrames;
  if (sharpness >= kParameters.blurred && !background_blurred) return;
  constexpr CompareLimits limits;  // noise is what the comparison takes for noise
  std::array<std::uint8_t, kBrightness> tolerance;
  for (int c = 0; c < kBrightness; ++c)
    tolerance[c] = static_cast<std::uint8_t>(
        std::clamp(limits.weak_sigmas * noise_[c], limits.weak_least / 16.0, 255.0));
  const GrayView frame = in.frame, background = in.background;
  blur_.suppress(background_blurred ? background : frame, background_blurred ? frame : background, tolerance,
                 weak_.view(), strong_.view());
}

// mask := the components that are objects. weak_ := the pixels that must not be learnt.
void ForegroundClassification::decide(const ClassificationInput& in, MutableBitView mask,
                                      MutableBitView absorb) {
  const Parameters& p = kParameters;
  const int width = in.frame.width;
  const MutableBitView seeds = strong_.view();
  morphology_.vote(weak_.view(), width, p.neighbours);
  morphology_.vote(seeds, width, p.neighbours);
  morphology_.reconstruct(seeds, weak_.view());
  std::memcpy(weak_.view().data, seeds.data, weak_.bytes());
  ComponentInput planes{in.frame,     in.background,
                        in.model.age, in.model.quiet,
                        in.still,     !in.still && unreliable_ < p.most_unreliable * in.columns * in.rows,
                        in.spans};
  planes.mechanisms = in.mechanisms.components;
  const bool young = components_.classify(planes, windows_, seeds, absorb);
  const int side = std::max(3, p.closing * width / 320 | 1);
  std::memcpy(mask.data, seeds.data, strong_.bytes());
  const MutableBitView closed = strong_.view();
  morphology_.close(closed, width, side);
  clear_outside(closed, in.spans);
  unite(weak_.view(), closed, weak_.view());
  morphology_.dilate(weak_.view(), width, p.margin);
  if (young) components_.merge_neighbours(planes, windows_, closed, mask);
  components_.join_fragments(planes, closed, mask);
}

std::size_t ForegroundClassification::bytes() const {
  return tolerance_.bytes() + weak_.bytes() + strong_.bytes() + morphology_.bytes() + components_.bytes() +
         blur_.bytes();
}

}  // namespace cerberus::vision
