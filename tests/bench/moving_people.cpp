// SPDX-License-Identifier: LGPL-2.1-or-later
// Are people near the camera and in groups found while it moves? Windows of three quarters of each sequence rest, pan,
// tilt, zoom and shake (moving_view.h), three of each with different phases; means of the three, on the people as the window
// cuts them.
//
//   bench-moving_people [--set STAGE.NAME=VALUE]...     other tuned numbers (parameters.h); nothing is judged
#include <gst/gst.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "asked.h"
#include "boxes.h"
#include "moving_view.h"
#include "people_sequences.h"
#include "set_detector.h"
#include "tracks.h"

using namespace cerberus;
using namespace cerberus::bench;

namespace {

constexpr struct {
  CameraMotion motion;
  const char* name;
} kMotions[] = {{CameraMotion::rest, "at rest"},
                {CameraMotion::pan, "pan"},
                {CameraMotion::tilt, "tilt"},
                {CameraMotion::zoom, "zoom"},
                {CameraMotion::shake, "shake"}};
constexpr int kMoving = std::size(kMotions) - 1;
constexpr int kPhases = 3;
// Of a person, inside the window: with less there is no person, and no mistake either.
constexpr double kLeastSeen = 0.5;

struct Run {
  Run(const vision::DetectorParameters& numbers, CameraMotion motion, double phase, vision::Size picture)
      : view(motion, phase, picture), detector(numbers) {}
  MovingView view;
  SetDetector detector;
  TrackScore score;

  void add(GstSample* sample, double seconds, const std::vector<Person>& people);
};

void Run::add(GstSample* sample, double seconds, const std::vector<Person>& people) {
  view.set_time(seconds);
  std::vector<Person> found =
      people_of(detector.find(sample, [this](vision::GrayView picture) { return view.render(picture); }));
  std::vector<Person> there;
  for (const Person& p : people) {
    const vision::Box seen = view.to_window(p.box);
    if (view.visible_share(p.box) >= kLeastSeen)
      there.push_back({p.id, seen});
    else
      std::erase_if(found, [&](const Person& f) { return overlap_area(f.box, seen) > 0.5 * f.box.area(); });
  }
  score.add(there, found);
}

struct Figures {
  double mota = 0, idf1 = 0, precision = 0, recall = 0, switches = 0;
  void add(const TrackScore& s, double weight) {
    mota += weight * s.mota();
    idf1 += weight * s.idf1();
    precision += weight * s.precision();
    recall += weight * s.recall();
    switches += weight * s.switches();
  }
  void print(const std::string& name) const {
    std::printf("  %-24s %6.3f %6.3f %10.3f %7.3f %9.1f", name.c_str(), mota, idf1, precision, recall,
                switches);
  }
};

// Seen of all that move: .738 and .593. The other sequences are printed; the means of bench-development judge what they need.
struct Floor {
  const char *sequence, *name;
  double Figures::* figure;
  double least;
};
constexpr Floor kFloors[] = {{"PETS09-S2L1", "MOTA", &Figures::mota, 0.71},
                             {"PETS09-S2L1", "IDF1", &Figures::idf1, 0.58}};

// False: it could not be measured.
bool measure(const PeopleSequence& s, const vision::DetectorParameters& numbers, bool judged, Asked& asked) {
  const People truth = read_people(s.truth, 1e9);
  std::vector<Run> runs;
  double first = -1;
  const bool measured = for_each_sample(
      s.source + " ! videoconvert ! video/x-raw,format=I420 ! appsink name=out sync=false max-buffers=4",
      [&](GstSample* sample, int n) {
        const double now = static_cast<double>(GST_BUFFER_PTS(gst_sample_get_buffer(sample))) / GST_SECOND;
        if (runs.empty()) {
          first = now;
          for (const auto& [motion, name] : kMotions)
            for (int i = 0; i < kPhases; ++i)
              runs.emplace_back(numbers, motion, (i + 0.5) / kPhases, size_of(sample));
        }
        const auto people = truth.find(n);
        for (Run& run : runs)
          run.add(sample, now - first, people == truth.end() ? std::vector<Person>{} : people->second);
      });
  if (!measured || runs.empty()) return false;
  std::size_t run = 0;
  Figures moving;
  std::printf("%s\n", s.name.c_str());
  for (const auto& [motion, name] : kMotions) {
    Figures figures;
    for (int i = 0; i < kPhases; ++i, ++run) {
      figures.add(runs[run].score, 1.0 / kPhases);
      if (motion != CameraMotion::rest) moving.add(runs[run].score, 1.0 / (kPhases * kMoving));
    }
    figures.print(name);
    std::puts("");
  }
  moving.print("all that move");
  for (const Floor& f : kFloors)
    if (judged && s.name == f.sequence)
      std::printf(
          "%s", asked.at_least(std::string(f.name) + " on " + s.name + ", moving", moving.*f.figure, f.least)
                    .c_str());
  std::puts("");
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  vision::DetectorParameters numbers;
  if (!parse_numbers(argc, argv, numbers)) return 2;
  const bool judged = argc == 1;
  return for_each_people_sequence(
      "Windows over each sequence    MOTA   IDF1  precision  recall  switches", judged,
      [&](const PeopleSequence& s, Asked& asked) { return measure(s, numbers, judged, asked); });
}
