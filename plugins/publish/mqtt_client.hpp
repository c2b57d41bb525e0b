// SPDX-License-Identifier: LGPL-2.1-or-later
// A connection to an MQTT broker, in a thread of its own: tried again for ever, with a last will. Retained messages are
// kept and sent anew at every connection; others are dropped while there is none.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "publish/mqtt_report.h"

namespace cerberus::plugin {

struct MqttServer {
  std::string host;
  int port = 1883;
  std::string user, password;
  std::string ca_file;              // empty: no TLS
  std::string client;               // identity; empty: the library's choice
  std::string status;               // topic of `online`, and as last will `offline`; empty: none
  std::string commands;             // "cerberus/front/command/": what is subscribed; empty: nothing
  std::vector<std::string> topics;  // further subscriptions, "+" and "#" allowed: on_message receives them
};

class MqttClient {
 public:
  // All in the client's thread.
  struct Listener {
    std::function<void(const std::string& name, const std::string& payload)> on_command;
    std::function<void(const std::string& topic, std::string payload)> on_message;
    std::function<void(const std::string& fault)> on_fault;  // once for each loss of the connection
  };

  MqttClient();
  ~MqttClient();
  MqttClient(const MqttClient&) = delete;
  MqttClient& operator=(const MqttClient&) = delete;

  void start(const MqttServer& server, Listener listener);
  void publish(publish::MqttMessage message);
  // Whether the broker has taken everything that was published.
  bool is_settled() const;
  // Says `offline` and disconnects. Waits two seconds at most: an attempt to connect may take longer, and then ends in
  // its own time. No call of the listener follows.
  void stop();

 private:
  class Connection;
  mutable std::mutex lock_;  // of the pointer: publish() is called in any thread
  std::shared_ptr<Connection> connection_;
};

}  // namespace cerberus::plugin
