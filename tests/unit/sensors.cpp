// SPDX-License-Identifier: LGPL-2.1-or-later
// The sensor drivers: the contract that each of them keeps, and what is particular to the recorded ones. The drivers of
// hardware are asked where there is some: CERBERUS_GPIO_CHIP names a chip with four free lines, CERBERUS_IIO_DEVICE a
// converter with voltage0 (tests/hardware sets them).
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "drivers/recording.h"
#include "drivers/sensor.h"
#include "drivers/sensor_array.h"

// after all else: its macro fail() is no word that C++ streams can bear
#include <check.h>

namespace {

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::kNever;
using cerberus::sensing::PirFault;
using cerberus::sensing::PirOptions;
using cerberus::sensing::Presence;

Time monotonic() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

bool says(const std::string& text, const std::string& what) {
  if (text.find(what) != text.npos) return true;
  std::fprintf(stderr, "\"%s\" does not say \"%s\"\n", text.c_str(), what.c_str());
  return false;
}

// ---- the contract

struct Backend {
  std::string driver;
  SensorSetup good, bad;
  std::string thing;  // that the error of `bad` names
};

std::string file(const std::string& text) {
  char path[] = "/tmp/cerberus-pir-XXXXXX";
  const int fd = mkstemp(path);
  if (write(fd, text.data(), text.size()) != static_cast<ssize_t>(text.size())) std::abort();
  close(fd);
  return path;
}

std::vector<Backend> backends() {
  std::vector<Backend> all;
  SensorSetup good, bad;
  good.location = file("0,0,1,0\n1,1,1,0\n");
  bad.location = "/nowhere/pir.csv";
  all.push_back({"replay", good, bad, "/nowhere/pir.csv"});
  good = bad = {};
  good.script = "0,0,1,0; 1,1,1,0";
  bad.script = "open fail no such script";
  all.push_back({"scripted", good, bad, "no such script"});
  if (const char* chip = std::getenv("CERBERUS_GPIO_CHIP")) {
    good = bad = {};
    good.chip = bad.chip = chip;
    good.lines = {"0", "1", "2"};
    good.red = {"3", "4", "5"};
    bad.lines = {"0", "1", "77"};
    all.push_back({"gpio", good, bad, "line 77"});
  }
  if (const char* device = std::getenv("CERBERUS_IIO_DEVICE")) {
    good = bad = {};
    good.device = bad.device = device;
    good.channels = {"0", "0", "0"};
    bad.channels = {"0", "0", "9"};
    all.push_back({"iio", good, bad, "voltage9"});
  }
  return all;
}

const std::vector<Backend>& every_backend() {
  static const std::vector<Backend> all = backends();
  return all;
}

std::unique_ptr<Sensor> opened(const Backend& backend) {
  auto sensor = make_sensor(backend.driver);
  const SensorError error = sensor->open(backend.good);
  if (error) ck_abort_msg("%s: %s", backend.driver.c_str(), error.text.c_str());
  return sensor;
}

Time now_of(const Sensor& sensor) {
  return sensor.recorded() ? 0s : monotonic();
}

START_TEST(the_first_edges_tell_where_each_line_stands) {
  for (const Backend& backend : every_backend()) {
    auto sensor = opened(backend);
    const Time before = now_of(*sensor);
    std::vector<SensorEdge> edges;
    ck_assert(!sensor->read(now_of(*sensor), edges));
    ck_assert_int_eq(static_cast<int>(edges.size()), 3);
    for (int i = 0; i < 3; ++i) {
      ck_assert_int_eq(edges[i].sensor, i);
      ck_assert(edges[i].time >= before - 1s && edges[i].time <= now_of(*sensor));
    }
    edges.clear();
    ck_assert(!sensor->read(now_of(*sensor), edges));
    ck_assert(edges.empty());
  }
}
END_TEST

START_TEST(a_driver_has_something_to_wait_for) {
  for (const Backend& backend : every_backend()) {
    auto sensor = opened(backend);
    ck_assert(sensor->recorded() != is_device(backend.driver));
    ck_assert(sensor->recorded() == (sensor->fd() < 0));
    ck_assert(sensor->recorded() == (sensor->next() != kNever));
    ck_assert(sensor->recorded() == (sensor->end() != kNever));
    std::vector<SensorEdge> edges;
    ck_assert(!sensor->read(now_of(*sensor), edges));
    if (sensor->fd() < 0) continue;
    pollfd waiting{sensor->fd(), POLLIN, 0};
    ck_assert(poll(&waiting, 1, 0) >= 0);
    ck_assert_int_eq(waiting.revents & (POLLERR | POLLHUP | POLLNVAL), 0);
  }
}
END_TEST

START_TEST(closing_is_safe_at_any_time_and_opening_begins_anew) {
  for (const Backend& backend : every_backend()) {
    auto sensor = make_sensor(backend.driver);
    std::vector<SensorEdge> edges;
    sensor->close();
    sensor->stop();
    ck_assert_int_eq(sensor->fd(), -1);
    sensor->read(0s, edges);
    ck_assert(edges.empty());
    for (int round = 0; round < 3; ++round) {
      const SensorError error = sensor->open(backend.good);
      if (error) ck_abort_msg("%s: %s", backend.driver.c_str(), error.text.c_str());
      edges.clear();
      ck_assert(!sensor->read(now_of(*sensor), edges));
      ck_assert_int_eq(static_cast<int>(edges.size()), 3);
      sensor->stop();
      sensor->stop();
      if (round == 1) continue;  // opened again without having been closed
      sensor->close();
      sensor->close();
      ck_assert_int_eq(sensor->fd(), -1);
    }
  }
}
END_TEST

START_TEST(an_error_names_the_thing_and_leaves_the_driver_closed) {
  for (const Backend& backend : every_backend()) {
    auto sensor = make_sensor(backend.driver);
    const SensorError error = sensor->open(backend.bad);
    ck_assert(error);
    ck_assert(says(error.text, backend.thing));
    ck_assert_int_eq(sensor->fd(), -1);
    std::vector<SensorEdge> edges;
    sensor->read(0s, edges);
    ck_assert(edges.empty());
    ck_assert(!sensor->open(backend.good));  // nothing was left behind
  }
}
END_TEST

START_TEST(places_have_names_and_leds_may_be_absent) {
  for (const Backend& backend : every_backend()) {
    auto sensor = opened(backend);
    ck_assert(!sensor->place(0).empty());
    ck_assert(!sensor->place(-1).empty());
    ck_assert(!sensor->place(16).empty());
    const Presence readings[] = {Presence::none, Presence::detected, Presence::invalid};
    ck_assert(!sensor->show(readings));
  }
}
END_TEST

START_TEST(every_driver_is_known_by_name) {
  ck_assert(sensor_drivers() == "gpio, iio, replay, scripted");
  ck_assert(!make_sensor("none such") && !is_device("none such"));
  ck_assert(is_device("gpio") && is_device("iio") && !is_device("replay") && !is_device("scripted"));
  for (const char* driver : {"gpio", "iio"}) {  // on a machine without, or in a build without: a clear word
    if (std::getenv("CERBERUS_GPIO_CHIP")) continue;
    SensorSetup setup;
    setup.chip = setup.device = "attic";
    setup.lines = setup.channels = {"0", "1", "2"};
    const SensorError error = make_sensor(driver)->open(setup);
    ck_assert(error.fault == SensorFault::not_found || error.fault == SensorFault::missing);
    ck_assert(says(error.text, error.fault == SensorFault::missing ? "build again" : "attic"));
  }
}
END_TEST

// ---- recordings

SensorError parse(const std::string& text, Recording& recording, int sensors = 3) {
  return parse_recording(text, "night.csv", sensors, recording);
}

START_TEST(comma_separated_values_and_json_lines_say_the_same) {
  Recording csv, json, pts;
  ck_assert(!parse("# last night\ntime,infer1,infer2,infer3\r\n\n0,0,0,0\r\n 1.5 , 1, 0 ,0\n2e0,1,2,1", csv));
  ck_assert(
      !parse("{\"time\":0,\"pir\":[0,0,0]}\n{\"time\":1.5,\"pir\":[1,0,0],\"what\":{\"a\":[\"}\"]}}\n"
             "{\"time\":2,\"pir\":[1,2,1]}\n",
             json));
  ck_assert(
      !parse("{\"pts\":0,\"pir\":[0,0,0]}\n{\"pts\":1500000000,\"pir\":[1,0,0]}\n{\"pts\":2000000000,\"pir\":"
             "[1,2,1]}\n",
             pts));
  for (const Recording& recording : {csv, json, pts}) {
    ck_assert(recording.end == 2s);
    ck_assert_int_eq(static_cast<int>(recording.edges.size()), 8);  // 2 = the line stays as it was
    ck_assert(recording.edges[3].time == 1500ms && recording.edges[3].sensor == 0 &&
              recording.edges[3].level);
    ck_assert(recording.edges[7].time == 2s && recording.edges[7].sensor == 2 && recording.edges[7].level);
  }
}
END_TEST

START_TEST(what_is_wrong_with_a_recording_is_told_with_file_and_line) {
  const struct {
    const char *text, *why;
    std::size_t edges;  // of what went before
  } cases[] = {
      {"0,0,0,0\n1,1,0",
       "night.csv, line 2: it has 2 readings, and there are 3 sensors; the file seems to be cut off here.",
       3},
      {"0,0,0,0\n1,1,0\n2,0,0,0\n", "night.csv, line 2: it has 2 readings, and there are 3 sensors.", 3},
      {"0,0,0,0,0\n", "line 1: it has 4 readings", 0},
      {"0,0,0,0\n\n# x\n2,1,0,0\n1.9,0,0,0\n",
       "night.csv, line 5: its time is before that of the line above.", 6},
      {"0,0,0,3\n", "\"3\" is no reading", 0},
      {"0,0,0,\n", "\"\" is no reading", 0},
      {"0,0,0,yes\n", "\"yes\" is no reading", 0},
      {"-1,0,0,0\n", "\"-1\" is no time", 0},
      {"nan,0,0,0\n", "\"nan\" is no time", 0},
      {"1e300,0,0,0\n", "is no time", 0},
      {"1;5,0,0,0\n", "is no time", 0},
      {"0,0,0,0\ntime,a,b,c\n", "line 2: \"time\" is no time", 3},
      {"{\"time\":0,\"pir\":[0,0,0]}\n{\"time\":1,\"pir\":[0,",
       "line 2: it is no complete JSON object; the file seems to be cut off here.", 3},
      {"{\"time\":0,\"pir\":[0,0,0]}\n{\"pir\":[0,0,0]}\n", "line 2: it has neither \"time\"", 3},
      {"{\"time\":\"0\",\"pir\":[0,0,0]}\n", "neither \"time\"", 0},
      {"{\"pts\":null,\"pir\":[0,0,0]}\n", "neither \"time\"", 0},
      {"{\"pts\":-5,\"pir\":[0,0,0]}\n", "neither \"time\"", 0},
      {"{\"time\":1}\n", "no \"pir\"", 0},
      {"{\"time\":1,\"pir\":[true,0,0]}\n", "\"true\" is no reading", 0},
      {"{\"time\":1,\"pir\":[0,0,0.5]}\n", "\"0.5\" is no reading", 0},
      {"\x01\xff\xfe\n", "is no time", 0},
  };
  for (const auto& one : cases) {
    Recording recording;
    const SensorError error = parse(one.text, recording);
    ck_assert(error.fault == SensorFault::data);
    ck_assert(says(error.text, one.why));
    ck_assert_int_eq(static_cast<int>(recording.edges.size()), static_cast<int>(one.edges));
  }
}
END_TEST

START_TEST(files_that_cannot_be_recordings_are_refused_at_once) {
  SensorSetup setup;
  const auto why = [&](const std::string& location) {
    setup.location = location;
    return make_sensor("replay")->open(setup);
  };
  ck_assert(why("").fault == SensorFault::settings);
  ck_assert(why("/nowhere").fault == SensorFault::not_found);
  ck_assert(says(why("/dev/zero").text, "/dev/zero is no regular file"));
  ck_assert(says(why("/tmp").text, "/tmp is no regular file"));
  const std::string empty = file("# nothing\n");
  ck_assert(why(empty).fault == SensorFault::data && says(why(empty).text, empty + " holds no readings"));
  unlink(empty.c_str());
}
END_TEST

START_TEST(a_recording_is_played_when_its_time_has_come) {
  Backend backend{"scripted", {}, {}, ""};
  backend.good.script = "0.5,0,1,0; 2,1,1,0; 2,1,1,1; 3 fail the cable broke";
  auto sensor = opened(backend);
  std::vector<SensorEdge> edges;
  ck_assert(sensor->next() == 500ms && sensor->end() == 3s);
  ck_assert(!sensor->read(499ms, edges) && edges.empty());
  ck_assert(!sensor->read(500ms, edges) && edges.size() == 3);
  ck_assert(sensor->next() == 2s);
  ck_assert(!sensor->read(2999ms, edges) && edges.size() == 9);
  ck_assert(sensor->next() == 3s);
  ck_assert(says(sensor->read(3s, edges).text, "the cable broke"));
}
END_TEST

// ---- all sensors together

struct Told {
  Time time;
  std::string readings;
  bool changed;
};

// Plays a script to its end, by nothing but due(). Readings as digits, "!" behind one whose fault changed.
std::vector<Told> play(SensorArray& array, const std::string& script, const PirOptions& options,
                       Time heartbeat = 10s, int sensors = 3) {
  SensorSetup setup;
  setup.sensors = sensors;
  setup.script = script;
  const SensorError error = array.open(make_sensor("scripted"), setup, options, heartbeat);
  if (error) ck_abort_msg("%s", error.text.c_str());
  std::vector<Told> told;
  for (int step = 0; step < 10000; ++step) {
    SensorReading reading;
    switch (array.next(array.due(), reading)) {
      case SensorArray::Step::reading: {
        std::string text;
        for (int i = 0; i < array.count(); ++i) {
          text += static_cast<char>('0' + static_cast<int>(reading.presence[static_cast<std::size_t>(i)]));
          if (reading.faulty >> i & 1) text += '!';
        }
        told.push_back({reading.time, text, reading.changed});
        break;
      }
      case SensorArray::Step::wait:
        break;
      case SensorArray::Step::ended:
      case SensorArray::Step::failed:
        return told;
    }
  }
  ck_abort_msg("it does not end");
}

void must_be(const std::vector<Told>& told, const std::vector<Told>& expected) {
  for (std::size_t i = 0; i < std::max(told.size(), expected.size()); ++i) {
    const Told none{-1s, "nothing", false};
    const Told &is = i < told.size() ? told[i] : none, &should = i < expected.size() ? expected[i] : none;
    if (is.time != should.time || is.readings != should.readings || is.changed != should.changed)
      ck_abort_msg("%zu: %s at %g s, not %s at %g s", i, is.readings.c_str(),
                   static_cast<double>(is.time.count()) / 1e9, should.readings.c_str(),
                   static_cast<double>(should.time.count()) / 1e9);
  }
}

START_TEST(a_reading_at_the_start_at_every_change_and_every_heartbeat) {
  SensorArray array;
  must_be(
      play(array, "0,0,0,0; 0.25,1,0,0; 0.4,1,1,1; 0.45,0,1,1", {}, 100ms),
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
  must_be(play(array, "1,0,1,0", {}), {{0ms, "222", true}, {1s, "010", true}});
  must_be(play(array, "", {}), {{0ms, "222", true}});
}
END_TEST

START_TEST(a_sensor_that_is_stuck_is_told_once_and_once_more_when_it_is_well) {
  SensorArray array;
  must_be(play(array, "0,0; 1,1; 700,0; 800,0", {}, 1000s, 1),
          {{0ms, "0", true}, {1s, "1", true}, {601s, "2!", true}, {700s + 20ms, "0!", true}});
  ck_assert(array.fault(0) == PirFault::none);
}
END_TEST

START_TEST(a_driver_that_fails_ends_it_with_its_own_words) {
  SensorArray array;
  must_be(play(array, "0,0,0,0; 1 fail the dog ate the cable", {}), {{0ms, "000", true}});
  ck_assert(says(array.error().text, "the dog ate the cable"));
  SensorReading reading;
  ck_assert(array.next(2s, reading) == SensorArray::Step::failed);  // and stays so
  must_be(play(array, "0,0,0,0; show fail no LED", {}), {});
  ck_assert(says(array.error().text, "no LED"));
}
END_TEST

START_TEST(what_was_before_the_first_look_is_not_told_and_missed_heartbeats_are_not_made_up_for) {
  SensorArray array;
  SensorSetup setup;
  setup.script = "0,0,0,0; 1,1,0,0; 2,0,1,0; 60,0,0,0";
  ck_assert(!array.open(make_sensor("scripted"), setup, {}, 100ms));
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
  ck_assert(!array.open(make_sensor("scripted"), setup, {}, 100s));
  SensorReading reading;
  ck_assert(array.next(0s, reading) == SensorArray::Step::reading && reading.doubtful == 0);
  array.base(500ms, cerberus::sensing::radians(20));
  ck_assert(array.next(1s, reading) == SensorArray::Step::reading && reading.doubtful == 0b100);
  array.base(2s, 0);
  ck_assert(array.next(10s, reading) == SensorArray::Step::reading);
  ck_assert(reading.changed && reading.time == 5s &&
            reading.doubtful == 0);  // modules hold their output for a while
}
END_TEST

}  // namespace

int main() {
  Suite* suite = suite_create("sensors");
  TCase* tests = tcase_create("sensors");
  tcase_add_test(tests, the_first_edges_tell_where_each_line_stands);
  tcase_add_test(tests, a_driver_has_something_to_wait_for);
  tcase_add_test(tests, closing_is_safe_at_any_time_and_opening_begins_anew);
  tcase_add_test(tests, an_error_names_the_thing_and_leaves_the_driver_closed);
  tcase_add_test(tests, places_have_names_and_leds_may_be_absent);
  tcase_add_test(tests, every_driver_is_known_by_name);
  tcase_add_test(tests, comma_separated_values_and_json_lines_say_the_same);
  tcase_add_test(tests, what_is_wrong_with_a_recording_is_told_with_file_and_line);
  tcase_add_test(tests, files_that_cannot_be_recordings_are_refused_at_once);
  tcase_add_test(tests, a_recording_is_played_when_its_time_has_come);
  tcase_add_test(tests, a_reading_at_the_start_at_every_change_and_every_heartbeat);
  tcase_add_test(tests, nothing_is_known_before_a_recordings_first_line);
  tcase_add_test(tests, a_sensor_that_is_stuck_is_told_once_and_once_more_when_it_is_well);
  tcase_add_test(tests, a_driver_that_fails_ends_it_with_its_own_words);
  tcase_add_test(tests, what_was_before_the_first_look_is_not_told_and_missed_heartbeats_are_not_made_up_for);
  tcase_add_test(tests, a_turning_base_makes_detections_doubtful);
  suite_add_tcase(suite, tests);
  const std::string recording =
      every_backend().front().good.location;  // made before the tests' own processes are
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  unlink(recording.c_str());
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
