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
    // Seconds between frames, assumed where no frame has a time; and the share of a new distance in their mean.
    double usual_period = 0.04, period_rate = 0.1;
    // Frames for which the camera has stood before changes are counted. Derived: the differences of the first frames
    // still contain the motion.
    int standing = 2;
    // Sampled pixels of a block (of 16) that must be foreground. Derived: above single pixels of noise.
    int least_foreground = 2;
    // A search's share in a block's mean foreground, as its inverse. Derived: a mean over the last second or so.
    int foreground_memory = 6;
    // Share of searches in which a block beside static ones is foreground, to belong to them; and in which blocks above
    // or below are, to show that the static part is a part of something larger.
    double belongs = 0.3, continues = 0.3;
    // Blocks from a box that may still belong to it, and as far as which its surroundings are judged.
    int near = 1, far = 3;
    // Share of the surroundings that may be foreground, or change with the box. Chosen, not swept. Guard: people of
    // vtest.avi and intel_one-by-one in bench-burnt_in.
    double around = 0.1;
    // Share of a box's blocks that must have changed within so many frames of one another. Derived: a digit changes as a
    // whole, a person's parts one after the other.
    double together = 0.6, together_frames = 2.5;
    // Share of a row or column of blocks that must be foreground for a box to grow over it.
    double grows = 0.25;
    // Share of the picture's width and height that writing has at most. Derived: three lines, or a large logo.
    double widest = 0.6, highest = 0.2;
    // Blocks that may lie between two digits, and the fewest blocks with evidence.
    int gap = 2, least_blocks = 2;
    // Analysis pixels that are left out around the blocks. Derived: the width of the blur.
    int margin = 2;
    // Other edges for each static one of a box, beyond which a comparison is contrary evidence. Swept: at 2 the sans clock
    // of a sweeping camera, between whose thin digits the scene moves, is forgotten after 17 s (bench-burnt_in, outdoor:
    // .078 of the frames), 3 and 4 serve (.000).
    int contrary = 3;
    // Seconds without any evidence, and of contrary evidence, after which a box is forgotten.
    double keep = 30, keep_against = 3;
    // Seconds without growth after which a box is reported. Derived: five searches.
    double settled = 1;
    // Overlap (intersection over union) below which a box is another one, whose surroundings were learnt wrongly.
    double same_box = 0.6;
  };

  BurntIn() = default;
  explicit BurntIn(const Parameters& parameters)
      : parameters_(parameters), changes_(parameters.changes), edges_(parameters.edges) {}

  // Forgets all but which boxes were new.
  void reset();
  // mask: 0 or 255, the foreground of frame k; out, without what is burnt in: a box is cleared but for the columns
  // whose pixels above and below it are foreground. Returns true when a box was added, removed, or has grown so much
  // that the background model has learnt the wrong content around it. Allocates at a new size only.
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
  double measure_time(double seconds);
  void look_for(const BurntInInput& input, GrayView mask, double seconds);
  void average_foreground(GrayView mask);
  void grow_rows();
  bool is_active(const Place& place) const;
  void grow_row(Place& place, int step);
  bool any_candidates(bool still);
  void search(bool still);
  bool touches_taken(int x, int y) const;
  Place take_component(int x, int y, bool still, int& count, bool& strong);
  void grow_foreground(Place& place) const;
  bool is_quiet_around(const Place& place, bool still) const;
  bool changes_together(const Place& place) const;
  bool is_too_large(const Place& place) const;
  void add(const Place& place);
  void forget(double seconds, bool compared);
  void publish(double seconds);
  bool is_changed();

  Parameters parameters_;
  BlockGrid grid_;
  RecurrentChanges changes_;
  StaticEdges edges_;
  std::vector<std::uint8_t> foreground_;  // of a block: share of searches, 1/255
  std::vector<std::uint8_t> candidate_;   // scratch of the search, of a block
  std::vector<std::uint64_t> bits_;       // scratch, two sampled rows
  double now_ = 0, searched_ = 0, period_ = 0;
  int standing_ = 0;  // frames
  std::vector<Place> places_;
  BurntInBoxes found_, published_, reported_;
};

}  // namespace cerberus::vision
