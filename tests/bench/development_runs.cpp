// SPDX-License-Identifier: LGPL-2.1-or-later
#include "development_runs.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <functional>
#include <thread>

#include "boxes.h"

namespace cerberus::bench {
namespace {

constexpr char kDecoded[] =
    " ! videoconvert ! video/x-raw,format=I420 ! appsink name=out sync=false max-buffers=4";

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

// Every detector as it is and mirrored, two after each other. Empty: the sequence could not be read.
std::vector<Outcome> run_detectors(const DevelopmentSequence& sequence, int width,
                                   const std::vector<DetectorSettings>& detectors) {
  struct Run {
    bool mirrored;
    SetDetector detector;
    DevelopmentRun outcome;
  };
  std::vector<Run> runs;
  for (const DetectorSettings& settings : detectors)
    for (const bool mirrored : {false, true})
      runs.push_back({mirrored, SetDetector(settings, width), DevelopmentRun(sequence, mirrored)});
  Mirror mirror;
  const bool measured = for_each_sample(sequence.source + kDecoded, [&](GstSample* sample, int) {
    for (Run& r : runs)
      r.outcome.add(
          r.detector.find(sample, r.mirrored ? SetDetector::View(std::ref(mirror)) : SetDetector::View()),
          size_of(sample), seconds_of(sample));
  });
  std::vector<Outcome> outcomes;
  for (const Run& r : runs)
    if (measured) outcomes.push_back(r.outcome.outcome());
  return outcomes;
}

std::vector<Outcome> run_elements(const DevelopmentSequence& sequence, int width,
                                  const std::string& elements) {
  std::vector<Outcome> outcomes;
  for (const bool mirrored : {false, true}) {
    std::string line = elements;
    if (const std::size_t at = line.find("motiondetect"); at != std::string::npos)
      line.insert(at + std::strlen("motiondetect"), " analysis-width=" + std::to_string(width));
    DevelopmentRun run(sequence, mirrored);
    if (!for_each_sample(line_of(sequence, mirrored) + " ! " + line + " ! appsink name=out sync=false",
                         [&](GstSample* sample, int) {
                           run.add(found_on(gst_sample_get_buffer(sample)), size_of(sample),
                                   seconds_of(sample));
                         }))
      return {};
    outcomes.push_back(run.outcome());
  }
  return outcomes;
}

void add(Outcome& sum, const Outcome& run, double share) {
  for (std::size_t f = 0; f < run.figures.size(); ++f) sum.figures[f] += share * run.figures[f];
  const auto append = [](auto& all, const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
  append(sum.first_boxes, run.first_boxes);
  append(sum.widths, run.widths);
  append(sum.heights, run.heights);
}

using RunsAtWidth = std::function<std::vector<Outcome>(const DevelopmentSequence&, int width)>;

std::vector<SequenceOutcomes> spread(const std::vector<DevelopmentSequence>& sequences,
                                     const std::vector<int>& widths, std::size_t detectors,
                                     const RunsAtWidth& runs) {
  std::vector<std::vector<Outcome>> done(sequences.size() * widths.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t job = next++; job < done.size(); job = next++)
      done[job] = runs(sequences[job / widths.size()], widths[job % widths.size()]);
  };
  {
    std::vector<std::jthread> workers;
    for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i)
      workers.emplace_back(work);
  }
  std::vector<SequenceOutcomes> all;
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    SequenceOutcomes outcomes(detectors);
    for (std::size_t w = 0; w < widths.size(); ++w) {
      const std::vector<Outcome>& found = done[s * widths.size() + w];
      if (found.empty()) outcomes.clear();
      for (std::size_t i = 0; i < outcomes.size(); ++i)
        for (const Outcome& run : {found[2 * i], found[2 * i + 1]})
          add(outcomes[i], run, 1 / (2. * static_cast<double>(widths.size())));
    }
    all.push_back(outcomes);
  }
  return all;
}

}  // namespace

std::vector<SequenceOutcomes> measure(const std::vector<DevelopmentSequence>& sequences,
                                      const std::vector<int>& widths,
                                      const std::vector<DetectorSettings>& detectors) {
  return spread(sequences, widths, detectors.size(), [&](const DevelopmentSequence& sequence, int width) {
    return run_detectors(sequence, width, detectors);
  });
}

std::vector<double> measure_calm(const DevelopmentSequence& sequence, const std::vector<int>& widths) {
  std::vector<double> shares;
  for (const int width : widths)
    for (const bool mirrored : {false, true}) {
      SetDetector detector(DetectorSettings{}, width);
      Mirror mirror;
      if (!for_each_sample(sequence.source + kDecoded, [&](GstSample* sample, int) {
            detector.find(sample, mirrored ? SetDetector::View(std::ref(mirror)) : SetDetector::View());
            shares.push_back(detector.calm());
          }))
        return {};
    }
  return shares;
}

std::vector<SequenceOutcomes> measure(const std::vector<DevelopmentSequence>& sequences,
                                      const std::vector<int>& widths, const std::string& elements) {
  return spread(sequences, widths, 1, [&](const DevelopmentSequence& sequence, int width) {
    return run_elements(sequence, width, elements);
  });
}

}  // namespace cerberus::bench
