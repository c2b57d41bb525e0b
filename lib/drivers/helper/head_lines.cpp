// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/helper/head_lines.h"

#include <charconv>
#include <cmath>
#include <initializer_list>
#include <system_error>

#include "sensing/angles.h"
#include "text/numbers.h"

namespace cerberus::drivers {
namespace {

using motion::AxisCommand;
using sensing::degrees;
using sensing::radians;

constexpr double kMostDegrees = 1e6;  // beyond it no head turns
constexpr int kDecimals = 4;          // of degrees: a tenth of an arc second

void append(std::string& line, double value) {
  line += ' ';
  line += text::rounded(value, kDecimals).string_view();
}

void append_angles(std::string& line, std::string_view word, std::initializer_list<double> angles) {
  line += word;
  for (const double angle : angles) append(line, degrees(angle));
}

void append_command(std::string& line, const AxisCommand& command) {
  const bool number = std::isfinite(command.value) && std::isfinite(command.speed);
  if (command.kind == AxisCommand::Kind::hold || !number)
    line += " hold";
  else if (command.kind == AxisCommand::Kind::position)
    append_angles(line, " to", {command.value, command.speed});
  else
    append_angles(line, " at", {command.value});
}

void append_limits(std::string& line, const motion::Limits& limits) {
  append_angles(line, "limits", {limits.pan.from, limits.pan.to, limits.tilt.from, limits.tilt.to});
}

// Words of a line, one after the other; blanks between them.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}
  std::string_view next() {
    const std::size_t begin = rest_.find_first_not_of(' ');
    if (begin == std::string_view::npos) return rest_ = {};
    rest_.remove_prefix(begin);
    const std::string_view word = rest_.substr(0, rest_.find(' '));
    rest_.remove_prefix(word.size());
    return word;
  }
  std::optional<double> number() {
    const std::string_view word = next();
    double value = 0;
    const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || read.ec != std::errc() || read.ptr != word.data() + word.size()) return std::nullopt;
    if (!(std::abs(value) <= kMostDegrees)) return std::nullopt;
    return value;
  }
  std::string rest() const {
    const std::size_t begin = rest_.find_first_not_of(' ');
    return begin == std::string_view::npos ? std::string() : std::string(rest_.substr(begin));
  }

 private:
  std::string_view rest_;
};

std::optional<HelperLine> parse_ready(Words words) {
  if (words.number() != kHeadProtocol) return std::nullopt;
  ReadyLine ready;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (word == "position") ready.abilities.position = true;
    if (word == "velocity") ready.abilities.velocity = true;
    if (word == "feedback") ready.abilities.feedback = true;
    if (word == "home") ready.abilities.home = true;
    if (word == kAlive) ready.abilities.alive = true;
    if (word == "zoom") ready.abilities.zoom = true;
    if (word != "rate") continue;
    const std::optional<double> rate = words.number();
    if (!rate || *rate < 1 || *rate > 1000) return std::nullopt;
    ready.abilities.rate = *rate;
  }
  if (!ready.abilities.position && !ready.abilities.velocity) return std::nullopt;
  return ready;
}

std::optional<HelperLine> parse_pose(Words words) {
  const auto pan = words.number(), tilt = words.number(), pan_speed = words.number(),
             tilt_speed = words.number(), age = words.number();
  if (!pan || !tilt || !pan_speed || !tilt_speed || !age || *age < 0 || !words.next().empty())
    return std::nullopt;
  return PoseLine{{radians(*pan), radians(*pan_speed), 0}, {radians(*tilt), radians(*tilt_speed), 0}, *age};
}

std::optional<HelperLine> parse_speeds(Words words) {
  const auto pan = words.number(), tilt = words.number(), age = words.number();
  if (!pan || !tilt || !age || *age < 0 || !words.next().empty()) return std::nullopt;
  return SpeedsLine{{radians(*pan), radians(*tilt)}, *age};
}

std::optional<HelperLine> parse_homed(Words words) {
  const auto pan = words.number(), tilt = words.number();
  if (!pan || !tilt || !words.next().empty()) return std::nullopt;
  return HomedLine{{radians(*pan), radians(*tilt)}};
}

std::optional<ZoomLine> parse_zoom(Words& words) {
  const auto position = words.number();
  if (!position || *position < 0 || *position > motion::kMostZoom || !words.next().empty())
    return std::nullopt;
  return ZoomLine{*position};
}

std::optional<motion::Limits> parse_stops(Words& words, motion::Limits limits = {}) {
  for (double* stop : {&limits.pan.from, &limits.pan.to, &limits.tilt.from, &limits.tilt.to}) {
    const auto angle = words.number();
    if (!angle) return std::nullopt;
    *stop = radians(*angle);
  }
  return limits;
}

bool parse_pair(Words& words, std::string_view name, double& pan, double& tilt) {
  if (words.next() != name) return false;
  const auto first = words.number(), second = words.number();
  if (!first || !second) return false;
  pan = radians(*first);
  tilt = radians(*second);
  return true;
}

std::optional<PipelineLine> parse_hello(Words words) {
  HelloLine hello;
  if (words.number() != kHeadProtocol || words.next() != "timeout") return std::nullopt;
  const auto timeout = words.number();
  if (!timeout || *timeout < 1e-3 || *timeout > 10 || words.next() != "limits") return std::nullopt;
  const auto stops = parse_stops(words);
  if (!stops) return std::nullopt;
  motion::Limits& limits = hello.setup.limits = *stops;
  if (!parse_pair(words, "speed", limits.pan.speed, limits.tilt.speed) ||
      !parse_pair(words, "acceleration", limits.pan.acceleration, limits.tilt.acceleration) ||
      !parse_pair(words, "start", hello.setup.pan, hello.setup.tilt) || !motion::check(limits).empty())
    return std::nullopt;
  hello.setup.helper_timeout = Time(static_cast<Time::rep>(*timeout * 1e9));
  return hello;
}

std::optional<AxisCommand> parse_command(Words& words) {
  const std::string_view word = words.next();
  if (word == "hold") return AxisCommand{};
  if (word != "to" && word != "at") return std::nullopt;
  const auto value = words.number();
  if (!value) return std::nullopt;
  if (word == "at") return AxisCommand{AxisCommand::Kind::velocity, radians(*value), 0};
  const auto speed = words.number();
  if (!speed || *speed < 0) return std::nullopt;
  return AxisCommand{AxisCommand::Kind::position, radians(*value), radians(*speed)};
}

}  // namespace

std::string ready_line(const HeadAbilities& abilities) {
  std::string line = "ready " + std::to_string(kHeadProtocol);
  if (abilities.position) line += " position";
  if (abilities.velocity) line += " velocity";
  if (abilities.feedback) line += " feedback";
  if (abilities.home) line += " home";
  if (abilities.alive) line.append(" ").append(kAlive);
  if (abilities.zoom) line += " zoom";
  line += " rate";
  append(line, abilities.rate);
  return line;
}

std::string pose_line(const PoseLine& pose) {
  std::string line;
  append_angles(line, "pose", {pose.pan.position, pose.tilt.position, pose.pan.speed, pose.tilt.speed});
  append(line, pose.age);
  return line;
}

std::string speeds_line(const SpeedsLine& speeds) {
  std::string line;
  append_angles(line, "speeds", {speeds.speed.pan, speeds.speed.tilt});
  append(line, speeds.age);
  return line;
}

std::string homed_line(const HomedLine& homed) {
  std::string line;
  append_angles(line, "homed", {homed.at.pan, homed.at.tilt});
  return line;
}

std::string zoom_line(const ZoomLine& zoom) {
  std::string line = "zoom";
  append(line, zoom.position);
  return line;
}

std::optional<PipelineLine> parse_pipeline_line(std::string_view text) {
  Words words(text);
  const std::string_view word = words.next();
  std::optional<PipelineLine> line;
  if (word == "cerberus-head") return parse_hello(words);
  if (word == "move") {
    const auto pan = parse_command(words);
    const auto tilt = pan ? parse_command(words) : std::nullopt;
    if (tilt) line = MoveLine{*pan, *tilt};
  } else if (word == "limits") {
    if (const auto limits = parse_stops(words);
        limits && limits->pan.from <= limits->pan.to && limits->tilt.from <= limits->tilt.to)
      line = LimitsLine{*limits};
  } else if (word == "home") {
    line = HomeLine{};
  } else if (word == "zoom") {
    if (const auto zoom = parse_zoom(words)) line = *zoom;
  } else if (word == kAlive) {
    line = AliveLine{};
  } else if (word == "stop") {
    line = StopLine{};
  } else if (word == "quit") {
    line = QuitLine{};
  }
  return words.next().empty() ? line : std::nullopt;
}

std::string hello_line(const HeadSetup& setup, Time timeout) {
  const motion::AxisLimits &pan = setup.limits.pan, &tilt = setup.limits.tilt;
  std::string line = "cerberus-head " + std::to_string(kHeadProtocol) + " timeout";
  append(line, motion::seconds(timeout));
  line += ' ';
  append_limits(line, setup.limits);
  append_angles(line, " speed", {pan.speed, tilt.speed});
  append_angles(line, " acceleration", {pan.acceleration, tilt.acceleration});
  append_angles(line, " start", {setup.pan, setup.tilt});
  return line += '\n';
}

std::string move_line(const AxisCommand& pan, const AxisCommand& tilt) {
  std::string line = "move";
  append_command(line, pan);
  append_command(line, tilt);
  return line += '\n';
}

std::string limits_line(const motion::Limits& limits) {
  std::string line;
  append_limits(line, limits);
  return line += '\n';
}

std::optional<HelperLine> parse_helper_line(std::string_view line) {
  Words words(line);
  const std::string_view word = words.next();
  if (word == "ready") return parse_ready(words);
  if (word == "pose") return parse_pose(words);
  if (word == "speeds") return parse_speeds(words);
  if (word == "zoom") return parse_zoom(words);
  if (word == "homed") return parse_homed(words);
  if (word == "fault" && !words.rest().empty()) return FaultLine{words.rest()};
  if (word == "recovered" && words.rest().empty()) return RecoveredLine{};
  if (word == kAlive && words.rest().empty()) return AliveLine{};
  if (word == "emergency") {
    const std::string state = words.rest();
    if (state == "pressed" || state == "released") return EmergencyLine{state == "pressed"};
    return std::nullopt;
  }
  if (word == "stopped") return StoppedLine{words.rest()};
  return std::nullopt;
}

}  // namespace cerberus::drivers
