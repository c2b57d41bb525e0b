// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/background/background_model.h"

#include <algorithm>
#include <cmath>

#include "vision/background/alignment.h"
#include "vision/background/background_state.h"
#include "vision/image/blur.h"
#include "vision/image/mask.h"
#include "vision/image/rounding.h"
#include "vision/image/shift_content.h"

namespace cerberus::vision {
namespace {

// Pixels a corner may be off by turning and zooming before the memory is redrawn.
constexpr double kFarthest = 12;
constexpr double kRedo = 1;   // pixels: a smaller correction is used from the next frame on
constexpr int kStanding = 5;  // frames after which a standing camera's memory is redrawn to fit it exactly
constexpr double kUsualPeriod = 0.04;  // seconds, where nobody knows

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

}  // namespace

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
    for (auto* plane : {&spread, &age, &quiet, &present}) plane->resize(to);
    light.preallocate(to);
    tolerance.resize({to.width, 1});
    for (auto* bits : {&weak, &strong, &moved, &absorb}) bits->resize(bit_mask_size(to));
    valid.resize({bit_mask_size(to).width, 1});
    parts.preallocate(to);
    surroundings.preallocate(to);
    blur.preallocate(to);
    columns = (to.width + kBackgroundBlock - 1) / kBackgroundBlock;
    rows = (to.height + kBackgroundBlock - 1) / kBackgroundBlock;
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
void BackgroundModel::State::measure_time(double seconds) {
  if (!(seconds > 0)) seconds = period > 0 ? period : kUsualPeriod;
  period = period > 0 ? period + 0.1 * (seconds - period) : seconds;
  windows = ClassificationWindows::of(period);
}

// The memory goes along with the camera by whole pixels.
void BackgroundModel::State::follow(const BackgroundInput& in) {
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
void BackgroundModel::State::redraw() {
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

bool BackgroundModel::State::draw_present(const BackgroundInput& in, GrayView blurred) {
  if (!warp.prepare(to_frame.inverse(), size)) return false;
  if (warp.is_identity())
    blur3(in.picture, 3, present.view());
  else
    warp.bilinear(blurred, present.view());
  return true;
}

void BackgroundModel::State::measure_blocks() {
  const auto spans = warp.spans();
  BlockRows r{present.view(), light.known(), age.view(), quiet.view(), 0, 0, 2, 3};
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

// Registers the frame to the memory's content; leaves the block sums as they are after it.
void BackgroundModel::State::align(const BackgroundInput& in, GrayView blurred) {
  measure_blocks();
  const auto correction = align_to_background(blocks, columns, size);
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

// Before a camera that moves what is measured of the light is half errors of registration: better the frame as it is.
void BackgroundModel::State::learn(bool still) {
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

void BackgroundModel::update(const BackgroundInput& in, MutableGrayView mask) {
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

std::size_t BackgroundModel::bytes() const {
  const State& s = *state_;
  std::size_t total = sizeof(State) + s.mean.bytes() + s.tolerance.bytes() + s.morphology.bytes() +
                      s.parts.bytes() + s.surroundings.bytes() + s.warp.bytes() + s.light.bytes() +
                      s.blur.bytes();
  for (const auto* plane : {&s.spread, &s.age, &s.quiet, &s.present}) total += plane->bytes();
  for (const auto* bits : {&s.weak, &s.strong, &s.moved, &s.valid, &s.absorb}) total += bits->bytes();
  return total + s.blocks.capacity() * sizeof(BlockSums);
}

}  // namespace cerberus::vision
