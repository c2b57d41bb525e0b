// SPDX-License-Identifier: LGPL-2.1-or-later
// Blobs that closing has joined: it bridges the fragments of one person, and with their shadows also the people beside one
// another. They are parted where hardly anything of a column is foreground, between columns of which much is, if what lies
// on either side changes: a person and the place that he leaves stay one. (The idea of finding people in a blob by its
// vertical projection: I. Haritaoglu, D. Harwood, L. S. Davis, "W4: real-time surveillance of people and their activities",
// PAMI 22(8), 2000.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/detection/regions.h"
#include "vision/image/labelling.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

class BlobParting {
 public:
  // Lengths in heights of the blob. Guard: tests/unit (blob_parting, regions), MOTA on TUD-Campus and TUD-Stadtmitte.
  struct Parameters {
    int least_height = 40;  // pixels of a blob. derived: its valleys are 3 pixels high
    // Width beyond which a blob may be several people. derived: a walker in stride is .43 wide.
    double several = 0.5;
    // Foreground in a column through the trunk of a person, who may be lower than the blob. swept: docs/quality.md,
    // .3 to .5.
    double trunk = 0.42;
    // Foreground in the emptiest column between two people: their shadow. swept: docs/quality.md, .02 to .15.
    double valley = 0.07;
    // Share of the foreground on either side that differs from the frame before. swept: docs/quality.md, 0 to .4. Guard:
    // bench-steady, unit (steady, places), where a place that was left becomes a region with .15.
    double changed = 0.35;
  };

  BlobParting() = default;
  explicit BlobParting(const Parameters& parameters) : parameters_(parameters) {}

  // Takes the memory for pictures of this width, pixels; part() takes none.
  void preallocate(int width);
  // Clears in `closed` the emptiest columns of every valley between two people of a blob. runs: those of all components of
  // `closed`, of which the blob is number `self`. moving: the foreground before closing, of the same picture; change: where that
  // differs from the frame before. Returns whether it was parted: then the components are to be found anew.
  bool part(const Component& blob, std::size_t self, std::span<const Run> runs, BitView moving,
            const Change& change, MutableBitView closed);
  std::size_t bytes() const;

 private:
  static constexpr std::size_t kMostValleys = 16;  // in one blob

  struct Columns {
    int from = 0, to = 0;
  };
  void find_valleys(const Component& blob);
  void drop_resting(const Component& blob);
  bool changes(Columns columns) const;
  Columns emptiest(Columns between) const;

  Parameters parameters_;
  // Scratch. Pixels of the foreground, and of it those that changed, in each column of the picture, in the rows of a blob.
  std::vector<std::uint16_t> moving_, changed_;
  std::vector<Columns> valleys_;  // of that blob: their emptiest columns
};

}  // namespace cerberus::vision
