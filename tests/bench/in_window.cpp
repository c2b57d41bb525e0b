// SPDX-License-Identifier: LGPL-2.1-or-later
// Does the closed loop keep a person in the picture? A window of 320 x 240 over vtest.avi, turned by a simulated head
// towards one annotated person: chosen on the first frame on which a track has that person's box, as an application
// chooses, by pantiltsink's signal `follow`; before that the head stands. Counted from then on: annotated frames on
// which the person's middle, and nine tenths of the visible part of the person, are inside the window. The last
// columns show whether that is the loop's merit: on how many of these frames the chosen track has the person's box,
// and how many tracks had it. A last run leaves the choice to fusion: how far the target's box is from the middle, degrees,
// and how far from where the window could be, whose limits many people walk beyond.
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
// Of the frames that are judged, with the middle inside. Seen: .978 to .987; 1.000 with .03 degrees of noise on the poses.
constexpr double kAsked = 0.97;
// Person 9, from frame 4 on, stands with two others for 8 s, and which of the three tracks is that person's afterwards is
// chance: with 24 seeds of .03 degrees of noise on the poses .79 +- .05 are inside, with the proportional law before as now.
constexpr int kByChance = 9, kByChanceFrom = 4;
// Degrees. Seen: 1.9, and 2.1 with the proportional law before; asked of the whole, where 3.3 is seen.
constexpr double kMostOff = 2.6;

std::string loop(const std::string& source, const std::string& head) {
  const std::string angles = window_angles(), tilt = window_tilt();
  return source + " ! virtualptz width=320 height=240 wide-fov=60 ! motiondetect ! pirfusion " + angles +
         " ! tee name=t  t. ! queue ! pantiltsink name=head driver=simulated " + angles + " " + tilt + " " +
         head + "  t. ! queue ! appsink name=out sync=false";
}

bool follow(Run& run, const std::string& source, const std::string& head) {
  return for_each_sample(
      loop(source, head), [](GstSample*, int) {}, [&](GstElement* pipeline) { watch_head(pipeline, run); });
}

// Of the target's box, means over frames, degrees: from the middle of the window, and from its middle where the window is
// as near as its limits let it.
struct BoxError {
  double off = 0, within_reach = 0;
  int frames = 0;

  void add(GstBuffer* buffer) {
    g_autoptr(CerberusFusion) fusion = cerberus_buffer_get_fusion(buffer);
    g_autoptr(CerberusPose) pose = cerberus_buffer_get_pose(buffer);
    if (!fusion || fusion->target == 0 || !pose) return;
    g_autoptr(GPtrArray) tracks = cerberus_buffer_get_regions(buffer);
    for (guint i = 0; i < tracks->len; ++i) {
      const auto* r = static_cast<const CerberusRegion*>(g_ptr_array_index(tracks, i));
      if (r->id != fusion->target) continue;
      const double right = kRadian * std::atan((r->x + r->width / 2 - kWindowWidth / 2) / kFocal);
      const double up = kRadian * std::atan((kWindowHeight / 2 - r->y - r->height / 2) / kFocal);
      off += std::hypot(right, up);
      within_reach += std::hypot(std::clamp(pose->pan + right, -kPan, kPan) - pose->pan,
                                 std::clamp(pose->tilt + up, -kTilt, kTilt) - pose->tilt);
      ++frames;
    }
  }
};

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
  int judged_frames = 0, judged_inside = 0;
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
      if (person == kByChance && seen[i] == kByChanceFrom) continue;
      judged_frames += run.annotated;
      judged_inside += run.middle;
    }
  }
  const double n = std::max(all.annotated, 1);
  std::printf("  %-32s %7d %14.3f %20.3f %21.3f", "all", all.annotated, all.middle / n, all.most / n,
              all.tracked / n);
  const double share = static_cast<double>(judged_inside) / std::max(judged_frames, 1);
  std::printf("\n  all but person %d from frame %d on: %.3f", kByChance, kByChanceFrom, share);
  if (judged) std::printf("%s", asked.at_least("the share inside", share, kAsked).c_str());
  BoxError error;
  const auto add = [&](GstSample* sample, int) { error.add(gst_sample_get_buffer(sample)); };
  if (!for_each_sample(loop(real->vtest, head), add)) return 1;
  const double frames_seen = std::max(error.frames, 1), within = error.within_reach / frames_seen;
  std::printf("\n  fusion's target, %d frames: %.2f degrees off, %.2f within reach", error.frames,
              error.off / frames_seen, within);
  if (judged) std::printf("%s", asked.at_most("the box error within reach", within, kMostOff).c_str());
  std::puts("");
  return judged ? asked.verdict() : 0;
}
