// SPDX-License-Identifier: LGPL-2.1-or-later
// The sensor drivers: the contract that each of them keeps. The drivers of hardware are asked where there is some:
// CERBERUS_GPIO_CHIP names a chip with four free lines, CERBERUS_IIO_DEVICE a converter with voltage0 (tests/hardware
// sets them).
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>

#include "drivers/sensor/sensor.h"

#include "support/says.h"
#include "support/suite.h"
#include "support/temporary_file.h"

namespace {

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::kNever;
using cerberus::sensing::Presence;
using cerberus::tests::temporary_file;

Time monotonic() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

struct Backend {
  std::string driver;
  SensorSetup good, bad;
  std::string thing;  // that the error of `bad` names
};

std::vector<Backend> backends() {
  std::vector<Backend> all;
  SensorSetup good, bad;
  good.location = temporary_file("0,0,1,0\n1,1,1,0\n");
  bad.location = "/nowhere/pir.csv";
  all.push_back({"replay", good, bad, "/nowhere/pir.csv"});
  good = bad = {};
  good.script = "0,0,1,0; 1,1,1,0";
  bad.script = "open fail no such script";
  all.push_back({"scripted", good, bad, "no such script"});
  good.script = "0,0V,3.1V,0V; 1,3V,3V,0.2V";
  bad.script = "0,0V,3.1V,high";
  all.push_back({"scripted", good, bad, "\"high\" is no reading"});
  good = bad = {};
  good.command = "echo levels 0 1 0; exec cat";
  bad.device = "/nowhere/fifo";
  all.push_back({"external", good, bad, "/nowhere/fifo"});
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

// What the sensor begins with. A command is not as quick as a device.
SensorError begin(const Backend& backend, Sensor& sensor, std::vector<SensorEdge>& edges) {
  pollfd waiting{sensor.fd(), POLLIN, 0};
  if (backend.driver == "external") ck_assert_int_eq(poll(&waiting, 1, 20000), 1);
  return sensor.read(sensor.recorded() ? 0s : monotonic(), edges);
}

Time now_of(const Sensor& sensor) {
  return sensor.recorded() ? 0s : monotonic();
}

START_TEST(the_first_edges_tell_where_each_line_stands) {
  for (const Backend& backend : every_backend()) {
    auto sensor = opened(backend);
    const Time before = now_of(*sensor);
    std::vector<SensorEdge> edges;
    ck_assert(!begin(backend, *sensor, edges));
    ck_assert_int_eq(static_cast<int>(edges.size()), 3);
    for (int i = 0; i < 3; ++i) {
      ck_assert_int_eq(edges[i].sensor, i);
      ck_assert(std::isnan(edges[i].volts) != sensor->measures());
      ck_assert(edges[i].time >= before - 1s && edges[i].time <= now_of(*sensor));
    }
    edges.clear();
    ck_assert(!sensor->read(now_of(*sensor), edges));
    // A converter may have another sample already.
    ck_assert(edges.empty() || (sensor->measures() && !sensor->recorded()));
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
      ck_assert(!begin(backend, *sensor, edges));
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

START_TEST(only_what_is_in_memory_and_never_waits_opens_at_once) {
  SensorSetup setup;
  setup.script = "0,0,0,0; 1,1,0,0";
  for (const char* driver : {"evdev", "external", "gpio", "iio", "replay", "scripted"})
    ck_assert(make_sensor(driver)->opens_at_once(setup) == (driver == std::string("scripted")));
  for (const char* waits : {"open wait 7; 0,0,0,0", "0,0,0,0; wait 7 8"}) {
    setup.script = waits;
    ck_assert(!make_sensor("scripted")->opens_at_once(setup));
  }
}
END_TEST

START_TEST(every_driver_is_known_by_name) {
  ck_assert(sensor_drivers() == "evdev, external, gpio, iio, replay, scripted");
  ck_assert(!make_sensor("none such") && !is_device("none such"));
  for (const char* device : {"evdev", "external", "gpio", "iio"}) ck_assert(is_device(device));
  ck_assert(!is_device("replay") && !is_device("scripted"));
  for (const char* driver :
       {"evdev", "gpio", "iio"}) {  // on a machine without, or in a build without: a clear word
    if (std::getenv("CERBERUS_GPIO_CHIP")) continue;
    SensorSetup setup;
    setup.chip = setup.device = "attic";
    setup.lines = setup.channels = {"0", "1", "2"};
    setup.codes = {"key:0", "key:1", "key:2"};
    const SensorError error = make_sensor(driver)->open(setup);
    ck_assert(error.fault == SensorFault::not_found || error.fault == SensorFault::missing);
    ck_assert(says(error.text, error.fault == SensorFault::missing ? "build again" : "attic"));
  }
}
END_TEST

}  // namespace

int main() {
  const std::string recording =
      every_backend().front().good.location;  // made before the tests' own processes are
  const int status = cerberus::tests::run_suite(
      "sensors",
      {the_first_edges_tell_where_each_line_stands, a_driver_has_something_to_wait_for,
       closing_is_safe_at_any_time_and_opening_begins_anew,
       an_error_names_the_thing_and_leaves_the_driver_closed, places_have_names_and_leds_may_be_absent,
       only_what_is_in_memory_and_never_waits_opens_at_once, every_driver_is_known_by_name});
  unlink(recording.c_str());
  return status;
}
