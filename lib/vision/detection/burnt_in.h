// SPDX-License-Identifier: LGPL-2.1-or-later
// Finds what a camera writes into its own pictures (a clock, a name, a logo), which would be foreground for ever: it
// keeps its place in the frame while the scene moves, or it changes again and again without leaving its own outline.
//
// Own method. The map has blocks of 8 x 4 analysis pixels in frame coordinates and two kinds of evidence:
// - The camera turns: edges of the picture that lie where they lay in a reference picture of up to 1.7 s ago, while the
//   ego-motion says that the scene has moved there (`static_edges`). A target followed by the head keeps its place,
//   too, but not to the pixel, and not all of it: above and below its static parts there is foreground. Writing ends
//   there.
// - The camera stands: a digit or a logo changes from one frame to the next and rests until it changes again. A moving
//   person changes the picture for several frames in a row. A running count (milliseconds) changes in every frame for
//   seconds. In both cases nothing changes above and below meanwhile.
// Blocks with enough evidence are joined to boxes. A box grows along its row by what changes at once (the next digit).
// It is forgotten when the evidence stops: its row moves along with the scene, or has not changed for long.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/geometry/box.h"
#include "vision/geometry/transform.h"
#include "vision/image/image.h"
#include "vision/image/mask.h"

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
  static constexpr int kBlockWidth = 8, kBlockHeight = 4;  // analysis pixels

  struct Parameters {
    // Seconds between two looks at static edges and at the map. Derived: 25 looks in the 5 s that learning may take.
    double look_period = 0.2;
    // Seconds for which a reference picture is kept at most. Derived: a scene that moves by four pixels a second is
    // seen to move. Where it has moved enough at the next look, that becomes the reference: of a logo that blinks each
    // second two looks in five see it in both.
    double reference_time = 0.8;
    // Analysis pixels by which the scene must have moved against the reference. Derived: more than an edge is wide.
    double least_shift = 3;
    // Grey levels over two pixels across an edge, and by which its pixels may differ from the reference. Chosen, not
    // swept. Guard: bench-burnt_in.
    int edge = 40, same = 10;
    // Pixels of a block (of 32) that must be static edges. Chosen, not swept. Guard: bench-burnt_in.
    int least_static = 4;
    // Looks with static edges, less an eighth of the looks without, before a block counts, and before it counts beside
    // one that does: .8 s and .4 s at least.
    int enough_looks = 4, some_looks = 2;
    // References that must have agreed. Derived: one may be matched by chance, or by a part of a followed person.
    int enough_references = 3;
    // Share of looks in which a block beside static ones is foreground, to belong to them; and in which blocks above
    // or below are, to show that the static part is a part of something larger.
    double belongs = 0.3, continues = 0.3;
    // Grey levels by which a pixel must change to count, Th at least. Tried: at 48 bench-burnt_in no longer learns the
    // sans clock of a standing camera; with Th alone a person swaying in time is learnt (unit test places with
    // learning: 9 wrong regions, at 32 still 1).
    int least_step = 32;
    // Pixels of a block (of 32) that must have changed. Derived: above single pixels of noise.
    int least_changed = 3;
    // Changes at once, each followed by rest, before a block counts. Derived: a clock's seconds within 5 s.
    int enough_changes = 3;
    // Seconds that they must span. Derived: five of a logo that blinks each second; as much of chance is rare.
    double enough_time = 2.4;
    // Frames that a change at once may take (interlacing, compression), and the rest that must follow: seconds, and
    // frames at low rates. Measured: people at 10 frames a second change a block every second frame for a while.
    int change_frames = 2;
    double rest = 0.4, rest_frames = 3.5;
    // Seconds of change in every frame (but for `rest`) before a block counts.
    double enough_busy = 3;
    // Seconds after which changes are forgotten that were too few.
    double stale = 12;
    // Share of the blocks beyond which a change is one of light or a cut, and counts for nothing.
    double whole_picture = 0.3;
    // Share of the picture's width and height that writing has at most. Derived: three lines, or a large logo.
    double widest = 0.6, highest = 0.2;
    // Blocks that may lie between two digits.
    int gap = 2;
    // Seconds without any evidence, and of contrary evidence, after which a box is forgotten.
    double keep = 30, keep_against = 3;
    // Share of a box and its last report that both must cover to be reported as the same.
    double same_report = 0.6;
  };

  BurntIn() = default;
  explicit BurntIn(const Parameters& parameters) : parameters_(parameters) {}

  // Forgets all.
  void reset();
  // mask: 0 or 255, the foreground of frame k; out, without what is burnt in: a box is cleared but for the columns
  // whose pixels above and below it are foreground. Returns true when boxes() is worth another report: one more, one
  // less, or much larger. Allocates at a new size only.
  bool update(const BurntInInput& input, MutableGrayView mask);
  // What is learnt, analysis pixels. The span lives until the next call.
  std::span<const Box> boxes() const { return found_; }
  std::size_t bytes() const;

 private:
  struct Block {
    std::uint32_t last = 0,
                  since = 0;      // milliseconds: last change, and since when there was one in every frame
    std::uint32_t first = 0;      // milliseconds: of the changes that are counted
    std::uint16_t interval = 0;   // milliseconds between changes at once
    std::uint8_t frames = 0;      // changes in a row
    std::uint8_t changes = 0;     // changes at once that were followed by rest
    std::uint8_t score = 0;       // of static edges
    std::uint8_t references = 0;  // with static edges; the highest bit: the present one
    std::uint8_t foreground = 0;  // share of looks, 1/255
    std::uint8_t candidate = 0;   // scratch of the search
  };
  struct Place {  // in blocks, ends exclusive
    int left, top, right, bottom;
    double quiet = 0, against = 0;  // seconds
    bool changes = false;           // learnt, or seen, from changes of a standing camera's picture
  };

  void prepare(Size size);
  void note_changes(const BurntInInput& input);
  void note_change(Block& block);
  double rest() const;
  bool keeps_time(Block& block, double seconds) const;
  void grow_rows();
  void look_at_edges(const BurntInInput& input);
  void look_at_foreground(GrayView mask);
  void search(bool still);
  void grow_foreground(Place& place) const;
  bool is_writing(const Place& place, bool still) const;
  void add(const Place& place);
  void forget(double seconds, bool looked);
  void publish();
  bool is_news();
  void clear(MutableGrayView mask) const;
  Block& block(int x, int y) { return blocks_[static_cast<std::size_t>(y) * columns_ + x]; }
  const Block& block(int x, int y) const { return blocks_[static_cast<std::size_t>(y) * columns_ + x]; }
  bool changed(int x, int y) const { return changed_[static_cast<std::size_t>(y) * columns_ + x]; }

  Parameters parameters_;
  Size size_;
  int columns_ = 0, rows_ = 0;
  std::vector<Block> blocks_;
  std::vector<std::uint8_t> changed_;          // this frame, a block each
  std::vector<std::uint8_t> static_, moving_;  // edge pixels at the last look, a block each
  std::vector<std::int32_t> stack_;            // of the search
  BitMask bits_;
  Image<std::uint8_t> reference_;
  Transform from_reference_;
  double now_ = 0, last_look_ = 0, reference_until_ = 0, period_ = 0;
  int standing_ = 0;  // frames
  bool referenced_ = false, changed_any_ = false;
  std::vector<Place> places_;
  std::vector<Box> found_, reported_;
};

}  // namespace cerberus::vision
