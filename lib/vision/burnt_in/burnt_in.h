// SPDX-License-Identifier: LGPL-2.1-or-later
// Finds what a camera writes into its own pictures (a clock, a name, a logo), which would be foreground for ever: it
// keeps its place in the frame while the scene moves, or it changes again and again without leaving its own outline.
//
// Own method. Blocks of 8 x 4 analysis pixels in frame coordinates collect evidence: edges that stay while the camera
// turns, changes at once with rest between them while it stands, or in every frame. Blocks with evidence and all that
// moves beside them are one component: a person who waves, or whom the head follows, is taller than writing, or mostly
// without evidence. The box of a component is learnt, grows along its row by what changes at once (the next digit), and
// is forgotten seconds after the last evidence.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/burnt_in/burnt_in_boxes.h"
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
    // Seconds between two searches. Derived: 25 of them in the 5 s that learning may take.
    double search_period = 0.2;
    // Seconds without any evidence after which a box is forgotten.
    double keep = 6;
    // Seconds of changes before a block counts, and after the last one until which it does. Derived: three of a clock's
    // seconds, less a frame or two. Guard: people of vtest.avi and intel_one-by-one in bench-burnt_in.
    double enough = 2.8;
    // Seconds of rest that follow a change at once, which takes two frames (interlacing, compression). Guard: as above.
    double rest = 0.4;
    // Grey levels by which a sampled pixel of a block must change to count, Th at least, and that an edge exceeds. Swept:
    // at 32 bench-burnt_in learns a sans clock before a bright sky late, at 18 a person whom the head follows is learnt
    // (unit test). 24 serves.
    int step = 24;
    // Grey levels by which either side of a static edge may differ from the reference. Swept: at 12 a box is learnt from an
    // outdoor sweep where nothing is written (bench-burnt_in), 10 serves.
    int same = 10;
    // Analysis pixels by which the scene must have moved against the reference. Derived: more than an edge is wide.
    double least_shift = 3;
    // A search's share in a block's mean foreground and mean static edges, as its inverse. Derived: a mean over the last
    // seconds, and three searches with static edges before a block counts. Swept: at 14 a blinking logo is learnt after
    // 5 s (unit test).
    int memory = 12;
    // Share of searches in which a block is foreground, or has static edges, to count as such. Swept: at .3 a blinking logo
    // is left over (unit test). Guard: bench-burnt_in.
    double often = 0.2;
    // Blocks that may lie between two parts of a component: digits, or the arms and the head of a person.
    int gap = 2;
    // Share of the picture's height that writing has at most. Derived: three lines, or a large logo.
    double highest = 0.2;
  };

  BurntIn() = default;
  explicit BurntIn(const Parameters& parameters) : parameters_(parameters) {}

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
  using Time = std::uint32_t;  // milliseconds, modulo 2^32 (50 days)

  enum class State : std::uint8_t { quiet, active, evident };

  struct Block {
    Time first = 0, burst = 0,
         last = 0;  // change: of those that are evidence, of the present burst, and of all
    std::uint8_t fixed = 0, foreground = 0;  // share of searches, 1/255
    // Scratch of a search: edges that have stayed, less those that have not; what the block is.
    std::int8_t votes = 0;
    State state = State::quiet;
  };

  struct Place {  // in blocks, ends exclusive
    int left, top, right, bottom;
    double quiet = 0;      // seconds without evidence
    bool changes = false;  // learnt, or seen, from changes of a standing camera's picture
    bool grown_by(const Place& other, int gap) const {
      return other.left <= right + gap && other.right >= left - gap && other.top <= bottom &&
             other.bottom >= top;
    }
  };

  Block& at(int x, int y) { return blocks_[static_cast<std::size_t>(y) * columns_ + x]; }
  void prepare(Size size);
  template <typename Each>
  void for_blocks(const Place& place, Each each);
  template <typename Found>
  void find_pixels(const std::uint8_t* row, int width, int y, int limit, Found found);
  void note_change(Block& block);
  void average(std::uint8_t& share, bool is) const;
  bool compare_edges(GrayView picture);
  void search(bool still);
  Place take_component(int x, int y, int& evident, int& active);
  void add(const Place& component, bool evident, bool still);
  void forget(double seconds, bool still, bool compared);
  void publish();

  Parameters parameters_;
  Size size_;
  int columns_ = 0, rows_ = 0;
  std::vector<Block> blocks_;
  std::vector<std::uint64_t> bits_;  // scratch, a sampled row
  std::vector<std::uint8_t> edges_;  // scratch, a sampled row
  Image<std::uint8_t> reference_;    // the sampled rows of a picture before
  Transform from_reference_;
  bool referenced_ = false;
  Time now_ = 0, searched_ = 0;
  double period_ = 0;  // seconds
  std::vector<Place> places_;
  BurntInBoxes found_, reported_;
};

}  // namespace cerberus::vision
