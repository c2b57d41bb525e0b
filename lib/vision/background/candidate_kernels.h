// SPDX-License-Identifier: LGPL-2.1-or-later
// The inner loop of the candidate background, one row at a time (Highway, run-time dispatch), with its scalar reference. Rows
// belong to Image; nothing is read or written beyond a row's width.
#pragma once

#include <array>
#include <cstdint>

#include "vision/background/background_kernels.h"

namespace cerberus::vision {

struct CandidateRow {
  // Pixels within which an edge is looked for; `above` and `below` are the frame's rows as far away. derived: the pictures are
  // blurred, and an edge is as wide.
  static constexpr int kReach = 2;
  // Frames, time constant with which a candidate follows the light; differences below it in grey levels are not followed.
  static constexpr int kFollow = 4;
  // A candidate lasts when it was seen for more than 1 / kOfAge of the model's age. swept: docs/quality.md, 0 to .4 of it.
  static constexpr int kOfAge = 4;

  const std::uint8_t *frame = nullptr, *above = nullptr, *below = nullptr;
  const std::uint8_t *age = nullptr, *quiet = nullptr;
  const std::uint64_t* foreground = nullptr;
  std::uint8_t *grey = nullptr, *seen = nullptr;  // the candidates; seen 0: none
  std::uint64_t* lasting = nullptr;
  int width = 0;
};
struct CandidateLimits {
  // Grey levels, by the candidate's brightness: what differs from it by no more is the same.
  std::array<std::uint8_t, kBrightness> same{};
  std::uint8_t contrast = 0;    // grey levels, of an edge
  std::uint8_t least_seen = 1;  // frames, at least 1
};
// For each pixel of the foreground: a frame that shows the candidate counts where the pixel rests (quiet > 0) and the frame
// has an edge. A frame that shows something else takes one off, and replaces a candidate that was seen once or never.
// `lasting` := foreground that shows a candidate seen for at least least_seen frames, and for more than a quarter of the
// model's age; elsewhere 0.
void count_candidates(const CandidateRow& row, const CandidateLimits& limits);
// The same for the pixels begin..end-1. Bits of `lasting` are set, and never cleared.
void count_candidates_reference(const CandidateRow& row, const CandidateLimits& limits, int begin, int end);

}  // namespace cerberus::vision
