// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/external/sensor_lines.h"

#include <cmath>
#include <string>

#include "support/suite.h"

namespace {

using namespace cerberus::drivers;

// A line in one word of its own, so that expectations can be read: "levels 0 1 -".
std::string read(std::string_view text) {
  const auto line = parse_sensor_line(text);
  if (!line) return "no line";
  if (const auto* hello = std::get_if<SensorHello>(&*line))
    return std::string("hello ")
        .append(std::to_string(hello->version))
        .append(" ")
        .append(std::to_string(hello->sensors));
  if (const auto* fault = std::get_if<SensorFaultText>(&*line))
    return std::string("fault \"").append(fault->text).append("\"");
  const auto& levels = std::get<SensorLevels>(*line);
  std::string words = levels.measured ? "volts" : "levels";
  for (int i = 0; i < levels.count; ++i) {
    if (levels.measured)
      words +=
          std::isnan(levels.volts[i]) ? " -" : std::string(" ").append(std::to_string(levels.volts[i]), 0, 4);
    else
      words += !levels.levels[i] ? " -" : *levels.levels[i] ? " 1" : " 0";
  }
  return words;
}

void must_read(std::string_view text, const std::string& expected) {
  const std::string found = read(text);
  ck_assert_msg(found == expected, "\"%.*s\" is %s, not %s", static_cast<int>(text.size()), text.data(),
                found.c_str(), expected.c_str());
}

START_TEST(a_line_has_the_levels_of_all_sensors) {
  must_read("levels 0 1 0", "levels 0 1 0");
  must_read("levels 1", "levels 1");
  must_read("levels - 1", "levels - 1");
  must_read("  levels\t0  1 ", "levels 0 1");
  must_read("levels 0 1\r", "levels 0 1");  // Arduino's println
  must_read("levels 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1", "levels 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1");
}
END_TEST

START_TEST(volts_have_a_point_in_every_locale_and_may_be_unknown) {
  must_read("volts 0.25 3.75 -", "volts 0.25 3.75 -");
  must_read("volts -1.5 1e1", "volts -1.5 10.0");
  must_read("volts 1,5", "no line");
  must_read("volts nan", "no line");
  must_read("volts inf", "no line");
  must_read("volts 1001", "no line");
}
END_TEST

START_TEST(the_hello_names_version_and_number) {
  must_read("cerberus-pir 1 3", "hello 1 3");
  must_read("cerberus-pir 1 3 later words", "hello 1 3");
  must_read("cerberus-pir 2", "hello 2 0");  // whatever follows is that version's
  must_read("cerberus-pir 2 many", "hello 2 0");
  for (const char* wrong : {"cerberus-pir", "cerberus-pir 0 3", "cerberus-pir 1", "cerberus-pir 1 0",
                            "cerberus-pir 1 17", "cerberus-pir one 3", "cerberus-pir 99999999999 3"})
    must_read(wrong, "no line");
}
END_TEST

START_TEST(a_fault_has_words_that_can_be_printed) {
  must_read("fault the converter does not answer", "fault \"the converter does not answer\"");
  must_read("fault", "fault \"\"");
  must_read("fault a\x1b[2Jb\xff", "fault \"a?[2Jb?\"");
  must_read("fault " + std::string(400, 'x'), "fault \"" + std::string(200, 'x') + "\"");
}
END_TEST

START_TEST(other_lines_are_skipped) {
  for (const char* other :
       {"", " ", "# a comment", "levels", "levels 2", "levels 0 1 x", "levels 01", "LEVELS 0", "els 0 1 0",
        "levels 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0", "volts", "ets Jul 29 2019 12:21:46"})
    must_read(other, "no line");
}
END_TEST

}  // namespace

int main() {
  return cerberus::tests::run_suite(
      "sensor_lines",
      {a_line_has_the_levels_of_all_sensors, volts_have_a_point_in_every_locale_and_may_be_unknown,
       the_hello_names_version_and_number, a_fault_has_words_that_can_be_printed, other_lines_are_skipped});
}
