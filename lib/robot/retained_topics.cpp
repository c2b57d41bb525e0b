// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/retained_topics.h"

#include <algorithm>

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

std::string text_of(const Topics& topics) {
  std::string text;
  for (const std::string& topic : topics) text.append(topic).append("\n");
  return text;
}

Topics topics_of(std::string_view text) {
  Topics all;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (end > 0) all.emplace(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return all;
}

}  // namespace cerberus::robot
