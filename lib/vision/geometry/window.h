// SPDX-License-Identifier: LGPL-2.1-or-later
// A window that moves over a wide picture as a camera on a pan-tilt head moves over the scene: its place for a pose,
// and its pixels.
//
// The wide picture is that of a pinhole camera pointing straight ahead (vision/geometry/lens.h without pan and tilt).
// The middle of the view of a head at (pan, tilt) is the point of the wide picture
//   x = W / 2 + F tan(pan),   y = H / 2 - F tan(tilt) / cos(pan),   F = (W / 2) / tan(wide field of view / 2)
// (corner coordinates, like those of boxes). The window is an upright rectangle around that point: the slight shear
// that a real camera shows near the edges is left out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vision/image/image.h"

namespace cerberus::vision {

class WindowGeometry {
 public:
  // Angles in radians. fov: field of view over the window's width; 0: a pixel of the picture is a pixel of the window.
  WindowGeometry() = default;
  WindowGeometry(double wide_fov, Size picture, Size window, double fov = 0);

  // Returns false when the window is larger than the picture or an angle is impossible for a pinhole camera. No other
  // method may be called then.
  bool fits() const { return fits_; }
  double scale() const { return scale_; }  // picture pixels a window pixel
  double fov() const;                      // radians, over the window's width
  // The window reaches -pan_reach..pan_reach with tilt 0, and -tilt_reach..tilt_reach with pan 0. Radians.
  double pan_reach() const;
  double tilt_reach() const;

  struct Place {
    double left = 0, top = 0;  // of the window's corner in the picture, corner coordinates
    double pan = 0, tilt = 0;  // the pose that the window shows, radians
    bool limited = false;      // the picture's edge limited the requested pose
  };
  // Returns the window's place for a pose in radians. NaN means straight ahead.
  Place at(double pan, double tilt) const;

 private:
  double focal_ = 0, scale_ = 1;
  double middle_x_ = 0, middle_y_ = 0;  // of the picture
  double half_x_ = 0, half_y_ = 0;      // of the window, picture pixels
  bool fits_ = false;
};

// Samples of a picture: a plane, or one component of packed pixels. Byte c of the `channels` adjacent bytes of sample
// (x, y) is data[y stride + x step + c].
template <typename Byte>
struct Samples {
  Byte* data = nullptr;
  int width = 0, height = 0;
  std::ptrdiff_t stride = 0;
  int step = 1, channels = 1;
};

// Bilinear resampling on a grid of equal steps:
//   target(i, j) = source(left + (i + 1/2) scale_x - 1/2, top + (j + 1/2) scale_y - 1/2)
// Positions are rounded to 1/128 sample and limited to the picture; values are rounded to nearest. At whole positions
// the result is a copy. Scales far above 1 skip samples. Source and target have the same number of channels. Allocates
// only for a wider target.
class WindowResampler {
 public:
  struct Grid {
    double left = 0, top = 0, scale_x = 1, scale_y = 1;
  };
  void draw(const Samples<const std::uint8_t>& source, const Samples<std::uint8_t>& target, const Grid& grid);

 private:
  struct Column {
    int first, second;  // index into line_ of the left and of the right sample, first channel
    int weight;         // of the right one, 1/128
  };
  // Returns true when every column has the same weight and follows the one before.
  bool find_columns(int width, int count, double left, double scale, int channels);

  std::vector<Column> columns_;
  std::vector<std::uint16_t> line_;  // two rows blended, 1/128 grey levels
  int begin_ = 0, end_ = 0;          // source columns that line_ holds
};

}  // namespace cerberus::vision
