// SPDX-License-Identifier: LGPL-2.1-or-later
// GPIO sensors on a chip that executes a script, also what no simulated one of the kernel's does: refuses a line
// without a reason, loses edges, goes away between two calls. (tests/hardware has the kernel's own, with libgpiod.)
#include "drivers/gpio/gpio_sensor.h"

#include <algorithm>
#include <cerrno>
#include <string>
#include <utility>
#include <vector>

#include "support/says.h"
#include "support/suite.h"

namespace {

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::Presence;

// The one chip. Errors are errno, 0: good.
struct Chip {
  int open_error = 0, input_error = 0, output_error = 0, read_error = 0, level_error = 0, set_error = 0;
  std::string user;  // of every line that another consumer holds
  std::vector<GpioEdge> edges;
  std::vector<bool> levels{false, false, false};
  std::vector<bool> lit;
  bool open = false, inputs = false, outputs = false;
};
Chip chip;

SensorSetup setup(bool leds = false) {
  SensorSetup setup;
  setup.chip = "/dev/chip";
  setup.lines = {"4", "5", "door"};
  if (leds) setup.red = {"7", "8", "9"};
  return setup;
}

}  // namespace

// The interface's third implementation, beside those of libgpiod 1.6 and 2.x.
namespace cerberus::drivers {

struct GpioLines::Handles {};
GpioLines::GpioLines() = default;
GpioLines::~GpioLines() {
  close();
}
int GpioLines::open(const std::string&) {
  close();
  chip.open = chip.open_error == 0;
  return chip.open_error;
}
void GpioLines::close() noexcept {
  chip.open = chip.inputs = chip.outputs = false;
}
std::string GpioLines::name() const {
  return "chip";
}
std::string GpioLines::label() const {
  return "fake";
}
unsigned GpioLines::count() const {
  return 12;
}
int GpioLines::find(const std::string& line) const {
  return line == "door" ? 6 : -1;
}
std::string GpioLines::user(unsigned) const {
  return chip.inputs ? "cerberus" : chip.user;
}
int GpioLines::request_inputs(std::span<const unsigned>, LineBias) {
  chip.inputs = true;  // libgpiod 1.6 takes line by line: some are taken when one is refused
  return chip.input_error;
}
int GpioLines::request_outputs(std::span<const unsigned> offsets, const std::vector<bool>&) {
  chip.outputs = true;
  chip.lit.assign(offsets.size(), false);
  return chip.output_error;
}
int GpioLines::fd() const {
  return -1;
}
int GpioLines::read(std::vector<GpioEdge>& edges) {
  edges.insert(edges.end(), chip.edges.begin(), chip.edges.end());
  chip.edges.clear();
  return chip.read_error;
}
int GpioLines::levels(std::vector<bool>& levels) {
  levels = chip.levels;
  return chip.level_error;
}
int GpioLines::set(const std::vector<bool>& levels) {
  if (chip.set_error == 0) chip.lit = levels;
  return chip.set_error;
}

}  // namespace cerberus::drivers

namespace {

// What was read at `now`: "sensor:level@ms ..."; an error's text instead.
std::string read(GpioSensor& sensor, Time now) {
  std::vector<SensorEdge> edges;
  if (const SensorError error = sensor.read(now, edges)) return error.text;
  std::string text;
  for (const SensorEdge& edge : edges)
    text += std::to_string(edge.sensor) + ":" + (edge.level ? "1" : "0") + "@" +
            std::to_string(edge.time / 1ms) + " ";
  return text;
}

void must_read(GpioSensor& sensor, Time now, const std::string& expected) {
  const std::string reported = read(sensor, now);
  ck_assert_msg(reported == expected, "\"%s\", not \"%s\"", reported.c_str(), expected.c_str());
}

void must_refuse(const SensorSetup& how, SensorFault fault, const std::string& words) {
  GpioSensor sensor;
  const SensorError error = sensor.open(how);
  ck_assert_msg(error.fault == fault, "fault %d: %s", static_cast<int>(error.fault), error.text.c_str());
  ck_assert(says(error.text, words));
  ck_assert(!chip.open && !chip.inputs && !chip.outputs);  // whatever it had got, it let go
}

}  // namespace

START_TEST(the_reason_why_a_chip_does_not_open_is_reported) {
  chip.open_error = EACCES;
  must_refuse(setup(), SensorFault::denied,
              "No permission to use GPIO chip /dev/chip: on Debian add the user");
  chip.open_error = EPERM;
  must_refuse(setup(), SensorFault::denied, "No permission");
  chip.open_error = ENODEV;
  must_refuse(setup(), SensorFault::not_found, "no GPIO chip \"/dev/chip\"");
  chip.open_error = ENOTTY;
  must_refuse(setup(), SensorFault::not_found, "/dev/chip cannot be used as a GPIO chip");
}
END_TEST

START_TEST(the_reason_why_a_chip_refuses_its_lines_is_reported) {
  for (const bool leds : {false, true}) {
    int& error = leds ? chip.output_error : chip.input_error;
    const std::string lines = leds ? "lines 7, 8, 9 of" : "lines 4, 5, 6 of";
    for (const int denied : {EACCES, EPERM}) {
      error = denied;
      must_refuse(setup(leds), SensorFault::denied, "No permission to use " + lines + " GPIO chip /dev/chip");
    }
    error = EBUSY;
    must_refuse(setup(leds), SensorFault::busy, "L" + lines.substr(1) + " GPIO chip /dev/chip are not free");
    chip.user = "kettle";
    must_refuse(setup(leds), SensorFault::busy,
                std::string(leds ? "Line 7" : "Line 4") + " of GPIO chip /dev/chip is in use by \"kettle\"");
    chip.user = "";
    error = EINVAL;
    must_refuse(setup(leds), SensorFault::gone, "does not give " + lines.substr(0, lines.size() - 3));
    error = 0;
  }
  chip.level_error = EIO;  // it gave them, and was gone
  must_refuse(setup(true), SensorFault::gone, "/dev/chip does not answer any more");
}
END_TEST

START_TEST(edges_come_in_order_after_the_levels_of_the_beginning) {
  GpioSensor sensor;
  chip.levels = {true, false, false};
  ck_assert(!sensor.open(setup()));
  // As libgpiod 1.6 reports them: line by line. They happened before the first reading.
  chip.edges = {{20ms, 0, false}, {40ms, 0, true}, {30ms, 2, true}};
  chip.levels = {true, false, true};
  must_read(sensor, 50ms, "0:1@20 1:0@20 2:0@20 0:0@20 2:1@30 0:1@40 ");
  must_read(sensor, 60ms, "");
}
END_TEST

START_TEST(an_edge_that_was_lost_does_not_leave_a_sensor_wrong) {
  GpioSensor sensor;
  ck_assert(!sensor.open(setup()));
  read(sensor, 0ms);
  chip.levels = {false, true, false};  // and no edge
  must_read(sensor, 70ms, "1:1@70 ");
  must_read(sensor, 80ms, "");
  chip.edges = {{90ms, 2, true}};
  chip.levels = {false, true, true};
  must_read(sensor, 100ms, "2:1@90 ");
}
END_TEST

START_TEST(a_chip_that_goes_away_is_named_whatever_was_asked_of_it) {
  for (int* error : {&chip.read_error, &chip.level_error}) {
    GpioSensor sensor;
    ck_assert(!sensor.open(setup()));
    must_read(sensor, 0ms, "0:0@0 1:0@0 2:0@0 ");
    *error = ENODEV;
    ck_assert(says(read(sensor, 10ms), "GPIO chip /dev/chip does not answer any more (No such device)"));
    *error = 0;
  }
  GpioSensor sensor;
  ck_assert(!sensor.open(setup(true)));
  chip.set_error = ENODEV;
  const Presence readings[] = {Presence::detected, Presence::none, Presence::invalid};
  const SensorError error = sensor.show(readings);
  ck_assert(error.fault == SensorFault::gone && says(error.text, "/dev/chip"));
  sensor.stop();  // the error is ignored
}
END_TEST

START_TEST(leds_go_out_when_it_stops_and_when_it_closes) {
  const Presence readings[] = {Presence::detected, Presence::none, Presence::detected};
  for (const bool stops : {true, false}) {
    GpioSensor sensor;
    ck_assert(!sensor.open(setup(true)));
    ck_assert(!sensor.show(readings));
    ck_assert(chip.lit == std::vector<bool>({true, false, true}));
    stops ? sensor.stop() : sensor.close();
    ck_assert(chip.lit == std::vector<bool>({false, false, false}));
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite("gpio_sensor", {the_reason_why_a_chip_does_not_open_is_reported,
                                                    the_reason_why_a_chip_refuses_its_lines_is_reported,
                                                    edges_come_in_order_after_the_levels_of_the_beginning,
                                                    an_edge_that_was_lost_does_not_leave_a_sensor_wrong,
                                                    a_chip_that_goes_away_is_named_whatever_was_asked_of_it,
                                                    leds_go_out_when_it_stops_and_when_it_closes});
}
