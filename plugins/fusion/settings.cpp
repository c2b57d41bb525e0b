// SPDX-License-Identifier: LGPL-2.1-or-later
#include "settings.hpp"

#include "motion/head_limits.h"
#include "sensing/angles.h"
#include "shared/choices.hpp"
#include "shared/stamps.hpp"

namespace cerberus::plugin {
namespace {

GType rules_type() {
  static const GEnumValue values[] = {
      {RULES_COMPLETE, "Computed from the sensors' bearings, the lens and the head's limits", "complete"},
      {RULES_PAPER, "The seven rules of the paper, literally, for three sensors", "paper"},
      {0, nullptr, nullptr}};
  static const GType type = g_enum_register_static("CerberusFusionRules", values);
  return type;
}

GType target_type() {
  static const GType type = register_target_choice("CerberusFusionTarget");
  return type;
}

const Property<Settings> kTable[] = {
    property("rules", &Settings::rules, rules_type, "The rule set; rules-file goes before it"),
    property(
        "rules-file", &Settings::rules_file,
        "Path of a rule table of your own (TOML); empty = none. A table with a gap, a contradiction or a "
        "rule "
        "that never applies is refused; given while the element runs, the old rules and their path stay"),
    property("target", &Settings::target, target_type,
             "Which track to follow when none is followed yet; a followed track stays the target, but leaves "
             "it to a "
             "seen person of personverify where it only moves"),
    property(
        "return-delay", &Settings::return_delay,
        "Nanoseconds without any detection, from the first frame on, after which the head returns to zero; "
        "0 = at once. rules=paper has none"),
    property(
        "hold-stopped", &Settings::hold_stopped,
        "Nanoseconds for which a followed track that stopped is kept as the target at least; 0 = not at all. "
        "rules=paper has none"),
    property(
        "camera-hold", &Settings::camera_hold,
        "Nanoseconds for which the camera counts as having found a person after the last track; 0 = only "
        "while there is one. rules=paper has none"),
    property("hysteresis", &Settings::hysteresis, 0, 90,
             "Degrees by which pan must leave a sector or a band of angles before it counts as outside; 0 = "
             "edges are sharp. rules=paper has none"),
    property(
        "horizontal-fov", &Settings::horizontal_fov, 0, 179,
        "Angle in degrees that the lens sees over the frame's whole width: searches stop half of it before "
        "a sector's edge; 0 = not known, searches go to the edge. Where the head's pose says what its zoom "
        "sees, "
        "that counts instead"),
    property("pan-min", &Settings::pan_minimum, -3600, 3600, "Leftmost pan angle of the head in degrees"),
    property("pan-max", &Settings::pan_maximum, -3600, 3600, "Rightmost pan angle of the head in degrees"),
    property(
        "max-wait", &Settings::max_wait,
        "Nanoseconds of real time that a frame of a stream that is not live waits for a PIR pad, which is "
        "then warned of and not waited for until data comes; 0 = never wait"),
    property("lost-after", &Settings::lost_after,
             "Nanoseconds without data after which the sensors of a live PIR pad are invalid, with a "
             "warning, until "
             "data comes: several heartbeats of its source; 0 = never"),
    property("level-threshold", &Settings::level_threshold, -1000, 1000,
             "Volts above which a sensor detects, at PIR pads that receive volts (format=level); read with "
             "their caps"),
    property("level-hysteresis", &Settings::level_hysteresis, 0, 1000,
             "Volts between switching on and switching off, level-threshold in the middle; read with "
             "the caps"),
    property("head", &Settings::head, "Name of the head whose pose counts; empty = any"),
    property("camera-name", &Settings::camera_name, kCameraNameBlurb),
};

}  // namespace

const std::span<const Property<Settings>> kProperties = kTable;

std::string limits_fault(const Settings& settings) {
  motion::Limits limits;
  limits.pan.from = sensing::radians(settings.pan_minimum);
  limits.pan.to = sensing::radians(settings.pan_maximum);
  const std::string fault = motion::check(limits);
  return fault.empty() ? fault : "No head has such limits: " + fault + ".";
}

fusion::FuserOptions fuser_options(const Settings& s, bool own_table) {
  const bool paper = !own_table && s.rules == RULES_PAPER;
  fusion::FuserOptions options;
  if (paper) options = fusion::paper_options();
  options.rules = paper || own_table ? fusion::RuleSet::table : fusion::RuleSet::complete;
  options.choice = static_cast<fusion::TargetChoice>(s.target);
  if (!paper) {
    options.camera_hold = time_of(s.camera_hold);
    options.hold_stopped = time_of(s.hold_stopped);
    options.return_delay = time_of(s.return_delay);
    options.hysteresis = sensing::radians(s.hysteresis);
  }
  options.lens = sensing::radians(s.horizontal_fov);
  options.limits = {sensing::radians(s.pan_minimum), sensing::radians(s.pan_maximum)};
  return options;
}

}  // namespace cerberus::plugin
