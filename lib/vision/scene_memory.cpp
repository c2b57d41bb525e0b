// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/scene_memory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <optional>
#include <vector>

#include "vision/blur.h"
#include "vision/mask.h"
#include "vision/median.h"
#include "vision/morphology.h"
#include "vision/motion_blur.h"
#include "vision/rounding.h"
#include "vision/scene_alignment.h"
#include "vision/scene_kernels.h"
#include "vision/scene_light.h"
#include "vision/scene_parts.h"
#include "vision/scene_surroundings.h"
#include "vision/shift_content.h"
#include "vision/warp.h"

namespace cerberus::vision {
namespace {

// Pixels a corner may be off by turning and zooming before the memory is redrawn.
constexpr double kFarthest = 12;
constexpr double kRedo = 1;   // pixels: a smaller correction is used from the next frame on
constexpr int kStanding = 5;  // frames after which a standing camera's memory is redrawn to fit it exactly
constexpr double kLeastSigma = 0.7;      // grey levels: rounding alone makes 0.3, compression more
constexpr int kClosing = 9;              // side of the closing at 320 columns
constexpr double kUsualPeriod = 0.04;    // seconds, where nobody knows
constexpr double kUnreliable = 1.5;      // pixels of registration error above which the memory is learnt anew
constexpr double kMostUnreliable = 0.1;  // share of the blocks up to which a memory fits the frame
constexpr int kUnsettled = 12;           // frames in which a memory still has its own errors of registration
constexpr double kBlurred = 0.8;  // sharpness from which on blur is the motion's, not the interpolation's

// 64 bits of a row from x on, zeros outside the row.
std::uint64_t bits_from(const std::uint64_t* row, int words, int x) {
  const int word = x >> 6, part = x & 63;  // floor, also for negative x
  const std::uint64_t low = word >= 0 && word < words ? row[word] : 0;
  if (!part) return low;
  const std::uint64_t high = word + 1 >= 0 && word + 1 < words ? row[word + 1] : 0;
  return low >> part | high << (64 - part);
}

// out(q) := in(map q), to the nearest pixel, with one displacement for 32 x 8 pixels: what is left of a registration by
// whole pixels turns so little that this is exact to about half a pixel.
void map_bits(BitView in, const Transform& map, MutableBitView out, int width) {
  constexpr double kFar = 1 << 20;  // beyond every picture, where a perspective may point
  for (int y0 = 0; y0 < out.height; y0 += 8)
    for (int x0 = 0; x0 < out.width * 64; x0 += 32) {
      const Point q{x0 + 15.5, y0 + 3.5}, p = map.apply(q);
      const int dx = round_to_int(std::clamp(p.x - q.x, -kFar, kFar)),
                dy = round_to_int(std::clamp(p.y - q.y, -kFar, kFar));
      for (int y = y0; y < std::min(y0 + 8, out.height); ++y) {
        const int from = y + dy;
        const std::uint64_t half =
            from >= 0 && from < in.height ? bits_from(in.row(from), in.width, x0 + dx) & 0xffffffffu : 0;
        std::uint64_t& word = out.row(y)[x0 / 64];
        word = x0 % 64 ? word | half << 32 : half;
      }
    }
  for (int y = 0; y < out.height; ++y) out.row(y)[out.width - 1] &= last_word_bits(width);
}

// A block's ages, at most kRelearn.
void relearn(MutableGrayView age, int left, int top) {
  const int columns = std::min(kSceneBlock, age.width - left),
            bottom = std::min(top + kSceneBlock, age.height);
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

struct SceneMemory::State {
  Size size;
  int frames = 0;
  int standing = 0;    // frames the camera has stood while the memory was not in the frame's coordinates
  Transform to_frame;  // memory pixel -> frame pixel
  Image<std::uint16_t> mean;
  Image<std::uint8_t> spread, age, quiet;
  Image<std::uint8_t> present;    // the frame in memory coordinates, blurred
  Image<std::uint8_t> tolerance;  // one row of blocks, per pixel
  BitMask weak, strong, moved, absorb;
  BitMask valid;  // one row
  Morphology morphology;
  SceneParts parts;
  SceneSurroundings surroundings;
  SceneWindows windows;
  int unreliable = 0;  // blocks of this frame that the memory does not fit
  double period = 0;   // seconds from frame to frame, smoothed
  Warp warp;
  SceneLight light;
  MotionBlur blur;
  int columns = 0, rows = 0;  // of blocks
  std::vector<BlockSums> blocks;
  std::array<double, kBrightness> sigma{};  // of frame - memory by brightness, grey levels

  void prepare(Size to);
  void measure_time(double seconds);
  void follow(const SceneMemoryInput& in);
  void redraw();
  // The mask before it is closed: who makes regions of it needs the gaps between people. What moved is not needed any
  // more once the frame is compared.
  MutableBitView plain() { return moved.view(); }
  ScenePixels pixels() { return {mean.view(), spread.view(), age.view(), quiet.view()}; }
  bool draw_present(const SceneMemoryInput& in, GrayView blurred);
  void measure_blocks();
  void align(const SceneMemoryInput& in, GrayView blurred);
  void learn_noise(const SceneMemoryInput& in);
  void leave_valid(MutableBitView bits) const;
  void compare(const SceneMemoryInput& in);
  void forgive_blur();
  void decide(const SceneMemoryInput& in);
  void learn(bool still);
};

SceneMemory::SceneMemory() : state_(std::make_unique<State>()) {}
SceneMemory::~SceneMemory() = default;
SceneMemory::SceneMemory(SceneMemory&&) noexcept = default;
SceneMemory& SceneMemory::operator=(SceneMemory&&) noexcept = default;

void SceneMemory::reset() {
  state_->frames = 0;
}

void SceneMemory::State::prepare(Size to) {
  if (to != size) {
    mean.resize(to);
    for (auto* plane : {&spread, &age, &quiet, &present}) plane->resize(to);
    light.make_room(to);
    tolerance.resize({to.width, 1});
    for (auto* bits : {&weak, &strong, &moved, &absorb}) bits->resize(bit_mask_size(to));
    valid.resize({bit_mask_size(to).width, 1});
    parts.make_room(to);
    surroundings.make_room(to);
    blur.make_room(to);
    columns = (to.width + kSceneBlock - 1) / kSceneBlock;
    rows = (to.height + kSceneBlock - 1) / kSceneBlock;
    blocks.assign(static_cast<std::size_t>(columns) * rows, {});
    frames = 0;
    size = to;  // last: what threw is tried again
  }
  if (frames == 0) {
    mean.fill_bytes(0);
    for (auto* plane : {&spread, &age, &quiet}) plane->fill_bytes(0);
    surroundings.begin(to);
    parts.begin();
    to_frame = {};
    light.begin();
  }
  ++frames;
}

// Frame rates vary, and frames come late: the usual time between them counts.
void SceneMemory::State::measure_time(double seconds) {
  if (!(seconds > 0)) seconds = period > 0 ? period : kUsualPeriod;
  period = period > 0 ? period + 0.1 * (seconds - period) : seconds;
  windows = SceneWindows::of(period);
}

// The memory goes along with the camera by whole pixels.
void SceneMemory::State::follow(const SceneMemoryInput& in) {
  if (in.still && !to_frame.is_identity() && ++standing == kStanding) redraw();
  if (!in.still) standing = 0;
  if (in.still || frames == 1) return;
  to_frame = in.motion * to_frame;
  const Point centre{(size.width - 1) / 2.0, (size.height - 1) / 2.0};
  const Point seen = to_frame.apply(centre);
  const double tx = seen.x - centre.x, ty = seen.y - centre.y;
  if (!to_frame.is_sane(size) || std::abs(tx) > size.width || std::abs(ty) > size.height) {
    frames = 0;
    prepare(size);
    return;
  }
  if (std::abs(tx) > 0.75 || std::abs(ty) > 0.75) {
    const int dx = static_cast<int>(std::lround(tx)), dy = static_cast<int>(std::lround(ty));
    const Transform shift = Transform::translation(dx, dy);
    surroundings.keep(pixels(), shift);
    shift_content<std::uint16_t>(mean.view(), dx, dy, 0);
    for (auto* plane : {&spread, &age, &quiet}) shift_content<std::uint8_t>(plane->view(), dx, dy, 0);
    surroundings.recall(pixels(), shift);
    to_frame = to_frame * Transform::translation(-dx, -dy);
  }
  if (to_frame.corner_motion(size) > kFarthest) redraw();
}

// The memory in the frame's own coordinates, by interpolation: only after much turning or zooming.
void SceneMemory::State::redraw() {
  if (!warp.prepare(to_frame, size)) {
    frames = 0;
    prepare(size);
    return;
  }
  surroundings.keep(pixels(), to_frame);
  light.draw(mean.view());
  warp.bilinear(light.known(), present.view());
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      mean.view().at(x, y) = static_cast<std::uint16_t>(present.view().at(x, y) << 8);
  for (auto* plane : {&spread, &age, &quiet}) {
    warp.nearest(plane->view(), present.view());
    plane->swap(present);
  }
  surroundings.recall(pixels(), to_frame);
  to_frame = {};
  standing = 0;
}

bool SceneMemory::State::draw_present(const SceneMemoryInput& in, GrayView blurred) {
  if (!warp.prepare(to_frame.inverse(), size)) return false;
  if (warp.is_identity())
    blur3(in.picture, 3, present.view());
  else
    warp.bilinear(blurred, present.view());
  return true;
}

void SceneMemory::State::measure_blocks() {
  const auto spans = warp.spans();
  BlockRows r{present.view(), light.known(), age.view(), quiet.view(), 0, 0, 2, 3};
  for (int by = 0; by < rows; ++by) {
    r.first = std::max(by * kSceneBlock, 1);
    r.end = std::min((by + 1) * kSceneBlock, size.height - 1);
    // The columns that all rows of the block have (spans bend little within 16 rows).
    int begin = 1, end = size.width - 1;
    for (int y = r.first; y < r.end; y += r.step) {
      begin = std::max(begin, spans[static_cast<std::size_t>(y)].begin);
      end = std::min(end, spans[static_cast<std::size_t>(y)].end);
    }
    for (int bx = 0; bx < columns; ++bx)
      blocks[static_cast<std::size_t>(by) * columns + bx] = block_sums(r, bx * kSceneBlock, begin, end);
  }
}

// Registers the frame to the memory's content; leaves the block sums as they are after it.
void SceneMemory::State::align(const SceneMemoryInput& in, GrayView blurred) {
  measure_blocks();
  const auto correction = align_to_memory(blocks, columns, size);
  if (!correction) return;
  const Transform before = to_frame;
  to_frame = to_frame * *correction;
  if (correction->corner_motion(size) < kRedo) return;
  if (!to_frame.is_sane(size) || !draw_present(in, blurred)) {
    to_frame = before;
    draw_present(in, blurred);
  }
  measure_blocks();
}

// sigma of frame - memory by brightness. While the memory is young its own noise and the frame's cannot be told apart
// there, and D(k) stands in: sqrt(1/2) of its sigma, times sqrt(1 + 1 / age) for a mean of that many frames.
void SceneMemory::State::learn_noise(const SceneMemoryInput& in) {
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
void SceneMemory::State::leave_valid(MutableBitView bits) const {
  for (int y = 0; y < bits.height; ++y) {
    const RowSpan span = warp.spans()[static_cast<std::size_t>(y)];
    clear_bits(bits.row(y), 0, span.begin);
    clear_bits(bits.row(y), span.end, 64 * bits.width);
  }
}

void SceneMemory::State::compare(const SceneMemoryInput& in) {
  CompareLimits limits;
  limits.registered = !in.still;
  for (int c = 0; c < kBrightness; ++c)
    limits.noise[c] = static_cast<std::uint8_t>(std::min(std::lround(16 * sigma[c]), 255L));
  // Mean of |e| of normal noise: 0.8 sigma.
  const double noise = 0.8 * std::max(in.sigma * std::sqrt(0.5), kLeastSigma);
  const bool unsettled = frames < kUnsettled;
  unreliable = 0;
  const auto k = light.known();
  CompareRow row;
  row.width = size.width;
  row.tolerance = tolerance.view().data;
  for (int y = 0; y < size.height; ++y) {
    const int by = y / kSceneBlock;
    if (in.still && y == 0) {
      std::fill_n(tolerance.view().data, size.width, std::uint8_t{16});  // a pixel
    } else if (!in.still && y % kSceneBlock == 0) {
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
          relearn(age.view(), bx * kSceneBlock, y);
        }
        std::fill_n(tolerance.view().data + bx * kSceneBlock,
                    std::min(kSceneBlock, size.width - bx * kSceneBlock),
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
void SceneMemory::State::forgive_blur() {
  const GrayView frame = present.view(), memory = light.known();
  const double sharpness = blur.sharpness(frame, memory, age.view(), warp.spans());
  const bool memory_blurred = sharpness > 1 / kBlurred && frames < kUnsettled;
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
void SceneMemory::State::decide(const SceneMemoryInput& in) {
  const int w = size.width;
  const MutableBitView seeds = strong.view();
  morphology.vote(weak.view(), w, 4);  // four of nine: noise is lonely
  morphology.vote(seeds, w, 4);
  morphology.reconstruct(seeds, weak.view());
  std::memcpy(weak.view().data, seeds.data, weak.bytes());
  const ScenePlanes planes{present.view(), light.known(),
                           age.view(),     quiet.view(),
                           in.still,       !in.still && unreliable < kMostUnreliable * columns * rows,
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

// Before a camera that moves what is measured of the light is half errors of registration: better the frame as it is.
void SceneMemory::State::learn(bool still) {
  LearnRow row;
  row.width = size.width;
  row.phase = frames % 2 ? 15 : 0;
  row.valid = valid.view().data;
  for (int y = 0; y < size.height; ++y) {
    row.present = present.view().row(y), row.memory = light.known().row(y), row.quiet = quiet.view().row(y);
    row.taken = still ? light.remembered(y, row.present) : row.present;
    row.keep = weak.view().row(y), row.absorb = absorb.view().row(y);
    const RowSpan span = warp.spans()[static_cast<std::size_t>(y)];
    valid.fill_bytes(0);
    set_bits(valid.view().data, span.begin, span.end);
    row.mean = mean.view().row(y), row.spread = spread.view().row(y), row.age = age.view().row(y);
    learn_row(row);
  }
}

void SceneMemory::update(const SceneMemoryInput& in, MutableGrayView mask) {
  State& s = *state_;
  s.prepare(mask.size());
  s.measure_time(in.seconds);
  const bool other_light = !in.still && s.light.is_other();
  if (other_light) s.light.adopt(s.pixels(), s.surroundings);
  s.follow(in);
  GrayView blurred = mask;
  if (!in.still || !s.to_frame.is_identity()) blur3(in.picture, 3, mask);
  s.light.draw(s.mean.view());
  // False for a perspective whose inverse is beyond reason. The mask holds the blurred picture then.
  if (!s.draw_present(in, blurred)) {
    s.frames = 0;
    for (int y = 0; y < mask.height; ++y) std::fill_n(mask.row(y), mask.width, std::uint8_t{0});
    return;
  }
  if (!in.still && s.frames > 1) {
    // Lamps' light may be in bands, which no adopting takes away; they would pull at the alignment.
    if (other_light) s.light.relight_rows(s.present.view(), s.warp.spans());
    s.align(in, blurred);
    if (other_light) s.light.draw(s.mean.view());
  }
  const bool step = s.frames > 1 && s.light.compensate(s.pixels(), s.surroundings, s.present.view(),
                                                       s.warp.spans(), in.still);
  s.surroundings.doubt(s.pixels(), s.present.view(), s.light.known(), s.warp.spans());
  if (s.warp.is_identity()) {
    binarise(in.difference, in.threshold, s.moved.view());
  } else {
    binarise(in.difference, in.threshold, s.absorb.view());
    map_bits(s.absorb.view(), s.to_frame, s.moved.view(), s.size.width);
  }
  if (step && in.still)
    s.light.forgive_step(s.pixels(), s.present.view(), s.weak.view(), s.sigma, s.moved.view());
  s.learn_noise(in);
  s.compare(in);
  s.decide(in);
  s.learn(in.still);
  if (s.to_frame.is_identity()) {
    unpack(s.plain(), mask);
  } else {
    map_bits(s.plain(), s.to_frame.inverse(), s.absorb.view(), s.size.width);
    unpack(s.absorb.view(), mask);
  }
}

std::size_t SceneMemory::bytes() const {
  const State& s = *state_;
  std::size_t total = sizeof(State) + s.mean.bytes() + s.tolerance.bytes() + s.morphology.bytes() +
                      s.parts.bytes() + s.surroundings.bytes() + s.warp.bytes() + s.light.bytes() +
                      s.blur.bytes();
  for (const auto* plane : {&s.spread, &s.age, &s.quiet, &s.present}) total += plane->bytes();
  for (const auto* bits : {&s.weak, &s.strong, &s.moved, &s.valid, &s.absorb}) total += bits->bytes();
  return total + s.blocks.capacity() * sizeof(BlockSums);
}

}  // namespace cerberus::vision
