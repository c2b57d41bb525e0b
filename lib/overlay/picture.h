// SPDX-License-Identifier: LGPL-2.1-or-later
// Small drawings and where they go in the frame. Pictures are taken from a pool and return to it when the last patch (or
// the buffer downstream that holds one) lets go: the steady state allocates nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "vision/image/image.h"

namespace cerberus::overlay {

struct Area {
  int x = 0, y = 0, width = 0, height = 0;
  bool operator==(const Area&) const = default;
  bool empty() const { return width <= 0 || height <= 0; }
  Area intersection(const Area& other) const;
  // The pixels that a shape between these corner coordinates and `margin` pixels round it touches.
  static Area around(double left, double top, double right, double bottom, double margin);
};

// Words of premultiplied alpha, red, green and blue from the highest byte down (cairo's ARGB32), rows side by side.
struct Picture {
  std::vector<std::uint32_t> words;
  int width = 0, height = 0;

  int stride() const { return width; }  // words
  vision::View<std::uint32_t> view() { return {words.data(), width, height, width}; }
  vision::View<const std::uint32_t> view() const { return {words.data(), width, height, width}; }
};
using PicturePtr = std::shared_ptr<Picture>;

// Where a picture goes; within the frame. Its pixels are not changed any more.
struct Patch {
  Area area;
  std::shared_ptr<const Picture> pixels;
};

class PicturePool {
 public:
  // Transparent; nobody else holds it. Memory is kept in classes of powers of two.
  PicturePtr take(int width, int height);

 private:
  struct Class {
    std::vector<PicturePtr> pictures;
    std::size_t next = 0;  // where the search for a free one goes on
  };
  std::vector<Class> classes_;
};

}  // namespace cerberus::overlay
