// SPDX-License-Identifier: LGPL-2.1-or-later
// What preset=paper finds: a walker before a camera that stands and one that turns to and fro (four rendered scenes each),
// the people on vtest.avi, and moving pixels. With arguments: the same of these launch lines, and nothing is judged.
#include <gst/gst.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "asked.h"
#include "boxes.h"
#include "mask_quality.h"
#include "people_sequences.h"
#include "sequences.h"
#include "support/data.h"
#include "tracks.h"

using namespace cerberus;
using namespace cerberus::bench;
namespace fs = std::filesystem;

namespace {

constexpr char kPaper[] = "motiondetect preset=paper";
constexpr double kRight = 0.5;  // intersection over union of the walker and a box
constexpr const char* kScenes[] = {"empty", "lebombo", "out", "st"};

// Share of the walker's frames in which a box fits.
double walker(const fs::path& folder, const std::string& detector) {
  const People truth = read_people(folder / "boxes.txt", 1e9);
  double found_in = 0;
  const bool measured = for_each_sample("multifilesrc location=" + (folder / "frames" / "%05d.jpg").string() +
                                            " start-index=1 caps=image/jpeg,framerate=30/1 ! jpegdec ! " +
                                            detector + " ! appsink name=out sync=false",
                                        [&](GstSample* sample, int n) {
                                          const auto people = truth.find(n);
                                          if (people == truth.end()) return;
                                          const auto found = found_on(gst_sample_get_buffer(sample));
                                          found_in += std::ranges::any_of(found, [&](const Found& f) {
                                            return vision::intersection_over_union(
                                                       f.person.box, people->second[0].box) >= kRight;
                                          });
                                        });
  return measured && !truth.empty() ? found_in / static_cast<double>(truth.size()) : 0;
}

// Mean over the scenes.
double walkers(const fs::path& data, const char* camera, const std::string& detector) {
  double sum = 0;
  std::printf("  walker, camera %-6s", camera);
  for (const char* scene : kScenes) {
    const double share = walker(data / ("walker_" + std::string(camera) + "_" + scene), detector);
    std::printf(" %s %.2f", scene, share);
    sum += share;
  }
  return sum / static_cast<double>(std::size(kScenes));
}

double mota(const fs::path& data, const std::string& video, const std::string& detector) {
  const std::vector<PeopleSequence> sequences = people_sequences(data, video);
  const auto pets = std::ranges::find(sequences, "PETS09-S2L1", &PeopleSequence::name);
  const People truth = read_people(pets->truth, 1e9);
  TrackScore score;
  const bool measured = for_each_sample(
      pets->source + " ! " + detector + " ! appsink name=out sync=false", [&](GstSample* sample, int n) {
        if (const auto people = truth.find(n); people != truth.end())
          score.add(people->second, people_of(found_on(gst_sample_get_buffer(sample))));
      });
  if (!measured) score = {};
  std::printf("  vtest.avi: IDF1 %.3f, precision %.3f, recall %.3f, MOTA", score.idf1(), score.precision(),
              score.recall());
  return score.mota();
}

double mean_f(const fs::path& data, const std::string& detector) {
  double sum = 0;
  std::printf("  masks, F:");
  for (const Sequence& s : sequences()) {
    const double f = mask_quality(s, data, detector).f();
    std::printf(" %s %.3f", s.name, f);
    sum += f;
  }
  return sum / static_cast<double>(sequences().size());
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  const auto real = tests::real_video();
  if (!real) return tests::kSkipped;
  if (!fs::exists(real->data / "walker_still_empty")) {
    std::puts(tests::kNoData);
    return tests::kSkipped;
  }
  std::vector<std::string> detectors(argv + 1, argv + argc);
  const bool judged = detectors.empty();
  if (judged) detectors = {kPaper};
  Asked asked;
  for (const std::string& detector : detectors) {
    std::printf("\n%s\n", detector.c_str());
    const auto line = [&](const char* what, double figure, double least) {
      std::printf(", mean %.3f%s\n", figure, judged ? asked.at_least(what, figure, least).c_str() : "");
    };
    line("share of frames with the walker, camera still", walkers(real->data, "still", detector), 0.9);
    line("share of frames with the walker, camera turning", walkers(real->data, "turn", detector), 0.7);
    line("MOTA on vtest.avi", mota(real->data, real->vtest, detector), 0.3);
    line("mean F", mean_f(real->data, detector), 0.42);
  }
  return judged ? asked.verdict() : 0;
}
