// SPDX-License-Identifier: LGPL-2.1-or-later
// pirsrc on the lines of a GPIO chip that the kernel simulates: real character devices, interrupts and time stamps.
#include "pir_source.h"

#include <linux/gpio.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>

#include <cerrno>
#include <cstdarg>
#include <string>
#include <vector>

namespace {

using namespace simulated;

// What libgpiod's requests for lines end with, as a kernel driver or a sandbox may refuse them though the chip opens;
// 0: they go through. The files of a simulated chip know no such thing: the program's own ioctl() comes before libc's.
int inputs_refused = 0, outputs_refused = 0;

int refusal_of(unsigned long request, const void* argument) {
  if (request == GPIO_GET_LINEEVENT_IOCTL) return inputs_refused;
  if (request == GPIO_GET_LINEHANDLE_IOCTL) return outputs_refused;
  if (request != GPIO_V2_GET_LINE_IOCTL) return 0;
  const auto& config = static_cast<const gpio_v2_line_request*>(argument)->config;
  return config.flags & GPIO_V2_LINE_FLAG_OUTPUT ? outputs_refused : inputs_refused;
}

}  // namespace

extern "C" int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list arguments;
  va_start(arguments, request);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  errno = refusal_of(request, argument);
  return errno ? -1 : static_cast<int>(syscall(SYS_ioctl, fd, request, argument));
}

namespace {

// Long heartbeats: what comes, comes because of an edge.
std::string gpio(const Chip& chip, const std::string& more = "lines=0,1,2") {
  return "driver=gpio heartbeat=5000000000 chip=" + chip.path() + " " + more;
}

// A source that plays and whose lines are all low.
class Quiet : public Source {
 public:
  explicit Quiet(const std::string& properties) : Source(properties) {
    play();
    expect({0, 0, 0});
  }
};

GST_START_TEST(a_pulse_comes_with_the_kernels_time_and_its_least_length) {
  Chip chip;
  Quiet source(gpio(chip));
  int line = 0;
  const GstClockTime least = least_of(60 * GST_MSECOND, [&] {
    Bytes expected{0, 0, 0};
    expected[line] = 1;
    const GstClockTime before = source.now();
    chip.pull(line, true);
    const GstClockTime after = source.now();
    const GstClockTime when = source.expect(expected);
    const GstClockTime came = source.now();
    must_be_of(when, {before + 10 * GST_MSECOND, after + 10 * GST_MSECOND});  // min-pulse
    const GstClockTime falling = source.now();
    chip.pull(line, false);
    const GstClockTime fell = source.now();
    const GstClockTime ended = source.expect({0, 0, 0});
    must_be_of(ended, {falling + 20 * GST_MSECOND, fell + 20 * GST_MSECOND});
    line = (line + 1) % 3;
    return came - before;
  });
  g_print("edge to buffer: %.1f ms\n", static_cast<double>(least) / 1e6);
  fail_unless(least < 60 * GST_MSECOND);
}
GST_END_TEST

GST_START_TEST(edges_that_nobody_waited_for_keep_their_times) {
  Chip chip;
  Quiet source(gpio(chip, "lines=0,1,2 min-pulse=0 debounce=0"));
  std::vector<Span> pulled;
  for (int i = 0; i < 6; ++i) {
    const GstClockTime before = source.now();
    chip.pull(0, i % 2 == 0);
    pulled.push_back({before, source.now()});
    g_usleep(10000);
  }
  GstClockTime last = 0;
  for (int i = 0; i < 6; ++i) {
    const GstClockTime when = source.expect({i % 2 == 0, 0, 0});
    must_be_of(when, pulled[i]);
    fail_unless(when > last);
    last = when;
  }
}
GST_END_TEST

GST_START_TEST(lines_go_by_name_and_the_chip_by_label_number_or_name) {
  Chip chip;
  const std::string number = chip.name().substr(std::string("gpiochip").size());
  for (const std::string& name : {chip.label(), number, chip.name(), chip.path()}) {
    chip.pull(1, true);
    Source source("driver=gpio heartbeat=5000000000 bearings=0 lines=door chip=" + name);
    source.play();
    source.expect({1});
    chip.pull(1, false);
    source.expect({0});
  }
}
GST_END_TEST

GST_START_TEST(bias_pulls_an_open_line) {
  Chip chip;
  {
    Source up(gpio(chip, "lines=3,4,5 bias=pull-up"));
    up.play();
    up.expect({1, 1, 1});
  }
  {
    Source as_is(gpio(chip, "lines=3,4,5"));  // still up
    as_is.play();
    as_is.expect({1, 1, 1});
  }
  Quiet down(gpio(chip, "lines=3,4,5 bias=pull-down"));
}
GST_END_TEST

GST_START_TEST(an_open_collector_module_is_active_low) {
  Chip chip;
  Quiet source(gpio(chip, "lines=0,1,2 bias=pull-up active-low=true"));
  chip.pull(2, false);
  source.expect({0, 0, 1});
}
GST_END_TEST

GST_START_TEST(leds_are_red_while_a_sensor_detects_and_blue_while_it_does_not) {
  Chip chip;
  const auto leds = [&] {
    std::string all;
    for (int line = 3; line < 9; ++line) all += std::to_string(chip.value(line));
    return all;
  };
  // They are lit on the driver's own thread.
  const auto must_become = [&](const std::string& expected) {
    for (int k = 0; k < 1000 && leds() != expected; ++k) g_usleep(10000);
    fail_unless(leds() == expected, "%s", leds().c_str());
  };
  {
    Quiet source(gpio(chip, "lines=0,1,2 leds-red=3,4,5 leds-blue=6,7,8"));
    must_become("000111");
    chip.pull(1, true);
    source.expect({0, 1, 0});
    must_become("010101");
    chip.pull(1, false);
    source.expect({0, 0, 0});
    must_become("000111");
    // A simulated line loses its level when it is released, a real one may not: it must have been set before.
    simulated::Trace trace("gpio/gpio_value");
    gst_element_set_state(source.element(), GST_STATE_READY);
    must_become("000000");
    fail_unless_equals_int(trace.count(" set 0"), 6);
  }
  Source warming(gpio(chip, "lines=0,1,2 leds-red=3,4,5 warm-up=3600000000000"));
  warming.play();
  warming.expect({2, 2, 2});
  fail_unless(leds() == "000000", "%s", leds().c_str());
}
GST_END_TEST

GST_START_TEST(a_line_in_use_is_named_with_its_user) {
  Chip chip;
  Quiet first(gpio(chip));
  {
    Source second(gpio(chip, "lines=6,7,2"));
    const std::string why = second.refusal(GST_RESOURCE_ERROR_BUSY);
    fail_unless(says(why, "Line 2 of GPIO chip " + chip.path()) && says(why, "in use by \"cerberus\""));
  }
  {
    Source leds(gpio(chip, "lines=6,7,8 leds-red=9,10,0"));
    fail_unless(says(leds.refusal(GST_RESOURCE_ERROR_BUSY), "Line 0 of"));
  }
  Source third(gpio(chip, "lines=6,7,8"));  // the refused ones left nothing behind
  third.play();
  third.expect({0, 0, 0});
  chip.pull(0, true);
  first.expect({1, 0, 0});
}
GST_END_TEST

GST_START_TEST(what_is_not_there_is_named) {
  Chip chip;
  fail_unless(
      says(Source("driver=gpio chip=/dev/gpiochip77 lines=0,1,2").refusal(GST_RESOURCE_ERROR_NOT_FOUND),
           "no GPIO chip \"/dev/gpiochip77\". There are: /dev/gpiochip"));
  fail_unless(
      says(Source("driver=gpio chip=attic lines=0,1,2").refusal(GST_RESOURCE_ERROR_NOT_FOUND), "\"attic\""));
  fail_unless(says(Source("driver=gpio chip=/dev/null lines=0,1,2").refusal(GST_RESOURCE_ERROR_NOT_FOUND),
                   "/dev/null"));
  fail_unless(says(Source(gpio(chip, "lines=0,1,12")).refusal(GST_RESOURCE_ERROR_NOT_FOUND),
                   "no line 12: its lines are 0 to 11"));
  fail_unless(
      says(Source(gpio(chip, "lines=0,window,2")).refusal(GST_RESOURCE_ERROR_NOT_FOUND), "\"window\""));
  fail_unless(says(Source(gpio(chip, "lines=0,door,1")).refusal(GST_RESOURCE_ERROR_SETTINGS), "named twice"));
  fail_unless(says(Source(gpio(chip, "lines=0,1")).refusal(GST_RESOURCE_ERROR_SETTINGS), "2 are named"));
  fail_unless(
      says(Source(gpio(chip, "lines=0,1,2 leds-blue=3,4")).refusal(GST_RESOURCE_ERROR_SETTINGS), "LED"));
}
GST_END_TEST

GST_START_TEST(without_permission_the_group_is_named) {
  Chip chip;
  fail_unless(seteuid(65534) == 0);
  Source source(gpio(chip));
  const std::string why = source.refusal(GST_RESOURCE_ERROR_NOT_AUTHORIZED);
  fail_unless(seteuid(0) == 0);
  fail_unless(says(why, chip.path()) && says(why, "group gpio"));
}
GST_END_TEST

GST_START_TEST(lines_that_may_not_be_used_are_named) {
  Chip chip;
  for (const int error : {EPERM, EACCES}) {
    inputs_refused = error;
    std::string why = Source(gpio(chip)).refusal(GST_RESOURCE_ERROR_NOT_AUTHORIZED);
    fail_unless(says(why, "No permission to use lines 0, 1, 2 of GPIO chip " + chip.path()));
    inputs_refused = 0;
    outputs_refused = error;
    why = Source(gpio(chip, "lines=0,1,2 leds-blue=5,4,3")).refusal(GST_RESOURCE_ERROR_NOT_AUTHORIZED);
    fail_unless(says(why, "No permission to use lines 5, 4, 3 of GPIO chip " + chip.path()));
    outputs_refused = 0;
  }
  inputs_refused = EINVAL;  // of a driver without bias support
  const std::string why = Source(gpio(chip)).refusal(GST_RESOURCE_ERROR_READ);
  fail_unless(says(why, "does not give lines 0, 1, 2 (Invalid argument)") && says(why, "bias"));
  inputs_refused = 0;
  Quiet usable(gpio(chip));  // the refused ones left nothing behind
}
GST_END_TEST

GST_START_TEST(a_chip_that_is_unplugged_while_running_is_an_error_that_names_it) {
  Chip chip;
  Source source("driver=gpio lines=0,1,2 leds-red=3,4,5 chip=" + chip.path());  // the usual heartbeat
  source.play();
  source.expect({0, 0, 0});
  chip.pull(1, true);
  source.expect({0, 1, 0});
  chip.unplug();
  source.expect({2, 2, 2});  // a lost sensor's last reading causes no endless search
  fail_unless(says(source.words(GST_MESSAGE_ERROR, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ),
                   "GPIO chip " + chip.path()));
}
GST_END_TEST

GST_START_TEST(a_chip_that_comes_back_is_usable_again) {
  for (int round = 0; round < 3; ++round) {
    Chip chip;
    Quiet source("driver=gpio lines=0,1,2 chip=" + chip.path());
    chip.unplug();
    source.words(GST_MESSAGE_ERROR);
  }
}
GST_END_TEST

GST_START_TEST(stopping_takes_no_time_while_it_waits_for_an_edge) {
  Chip chip;
  Source source("driver=gpio heartbeat=3600000000000 lines=0,1,2 chip=" + chip.path());
  const GstClockTime least = least_of(100 * GST_MSECOND, [&] {
    source.play();
    source.reading();
    const gint64 before = g_get_monotonic_time();
    gst_element_set_state(source.element(), GST_STATE_NULL);
    return static_cast<GstClockTime>(g_get_monotonic_time() - before) * GST_USECOND;
  });
  fail_unless(least < 100 * GST_MSECOND, "%d ms", static_cast<int>(least / GST_MSECOND));
}
GST_END_TEST

GST_START_TEST(a_sensor_that_chatters_is_named_with_its_line) {
  Chip chip;
  Quiet source(gpio(chip, "lines=4,5,6 min-pulse=0 debounce=0 chatter-edges=10"));
  for (int i = 0; i < 30;
       ++i) {  // more than needed: of edges that come too fast the kernel reports some as one
    chip.pull(5, true);
    g_usleep(3000);
    chip.pull(5, false);
    g_usleep(3000);
  }
  const std::string warning = source.words(GST_MESSAGE_WARNING);
  fail_unless(says(warning, "infer2 (line 5 of " + chip.path()) && says(warning, "is chattering"));
}
GST_END_TEST

// The kernel keeps 16 edges of a line for a late reader; lost edges must not leave the sensor wrong.
GST_START_TEST(a_flood_of_edges_ends_with_the_right_level) {
  Chip chip;
  Quiet source("driver=gpio min-pulse=0 debounce=0 chatter-edges=0 lines=0,1,2 chip=" + chip.path());
  for (int round = 0; round < 4; ++round) {  // now the kernel's last edge is the right one by chance, now not
    gst_element_set_state(source.element(), GST_STATE_PAUSED);  // no reader
    for (int i = 0; i < 101; ++i) {
      chip.pull(0, i % 2 == round % 2);
      g_usleep(500);
    }
    source.play();
    const GstClockTime calm = source.now();
    GstClockTime when = 0;
    Bytes last;
    while (when < calm + 200 * GST_MSECOND) last = source.reading(&when);
    fail_unless(last == Bytes({round % 2 == 0, 0, 0}));
  }
}
GST_END_TEST

Suite* gpio_suite() {
  Suite* suite = suite_create("gpio");
  TCase* tests = tcase_create("gpio");
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, a_pulse_comes_with_the_kernels_time_and_its_least_length);
  tcase_add_test(tests, edges_that_nobody_waited_for_keep_their_times);
  tcase_add_test(tests, lines_go_by_name_and_the_chip_by_label_number_or_name);
  tcase_add_test(tests, bias_pulls_an_open_line);
  tcase_add_test(tests, an_open_collector_module_is_active_low);
  tcase_add_test(tests, leds_are_red_while_a_sensor_detects_and_blue_while_it_does_not);
  tcase_add_test(tests, a_line_in_use_is_named_with_its_user);
  tcase_add_test(tests, what_is_not_there_is_named);
  tcase_add_test(tests, without_permission_the_group_is_named);
  tcase_add_test(tests, lines_that_may_not_be_used_are_named);
  tcase_add_test(tests, a_chip_that_is_unplugged_while_running_is_an_error_that_names_it);
  tcase_add_test(tests, a_chip_that_comes_back_is_usable_again);
  tcase_add_test(tests, stopping_takes_no_time_while_it_waits_for_an_edge);
  tcase_add_test(tests, a_sensor_that_chatters_is_named_with_its_line);
  tcase_add_test(tests, a_flood_of_edges_ends_with_the_right_level);
  suite_add_tcase(suite, tests);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(gpio)
