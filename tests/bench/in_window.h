// SPDX-License-Identifier: LGPL-2.1-or-later
// A window of 320 x 240 over vtest.avi that follows one annotated person, and what is counted of it: annotated frames,
// from the choice of the person on, on which the person's middle, and nine tenths of what the picture shows of the
// person, are inside the window.
#pragma once

#include <cerberus/cerberus.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <set>

#include "boxes.h"

namespace cerberus::bench {

inline constexpr double kWidth = 768, kHeight = 576, kWindowWidth = 320, kWindowHeight = 240;
inline constexpr double kRadian = 180 / G_PI;
// The wide picture sees 60 degrees: focal length, and from it what the window sees and how far it goes.
inline const double kFocal = kWidth / 2 / std::tan(30 / kRadian);
inline const double kFov = 2 * std::atan(kWindowWidth / 2 / kFocal) * kRadian;
inline const double kPan = std::atan((kWidth - kWindowWidth) / 2 / kFocal) * kRadian;
inline const double kTilt = std::atan((kHeight - kWindowHeight) / 2 / kFocal) * kRadian;
struct Run {
  Run(const People* t, int p, int f) : truth(t), person(p), first(f) {}
  const People* truth;
  int person, first;  // nobody is chosen before this frame
  int frame = 0;
  guint chosen = 0;
  int waited = 0;  // annotated frames with the middle inside before the choice
  int chosen_at = -1, annotated = 0, middle = 0, most = 0, tracked = 0;
  std::function<vision::Box(int)> window;  // of a frame; none: by the pose that it carries
  std::function<bool()> stop;              // orders to the head; none: by the signals of the element `head`
  std::function<bool(guint)> follow;
  std::set<guint> carriers;  // tracks that had the person's box
};

inline vision::Box window_at(double pan, double tilt) {
  return {kWidth / 2 + kFocal * std::tan(pan) - kWindowWidth / 2,
          kHeight / 2 - kFocal * std::tan(tilt) / std::cos(pan) - kWindowHeight / 2, kWindowWidth,
          kWindowHeight};
}
// By the pose on the frame.
inline vision::Box window_of(GstBuffer* buffer) {
  g_autoptr(CerberusPose) pose = cerberus_buffer_get_pose(buffer);
  const double pan = pose ? pose->pan / kRadian : 0, tilt = pose ? pose->tilt / kRadian : 0;
  return window_at(pan, tilt);
}

// In front of pantiltsink, and in its thread, so that a choice
// counts for the frame that it is made on: counts and chooses.
inline GstPadProbeReturn look(GstPad* pad, GstPadProbeInfo* info, gpointer data) {
  Run& run = *static_cast<Run*>(data);
  auto* buffer = GST_PAD_PROBE_INFO_BUFFER(info);
  GstElement* head = GST_PAD_PARENT(pad);
  gboolean obeyed = TRUE;
  const int frame = run.frame++;
  const auto order_stop = [&] {
    if (run.stop)
      obeyed = run.stop();
    else
      g_signal_emit_by_name(head, "stop", &obeyed);
  };
  const auto order_follow = [&](guint track) {
    if (run.follow)
      obeyed = run.follow(track);
    else
      g_signal_emit_by_name(head, "follow", track, &obeyed);
  };
  if (frame == 0) order_stop();
  const vision::Box window = run.window ? run.window(frame) : window_of(buffer);
  const std::vector<Person>* people = nullptr;
  const Person* person = nullptr;
  if (const auto here = run.truth->find(frame); here != run.truth->end()) {
    people = &here->second;
    for (const Person& p : *people)
      if (p.id == run.person) person = &p;
  }

  GPtrArray* tracks = cerberus_buffer_get_regions(buffer);
  guint has = 0;      // the track with the person's box
  bool seen = false;  // and nobody else's by half as much
  double best = 0.5;
  for (guint i = 0; person && i < tracks->len; ++i) {
    const auto* r = static_cast<const CerberusRegion*>(g_ptr_array_index(tracks, i));
    const vision::Box box{r->x + window.x, r->y + window.y, r->width, r->height};
    const double overlap = vision::intersection_over_union(box, person->box);
    if (overlap < best) continue;
    best = overlap;
    has = r->id;
    seen = std::ranges::none_of(*people, [&](const Person& p) {
      return p.id != run.person && vision::intersection_over_union(box, p.box) >= 0.5 * overlap;
    });
  }
  if (run.chosen == 0 && seen && frame >= run.first) {
    run.chosen = has;
    run.chosen_at = frame;
    order_follow(has);
  }
  if (!obeyed) std::fprintf(stderr, "bench: the head does not obey\n");
  g_ptr_array_unref(tracks);

  if (!person) return GST_PAD_PROBE_OK;
  const vision::Box& b = person->box;
  const double x = b.x + b.width / 2 - window.x, y = b.y + b.height / 2 - window.y;
  const bool inside = x >= 0 && y >= 0 && x <= kWindowWidth && y <= kWindowHeight;
  if (run.chosen == 0) {
    run.waited += inside && frame >= run.first;
  } else {
    ++run.annotated;
    run.middle += inside;
    run.most += vision::overlap_area(b, window) >= 0.9 * vision::overlap_area(b, {0, 0, kWidth, kHeight});
    run.tracked += has == run.chosen;
    if (has) run.carriers.insert(has);
  }
  return GST_PAD_PROBE_OK;
}

// Properties of an element that drives or moves the window.
inline std::string window_angles() {
  char text[200];
  std::snprintf(text, sizeof text, "horizontal-fov=%.4f pan-min=-%.4f pan-max=%.4f", kFov, kPan, kPan);
  return text;
}
inline std::string window_tilt() {
  char text[100];
  std::snprintf(text, sizeof text, "tilt-min=-%.4f tilt-max=%.4f", kTilt, kTilt);
  return text;
}
// Counts on the element `head` of the pipeline.
inline void watch_head(GstElement* pipeline, Run& run) {
  GstElement* sink = gst_bin_get_by_name(GST_BIN(pipeline), "head");
  GstPad* pad = gst_element_get_static_pad(sink, "sink");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, look, &run, nullptr);
  gst_object_unref(pad);
  gst_object_unref(sink);
}

}  // namespace cerberus::bench
