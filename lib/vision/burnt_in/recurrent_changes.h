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

// A moving person changes the picture for several frames in a row, and at no interval. Own method. Times are
// kept in 16 bits, in steps of 4 ms: forget_old() keeps them from running over.
class RecurrentChanges {
 public:
  struct Parameters {
    // Grey levels by which a pixel must change to count, Th at least. Tried: at 48 bench-burnt_in no longer learns the
    // sans clock of a standing camera; with Th alone a person swaying in time is learnt (unit test places with
    // learning: 9 wrong regions, at 32 still 1).
    int least_step = 32;
    // Sampled pixels of a block (of 16) that must have changed. Swept: with 2 bench-burnt_in no longer learns the sans
    // clock of a standing camera (outdoor), whose thin digits cover few of the sampled rows.
    int least_changed = 1;
    // Share of the blocks beyond which a change is one of light or a cut, and counts for nothing. Chosen. Guard: unit
    // test "a picture that flashes teaches nothing".
    double whole_picture = 0.3;
    // Changes at once, each followed by rest, before a block counts. Derived: a clock's seconds within 5 s.
    int enough_changes = 3;
    // Seconds that they must span. Derived: five of a logo that blinks each second; as much of chance is rare.
    double enough_time = 2.4;
    // Frames that a change at once may take (interlacing, compression), and the rest that must follow: seconds, and
    // frames at low rates. Measured: people at 10 frames a second change a block every second frame for a while.
    int change_frames = 2;
    double rest = 0.4, rest_frames = 3.5;
    // Frame periods up to which two changes follow one another in a row. Derived: the frame rate's own jitter.
    double in_a_row = 1.5;
    // Intervals of a block's changes are equal, or small multiples of one another, within so many frame periods. Derived:
    // a change is seen up to a frame late; not every second changes every part of a digit.
    double interval_slack = 1.2, most_multiple = 3;
    // Seconds of change in every frame (but for `rest`) before a block counts. Chosen: longer than a person moves in one
    // block. Guard: people of vtest.avi and intel_one-by-one in bench-burnt_in.
    double enough_busy = 3;
    // Seconds after its last change until which a block counts. Derived: twice a clock's interval.
    double recent = 2;
    // Seconds after which changes are forgotten that were too few. Derived: a clock's tens, with some patience.
    double stale = 12;
  };

  RecurrentChanges() = default;
  explicit RecurrentChanges(const Parameters& parameters) : parameters_(parameters) {}

  void resize(const BlockGrid& grid);
  void reset();
  // The time of the next frame, seconds; period: between frames, smoothed.
  void set_time(double now, double period);
  // Counts the changes of that frame. difference: D(k); threshold: Th. Returns whether some blocks have changed, but not
  // so many that it was the light.
  bool update(GrayView difference, int threshold);
  // Forgets what is older than `stale`, in one row of blocks a call, below one frame a second in all rows. To be called a
  // few times a second, or in every frame.
  void forget_old();

  // In the frame that update() was called for last.
  bool changed(std::size_t block) const { return changed_[block]; }
  bool is_candidate(std::size_t block) const;
  // Seconds since the changes began that make the block a candidate, and since the last one; infinity: never.
  double since_begin(std::size_t block) const;
  double since_change(std::size_t block) const;
  void forget(std::size_t block) { blocks_[block] = {}; }
  std::size_t bytes() const {
    return blocks_.capacity() * sizeof(Block) + changed_.capacity() + bits_.capacity() * 8;
  }

 private:
  using Time = std::uint16_t;  // 0: never
  static constexpr double kTick = 0.004;
  // Seconds between frames beyond which all rows are aged in each of them. Derived: 16 bits of 4 ms are 262 s; up to 200
  // rows of blocks take less.
  static constexpr double kLongPeriod = 1;

  struct Block {
    Time last = 0, since = 0;    // last change, and since when there was one in every frame
    Time first = 0;              // of the changes that are counted
    std::uint16_t interval = 0;  // milliseconds between changes at once
    std::uint8_t frames = 0;     // changes in a row
    std::uint8_t changes = 0;    // changes at once that were followed by rest
  };

  double seconds_since(Time then) const { return static_cast<Time>(now_ - then) * kTick; }
  std::size_t find_changes(GrayView difference, int threshold);
  void note(Block& block);
  void forget_old(int row);
  double rest() const;
  bool keeps_time(Block& block, double seconds) const;
  bool is_recurrent(const Block& block) const { return block.changes + 1 >= parameters_.enough_changes; }

  Parameters parameters_;
  BlockGrid grid_;
  double period_ = 0;  // seconds
  Time now_ = 1;
  int aged_ = 0;  // row of blocks that was aged last
  std::vector<Block> blocks_;
  std::vector<std::uint8_t> changed_;  // of a block: 0 or 1
  std::vector<std::uint64_t> bits_;    // of two sampled rows
};

}  // namespace cerberus::vision
