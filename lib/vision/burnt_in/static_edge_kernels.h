// SPDX-License-Identifier: LGPL-2.1-or-later
// Inner loop of StaticEdges, chosen for the processor at run time.
#pragma once

#include <cstdint>

namespace cerberus::vision {

// Two rows of samples of the same picture: those on either side of up to 64 possible edges.
struct EdgeSides {
  const std::uint8_t *first, *second;
};
struct EdgeBits {
  std::uint64_t edges = 0;  // |now.second - now.first| >= edge
  std::uint64_t fixed = 0;  // of the edges: both sides differ from `then` by at most `same`
};

// The edges between first[i] and second[i], i < count (0..64), as bit i. edge, same: grey levels.
EdgeBits compare_edges(EdgeSides now, EdgeSides then, int count, std::uint8_t edge, std::uint8_t same);
EdgeBits compare_edges_reference(EdgeSides now, EdgeSides then, int count, std::uint8_t edge,
                                 std::uint8_t same);

}  // namespace cerberus::vision
