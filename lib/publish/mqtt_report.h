// SPDX-License-Identifier: LGPL-2.1-or-later
// What one camera publishes by MQTT: topics and JSON payloads out of the facts of its frames, each when it changed.
// docs/manual/mqtt.md lists them.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cerberus::publish {

struct MqttMessage {
  std::string topic, payload;
  bool retain = false;
};

struct MqttObject {
  std::uint32_t id = 0;  // of its track
  std::string_view type, kind, state;
  double x = 0, y = 0, width = 0, height = 0;        // pixels
  double confidence = 0, bearing = 0, distance = 0;  // NaN: not known
  bool motion = true, person = false;                // its witnesses
};

// What one frame carries; views are valid during the call.
struct MqttFrame {
  std::chrono::nanoseconds time{};              // running time
  std::chrono::nanoseconds arrival{};           // when it came, by a clock that never jumps
  std::optional<std::chrono::nanoseconds> utc;  // since 1970
  bool analysed = false;                        // a detector looked at it
  std::span<const MqttObject> objects;          // with a track
  struct Head {
    double pan = 0, tilt = 0;  // degrees
    bool moving = false;
  };
  std::optional<Head> head;
  struct Decision {
    int rule = 0;
    std::string_view name, action;
    std::uint32_t target = 0;  // 0: none
  };
  std::optional<Decision> decision;
  std::span<const std::uint8_t> sensors;  // 0 nothing, 1 detection, 2 invalid
};

// What a camera has beside its detection.
struct MqttParts {
  std::size_t sensors = 0;
  bool head = false;
  bool recorder = false;
  bool operator==(const MqttParts&) const = default;
};

// Whether a name can be one level of a topic.
bool is_topic_level(std::string_view name);
// Levels with / between them.
bool is_topic(std::string_view name);
// Whether a name is in a list whose entries are parted by blanks or commas.
bool is_listed(std::string_view name, std::string_view list);

class MqttReport {
 public:
  struct Parameters {
    std::chrono::nanoseconds update = std::chrono::seconds(1);  // between two `updated` of one track
    std::chrono::nanoseconds left = std::chrono::seconds(2);    // unseen for so long, a track has left
    std::chrono::nanoseconds head =
        std::chrono::milliseconds(500);  // between two reports of a head that moves
    // Frames that are further apart are those of a camera that was away. Chosen: several times the distance of the
    // slowest cameras.
    std::chrono::nanoseconds longest_distance = std::chrono::seconds(10);
  };

  // `prefix`: "cerberus"; `camera`: one level of a topic.
  MqttReport(std::string prefix, std::string camera)
      : prefix_(std::move(prefix)), camera_(std::move(camera)) {}

  // Before the first frame: nothing moves, whatever a process of before left at the broker.
  std::vector<MqttMessage> begin();
  // The messages that this frame causes.
  std::vector<MqttMessage> update(const MqttFrame& frame);
  // The stream ends: all tracks leave, nothing moves, no sensor is read and no rule holds.
  std::vector<MqttMessage> end();
  // The same where no frame has come for Parameters::left and twice the last distance of two frames. `now`: as
  // `arrival`; meant for every second.
  std::vector<MqttMessage> check(std::chrono::nanoseconds now);

  std::string topic(std::string_view name) const;  // "cerberus/front/status"
  // Retained messages by which Home Assistant finds the camera and its parts (MQTT discovery).
  std::vector<MqttMessage> discovery(std::string_view home_assistant, const MqttParts& parts) const;
  // The same for the sensors and the head of this frame; nothing where they are those of the call before.
  std::vector<MqttMessage> discovery_of(const MqttFrame& frame, std::string_view home_assistant,
                                        bool recorder);
  // Every topic that a camera with these parts may leave retained at the broker. `home_assistant`: empty: no discovery.
  std::vector<std::string> retained_topics(std::string_view home_assistant, const MqttParts& parts) const;

 private:
  struct Visit {
    std::string object;  // members of the last report, JSON
    std::chrono::nanoseconds seen{}, reported{};
  };
  void tracks(const MqttFrame& frame, std::vector<MqttMessage>& out);
  void state(std::vector<MqttMessage>& out);
  std::vector<MqttMessage> fall_silent();
  void head(std::vector<MqttMessage>& out);
  void pir(std::span<const std::uint8_t> readings, std::vector<MqttMessage>& out);
  void once(std::string_view name, std::string payload, std::vector<MqttMessage>& out);

  Parameters parameters_;
  std::string prefix_, camera_;
  std::map<std::uint32_t, Visit> visits_;
  std::map<std::string, std::string, std::less<>> last_;  // payload of each retained topic
  std::optional<MqttParts> announced_;
  std::optional<MqttFrame::Head> head_;
  std::chrono::nanoseconds head_reported_{};
  std::size_t sensors_ = 0;  // of the last frame
  std::optional<std::chrono::nanoseconds>
      arrival_;                          // of the last frame; nullopt: none came since the stream began
  std::chrono::nanoseconds distance_{};  // to the one before
};

// An order that arrived at PREFIX/CAMERA/command/NAME.
struct MqttCommand {
  std::string name;
  double first = 0, second = 0;  // move-to, move-by: pan, tilt in degrees; follow: the track
};
// How many numbers an order has; nullopt: there is none of this name.
std::optional<int> arguments_of(std::string_view name);
// `allowed`: names parted by blanks or commas. nullopt, and why, where it is refused.
std::optional<MqttCommand> parse_mqtt_command(std::string_view name, std::string_view payload,
                                              std::string_view allowed, std::string& error);

}  // namespace cerberus::publish
