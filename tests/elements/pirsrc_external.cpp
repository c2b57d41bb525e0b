// SPDX-License-Identifier: LGPL-2.1-or-later
// pirsrc with sensors that another program sends: its readings, and what is reported when it ends or is wrong.
#include <cerberus/pir.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "../support/pipe.h"
#include "../support/pir_source.h"

namespace {

using cerberus::tests::Pipe;
using Bytes = std::vector<int>;

constexpr char kDriver[] = "driver=external debounce=0 heartbeat=3600000000000 ";

class Source : public PirSource {
 public:
  explicit Source(const std::string& properties) : PirSource("pirsrc name=source " + (kDriver + properties)) {
    gst_harness_use_systemclock(harness());
  }
  void must_read(const Bytes& expected) {
    Bytes readings;
    // Until the first line comes nothing is known.
    do {
      g_autoptr(GstBuffer) buffer = take();
      readings = readings_of(buffer);
    } while (nothing_is_known(readings) && !nothing_is_known(expected));
    fail_unless(readings == expected, "%d%d%d", readings[0], readings[1], readings[2]);
  }
};

// A command that reads its lines from the test, to its own end.
std::string lines_of(const Pipe& pipe) {
  return "command=\"exec cat <&" + pipe.reader() + " " + pipe.writer() + ">&-\" device-options=\"silence=0\"";
}

void write(const Pipe& pipe, const std::string& text) {
  fail_unless(::write(pipe.ends[1], text.data(), text.size()) == static_cast<ssize_t>(text.size()));
}

}  // namespace

GST_START_TEST(lines_become_readings_at_once) {
  Pipe pipe;
  Source source(lines_of(pipe));
  source.play();
  write(pipe, "cerberus-pir 1 3\nlevels 0 1 0\n");
  source.must_read({0, 1, 0});
  write(pipe, "levels 1 1 0\n");
  source.must_read({1, 1, 0});
  write(pipe, "levels 1 1 -\n");
  source.must_read({1, 1, 2});
  fail_unless(source.pop(GST_MESSAGE_WARNING) == nullptr);
}
GST_END_TEST

GST_START_TEST(a_program_that_ends_is_a_warning_and_its_return_an_info) {
  Pipe pipe;
  Source source(lines_of(pipe));
  source.play();
  write(pipe, "levels 0 1 0\n");
  source.must_read({0, 1, 0});
  write(pipe, "fault no supply\n");
  source.must_read({2, 2, 2});
  const std::string words = source.words(GST_MESSAGE_WARNING, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ);
  fail_unless(says(words, ": no supply."));
  write(pipe, "levels 0 0 1\n");
  source.must_read({0, 0, 1});
  g_autoptr(GstMessage) info = source.wait_for(GST_MESSAGE_INFO);
  fail_unless(source.pop(GST_MESSAGE_ERROR) == nullptr);
  pipe.close_writer();
  source.must_read({2, 2, 2});
  fail_unless(says(source.words(GST_MESSAGE_WARNING), "it has ended"));
}
GST_END_TEST

GST_START_TEST(another_number_of_sensors_is_an_error) {
  Pipe pipe;
  Source source(lines_of(pipe));
  source.play();
  write(pipe, "cerberus-pir 1 2\n");
  fail_unless(says(source.words(GST_MESSAGE_ERROR, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_SETTINGS),
                   "there are 2, and 3 bearings are set"));
}
GST_END_TEST

GST_START_TEST(the_example_of_the_manual_works) {
  Source source("command=\"exec python3 " CERBERUS_SOURCE_ROOT "/pipelines/sensors/example.py\"");
  source.play();
  source.must_read({1, 0, 0});  // the walk begins straight ahead
  fail_unless(source.pop(GST_MESSAGE_WARNING) == nullptr);
}
GST_END_TEST

GST_START_TEST(what_is_missing_is_named) {
  fail_unless(
      says(Source("").refusal(GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_SETTINGS), "a command or a device"));
  fail_unless(
      says(Source("device=serial:/dev/nothing").refusal(GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_NOT_FOUND),
           "/dev/nothing"));
  fail_unless(says(PirSource("pirsrc driver=evdev device=attic codes=BTN_0,BTN_1,BTN_2")
                       .refusal(GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_NOT_FOUND),
                   "\"attic\""));
}
GST_END_TEST

static Suite* pirsrc_external_suite() {
  Suite* suite = suite_create("pirsrc_external");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, lines_become_readings_at_once);
  tcase_add_test(tests, a_program_that_ends_is_a_warning_and_its_return_an_info);
  tcase_add_test(tests, another_number_of_sensors_is_an_error);
  tcase_add_test(tests, the_example_of_the_manual_works);
  tcase_add_test(tests, what_is_missing_is_named);
  return suite;
}

GST_CHECK_MAIN(pirsrc_external)
