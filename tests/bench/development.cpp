// SPDX-License-Identifier: LGPL-2.1-or-later
// The detector on every development sequence: numbers and mechanisms are chosen by these means. A run is one sequence at
// one analysis width, as it is or mirrored; two runs of one sequence often differ by more than two versions of a detector.
//
//   bench-development [--widths 300,320,344] [--only NAME,NAME] [--set STAGE.NAME=VALUE]...
//   bench-development [--widths 320] [--only NAME,NAME] --elements "motiondetect ! personverify"
//   bench-development [--widths 320] [--only NAME,NAME] --calm yes
//
// --set: prints also, for each kind of sequence, the mean difference to the usual numbers, paired by run, with its standard
// error over sequences. --calm: prints how calm the scenes are instead. --elements: measures a launch line, in which motiondetect has the width. With no argument: widths 320,
// judged.
#include <gst/gst.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "asked.h"
#include "development_sequences.h"
#include "set_detector.h"
#include "support/data.h"

using namespace cerberus;
using namespace cerberus::bench;

namespace {

// Seen: .40, .67 and .36; 52 identities a minute. A change that costs more than this is no accident.
constexpr double kCalm = .8;  // share of the corners; see SceneCalm
constexpr double kMota = .37, kIdf1 = .65, kRecall = .34, kIdentities = 60;

struct Options {
  std::vector<int> widths{320};  // analysis pixels
  std::vector<std::string> only;
  std::string elements;
  bool calm = false;
  std::optional<vision::DetectorParameters> numbers;
};

std::vector<std::string> parts(const std::string& text) {
  std::vector<std::string> found;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) found.push_back(part);
  return found;
}

std::optional<Options> read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i], value = ++i < argc ? argv[i] : "";
    std::string wrong;
    if (name == "--only" && !value.empty()) {
      options.only = parts(value);
    } else if (name == "--elements" && !value.empty()) {
      options.elements = value;
    } else if (name == "--calm" && value == "yes") {
      options.calm = true;
    } else if (name == "--widths" && !value.empty()) {
      options.widths.clear();
      for (const std::string& width : parts(value)) options.widths.push_back(std::atoi(width.c_str()));
      if (std::ranges::min(options.widths) < 48) wrong = value + ": a width is a number of pixels from 48 on";
    } else if (name == "--set" && !value.empty()) {
      if (!options.numbers) options.numbers.emplace();
      wrong = set_number(*options.numbers, value);
    } else {
      wrong = name + " is no option, or has no value";
    }
    if (!wrong.empty()) {
      std::fprintf(stderr, "bench-development: %s\n", wrong.c_str());
      return std::nullopt;
    }
  }
  return options;
}

// Figures of the runs of one sequence, in the same order for every detector.
using Runs = std::vector<Figures>;

double seconds_of(GstSample* sample) {
  return static_cast<double>(GST_BUFFER_PTS(gst_sample_get_buffer(sample))) / GST_SECOND;
}

// A mirrored copy of a picture; lives until the next call.
class Mirror {
 public:
  vision::GrayView operator()(vision::GrayView picture) {
    pixels_.resize(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
    for (int y = 0; y < picture.height; ++y)
      std::reverse_copy(picture.row(y), picture.row(y) + picture.width,
                        pixels_.data() + static_cast<std::ptrdiff_t>(y) * picture.width);
    return {pixels_.data(), picture.width, picture.height, picture.width};
  }

 private:
  std::vector<std::uint8_t> pixels_;
};

// Every run sees each frame once it is decoded. Empty: the sequence could not be read.
std::vector<Runs> measure_numbers(const DevelopmentSequence& sequence, const std::vector<int>& widths,
                                  const std::vector<vision::DetectorParameters>& numbers) {
  struct Variant {
    bool mirrored;
    SetDetector detector;
    DevelopmentRun run;
  };
  std::vector<std::vector<Variant>> variants(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i)
    for (const int width : widths)
      for (const bool mirrored : {false, true})
        variants[i].push_back({mirrored, SetDetector(numbers[i], width), DevelopmentRun(sequence, mirrored)});
  Mirror mirror;
  const bool measured = for_each_sample(
      sequence.source +
          " ! videoconvert ! video/x-raw,format=I420 ! appsink name=out sync=false max-buffers=4",
      [&](GstSample* sample, int) {
        for (auto& of_numbers : variants)
          for (Variant& v : of_numbers)
            v.run.add(v.detector.find(sample,
                                      v.mirrored ? SetDetector::View(std::ref(mirror)) : SetDetector::View()),
                      size_of(sample).width, seconds_of(sample));
      });
  if (!measured) return {};
  std::vector<Runs> runs;
  for (const auto& of_numbers : variants) {
    runs.emplace_back();
    for (const Variant& v : of_numbers) runs.back().push_back(v.run.figures());
  }
  return runs;
}

std::vector<Runs> measure_elements(const DevelopmentSequence& sequence, const std::vector<int>& widths,
                                   const std::string& elements) {
  Runs runs;
  for (const int width : widths)
    for (const bool mirrored : {false, true}) {
      std::string line = elements;
      if (const std::size_t at = line.find("motiondetect"); at != std::string::npos)
        line.insert(at + std::strlen("motiondetect"), " analysis-width=" + std::to_string(width));
      DevelopmentRun run(sequence, mirrored);
      if (!for_each_sample(sequence.source + " ! videoconvert" +
                               (mirrored ? " ! videoflip video-direction=horiz ! videoconvert" : "") +
                               " ! video/x-raw,format=I420 ! " + line + " ! appsink name=out sync=false",
                           [&](GstSample* sample, int) {
                             run.add(found_on(gst_sample_get_buffer(sample)), size_of(sample).width,
                                     seconds_of(sample));
                           }))
        return {};
      runs.push_back(run.figures());
    }
  return {runs};
}

// Prints how calm the scene is: median over the frames of all runs, and the share of them in which it is at least kCalm.
bool print_calm(const DevelopmentSequence& sequence, const std::vector<int>& widths) {
  std::vector<double> shares;
  for (const int width : widths)
    for (const bool mirrored : {false, true}) {
      SetDetector detector({}, width);
      Mirror mirror;
      if (!for_each_sample(
              sequence.source +
                  " ! videoconvert ! video/x-raw,format=I420 ! appsink name=out sync=false max-buffers=4",
              [&](GstSample* sample, int) {
                detector.find(sample, mirrored ? SetDetector::View(std::ref(mirror)) : SetDetector::View());
                shares.push_back(detector.calm());
              }))
        return false;
    }
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

// The paired differences of sequences: their mean and its standard error.
void print_difference(Labels labels, const Runs& before, const Runs& after) {
  const std::size_t n = before.size();
  for (std::size_t i = 0; i < Figures{}.size(); ++i) {
    if (!*figure_names(labels)[i]) continue;
    double sum = 0, squares = 0;
    for (std::size_t k = 0; k < n; ++k) sum += (after[k][i] - before[k][i]) / static_cast<double>(n);
    for (std::size_t k = 0; k < n; ++k) squares += std::pow(after[k][i] - before[k][i] - sum, 2);
    const double error = n > 1 ? std::sqrt(squares / static_cast<double>(n * (n - 1))) : 0;
    std::printf("  %-20s %+.4f, standard error %.4f\n", figure_names(labels)[i], sum, error);
  }
}

void judge(Labels labels, const Figures& means, Asked& asked) {
  const auto said = [](const std::string& text) { std::printf("%s", text.c_str()); };
  if (labels == Labels::all) {
    said(asked.at_least("mean MOTA", means[0], kMota));
    said(asked.at_least("mean IDF1", means[1], kIdf1));
  }
  if (labels == Labels::one) said(asked.at_least("mean recall at .5", means[1], kRecall));
  if (labels == Labels::nobody) said(asked.at_most("identities a minute with nobody", means[0], kIdentities));
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
  std::vector<vision::DetectorParameters> numbers(1);
  if (options->numbers) numbers.push_back(*options->numbers);
  Asked asked;
  bool measured = true;
  std::array<std::vector<Runs>, kLabels.size()> means;  // by labels, then by numbers: a mean a sequence
  for (auto& of_labels : means) of_labels.resize(numbers.size());
  for (const DevelopmentSequence& sequence : development_sequences(*data)) {
    if (!options->only.empty() && std::ranges::find(options->only, sequence.name) == options->only.end())
      continue;
    if (options->calm) {
      measured = print_calm(sequence, options->widths) && measured;
      continue;
    }
    const auto runs = options->elements.empty()
                          ? measure_numbers(sequence, options->widths, numbers)
                          : measure_elements(sequence, options->widths, options->elements);
    measured = measured && !runs.empty();
    for (std::size_t i = 0; i < runs.size(); ++i) {
      means[static_cast<std::size_t>(sequence.labels)][i].push_back(mean(runs[i]));
      print_figures(((i == 0 ? "" : "set: ") + sequence.name).c_str(), sequence.labels, mean(runs[i]));
      std::puts("");
    }
    std::fflush(stdout);
  }
  for (const Labels labels : kLabels) {
    const auto& of_labels = means[static_cast<std::size_t>(labels)];
    const Runs& usual = of_labels[0];
    if (usual.empty()) continue;
    print_figures(("mean of " + std::to_string(usual.size())).c_str(), labels, mean(usual));
    if (argc == 1) judge(labels, mean(usual), asked);
    std::puts("");
    if (of_labels.size() > 1) print_difference(labels, usual, of_labels[1]);
  }
  const int verdict = argc == 1 ? asked.verdict() : 0;
  return measured ? verdict : 1;
}
