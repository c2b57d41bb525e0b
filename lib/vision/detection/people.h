// SPDX-License-Identifier: LGPL-2.1-or-later
// A patch of moving pixels explained by as few standing people of known height as possible: fragments of one person
// come together and people side by side come apart by the same rule.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vision/detection/height_prior.h"
#include "vision/detection/regions.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

// Part of the picture: columns and rows from (left, top) up to but not including (right, bottom).
struct Bounds {
  int left = 0, top = 0, right = 0, bottom = 0;
  int width() const { return right - left; }
  int height() const { return bottom - top; }
};

struct Person {
  Box box;           // of the expected height and width, may leave the picture
  double score = 0;  // evidence per pixel of the box; about 1 for a whole person seen well
};

class PeopleFinder {
 public:
  // Takes the memory for pictures of this size; find() takes none.
  void preallocate(Size picture);

  // pixels: one bit a pixel of the picture that preallocate() was told. Looks at the window only. Returns nobody when the
  // prior does not know the heights there, and for a block: what has no gaps where people side by side would leave
  // some. was_wide_block: found_wide_block() said so a frame ago. Deterministic; the span lives until the next call.
  std::span<const Person> find(BitView pixels, const Bounds& window, const HeightPrior& prior,
                               bool was_wide_block = false);
  // By the last find(): a block of which too much is seen to be people, or what is left of one.
  bool found_wide_block() const { return wide_block_; }

  std::size_t bytes() const;

 private:
  // All in cells of the grid; `right` and `bottom` exclusive.
  struct Candidate {
    int left = 0, top = 0, right = 0, bottom = 0;
    int score = 0;  // what it gains less the price of a person, 1/64
    int gain = 0;
  };
  struct Shape {  // of a person whose feet are at one row of the grid
    int height = 0, width = 0;
  };

  bool lay_grid(BitView pixels, const Bounds& window, std::span<std::uint8_t> room);
  void choose(bool was_wide_block);
  std::uint8_t* cells(int row) { return &cells_[static_cast<std::size_t>(row) * columns_]; }
  void forget_explained();
  void mark_explained(const Candidate& candidate);
  void add_up_window();
  void slide(int top, int bottom, int left, int right);
  Candidate best(int from, int to, int anchor);
  int explain(bool from_the_left);
  void settle();
  double filled();
  double gaps();
  bool is_block(bool was_wide);

  Size picture_;
  const HeightPrior* prior_ = nullptr;
  bool wide_block_ = false;
  // The grid: cells of step_ x step_ pixels, the first one's corner at (x0_, y0_); the picture and the window in it.
  int step_ = 1, x0_ = 0, y0_ = 0, columns_ = 0, rows_ = 0;
  Bounds inside_, window_;
  std::vector<Shape> shapes_;          // of each foot row 0..rows_
  std::span<std::uint8_t> cells_;      // kCell... of people_kernels.h; find() has them on its stack
  std::vector<std::uint32_t> moving_;  // moving cells not yet explained in the columns before each
  // Sums of the cells in the rows [band_top_, band_bottom_): of each column, and of the columns before each from where
  // they were asked for.
  int band_top_ = 0, band_bottom_ = 0;
  std::vector<std::uint32_t> band_, sums_;
  std::vector<int> scores_;
  std::vector<Candidate> chosen_, other_;
  std::vector<Person> people_;
};

}  // namespace cerberus::vision
