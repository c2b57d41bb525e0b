// SPDX-License-Identifier: LGPL-2.1-or-later
// The detector on every development sequence: numbers and mechanisms are chosen by these means. A run is one sequence at
// one analysis width, as it is or mirrored; two runs of one sequence often differ by more than two versions of a detector.
//
//   bench-development [--widths 300,320,344] [--only NAME,NAME] [--set STAGE.NAME=VALUE]... [--without NAME,NAME]...
//   bench-development [--widths 300,320,344] [--only NAME,NAME] --table
//   bench-development [--widths 320] [--only NAME,NAME] --elements "motiondetect ! personverify"
//   bench-development [--widths 320] [--only NAME,NAME] --calm
//   bench-development --persons
//
// --set, --without (mechanisms.h): prints also, for each kind of sequence, the mean difference to the usual detector, paired
// by run, with its standard error over sequences. --table: what the absence of each mechanism does to the means, with the
// lines and tuned numbers that it takes. --elements: measures a launch line, in which motiondetect has the width. --calm:
// prints how calm the scenes are instead. --persons: `motiondetect ! personverify`, judged. With no argument: widths 320,
// judged.
#include <gst/gst.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "asked.h"
#include "development_runs.h"
#include "development_sequences.h"
#include "mechanisms.h"
#include "parameters.h"
#include "support/data.h"

using namespace cerberus;
using namespace cerberus::bench;

namespace {

// Seen: .52, .69 and .35; 5 identities a minute. A change that costs more than this is no accident.
struct Floors {
  double mota, idf1, recall, identities;  // identities: a minute, at most
};
constexpr Floors kMotionAlone{.49, .66, .32, 8};
// Seen with HOG: .62, .73, .34; 2 identities a minute.
constexpr Floors kWithPersons{.59, .70, .31, 4};
constexpr double kCalm = .8;  // share of the corners; see SceneCalm

struct Options {
  std::vector<int> widths{320};  // analysis pixels
  std::vector<std::string> only;
  std::string elements;
  std::optional<DetectorSettings> other;  // what the usual detector is compared with
  bool table = false, calm = false;
  std::optional<Floors> floors;  // what is asked for
};

std::vector<std::string> parts(const std::string& text) {
  std::vector<std::string> found;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) found.push_back(part);
  return found;
}

std::optional<Options> read_options(int argc, char** argv) {
  Options options;
  if (argc == 1) options.floors = kMotionAlone;
  if (argc == 2 && std::string(argv[1]) == "--persons") {
    options.floors = kWithPersons;
    options.elements = "motiondetect ! personverify";
    return options;
  }
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    const bool alone = name == "--table" || name == "--calm";
    const std::string value = !alone && ++i < argc ? argv[i] : "";
    std::string wrong;
    if (name == "--table") {
      options.table = true;
    } else if (name == "--calm") {
      options.calm = true;
    } else if (name == "--only" && !value.empty()) {
      options.only = parts(value);
    } else if (name == "--elements" && !value.empty()) {
      options.elements = value;
    } else if (name == "--widths" && !value.empty()) {
      options.widths.clear();
      for (const std::string& width : parts(value)) options.widths.push_back(std::atoi(width.c_str()));
      if (std::ranges::min(options.widths) < 48) wrong = value + ": a width is a number of pixels from 48 on";
    } else if (name == "--set" && !value.empty()) {
      if (!options.other) options.other.emplace();
      wrong = set_number(options.other->numbers, value);
    } else if (name == "--without" && !value.empty()) {
      if (!options.other) options.other.emplace();
      wrong = leave_out(*options.other, value);
    } else {
      wrong = name + " is no option, or has no value";
    }
    if (options.table && options.other) wrong = "--table compares with what it leaves out itself";
    if (!wrong.empty()) {
      std::fprintf(stderr, "bench-development: %s\n", wrong.c_str());
      return std::nullopt;
    }
  }
  return options;
}

// Means of sequences.
using Runs = std::vector<Figures>;

// How calm the scene is: median over the frames of all runs, and the share of them in which it is at least kCalm.
bool print_calm(const DevelopmentSequence& sequence, const std::vector<int>& widths) {
  std::vector<double> shares = measure_calm(sequence, widths);
  if (shares.empty()) return false;
  const auto calm = std::ranges::count_if(shares, [](double share) { return share >= kCalm; });
  const auto middle = shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2);
  std::ranges::nth_element(shares, middle);
  std::printf("  %-32s  median %.2f  calm in %.2f of the frames\n", sequence.name.c_str(), *middle,
              static_cast<double>(calm) / static_cast<double>(shares.size()));
  return true;
}

Figures mean(const Runs& runs) {
  Figures sum{};
  for (const Figures& f : runs)
    for (std::size_t i = 0; i < f.size(); ++i) sum[i] += f[i] / static_cast<double>(runs.size());
  return sum;
}

void print_figures(const char* what, Labels labels, const Figures& figures) {
  std::printf("  %-32s", what);
  for (std::size_t i = 0; i < figures.size(); ++i)
    if (const char* name = figure_names(labels)[i]; *name) std::printf("  %s %.3f", name, figures[i]);
}

struct Difference {
  double mean = 0, error = 0;
};

// Of one figure, paired by sequence: the mean and its standard error.
Difference difference(const Runs& before, const Runs& after, std::size_t figure) {
  const auto n = static_cast<double>(before.size());
  Difference d;
  for (std::size_t k = 0; k < before.size(); ++k) d.mean += (after[k][figure] - before[k][figure]) / n;
  double squares = 0;
  for (std::size_t k = 0; k < before.size(); ++k)
    squares += std::pow(after[k][figure] - before[k][figure] - d.mean, 2);
  if (n > 1) d.error = std::sqrt(squares / (n * (n - 1)));
  return d;
}

void print_difference(Labels labels, const Runs& before, const Runs& after) {
  for (std::size_t i = 0; i < Figures{}.size(); ++i) {
    if (!*figure_names(labels)[i]) continue;
    const Difference d = difference(before, after, i);
    std::printf("  %-20s %+.4f, standard error %.4f\n", figure_names(labels)[i], d.mean, d.error);
  }
}

// By labels, then by detector: a mean a sequence.
using Means = std::array<std::vector<Runs>, kLabels.size()>;

// detectors: the usual one, then one without each mechanism.
void print_table(const Means& means) {
  struct Column {
    const char* name;
    Labels labels;
    std::size_t figure;
    double factor;
  };
  constexpr Column kColumns[]{{"MOTA", Labels::all, 0, 100},
                              {"IDF1", Labels::all, 1, 100},
                              {"recall .5", Labels::one, 1, 100},
                              {"identities/min", Labels::nobody, 0, 1}};
  std::printf("\n  %-22s %5s %7s", "without", "lines", "numbers");
  for (const Column& c : kColumns) std::printf(" %18s", c.name);
  std::puts("   (mean difference +- standard error; points of 100)");
  for (std::size_t i = 0; i < mechanisms().size(); ++i) {
    const Mechanism& m = mechanisms()[i];
    const Extent extent = extent_of(m, CERBERUS_SOURCE_ROOT);
    std::printf("  %-22s %5d %7d", m.name, extent.lines, extent.numbers);
    for (const Column& c : kColumns) {
      const std::vector<Runs>& of = means[static_cast<std::size_t>(c.labels)];
      if (of[0].empty()) {
        std::printf(" %18s", "-");
        continue;
      }
      const Difference d = difference(of[0], of[i + 1], c.figure);
      std::printf("   %+7.2f +-%5.2f", c.factor * d.mean, c.factor * d.error);
    }
    std::puts("");
  }
}

void judge(Labels labels, const Figures& means, const Floors& floors, Asked& asked) {
  const auto said = [](const std::string& text) { std::printf("%s", text.c_str()); };
  if (labels == Labels::all) {
    said(asked.at_least("mean MOTA", means[0], floors.mota));
    said(asked.at_least("mean IDF1", means[1], floors.idf1));
  }
  if (labels == Labels::one) said(asked.at_least("mean recall at .5", means[1], floors.recall));
  if (labels == Labels::nobody)
    said(asked.at_most("identities a minute with nobody", means[0], floors.identities));
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  const auto options = read_options(argc, argv);
  if (!options) return 2;
  const auto data = tests::data_folder();
  if (!data) {
    std::printf("skipped: %s\n", tests::kNoData);
    return tests::kSkipped;
  }
  std::vector<DetectorSettings> detectors(1);
  if (options->other) detectors.push_back(*options->other);
  if (options->table)
    for (const Mechanism& m : mechanisms()) leave_out(detectors.emplace_back(), m.name);
  std::vector<DevelopmentSequence> sequences = development_sequences(*data);
  if (!options->only.empty())
    std::erase_if(sequences, [&](const DevelopmentSequence& s) {
      return std::ranges::find(options->only, s.name) == options->only.end();
    });
  if (options->calm)
    return std::ranges::all_of(sequences, [&](const auto& s) { return print_calm(s, options->widths); }) ? 0
                                                                                                         : 1;
  const std::vector<SequenceMeans> measured = options->elements.empty()
                                                  ? measure(sequences, options->widths, detectors)
                                                  : measure(sequences, options->widths, options->elements);
  Means means;
  for (auto& of_labels : means) of_labels.resize(detectors.size());
  for (std::size_t s = 0; s < sequences.size(); ++s)
    for (std::size_t i = 0; i < measured[s].size(); ++i) {
      means[static_cast<std::size_t>(sequences[s].labels)][i].push_back(measured[s][i]);
      if (options->table && i > 0) continue;
      print_figures(((i == 0 ? "" : "other: ") + sequences[s].name).c_str(), sequences[s].labels,
                    measured[s][i]);
      std::puts("");
    }
  Asked asked;
  for (const Labels labels : kLabels) {
    const auto& of_labels = means[static_cast<std::size_t>(labels)];
    const Runs& usual = of_labels[0];
    if (usual.empty()) continue;
    print_figures(("mean of " + std::to_string(usual.size())).c_str(), labels, mean(usual));
    if (options->floors) judge(labels, mean(usual), *options->floors, asked);
    std::puts("");
    if (options->other) print_difference(labels, usual, of_labels[1]);
  }
  if (options->table) print_table(means);
  const int verdict = options->floors ? asked.verdict() : 0;
  return std::ranges::none_of(measured, &SequenceMeans::empty) ? verdict : 1;
}
