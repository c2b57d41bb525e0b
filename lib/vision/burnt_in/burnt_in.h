// SPDX-License-Identifier: LGPL-2.1-or-later
// Finds what a camera writes into its own pictures (a clock, a name, a logo), which would be foreground for ever: it
// keeps its place in the frame while the scene moves, or it changes again and again without leaving its own outline.
//
// Own method. Blocks of 8 x 4 analysis pixels in frame coordinates collect evidence of two kinds: static edges while the
// camera turns (static_edges.h), recurrent changes while it stands (recurrent_changes.h). Blocks with enough evidence
// are joined to boxes. A target followed by the head keeps its place, too, and a person changes the picture in place,
// but neither all of the person: above and below there is foreground or change. Around writing there is none.
// A box grows along its row by what changes at once (the next digit). It is forgotten when the evidence stops: its row
// moves along with the scene, or has not changed for long.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/burnt_in/block_grid.h"
#include "vision/burnt_in/burnt_in_boxes.h"
#include "vision/burnt_in/recurrent_changes.h"
#include "vision/burnt_in/static_edges.h"
#include "vision/geometry/box.h"
#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

struct BurntInInput {
  GrayView picture;     // F(k), analysis pixels
  GrayView difference;  // D(k), registered
  int threshold = 0;    // Th: D(k) > Th has changed
  Transform motion;     // frame k-1 to k, analysis pixels
  bool still = false;   // the camera stands
  double seconds = 0;   // since frame k-1; 0: unknown
};

class BurntIn {
 public:
  struct Parameters {
    RecurrentChanges::Parameters changes;
    StaticEdges::Parameters edges;
    // Seconds between two searches. Derived: 25 of them in the 5 s that learning may take.
    double search_period = 0.2;
    // A search's share in a block's mean foreground, as its inverse. Derived: a mean over the last second or so.
    int foreground_memory = 6;
    // Share of searches in which a block is foreground to count as such, and share of a row or column of such blocks by
    // which a box of static edges grows. Swept: at .3 a column of a blinking logo is left over (unit test). Guard:
    // bench-burnt_in.
    double often = 0.2;
    // Blocks that may lie between two digits, and as far as which a box's surroundings are judged.
    int gap = 2, far = 3;
    // Share of the surroundings that may be foreground, or change with the box. Chosen, not swept. Guard: people of
    // vtest.avi and intel_one-by-one in bench-burnt_in.
    double around = 0.1;
    // Share of a box's blocks that must have changed at once. Derived: a digit changes as a whole, a person's parts one
    // after the other.
    double together = 0.6;
    // Share of the picture's width and height that writing has at most. Derived: three lines, or a large logo.
    double widest = 0.6, highest = 0.2;
    // Analysis pixels that are left out around the blocks. Derived: the width of the blur.
    int margin = 2;
    // Seconds without any evidence, and of contrary evidence, after which a box is forgotten.
    double keep = 30, keep_against = 3;
    // Seconds without growth after which a box is reported. Derived: five searches.
    double settled = 1;
  };

  BurntIn() = default;
  explicit BurntIn(const Parameters& parameters)
      : parameters_(parameters), changes_(parameters.changes), edges_(parameters.edges) {}

  // Forgets all but which boxes were new.
  void reset();
  // mask: 0 or 255, the foreground of frame k; out, without what is burnt in: a box is cleared but for the columns
  // whose pixels above and below it are foreground. Returns true when the number of boxes changes: the background model
  // has learnt the wrong content there. Allocates at a new size only.
  bool update(const BurntInInput& input, MutableGrayView mask);
  const BurntInBoxes& found() const { return found_; }
  std::span<const Box> boxes() const { return found_.boxes(); }
  std::size_t bytes() const;

 private:
  struct Place {  // in blocks, ends exclusive
    int left, top, right, bottom;
    double quiet = 0, against = 0, unchanged = 0;  // seconds
    bool changes = false;  // learnt, or seen, from changes of a standing camera's picture
  };

  void prepare(Size size);
  void look_for(const BurntInInput& input, GrayView mask, double seconds);
  void average_foreground(GrayView mask);
  void grow_rows();
  bool is_active(const Place& place) const;
  void grow_row(Place& place, int step);
  void search(bool still);
  Place take_component(int x, int y);
  void grow_foreground(Place& place) const;
  bool is_quiet_around(const Place& place, bool still) const;
  bool changes_together(const Place& place) const;
  bool is_too_large(const Place& place) const;
  void add(const Place& place);
  void forget(double seconds, bool still, bool compared);
  void publish(double seconds);

  Parameters parameters_;
  BlockGrid grid_;
  RecurrentChanges changes_;
  StaticEdges edges_;
  std::vector<std::uint8_t> foreground_;  // of a block: share of searches, 1/255
  std::vector<std::uint8_t> candidate_;   // scratch of the search, of a block
  std::vector<std::uint64_t> bits_;       // scratch, two sampled rows
  double now_ = 0, searched_ = 0, period_ = 0;
  std::vector<Place> places_;
  BurntInBoxes found_, reported_;
};

}  // namespace cerberus::vision
