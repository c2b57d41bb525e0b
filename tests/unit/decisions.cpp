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

START_TEST(the_chosen_track_is_the_decision_from_the_next_frame_on_until_it_is_given_up) {
  Stream stream;
  const Track others[]{{.id = 4, .x = 10, .y = 10, .width = 20, .height = 60, .age = 2s},
                       {.id = 9, .x = 50, .y = 10, .width = 10, .height = 20, .age = 2s}};
  const auto frame = [&](Time time, std::size_t count) {
    return stream.decisions
        .frame(time, time, true,
               [&](Time, std::vector<Track>& tracks) {
                 tracks.assign(others, others + count);
                 return snapshot_of(0);
               })
        .decision;
  };
  ck_assert(frame(1s, 2).target == 4 && frame(1040ms, 2).rule_name == "camera");
  stream.decisions.choose(9);
  const Decision chosen = frame(1080ms, 2);
  ck_assert(chosen.action == Action::track && chosen.target == 9 && chosen.rule == 0);
  ck_assert(!chosen.immediate);
  ck_assert(chosen.rule_name == "chosen" && chosen.changed && chosen.camera_found);
  ck_assert(!frame(1120ms, 2).changed);
  // A sensor does not take the head from it between two frames.
  const auto between = stream.between(1130ms, 1);
  ck_assert(between && between->decision.target == 9);
  ck_assert(frame(1160ms, 1).action == Action::hold);  // it is awaited: no other track is followed
  ck_assert(frame(1200ms, 2).target == 9);
  frame(1240ms, 1);
  const Decision lost = frame(1200ms + TargetOverride::kPatience, 1);
  ck_assert(lost.target == 4 && lost.rule_name == "camera" && lost.changed);
  stream.decisions.choose(9);
  ck_assert(frame(7s, 2).target == 9);
  stream.decisions.choose(31);  // the last frame, which had 9, says nothing of it
  const auto between_choices = stream.between(7010ms, 1);
  ck_assert(between_choices && between_choices->decision.target != 31);
  stream.decisions.choose(9);
  ck_assert(frame(7020ms, 2).target == 9);
  stream.decisions.choose(0);
  ck_assert(frame(7040ms, 2).rule_name == "camera");
  stream.decisions.choose(31);  // a track that is gone
  ck_assert(frame(7080ms, 2).rule_name == "camera" && frame(7080ms, 2).target != 31);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "decisions", {only_another_value_of_the_same_sensors_decides_between_frames,
                    no_decision_uses_older_readings_than_the_one_before,
                    a_stream_that_is_not_live_has_ended_or_is_flushed_has_no_last_frame,
                    changes_are_published_once_in_their_order,
                    the_chosen_track_is_the_decision_from_the_next_frame_on_until_it_is_given_up,
                    a_rules_name_outlives_its_table_and_steady_state_allocates_nothing});
}
