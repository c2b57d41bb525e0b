// SPDX-License-Identifier: LGPL-2.1-or-later
// A pirsrc on hardware that the kernel simulates, and what the tests ask of it.
#pragma once

#include "simulated.h"  // before gst-check, whose macros C++ streams cannot bear

#include <algorithm>
#include <string>
#include <vector>

#include "../support/pir_source.h"

namespace simulated {

using Bytes = std::vector<int>;

class Source : public PirSource {
 public:
  explicit Source(const std::string& properties, const char* caps = nullptr)
      : PirSource("pirsrc " + properties, caps) {
    gst_harness_use_systemclock(harness());
  }

  GstClockTime now() const {
    GstClock* clock = gst_element_get_clock(element());
    const GstClockTime time = gst_clock_get_time(clock) - gst_element_get_base_time(element());
    gst_object_unref(clock);
    return time;
  }
  // The next buffer's readings; `when` = its time.
  Bytes reading(GstClockTime* when = nullptr) {
    GstBuffer* buffer = take();
    if (when) *when = GST_BUFFER_PTS(buffer);
    Bytes bytes = readings_of(buffer);
    gst_buffer_unref(buffer);
    return bytes;
  }
  // Waits for these readings, which must come with the next change; the first, as soon as the sensors are open.
  GstClockTime expect(const Bytes& expected) {
    const Bytes before = last_;
    GstClockTime when = 0;
    do last_ = reading(&when);
    while (last_ != expected && (last_ == before || (before.empty() && nothing_is_known(last_))));
    fail_unless(last_ == expected, "%s came, not %s", text(last_).c_str(), text(expected).c_str());
    return when;
  }
  // Starting fails; what it said.
  std::string refusal(gint code) { return PirSource::refusal(GST_RESOURCE_ERROR, code); }

 private:
  static std::string text(const Bytes& bytes) {
    std::string all;
    for (const int byte : bytes) all += std::to_string(byte);
    return all;
  }
  Bytes last_;
};

struct Span {
  GstClockTime before, after;
};

// The kernel stamped it while it happened. A millisecond: the two clocks cannot be read at the same moment.
inline void must_be_of(GstClockTime when, const Span& span) {
  fail_unless(when + GST_MSECOND >= span.before && when <= span.after + GST_MSECOND,
              "stamped %" GST_TIME_FORMAT ", happened %" GST_TIME_FORMAT " to %" GST_TIME_FORMAT,
              GST_TIME_ARGS(when), GST_TIME_ARGS(span.before), GST_TIME_ARGS(span.after));
}

// A bound that is promised, on a machine within a machine that may be busy: of many rounds one must keep it.
template <typename Round>
GstClockTime least_of(GstClockTime promised, Round&& round) {
  GstClockTime least = GST_CLOCK_TIME_NONE;
  for (int i = 0; i < 20 && least >= promised; ++i) least = std::min<GstClockTime>(least, round());
  return least;
}

}  // namespace simulated
