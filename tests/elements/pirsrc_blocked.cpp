// SPDX-License-Identifier: LGPL-2.1-or-later
// Sensors whose driver blocks for ever delay no change of state, no event and no query.
#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <vector>

#include "../support/pipe.h"
#include "../support/pir_source.h"
#include "promises.h"
#include "support.h"

#include <cerberus/base.h>

namespace {

using cerberus::tests::Pipe;
using std::chrono::milliseconds;

// Plays; its driver is in a call that does not return before `gate` is opened.
struct Blocked {
  Pipe gate, bell;
  PirSource source;
  Blocked()
      : source("pirsrc is-live=true script=\"0,0,0,1; 1,1,1,1; wait " + gate.reader() + " " + bell.writer() +
               "\"") {
    source.play();
    bell.read();
  }
};

milliseconds down(Blocked& blocked, GstState state) {
  return time_taken([&] { gst_element_set_state(blocked.source.element(), state); });
}

}  // namespace

GST_START_TEST(a_blocked_driver_delays_no_change_of_state) {
  constexpr std::array kStates = {GST_STATE_PAUSED, GST_STATE_PLAYING, GST_STATE_READY};
  std::array<milliseconds, kStates.size()> best;
  best.fill(milliseconds::max());
  for (int round = 0; round < kRounds && std::ranges::max(best) >= kPromised; ++round) {
    Blocked blocked;
    for (std::size_t k = 0; k < kStates.size(); ++k) best[k] = std::min(best[k], down(blocked, kStates[k]));
  }
  for (std::size_t k = 0; k < kStates.size(); ++k)
    fail_unless(best[k] < kPromised, "%s takes %d ms", gst_element_state_get_name(kStates[k]),
                static_cast<int>(best[k].count()));
}
GST_END_TEST

GST_START_TEST(a_blocked_driver_delays_no_reading_event_or_query) {
  assert_prompt("a reading, an event and a query", [] {
    Blocked blocked;
    return time_taken([&] {
      std::vector<int> readings;
      do {
        g_autoptr(GstBuffer) buffer = blocked.source.take();
        readings = readings_of(buffer);
      } while (nothing_is_known(readings));
      fail_unless(readings == std::vector({0, 0, 1}));  // the reading before it blocked
      fail_unless(gst_harness_push_upstream_event(blocked.source.harness(), base_event(9, GST_SECOND)));
      g_autoptr(GstCaps) caps = gst_pad_peer_query_caps(blocked.source.harness()->sinkpad, nullptr);
      fail_unless(gst_caps_is_fixed(caps));
    });
  });
}
GST_END_TEST

static Suite* pirsrc_blocked_suite() {
  watch_library_log();
  Suite* suite = suite_create("pirsrc whose driver blocks");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, a_blocked_driver_delays_no_change_of_state);
  tcase_add_test(tests, a_blocked_driver_delays_no_reading_event_or_query);
  return suite;
}

GST_CHECK_MAIN(pirsrc_blocked)
