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
    // seen to move. Where it has moved before, the picture becomes the reference at once: of a logo that blinks each
    // second two comparisons in five see it in both.
    double reference_time = 0.8;
    // Analysis pixels by which the scene must have moved against the reference. Derived: more than an edge is wide.
    double least_shift = 3;
    // Grey levels over two pixels that an edge exceeds, and by which either side may differ from the reference. Swept for
    // `same`: at 15 a person followed by the head is learnt (unit test), 10 and 12 serve. Guard: bench-burnt_in.
    std::uint8_t edge = 39, same = 10;
    // Comparisons with static edges, less an eighth of those without, before a block is evidence. Swept: with 4 the
    // blinking logo of bench-burnt_in is learnt after 5.4 s (.024 of the frames of the outdoor sweep), with 3 before 5 s.
    int enough = 3;
    // Other edges for each static one, beyond which a comparison is contrary evidence. Swept: at 2 the sans clock of a
    // sweeping camera, between whose thin digits the scene moves, is forgotten after 17 s (bench-burnt_in, outdoor: .078
    // of the frames), 3 and 4 serve (.000).
    int contrary = 3;
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
  void renew(GrayView picture, double now);

  bool is_candidate(std::size_t block) const { return score_[block] >= kScore * parameters_.enough; }
  // Forgets the evidence of a block.
  void forget(std::size_t block) { score_[block] = 0; }
  // Edge pixels at the last comparison, of a block: static ones, and others where the scene has moved.
  int fixed(std::size_t block) const { return fixed_[block]; }
  int moved(std::size_t block) const { return moved_[block]; }
  // Whether such counts, of one block or of several, speak against burnt-in content.
  bool is_contrary(int fixed, int moved) const { return moved > parameters_.contrary * fixed; }
  std::size_t bytes() const;

 private:
  // What a comparison with static edges adds to a block's score; one without takes 1 away.
  static constexpr int kScore = 8;

  enum class Across { nowhere, columns, rows };
  Across direction(const Point& left, const Point& right) const;
  void compare_blocks(GrayView picture, int row, int word, Across across);

  Parameters parameters_;
  BlockGrid grid_;
  std::vector<std::uint8_t> score_, fixed_, moved_;  // of a block
  Image<std::uint8_t> reference_;                    // its sampled rows
  Transform from_reference_;
  double until_ = 0;  // seconds, when the reference is renewed
  bool referenced_ = false;
};

}  // namespace cerberus::vision
