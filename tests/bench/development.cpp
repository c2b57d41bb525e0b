// SPDX-License-Identifier: LGPL-2.1-or-later
// The detector on every development sequence: numbers and mechanisms are chosen by these means. A run is one sequence at
// one analysis width, as it is or mirrored; two runs of one sequence often differ by more than two versions of a detector.
//
//   bench-development [--widths 300,320,344] [--only NAME,NAME] [--set STAGE.NAME=VALUE]... [--without NAME,NAME]...
//   bench-development [--widths 300,320,344] [--only NAME,NAME] --table
//   bench-development [--widths 320] [--only NAME,NAME] --elements "motiondetect ! personverify"
//   bench-development [--widths 320] [--only NAME,NAME] --calm
//   bench-development [--only NAME,NAME] --persons [--rates 4,2,1]
//
// --set, --without (mechanisms.h): prints also, for each kind of sequence, the mean difference to the usual detector, paired
// by run, with its standard error over sequences. --table: what the absence of each mechanism does to the means, with the
// lines and tuned numbers that it takes. --elements: measures a launch line, in which motiondetect has the width. --calm:
// prints how calm the scenes are instead. --persons: `motiondetect ! personverify`. --rates: its means at these looks a
// second, and with a published network where there is one. --third 0, 1 or 2, with any of them: the means of every third
// sequence of each kind, and of the others, by which a choice is made. With no argument, and with --persons alone: widths
// 320, judged.
//
// Seconds to the first box: see FirstBox; medians and shares of all persons of all runs.
#include <gst/gst.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "asked.h"
#include "development_report.h"
#include "development_runs.h"
#include "development_sequences.h"
#include "mechanisms.h"
#include "parameters.h"
#include "support/data.h"

using namespace cerberus;
using namespace cerberus::bench;

namespace {

// A change that costs more than this is no accident. Seen: .522, .688, .349; 2.4 identities a minute, .76 soon.
constexpr Floors kMotionAlone{.49, .66, .32, 5, .70};
// Seen with HOG: .63, .74, .40; 1.3 identities a minute, .80 soon.
constexpr Floors kWithPersons{.59, .70, .31, 4, .7};
constexpr double kCalm = .8;  // share of the corners; see SceneCalm

struct Options {
  std::vector<int> widths{320};  // analysis pixels
  std::vector<std::string> only, rates;
  std::string elements;
  std::optional<DetectorSettings> other;  // what the usual detector is compared with
  std::optional<int> third;
  bool table = false, calm = false;
  std::optional<Floors> floors;  // what is asked for
};

constexpr char kPersons[] = "motiondetect ! personverify", kNetwork[] = "yolo-fastest-1.1_body.weights";

std::vector<std::string> parts(const std::string& text) {
  std::vector<std::string> found;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) found.push_back(part);
  return found;
}

// Takes the option at `i` and its value. Returns what is wrong with it.
std::string read_option(Options& options, std::span<char*> arguments, std::size_t& i) {
  const std::string name = arguments[i];
  if (name == "--table") return options.table = true, "";
  if (name == "--calm") return options.calm = true, "";
  if (name == "--persons") return options.elements = kPersons, "";
  const std::string value = i + 1 < arguments.size() ? arguments[++i] : "";
  if (value.empty()) return name + " is no option, or has no value";
  if (name == "--only") return options.only = parts(value), "";
  if (name == "--rates") return options.rates = parts(value), "";
  if (name == "--elements") return options.elements = value, "";
  if (name == "--third") {
    options.third = std::atoi(value.c_str());
    return value == "0" || value == "1" || value == "2" ? "" : value + ": a third is 0, 1 or 2";
  }
  if (name == "--widths") {
    options.widths.clear();
    for (const std::string& width : parts(value)) options.widths.push_back(std::atoi(width.c_str()));
    return std::ranges::min(options.widths) < 48 ? value + ": a width is a number of pixels from 48 on" : "";
  }
  if (name != "--set" && name != "--without") return name + " is no option";
  if (!options.other) options.other.emplace();
  return name == "--set" ? set_number(options.other->numbers, value) : leave_out(*options.other, value);
}

std::optional<Options> read_options(std::span<char*> arguments) {
  Options options;
  std::string wrong;
  for (std::size_t i = 0; i < arguments.size() && wrong.empty(); ++i)
    wrong = read_option(options, arguments, i);
  if (options.table && options.other) wrong = "--table compares with what it leaves out itself";
  if (!options.elements.empty() && (options.table || options.other))
    wrong =
        "--set, --without and --table are of the library's detector: none goes with --elements or --persons";
  if (!options.rates.empty() && options.elements != kPersons) wrong = "--rates goes with --persons";
  if (arguments.empty()) options.floors = kMotionAlone;
  if (arguments.size() == 1 && options.elements == kPersons) options.floors = kWithPersons;
  if (wrong.empty()) return options;
  std::fprintf(stderr, "bench-development: %s\n", wrong.c_str());
  return std::nullopt;
}

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

// By labels, then by detector: an outcome a sequence.
using Means = std::array<std::vector<Outcomes>, kLabels.size()>;

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
      const std::vector<Outcomes>& of = means[static_cast<std::size_t>(c.labels)];
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

// The outcomes of the sequences that are, or are not, the third.
Outcomes part(const Outcomes& all, int third, bool inside) {
  Outcomes of_part;
  for (std::size_t i = 0; i < all.size(); ++i)
    if ((i % 3 == static_cast<std::size_t>(third)) == inside) of_part.push_back(all[i]);
  return of_part;
}

// By labels, with what is compared with them.
void print_all_means(const Options& options, const Means& means, Asked& asked) {
  for (const Labels labels : kLabels) {
    const auto& of_labels = means[static_cast<std::size_t>(labels)];
    const Outcomes& usual = of_labels[0];
    if (usual.empty()) continue;
    print_means(labels, usual, options.floors, asked);
    for (const bool inside : {false, true})
      if (const auto some = options.third ? part(usual, *options.third, inside) : Outcomes{}; !some.empty()) {
        std::printf(inside ? "  third:     " : "  two thirds:");
        print_means(labels, some, {}, asked);
      }
    if (options.other) print_difference(labels, usual, of_labels[1]);
  }
}

// One row a rate and kind of sequence, then those of the network.
bool print_rates(const Options& options, const std::vector<DevelopmentSequence>& sequences) {
  std::vector<std::string> lines;
  for (const std::string& rate : options.rates) lines.push_back(kPersons + (" rate=" + rate));
  if (const auto models = tests::models_folder())
    lines.push_back(kPersons + (" model=" + (*models / kNetwork).string()));
  else
    std::printf("%s\n", tests::kNoModels);
  for (const std::string& line : lines) {
    std::printf("%s\n", line.c_str());
    const std::vector<SequenceOutcomes> measured = measure(sequences, options.widths, line);
    if (!std::ranges::none_of(measured, &SequenceOutcomes::empty)) return false;
    Means means;
    for (auto& of_labels : means) of_labels.resize(1);
    for (std::size_t s = 0; s < sequences.size(); ++s)
      means[static_cast<std::size_t>(sequences[s].labels)][0].push_back(measured[s][0]);
    Asked nothing;
    print_all_means(options, means, nothing);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  const auto options = read_options({argv + 1, argv + argc});
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
  if (!options->rates.empty()) return print_rates(*options, sequences) ? 0 : 1;
  const std::vector<SequenceOutcomes> measured = options->elements.empty()
                                                     ? measure(sequences, options->widths, detectors)
                                                     : measure(sequences, options->widths, options->elements);
  if (!std::ranges::none_of(measured, &SequenceOutcomes::empty)) return 1;
  Means means;
  for (auto& of_labels : means) of_labels.resize(detectors.size());
  Outcomes usual;
  for (std::size_t s = 0; s < sequences.size(); ++s)
    for (std::size_t i = 0; i < measured[s].size(); ++i) {
      means[static_cast<std::size_t>(sequences[s].labels)][i].push_back(measured[s][i]);
      if (i == 0) usual.push_back(measured[s][i]);
      if (options->table && i > 0) continue;
      print_figures((i == 0 ? "" : "other: ") + sequences[s].name, sequences[s].labels, measured[s][i]);
      std::puts("");
    }
  Asked asked;
  print_fit(sequences, usual, options->floors.has_value(), asked);
  print_all_means(*options, means, asked);
  if (options->table) print_table(means);
  return options->floors ? asked.verdict() : 0;
}
