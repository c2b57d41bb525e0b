// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/recorded/recording.h"

#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

namespace cerberus::drivers {

namespace {

constexpr double kLongest = 100.0 * 365 * 86400;  // seconds
constexpr double kMostVolts = 1000;               // either way

struct Row {
  Time time{};
  std::array<int, sensing::kMaxSensors> levels{};
  std::array<float, sensing::kMaxSensors> volts{};
  std::size_t count = 0, measured = 0;
};

std::string_view trim(std::string_view text) {
  constexpr std::string_view blank = " \t\r";
  const auto first = text.find_first_not_of(blank);
  return first == text.npos ? std::string_view()
                            : text.substr(first, text.find_last_not_of(blank) - first + 1);
}

bool from_seconds(double seconds, Time& time) {
  if (!(seconds >= 0 && seconds <= kLongest)) return false;
  time = Time(std::llround(seconds * 1e9));
  return true;
}

bool from_decimal(std::string_view text, double& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

// These functions return an error text for the user; empty: no error.
std::string add_volts(Row& row, double volts, const std::string& text) {
  if (!(std::abs(volts) <= kMostVolts)) return "\"" + text + "\" is no voltage";
  if (row.count < row.volts.size()) row.volts[row.count] = static_cast<float>(volts);
  ++row.count;
  ++row.measured;
  return "";
}

std::string add_level(Row& row, std::string_view text) {
  if (text.ends_with('V')) {
    double volts = kMostVolts * 2;
    if (!from_decimal(text.substr(0, text.size() - 1), volts)) volts = kMostVolts * 2;
    return add_volts(row, volts, std::string(text));
  }
  if (text != "0" && text != "1" && text != "2")
    return "\"" + std::string(text) + "\" is no reading: 0, 1 or 2 is expected, or volts (1.7V)";
  if (row.count < row.levels.size()) row.levels[row.count] = text[0] - '0';
  ++row.count;
  return "";
}

std::string parse_csv(std::string_view line, Row& row) {
  const auto comma = line.find(',');
  if (!parse_seconds(trim(line.substr(0, comma)), row.time))
    return "\"" + std::string(trim(line.substr(0, comma))) + "\" is no time in seconds";
  for (auto at = comma; at != line.npos;) {
    const auto end = line.find(',', at + 1);
    std::string why = add_level(row, trim(line.substr(at + 1, end == line.npos ? end : end - at - 1)));
    if (!why.empty()) return why;
    at = end;
  }
  return "";
}

std::string parse_json(std::string_view line, Row& row) {
  const auto object = nlohmann::json::parse(line, nullptr, false);
  if (!object.is_object()) return "it is no complete JSON object";
  const auto time = object.find("time"), pts = object.find("pts");
  const auto pir = object.find("pir"), volts = object.find("volts");
  const bool timed = time != object.end() && time->is_number()
                         ? from_seconds(time->get<double>(), row.time)
                         : pts != object.end() && pts->is_number_unsigned() &&
                               from_seconds(pts->get<double>() / 1e9, row.time);
  if (!timed) return "it has neither \"time\" in seconds nor \"pts\" in nanoseconds";
  if (volts != object.end() && volts->is_array()) {
    for (const auto& measured : *volts) {
      const double number = measured.is_number() ? measured.get<double>() : kMostVolts * 2;
      std::string why = add_volts(row, number, measured.dump());
      if (!why.empty()) return why;
    }
    return "";
  }
  if (pir == object.end() || !pir->is_array()) return "it has no \"pir\": [readings]";
  for (const auto& level : *pir) {
    std::string why = add_level(row, level.dump());
    if (!why.empty()) return why;
  }
  return "";
}

bool counts(std::string_view line) {
  return !line.empty() && line.front() != '#';
}

bool is_heading(std::string_view line) {
  const std::string_view first = trim(line.substr(0, line.find(',')));
  return first == "time" || first == "\"time\"";
}

}  // namespace

bool parse_seconds(std::string_view text, Time& time) {
  double seconds = 0;
  return from_decimal(text, seconds) && from_seconds(seconds, time);
}

SensorError parse_recording(std::string_view text, std::string_view name, int sensors, Recording& recording) {
  recording = {};
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // written by some spreadsheet programs
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  std::size_t number = 0;
  bool begun = false;
  while (!text.empty()) {
    const auto end = text.find('\n');
    const bool complete = end != text.npos;
    const std::string_view line = trim(text.substr(0, end));
    text.remove_prefix(complete ? end + 1 : text.size());
    ++number;
    if (!counts(line) || (!begun && is_heading(line))) continue;
    Row row;
    std::string why = line.front() == '{' ? parse_json(line, row) : parse_csv(line, row);
    if (why.empty() && row.count != static_cast<std::size_t>(sensors))
      why = "it has " + std::to_string(row.count) + " readings, and there are " + std::to_string(sensors) +
            " sensors";
    if (why.empty() && begun && row.time < recording.end) why = "its time is before that of the line above";
    const bool in_volts = row.measured > 0;
    if (why.empty() && (in_volts ? row.measured < row.count || (begun && !recording.volts) : recording.volts))
      why = "volts and levels are mixed";
    if (!why.empty()) {
      if (!complete) why += "; the file seems to be cut off here";
      return {SensorFault::data, std::string(name) + ", line " + std::to_string(number) + ": " + why + ".",
              std::string(line.substr(0, 200))};
    }
    begun = true;
    recording.end = row.time;
    recording.volts = in_volts;
    for (std::size_t i = 0; i < row.count; ++i) {
      if (in_volts)
        recording.edges.push_back({row.time, static_cast<int>(i), false, row.volts[i]});
      else
        recording.edges.push_back({.time = row.time,
                                   .sensor = static_cast<int>(i),
                                   .level = row.levels[i] == 1,
                                   .known = row.levels[i] < 2});
    }
  }
  return {};
}

}  // namespace cerberus::drivers
