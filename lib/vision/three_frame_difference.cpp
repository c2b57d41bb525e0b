// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/three_frame_difference.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "vision/blur.h"
#include "vision/difference_kernels.h"
#include "vision/light.h"
#include "vision/warp.h"

namespace cerberus::vision {

namespace {

RowSpan both(RowSpan a, RowSpan b) {
  const RowSpan s{std::max(a.begin, b.begin), std::min(a.end, b.end)};
  return s.begin < s.end ? s : RowSpan{};
}

}  // namespace

struct ThreeFrameDifference::State {
  DifferenceOptions options;
  Size size;
  int frames = 0;  // of this scene, at most 3
  // Blurred pictures, [0] of the newest frame; never an old difference.
  std::array<Image<std::uint8_t>, 3> ring;
  Transform before;  // frame k-2 to k-1
  Warp warp1, warp2;
  LightSamples samples;
  LightChange light, light_before;
  Image<std::uint8_t> rows;  // scratch for relit rows
  std::vector<RowSpan> spans;

  void forget() {
    frames = 0;
    before = {};
    light.clear();
    light_before.clear();
  }
};

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
                                              Histogram& histogram) {
  State& s = *state_;
  const Size size = picture.size();
  const std::size_t height = static_cast<std::size_t>(size.height);
  if (size != s.size) {
    s.size = size;
    for (auto& image : s.ring) image.resize(size);
    s.rows.resize({size.width, 2});
    s.spans.assign(height, {});
    s.forget();
  }
  histogram.fill(0);
  DifferenceResult result;
  if (picture.empty()) return result;

  std::swap(s.ring[1], s.ring[2]);
  std::swap(s.ring[0], s.ring[1]);
  blur3(picture, s.options.blur, s.ring[0].view());
  s.frames = std::min(s.frames + 1, 3);
  result.frames = s.frames;
  const auto clear = [&](MutableGrayView v) {
    for (int y = 0; y < v.height; ++y) std::fill_n(v.row(y), v.width, std::uint8_t{0});
  };
  if (s.frames < 2 || !s.warp1.prepare(motion, size)) {
    clear(current);
    clear(previous);
    s.before = motion;
    if (s.frames > 1) {  // the camera's motion is not to be trusted: begin again
      s.forget();
      s.frames = 1;
    }
    result.frames = s.frames;
    return result;
  }
  // Both previous pictures where frame k sees them; the outputs hold them until the differences overwrite
  // them.
  const GrayView present = s.ring[0].view();
  GrayView first = s.ring[1].view(), second = s.ring[2].view();
  std::ranges::copy(s.warp1.spans(), s.spans.begin());
  if (!s.warp1.is_identity()) {
    s.warp1.bilinear(first, current);
    first = current;
  }
  const bool three = s.frames == 3 && s.warp2.prepare(motion * s.before, size);
  if (three) {
    for (std::size_t y = 0; y < height; ++y) s.spans[y] = both(s.spans[y], s.warp2.spans()[y]);
    if (!s.warp2.is_identity()) {
      s.warp2.bilinear(second, previous);
      second = previous;
    }
  }
  std::swap(s.light, s.light_before);
  if (s.options.compensate_light) {
    s.samples.take(first, present, s.spans);
    s.light.estimate(s.samples, s.warp1.is_identity());
  } else {
    s.light.clear();
  }

  LevelCounter counter;
  for (int y = 0; y < size.height; ++y) {
    const RowSpan span = s.spans[static_cast<std::size_t>(y)];
    const int count = span.end - span.begin;
    std::uint8_t *d1 = current.row(y), *d2 = previous.row(y);
    const std::uint8_t* f0 = present.row(y) + span.begin;
    const std::uint8_t* f1 = first.row(y) + span.begin;
    if (three) {
      const std::uint8_t* f2 = second.row(y) + span.begin;
      if (!s.light_before.none()) {
        relight_row(f2, s.light_before.row(y), count, s.rows.view().row(0));
        f2 = s.rows.view().row(0);
      }
      difference_row(f1, f2, count, d2 + span.begin);
    }
    if (!s.light.none()) {
      relight_row(f1, s.light.row(y), count, s.rows.view().row(1));
      f1 = s.rows.view().row(1);
    }
    difference_row(f0, f1, count, d1 + span.begin);
    counter.add(d1 + span.begin, count);
    std::fill(d1, d1 + span.begin, std::uint8_t{0});
    std::fill(d1 + span.end, d1 + size.width, std::uint8_t{0});
    if (three) {
      std::fill(d2, d2 + span.begin, std::uint8_t{0});
      std::fill(d2 + span.end, d2 + size.width, std::uint8_t{0});
    } else {
      std::fill_n(d2, size.width, std::uint8_t{0});
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
  return s.ring[0].bytes() * 3 + s.rows.bytes() + s.warp1.bytes() + s.warp2.bytes() + s.samples.bytes() +
         s.light.bytes() + s.light_before.bytes() + s.spans.capacity() * sizeof(RowSpan) + sizeof(State);
}

}  // namespace cerberus::vision
