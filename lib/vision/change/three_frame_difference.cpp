// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/change/three_frame_difference.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "vision/change/difference_kernels.h"
#include "vision/change/light.h"
#include "vision/geometry/warp.h"
#include "vision/image/blur.h"

namespace cerberus::vision {

namespace {

RowSpan both(RowSpan a, RowSpan b) {
  const RowSpan s{std::max(a.begin, b.begin), std::min(a.end, b.end)};
  return s.begin < s.end ? s : RowSpan{};
}

void clear_outside(RowSpan span, std::uint8_t* row, int width) {
  std::fill(row, row + span.begin, std::uint8_t{0});
  std::fill(row + span.end, row + width, std::uint8_t{0});
}

}  // namespace

struct ThreeFrameDifference::State {
  DifferenceOptions options;
  Size size;
  int frames = 0;  // of this scene, at most 3
  // Blurred pictures, [0] of the newest frame; never an old difference. Between two frames there are two of them: when
  // frame k comes, D(k-1) is made first, and F(k) takes the place of F(k-2). Without D(k-1) the second one is empty.
  std::array<Image<std::uint8_t>, 2> ring;
  bool has_older = false;  // of them is ring[1]
  Transform before;        // frame k-2 to k-1
  Warp warp;
  LightSamples samples;
  LightChange light, light_before;
  Image<std::uint8_t> relit;  // a row
  Image<std::uint8_t> near;   // three rows of F(k-1) around a row, relit, with a pixel more on either side
  std::vector<RowSpan> spans;

  void preallocate(Size to, bool both);
  void take(GrayView picture) {
    has_older = !ring[1].empty();
    if (has_older) std::swap(ring[0], ring[1]);
    blur3(picture, options.blur, ring[0].view());
  }
  void subtract_before(GrayView first, GrayView second, MutableGrayView previous);
  void load_near(GrayView first, GrayView present, int y);
  const std::uint8_t* near_row(int y) const { return near.view().row(y % 3) + 1; }
  void forget() {
    frames = 0;
    before = {};
    light.clear();
    light_before.clear();
  }
};

void ThreeFrameDifference::State::preallocate(Size to, bool both) {
  if (to != size) {
    ring[0].resize(to);
    ring[1] = {};
    relit.resize({to.width, 1});
    near.resize({to.width + 2, 3});
    spans.assign(static_cast<std::size_t>(to.height), {});
    forget();
    size = to;  // assigned last: after a failed allocation the next frame tries again
  }
  if (both == !ring[1].empty()) return;
  ring[1] = both ? Image<std::uint8_t>(to) : Image<std::uint8_t>();
  has_older = false;
}

// previous := D(k-1) of both pictures where frame k covers them, with the light that was estimated in frame k-1.
void ThreeFrameDifference::State::subtract_before(GrayView first, GrayView second, MutableGrayView previous) {
  for (int y = 0; y < size.height; ++y) {
    const RowSpan span = spans[static_cast<std::size_t>(y)];
    const int count = span.end - span.begin;
    std::uint8_t* row = previous.row(y);
    const std::uint8_t* f2 = second.row(y) + span.begin;
    if (!light_before.none()) {
      light_before.relight(f2, first.row(y) + span.begin, y, count, relit.view().data);
      f2 = relit.view().data;
    }
    difference_row(first.row(y) + span.begin, f2, count, row + span.begin);
    clear_outside(span, row, size.width);
  }
}

// Stores a row of F(k-1) in `near`; what it does not cover continues its first and last pixel.
void ThreeFrameDifference::State::load_near(GrayView first, GrayView present, int y) {
  const RowSpan span = spans[static_cast<std::size_t>(y)];
  if (span.begin >= span.end) return;
  std::uint8_t* row = near.view().row(y % 3) + 1;
  const int count = span.end - span.begin;
  if (light.none())
    std::copy_n(first.row(y) + span.begin, count, row + span.begin);
  else
    light.relight(first.row(y) + span.begin, present.row(y) + span.begin, y, count, row + span.begin);
  std::fill(row - 1, row + span.begin, row[span.begin]);
  std::fill(row + span.end, row + size.width + 1, row[span.end - 1]);
}

ThreeFrameDifference::ThreeFrameDifference() : state_(std::make_unique<State>()) {}
ThreeFrameDifference::~ThreeFrameDifference() = default;
ThreeFrameDifference::ThreeFrameDifference(ThreeFrameDifference&&) noexcept = default;
ThreeFrameDifference& ThreeFrameDifference::operator=(ThreeFrameDifference&&) noexcept = default;

void ThreeFrameDifference::set_options(const DifferenceOptions& options) {
  if (options.blur != state_->options.blur) state_->forget();
  state_->options = options;
}

void ThreeFrameDifference::reset() {
  state_->forget();
}

DifferenceResult ThreeFrameDifference::update(GrayView picture, const Transform& motion,
                                              MutableGrayView current, MutableGrayView previous,
                                              MutableGrayView tolerant, Histogram& histogram) {
  State& s = *state_;
  const Size size = picture.size();
  const std::size_t height = static_cast<std::size_t>(size.height);
  const bool both_wanted = !previous.empty();
  s.preallocate(size, both_wanted);
  histogram.fill(0);
  DifferenceResult result;
  if (picture.empty()) return result;

  s.frames = std::min(s.frames + 1, 3);
  result.frames = s.frames;
  const auto covered = [&](int y) {
    const RowSpan span = s.spans[static_cast<std::size_t>(y)];
    return span.begin < span.end;
  };
  const auto clear = [&](MutableGrayView v) {
    for (int y = 0; y < v.height; ++y) std::fill_n(v.row(y), v.width, std::uint8_t{0});
  };
  if (s.frames < 2 || !s.warp.prepare(motion, size)) {
    s.take(picture);
    clear(current);
    clear(previous);
    clear(tolerant);
    s.before = motion;
    if (s.frames > 1) {  // the camera's motion is invalid: the history is discarded
      s.forget();
      s.frames = 1;
    }
    result.frames = s.frames;
    return result;
  }
  // Both previous pictures in the coordinates of frame k; the outputs hold them until the differences overwrite them.
  GrayView first = s.ring[0].view(), second = s.ring[1].view();
  std::ranges::copy(s.warp.spans(), s.spans.begin());
  const bool still = s.warp.is_identity();
  if (!still) {
    s.warp.bilinear(first, current);
    first = current;
  }
  const bool three = s.frames == 3 && s.warp.prepare(motion * s.before, size);
  if (three) {
    for (std::size_t y = 0; y < height; ++y) s.spans[y] = both(s.spans[y], s.warp.spans()[y]);
    result.previous = s.has_older;
    if (result.previous && !s.warp.is_identity()) {
      s.warp.bilinear(second, previous);
      second = previous;
    }
  }
  if (both_wanted) std::swap(s.light, s.light_before);
  if (result.previous)
    s.subtract_before(first, second, previous);
  else
    clear(previous);
  // F(k-1) is in `current` if it was warped. Otherwise its only copy may be where F(k) is stored, and F(k) is stored
  // later.
  const bool waits = still && !both_wanted;
  if (waits)
    blur3(picture, s.options.blur, current);
  else
    s.take(picture);
  const GrayView present = waits ? GrayView(current) : s.ring[0].view();
  if (s.options.compensate_light) {
    s.samples.take(first, present, s.spans);
    s.light.estimate(s.samples, still);
  } else {
    s.light.clear();
  }

  LevelCounter counter;
  if (!tolerant.empty()) s.load_near(first, present, 0);
  for (int y = 0; y < size.height; ++y) {
    const RowSpan span = s.spans[static_cast<std::size_t>(y)];
    const int count = span.end - span.begin;
    std::uint8_t* row = current.row(y);
    const std::uint8_t *f = s.ring[0].view().row(y) + span.begin, *f1 = first.row(y) + span.begin;
    std::uint8_t* relit = s.relit.view().data;
    if (!tolerant.empty()) {
      if (y + 1 < size.height) s.load_near(first, present, y + 1);
      f1 = s.near_row(y) + span.begin;
    } else if (!s.light.none())
      s.light.relight(f1, present.row(y) + span.begin, y, count, relit), f1 = relit;
    else if (waits)
      f1 = std::copy_n(f1, count, relit) - count;
    if (waits) std::copy_n(row, size.width, s.ring[0].view().row(y));
    difference_row(f, f1, count, row + span.begin);
    counter.add(row + span.begin, count);
    clear_outside(span, row, size.width);
    if (!tolerant.empty()) {
      const auto beside = [&](int v) {
        return s.near_row(v >= 0 && v < size.height && covered(v) ? v : y) + span.begin;
      };
      tolerant_difference_row(f, beside(y - 1), f1, beside(y + 1), count, tolerant.row(y) + span.begin);
      clear_outside(span, tolerant.row(y), size.width);
    }
    result.valid += static_cast<std::uint32_t>(count);
  }
  counter.store(histogram);
  s.before = motion;
  result.gain = s.light.gain();
  result.offset = s.light.offset();
  return result;
}

std::size_t ThreeFrameDifference::bytes() const {
  const State& s = *state_;
  return s.ring[0].bytes() + s.ring[1].bytes() + s.relit.bytes() + s.near.bytes() + s.warp.bytes() +
         s.samples.bytes() + s.light.bytes() + s.light_before.bytes() + s.spans.capacity() * sizeof(RowSpan) +
         sizeof(State);
}

}  // namespace cerberus::vision
