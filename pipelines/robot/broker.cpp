// SPDX-License-Identifier: LGPL-2.1-or-later
#include "broker.h"

#include <glib.h>

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
  if (all_.empty()) all_ = left_topics_of(text::read_file(path_, kLongestList).text);
  settings_ = settings;
  all_ = with_present(std::move(all_), settings);
  retired_ = retired_topics(all_, settings);
  if (!all_.empty()) keep();
  client_.stop();
  started_ = false;
  deadline_ = std::chrono::steady_clock::now() + kPatience;
}

void RetiredTopics::start() {
  const LeftTopics& one = retired_.front();
  const std::string host = broker_of(one.broker, "MQTT").host;
  client_.start(broker_of(one.broker, "MQTT"),
                {.on_command = {}, .on_message = {}, .on_fault = [host](const std::string& fault) {
                   g_printerr(
                       "cerberusd: MQTT: what was left at the broker %s is cleared when it can be reached: "
                       "%s\n",
                       host.c_str(), fault.c_str());
                 }});
  for (const std::string& topic : one.topics) client_.publish({topic, "", true});
}

void RetiredTopics::tick(bool quiet) {
  if (retired_.empty()) return;
  const Properties broker = retired_.front().broker;
  const std::string host = broker_of(broker, "MQTT").host;
  const bool is_present = settings_.mqtt && broker == broker_properties(*settings_.mqtt);
  const bool too_late = broker.empty() || (!is_present && std::chrono::steady_clock::now() > deadline_);
  if (!started_ && !too_late) {
    if (!quiet) return;
    started_ = true;
    return start();
  }
  if (!too_late && !client_.is_settled()) return;
  client_.stop();
  started_ = false;
  retired_.erase(retired_.begin());
  std::erase_if(all_, [&](const LeftTopics& one) { return one.broker == broker; });
  all_ = with_present(std::move(all_), settings_);
  keep();
  if (too_late)
    g_printerr("cerberusd: MQTT: the broker %s does not answer: what cameras left there stays\n",
               host.c_str());
  else
    g_printerr("cerberusd: MQTT: what removed cameras or parts left at the broker%s is cleared\n",
               is_present ? "" : (' ' + host).c_str());
}

void RetiredTopics::keep() const {
  const std::string text = text_of(all_);
  g_autoptr(GError) error = nullptr;
  if (!g_file_set_contents_full(path_.c_str(), text.data(), static_cast<gssize>(text.size()),
                                G_FILE_SET_CONTENTS_CONSISTENT, 0600, &error))
    g_printerr("cerberusd: a camera that is removed later will stay at the MQTT broker: %s\n",
               error->message);
}

}  // namespace cerberus::robot
