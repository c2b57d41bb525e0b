// SPDX-License-Identifier: LGPL-2.1-or-later
// Parts blobs that closing has joined: it bridges the fragments of one person, and with their shadows also the people beside
// one another. A valley is where hardly anything of a column is foreground, between columns of which much is. What rests is
// not parted from its neighbour: it may be the place that a person has left. (The idea of finding people in a blob by its
// vertical projection: I. Haritaoglu, D. Harwood, L. S. Davis, "W4: real-time surveillance of people and their
// activities", PAMI 22(8), 2000.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/detection/change.h"
#include "vision/image/labelling.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

class BlobParting {
 public:
  // Lengths in heights of the blob. Guard: tests/unit (blob_parting, regions), MOTA on TUD-Campus and TUD-Stadtmitte.
  struct Parameters {
    int least_height = 40;  // pixels of a blob. derived: a valley is 3 rows; less is noise
    // Foreground in a column through the trunk of a person, who may be lower than the blob. swept: .3 to .5.
    double trunk = 0.38;
    // Foreground in the emptiest column between two people: their shadow. swept: .02 to .15.
    double valley = 0.07;
    // Share of the foreground on both sides that differs from the frame before. swept: .2 to .4. Guard:
    // bench-steady, where a place that was left is a region with .28 and less.
    double changed = 0.35;
  };

  BlobParting() = default;
  explicit BlobParting(const Parameters& parameters) : parameters_(parameters) {}

  // Takes the memory for pictures of this width, pixels; part() takes none.
  void preallocate(int width);
  // Clears in `closed` the emptiest columns of every valley between two people of a blob. The blob is number `self` of the
  // components of `closed`, and `runs` has the runs of all of them. moving: the foreground before closing. change: where the
  // picture differs from the frame before. All are of one size. Returns whether the blob was parted: then the components are
  // to be found anew.
  bool part(const Component& blob, std::size_t self, std::span<const Run> runs, BitView moving,
            const Change& change, MutableBitView closed);
  std::size_t bytes() const;

 private:
  static constexpr std::size_t kMostValleys = 16;  // in one blob

  struct Columns {
    int from = 0, to = 0;
  };
  void find_valleys(const Component& blob);
  void join_resting(const Component& blob);
  bool changes(Columns columns) const;
  Columns emptiest(Columns between) const;

  Parameters parameters_;
  // Scratch. Pixels of the foreground, and of it those that changed, in each column of the picture, in the rows of a blob.
  std::vector<std::uint16_t> moving_, changed_;
  std::vector<Columns> valleys_;  // of that blob: their emptiest columns
};

}  // namespace cerberus::vision
