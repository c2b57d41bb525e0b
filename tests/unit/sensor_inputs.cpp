// SPDX-License-Identifier: LGPL-2.1-or-later
// Which thread waits for which, and the sensors of several groups by their places: worked out by hand.
#include "fusion/sensor_inputs.h"

#include <thread>

#include "support/suite.h"

using namespace cerberus::fusion;
using namespace std::chrono_literals;

namespace {

struct Inputs : SensorInputs {
  SensorSnapshot at(Time time) {
    const std::lock_guard guard(lock_);
    SensorSnapshot snapshot;
    read(time, snapshot);
    return snapshot;
  }
};

// A linked group of `count` sensors.
struct Group : SensorSource {
  Group(unsigned place, int count) {
    name = "group " + std::to_string(place);
    index = place;
    sensors = count;
    linked = true;
    flushing = false;
    auto array = std::make_shared<SensorArray>();
    array->count = count;
    array->bearings.fill(place);
    history.set_array(std::move(array));
  }
  void append(Time time, std::uint8_t value) {
    const std::uint8_t values[] = {value, value};
    history.append(time, std::span(values).first(static_cast<std::size_t>(sensors)));
  }
};

}  // namespace

START_TEST(a_frame_waits_until_every_linked_group_covers_its_time) {
  Inputs inputs;
  Group one(0, 1), two(1, 1);
  inputs.add(one), inputs.add(two);
  inputs.set_flushing(false);
  std::vector<SilentSource> silent;
  one.append(2s, 1);
  std::thread sensor([&] {
    const std::lock_guard guard(inputs.lock());
    two.append(3s, 1);
    inputs.add_reading(two, 3s);
  });
  ck_assert(inputs.frame_came(1s, Time::max(), silent) && silent.empty());
  sensor.join();
  inputs.set(two.linked, false);
  ck_assert(inputs.frame_came(2s, Time::zero(), silent));  // a live stream does not wait
}
END_TEST

START_TEST(a_group_that_stays_silent_is_given_up_until_it_speaks) {
  Inputs inputs;
  Group one(0, 1), two(1, 1);
  inputs.add(one), inputs.add(two);
  inputs.set_flushing(false);
  one.append(1s, 1), two.append(9s, 1);
  std::vector<SilentSource> silent;
  ck_assert(inputs.frame_came(5s, 1ms, silent));
  ck_assert(silent.size() == 1 && silent[0].name == "group 0" && !silent[0].ended);
  ck_assert(inputs.at(9s).sensors[0] == kInvalid && inputs.at(9s).sensors[1] == 1);
  ck_assert(inputs.frame_came(6s, Time::max(), silent) && silent.size() == 1);  // not waited for
  inputs.add_reading(one, 6s);
  ck_assert_int_eq(inputs.at(9s).sensors[0], 1);
}
END_TEST

START_TEST(live_patience_begins_with_the_first_frame_and_spares_recordings) {
  Inputs inputs;
  Group live(0, 1), recorded(1, 1);
  recorded.live = false;
  inputs.add(live), inputs.add(recorded);
  std::vector<SilentSource> silent;
  inputs.give_up_silent(10s, 1s, silent);
  inputs.give_up_silent(11s, 1s, silent);
  ck_assert(silent.empty());
  inputs.end(live);
  inputs.give_up_silent(11s + 1ns, 1s, silent);
  ck_assert(silent.size() == 1 && silent[0].name == "group 0" && silent[0].ended);
}
END_TEST

START_TEST(a_flush_ends_the_wait_of_a_frame) {
  Inputs inputs;
  Group one(0, 1);
  inputs.add(one);
  inputs.set_flushing(false);
  std::thread flush([&] { inputs.set_flushing(true); });
  std::vector<SilentSource> silent;
  ck_assert(!inputs.frame_came(1s, Time::max(), silent));
  flush.join();
}
END_TEST

START_TEST(a_recording_waits_for_the_video_ten_seconds_ahead) {
  Inputs inputs;
  Group one(0, 1);
  inputs.add(one);
  std::vector<SilentSource> silent;
  std::unique_lock guard(inputs.lock());
  ck_assert(inputs.wait_for_video(guard, one, 10s - 1ns));
  std::thread video([&] { inputs.frame_came(1s, 0s, silent); });
  ck_assert(inputs.wait_for_video(guard, one, 10s));
  video.join();
  std::thread end([&] { inputs.end_video(); });
  ck_assert(!inputs.wait_for_video(guard, one, 30s));
  end.join();
}
END_TEST

// The frame of 30 s was on its way when a seek back to 1 s had reached the group.
START_TEST(a_frame_from_before_a_seek_takes_no_reading_from_those_behind_it) {
  for (const int seeks : {0, 1, 2}) {
    Inputs inputs;
    Group one(0, 1);
    inputs.add(one);
    for (int k = 0; k < seeks; ++k) inputs.begin_seek();
    one.append(1s, 1), one.append(3s, 0);
    ck_assert_int_eq(inputs.at(30s).sensors[0], 0);
    ck_assert_int_eq(inputs.at(2s).sensors[0], seeks > 0 ? 1 : kInvalid);
    if (seeks == 0) continue;
    inputs.end_seek();
    ck_assert_int_eq(inputs.at(30s).sensors[0], 0);
    ck_assert_int_eq(inputs.at(2s).sensors[0], seeks > 1 ? 1 : kInvalid);
  }
}
END_TEST

START_TEST(places_without_a_group_count_as_one_invalid_sensor) {
  Inputs inputs;
  Group one(1, 2), four(4, 1);
  inputs.add(four), inputs.add(one);
  one.append(0s, 1), four.append(0s, 0);
  const SensorSnapshot snapshot = inputs.at(1s);  // places 0, 1 (two sensors), 2, 3, 4
  const std::uint8_t expected[] = {kInvalid, 1, 1, kInvalid, kInvalid, 0};
  ck_assert(snapshot.count == 6 && !snapshot.geometry_known);
  for (int i = 0; i < 6; ++i) ck_assert_int_eq(snapshot.sensors[i], expected[i]);
  ck_assert_int_eq(inputs.places_besides(one), 4);
  ck_assert_int_eq(inputs.places_besides(four), 5);
  ck_assert_int_eq(*inputs.free_place({}), 0);
  ck_assert_int_eq(*inputs.free_place(2), 2);
  ck_assert(!inputs.free_place(4) && !inputs.free_place(16) && *inputs.free_place(15) == 15);
  inputs.drop(one);
  ck_assert_int_eq(*inputs.free_place(1), 1);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "sensor_inputs", {a_frame_waits_until_every_linked_group_covers_its_time,
                        a_group_that_stays_silent_is_given_up_until_it_speaks,
                        live_patience_begins_with_the_first_frame_and_spares_recordings,
                        a_flush_ends_the_wait_of_a_frame, a_recording_waits_for_the_video_ten_seconds_ahead,
                        a_frame_from_before_a_seek_takes_no_reading_from_those_behind_it,
                        places_without_a_group_count_as_one_invalid_sensor});
}
