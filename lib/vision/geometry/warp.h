// SPDX-License-Identifier: LGPL-2.1-or-later
// Registration: redraws a picture of frame k-1 in the coordinates of frame k.
#pragma once

#include <cstdint>
#include <span>

#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

// The pixels [begin, end) of one row; begin == end: none.
struct RowSpan {
  int begin = 0;
  int end = 0;
  bool operator==(const RowSpan&) const = default;
};

// Inverse mapping: target(p) = source(motion^-1 p), for pictures of one size. `prepare` does the work that depends on
// the motion alone, so that several planes can be warped by the same motion.
//
// A target pixel is valid when its source position lies inside the rectangle of source pixel centres (0 <= x
// <= w - 1, 0 <= y <= h - 1; positions are rounded to 1/128 pixel). The source rectangle is convex and the
// motions are not degenerate, so the valid pixels of a row are one span. All methods write every pixel of the
// target: `fill` outside the spans. Source and target must not overlap.
//
// Identity is done as a copy and a shift by whole pixels as a copy of spans; both are exact for every method.
class Warp {
 public:
  // motion: source (frame k-1) to target (frame k), pixels. Returns false when the motion is not sane for this size: no
  // pixel is valid and the methods only fill. Allocates only when the size changes.
  bool prepare(const Transform& motion, Size size);

  bool is_identity() const { return kind_ == Kind::identity; }
  // Valid pixels, one span a row.
  std::span<const RowSpan> spans() const {
    return {spans_.view().data, static_cast<std::size_t>(size_.height)};
  }

  // Bilinear with 1/128 pixel weights, rounded to nearest.
  void bilinear(GrayView source, MutableGrayView target, std::uint8_t fill = 0);
  // The nearest source pixel (ties to the right and down): for ages and flags.
  void nearest(GrayView source, MutableGrayView target, std::uint8_t fill = 0);

  std::size_t bytes() const { return spans_.bytes() + positions_.bytes(); }

 private:
  enum class Kind { nothing, identity, shift, affine, projective };

  RowSpan shift_span(int y) const;
  RowSpan affine_span(int y) const;
  RowSpan projective_span(int y, RowSpan above) const;
  bool projective_position(int x, int y, std::int32_t& u, std::int32_t& v) const;
  void find_positions(int y);
  template <typename Sample>
  void draw(GrayView source, MutableGrayView target, std::uint8_t fill, Sample&& sample);

  Kind kind_ = Kind::nothing;
  Size size_;
  int dx_ = 0, dy_ = 0;            // Kind::shift: source = target - (dx, dy)
  Transform inverse_;              // target to source, third coordinate positive where it is valid
  Image<RowSpan> spans_;           // height x 1
  Image<std::int32_t> positions_;  // source positions of the row at hand, 1/128 pixel: row 0 x, row 1 y
};

// The same by definition, one pixel at a time in floating point, without a fast path: the reference for the tests of
// Warp.
void warp_bilinear_reference(const Transform& motion, GrayView source, MutableGrayView target,
                             std::uint8_t fill);

}  // namespace cerberus::vision
