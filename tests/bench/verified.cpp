// SPDX-License-Identifier: LGPL-2.1-or-later
// How well `motiondetect ! personverify` follows annotated people, as the mean of runs whose first look is put off by
// equal parts of the time between two looks: which frames are looked at is a matter of luck.
//
//   bench-verified [RUNS] [SEQUENCE]...    8 runs; all sequences. Named ones are judged by the one who looks.
#include <gst/gst.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <span>

#include "asked.h"
#include "boxes.h"
#include "people_sequences.h"
#include "support/data.h"
#include "tracks.h"

using namespace cerberus;
using namespace cerberus::bench;
namespace fs = std::filesystem;

namespace {

constexpr int kRunsOfMean = 8;
// Switches that fewer runs may have beyond the mean that is asked: of eight, 23 to 29 were seen around a mean of 24.
constexpr double kMoreSwitches = 5;

// Of the mean, at least; of the switches at most.
struct AskedOfMean {
  const char* name;
  double mota, idf1, precision, recall, switches;
  bool promised;
};
// IDF1 on PETS09-S2L1: .74 was asked; .841 was seen, and .782 with appearance_weight at 0.
constexpr AskedOfMean kAsked[] = {{"PETS09-S2L1", 0.75, 0.8, 0, 0, 25, true},
                                  {"TUD-Campus", 0.5, 0.65, 0.8, 0.6, 1000, true},
                                  {"TUD-Stadtmitte", 0.3, 0, 0.7, 0.45, 1000, true},
                                  {"davis_tennis", 0, 0, 0.85, 0.85, 1000, true}};

struct Figure {
  const char* name;
  double (*of)(const TrackScore&);
  double AskedOfMean::*asked;
};
constexpr Figure kFigures[] = {
    {"MOTA", [](const TrackScore& s) { return s.mota(); }, &AskedOfMean::mota},
    {"IDF1", [](const TrackScore& s) { return s.idf1(); }, &AskedOfMean::idf1},
    {"precision", [](const TrackScore& s) { return s.precision(); }, &AskedOfMean::precision},
    {"recall", [](const TrackScore& s) { return s.recall(); }, &AskedOfMean::recall},
    {"switches", [](const TrackScore& s) { return double(s.switches()); }, &AskedOfMean::switches}};

std::optional<TrackScore> run(const PeopleSequence& sequence, double phase) {
  const People truth = read_people(sequence.truth, 1e9);
  char verify[60];
  std::snprintf(verify, sizeof verify, " ! motiondetect ! personverify phase=%.6f", phase);
  TrackScore score;
  const bool measured = for_each_sample(
      sequence.source + verify + " ! appsink name=out sync=false", [&](GstSample* sample, int n) {
        if (const auto people = truth.find(n); people != truth.end())
          score.add(people->second, people_of(found_on(gst_sample_get_buffer(sample))));
      });
  if (!measured) return std::nullopt;
  return score;
}

// False: it could not be measured.
bool measure(const PeopleSequence& sequence, int runs, Asked& asked) {
  std::vector<TrackScore> scores;
  for (int i = 0; i < runs; ++i) {
    const auto score = run(sequence, static_cast<double>(i) / runs);
    if (!score) return false;
    scores.push_back(*score);
  }
  const AskedOfMean& wanted =
      *std::ranges::find(kAsked, sequence.name, [](const AskedOfMean& a) { return std::string(a.name); });
  std::printf("%s, %d runs                mean    least    most\n", sequence.name.c_str(), runs);
  for (const Figure& figure : kFigures) {
    double sum = 0, least = 1e9, most = -1e9;
    for (const TrackScore& score : scores) {
      const double value = figure.of(score);
      sum += value, least = std::min(least, value), most = std::max(most, value);
    }
    const bool counted = figure.asked == &AskedOfMean::switches;
    const double mean = sum / runs,
                 limit = wanted.*figure.asked + (counted && runs < kRunsOfMean ? kMoreSwitches : 0);
    const std::string what = std::string(figure.name) + " on " + sequence.name;
    std::string verdict;
    if (counted && limit < 1000) verdict = asked.at_most(what, mean, limit, wanted.promised);
    if (!counted && limit > 0) verdict = asked.at_least(what, mean, limit, wanted.promised);
    std::printf("  %-24s %7.3f %8.3f %7.3f%s\n", figure.name, mean, least, most, verdict.c_str());
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  const int runs = argc > 1 ? std::atoi(argv[1]) : kRunsOfMean;
  if (runs < 1) {
    std::fprintf(stderr, "bench-verified [RUNS] [SEQUENCE]...: %s is no number of runs\n", argv[1]);
    return 2;
  }
  const std::span<char*> wanted(argv + std::min(argc, 2), argv + argc);
  const auto real = tests::real_video();
  if (!real) return tests::kSkipped;
  Asked asked;
  bool measured = true;
  for (const PeopleSequence& sequence : people_sequences(real->data, real->vtest)) {
    if (!wanted.empty() &&
        std::ranges::find(wanted, sequence.name, [](char* w) { return std::string(w); }) == wanted.end())
      continue;
    if (fs::exists(sequence.truth))
      measured = measure(sequence, runs, asked) && measured;
    else
      std::printf("%-16s %s\n", sequence.name.c_str(), tests::kNoData);
  }
  const int verdict = wanted.empty() ? asked.verdict() : 0;
  return measured ? verdict : 1;
}
