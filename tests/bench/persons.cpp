// SPDX-License-Identifier: LGPL-2.1-or-later
// People detectors by themselves, without tracks: looks at whole frames of the development sequences, 4 a second.
//
//   bench-persons [--only NAME,NAME] [DETECTOR]...      daimler, hog, hog:LINES, or the file of a network
//
// Without arguments: daimler, hog and a published network, judged.
//
// all, one: average precision (all only) and recall at IoU .5 of all boxes down to the least score, the medians of their
// widths and heights over the truth's. nobody: the best score. Everywhere: boxes a look that are no labelled person, and
// CPU milliseconds a look.
#include <gst/gst.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "asked.h"
#include "boxes.h"
#include "development_sequences.h"
#include "frames.h"
#include "shared/video.hpp"
#include "support/data.h"
#include "verify/detector_use.hpp"
#include "vision/persons/whole_frame_detector.h"

using namespace cerberus;
using namespace cerberus::bench;

namespace {

constexpr double kRight = .5;        // intersection over union
constexpr double kLooksASecond = 4;  // of media time

// name: daimler or hog, perhaps with lines (hog:720), or a file.
std::unique_ptr<vision::WholeFrameDetector> detector_of(const std::string& name) {
  const std::size_t colon = name.find(':');
  const std::string kind = name.substr(0, colon);
  plugin::ModelSettings model;
  std::string wrong;
  std::unique_ptr<vision::WholeFrameDetector> detector;
  if (kind == "daimler" || kind == "hog") {
    const int lines =
        colon == std::string::npos ? plugin::kWholeFrameLines : std::atoi(name.c_str() + colon + 1);
    detector = plugin::make_whole_frame_detector(
        kind == "hog" ? plugin::DetectorKind::hog : plugin::DetectorKind::daimler, model, wrong, lines);
  } else {
    model.model = name;
    detector = plugin::make_whole_frame_detector(plugin::DetectorKind::model, model, wrong);
  }
  if (!detector) std::fprintf(stderr, "bench-persons: %s\n", wrong.c_str());
  return detector;
}

// What the looks at one sequence found.
class Looks {
 public:
  explicit Looks(const DevelopmentSequence& sequence)
      : labels_(sequence.labels), people_(read_truth(sequence)) {}

  // bodies: the surest first.
  void add(int frame, const std::vector<vision::PersonDetection>& bodies, double seconds) {
    ++looks_, seconds_ += seconds;
    std::vector<Person> truth;
    if (const auto found = people_.find(frame); found != people_.end()) truth = found->second;
    wanted_ += truth.size();
    for (const vision::PersonDetection& body : bodies) {
      const auto best = std::ranges::max_element(
          truth, {}, [&](const Person& p) { return vision::intersection_over_union(p.box, body.box); });
      const bool right =
          best != truth.end() && vision::intersection_over_union(best->box, body.box) >= kRight;
      scores_.push_back({body.score, right});
      if (!right) continue;
      widths_.push_back(body.box.width / best->box.width),
          heights_.push_back(body.box.height / best->box.height);
      truth.erase(best);
    }
  }

  void print() const {
    const auto right = static_cast<double>(widths_.size()), looks = std::max(1., double(looks_));
    if (labels_ == Labels::all) std::printf("  AP %.3f", average_precision());
    if (labels_ != Labels::nobody)
      std::printf("  recall %.3f  width %.2f  height %.2f", recall(), widths_.empty() ? 0 : median(widths_),
                  heights_.empty() ? 0 : median(heights_));
    else if (!scores_.empty())
      std::printf("  best score %.2f", std::ranges::max(scores_).first);
    std::printf("  others a look %.2f  %.0f ms\n", (double(scores_.size()) - right) / looks,
                1e3 * seconds_ / looks);
  }
  double recall() const { return double(widths_.size()) / std::max(1., double(wanted_)); }
  // The area below the precision that each recall affords at best (PASCAL VOC 2010).
  double average_precision() const {
    std::vector<std::pair<double, bool>> sorted = scores_;
    std::ranges::sort(sorted, std::greater<>());
    std::vector<double> precision;
    double right = 0, seen = 0;
    for (const auto& [score, is_right] : sorted)
      if (seen += 1; is_right) precision.push_back((right += 1) / seen);
    double area = 0, best = 0;
    for (std::size_t i = precision.size(); i-- > 0;) area += best = std::max(best, precision[i]);
    return area / std::max(1., double(wanted_));
  }

 private:
  Labels labels_;
  People people_;
  int looks_ = 0;
  double seconds_ = 0;
  std::size_t wanted_ = 0;
  std::vector<std::pair<double, bool>> scores_;  // of every box, and whether it is right
  std::vector<double> widths_, heights_;
};

// False: it could not be measured.
bool measure(const DevelopmentSequence& sequence, vision::WholeFrameDetector& detector, Looks& looks) {
  double next = 0;
  std::optional<std::string> refusal;
  std::vector<vision::PersonDetection> bodies;
  vision::PictureCopy picture;
  const bool read = for_each_sample(
      sequence.source +
          " ! videoconvert ! video/x-raw,format=I420 ! appsink name=out sync=false max-buffers=4",
      [&](GstSample* sample, int n) {
        GstBuffer* buffer = gst_sample_get_buffer(sample);
        const double time = double(GST_BUFFER_PTS(buffer)) / GST_SECOND;
        if (time < next - 1e-6) return;
        next += 1 / kLooksASecond;
        GstVideoInfo info;
        GstVideoFrame mapped;
        if (!gst_video_info_from_caps(&info, gst_sample_get_caps(sample)) ||
            !gst_video_frame_map(&mapped, &info, buffer, GST_MAP_READ))
          return;
        const std::clock_t start = std::clock();
        picture.take(picture_source(mapped), 0, 0, {info.width, info.height}, detector.sees_colours());
        refusal = detector.find(picture.view(), bodies);
        looks.add(n, bodies, double(std::clock() - start) / CLOCKS_PER_SEC);
        gst_video_frame_unmap(&mapped);
      });
  if (refusal) std::fprintf(stderr, "bench-persons: %s\n", refusal->c_str());
  return read && !refusal;
}

// The mean average precision of the sequences where everybody is labelled. nullopt: it could not be measured.
std::optional<double> measure_all(const std::string& name, const std::vector<std::string>& only,
                                  const std::vector<DevelopmentSequence>& sequences) {
  const auto detector = detector_of(name);
  if (!detector) return std::nullopt;
  std::printf("%s\n", name.c_str());
  double precision = 0, recall = 0;
  int all = 0;
  for (const DevelopmentSequence& sequence : sequences) {
    if (!only.empty() && std::ranges::find(only, sequence.name) == only.end()) continue;
    Looks looks(sequence);
    if (!measure(sequence, *detector, looks)) return std::nullopt;
    std::printf("  %-24s", sequence.name.c_str());
    looks.print();
    std::fflush(stdout);
    if (sequence.labels != Labels::all) continue;
    precision += looks.average_precision(), recall += looks.recall(), ++all;
  }
  const double n = std::max(1, all);
  std::printf("  mean of %-3d               AP %.3f  recall %.3f", all, precision / n, recall / n);
  return precision / n;
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  std::vector<std::string> only, detectors;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) != "--only" || i + 1 == argc) {
      detectors.push_back(argv[i]);
      continue;
    }
    std::istringstream names(argv[++i]);
    for (std::string name; std::getline(names, name, ',');) only.push_back(name);
  }
  const auto data = tests::data_folder();
  if (!data) {
    std::printf("skipped: %s\n", tests::kNoData);
    return tests::kSkipped;
  }
  const std::vector<DevelopmentSequence> sequences = development_sequences(*data);
  // Seen: .50, .48 and .86.
  std::vector<std::pair<std::string, double>> judged;
  if (argc == 1) {
    judged = {{"daimler", .47}, {"hog", .45}};
    if (const auto models = tests::models_folder())
      judged.emplace_back(*models / "yolo-fastest-1.1_body.weights", .83);
    else
      std::printf("%s\n", tests::kNoModels);
  }
  Asked asked;
  for (const auto& [name, least] : judged) {
    const auto precision = measure_all(name, only, sequences);
    if (!precision) return 1;
    std::printf("%s\n", asked.at_least("AP of " + name, *precision, least).c_str());
  }
  for (const std::string& name : detectors) {
    if (!measure_all(name, only, sequences)) return 1;
    std::printf("\n");
  }
  return argc == 1 ? asked.verdict() : 0;
}
