// SPDX-License-Identifier: LGPL-2.1-or-later
// Looks at a synthetic scene from one frame to the next: for tests of the camera motion.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <random>

#include "support/motions.h"
#include "support/pictures.h"
#include "vision/ego_motion/camera_motion.h"

namespace cerberus::tests {

inline constexpr vision::Size kSize{320, 240};

// Motion about the middle of the picture, where cameras turn and zoom.
inline vision::Transform about_centre(double scale, double angle, double dx, double dy,
                                      vision::Size size = kSize) {
  const double cx = 0.5 * (size.width - 1), cy = 0.5 * (size.height - 1);
  return vision::Transform::translation(cx + dx, cy + dy) * similarity(scale, angle, 0, 0) *
         vision::Transform::translation(-cx, -cy);
}

// Largest distance between where two motions take a grid of points.
inline double disagreement(const vision::Transform& a, const vision::Transform& b,
                           vision::Size size = kSize) {
  double worst = 0;
  for (int y = 0; y <= 4; ++y)
    for (int x = 0; x <= 4; ++x) {
      const vision::Point p{x * size.width / 4.0, y * size.height / 4.0}, q = a.apply(p), r = b.apply(p);
      worst = std::max(worst, std::hypot(q.x - r.x, q.y - r.y));
    }
  return worst;
}

inline vision::Image<std::uint8_t> picture(const Scene& scene, const vision::Transform& motion = {},
                                           vision::Size size = kSize) {
  vision::Image<std::uint8_t> image(size);
  look(scene, motion, image.view());
  return image;
}

inline vision::Image<std::uint8_t> mapped(const vision::Image<std::uint8_t>& image,
                                          const std::function<double(double, int)>& light) {
  vision::Image<std::uint8_t> out(image.size());
  for (int y = 0; y < image.size().height; ++y)
    for (int x = 0; x < image.size().width; ++x)
      out.view().at(x, y) = to_byte(light(image.view().at(x, y), y));
  return out;
}

// A picture of this level, with hardly any noise.
inline vision::Image<std::uint8_t> flat(int level, std::mt19937& random, vision::Size size = kSize) {
  vision::Image<std::uint8_t> image(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      image.view().at(x, y) = to_byte(level + static_cast<int>(random() % 3) - 1);
  return image;
}

inline void paste(const vision::Image<std::uint8_t>& from, vision::MutableGrayView onto, int left, int top,
                  int width, int height) {
  for (int y = top; y < top + height; ++y)
    for (int x = std::max(left, 0); x < std::min(left + width, onto.width); ++x)
      onto.at(x, y) = from.view().at(x - left, y - top);
}

// The motion found between two looks at a scene.
inline vision::CameraMotionResult between(const Scene& scene, const vision::Transform& motion,
                                          vision::MotionModel model = vision::MotionModel::similarity,
                                          double noise = 2,
                                          const std::optional<vision::Transform>& prior = std::nullopt,
                                          vision::Size size = kSize) {
  std::mt19937 random(1);
  vision::CameraMotion camera;
  camera.set_options({model});
  vision::Image<std::uint8_t> earlier = picture(scene, {}, size), later = picture(scene, motion, size);
  add_noise(earlier.view(), noise, noise, random);
  add_noise(later.view(), noise, noise, random);
  camera.update(earlier.view());
  return camera.update(later.view(), prior);
}

}  // namespace cerberus::tests
