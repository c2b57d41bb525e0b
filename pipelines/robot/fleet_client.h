// SPDX-License-Identifier: LGPL-2.1-or-later
// Listens to what other robots publish to the broker. Main loop's thread.
#pragma once

#if HAVE_MQTT
#include <memory>
#include <string>

#include "publish/fleet.h"
#include "publish/mqtt_client.hpp"
#include "robot/settings.h"

namespace cerberus::robot {

class FleetClient {
 public:
  // `mqtt`: properties of mqttpublish. A broker that cannot be reached is tried again for ever.
  explicit FleetClient(const Properties& mqtt);
  ~FleetClient();
  FleetClient(const FleetClient&) = delete;
  FleetClient& operator=(const FleetClient&) = delete;

  const publish::Fleet& fleet() const { return *fleet_; }
  // Its picture arrives later, where its `commands` allow it. False: the broker knows no such camera.
  bool ask_for_picture(const std::string& camera);

 private:
  // Messages that are on their way to the main loop may outlive this.
  std::shared_ptr<publish::Fleet> fleet_;
  plugin::MqttClient client_;
};

}  // namespace cerberus::robot
#endif
