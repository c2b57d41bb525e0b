// SPDX-License-Identifier: LGPL-2.1-or-later
// Decisions with frames and between them: order, limits of what may follow, and what is published.
#include "fusion/decisions.h"

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::fusion;
using namespace std::chrono_literals;

namespace {

// One sensor ahead that reads `value`, and a head that points ahead.
SensorSnapshot snapshot_of(std::uint8_t value, double bearing = 0) {
  SensorSnapshot snapshot;
  snapshot.count = 1;
  snapshot.sensors[0] = value;
  snapshot.bearings[0] = bearing;
  snapshot.fields_of_view[0] = 2;
  snapshot.pan_degrees = 0;
  return snapshot;
}

struct Stream {
  SensorInputs inputs;
  Decisions decisions{inputs};

  Stream() { inputs.set_flushing(false); }
  Decisions::Outcome frame(Time time, Time sensor_time, std::uint8_t value, bool live = true) {
    return decisions.frame(time, sensor_time, live,
                           [&](Time, std::vector<Track>&) { return snapshot_of(value); });
  }
  std::optional<Decisions::Outcome> between(Time sensor_time, std::uint8_t value, double bearing = 0) {
    return decisions.between(
        sensor_time, [&](Time, Time, SensorSnapshot& snapshot) { snapshot = snapshot_of(value, bearing); });
  }
  std::vector<Time> published() {
    std::vector<Time> times;
    decisions.publish_changes([&](Time time, const Decisions::Outcome&) { times.push_back(time); });
    return times;
  }
};

}  // namespace

START_TEST(only_another_value_of_the_same_sensors_decides_between_frames) {
  Stream stream;
  ck_assert(!stream.between(1s, 1));  // no frame yet
  stream.frame(1s, 1s, 0);
  ck_assert(!stream.between(1100ms, 0));
  ck_assert(!stream.between(1100ms, 1, 1));  // another sensor
  const auto outcome = stream.between(1100ms, 1);
  ck_assert(outcome && outcome->decision.fired == 1 && outcome->decided == 1100ms);
  ck_assert(!stream.between(1200ms, 1));
  ck_assert(stream.between(2s, 0));         // a second after the frame
  ck_assert(!stream.between(2s + 1ns, 1));  // later than that
}
END_TEST

START_TEST(no_decision_uses_older_readings_than_the_one_before) {
  Stream stream;
  stream.frame(1s, 1s, 0);
  ck_assert(stream.between(1500ms, 1)->decided == 1500ms);
  ck_assert(stream.frame(1040ms, 1400ms, 1).decided == 1500ms);
  ck_assert(stream.between(1500ms, 0)->decided == 1500ms + 1ns);
  ck_assert(stream.frame(100ms, 100ms, 1).decided == 100ms);  // running time began anew
}
END_TEST

START_TEST(a_stream_that_is_not_live_has_ended_or_is_flushed_has_no_last_frame) {
  Stream stream;
  stream.frame(1s, 1s, 0, false);
  ck_assert(!stream.between(1100ms, 1));
  stream.frame(1s, 1s, 0);
  stream.decisions.end();
  ck_assert(!stream.between(1100ms, 1));
  stream.inputs.set_flushing(true);
  stream.frame(1s, 1s, 0);
  ck_assert(!stream.between(1100ms, 1));
}
END_TEST

START_TEST(changes_are_published_once_in_their_order) {
  Stream stream;
  stream.frame(1s, 1010ms, 0);
  stream.between(1100ms, 1);
  stream.frame(1040ms, 1110ms, 1);  // nothing new
  ck_assert(stream.published() == (std::vector<Time>{1s, 1100ms}));
  ck_assert(stream.published().empty());
  stream.frame(1080ms, 1120ms, 0);
  stream.decisions.forget();
  ck_assert(stream.published().empty());
}
END_TEST

START_TEST(a_rules_name_outlives_its_table_and_steady_state_allocates_nothing) {
  Stream stream;
  const Decisions::Outcome outcome = stream.frame(1s, 1s, 0);
  ck_assert(outcome.decision.rule_name == "return");
  stream.decisions.configure({}, paper_rules());
  stream.decisions.forget();
  ck_assert_str_eq(outcome.decision.rule_name.data(), "return");
  stream.frame(1s, 1s, 0);
  const auto before = cerberus::tests::allocations();
  for (int i = 1; i < 50; ++i) stream.frame(1s + i * 1ms, 1s + i * 1ms, 0);
  ck_assert_uint_eq(cerberus::tests::allocations(), before);
}
END_TEST

int main() {
  return cerberus::tests::run_suite("decisions",
                                    {only_another_value_of_the_same_sensors_decides_between_frames,
                                     no_decision_uses_older_readings_than_the_one_before,
                                     a_stream_that_is_not_live_has_ended_or_is_flushed_has_no_last_frame,
                                     changes_are_published_once_in_their_order,
                                     a_rules_name_outlives_its_table_and_steady_state_allocates_nothing});
}
