// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame_times.hpp"

#include <algorithm>

#include "times.hpp"

namespace cerberus::plugin {

FrameTimes::Time FrameTimes::taken(const GstSegment& segment, GstBuffer* frame) const {
  GstClockTime running = GST_CLOCK_TIME_NONE;
  if (segment.format == GST_FORMAT_TIME && GST_BUFFER_PTS_IS_VALID(frame))
    running = gst_segment_to_running_time(&segment, GST_FORMAT_TIME, GST_BUFFER_PTS(frame));
  return GST_CLOCK_TIME_IS_VALID(running) ? time_of(running) : end_.value_or(Time::zero());
}

GstEvent* FrameTimes::gap_before(const GstSegment& segment, GstBuffer* frame) const {
  if (!end_ || taken(segment, frame) <= *end_) return nullptr;
  const GstClockTime until = GST_BUFFER_PTS(frame);
  guint64 from = gst_segment_position_from_running_time(&segment, GST_FORMAT_TIME, clock_time(*end_));
  if (!GST_CLOCK_TIME_IS_VALID(from)) from = segment.start;  // the last frame was of the segment before
  return from < until ? gst_event_new_gap(from, until - from) : nullptr;
}

void FrameTimes::add(const GstSegment& segment, const GstVideoInfo& info, GstBuffer* frame) {
  // As long as nobody knows how long it lasts, it does: a gap begins later than a frame.
  end_ = taken(segment, frame) + std::max(running_length(GST_BUFFER_DURATION(frame), info, segment), Time(1));
}

}  // namespace cerberus::plugin
