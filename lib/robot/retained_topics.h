// SPDX-License-Identifier: LGPL-2.1-or-later
// What the cameras of a configuration leave at an MQTT broker for ever: a camera that leaves the configuration takes it with
// it, as do a head, sensors, a recorder, another prefix and another broker.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "robot/settings.h"

namespace cerberus::robot {

using Topics = std::set<std::string, std::less<>>;

// Every topic that the cameras may leave retained; none without [mqtt].
Topics retained_topics(const Settings& settings);

// The properties of [mqtt] that lead to its broker: an address, and names of files rather than what is in them.
Properties broker_properties(const Properties& mqtt);

// What was left at one broker.
struct LeftTopics {
  Properties broker;  // broker_properties(); empty: not known, because an older version wrote the list
  Topics topics;
};

// `before`, and what the cameras of `settings` may leave from now on: one entry a broker.
std::vector<LeftTopics> with_present(std::vector<LeftTopics> before, const Settings& settings);
// What of that these cameras do not publish: all of it at another broker than theirs.
std::vector<LeftTopics> retired_topics(const std::vector<LeftTopics>& all, const Settings& settings);

// The text of a file that keeps them, a broker or a topic a line.
std::string text_of(const std::vector<LeftTopics>& all);
std::vector<LeftTopics> left_topics_of(std::string_view text);

}  // namespace cerberus::robot
