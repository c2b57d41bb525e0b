// SPDX-License-Identifier: LGPL-2.1-or-later
// Decides whether a frame continues the ones before it or begins a new scene, for every analysing element, by times and
// marks alone.
#pragma once

#include <gst/gst.h>

#include <optional>

namespace cerberus::plugin {

class History {
 public:
  // The next frame starts a scene: caps, segment, flush, DISCONT.
  void drop() { any_ = false; }
  // Records a frame without its picture. The next one follows the last with a picture, unless too many are lost in a
  // row.
  void lose();

  // A frame came that repeats the last picture. Returns how long ago that was, in seconds; nothing where a scene begins.
  std::optional<double> repeat(GstClockTime time, double nominal);

  // Running time of the last frame, or NONE.
  GstClockTime previous() const { return previous_; }

  struct Step {
    bool fresh = true;       // no predecessor: everything learnt from earlier frames is dropped
    bool broken = false;     // there was a predecessor, but the time ended the scene
    bool backwards = false;  // older than the frame before; if only a little, its time counts as unknown
    double seconds = 0;      // since the previous frame; 0: none, or not known
    GstClockTime previous = GST_CLOCK_TIME_NONE;  // running time of the previous frame, where it has one
  };

  // time: running time of the frame, or NONE. nominal: frame distance of the caps in seconds, 0 = variable.
  Step next(GstClockTime time, double nominal);
  // Returns whether frames are missing between the last one and this: a leaky queue marks the gap by DISCONT, as a cut
  // is marked.
  bool misses_frames(GstClockTime time, double nominal) const;

 private:
  void follow(Step& step, GstClockTime time, bool timed, double rhythm);

  bool any_ = false;  // a frame of this scene was seen
  int lost_ = 0;      // since the last frame
  int repeats_ = 0;   // likewise
  GstClockTime previous_ = GST_CLOCK_TIME_NONE;
  GstClockTime stamp_ = GST_CLOCK_TIME_NONE;  // of the last frame of this scene that had a time at all
  GstClockTime clock_ = GST_CLOCK_TIME_NONE;  // the time that was assumed for it
  int late_ = 0;                              // frames in a row that were older than that
  double usual_ = 0;                          // smoothed distance between frames, s
};

}  // namespace cerberus::plugin
