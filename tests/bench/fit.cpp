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
#include <map>
#include <span>
#include <string>
#include <vector>

#include "asked.h"
#include "boxes.h"
#include "frames.h"
#include "people_sequences.h"
#include "support/data.h"
#include "tracks.h"

using namespace cerberus;
using namespace cerberus::bench;
namespace fs = std::filesystem;

namespace {

constexpr double kHiddenFor = 3;  // s, issue: who was hidden for so long is the same
constexpr double kAround = 1;     // s before and after it in which the person must be matched to be judged

constexpr double kLargestBias = 0.05;  // of the person's width or height, issue
// The share of hidden people that must be kept where there are many (all are wanted): 33 of 35 are, one more may be lost.
constexpr double kLeastKept = 0.9;
constexpr const char* kManyHidden = "PETS09-S2L1";

std::string line_of(const std::string& source, const std::string& detector) {
  return source + " ! " + detector + " ! appsink name=out sync=false";
}

vision::Size size_of(GstSample* sample) {
  const GstStructure* s = gst_caps_get_structure(gst_sample_get_caps(sample), 0);
  vision::Size size{};
  gst_structure_get_int(s, "width", &size.width);
  gst_structure_get_int(s, "height", &size.height);
  return size;
}

double seconds_of(GstSample* sample) {
  return static_cast<double>(GST_BUFFER_PTS(gst_sample_get_buffer(sample))) / GST_SECOND;
}

// What is known of one person in one frame.
struct Seen {
  double time = 0;
  bool hidden = false;
  int track = -1;  // the one that is matched
};
using Lives = std::map<int, std::vector<Seen>>;  // by person, in the order of time

struct Fit {
  std::vector<double> width, foot, head;  // of the person's width, height, height; positive: wider, lower
};

// More than half of the box is covered by people whose feet are lower in the picture: they are nearer.
bool covered(const Person& person, std::span<const Person> all) {
  constexpr int kSamples = 20;
  int behind = 0;
  for (int y = 0; y < kSamples; ++y)
    for (int x = 0; x < kSamples; ++x) {
      const double px = person.box.x + (x + 0.5) * person.box.width / kSamples;
      const double py = person.box.y + (y + 0.5) * person.box.height / kSamples;
      behind += std::ranges::any_of(all, [&](const Person& o) {
        return o.id != person.id && o.box.bottom() > person.box.bottom() && px >= o.box.x &&
               px < o.box.right() && py >= o.box.y && py < o.box.bottom();
      });
    }
  return 2 * behind > kSamples * kSamples;
}

double middle(std::vector<double> values) {
  return values.empty() ? std::nan("") : median(std::move(values));
}

struct Identities {
  int asked = 0, kept = 0, lost = 0;  // lost: no track in the second after it
};

// Times of at most kHiddenFor in which a person is hidden, or not annotated between two frames in which he is.
Identities after_hiding(const Lives& lives, double frame) {
  Identities result;
  for (const auto& [id, life] : lives)
    for (std::size_t i = 1; i < life.size(); ++i) {
      const bool gap = life[i].time - life[i - 1].time > 1.5 * frame;
      if (life[i - 1].hidden || (!life[i].hidden && !gap)) continue;
      std::size_t end = i;
      while (end < life.size() && life[end].hidden) ++end;
      if (end == life.size()) break;
      const double from = life[i - 1].time, to = life[end].time;
      if (to - from > kHiddenFor) continue;
      int before = -1, after = -1;
      for (std::size_t k = 0; k < i; ++k)
        if (life[k].track >= 0 && from - life[k].time <= kAround) before = life[k].track;
      for (std::size_t k = end; k < life.size() && after < 0 && life[k].time - to <= kAround; ++k)
        after = life[k].track;
      if (before < 0) continue;
      ++result.asked;
      result.kept += before == after;
      result.lost += after < 0;
      i = end;
    }
  return result;
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
          lives[p.id].push_back({time, covered(p, people->second), f ? f->id : -1});
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
  const Identities hidden = after_hiding(lives, (last - first) / std::max(1, frames - 1));
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
  const auto data = tests::data_folder();
  const auto video = tests::vtest_source();
  if (!data || !video) {
    std::printf("skipped: %s\n", data ? tests::kNoVtest : tests::kNoData);
    return 77;
  }
  Asked asked;
  bool measured = true;
  std::puts("Fit and identities    boxes    width     foot     head   hidden  kept  lost");
  for (const PeopleSequence& s : people_sequences(*data, *video))
    if (fs::exists(s.truth)) measured = measure(s, detector, asked) && measured;
  if (detector != kJudged) return measured ? 0 : 1;
  const int verdict = asked.verdict();
  return measured ? verdict : 1;
}
