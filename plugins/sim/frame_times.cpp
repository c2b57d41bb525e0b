// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame_times.hpp"

#include <algorithm>

#include "shared/times.hpp"

namespace cerberus::plugin {

FrameTimes::Time FrameTimes::taken(const GstSegment& segment, GstBuffer* frame) const {
  const GstClockTime running = running_time_of(segment, frame);
  return GST_CLOCK_TIME_IS_VALID(running) ? time_of(running) : end_.value_or(Time::zero());
}

namespace {

// From running time `begin` until `frame`; nullptr: nothing is between them.
GstEvent* gap(const GstSegment& segment, motion::Time begin, GstBuffer* frame) {
  const GstClockTime until = GST_BUFFER_PTS(frame);
  if (!GST_CLOCK_TIME_IS_VALID(until)) return nullptr;
  guint64 from = gst_segment_position_from_running_time(&segment, GST_FORMAT_TIME, clock_time(begin));
  if (!GST_CLOCK_TIME_IS_VALID(from)) from = segment.start;  // it was in the segment before
  return from < until ? gst_event_new_gap(from, until - from) : nullptr;
}

}  // namespace

GstEvent* FrameTimes::gap_before(const GstSegment& segment, GstBuffer* frame) const {
  return end_ && taken(segment, frame) > *end_ ? gap(segment, *end_, frame) : nullptr;
}

GstEvent* FrameTimes::gap_from_last(const GstSegment& segment, GstBuffer* frame) const {
  return last_ ? gap(segment, *last_, frame) : nullptr;
}

void FrameTimes::add(const GstSegment& segment, const GstVideoInfo& info, GstBuffer* frame) {
  // As long as nobody knows how long it lasts, it does: a gap begins later than a frame.
  last_ = taken(segment, frame);
  end_ = *last_ + std::max(running_length(GST_BUFFER_DURATION(frame), info, segment), Time(1));
}

}  // namespace cerberus::plugin
