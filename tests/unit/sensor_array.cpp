// SPDX-License-Identifier: LGPL-2.1-or-later
// All sensors of a driver together: which reading is reported when.
#include "drivers/sensor/sensor_array.h"

#include <poll.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "support/pipe.h"
#include "support/says.h"
#include "support/suite.h"
#include "support/text.h"

namespace {

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::PirFault;
using cerberus::sensing::PirOptions;
using cerberus::sensing::Presence;
using cerberus::tests::assert_text;
using cerberus::tests::Pipe;

// Every pulse counts, with the time of its edge.
constexpr PirOptions kAtOnce{.min_pulse = 0s};

struct Reported {
  Time time;
  std::string readings;
  bool changed;
};

// All until the end, by nothing but due(). Readings as digits, "!" behind one whose fault changed.
std::vector<Reported> rest(SensorArray& array) {
  std::vector<Reported> reported;
  for (int step = 0; step < 10000; ++step) {
    SensorReading reading;
    switch (array.next(array.due(), reading)) {
      case SensorArray::Step::reading: {
        std::string text;
        for (int i = 0; i < array.count(); ++i) {
          text += static_cast<char>('0' + static_cast<int>(reading.presence[static_cast<std::size_t>(i)]));
          if (reading.faulty >> i & 1) text += '!';
        }
        reported.push_back({reading.time, text, reading.changed});
        break;
      }
      case SensorArray::Step::wait:
        break;
      case SensorArray::Step::ended:
      case SensorArray::Step::failed:
        return reported;
    }
  }
  ck_abort_msg("it does not end");
}

// Plays a script to its end.
std::vector<Reported> play(SensorArray& array, const std::string& script, const PirOptions& options,
                           Time heartbeat = 10s, int sensors = 3) {
  SensorSetup setup;
  setup.sensors = sensors;
  setup.script = script;
  const SensorError error = array.open(make_sensor("scripted"), setup, options, heartbeat);
  if (error) ck_abort_msg("%s", error.text.c_str());
  return rest(array);
}

void must_be(const std::vector<Reported>& reported, const std::vector<Reported>& expected) {
  for (std::size_t i = 0; i < std::max(reported.size(), expected.size()); ++i) {
    const Reported none{-1s, "nothing", false};
    const Reported &is = i < reported.size() ? reported[i] : none,
                   &should = i < expected.size() ? expected[i] : none;
    if (is.time != should.time || is.readings != should.readings || is.changed != should.changed)
      ck_abort_msg("%zu: %s at %g s, not %s at %g s", i, is.readings.c_str(),
                   static_cast<double>(is.time.count()) / 1e9, should.readings.c_str(),
                   static_cast<double>(should.time.count()) / 1e9);
  }
}

START_TEST(a_reading_at_the_start_at_every_change_and_every_heartbeat) {
  SensorArray array;
  must_be(
      play(array, "0,0,0,0; 0.25,1,0,0; 0.4,1,1,1; 0.45,0,1,1", kAtOnce, 100ms),
      {{0ms, "000", true},
       {100ms, "000", false},
       {200ms, "000", false},
       {250ms, "100", true},
       {300ms, "100", false},
       {400ms, "111", true},    // a change at a heartbeat is one reading
       {470ms, "011", true}});  // the fall counts after 20 ms of quiet, and the recording goes on until then
}
END_TEST

START_TEST(nothing_is_known_before_a_recordings_first_line) {
  SensorArray array;
  must_be(play(array, "1,0,1,0", kAtOnce), {{0ms, "222", true}, {1s, "010", true}});
  must_be(play(array, "", {}), {{0ms, "222", true}});
}
END_TEST

START_TEST(an_invalid_reading_of_a_recording_lasts_until_the_next_one) {
  SensorArray array;
  must_be(play(array, "0,0,1,2; 1,2,2,2; 2,2,1,1; 3,1,0,2; 4,0,0,0",
               {.min_pulse = 0s, .hold = 10s, .warm_up = 500ms}, 100s),
          {{0s, "222", true},
           {500ms, "012", true},
           {1s, "222", true},
           {2s, "211", true},  // whatever the reading before
           {3s, "112", true},
           {4s, "110", true}});  // the hold of those that go on
  // Low during a detection, and no earlier edge is waited for.
  must_be(play(array, "0,0; 1,2; 2,1; 3,2; 4,0", {.active_low = true, .min_pulse = 0s}, 100s, 1),
          {{0s, "1", true}, {1s, "2", true}, {2s, "0", true}, {3s, "2", true}, {4s, "1", true}});
}
END_TEST

START_TEST(a_recording_goes_on_wherever_it_is_asked_to) {
  SensorArray array;
  const std::string script = "0,0,0; 1,1,0; 1.5,1,2; 2.5,0,1; 4,0,0";
  const std::vector<Reported> whole = play(array, script, {.min_pulse = 0s, .hold = 2s}, 100s, 2);
  must_be(whole,
          {{0s, "00", true}, {1s, "10", true}, {1500ms, "12", true}, {2500ms, "11", true}, {3s, "01", true}});
  array.seek(2s);
  must_be(rest(array), {{2s, "12", true}, {2500ms, "11", true}, {3s, "01", true}});
  array.seek(2999ms);  // the hold of before
  must_be(rest(array), {{2999ms, "11", true}, {3s, "01", true}});
  array.seek(0s);
  must_be(rest(array), whole);
  array.seek(10s);  // the last word
  must_be(rest(array), {{10s, "00", true}});
}
END_TEST

// It is between two reads, or in one, when it is let go.
START_TEST(a_driver_that_blocks_blocks_no_caller_and_its_readings_are_received_later) {
  for (const bool late : {false, true}) {
    Pipe gate, bell;
    SensorArray array;
    SensorSetup setup;
    setup.script = "0,0,1,0; 1,1,0,0; wait " + gate.reader() + " " + bell.writer();
    ck_assert(!array.open(make_sensor("scripted"), setup, {.min_pulse = 0s, .debounce = 0s}, 1h));
    ck_assert(array.fd() >= 0 && !array.recorded());
    ck_assert(array.place(2) == "reading 3 of script");
    bell.read();  // it blocks
    const auto now = [] { return Time(std::chrono::steady_clock::now().time_since_epoch()); };
    const Time begin = now();
    SensorReading reading;
    ck_assert(array.next(begin, reading) == SensorArray::Step::reading);
    ck_assert(reading.presence[0] == Presence::none && reading.presence[1] == Presence::detected);
    ck_assert(array.next(begin, reading) == SensorArray::Step::wait);
    if (late) {
      array.close();  // while it blocks
      ck_assert_int_eq(array.fd(), -1);
      continue;
    }
    gate.close_writer();
    pollfd news{array.fd(), POLLIN, 0};
    ck_assert_int_eq(poll(&news, 1, 60000), 1);
    ck_assert(array.next(now(), reading) == SensorArray::Step::reading);
    ck_assert(reading.presence[0] == Presence::detected && reading.presence[1] == Presence::none);
  }
}
END_TEST

// Notes the thread that opens it.
class NotingSensor final : public Sensor {
 public:
  NotingSensor(bool at_once, std::thread::id& opener) : at_once_(at_once), opener_(opener) {}
  SensorError open(const SensorSetup&) override {
    opener_ = std::this_thread::get_id();
    return {};
  }
  bool opens_at_once(const SensorSetup&) const override { return at_once_; }
  void close() noexcept override {}
  void stop() noexcept override {}
  SensorError read(Time, std::vector<SensorEdge>&) override { return {}; }
  std::string place(int) const override { return "nowhere"; }
  bool recorded() const override { return true; }

 private:
  bool at_once_;
  std::thread::id& opener_;
};

START_TEST(a_sensor_that_may_block_is_not_opened_on_the_caller_s_thread) {
  for (const bool at_once : {true, false}) {
    std::thread::id opener;
    SensorArray array;
    ck_assert(!array.open(std::make_unique<NotingSensor>(at_once, opener), {}, {}, 10s));
    ck_assert(array.opened());
    ck_assert((opener == std::this_thread::get_id()) == at_once);
  }
}
END_TEST

START_TEST(a_stuck_sensor_is_reported_once_and_once_more_when_it_works_again) {
  SensorArray array;
  must_be(play(array, "0,0; 1,1; 700,0; 800,0", kAtOnce, 1000s, 1),
          {{0ms, "0", true}, {1s, "1", true}, {601s, "2!", true}, {700s + 20ms, "0!", true}});
  ck_assert(array.fault(0) == PirFault::none);
}
END_TEST

START_TEST(a_driver_that_fails_ends_it_with_its_own_words) {
  SensorArray array;
  must_be(play(array, "0,0,0,0; 1 fail the dog ate the cable", {}), {{0ms, "000", true}, {1s, "222", true}});
  ck_assert(says(array.error().text, "the dog ate the cable"));
  SensorReading reading;
  ck_assert(array.next(2s, reading) == SensorArray::Step::failed);  // and stays so
  must_be(play(array, "0,0,0,0; show fail no LED", {}), {{0ms, "222", true}});
  ck_assert(says(array.error().text, "no LED"));
}
END_TEST

namespace {

// A live sensor of one line: "TIME:LEVEL ..." in seconds, "-" where nothing is known.
class Live final : public Sensor {
 public:
  explicit Live(std::vector<SensorEdge> edges) : edges_(std::move(edges)) {}
  SensorError open(const SensorSetup&) override { return {}; }
  bool opens_at_once(const SensorSetup&) const override { return true; }
  void close() noexcept override {}
  void stop() noexcept override {}
  SensorError read(Time now, std::vector<SensorEdge>& edges) override {
    for (; given_ < edges_.size() && edges_[given_].time <= now; ++given_) edges.push_back(edges_[given_]);
    return {};
  }
  std::string place(int) const override { return "nowhere"; }

 private:
  std::vector<SensorEdge> edges_;
  std::size_t given_ = 0;
};

// The reading of one sensor at these times; warm-up 60 s.
std::string presence_at(std::vector<SensorEdge> edges, const std::vector<Time>& times) {
  SensorArray array;
  SensorSetup setup;
  setup.sensors = 1;
  ck_assert(!array.open(std::make_unique<Live>(std::move(edges)), setup, {.warm_up = 60s}, 1h));
  std::string found;
  SensorReading last;
  for (Time now = 0s; const Time time : times) {
    for (; now <= time; now += 500ms)
      for (SensorReading reading; array.next(now, reading) == SensorArray::Step::reading;) last = reading;
    found += static_cast<char>('0' + static_cast<int>(last.presence[0]));
  }
  return found;
}

}  // namespace

START_TEST(a_level_that_is_unknown_for_a_while_ends_no_warm_up) {
  const auto unknown = [](Time time, bool restarts = false) {
    return SensorEdge{.time = time, .known = false, .restarts = restarts};
  };
  const auto high = [](Time time) { return SensorEdge{.time = time, .level = true}; };
  // The warm-up goes on through the gap, from 0 to 60 s.
  assert_text(presence_at({high(0s), unknown(10s), high(12s)}, {5s, 11s, 13s, 59s, 61s}), "22221");
  // The first level comes late: the module may have got its supply just then.
  assert_text(presence_at({unknown(0s), unknown(1s), high(10s)}, {5s, 11s, 69s, 71s}), "2221");
  // Of a sensor that is warm, or that restarts.
  assert_text(presence_at({high(0s), unknown(70s), high(72s)}, {65s, 71s, 73s}), "121");
  assert_text(presence_at({high(0s), unknown(70s, true), high(72s)}, {65s, 73s, 131s, 133s}), "1221");
}
END_TEST

START_TEST(edges_before_the_first_reading_are_not_reported_and_missed_heartbeats_are_not_repeated) {
  SensorArray array;
  SensorSetup setup;
  setup.script = "0,0,0,0; 1,1,0,0; 2,0,1,0; 60,0,0,0";
  ck_assert(!array.open(make_sensor("scripted"), setup, kAtOnce, 100ms));
  SensorReading reading;
  ck_assert(array.next(1500ms, reading) == SensorArray::Step::reading);
  ck_assert(reading.time == 1500ms && reading.presence[0] == Presence::detected);
  ck_assert(array.next(1500ms, reading) == SensorArray::Step::wait && array.due() == 1600ms);
  ck_assert(array.next(30s, reading) == SensorArray::Step::reading && reading.time == 1600ms);
  ck_assert(array.next(30s, reading) == SensorArray::Step::reading && reading.time == 2s && reading.changed);
  ck_assert(array.next(30s, reading) == SensorArray::Step::reading && reading.time == 2020ms &&
            reading.changed);
  ck_assert(array.next(30s, reading) == SensorArray::Step::wait && array.due() == 30s + 100ms);
}
END_TEST

START_TEST(a_turning_base_makes_detections_doubtful) {
  SensorArray array;
  SensorSetup setup;
  setup.script = "0,0,0,0; 1,0,0,1; 60,0,0,1";
  ck_assert(!array.open(make_sensor("scripted"), setup, kAtOnce, 100s));
  SensorReading reading;
  ck_assert(array.next(0s, reading) == SensorArray::Step::reading && reading.doubtful == 0);
  const cerberus::sensing::Geometry around;
  array.base(500ms, around, {.yaw_rate = cerberus::sensing::radians(20)});
  ck_assert(array.next(1s, reading) == SensorArray::Step::reading && reading.doubtful == 0b100);
  array.base(1s, around, {.yaw_rate = 0});
  ck_assert(array.next(10s, reading) == SensorArray::Step::reading);
  ck_assert(reading.changed && reading.time == 4s &&
            reading.doubtful == 0);  // modules hold their output for a while
}
END_TEST

START_TEST(every_sample_is_a_reading_where_that_is_asked_for) {
  SensorArray array;
  SensorSetup setup;
  setup.script = "0.5,0V,0V,0V; 1,0.1V,3V,0V; 1.25,0.1V,3V,0V; 2,0V,0V,0V";
  for (const bool all : {false, true}) {
    ck_assert(!array.open(make_sensor("scripted"), setup, kAtOnce, 1500ms));
    ck_assert(array.measures());
    if (all) array.report_samples(true);
    std::vector<Time> times;
    std::vector<float> second;
    for (SensorReading reading;;) {
      const auto step = array.next(array.due(), reading);
      if (step == SensorArray::Step::ended) break;
      if (step != SensorArray::Step::reading) continue;
      times.push_back(reading.time);
      second.push_back(reading.volts[1]);
    }
    // The start, when nothing is known; the first sample; a detection; ...; a heartbeat; ...; the fall's debounced end.
    const std::vector<Time> expected = all ? std::vector<Time>{0ms, 500ms, 1s, 1250ms, 1500ms, 2s, 2020ms}
                                           : std::vector<Time>{0ms, 500ms, 1s, 1500ms, 2020ms};
    ck_assert(times == expected);
    ck_assert(std::isnan(second[0]) && second[1] == 0 && second[2] == 3 && second.back() == 0);
  }
  setup.script = "0,0,0,0";
  ck_assert(!array.open(make_sensor("scripted"), setup, kAtOnce, 1s) && !array.measures());
}
END_TEST

// A recording of volts whose second sensor is lost after a second.
class LosesOne final : public Sensor {
 public:
  SensorError open(const SensorSetup&) override { return {}; }
  bool opens_at_once(const SensorSetup&) const override { return true; }
  void close() noexcept override {}
  void stop() noexcept override {}
  SensorError read(Time now, std::vector<SensorEdge>& edges) override {
    for (; next() <= now; ++given_)
      for (int i = 0; i < 3; ++i) {
        SensorEdge edge{next(), i, i == 1, i == 1 ? 3.0f : 0.0f};
        if (given_ == 1 && i == 1) edge = {next(), i, false, std::nanf(""), false};
        edges.push_back(edge);
      }
    return {};
  }
  std::string place(int) const override { return "nowhere"; }
  bool measures() const override { return true; }
  bool recorded() const override { return true; }
  Time next() const override {
    return given_ == 0 ? 500ms : given_ == 1 ? Time(1s) : cerberus::sensing::kNever;
  }
  Time end() const override { return 3s; }

 private:
  int given_ = 0;
};

// Volts that are not known any more are not those of before, at heartbeats neither.
START_TEST(unknown_volts_are_not_the_last_ones) {
  SensorArray array;
  ck_assert(!array.open(std::make_unique<LosesOne>(), {}, {}, 700ms));
  float before = 0, last = 0;
  for (SensorReading reading;;) {
    const auto step = array.next(array.due(), reading);
    if (step == SensorArray::Step::ended) break;
    if (step != SensorArray::Step::reading) continue;
    (reading.time < 1s ? before : last) = reading.volts[1];
  }
  ck_assert(before == 3 && std::isnan(last));
}
END_TEST

}  // namespace

int main() {
  return cerberus::tests::run_suite(
      "sensor_array",
      {a_reading_at_the_start_at_every_change_and_every_heartbeat,
       nothing_is_known_before_a_recordings_first_line,
       an_invalid_reading_of_a_recording_lasts_until_the_next_one,
       a_recording_goes_on_wherever_it_is_asked_to,
       a_driver_that_blocks_blocks_no_caller_and_its_readings_are_received_later,
       a_sensor_that_may_block_is_not_opened_on_the_caller_s_thread,
       a_stuck_sensor_is_reported_once_and_once_more_when_it_works_again,
       a_driver_that_fails_ends_it_with_its_own_words, a_level_that_is_unknown_for_a_while_ends_no_warm_up,
       edges_before_the_first_reading_are_not_reported_and_missed_heartbeats_are_not_repeated,
       a_turning_base_makes_detections_doubtful, unknown_volts_are_not_the_last_ones,
       every_sample_is_a_reading_where_that_is_asked_for});
}
