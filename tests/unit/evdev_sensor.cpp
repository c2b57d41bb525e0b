// SPDX-License-Identifier: LGPL-2.1-or-later
// Sensors on input devices that execute a script, also what uinput cannot do: drops events, or refuses to be read.
// (tests/hardware has the kernel's own.)
#include "drivers/evdev/evdev_sensor.h"

#include <linux/input-event-codes.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "drivers/evdev/input_codes.h"
#include "support/says.h"
#include "support/suite.h"

namespace {

using namespace cerberus::drivers;
using namespace std::chrono_literals;

constexpr InputCode kFirst{EV_KEY, BTN_0}, kSecond{EV_KEY, BTN_1}, kCover{EV_SW, SW_MACHINE_COVER};
constexpr InputCode kReport{EV_SYN, SYN_REPORT}, kDropped{EV_SYN, SYN_DROPPED};

// One input device; errors are errno, 0: good.
struct Receiver {
  std::string name = "PIR receiver";
  int open_error = 0, read_error = 0, level_error = 0;
  std::vector<InputCode> codes{kFirst, kSecond, kCover};
  std::vector<InputCode> on;  // what is pressed or switched on
  std::vector<InputEvent> events;
};
std::map<std::string, Receiver> receivers;  // by path
std::map<const InputDevice*, std::string> opened;

Receiver& of(const InputDevice* device) {
  return receivers.at(opened.at(device));
}

}  // namespace

// The interface's second implementation, beside that of the kernel's devices.
namespace cerberus::drivers {

int InputDevice::open(const std::string& path) {
  close();
  const auto found = receivers.find(path);
  if (found == receivers.end()) return ENOENT;
  if (found->second.open_error != 0) return found->second.open_error;
  opened[this] = path;
  fd_ = 1000;
  return 0;
}
void InputDevice::close() noexcept {
  opened.erase(this);
  fd_ = -1;
}
std::string InputDevice::name() const {
  return of(this).name;
}
std::vector<InputCode> InputDevice::codes() const {
  return of(this).codes;
}
int InputDevice::levels(const std::vector<InputCode>& codes, std::vector<bool>& levels) const {
  levels.clear();
  for (const InputCode& code : codes) levels.push_back(std::ranges::count(of(this).on, code) > 0);
  return of(this).level_error;
}
int InputDevice::read(std::vector<InputEvent>& events) {
  if (!receivers.contains(opened.at(this))) return ENODEV;
  Receiver& receiver = of(this);
  events.insert(events.end(), receiver.events.begin(), receiver.events.end());
  receiver.events.clear();
  return receiver.read_error;
}
std::vector<std::string> input_devices() {
  std::vector<std::string> paths;
  for (const auto& [path, receiver] : receivers) paths.push_back(path);
  return paths;
}

}  // namespace cerberus::drivers

namespace {

SensorSetup setup(const std::string& device = "/dev/input/event3") {
  SensorSetup setup;
  setup.device = device;
  setup.codes = {"BTN_0", "key:257", "SW_MACHINE_COVER"};
  return setup;
}

Receiver& plug(const std::string& path = "/dev/input/event3") {
  return receivers[path];
}

// Tests share a process where check does not fork.
void unplug_all() {
  receivers.clear();
}

std::string read(EvdevSensor& sensor, Time now) {
  std::vector<SensorEdge> edges;
  if (const SensorError error = sensor.read(now, edges)) return error.text;
  std::string text;
  for (const SensorEdge& edge : edges) {
    const char* level = edge.known ? edge.level ? "1" : "0" : edge.restarts ? "!" : "-";
    text.append(text.empty() ? "" : " ").append(std::to_string(edge.sensor)).append(":").append(level);
    text.append("@").append(std::to_string(edge.time / 1ms));
  }
  return text;
}

void must_read(EvdevSensor& sensor, Time now, const std::string& expected) {
  const std::string found = read(sensor, now);
  ck_assert_msg(found == expected, "\"%s\", not \"%s\"", found.c_str(), expected.c_str());
}

void must_refuse(const SensorSetup& how, SensorFault fault, const std::string& words) {
  EvdevSensor sensor;
  const SensorError error = sensor.open(how);
  ck_assert_msg(error.fault == fault, "%s", error.text.c_str());
  ck_assert(says(error.text, words));
  ck_assert_int_eq(sensor.fd(), -1);
}

START_TEST(it_begins_with_the_levels_and_goes_on_with_events_and_their_stamps) {
  unplug_all();
  Receiver& receiver = plug();
  receiver.on = {kSecond, kCover};
  EvdevSensor sensor;
  ck_assert(!sensor.open(setup()));
  must_read(sensor, 1s, "0:0@1000 1:1@1000 2:1@1000");
  receiver.events = {{1100ms, kFirst, 1}, {1100ms, kReport, 0}, {1200ms, kCover, 0}, {1200ms, kReport, 0}};
  must_read(sensor, 1300ms, "0:1@1100 2:0@1200");
  must_read(sensor, 1400ms, "");
}
END_TEST

START_TEST(other_keys_and_repeated_ones_are_no_edges) {
  unplug_all();
  Receiver& receiver = plug();
  EvdevSensor sensor;
  ck_assert(!sensor.open(setup()));
  must_read(sensor, 1s, "0:0@1000 1:0@1000 2:0@1000");
  receiver.events = {
      {1100ms, {EV_KEY, KEY_A}, 1},    {1101ms, kFirst, 1}, {1300ms, kFirst, 2}, {1310ms, kFirst, 1},
      {1320ms, {EV_MSC, MSC_SCAN}, 4}, {1400ms, kFirst, 0}};
  must_read(sensor, 2s, "0:1@1101 0:0@1400");
}
END_TEST

START_TEST(after_dropped_events_the_levels_are_read_anew) {
  unplug_all();
  Receiver& receiver = plug();
  EvdevSensor sensor;
  ck_assert(!sensor.open(setup()));
  must_read(sensor, 1s, "0:0@1000 1:0@1000 2:0@1000");
  // What stands between SYN_DROPPED and the next report is incomplete.
  receiver.on = {kSecond};
  receiver.events = {{1100ms, kDropped, 0}, {1100ms, kFirst, 1}};
  must_read(sensor, 1200ms, "");
  receiver.events = {{1210ms, kCover, 1}, {1210ms, kReport, 0}};
  must_read(sensor, 1300ms, "1:1@1300");
}
END_TEST

START_TEST(a_receiver_that_vanishes_is_an_outage_and_is_opened_again) {
  unplug_all();
  plug();
  EvdevSensor sensor;
  ck_assert(!sensor.open(setup()));
  must_read(sensor, 1s, "0:0@1000 1:0@1000 2:0@1000");
  unplug_all();
  must_read(sensor, 2s, "0:!@2000 1:!@2000 2:!@2000");
  ck_assert_int_eq(sensor.fd(), -1);
  ck_assert(says(sensor.outage(), "/dev/input/event3 (PIR receiver) is gone (No such device)"));
  plug();
  must_read(sensor, 2900ms, "");  // once a second
  receivers.at("/dev/input/event3").on = {kFirst};
  must_read(sensor, 3s, "0:1@3000 1:0@3000 2:0@3000");
  ck_assert(sensor.outage().empty());
}
END_TEST

START_TEST(a_receiver_that_returns_under_another_number_is_known_by_its_name) {
  unplug_all();
  plug();
  EvdevSensor sensor;
  ck_assert(!sensor.open(setup()));
  read(sensor, 1s);
  unplug_all();
  read(sensor, 2s);
  plug().name = "a keyboard";  // has taken its path
  must_read(sensor, 3s, "");
  ck_assert(!sensor.outage().empty());
  plug("/dev/input/event9").on = {kCover};
  must_read(sensor, 4s, "0:0@4000 1:0@4000 2:1@4000");
}
END_TEST

START_TEST(events_before_the_end_count) {
  unplug_all();
  Receiver& receiver = plug();
  EvdevSensor sensor;
  ck_assert(!sensor.open(setup()));
  read(sensor, 1s);
  receiver.events = {{1100ms, kFirst, 1}};
  receiver.read_error = ENODEV;
  must_read(sensor, 2s, "0:1@1100 0:!@2000 1:!@2000 2:!@2000");
}
END_TEST

START_TEST(a_device_is_found_by_its_name) {
  unplug_all();
  plug("/dev/input/event0").name = "a keyboard";
  plug("/dev/input/event1").open_error = EACCES;
  plug("/dev/input/event3").on = {kSecond};
  EvdevSensor sensor;
  ck_assert(!sensor.open(setup("PIR receiver")));
  must_read(sensor, 1s, "0:0@1000 1:1@1000 2:0@1000");
  ck_assert(says(sensor.place(1), "BTN_1 of PIR receiver"));
  must_refuse(setup("attic"), SensorFault::not_found,
              "There are: /dev/input/event0 (a keyboard), /dev/input/event3 (PIR receiver).");
}
END_TEST

START_TEST(what_is_wrong_is_named_and_so_is_the_remedy) {
  unplug_all();
  must_refuse(setup(), SensorFault::not_found,
              "There is no input device \"/dev/input/event3\". This machine has none");
  plug().open_error = EACCES;
  must_refuse(setup(), SensorFault::denied, "add the user to the group input");
  must_refuse(setup("PIR receiver"), SensorFault::denied, "add the user to the group input");
  plug().open_error = ENOTTY;
  must_refuse(setup(), SensorFault::not_found, "/dev/input/event3 is no input device");
  plug().open_error = 0;
  SensorSetup how = setup();
  how.codes = {"BTN_0", "BTN_1", "BTN_9"};
  must_refuse(how, SensorFault::not_found, "has no BTN_9. It has: BTN_0, BTN_1, SW_MACHINE_COVER.");
  how.codes = {"BTN_0", "BTN_1", "eggs"};
  must_refuse(how, SensorFault::settings, "\"eggs\" is no key or switch");
  how.codes = {"BTN_0", "BTN_1", "key:256"};
  must_refuse(how, SensorFault::settings, "key:256 is named twice");
  how.codes = {"BTN_0"};
  must_refuse(how, SensorFault::settings, "each of the 3 sensors (codes); 1 are named");
}
END_TEST

START_TEST(codes_have_numbers_and_some_have_names) {
  // Numbers of linux/input-event-codes.h.
  const std::pair<const char*, InputCode> kCodes[] = {{"BTN_0", {1, 0x100}},
                                                      {"BTN_9", {1, 0x109}},
                                                      {"KEY_PROG2", {1, 149}},
                                                      {"KEY_PROG3", {1, 202}},
                                                      {"KEY_WAKEUP", {1, 143}},
                                                      {"SW_LID", {5, 0}},
                                                      {"SW_FRONT_PROXIMITY", {5, 11}},
                                                      {"BTN_TRIGGER_HAPPY40", {1, 0x2e7}},
                                                      {"key:30", {1, 30}},
                                                      {"switch:2", {5, 2}}};
  for (const auto& [name, code] : kCodes) {
    const auto found = parse_input_code(name);
    ck_assert_msg(found == code, "%s", name);
    ck_assert_msg(input_code_name(code) == name, "%s", name);
  }
  for (const char* wrong : {"", "BTN_", "BTN_10", "BTN_x", "KEY_PROG0", "KEY_PROG5", "SW_LID1",
                            "key:", "key:768", "key:-1", "switch:17", "BTN_TRIGGER_HAPPY0"})
    ck_assert_msg(!parse_input_code(wrong), "%s", wrong);
}
END_TEST

}  // namespace

int main() {
  return cerberus::tests::run_suite(
      "evdev_sensor",
      {it_begins_with_the_levels_and_goes_on_with_events_and_their_stamps,
       other_keys_and_repeated_ones_are_no_edges, after_dropped_events_the_levels_are_read_anew,
       a_receiver_that_vanishes_is_an_outage_and_is_opened_again,
       a_receiver_that_returns_under_another_number_is_known_by_its_name, events_before_the_end_count,
       a_device_is_found_by_its_name, what_is_wrong_is_named_and_so_is_the_remedy,
       codes_have_numbers_and_some_have_names});
}
