// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/background/background_model.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "vision/background/alignment.h"
#include "vision/background/background_kernels.h"
#include "vision/background/background_light.h"
#include "vision/background/foreground_classification.h"
#include "vision/background/mosaic.h"
#include "vision/geometry/warp.h"
#include "vision/image/blur.h"
#include "vision/image/mask.h"
#include "vision/image/rounding.h"
#include "vision/image/shift_content.h"

namespace cerberus::vision {
namespace {

// Origin unknown where none is given: kept from the first version. Guard of all: mean F of bench-quality.
constexpr struct Parameters {
  double farthest = 12;  // pixels a corner may be off by rotation and zoom before the model is resampled
  double realign = 1;    // pixels: a smaller correction takes effect with the next frame
  double shift = 0.75;   // pixels the centre may be off before the model moves by whole pixels
  int standing = 5;      // frames after which the model of a standing camera is resampled to fit exactly
  double usual_period = 0.04;      // seconds from frame to frame where that is unknown
  double period_rate = 0.1;        // share by which the smoothed period follows a frame's
  int block_step = 2;              // every so many rows of a block are measured
  std::size_t most_excluded = 16;  // boxes that are excluded; the others are scene
  int block_quiet = 3;  // ticks without motion from which a pixel counts for the registration error
} kParameters;

// 64 bits of a row from x on, zeros outside the row.
std::uint64_t bits_from(const std::uint64_t* row, int words, int x) {
  const int word = x >> 6, part = x & 63;  // floor, also for negative x
  const std::uint64_t low = word >= 0 && word < words ? row[word] : 0;
  if (!part) return low;
  const std::uint64_t high = word + 1 >= 0 && word + 1 < words ? row[word + 1] : 0;
  return low >> part | high << (64 - part);
}

// out(q) := in(map q), to the nearest pixel, with one displacement for 32 x 8 pixels. The map is what a registration by
// whole pixels leaves, so small a rotation that this is exact to about half a pixel.
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

}  // namespace

struct BackgroundModel::State {
  Size size;
  int frames = 0;
  bool stood = false;  // the camera, in the last frame
  int standing = 0;    // frames the camera has stood while the model was not in the frame's coordinates
  double period = 0;   // seconds from frame to frame, smoothed
  Transform to_frame;  // model pixel to frame pixel
  Image<std::uint16_t> mean;
  Image<std::uint8_t> spread, age, quiet;
  Image<std::uint8_t> frame;  // F(k) in the model's coordinates, blurred
  BitMask mask;               // D(k) > Th in the model's coordinates, then the foreground
  BitMask absorb;             // pixels to be taken over at once
  BitMask covered;            // one row: the pixels that the frame shows
  ForegroundMechanisms mechanisms;
  Mosaic mosaic;
  Warp warp;
  BackgroundLight light;
  ForegroundClassification classification;
  int columns = 0, rows = 0;  // of blocks
  std::vector<BlockSums> blocks;
  struct Excluded {
    int left, top, right, bottom;
  };
  std::vector<Excluded> excluded;

  BackgroundPixels pixels() { return {mean.view(), spread.view(), age.view(), quiet.view()}; }
  void prepare(Size to);
  void restart();
  void measure_period(double seconds);
  void follow_camera(const BackgroundInput& in);
  void resample();
  bool warp_frame(const BackgroundInput& in, GrayView blurred);
  void exclude(std::span<const Box> boxes);
  template <typename Each>
  void for_excluded(int y, Each&& each) const;
  void measure_blocks();
  void align(const BackgroundInput& in, GrayView blurred);
  void classify(const BackgroundInput& in);
  void learn(const BackgroundInput& in);
};

BackgroundModel::BackgroundModel() : state_(std::make_unique<State>()) {}
BackgroundModel::~BackgroundModel() = default;
BackgroundModel::BackgroundModel(BackgroundModel&&) noexcept = default;
BackgroundModel& BackgroundModel::operator=(BackgroundModel&&) noexcept = default;

void BackgroundModel::reset() {
  state_->frames = 0;
}

void BackgroundModel::State::prepare(Size to) {
  if (to != size) {
    mean.resize(to);
    for (auto* plane : {&spread, &age, &quiet, &frame}) plane->resize(to);
    light.preallocate(to);
    for (auto* bits : {&mask, &absorb}) bits->resize(bit_mask_size(to));
    covered.resize({bit_mask_size(to).width, 1});
    classification.preallocate(to);
    mosaic.preallocate(to);
    columns = (to.width + kBackgroundBlock - 1) / kBackgroundBlock;
    rows = (to.height + kBackgroundBlock - 1) / kBackgroundBlock;
    blocks.assign(static_cast<std::size_t>(columns) * rows, {});
    excluded.reserve(kParameters.most_excluded);
    frames = 0;
    size = to;  // last: an allocation that threw is tried again with the next frame
  }
  if (frames == 0) {
    mean.fill_bytes(0);
    for (auto* plane : {&spread, &age, &quiet}) plane->fill_bytes(0);
    mosaic.reset(to);
    classification.reset();
    to_frame = {};
    light.reset();
  }
  ++frames;
}

void BackgroundModel::State::restart() {
  frames = 0;
  prepare(size);
}

// Frame rates vary and frames come late, so the period is smoothed.
void BackgroundModel::State::measure_period(double seconds) {
  if (!(seconds > 0)) seconds = period > 0 ? period : kParameters.usual_period;
  period = period > 0 ? period + kParameters.period_rate * (seconds - period) : seconds;
  classification.set_period(period);
}

// Moves the model with the camera by whole pixels.
void BackgroundModel::State::follow_camera(const BackgroundInput& in) {
  if (in.still && !to_frame.is_identity() && ++standing == kParameters.standing) resample();
  if (!in.still) standing = 0;
  if (in.still || frames == 1) return;
  to_frame = in.motion * to_frame;
  const Point centre{(size.width - 1) / 2.0, (size.height - 1) / 2.0};
  const Point seen = to_frame.apply(centre);
  const double tx = seen.x - centre.x, ty = seen.y - centre.y;
  if (!to_frame.is_sane(size) || std::abs(tx) > size.width || std::abs(ty) > size.height) return restart();
  if (std::abs(tx) > kParameters.shift || std::abs(ty) > kParameters.shift) {
    const int dx = static_cast<int>(std::lround(tx)), dy = static_cast<int>(std::lround(ty));
    const Transform shift = Transform::translation(dx, dy);
    if (mechanisms.mosaic) mosaic.store(pixels(), shift);
    shift_content<std::uint16_t>(mean.view(), dx, dy, 0);
    for (auto* plane : {&spread, &age, &quiet}) shift_content<std::uint8_t>(plane->view(), dx, dy, 0);
    mosaic.restore(pixels(), shift);
    to_frame = to_frame * Transform::translation(-dx, -dy);
  }
  if (to_frame.corner_motion(size) > kParameters.farthest) resample();
}

// Interpolates the model into the frame's own coordinates: only after much rotation or zoom.
void BackgroundModel::State::resample() {
  if (!warp.prepare(to_frame, size)) return restart();
  if (mechanisms.mosaic) mosaic.store(pixels(), to_frame);
  light.load(mean.view());
  warp.bilinear(light.background(), frame.view());
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      mean.view().at(x, y) = static_cast<std::uint16_t>(frame.view().at(x, y) << 8);
  for (auto* plane : {&spread, &age, &quiet}) {
    warp.nearest(plane->view(), frame.view());
    plane->swap(frame);
  }
  mosaic.restore(pixels(), to_frame);
  to_frame = {};
  standing = 0;
}

// What the frame excludes, in the model's coordinates.
void BackgroundModel::State::exclude(std::span<const Box> boxes) {
  excluded.clear();
  if (boxes.empty()) return;
  const Transform to_model = to_frame.inverse();
  for (const Box& b : boxes.first(std::min(boxes.size(), excluded.capacity()))) {
    const Point first = to_model.apply({b.x, b.y}), last = to_model.apply({b.right() - 1, b.bottom() - 1});
    const auto from = [](double a, double c) {
      return std::max(static_cast<int>(std::floor(std::min(a, c))), 0);
    };
    const auto end = [](double a, double c, int most) {
      return std::min(static_cast<int>(std::ceil(std::max(a, c))) + 1, most);
    };
    excluded.push_back({from(first.x, last.x), from(first.y, last.y), end(first.x, last.x, size.width),
                        end(first.y, last.y, size.height)});
  }
}

// Calls each(left, right) with the columns of a row of the model that are excluded.
template <typename Each>
void BackgroundModel::State::for_excluded(int y, Each&& each) const {
  for (const Excluded& e : excluded)
    if (y >= e.top && y < e.bottom && e.left < e.right) each(e.left, e.right);
}

// frame := F(k) in the model's coordinates, and the background where it is excluded. False for a perspective whose inverse is not sane.
bool BackgroundModel::State::warp_frame(const BackgroundInput& in, GrayView blurred) {
  if (!warp.prepare(to_frame.inverse(), size)) return false;
  if (warp.is_identity())
    blur3(in.picture, 3, frame.view());
  else
    warp.bilinear(blurred, frame.view());
  exclude(in.excluded);
  for (int y = 0; y < size.height; ++y)
    for_excluded(y, [&](int left, int right) {
      std::copy(light.background().row(y) + left, light.background().row(y) + right,
                frame.view().row(y) + left);
    });
  return true;
}

void BackgroundModel::State::measure_blocks() {
  const auto spans = warp.spans();
  BlockRows r{frame.view(),           light.background(),     age.view(), quiet.view(), 0, 0,
              kParameters.block_step, kParameters.block_quiet};
  for (int by = 0; by < rows; ++by) {
    r.first = std::max(by * kBackgroundBlock, 1);
    r.end = std::min((by + 1) * kBackgroundBlock, size.height - 1);
    // The columns that all rows of the block have (spans bend little within 16 rows).
    int begin = 1, end = size.width - 1;
    for (int y = r.first; y < r.end; y += r.step) {
      begin = std::max(begin, spans[static_cast<std::size_t>(y)].begin);
      end = std::min(end, spans[static_cast<std::size_t>(y)].end);
    }
    for (int bx = 0; bx < columns; ++bx)
      blocks[static_cast<std::size_t>(by) * columns + bx] = block_sums(r, bx * kBackgroundBlock, begin, end);
  }
}

// Registers the frame to the model's content. The block sums are those after registration.
void BackgroundModel::State::align(const BackgroundInput& in, GrayView blurred) {
  measure_blocks();
  const auto correction = align_to_background(blocks, columns, size);
  if (!correction) return;
  const Transform before = to_frame;
  to_frame = to_frame * *correction;
  if (correction->corner_motion(size) < kParameters.realign) return;
  if (!to_frame.is_sane(size) || !warp_frame(in, blurred)) {
    to_frame = before;
    warp_frame(in, blurred);
  }
  measure_blocks();
}

void BackgroundModel::State::classify(const BackgroundInput& in) {
  ClassificationInput input;
  input.picture = in.picture, input.difference = in.difference;
  input.sigma = in.sigma, input.still = in.still, input.frames = frames;
  input.frame = frame.view(), input.background = light.background(), input.model = pixels();
  input.spans = warp.spans(), input.mechanisms = mechanisms;
  input.blocks = blocks, input.columns = columns, input.rows = rows;
  classification.classify(input, mask.view(), absorb.view());
}

// The model keeps the light that it was learnt in, but for a moving camera the measured change of light is half
// registration error, and the frame is learnt as it is.
void BackgroundModel::State::learn(const BackgroundInput& in) {
  LearnRow row;
  row.width = size.width;
  row.phase = frames % 2 ? 15 : 0;
  row.tick = std::min(classification.tick(), 128);
  row.valid = covered.view().data;
  for (int y = 0; y < size.height; ++y) {
    row.frame = frame.view().row(y), row.background = light.background().row(y),
    row.quiet = quiet.view().row(y);
    row.taken = in.still ? light.in_background_light(y, row.frame) : row.frame;
    row.keep = classification.foreground().row(y), row.absorb = absorb.view().row(y);
    const RowSpan span = warp.spans()[static_cast<std::size_t>(y)];
    covered.fill_bytes(0);
    set_bits(covered.view().data, span.begin, span.end);
    for_excluded(y, [&](int left, int right) { clear_bits(covered.view().data, left, right); });
    row.mean = mean.view().row(y), row.spread = spread.view().row(y), row.age = age.view().row(y);
    learn_row(row);
  }
}

void BackgroundModel::update(const BackgroundInput& in, MutableGrayView mask) {
  State& s = *state_;
  s.prepare(mask.size());
  s.mechanisms = in.mechanisms;
  s.stood = in.still;
  s.measure_period(in.seconds);
  const bool other_light = !in.still && s.light.is_different();
  if (other_light) s.light.adopt(s.pixels(), s.mosaic);
  s.follow_camera(in);
  const GrayView blurred = mask;
  if (!in.still || !s.to_frame.is_identity()) blur3(in.picture, 3, mask);
  s.light.load(s.mean.view());
  if (!s.warp_frame(in, blurred)) {
    s.frames = 0;
    for (int y = 0; y < mask.height; ++y) std::fill_n(mask.row(y), mask.width, std::uint8_t{0});
    return;
  }
  if (!in.still && s.frames > 1) {
    // Lamps may light the frame in bands, which adopt() does not remove; they would bias the alignment.
    if (other_light) s.light.relight_rows(s.frame.view(), s.warp.spans());
    if (s.mechanisms.alignment) s.align(in, blurred);
    if (other_light) s.light.load(s.mean.view());
  }
  const bool step = s.frames > 1 && s.mechanisms.light &&
                    s.light.compensate(s.pixels(), s.mosaic, s.frame.view(), s.warp.spans(), in.still);
  s.mosaic.verify(s.pixels(), s.frame.view(), s.light.background(), s.warp.spans());
  if (s.warp.is_identity()) {
    binarise(in.difference, in.threshold, s.mask.view());
  } else {
    binarise(in.difference, in.threshold, s.absorb.view());
    map_bits(s.absorb.view(), s.to_frame, s.mask.view(), s.size.width);
  }
  for (int y = 0; y < s.size.height; ++y)
    s.for_excluded(y, [&](int left, int right) { clear_bits(s.mask.view().row(y), left, right); });
  if (step && in.still)
    s.light.suppress_step(s.pixels(), s.frame.view(), s.classification.foreground(), s.classification.noise(),
                          s.mask.view());
  s.classify(in);
  s.learn(in);
  if (s.to_frame.is_identity()) {
    unpack(s.mask.view(), mask);
  } else {
    map_bits(s.mask.view(), s.to_frame.inverse(), s.absorb.view(), s.size.width);
    unpack(s.absorb.view(), mask);
  }
}

GrayView BackgroundModel::background() const {
  State& s = *state_;
  return s.frames > 1 && s.stood && s.to_frame.is_identity() ? GrayView(s.light.background()) : GrayView{};
}

std::size_t BackgroundModel::bytes() const {
  const State& s = *state_;
  std::size_t total = sizeof(State) + s.mean.bytes() + s.classification.bytes() + s.mosaic.bytes() +
                      s.warp.bytes() + s.light.bytes();
  for (const auto* plane : {&s.spread, &s.age, &s.quiet, &s.frame}) total += plane->bytes();
  for (const auto* bits : {&s.mask, &s.covered, &s.absorb}) total += bits->bytes();
  return total + s.blocks.capacity() * sizeof(BlockSums);
}

}  // namespace cerberus::vision
