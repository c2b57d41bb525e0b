// SPDX-License-Identifier: LGPL-2.1-or-later
// Does the closed loop keep a person in the picture? A window of 320 x 240 over vtest.avi, turned by a simulated head
// towards one annotated person: chosen on the first frame on which a track has that person's box, as an application
// chooses, by pantiltsink's signal `follow`; before that the head stands. Counted from then on: annotated frames on
// which the person's middle, and nine tenths of the visible part of the person, are inside the window. The last
// columns show whether that is the loop's merit: on how many of these frames the chosen track has the person's box,
// and how many tracks had it.
#include <algorithm>
#include <cstdio>

#include "asked.h"
#include "boxes.h"
#include "in_window.h"
#include "support/data.h"

using namespace cerberus;
using namespace cerberus::bench;

namespace {

constexpr int kLeastFrames = 40;  // annotated
// Of all frames, with the middle inside. One person alone is no measure: a difference in rounding decides about a second of
// some. Seen: .990; 1.000 with another rounding.
constexpr double kAsked = 0.97;

bool follow(Run& run, const std::string& source, const std::string& head) {
  const std::string angles = window_angles(), tilt = window_tilt();
  const std::string line = source +
                           " ! virtualptz width=320 height=240 wide-fov=60 ! motiondetect ! pirfusion " +
                           angles + " ! tee name=t  t. ! queue ! pantiltsink name=head driver=simulated " +
                           angles + " " + tilt + " " + head + "  t. ! queue ! appsink name=out sync=false";
  return for_each_sample(
      line, [](GstSample*, int) {}, [&](GstElement* pipeline) { watch_head(pipeline, run); });
}

}  // namespace

// The arguments, if any, are properties of pantiltsink.
int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  const auto real = tests::real_video();
  if (!real) return tests::kSkipped;
  const bool judged = argc == 1;
  std::string head;
  for (int i = 1; i < argc; ++i) head += std::string(argv[i]) + " ";
  const People truth = read_people(real->data / "pets09_s2l1_view1" / "gt_interpolated.txt");
  std::map<int, std::vector<int>> frames;  // of each person
  for (const auto& [frame, people] : truth)
    for (const Person& p : people) frames[p.id].push_back(frame);
  std::printf(
      "The closed loop on vtest.avi, window 320x240; of the annotated frames since chosen\n"
      "  person  from  waited  chosen at  frames   middle inside   nine tenths inside   by the chosen track  "
      " "
      "tracks\n");
  Run all(&truth, 0, 0);
  Asked asked;
  for (const auto& [person, seen] : frames) {
    if (static_cast<int>(seen.size()) < kLeastFrames) continue;
    // Once from the start, and once more from each later stretch of annotation.
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (i > 0 && seen[i] - seen[i - 1] < 50) continue;
      Run run(&truth, person, seen[i]);
      if (!follow(run, real->vtest, head)) return 1;
      const double n = std::max(run.annotated, 1);
      std::printf("  %6d %5d %7d %10d %7d %14.3f %20.3f %21.3f %8zu\n", person, seen[i], run.waited,
                  run.chosen_at, run.annotated, run.middle / n, run.most / n, run.tracked / n,
                  run.carriers.size());
      all.annotated += run.annotated;
      all.middle += run.middle;
      all.most += run.most;
      all.tracked += run.tracked;
    }
  }
  const double n = std::max(all.annotated, 1);
  std::printf("  %-32s %7d %14.3f %20.3f %21.3f", "all", all.annotated, all.middle / n, all.most / n,
              all.tracked / n);
  if (judged) std::printf("%s", asked.at_least("the share inside of all", all.middle / n, kAsked).c_str());
  std::puts("");
  return judged ? asked.verdict() : 0;
}
