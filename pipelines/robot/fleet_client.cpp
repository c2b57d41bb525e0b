// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fleet_client.h"

#include <glib.h>

#include <atomic>
#include <utility>

#include "broker.h"

namespace cerberus::robot {

namespace {

// Bytes that wait for the main loop at most: what 500 cameras retain is a quarter of it.
constexpr std::size_t kMostWaiting = 16u << 20;

struct Arrived {
  std::shared_ptr<publish::Fleet> fleet;
  std::shared_ptr<std::atomic<std::size_t>> waiting;
  std::string topic, payload;
  std::size_t size = sizeof(Arrived) + topic.size() + payload.size();

  ~Arrived() { *waiting -= size; }
};

plugin::MqttServer server_of(const Properties& mqtt, std::string& prefix) {
  plugin::MqttServer server = broker_of(mqtt, "the list of cameras");
  for (const Property& one : mqtt)
    if (one.name == "topic-prefix") prefix = one.value;
  for (const std::string_view topic : publish::Fleet::kTopics)
    server.topics.push_back(prefix + "/+/" + std::string(topic));
  return server;
}

}  // namespace

FleetClient::FleetClient(const Properties& mqtt) {
  std::string prefix = "cerberus";
  const plugin::MqttServer server = server_of(mqtt, prefix);
  fleet_ = std::make_shared<publish::Fleet>(prefix);
  client_.start(server, {.on_command = {},
                         .on_message =
                             [fleet = fleet_, waiting = std::make_shared<std::atomic<std::size_t>>(0)](
                                 const std::string& topic, std::string payload) {
                               const bool picture = topic.ends_with("/picture");
                               if (!g_utf8_validate_len(topic.data(), topic.size(), nullptr)) return;
                               if (!picture && !g_utf8_validate_len(payload.data(), payload.size(), nullptr))
                                 return;
                               if (!picture && payload.size() > publish::Fleet::kLongestText) return;
                               if (*waiting > kMostWaiting) return;
                               auto* arrived = new Arrived{fleet, waiting, topic, std::move(payload)};
                               *waiting += arrived->size;
                               g_main_context_invoke_full(
                                   nullptr, G_PRIORITY_DEFAULT,
                                   [](gpointer data) {
                                     auto& arrived = *static_cast<Arrived*>(data);
                                     arrived.fleet->take(arrived.topic, std::move(arrived.payload),
                                                         std::chrono::steady_clock::now());
                                     return static_cast<gboolean>(G_SOURCE_REMOVE);
                                   },
                                   arrived, [](gpointer data) { delete static_cast<Arrived*>(data); });
                             },
                         .on_fault =
                             [](const std::string& fault) {
                               g_printerr(
                                   "cerberusd: the list of cameras: the broker cannot be reached: %s\n",
                                   fault.c_str());
                             }});
}

FleetClient::~FleetClient() {
  client_.stop();
}

bool FleetClient::ask_for_picture(const std::string& camera) {
  if (!fleet_->ask(camera, std::chrono::steady_clock::now())) return false;
  client_.publish({fleet_->prefix() + '/' + camera + "/command/picture", "", false});
  return true;
}

}  // namespace cerberus::robot
