// SPDX-License-Identifier: LGPL-2.1-or-later
// Evidence of burnt-in content while the camera stands: blocks that change at once, rest, and change again in time, as a
// clock's digits and a blinking logo do; and blocks that change in every frame for seconds, as a running count does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vision/burnt_in/block_grid.h"
#include "vision/image/image.h"

namespace cerberus::vision {

// A moving person changes the picture for several frames in a row, and at no interval. Own method.
class RecurrentChanges {
 public:
  struct Parameters {
    // Grey levels by which a sampled pixel of a block must change to count, Th at least. Tried: at 48 bench-burnt_in no
    // longer learns the sans clock of a standing camera; with Th alone a person swaying in time is learnt (unit test
    // places with learning: 9 wrong regions, at 32 still 1).
    int least_step = 32;
    // Share of the blocks beyond which a change is one of light or a cut, and counts for nothing. Chosen. Guard: unit
    // test "a picture that flashes teaches nothing".
    double whole_picture = 0.3;
    // Seconds of changes in time, or in every frame, before a block counts, and after the last one until which it does.
    // Derived: three of a clock's seconds, less a frame or two. Guard: people of vtest.avi and intel_one-by-one in
    // bench-burnt_in.
    double enough = 2.8;
    // Changes that came in time before a block counts. Derived: one does by chance.
    int enough_in_time = 2;
    // Frames that a change at once may take (interlacing, compression), and seconds of rest that must follow. Measured:
    // people at 10 frames a second change a block every second frame for a while.
    int change_frames = 2;
    double rest = 0.4;
    // Frame periods up to which two changes follow one another in a row, or are late for an interval. Derived: a change
    // is seen up to a frame late, and the frame rate's own jitter.
    double jitter = 1.5;
    // Intervals of a block's changes are equal, or small multiples of one another, up to this. Derived: not every second
    // changes every part of a digit.
    double most_multiple = 3;
    // Seconds after which changes are forgotten that were too few. Derived: a clock's tens, with some patience.
    double stale = 12;
  };

  RecurrentChanges() = default;
  explicit RecurrentChanges(const Parameters& parameters) : parameters_(parameters) {}

  void resize(const BlockGrid& grid);
  void reset();
  // The time of the next frame; period: since the frame before; seconds.
  void set_time(double now, double period);
  // Counts the changes of that frame. difference: D(k); threshold: Th. Returns whether some blocks have changed, but not
  // so many that it was the light.
  bool update(GrayView difference, int threshold);

  // In the frame that update() was called for last.
  bool changed(std::size_t block) const { return changed_[block]; }
  bool is_candidate(std::size_t block) const;
  // Seconds since the changes began that make the block a candidate, `stale` at most, and since the last one; infinity:
  // never.
  double since_begin(std::size_t block) const;
  double since_change(std::size_t block) const;
  void forget(std::size_t block) { blocks_[block] = {}; }
  std::size_t bytes() const {
    return blocks_.capacity() * sizeof(Block) + changed_.capacity() + bits_.capacity() * 8;
  }

 private:
  using Time = std::uint32_t;  // milliseconds, modulo 2^32 (50 days); 0: never

  struct Block {
    Time last = 0, since = 0;    // last change, and since when there was one in every frame
    Time first = 0;              // of the changes that are counted
    std::uint16_t interval = 0;  // milliseconds between changes at once
    std::uint8_t frames = 0;     // changes in a row
    std::uint8_t in_time = 0;    // changes at once that came in time, in a row
  };

  double seconds_since(Time then) const { return (now_ - then) / 1000.0; }
  void note(Block& block);
  bool keeps_time(Block& block, double seconds) const;
  bool is_recurrent(const Block& block) const { return block.in_time >= parameters_.enough_in_time; }

  Parameters parameters_;
  BlockGrid grid_;
  double period_ = 0;  // seconds
  Time now_ = 1;
  std::vector<Block> blocks_;
  std::vector<std::uint8_t> changed_;  // of a block: 0 or 1
  std::vector<std::uint64_t> bits_;    // of two sampled rows
};

}  // namespace cerberus::vision
