// SPDX-License-Identifier: LGPL-2.1-or-later
// Pictures for tests: a scene that can be viewed from anywhere without interpolation error, noise, and memory that
// ends at an unreadable page.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>

#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::tests {

// A smooth endless texture: random values on lattices of 4 to 32 pixels, cubic B-splines between them, so that it is
// known at every real point.
class Scene {
 public:
  explicit Scene(std::uint32_t seed, double contrast = 40) : seed_(seed), contrast_(contrast) {}

  double at(double x, double y) const {
    double value = 0;
    for (int octave = 0; octave < 4; ++octave) {
      const double cell = 4 << octave;
      value += octave_at(octave, x / cell, y / cell);
    }
    return 128 + contrast_ * value;
  }

 private:
  double lattice(int octave, int x, int y) const {
    std::uint32_t h = seed_ * 2654435761u + static_cast<std::uint32_t>(octave) * 97u;
    h ^= static_cast<std::uint32_t>(x) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    h ^= static_cast<std::uint32_t>(y) * 0x27d4eb2fu;
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    h ^= h >> 12;
    return h / 2147483648.0 - 1;
  }

  double octave_at(int octave, double x, double y) const {
    const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
    double wx[4], wy[4];
    spline(x - ix, wx), spline(y - iy, wy);
    double sum = 0;
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) sum += wx[i] * wy[j] * lattice(octave, ix + i - 1, iy + j - 1);
    return sum;
  }

  static void spline(double t, double (&w)[4]) {
    w[0] = (1 - t) * (1 - t) * (1 - t) / 6;
    w[1] = (3 * t * t * t - 6 * t * t + 4) / 6;
    w[2] = (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6;
    w[3] = t * t * t / 6;
  }

  std::uint32_t seed_;
  double contrast_;
};

inline std::uint8_t to_byte(double v) {
  return static_cast<std::uint8_t>(std::clamp(v + 0.5, 0.0, 255.0));
}

// What a camera sees of the scene after `motion` (scene to picture): picture(p) = scene(motion^-1 p).
inline void look(const Scene& scene, const vision::Transform& motion, vision::MutableGrayView picture) {
  const vision::Transform inverse = motion.inverse();
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const vision::Point p = inverse.apply({static_cast<double>(x), static_cast<double>(y)});
      picture.at(x, y) = to_byte(scene.at(p.x, p.y));
    }
}

// Sensor noise whose standard deviation grows with brightness from `dark` to `bright`.
inline void add_noise(vision::MutableGrayView picture, double dark, double bright, std::mt19937& random) {
  std::normal_distribution<double> normal;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const double v = picture.at(x, y);
      picture.at(x, y) = to_byte(v + (dark + (bright - dark) * v / 255) * normal(random));
    }
}

template <typename T>
void fill_random(vision::View<T> picture, std::mt19937& random) {
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) picture.at(x, y) = static_cast<T>(random());
}

// `bytes` readable bytes that end where an unreadable page begins: reading one too many ends the program.
class GuardedBytes {
 public:
  explicit GuardedBytes(std::size_t bytes) {
    const std::size_t page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    mapped_ = (bytes + page - 1) / page * page + page;
    base_ = static_cast<std::uint8_t*>(
        mmap(nullptr, mapped_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    if (base_ == MAP_FAILED || mprotect(base_ + mapped_ - page, page, PROT_NONE) != 0) std::abort();
    data_ = base_ + mapped_ - page - bytes;
  }
  ~GuardedBytes() { munmap(base_, mapped_); }
  GuardedBytes(const GuardedBytes&) = delete;
  GuardedBytes& operator=(const GuardedBytes&) = delete;

  std::uint8_t* data() const { return data_; }

 private:
  std::uint8_t* base_;
  std::uint8_t* data_;
  std::size_t mapped_;
};

// A picture whose last row ends at the unreadable page (rows `padding` bytes apart).
class GuardedPicture {
 public:
  GuardedPicture(vision::Size size, int padding = 0)
      : stride_(size.width + padding),
        size_(size),
        bytes_(static_cast<std::size_t>(stride_) * (size.height - 1) + size.width) {}
  vision::MutableGrayView view() const { return {bytes_.data(), size_.width, size_.height, stride_}; }

 private:
  std::ptrdiff_t stride_;
  vision::Size size_;
  GuardedBytes bytes_;
};

}  // namespace cerberus::tests
