// SPDX-License-Identifier: LGPL-2.1-or-later
// What bench-development prints of the outcomes of sequences.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "asked.h"
#include "development_sequences.h"

namespace cerberus::bench {

using Outcomes = std::vector<Outcome>;  // a sequence each

// What the means of one detector must reach.
struct Floors {
  double mota, idf1, recall;
  double identities;  // a minute, at most
  double soon;        // share of the plain persons with a box within kSoon, at least
};
inline constexpr double kSoon = 1.2;  // s

// A row without its end.
void print_figures(const std::string& what, Labels labels, const Outcome& outcome);
// The means of sequences with these labels, judged where there are floors.
void print_means(Labels labels, std::span<const Outcome> outcomes, const std::optional<Floors>& floors,
                 Asked& asked);
// Medians by which boxes are wider and higher than the truth, where that is good enough.
void print_fit(std::span<const DevelopmentSequence> sequences, std::span<const Outcome> outcomes, bool judged,
               Asked& asked);

struct Difference {
  double mean = 0, error = 0;  // standard error of the mean
};
// Of one figure, paired by sequence.
Difference difference(const Outcomes& before, const Outcomes& after, std::size_t figure);
void print_difference(Labels labels, const Outcomes& before, const Outcomes& after);

}  // namespace cerberus::bench
