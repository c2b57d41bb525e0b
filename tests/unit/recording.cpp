// SPDX-License-Identifier: LGPL-2.1-or-later
// Recorded sensors: what their files and scripts say, and what is wrong with those that say nothing.
#include "drivers/recorded/recording.h"

#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <string>

#include "drivers/sensor/sensor.h"
#include "support/says.h"
#include "support/suite.h"
#include "support/temporary_file.h"

namespace {

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::tests::temporary_file;

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
    ck_assert_int_eq(static_cast<int>(recording.edges.size()), 9);
    ck_assert(recording.edges[3].time == 1500ms && recording.edges[3].sensor == 0 &&
              recording.edges[3].level);
    ck_assert(recording.edges[3].known && !recording.edges[7].known);  // 2
    ck_assert(recording.edges[8].time == 2s && recording.edges[8].sensor == 2 && recording.edges[8].level);
  }
}
END_TEST

START_TEST(a_byte_order_mark_is_no_reading) {
  for (const std::string text : {"0,0,1,0\n", "time,a,b,c\n0,0,1,0\n", "{\"time\":0,\"pir\":[0,1,0]}\n"}) {
    Recording recording;
    ck_assert(!parse("\xEF\xBB\xBF" + text, recording));
    ck_assert(recording.edges.size() == 3 && recording.edges[1].level);
    ck_assert(parse(text + "\xEF\xBB\xBF" + text, recording).fault == SensorFault::data);
  }
}
END_TEST

START_TEST(an_error_in_a_recording_is_reported_with_file_and_line) {
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
  const std::string empty = temporary_file("# nothing\n");
  ck_assert(why(empty).fault == SensorFault::data && says(why(empty).text, empty + " holds no readings"));
  unlink(empty.c_str());
}
END_TEST

START_TEST(a_recording_that_may_not_be_read_is_named) {
  SensorSetup setup;
  setup.location = temporary_file("0,0,0,0\n");
  chmod(setup.location.c_str(), 0);
  const bool root = geteuid() == 0;
  ck_assert(!root || seteuid(65534) == 0);
  const SensorError error = make_sensor("replay")->open(setup);
  ck_assert(!root || seteuid(0) == 0);
  unlink(setup.location.c_str());
  ck_assert(error.fault == SensorFault::denied);
  ck_assert(says(error.text, setup.location) && says(error.text, "may read it"));
}
END_TEST

START_TEST(a_recording_is_played_when_its_time_has_come) {
  SensorSetup setup;
  setup.script = "0.5,0,1,0; 2,1,1,0; 2,1,1,1; 3 fail the cable broke";
  auto sensor = make_sensor("scripted");
  ck_assert(!sensor->open(setup) && !sensor->measures());
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

START_TEST(volts_are_written_as_volts) {
  Recording csv, json;
  ck_assert(!parse("time,a,b,c\n0,0.1V,-2V,3.25V\n1.5, 1e-1V ,0V,1000V", csv));
  ck_assert(
      !parse("{\"time\":0,\"volts\":[0.1,-2,3.25]}\n{\"pts\":1500000000,\"volts\":[0.1,0,1e3]}\n", json));
  const float expected[] = {0.1F, -2, 3.25F, 0.1F, 0, 1000};
  for (const Recording& recording : {csv, json}) {
    ck_assert(recording.volts && recording.end == 1500ms);
    ck_assert_int_eq(static_cast<int>(recording.edges.size()), 6);
    for (std::size_t i = 0; i < 6; ++i) {
      ck_assert(recording.edges[i].time == (i < 3 ? 0ms : 1500ms));
      ck_assert_int_eq(recording.edges[i].sensor, static_cast<int>(i % 3));
      ck_assert(recording.edges[i].volts == expected[i]);
    }
  }
  Recording levels;
  ck_assert(!parse("0,0,1,0\n", levels) && !levels.volts && std::isnan(levels.edges[1].volts));
}
END_TEST

START_TEST(an_error_in_volts_is_reported) {
  const struct {
    const char *text, *why;
  } cases[] = {
      {"0,0V,0V,highV\n", "\"highV\" is no voltage"},
      {"0,0V,0V,V\n", "\"V\" is no voltage"},
      {"0,0V,0V,nanV\n", "\"nanV\" is no voltage"},
      {"0,0V,0V,infV\n", "\"infV\" is no voltage"},
      {"0,0V,0V,1001V\n", "\"1001V\" is no voltage"},
      {"0,0V,0V,1.7\n", "\"1.7\" is no reading: 0, 1 or 2 is expected, or volts (1.7V)"},
      {"0,0V,0V,1\n", "line 1: volts and levels are mixed"},
      {"0,0,0,1\n1,0V,0V,3V\n", "line 2: volts and levels are mixed"},
      {"0,0V,0V,3V\n1,0,0,1\n", "line 2: volts and levels are mixed"},
      {"0,0V,0V\n", "it has 2 readings"},
      {"{\"time\":0,\"volts\":[0,null,1]}\n", "\"null\" is no voltage"},
      {"{\"time\":0,\"volts\":3}\n", "no \"pir\""},
  };
  for (const auto& one : cases) {
    Recording recording;
    const SensorError error = parse(one.text, recording);
    ck_assert(error.fault == SensorFault::data);
    ck_assert(says(error.text, one.why));
  }
}
END_TEST

START_TEST(recorded_volts_are_compared_with_the_threshold) {
  SensorSetup setup;
  setup.sensors = 1;
  setup.level = {.threshold = 2, .hysteresis = 1};
  setup.script = "0,0V; 1,2.4V; 2,2.5V; 3,1.5V; 4,1.4V";
  auto sensor = make_sensor("scripted");
  ck_assert(!sensor->open(setup) && sensor->measures());
  std::vector<SensorEdge> edges;
  ck_assert(!sensor->read(10s, edges));
  std::string levels;
  for (const SensorEdge& edge : edges) levels += edge.level ? '1' : '0';
  ck_assert_str_eq(levels.c_str(), "00110");
}
END_TEST

}  // namespace

int main() {
  return cerberus::tests::run_suite(
      "recording",
      {comma_separated_values_and_json_lines_say_the_same, a_byte_order_mark_is_no_reading,
       an_error_in_a_recording_is_reported_with_file_and_line,
       files_that_cannot_be_recordings_are_refused_at_once, a_recording_that_may_not_be_read_is_named,
       a_recording_is_played_when_its_time_has_come, volts_are_written_as_volts,
       an_error_in_volts_is_reported, recorded_volts_are_compared_with_the_threshold});
}
