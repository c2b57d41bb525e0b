// SPDX-License-Identifier: LGPL-2.1-or-later
#include "head_wait.hpp"

#include <algorithm>

#include "cerberus/private/messages.hpp"
#include "shared/clock_times.hpp"
#include "text/numbers.h"

namespace cerberus::plugin {

using motion::Time;

namespace {

// When no pose came for half the time-out, at most for so long, the last frame may have been lost on its way to the head.
constexpr Time kLost = std::chrono::milliseconds(500);

// Announces to the head that no frame is taken from running time `begin` until the one stamped `until`.
void push_gap(const HeadWait& wait, std::optional<Time> begin, GstClockTime until) {
  if (!begin || !GST_CLOCK_TIME_IS_VALID(until)) return;
  guint64 from = gst_segment_position_from_running_time(&wait.segment, GST_FORMAT_TIME, clock_time(*begin));
  if (!GST_CLOCK_TIME_IS_VALID(from)) from = wait.segment.start;  // it was in the segment before
  if (from < until) gst_pad_push_event(wait.src, gst_event_new_gap(from, until - from));
}

}  // namespace

GstFlowReturn wait_for_head(const HeadWait& wait, GstClockTime pts, Time time) {
  push_gap(wait, wait.times.gap_begin(time), pts);
  const Time patience = time_of(wait.timeout);
  const Time least(1);  // none at all would be for ever
  const Time lost_after = wait.timeout > 0 ? std::clamp(patience / 2, least, kLost) : kLost;
  using motion::PoseFeed;
  PoseFeed::Answer answer = wait.feed.wait(time, lost_after);
  if (answer == PoseFeed::Answer::silent) {
    // A head that has had the last frame drops this gap as old, however late it comes to it: the result stays the same.
    push_gap(wait, wait.times.last(), pts);
    answer = wait.feed.wait(time, wait.timeout > 0 ? std::max(patience - lost_after, least) : patience);
  }
  switch (answer) {
    case PoseFeed::Answer::known:
      return GST_FLOW_OK;
    case PoseFeed::Answer::interrupted:
      return GST_FLOW_FLUSHING;
    case PoseFeed::Answer::silent:
      break;
  }
  const std::string at = text::rounded(motion::seconds(time), 3).string();
  const std::string waited = text::significant(motion::seconds(patience), 3).string();
  CERBERUS_ELEMENT_ERROR(
      wait.element, RESOURCE, READ,
      ("The head \"%s\" published no pose for the frame at %s s: none came for %s s. Is there "
       "a pantiltsink of "
       "that name downstream? Without one, set lockstep=off.",
       wait.head.c_str(), at.c_str(), waited.c_str()),
      ("running time %" GST_TIME_FORMAT, GST_TIME_ARGS(clock_time(time))));
  return GST_FLOW_ERROR;
}

}  // namespace cerberus::plugin
