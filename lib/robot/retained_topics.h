// SPDX-License-Identifier: LGPL-2.1-or-later
// What the cameras of a configuration leave at an MQTT broker for ever: a camera that leaves the configuration takes it with
// it, as do a head, sensors, a recorder and another prefix.
#pragma once

#include <set>
#include <string>
#include <string_view>

#include "robot/settings.h"

namespace cerberus::robot {

using Topics = std::set<std::string, std::less<>>;

// Every topic that the cameras may leave retained; none without [mqtt].
Topics retained_topics(const Settings& settings);

// The text of a file that keeps topics, one a line.
std::string text_of(const Topics& topics);
Topics topics_of(std::string_view text);

}  // namespace cerberus::robot
