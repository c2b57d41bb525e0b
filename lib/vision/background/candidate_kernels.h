// SPDX-License-Identifier: LGPL-2.1-or-later
// The inner loop of the candidate background, one row at a time (Highway, run-time dispatch), with its scalar reference. Planes
// belong to Image: rows are read and written up to the next multiple of 16 samples.
#pragma once

#include <array>
#include <cstdint>

#include "vision/background/background_kernels.h"

namespace cerberus::vision {

struct CandidateRow {
  // Pixels within which an edge is looked for; `above` and `below` are the frame's rows as far away.
  static constexpr int kReach = 2;
  static constexpr int kFollow = 4;  // frames, time constant of a candidate: the light changes
  static constexpr int kOfAge = 4;   // times less than the model's age that a candidate must have been seen

  const std::uint8_t *frame = nullptr, *above = nullptr, *below = nullptr;
  const std::uint8_t *age = nullptr, *quiet = nullptr;
  const std::uint64_t* foreground = nullptr;
  std::uint8_t *grey = nullptr, *seen = nullptr;  // the candidates; seen 0: none
  std::uint64_t* lasting = nullptr;
  int width = 0;
};
struct CandidateLimits {
  std::array<std::uint8_t, kBrightness>
      same{};                   // grey levels by the candidate's brightness: as far from it is the same
  std::uint8_t contrast = 0;    // grey levels, of an edge
  std::uint8_t least_seen = 0;  // frames
};
// For each pixel of the foreground: a frame that shows the candidate counts where the pixel rests (quiet > 0) and the frame has an
// edge; one that does not takes off one, and the frame replaces a candidate of 1 or none. `lasting` := foreground that shows a
// candidate seen for at least least_seen and for more than a quarter of the model's age; elsewhere 0.
void count_candidates(const CandidateRow& row, const CandidateLimits& limits);
// The pixels begin..end-1, all others as they are; of `lasting` bits are set only.
void count_candidates_reference(const CandidateRow& row, const CandidateLimits& limits, int begin, int end);

}  // namespace cerberus::vision
