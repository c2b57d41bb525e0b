// SPDX-License-Identifier: LGPL-2.1-or-later
// People in a group of foreground blobs: the foreground is explained by as few standing persons as possible, so that
// fragments of one person are joined and persons beside and behind one another are parted by the same rule. A person is
// a body of three parts (head, trunk, legs), as tall as the height prior expects or, where that is not known, at most as
// tall as the blob.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/detection/height_prior.h"
#include "vision/detection/people_kernels.h"
#include "vision/detection/person.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

class PeopleFinder {
 public:
  // One part of a body: rows from `top` to `bottom`, columns up to `core` and up to `reach` from the axis, all in
  // heights of the person; probabilities that a pixel there is foreground.
  struct Part {
    double top, bottom, core, reach;
    double core_moving, side_moving;
  };
  // Where no origin stands the value was chosen by hand on vtest.avi and TUD-Campus. Guard: tests/unit (people,
  // regions), the boxes on vtest.avi, MOTA 70 on PETS09-S2L1.
  struct Parameters {
    // The space above a head is background: a trunk is no head. It has no price.
    Part free_space{-0.10, -0.02, 0.07, 0.07, 0.03, 0.03};
    // derived: proportions of a walking adult (head 1/7 of the height, shoulders 1/4, a stride 0.38).
    std::array<Part, 3> body{{{0, 0.14, 0.065, 0.16, 0.75, 0.05},
                              {0.14, 0.50, 0.095, 0.175, 0.75, 0.30},
                              {0.50, 1, 0.095, 0.19, 0.65, 0.33}}};
    double elsewhere = 0.13;  // probability that a pixel of the group beside all persons is foreground
    // Nats a pixel of a body; a whole person gains 1 to 1.7. swept: .25 to .4.
    double price = 0.3;
    // A height that differs from the expected one costs as in a log-normal prior.
    double height_weight = 0.16;  // nats of a squared height. derived: half of a body's pixels, 0.33 h^2
    // Of the logarithm of the height: adults differ by 5 %, blobs by as much; the line's own error is added. measured: MOTA on PETS09-S2L1 71.8
    // with .08 and 73.5 with .11, where a clock over the picture costs 2 % of the recall.
    double spread = 0.08;
    // Where the height is not known the blob's is expected, and smaller ones are tried by steps. measured: the step of the
    // trial on TUD-Campus. swept: .3 to .45.
    double unknown_spread = 0.4;  // of the logarithm of the height
    double unknown_step = 0.08;   // of the blob's height
    double other_height = 0.08;  // a height that is tried as well is by so much lower or higher than expected
    // Nats of a squared height, before the price of an unusual height is taken off: less is the rest of a person already
    // found. swept: .09 to .11. Guard: MOTA .05 on TUD-Stadtmitte, which jumps with it.
    double least_gain = 0.0975;
    double aspect = 0.36;  // width / height of a walking body
    // Rows of cells that a body is cut into, if it has as many pixels. measured: with 24 MOTA on PETS09-S2L1 is 3
    // lower, with 48 no higher.
    int cells = 28;
    double above = 0.7;       // heights of free grid above the window,
    double below = 0.6;       // and below it, where it reaches the picture's lower edge
    double least_feet = 0.4;  // heights from the window's top to the feet, at least
    int least_part = 3;       // 1/n of a person is in the picture, and pays for its price
    int edge_part = 3;  // 1/n of the width: reach of a person's edge around the leftmost unexplained column
    int edge_step = 4;  // 1/n of the width: step where no person begins there
    double one_wide = 1.3;  // body widths; in a narrower window one person is enough
    // Blocks: cars, doors. measured: gaps of rows of people on vtest.avi against cars on highway.
    double solid = 0.88;  // of the persons' boxes that is foreground: people leave more gaps
    int block_width = 4;  // body widths of a wide block: a row of so many people has gaps
    // Share of gaps, at least, in a row of people; cars have .06 to .10. swept: .11 to .14.
    double gaps = 0.13;
    double gaps_after = 0.16;  // the same where a wide block was a frame ago
    // Share of gaps, at least, of people in one blob before their height is known; in a blob with fewer gaps bodies are a
    // thing. measured as above.
    double gaps_unknown = 0.11;
  };
  static constexpr std::size_t kMostPeople = 12;  // in one group

  PeopleFinder() : PeopleFinder(Parameters()) {}
  explicit PeopleFinder(const Parameters& parameters);

  // Takes the memory for pictures of this size; find() takes none.
  void preallocate(Size picture);

  // pixels: one bit a pixel of a picture of the size given to preallocate(). Reads the window only. Where the prior knows
  // the height, nothing is returned for a block: foreground without the gaps that people side by side leave. Where it
  // does not know it, the window is that of one blob, and the bodies that explain a block are returned as well:
  // found_block() tells them apart. was_wide_block: the result of found_wide_block() a frame ago. Deterministic; the
  // span lives until the next call.
  std::span<const Person> find(BitView pixels, const Bounds& window, const HeightPrior& prior,
                               bool was_wide_block = false);
  // Returns whether the last find() found a block that is too wide for people, or the rest of one.
  bool found_wide_block() const { return wide_block_; }
  // Returns whether the last find() found a block.
  bool found_block() const { return block_; }

  std::size_t bytes() const;

 private:
  static constexpr int kTallest = 64;  // cells of the tallest body that is scored

  // All in cells of the grid; `right` and `bottom` exclusive.
  struct Candidate {
    int left = 0, top = 0, right = 0, bottom = 0;
    int axis = 0;
    int score = 0;  // gain less the price of a person, 1/64
  };
  struct Shape {  // of a person whose feet are at one row of the grid
    int height = 0, width = 0;
    float spread = 0;  // of the logarithm of the height: that of people and the line's error
  };
  struct Scale {  // a height that is tried: times the expected one
    double factor = 1, log = 0;
  };
  struct Rows {  // of a part of a body of one height: offsets from its top row, columns from its axis
    std::int16_t top = 0, bottom = 0, core = 0, reach = 0;
  };
  using Body = std::array<Rows, kBodyBands>;

  void lay_grid(BitView pixels, const Bounds& window, double tallest);
  void choose(bool was_wide_block);
  std::uint8_t* cells(int row) { return &cells_[static_cast<std::size_t>(row) * columns_]; }
  const std::uint32_t* sums(int row) const;
  int moving_before(int column) const;
  void clear_explained();
  void mark_explained(const Candidate& candidate);
  void add_up();
  void try_row(int foot, const Scale& scale, int from, int to, int anchor, Candidate& best);
  Candidate best(int from, int to, int anchor);
  int score(int foot, int height, int first, int end);
  double gain_a_pixel(const Candidate& candidate) const;
  int explain(bool from_the_left);
  void settle();
  double filled();
  double gaps();
  bool is_block(bool was_wide);

  Parameters parameters_;
  BodyBands bands_;  // the gains, and the rows of the body that is being scored
  std::array<Body, kTallest + 1> bodies_;
  // The expected height, its neighbours, and those beyond, up to a quarter off, which are for a line that is uncertain.
  static constexpr std::size_t kNeighbours = 2;
  std::array<Scale, 7> scales_;
  std::array<Scale, 6> unknown_scales_;  // of the blob's height
  Size picture_;
  const HeightPrior* prior_ = nullptr;
  bool height_known_ = false;
  bool block_ = false, wide_block_ = false;
  // The grid: cells of step_ x step_ pixels, the first one's corner at (x0_, y0_); the picture and the window in it.
  int step_ = 1, x0_ = 0, y0_ = 0, columns_ = 0, rows_ = 0;
  Bounds inside_, window_;
  int explained_from_ = 0;     // the first row of which a cell may be explained
  int summed_to_ = 0;          // rows of which the sums are right
  std::vector<Shape> shapes_;  // of each foot row 0..rows_
  float largest_spread_ = 0;   // of shapes_
  // On the stack of find(): kCell... of people_kernels.h, and their sums, of the cells not yet explained above each row
  // and left of each column.
  std::span<std::uint8_t> cells_;
  std::span<std::uint32_t> sums_;
  std::vector<int> scores_;
  std::vector<Candidate> chosen_, other_;
  std::vector<Person> people_;
};

}  // namespace cerberus::vision
