// SPDX-License-Identifier: LGPL-2.1-or-later
// A paved yard with a door in its middle before a camera that stands, a person who walks in it, and rain.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "support/sensor.h"
#include "vision/geometry/box.h"
#include "vision/image/luma/luma.h"

namespace cerberus::tests {

struct Yard {
  vision::Size size{160, 120};
  double rate = 10;     // frames a second
  double contrast = 1;  // of the person: 1 is a white face, a light coat and black trousers
  double level = 34;    // of the person's feet, rows below the picture's middle, at 120 rows
  std::uint32_t seed = 1;
  Noise noise{};
  std::vector<float> scene{};
  vision::Image<std::uint8_t> picture{};

  double scale() const { return size.height / 120.0; }
  vision::Box door() const {
    return {.44 * size.width, size.height / 2.0 - 20 * scale(), 22 * scale(), 48 * scale()};
  }
  // The person whose middle is in this column, `way` pixels from where his legs were together, and who is hidden right of the
  // column `hidden`.
  struct Person {
    double x = -1000, way = 0, hidden = 1e9;
  };
  vision::Box box(const Person& person) const {
    const double k = scale(), feet = size.height / 2.0 + (level - 8) * k;
    return {person.x - 6 * k, feet - 34 * k, 12 * k, 34 * k};
  }

  void draw(const Person& person) {
    const double k = scale();
    scene.resize(static_cast<std::size_t>(size.area()));
    picture.resize(size);
    const vision::Box d = door(), b = box(person);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const bool in_door = x >= d.x && x < d.right() && y >= d.y && y < d.bottom();
        const int slab = (static_cast<int>(x / k) / 18 + static_cast<int>(y / k) / 13) % 2;
        double grey = in_door ? 45 + (std::fmod(y / k, 6) < 3 ? 6 : 0)
                              : 70 + 30.0 * x / size.width + 40.0 * y / size.height + 14 * slab;
        const double from_top = (y - b.y) / k, aside = (x - person.x) / k;
        if (x < person.hidden && covers(aside, from_top, person.way / k)) {
          const double own = from_top < 8 ? 190 : from_top < 20 ? 150 : 25;
          grey += contrast * (own - grey);
        }
        scene[static_cast<std::size_t>(y) * size.width + x] = static_cast<float>(grey);
      }
  }
  // Streaks of rain, each in this picture only.
  void rain(int streaks, double length, float brightness, std::mt19937& random) {
    std::uniform_real_distribution<double> share(0, 1);
    for (int i = 0; i < streaks; ++i) {
      const double x = share(random) * size.width, y = share(random) * size.height,
                   slope = .05 + .06 * share(random);
      const double long_ = length * (.4 + .6 * share(random));
      for (int n = 0; n < long_; ++n)
        for (int side = 0; side < (long_ > 18 ? 2 : 1); ++side) {
          const int column = static_cast<int>(x + n * slope) + side, row = static_cast<int>(y) + n;
          if (row < size.height && column < size.width)
            scene[static_cast<std::size_t>(row) * size.width + column] += brightness;
        }
    }
  }
  // The camera's picture of what was drawn; lives until the next call.
  vision::LumaSource shoot() {
    expose(scene.data(), size.width, {}, noise, picture.view());
    vision::LumaSource source;
    source.data = picture.view().data, source.stride = picture.view().stride;
    source.width = size.width, source.height = size.height;
    return source;
  }

 private:
  // A body 34 high: head, shoulders, two legs that swing.
  static bool covers(double aside, double from_top, double way) {
    if (from_top < 0 || from_top >= 34) return false;
    if (from_top < 7) return std::hypot(aside / 3.2, (from_top - 3.5) / 3.6) <= 1;
    if (from_top < 9) return std::abs(aside) <= 2;
    if (from_top < 20) return std::abs(aside) <= 5.2 - .12 * (from_top - 9);
    const double swing = 4 * std::sin(.35 * way) * (from_top - 19) / 15;
    return std::abs(aside - swing) <= 2 || std::abs(aside + swing) <= 2;
  }
};

}  // namespace cerberus::tests
