// SPDX-License-Identifier: LGPL-2.1-or-later
// People in a group of foreground blobs: the foreground is explained by as few standing persons of known height as
// possible, so that fragments of one person are joined and persons side by side are parted by the same rule.
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
  double score = 0;  // log-likelihood ratio per pixel of the box; about 1 for a whole person with a good mask
};

class PeopleFinder {
 public:
  // Where no origin stands the value was chosen by hand on vtest.avi. Guard: tests/unit (people, regions) and the boxes
  // on vtest.avi (precision .84, recall .83). The likelihood's probabilities are in people_kernels.h.
  struct Parameters {
    double aspect = 0.36;  // width / height of a walking body
    int cells = 24;  // rows of cells that a body is cut into, if it has as many pixels. derived: 2 cm of it
                     // do not matter, and two bodies of 24 x 9 cells cost what one of 48 x 18 does
    double above = 0.7;       // heights of free grid above the window,
    double below = 0.6;       // and below it, where it reaches the picture's lower edge
    double tallest = 1.3;     // = above + below, for the memory
    double least_feet = 0.4;  // heights from the window's top to the feet, at least
    int side_part = 4;        // 1/n of the width: either outer part of a person
    int least_part = 3;       // 1/n of a person is in the picture, and pays for its price
    int edge_part = 3;  // 1/n of the width: reach of a person's edge around the leftmost unexplained column
    int edge_step = 4;  // 1/n of the width: step where no person begins there
    double cell_moves = 0.5;  // of a cell's pixels that are foreground: the cell is
    double one_wide = 1.3;    // body widths; in a narrower window one person is enough
    // Blocks: cars, doors. measured: gaps of rows of people on vtest.avi against cars on highway.
    double solid = 0.88;       // of the persons' boxes that is foreground: people leave more gaps
    int block_width = 4;       // body widths of a wide block: a row of so many people has gaps
    double gaps = 0.11;        // share of gaps, at least, in a row of people; cars have .06 to .10
    double gaps_after = 0.16;  // the same where a wide block was a frame ago
  };
  static constexpr std::size_t kMostPeople = 12;  // in one group

  // Takes the memory for pictures of this size; find() takes none.
  void preallocate(Size picture);

  // pixels: one bit a pixel of a picture of the size given to preallocate(). Reads the window only. Returns nothing
  // where the prior does not know the height, and for a block: foreground without the gaps that people side by side
  // leave. was_wide_block: the result of found_wide_block() a frame ago. Deterministic; the span lives until the next
  // call.
  std::span<const Person> find(BitView pixels, const Bounds& window, const HeightPrior& prior,
                               bool was_wide_block = false);
  // Returns whether the last find() found a block that is too wide for people, or the rest of one.
  bool found_wide_block() const { return wide_block_; }

  std::size_t bytes() const;

 private:
  // All in cells of the grid; `right` and `bottom` exclusive.
  struct Candidate {
    int left = 0, top = 0, right = 0, bottom = 0;
    int score = 0;  // gain less the price of a person, 1/64
    int gain = 0;
  };
  struct Shape {  // of a person whose feet are at one row of the grid
    int height = 0, width = 0;
  };

  bool lay_grid(BitView pixels, const Bounds& window, std::span<std::uint8_t> room);
  void choose(bool was_wide_block);
  std::uint8_t* cells(int row) { return &cells_[static_cast<std::size_t>(row) * columns_]; }
  void clear_explained();
  void mark_explained(const Candidate& candidate);
  void add_up_window();
  void slide(int top, int bottom, int left, int right);
  Candidate best(int from, int to, int anchor);
  int explain(bool from_the_left);
  void settle();
  double filled();
  double gaps();
  bool is_block(bool was_wide);

  Parameters parameters_;
  Size picture_;
  const HeightPrior* prior_ = nullptr;
  bool wide_block_ = false;
  // The grid: cells of step_ x step_ pixels, the first one's corner at (x0_, y0_); the picture and the window in it.
  int step_ = 1, x0_ = 0, y0_ = 0, columns_ = 0, rows_ = 0;
  Bounds inside_, window_;
  std::vector<Shape> shapes_;          // of each foot row 0..rows_
  std::span<std::uint8_t> cells_;      // kCell... of people_kernels.h; on the stack of find()
  std::vector<std::uint32_t> moving_;  // moving cells not yet explained in the columns before each
  // Sums of the cells in the rows [band_top_, band_bottom_): of each column, and cumulative from the first column that
  // slide() was called for.
  int band_top_ = 0, band_bottom_ = 0;
  std::vector<std::uint32_t> band_, sums_;
  std::vector<int> scores_;
  std::vector<Candidate> chosen_, other_;
  std::vector<Person> people_;
};

}  // namespace cerberus::vision
