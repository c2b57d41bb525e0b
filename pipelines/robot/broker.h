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

// Clears what cameras that are no longer in the configuration left at the broker: the state folder keeps a list of all
// topics until the broker has taken them back. Main loop's thread.
class RetiredTopics {
 public:
  // Takes a configuration, the first one or another.
  void take(const Settings& settings);
  // Once a second. `quiet`: no camera is stopping, which would publish once more.
  void tick(bool quiet);

 private:
  void keep(const Topics& topics) const;

  std::string path_;
  Properties mqtt_;
  Topics present_, retired_;
  plugin::MqttClient client_;
  bool started_ = false;
};

}  // namespace cerberus::robot
#endif
