// SPDX-License-Identifier: LGPL-2.1-or-later
#include "broker.h"

#include <glib.h>

#include <algorithm>
#include <utility>

#include "robot/settings_file.h"
#include "text/file.h"

namespace cerberus::robot {

namespace {
constexpr std::size_t kLongestList = 4u << 20;  // bytes: far more than 500 cameras have
}

plugin::MqttServer broker_of(const Properties& mqtt, const char* what) {
  plugin::MqttServer server;
  for (const Property& one : mqtt) {
    if (one.name == "host") server.host = one.value;
    if (one.name == "port") server.port = static_cast<int>(g_ascii_strtoll(one.value.c_str(), nullptr, 10));
    if (one.name == "username") server.user = one.value;
    if (one.name == "ca-file") server.ca_file = one.value;
    std::string error;
    if (one.name == "password-file") server.password = read_secret(one.value, error).value_or("");
    if (!error.empty()) g_printerr("cerberusd: %s: %s\n", what, error.c_str());
  }
  return server;
}

void RetiredTopics::take(const Settings& settings) {
  path_ = settings.state_folder + "/mqtt-topics";
  Topics before = topics_of(text::read_file(path_, kLongestList).text);
  present_ = retained_topics(settings);
  before.merge(retired_);  // those of which the list was not written
  retired_.clear();
  std::ranges::set_difference(before, present_, std::inserter(retired_, retired_.end()));
  before.insert(present_.begin(), present_.end());
  if (!before.empty()) keep(before);
  client_.stop();
  started_ = false;
  mqtt_ = settings.mqtt.value_or(Properties{});
  if (!retired_.empty() && !settings.mqtt)
    g_printerr(
        "cerberusd: MQTT: cameras that published before stay at their broker, because there is no [mqtt] any "
        "more: %zu topics\n",
        retired_.size());
}

void RetiredTopics::tick(bool quiet) {
  if (retired_.empty() || mqtt_.empty()) return;
  if (!started_) {
    if (!quiet) return;
    started_ = true;
    client_.start(
        broker_of(mqtt_, "MQTT"),
        {.on_command = {}, .on_message = {}, .on_fault = [](const std::string& fault) {
           g_printerr(
               "cerberusd: MQTT: what a camera left that was removed is cleared when the broker can be "
               "reached: %s\n",
               fault.c_str());
         }});
    for (const std::string& topic : retired_) client_.publish({topic, "", true});
    return;
  }
  if (!client_.is_settled()) return;
  client_.stop();
  started_ = false;
  retired_.clear();
  keep(present_);
  g_printerr("cerberusd: MQTT: what removed cameras or parts left at the broker is cleared\n");
}

void RetiredTopics::keep(const Topics& topics) const {
  const std::string text = text_of(topics);
  g_autoptr(GError) error = nullptr;
  if (!g_file_set_contents_full(path_.c_str(), text.data(), static_cast<gssize>(text.size()),
                                G_FILE_SET_CONTENTS_CONSISTENT, 0600, &error))
    g_printerr("cerberusd: a camera that is removed later will stay at the MQTT broker: %s\n",
               error->message);
}

}  // namespace cerberus::robot
