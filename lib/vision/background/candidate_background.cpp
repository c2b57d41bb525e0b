// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/background/candidate_background.h"

#include <algorithm>
#include <cmath>

#include "vision/background/candidate_kernels.h"

namespace cerberus::vision {
namespace {

// swept: docs/quality.md. Guard of all: the means of TUD-Stadtmitte (bench-variants), unit candidate_background.
constexpr struct Parameters {
  double lasting = 0.45;  // s for which a candidate must have been seen in all
  // Frames, at least. derived: at 10 a second and less .45 s are so few that a passer may look alike in each.
  int least_frames = 5;
  // Grey levels within CandidateRow::kReach pixels: a frame counts only where it has an edge. Two coats alike are no
  // candidate.
  std::uint8_t contrast = 12;
} kParameters;

}  // namespace

void CandidateBackground::preallocate(Size picture) {
  grey_.resize(picture);
  seen_.resize(picture);
  lasting_.resize(bit_mask_size(picture));
  reset();
}

void CandidateBackground::reset() {
  seen_.fill_bytes(0);
  lasting_.fill_bytes(0);
}

void CandidateBackground::set_period(double seconds) {
  const Parameters& p = kParameters;
  least_seen_ = static_cast<std::uint8_t>(
      std::clamp(std::round(p.lasting / seconds), static_cast<double>(p.least_frames), 254.0));
}

void CandidateBackground::update(const Pictures& pictures, const std::array<double, kBrightness>& noise) {
  CandidateLimits limits;
  limits.contrast = kParameters.contrast;
  limits.least_seen = least_seen_;
  // As far from a candidate is the same as the comparison tolerates from the background, without spread and edges.
  for (int c = 0; c < kBrightness; ++c)
    limits.same[c] = static_cast<std::uint8_t>(
        std::clamp(CompareLimits::strong_sigmas * noise[c], CompareLimits::strong_least / 16.0, 255.0));
  const GrayView& frame = pictures.frame;
  CandidateRow row;
  row.width = frame.width;
  for (int y = 0; y < frame.height; ++y) {
    row.frame = frame.row(y);
    row.above = frame.row(std::max(y - CandidateRow::kReach, 0));
    row.below = frame.row(std::min(y + CandidateRow::kReach, frame.height - 1));
    row.age = pictures.age.row(y), row.quiet = pictures.quiet.row(y),
    row.foreground = pictures.foreground.row(y);
    row.grey = grey_.view().row(y), row.seen = seen_.view().row(y), row.lasting = lasting_.view().row(y);
    count_candidates(row, limits);
  }
}

}  // namespace cerberus::vision
