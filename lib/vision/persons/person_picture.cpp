// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/persons/person_picture.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace cerberus::vision {

namespace {

std::uint8_t level(double value) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
}

// The part of a plane that lies over the part of the picture.
LumaSource part_of(const LumaSource& plane, Size picture, int x, int y, Size part) {
  LumaSource found = plane;
  const int left = x * plane.width / picture.width, top = y * plane.height / picture.height;
  found.width = std::clamp(part.width * plane.width / picture.width, 1, plane.width - left);
  found.height = std::clamp(part.height * plane.height / picture.height, 1, plane.height - top);
  found.data += top * plane.stride + static_cast<std::ptrdiff_t>(left) * plane.pixel_stride;
  return found;
}

}  // namespace

std::array<std::uint8_t, 3> rgb_of(int luma, int blue, int red, ColourPlanes planes) {
  switch (planes) {
    case ColourPlanes::blue_red:
      return {level(red), level((256 * luma - 77 * red - 29 * blue) / 150.0), level(blue)};
    case ColourPlanes::difference_video:
    case ColourPlanes::difference_full: {
      const bool full = planes == ColourPlanes::difference_full;
      const double y = full ? luma : (luma - 16) * 255 / 219.0, range = full ? 1 : 255 / 224.0;
      const double u = range * (blue - 128), v = range * (red - 128);
      return {level(y + 1.402 * v), level(y - 0.344 * u - 0.714 * v), level(y + 1.772 * u)};
    }
    case ColourPlanes::none:
      break;
  }
  return {level(luma), level(luma), level(luma)};
}

void PictureCopy::take(const PictureSource& source, int x, int y, Size part, bool colours) {
  const Size whole{source.luma.width, source.luma.height};
  const auto copy = [&](const LumaSource& plane, Image<std::uint8_t>& to) {
    const LumaSource from = part_of(plane, whole, x, y, part);
    to.resize({from.width, from.height});
    scaler_.scale(from, to.view());
  };
  copy(source.luma, luma_);
  planes_ = colours ? source.planes : ColourPlanes::none;
  if (planes_ == ColourPlanes::none) return;
  copy(source.blue, blue_);
  copy(source.red, red_);
}

PersonPicture PictureCopy::view() const {
  PersonPicture picture(luma_.view());
  if (planes_ == ColourPlanes::none) return picture;
  picture.blue = blue_.view(), picture.red = red_.view(), picture.planes = planes_;
  return picture;
}

}  // namespace cerberus::vision
