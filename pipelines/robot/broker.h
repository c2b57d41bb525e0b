// SPDX-License-Identifier: LGPL-2.1-or-later
// cerberusd's own connections to the broker of [mqtt].
#pragma once

#if HAVE_MQTT
#include <chrono>
#include <string>

#include "publish/mqtt_client.hpp"
#include "robot/retained_topics.h"

namespace cerberus::robot {

// `mqtt`: properties of mqttpublish. What cannot be read is reported for `what`.
plugin::MqttServer broker_of(const Properties& mqtt, const char* what);

// Clears what cameras that are no longer in the configuration left at the broker, and all of them at a broker that is not:
// the state folder keeps a list of all topics until their broker has taken them back. Main loop's thread.
class RetiredTopics {
 public:
  // Takes a configuration, the first one or another.
  void take(const Settings& settings);
  // Once a second. `quiet`: no camera is stopping, which would publish once more.
  void tick(bool quiet);

 private:
  // So long another broker than the present one is tried. Chosen: longer than a broker takes to start anew and a network
  // to come after the machine; after that it may be somebody else's.
  static constexpr std::chrono::minutes kPatience{5};

  void start();
  void keep() const;

  std::string path_;
  std::vector<LeftTopics> all_, retired_;  // the first of the latter is being cleared
  Settings settings_;                      // of which only the topics count
  plugin::MqttClient client_;
  std::chrono::steady_clock::time_point deadline_;
  bool started_ = false;
};

}  // namespace cerberus::robot
#endif
