// SPDX-License-Identifier: LGPL-2.1-or-later
// When a frame continues the ones before it, and when a new scene begins: the one place that decides it for every
// analysing element. Knows nothing of pixels.
#pragma once

#include <gst/gst.h>

namespace cerberus::plugin {

class History {
 public:
  // The next frame starts a scene: caps, segment, flush, DISCONT, an unusable buffer.
  void drop() { any_ = false; }

  // Running time of the last frame, or NONE.
  GstClockTime previous() const { return previous_; }

  struct Step {
    bool fresh = true;   // no predecessor: everything learnt from earlier frames is dropped
    double seconds = 0;  // since the previous frame; 0: none, or not known
    GstClockTime previous = GST_CLOCK_TIME_NONE;  // running time of the previous frame, where it has one
  };

  // time: running time of the frame, or NONE. nominal: frame distance of the caps in seconds, 0 = variable.
  Step next(GstClockTime time, double nominal);
  // Whether frames are missing between the last one and this: what a queue that leaks marks DISCONT, as others mark a cut.
  bool misses_frames(GstClockTime time, double nominal) const;

 private:
  bool any_ = false;  // a frame of this scene was seen
  GstClockTime previous_ = GST_CLOCK_TIME_NONE;
  GstClockTime newest_ = GST_CLOCK_TIME_NONE;  // of the frames of this scene that had a time at all
  double usual_ = 0;                           // smoothed distance between frames, s
};

}  // namespace cerberus::plugin
