// SPDX-License-Identifier: LGPL-2.1-or-later
// How well boxes fit real people, and how long an identity lasts, through GStreamer and with no property set:
// - the fit: medians of width (of the person's width), foot and head (of his height) of the boxes with an IoU of .5,
//   people whom the picture's edge cuts left out; positive: wider, lower;
// - identities: of the people who are hidden for up to 3 s and had a track before, how many have the same one
//   afterwards, and how many have none within a second (lost).
//
//   bench-fit [DETECTOR]     instead of `motiondetect`; judged by the one who looks
#include <gst/gst.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "asked.h"
#include "boxes.h"
#include "frames.h"
#include "hidden_people.h"
#include "people_sequences.h"
#include "tracks.h"

using namespace cerberus;
using namespace cerberus::bench;

namespace {

constexpr double kLargestBias = 0.1;  // of the person's width or height, issue
// The share of hidden people that must be kept where there are many (all are wanted): 33 of 35 are, one more may be lost.
constexpr double kLeastKept = 0.9;
constexpr const char* kManyHidden = "PETS09-S2L1";

std::string line_of(const std::string& source, const std::string& detector) {
  return source + " ! " + detector + " ! appsink name=out sync=false";
}

double seconds_of(GstSample* sample) {
  return static_cast<double>(GST_BUFFER_PTS(gst_sample_get_buffer(sample))) / GST_SECOND;
}

struct Fit {
  std::vector<double> width, foot, head;  // of the person's width, height, height; positive: wider, lower
};

double middle(std::vector<double> values) {
  return values.empty() ? std::nan("") : median(std::move(values));
}

// False: it could not be measured.
bool measure(const PeopleSequence& s, const std::string& detector, Asked& asked) {
  const People truth = read_people(s.truth, 1e9);
  Fit fit;
  Lives lives;
  TrackScore pairs;  // a person keeps his last track where the two overlap
  double first = -1, last = 0;
  int frames = 0;
  if (!for_each_sample(line_of(s.source, detector), [&](GstSample* sample, int n) {
        const double time = seconds_of(sample);
        if (first < 0) first = time;
        last = time, ++frames;
        const auto people = truth.find(n);
        if (people == truth.end()) return;
        const auto found = people_of(found_on(gst_sample_get_buffer(sample)));
        const auto partner = pairs.add(people->second, found);
        const vision::Size size = size_of(sample);
        for (std::size_t i = 0; i < partner.size(); ++i) {
          const Person& p = people->second[i];
          const Person* f = partner[i] < 0 ? nullptr : &found[static_cast<std::size_t>(partner[i])];
          lives[p.id].push_back({time, is_covered(p, people->second), f ? f->id : -1});
          const bool whole =
              p.box.x >= 0 && p.box.y >= 0 && p.box.right() <= size.width && p.box.bottom() <= size.height;
          if (!f || !whole) continue;
          fit.width.push_back((f->box.width - p.box.width) / p.box.width);
          fit.foot.push_back((f->box.bottom() - p.box.bottom()) / p.box.height);
          fit.head.push_back((f->box.y - p.box.y) / p.box.height);
        }
      }))
    return false;
  const double width = middle(fit.width), foot = middle(fit.foot), head = middle(fit.head);
  const HiddenPeople hidden = hidden_people(lives, (last - first) / std::max(1, frames - 1));
  std::printf("  %-16s %6zu %+8.3f %+8.3f %+8.3f %8d %5d %5d", s.name.c_str(), fit.width.size(), width, foot,
              head, hidden.asked, hidden.kept, hidden.lost);
  const double worst = std::max({std::abs(width), std::abs(foot), std::abs(head)});
  const bool judged = detector == kJudged, many = s.name == kManyHidden;
  std::printf("%s", asked.at_most("bias on " + s.name, worst, kLargestBias, judged).c_str());
  if (hidden.asked > 0)
    std::printf("%s", asked
                          .at_least("people hidden on " + s.name + " who are kept",
                                    static_cast<double>(hidden.kept) / hidden.asked, many ? kLeastKept : 1,
                                    judged && many)
                          .c_str());
  std::puts("");
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  const std::string detector = argc > 1 ? argv[1] : kJudged;
  return for_each_people_sequence(
      "Fit and identities    boxes    width     foot     head   hidden  kept  lost", detector == kJudged,
      [&](const PeopleSequence& s, Asked& asked) { return measure(s, detector, asked); });
}
