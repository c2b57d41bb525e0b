// SPDX-License-Identifier: LGPL-2.1-or-later
// Small drawings and their places in the frame. Pictures are taken from a pool and return to it when the last reference
// (of a patch or of a buffer downstream) is released: the steady state allocates nothing.
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
  // Returns the area enlarged to even coordinates: samples of chroma are then covered wholly.
  Area even() const;
  // Returns the pixels touched by a shape between these corner coordinates, enlarged by `margin` pixels on all sides.
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

// A picture and its place, within the frame. Its pixels do not change any more.
struct Patch {
  Area area;
  std::shared_ptr<const Picture> pixels;
};

class PicturePool {
 public:
  // Returns a picture that has no other reference. Memory is reused in classes of powers of two.
  PicturePtr take(int width, int height);            // transparent
  PicturePtr take_unwritten(int width, int height);  // whose pixels are any: the caller writes all of them

 private:
  struct Class {
    std::vector<PicturePtr> pictures;
    std::size_t next = 0;  // index at which the search for a free one continues
  };
  std::vector<Class> classes_;
};

}  // namespace cerberus::overlay
