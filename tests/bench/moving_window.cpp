// SPDX-License-Identifier: LGPL-2.1-or-later
// Does detection go on while the camera turns? A window of 320 x 240 goes to and fro over vtest.avi at 12 pixels a
// frame; beside it windows at rest over the same places. Box precision and recall of both, as tests/bench/quality.cpp
// scores them, on the people as the window cuts them. And does who it is stay who it is, when the window comes back to
// him? IDF1, one identity a person and way, groups on neither side; it means nothing of a chain without tracks.
#include <cerberus/cerberus.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "asked.h"
#include "boxes.h"
#include "people_sequences.h"
#include "support/data.h"
#include "tracks.h"
#include "vision/geometry/window.h"

using namespace cerberus;
using namespace cerberus::bench;

namespace {

constexpr vision::Size kPicture{768, 576}, kWindow{320, 240};
constexpr double kWideFov = 60;  // degrees: any will do, the window counts in pixels
constexpr double kSpeed = 12;    // pixels a frame
constexpr double kReach = 192;   // pixels to each side of the middle; beyond it the truth ends
constexpr int kPhases = 8;       // ways that begin evenly spread along the path; as many places of rest
constexpr double kLeastSeen =
    0.5;  // of a person, inside the window: with less there is no person, and no mistake either

// Somewhere on the path there and back again.
double along(double way) {
  const double turn = std::fmod(way, 4 * kReach);
  return turn < 2 * kReach ? turn - kReach : 3 * kReach - turn;
}

// The pan at which the middle of the window lies this far to the right of the picture's.
double pan_of(double pixels) {
  const double focal = kPicture.width / 2.0 / std::tan(kWideFov * G_PI / 360);
  return std::atan(pixels / focal) * 180 / G_PI;
}

struct Window {
  double first, speed;  // along the path: pixels, pixels a frame
  double left(int frame) const {
    return (kPicture.width - kWindow.width) / 2.0 + along(first + speed * frame);
  }
};

vision::Box clip(const vision::Box& b, double left, double top) {
  const double x0 = std::max(b.x - left, 0.0), y0 = std::max(b.y - top, 0.0);
  return {x0, y0, std::min<double>(b.right() - left, kWindow.width) - x0,
          std::min<double>(b.bottom() - top, kWindow.height) - y0};
}

// The pose of frame `number`, as its head would publish it while frame `number - 1` is analysed.
void send_pose(GstElement* pipeline, const Window& window, int number, GstClockTime from,
               GstClockTime until) {
  CerberusPose pose;
  cerberus_pose_init(&pose);
  const double seconds = static_cast<double>(until - from) / GST_SECOND;
  pose.pan = pan_of(along(window.first + window.speed * (number - 1)));
  pose.pan_speed = (pan_of(along(window.first + window.speed * number)) - pose.pan) / seconds;
  pose.valid_from = from;
  pose.valid_until = until;
  pose.moving = window.speed != 0;
  GstElement* out = gst_bin_get_by_name(GST_BIN(pipeline), "out");
  GstPad* pad = gst_element_get_static_pad(out, "sink");
  gst_pad_push_event(pad, cerberus_event_new_pose(&pose));
  gst_object_unref(pad);
  gst_object_unref(out);
}

bool measure(Counts& counts, TrackScore& identities, const std::string& source, const People& truth,
             const std::string& detector, const Window& window) {
  const double top = (kPicture.height - kWindow.height) / 2.0;
  GstElement* pipeline = nullptr;
  return for_each_sample(
      source + " ! virtualptz name=ptz lockstep=on width=320 height=240 wide-fov=60 start-pan=" +
          std::to_string(pan_of(along(window.first))) + " ! " + detector + " ! appsink name=out sync=false",
      [&](GstSample* sample, int n) {
        GstBuffer* buffer = gst_sample_get_buffer(sample);
        const GstClockTime now = GST_BUFFER_PTS(buffer);
        send_pose(pipeline, window, n + 1, now, now + GST_BUFFER_DURATION(buffer));
        const auto people = truth.find(n);
        if (people == truth.end()) return;
        const double left = window.left(n);
        std::vector<vision::Box> found = found_boxes(buffer), there, half;
        std::vector<Person> people_found = people_of(found_on(buffer)), people_there;
        for (const Person& p : people->second) {
          const vision::Box seen = clip(p.box, left, top);
          if (!(seen.width > 0 && seen.height > 0)) continue;
          const bool mostly = seen.area() >= kLeastSeen * p.box.area();
          (mostly ? there : half).push_back(seen);
          if (mostly) people_there.push_back({p.id, seen});
        }
        const auto unscored = [&](const vision::Box& b) {
          const auto covers = [&](const vision::Box& h) {
            return vision::overlap_area(b, h) > 0.5 * b.area();
          };
          return left + b.right() > kTruthEnds || std::ranges::any_of(half, covers);
        };
        std::erase_if(found, unscored);
        std::erase_if(people_found, [&](const Person& p) { return unscored(p.box); });
        match(counts, found, there);
        identities.add(people_there, people_found);
      },
      [&](GstElement* p) { pipeline = p; });
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  const auto real = tests::real_video();
  if (!real) return tests::kSkipped;
  const People truth = read_people(real->data / "pets09_s2l1_view1" / "gt_interpolated.txt");
  // The whole chain, and what it would be without tracks.
  std::vector<std::string> detectors{kJudged,
                                     "cameramotion ! threeframediff ! fuzzythreshold ! motionregions"};
  if (argc > 1) detectors.assign(argv + 1, argv + argc);
  std::printf(
      "A window of 320x240 over vtest.avi, %d ways or places each, IoU >= 0.5   precision  recall   IDF1\n",
      kPhases);
  Asked asked;
  for (const std::string& detector : detectors) {
    Counts rest, moving;
    double idf1_rest = 0, idf1_moving = 0;  // means of the ways or places
    for (int i = 0; i < kPhases; ++i) {
      TrackScore at_rest, on_the_way;
      if (!measure(rest, at_rest, real->vtest, truth, detector, {2 * kReach * (i + 0.5) / kPhases, 0}) ||
          !measure(moving, on_the_way, real->vtest, truth, detector,
                   {4 * kReach * (i + 0.5) / kPhases, kSpeed}))
        return 1;
      idf1_rest += at_rest.idf1() / kPhases;
      idf1_moving += on_the_way.idf1() / kPhases;
    }
    std::printf("%s\n", detector.c_str());
    const auto row = [](const char* name, const Counts& c, double idf1) {
      std::printf("  %-40s %.3f  %.3f  %.3f   (%.0f right, %.0f wrong, %.0f missed)\n", name, c.precision(),
                  c.recall(), idf1, c.hit, c.extra, c.missed);
    };
    row("at rest", rest, idf1_rest);
    row("at 12 pixels a frame", moving, idf1_moving);
    struct Figure {
      const char* name;
      double reached, least;
    };
    for (const Figure& f : {Figure{"precision, at rest", rest.precision(), 0.81},
                            {"precision, moving / at rest", moving.precision() / rest.precision(), 0.9},
                            {"recall, moving / at rest", moving.recall() / rest.recall(), 0.9},
                            {"recall, moving", moving.recall(), 0.71},
                            {"IDF1, moving / at rest", idf1_moving / idf1_rest, 0.9},
                            {"IDF1, moving", idf1_moving, 0.58}})
      std::printf("  %-40s %.3f%s\n", f.name, f.reached,
                  detector == kJudged ? asked.at_least(f.name, f.reached, f.least).c_str() : "");
  }
  return asked.verdict();
}
