// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/retained_topics.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "publish/mqtt_report.h"

namespace cerberus::robot {

namespace {

std::string value_of(const Properties& properties, std::string_view name, std::string otherwise) {
  for (const Property& one : properties)
    if (one.name == name) return one.value;
  return otherwise;
}

// As pirsrc counts its `bearings`, parted by commas; three where there are none.
std::size_t count_sensors(const Properties& sensors) {
  const std::string bearings = value_of(sensors, "bearings", "0,-120,120");
  return static_cast<std::size_t>(std::ranges::count(bearings, ',')) + 1;
}

// A line that names a broker, with a tab before each of its words; no topic begins so.
constexpr std::string_view kBroker = "\tbroker";

bool is_same_broker(const Properties& a, const Properties& b) {
  return value_of(a, "host", "") == value_of(b, "host", "") &&
         value_of(a, "port", "1883") == value_of(b, "port", "1883");
}

}  // namespace

Topics retained_topics(const Settings& settings) {
  Topics all;
  if (!settings.mqtt) return all;
  const std::string home_assistant = value_of(*settings.mqtt, "discovery-prefix", "");
  for (const CameraSettings& camera : settings.cameras) {
    const publish::MqttReport report(value_of(*settings.mqtt, "topic-prefix", "cerberus"), camera.name);
    const publish::MqttParts parts{camera.sensors ? count_sensors(*camera.sensors) : 0,
                                   camera.head.has_value(), camera.recorder.has_value()};
    for (std::string& topic : report.retained_topics(home_assistant, parts)) all.insert(std::move(topic));
  }
  return all;
}

Properties broker_properties(const Properties& mqtt) {
  constexpr std::array<std::string_view, 5> kNames{"host", "port", "username", "password-file", "ca-file"};
  Properties all;
  for (const std::string_view name : kNames)
    for (const Property& one : mqtt)
      if (one.name == name && one.value.find_first_of("\t\n") == one.value.npos)
        all.push_back({one.name, one.value});
  return all;
}

std::vector<LeftTopics> with_present(std::vector<LeftTopics> before, const Settings& settings) {
  if (!settings.mqtt) return before;
  LeftTopics present{broker_properties(*settings.mqtt), retained_topics(settings)};
  std::erase_if(before, [&](LeftTopics& one) {
    const bool is_same = one.broker.empty() || is_same_broker(one.broker, present.broker);
    if (is_same) present.topics.merge(one.topics);
    return is_same;
  });
  before.insert(before.begin(), std::move(present));
  return before;
}

std::vector<LeftTopics> retired_topics(const std::vector<LeftTopics>& all, const Settings& settings) {
  const Topics present = retained_topics(settings);
  std::vector<LeftTopics> retired;
  for (const LeftTopics& one : all) {
    LeftTopics left{one.broker, {}};
    if (settings.mqtt && is_same_broker(one.broker, *settings.mqtt))
      std::ranges::set_difference(one.topics, present, std::inserter(left.topics, left.topics.end()));
    else
      left.topics = one.topics;
    if (!left.topics.empty()) retired.push_back(std::move(left));
  }
  return retired;
}

std::string text_of(const std::vector<LeftTopics>& all) {
  std::string text;
  for (const LeftTopics& one : all) {
    text.append(kBroker);
    for (const Property& word : one.broker)
      text.append("\t").append(word.name).append("=").append(word.value);
    text += '\n';
    for (const std::string& topic : one.topics) text.append(topic).append("\n");
  }
  return text;
}

std::vector<LeftTopics> left_topics_of(std::string_view text) {
  std::vector<LeftTopics> all;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.starts_with(kBroker)) {
      line.remove_prefix(kBroker.size());
      LeftTopics& one = all.emplace_back();
      while (line.starts_with('\t')) {
        const std::string_view word = line.substr(1, line.find('\t', 1) - 1);
        const std::size_t sign = std::min(word.find('='), word.size());
        one.broker.push_back(
            {std::string(word.substr(0, sign)), std::string(word.substr(std::min(sign + 1, word.size())))});
        line.remove_prefix(word.size() + 1);
      }
    } else if (!line.empty()) {
      if (all.empty()) all.emplace_back();
      all.back().topics.emplace(line);
    }
  }
  return all;
}

}  // namespace cerberus::robot
