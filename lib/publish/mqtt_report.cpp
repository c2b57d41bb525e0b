// SPDX-License-Identifier: LGPL-2.1-or-later
#include "publish/mqtt_report.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "text/json_line.h"
#include "text/utc.h"

namespace cerberus::publish {

namespace {

using text::JsonLine;

struct Order {
  std::string_view name;
  int arguments;
};
constexpr std::array<Order, 10> kOrders{{{"move-to", 2},
                                         {"move-by", 2},
                                         {"stop", 0},
                                         {"home", 0},
                                         {"auto", 0},
                                         {"follow", 1},
                                         {"arm", 0},
                                         {"disarm", 0},
                                         {"privacy", 0},
                                         {"picture", 0}}};

// A full turn. What is beyond it is a mistake, where a limit of the head would make a turn of it.
constexpr double kMostDegrees = 360;

// Without the newline.
std::string text_of(JsonLine& line) {
  std::string_view text = line.finish();
  text.remove_suffix(1);
  return std::string(text);
}

void write_object(JsonLine& line, const MqttObject& object) {
  line.key("id").integer(object.id).key("type").text(object.type).key("kind").text(object.kind);
  line.key("state").text(object.state);
  line.key("x").fixed(object.x, 1).key("y").fixed(object.y, 1);
  line.key("w").fixed(object.width, 1).key("h").fixed(object.height, 1);
  line.key("confidence").fixed(object.confidence, 3);
  line.key("bearing").fixed(object.bearing, 2).key("distance").fixed(object.distance, 2);
  line.key("witnesses").open('[');
  if (object.motion) line.string("motion");
  if (object.person) line.string("person");
  line.close(']');
}

std::string object_text(const MqttObject& object) {
  JsonLine line;
  line.open('{');
  write_object(line, object);
  line.close('}');
  const std::string text = text_of(line);
  return text.substr(1, text.size() - 2);
}

std::string track_text(std::string_view event, const std::optional<std::chrono::nanoseconds>& utc,
                       std::string_view object) {
  std::string text = "{\"event\":\"";
  text.append(event).append("\",\"utc\":");
  if (utc)
    text.append("\"").append(std::string_view(text::Utc(*utc))).append("\"");
  else
    text.append("null");
  return text.append(",").append(object).append("}");
}

// Takes one number off the front; blanks part numbers.
bool take_number(std::string_view& text, double& number) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  if (read.ec != std::errc() || !std::isfinite(number)) return false;
  text.remove_prefix(static_cast<std::size_t>(read.ptr - text.data()));
  return text.empty() || text.starts_with(' ');
}

}  // namespace

bool is_listed(std::string_view name, std::string_view list) {
  while (!list.empty()) {
    const std::size_t end = std::min(list.find_first_of(" ,"), list.size());
    if (list.substr(0, end) == name) return true;
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return false;
}

bool is_topic_level(std::string_view name) {
  return !name.empty() && name.find_first_of("/+#") == name.npos &&
         std::ranges::none_of(name, [](char c) { return c >= 0 && c < ' '; });
}

bool is_topic(std::string_view name) {
  for (std::size_t end = name.find('/'); end != name.npos; end = name.find('/')) {
    if (!is_topic_level(name.substr(0, end))) return false;
    name.remove_prefix(end + 1);
  }
  return is_topic_level(name);
}

std::string MqttReport::topic(std::string_view name) const {
  std::string whole = prefix_;
  return whole.append("/").append(camera_).append("/").append(name);
}

void MqttReport::once(std::string_view name, std::string payload, std::vector<MqttMessage>& out) {
  const auto found = last_.find(name);
  if (found != last_.end() && found->second == payload) return;
  last_.insert_or_assign(std::string(name), payload);
  out.push_back({topic(name), std::move(payload), true});
}

void MqttReport::tracks(const MqttFrame& frame, std::vector<MqttMessage>& out) {
  for (const MqttObject& object : frame.objects) {
    const auto [entry, is_new] = visits_.try_emplace(object.id);
    Visit& visit = entry->second;
    visit.seen = frame.time;
    visit.object = object_text(object);
    if (!is_new && frame.time - visit.reported < parameters_.update) continue;
    visit.reported = frame.time;
    out.push_back(
        {topic("track"), track_text(is_new ? "appeared" : "updated", frame.utc, visit.object), false});
  }
  for (auto entry = visits_.begin(); entry != visits_.end();) {
    // A time that falls back is another stream's: what was seen there has left.
    const bool gone = frame.time - entry->second.seen >= parameters_.left || frame.time < entry->second.seen;
    if (gone) out.push_back({topic("track"), track_text("left", frame.utc, entry->second.object), false});
    entry = gone ? visits_.erase(entry) : std::next(entry);
  }
}

std::vector<MqttMessage> MqttReport::begin() {
  std::vector<MqttMessage> out;
  state(out);
  return out;
}

void MqttReport::state(std::vector<MqttMessage>& out) {
  JsonLine line;
  line.open('{').key("motion").boolean(!visits_.empty()).key("objects").integer(visits_.size()).close('}');
  once("state", text_of(line), out);
}

void MqttReport::head(std::vector<MqttMessage>& out) {
  JsonLine line;
  line.open('{').key("pan").fixed(head_->pan, 2).key("tilt").fixed(head_->tilt, 2);
  line.key("moving").boolean(head_->moving).close('}');
  once("pantilt", text_of(line), out);
}

std::vector<MqttMessage> MqttReport::update(const MqttFrame& frame) {
  std::vector<MqttMessage> out;
  if (arrival_) distance_ = std::min(frame.arrival - *arrival_, parameters_.longest_distance);
  arrival_ = frame.arrival;
  if (frame.analysed) {
    tracks(frame, out);
    state(out);
  }
  if (frame.head) {
    const bool rests = head_ && head_->moving && !frame.head->moving;
    const bool due =
        !head_ || rests || frame.time < head_reported_ || frame.time - head_reported_ >= parameters_.head;
    if (due) {
      head_ = frame.head;
      head_reported_ = frame.time;
      head(out);
    }
  }
  if (frame.decision) {
    JsonLine line;
    line.open('{').key("rule").integer(frame.decision->rule).key("name").text(frame.decision->name);
    line.key("action").text(frame.decision->action).key("target");
    if (frame.decision->target != 0)
      line.integer(frame.decision->target);
    else
      line.null();
    line.close('}');
    once("rule", text_of(line), out);
  }
  if (!frame.sensors.empty()) pir(frame.sensors, out);
  sensors_ = frame.sensors.size();
  return out;
}

void MqttReport::pir(std::span<const std::uint8_t> readings, std::vector<MqttMessage>& out) {
  JsonLine line;
  line.open('{').key("sensors").open('[');
  for (const std::uint8_t reading : readings) line.integer(static_cast<int>(reading));
  line.close(']').close('}');
  once("pir", text_of(line), out);
}

// What was published of the last frame is true no more, and stays at the broker.
std::vector<MqttMessage> MqttReport::end() {
  std::vector<MqttMessage> out = fall_silent();
  arrival_.reset();
  distance_ = std::chrono::nanoseconds::zero();
  return out;
}

std::vector<MqttMessage> MqttReport::fall_silent() {
  std::vector<MqttMessage> out;
  for (const auto& [id, visit] : std::exchange(visits_, {}))
    out.push_back({topic("track"), track_text("left", std::nullopt, visit.object), false});
  if (last_.contains("state")) state(out);
  if (head_ && head_->moving) {
    head_->moving = false;
    head(out);
  }
  constexpr std::uint8_t kInvalid = 2;
  if (sensors_ > 0) pir(std::vector<std::uint8_t>(sensors_, kInvalid), out);
  if (last_.contains("rule")) {
    JsonLine line;
    line.open('{').key("rule").null().key("name").string("").key("action").string("").key("target").null();
    line.close('}');
    once("rule", text_of(line), out);
  }
  return out;
}

// The distance of a stream's frames outlasts its silence: that of a slow camera is known when its next frame comes.
std::vector<MqttMessage> MqttReport::check(std::chrono::nanoseconds now) {
  if (!arrival_ || now - *arrival_ < parameters_.left + 2 * distance_) return {};
  return fall_silent();
}

std::vector<MqttMessage> MqttReport::discovery(std::string_view home_assistant,
                                               const MqttParts& parts) const {
  std::vector<MqttMessage> out;
  const std::string device = prefix_ + '_' + camera_;
  const auto add = [&](std::string_view component, std::string_view name, std::string_view source,
                       std::string_view value, std::string_view device_class, std::string_view unit) {
    JsonLine line;
    std::string identity = device;
    identity.append("_").append(name);
    line.open('{').key("name").text(name).key("unique_id").text(identity);
    line.key("state_topic").text(topic(source)).key("value_template").text(value);
    line.key("availability_topic").text(topic("status"));
    if (!device_class.empty()) line.key("device_class").text(device_class);
    if (!unit.empty()) line.key("unit_of_measurement").text(unit);
    if (component == "binary_sensor") line.key("payload_on").string("ON").key("payload_off").string("OFF");
    line.key("device").open('{').key("identifiers").open('[').text(device).close(']');
    line.key("name").text(camera_).key("manufacturer").string("Cerberus").close('}').close('}');
    std::string where(home_assistant);
    where.append("/").append(component).append("/").append(device).append("/").append(name).append("/config");
    out.push_back({std::move(where), text_of(line), true});
  };
  add("binary_sensor", "motion", "state", "{{ 'ON' if value_json.motion else 'OFF' }}", "motion", "");
  add("sensor", "objects", "state", "{{ value_json.objects }}", "", "");
  add("sensor", "mode", "mode", "{{ value }}", "", "");
  if (parts.sensors > 0) add("sensor", "rule", "rule", "{{ value_json.name }}", "", "");
  for (std::size_t k = 0; k < parts.sensors; ++k) {
    const std::string number = std::to_string(k);
    std::string name = "pir_", value = "{{ 'ON' if value_json.sensors[";
    name += number;
    value.append(number).append("] == 1 else 'OFF' }}");
    add("binary_sensor", name, "pir", value, "motion", "");
  }
  if (parts.recorder) {
    add("binary_sensor", "recording", "recording", "{{ 'ON' if value_json.recording else 'OFF' }}", "running",
        "");
    add("binary_sensor", "recording_fault", "recording", "{{ 'ON' if value_json.fault else 'OFF' }}",
        "problem", "");
  }
  if (parts.head) {
    add("sensor", "pan", "pantilt", "{{ value_json.pan }}", "", "\u00b0");
    add("sensor", "tilt", "pantilt", "{{ value_json.tilt }}", "", "\u00b0");
  }
  return out;
}

std::vector<MqttMessage> MqttReport::discovery_of(const MqttFrame& frame, std::string_view home_assistant,
                                                  bool recorder) {
  const MqttParts now{frame.sensors.size(), frame.head.has_value(), recorder};
  if (announced_ == now) return {};
  announced_ = now;
  return discovery(home_assistant, now);
}

std::vector<std::string> MqttReport::retained_topics(std::string_view home_assistant,
                                                     const MqttParts& parts) const {
  std::vector<std::string> all;
  for (const char* name : {"status", "mode", "state", "rule"}) all.push_back(topic(name));
  if (parts.sensors > 0) all.push_back(topic("pir"));
  if (parts.head) all.push_back(topic("pantilt"));
  if (parts.recorder)
    for (const char* name : {"event", "recording"}) all.push_back(topic(name));
  if (!home_assistant.empty())
    for (MqttMessage& message : discovery(home_assistant, parts)) all.push_back(std::move(message.topic));
  return all;
}

std::optional<int> arguments_of(std::string_view name) {
  for (const Order& order : kOrders)
    if (order.name == name) return order.arguments;
  return std::nullopt;
}

std::optional<MqttCommand> parse_mqtt_command(std::string_view name, std::string_view payload,
                                              std::string_view allowed, std::string& error) {
  const std::optional<int> arguments = arguments_of(name);
  if (!arguments) {
    error = "there is no such command";
    return std::nullopt;
  }
  if (!is_listed(name, allowed)) {
    error = "it is not among those that are allowed";
    return std::nullopt;
  }
  MqttCommand command;
  command.name = name;
  bool good = payload.size() <= 64;
  if (good && *arguments > 0) good = take_number(payload, command.first);
  if (good && *arguments > 1) good = take_number(payload, command.second);
  // Orders without numbers may carry any payload: home automation sends one always.
  if (good && *arguments > 0) good = payload.empty();
  if (good && name == "follow")
    good = command.first >= 1 && command.first <= 4294967295.0 && command.first == std::floor(command.first);
  if (good && *arguments == 2)
    good = std::abs(command.first) <= kMostDegrees && std::abs(command.second) <= kMostDegrees;
  if (!good) {
    error = *arguments == 2   ? "its payload is pan and tilt in degrees, from -360 to 360: 10 -5"
            : *arguments == 1 ? "its payload is the number of a track, from 1"
                              : "its payload is too long";
    return std::nullopt;
  }
  return command;
}

}  // namespace cerberus::publish
