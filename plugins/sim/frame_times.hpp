// SPDX-License-Identifier: LGPL-2.1-or-later
// When the frames of a stream are taken, in running time, and where some are missing.
//
// After a frame a head tells its way until the next one, where it takes that to
// be. Where frames are missing (lost ones, a variable rate, a decoder that was cut
// off) it has to be told that none comes, or it waits for one, and one for it.
#pragma once

#include <gst/video/video.h>

#include <optional>

#include "motion/head_limits.h"

namespace cerberus::plugin {

class FrameTimes {
 public:
  using Time = motion::Time;

  // Running time begins anew.
  void forget() { last_ = end_ = {}; }
  // When this frame is taken. Without a time stamp: when the last one ended, as pantiltsink counts.
  Time taken(const GstSegment& segment, GstBuffer* frame) const;
  // What is missing between the last frame and this one, as an event for those behind; nullptr: nothing.
  GstEvent* gap_before(const GstSegment& segment, GstBuffer* frame) const;
  // The same if the last frame was lost on its way to the head, too.
  GstEvent* gap_from_last(const GstSegment& segment, GstBuffer* frame) const;
  void add(const GstSegment& segment, const GstVideoInfo& info, GstBuffer* frame);

 private:
  std::optional<Time> last_, end_;  // begin and end of the last frame
};

}  // namespace cerberus::plugin
