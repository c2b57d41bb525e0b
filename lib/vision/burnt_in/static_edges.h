// SPDX-License-Identifier: LGPL-2.1-or-later
// Evidence of burnt-in content while the camera turns: edges that keep their place in the frame while the ego-motion says
// that the scene has moved there.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vision/burnt_in/block_grid.h"
#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

// Compares the picture with a reference picture of up to `reference_time` ago. Own method.
class StaticEdges {
 public:
  struct Parameters {
    // Seconds for which a reference picture is kept at most. Derived: a scene that moves by four pixels a second is
    // seen to move. Where it has moved enough before, the picture becomes the reference at once: of a logo that blinks
    // each second two comparisons in five see it in both.
    double reference_time = 0.8;
    // Analysis pixels by which the scene must have moved against the reference. Derived: more than an edge is wide.
    double least_shift = 3;
    // Grey levels over two pixels across an edge, and by which either side may differ from the reference. Swept for
    // `same`: at 15 a person followed by the head is learnt (unit test), 10 and 12 serve. Guard: bench-burnt_in.
    std::uint8_t edge = 40, same = 10;
    // Sampled pixels of a block (of 16) that must be static edges. Chosen, not swept. Guard: bench-burnt_in.
    int least_static = 2;
    // What a comparison with static edges adds to a block's score; one without takes 1 away. Chosen. Guard: the
    // blinking logos of bench-burnt_in.
    int score = 8;
    // Comparisons with static edges, less an eighth of those without, before a block is strong evidence, and before it
    // is evidence beside one that is. Swept: with 4 the blinking logo of bench-burnt_in is learnt after 5.4 s (.024 of
    // the frames of the outdoor sweep), with 3 before 5 s (.000).
    int enough = 3, some = 2;
    // References that must have agreed. Derived: one may be matched by chance, or by a part of a followed person.
    int enough_references = 3;
  };

  StaticEdges() = default;
  explicit StaticEdges(const Parameters& parameters) : parameters_(parameters) {}

  void resize(const BlockGrid& grid);
  void reset();
  // The camera's motion from the last frame to this one, analysis pixels.
  void follow(const Transform& motion) { from_reference_ = motion * from_reference_; }
  // Compares F(k) with the reference; returns false where there is none, or the scene has not moved against it. The
  // counts below are those of this call.
  bool compare(GrayView picture);
  // Takes F(k) as the reference where it is time, seconds.
  void renew(GrayView picture, double now, double period);

  // 1 in the byte of each of the eight blocks from `first` on that have some evidence.
  std::uint64_t candidates(std::size_t first) const {
    return bytes_at_least(load_counts(score_.data() + first), parameters_.score * parameters_.some);
  }
  bool is_strong(std::size_t block) const {
    return score_[block] >= parameters_.score * parameters_.enough &&
           (references_[block] & ~kPresent) >= parameters_.enough_references;
  }
  // Forgets the evidence of a block.
  void forget(std::size_t block) { score_[block] = references_[block] = 0; }
  // Edge pixels at the last comparison, of a block: static ones, and others where the scene has moved.
  int fixed(std::size_t block) const { return fixed_[block]; }
  int moved(std::size_t block) const { return moved_[block]; }
  // Whether counts of edges, of one block or of several, are evidence of burnt-in content, or against it.
  bool is_static(int fixed, int moved) const { return fixed >= parameters_.least_static && fixed > moved; }
  bool has_edges(int count) const { return count >= parameters_.least_static; }
  std::size_t bytes() const;

 private:
  static constexpr std::uint8_t kPresent = 0x80;  // the present reference has agreed

  enum class Across { nowhere, columns, rows };
  Across direction(const Point& left, const Point& right) const;
  void compare_blocks(GrayView picture, int row, int word, Across across);
  void rate_blocks(std::size_t first);

  Parameters parameters_;
  BlockGrid grid_;
  std::vector<std::uint8_t> score_, references_, fixed_, moved_;  // of a block
  Image<std::uint8_t> reference_;                                 // its sampled rows
  Transform from_reference_;
  double until_ = 0;  // seconds, when the reference is renewed
  bool referenced_ = false;
};

}  // namespace cerberus::vision
