// SPDX-License-Identifier: LGPL-2.1-or-later
#include "development_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "frames.h"

namespace cerberus::bench {
namespace {

// Sequences with boxes that are good enough to measure others by, and those on which ours are, or nearly are, too wide.
constexpr std::array kFitted{"davis_tennis", "mot15_tud_campus", "mot15_tud_stadtmitte", "otb_David3",
                             "otb_Jogging1", "otb_Woman",        "pets09_s2l1_view1"};
constexpr std::array kTooWide{"mot15_tud_stadtmitte", "otb_Jogging1", "otb_Woman"};
constexpr double kLargestBias = .1;  // of the person's width or height, issue

Outcome mean(std::span<const Outcome> outcomes) {
  Outcome sum;
  for (const Outcome& o : outcomes) {
    for (std::size_t i = 0; i < o.figures.size(); ++i)
      sum.figures[i] += o.figures[i] / static_cast<double>(outcomes.size());
    sum.first_boxes.insert(sum.first_boxes.end(), o.first_boxes.begin(), o.first_boxes.end());
  }
  return sum;
}

struct Starts {
  double middle = 0, worst = 0;  // s, of all persons, and of the plain ones
  double soon = 1;               // share of the plain ones
  std::size_t plain = 0;
};

Starts starts_of(const std::vector<FirstBox>& boxes) {
  Starts starts;
  std::vector<double> all;
  double soon = 0;
  for (const FirstBox& b : boxes) {
    all.push_back(b.seconds);
    if (!b.plain) continue;
    ++starts.plain;
    starts.worst = std::max(starts.worst, b.seconds);
    soon += b.seconds <= kSoon;
  }
  starts.middle = median(std::move(all));
  if (starts.plain > 0) starts.soon = soon / static_cast<double>(starts.plain);
  return starts;
}

std::string in_words(double seconds) {
  if (std::isinf(seconds)) return "never";
  char text[40];
  std::snprintf(text, sizeof text, "%.2f s", seconds);
  return text;
}

}  // namespace

void print_figures(const std::string& what, Labels labels, const Outcome& outcome) {
  std::printf("  %-32s", what.c_str());
  for (std::size_t i = 0; i < outcome.figures.size(); ++i)
    if (const char* name = figure_names(labels)[i]; *name) std::printf("  %s %.3f", name, outcome.figures[i]);
  if (outcome.first_boxes.empty()) return;
  const Starts starts = starts_of(outcome.first_boxes);
  std::printf("  first box %s", in_words(starts.middle).c_str());
  if (starts.plain > 0) std::printf(", worst of %zu plain %s", starts.plain, in_words(starts.worst).c_str());
}

void print_means(Labels labels, std::span<const Outcome> outcomes, const std::optional<Floors>& floors,
                 Asked& asked) {
  const Outcome means = mean(outcomes);
  print_figures("mean of " + std::to_string(outcomes.size()), labels, means);
  const auto said = [](const std::string& text) { std::printf("%s", text.c_str()); };
  if (floors && labels == Labels::all) {
    said(asked.at_least("mean MOTA", means.figures[0], floors->mota));
    said(asked.at_least("mean IDF1", means.figures[1], floors->idf1));
  }
  if (floors && labels == Labels::one)
    said(asked.at_least("mean recall at .5", means.figures[1], floors->recall));
  if (floors && labels == Labels::nobody)
    said(asked.at_most("identities a minute with nobody", means.figures[0], floors->identities));
  if (labels == Labels::all) {
    const Starts starts = starts_of(means.first_boxes);
    std::printf("\n  %-32s  median %s", "first box", in_words(starts.middle).c_str());
    if (floors) said(asked.at_most("median seconds to the first box", starts.middle, .5));
    std::printf("  share of %zu plain persons within %.1f s %.3f", starts.plain, kSoon, starts.soon);
    if (floors) {
      said(asked.at_least("share of plain persons with a box soon", starts.soon, floors->soon));
      said(asked.at_least("share of plain persons with a box soon", starts.soon, 1, false));
    }
  }
  std::puts("");
}

void print_fit(std::span<const DevelopmentSequence> sequences, std::span<const Outcome> outcomes, bool judged,
               Asked& asked) {
  const auto among = [](const auto& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
  };
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    const std::string& name = sequences[s].name;
    if (!among(kFitted, name) || outcomes[s].widths.empty()) continue;
    const double width = median(outcomes[s].widths) - 1, height = median(outcomes[s].heights) - 1;
    std::printf("  fit of boxes, %-20s width %+.3f  height %+.3f", name.c_str(), width, height);
    if (judged)
      std::printf("%s", asked
                            .at_most("bias of boxes on " + name, std::max(std::abs(width), std::abs(height)),
                                     kLargestBias, !among(kTooWide, name))
                            .c_str());
    std::puts("");
  }
}

Difference difference(const Outcomes& before, const Outcomes& after, std::size_t figure) {
  const auto n = static_cast<double>(before.size());
  const auto gain = [&](std::size_t k) { return after[k].figures[figure] - before[k].figures[figure]; };
  Difference d;
  for (std::size_t k = 0; k < before.size(); ++k) d.mean += gain(k) / n;
  double squares = 0;
  for (std::size_t k = 0; k < before.size(); ++k) squares += std::pow(gain(k) - d.mean, 2);
  if (n > 1) d.error = std::sqrt(squares / (n * (n - 1)));
  return d;
}

void print_difference(Labels labels, const Outcomes& before, const Outcomes& after) {
  for (std::size_t i = 0; i < Figures{}.size(); ++i) {
    if (!*figure_names(labels)[i]) continue;
    const Difference d = difference(before, after, i);
    std::printf("  %-20s %+.4f, standard error %.4f\n", figure_names(labels)[i], d.mean, d.error);
  }
}

}  // namespace cerberus::bench
