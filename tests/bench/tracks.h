// SPDX-License-Identifier: LGPL-2.1-or-later
// How well tracks follow annotated people: CLEAR MOT (K. Bernardin, R. Stiefelhagen, "Evaluating multiple object tracking
// performance", EURASIP JIVP 2008) and IDF1 (E. Ristani et al., "Performance measures and a data set for multi-target,
// multi-camera tracking", ECCV workshops 2016), at IoU >= 0.5.
#pragma once

#include <map>
#include <span>
#include <utility>

#include "boxes.h"
#include "vision/tracking/assignment.h"

namespace cerberus::bench {

class TrackScore {
 public:
  // One frame. A person keeps the track of the frame before where the two still overlap; the others are paired for the
  // largest total overlap. Returns the index of each person's found box, or -1; it lives until the next call.
  std::span<const int> add(std::span<const Person> truth, std::span<const Person> found);

  // Misses, wrong boxes and changes of identity against the annotated boxes: 1 - (missed + extra + switches) / truth.
  double mota() const;
  // Boxes whose identity is right under the best one-to-one pairing of persons and tracks, as an F measure.
  double idf1() const;
  double precision() const { return hits_ > 0 ? hits_ / (hits_ + extra_) : 0; }
  double recall() const { return hits_ > 0 ? hits_ / (hits_ + missed_) : 0; }
  int switches() const { return switches_; }

 private:
  double hits_ = 0, extra_ = 0, missed_ = 0;
  int switches_ = 0;
  std::map<int, int> last_;                           // person: its last track
  std::map<std::pair<int, int>, double> overlapped_;  // person and track: frames
  vision::Assignment assignment_;
};

}  // namespace cerberus::bench
