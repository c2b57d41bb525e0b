// SPDX-License-Identifier: LGPL-2.1-or-later
#include "patrol_settings.hpp"

#include <cerberus/truth.h>

#include "office.h"
#include "shared/clock_times.hpp"
#include "shared/pir_caps.hpp"
#include "shared/pir_presets.hpp"
#include "text/numbers.h"

namespace cerberus::plugin {
namespace {

GType lockstep_type() {
  static const GEnumValue values[] = {
      {LOCKSTEP_AUTO, "Where a pantiltsink of that name is downstream", "auto"},
      {LOCKSTEP_ON, "Every frame waits for its pose", "on"},
      {LOCKSTEP_OFF, "No frame waits", "off"},
      {0, nullptr, nullptr}};
  static const GType type = g_enum_register_static("CerberusPatrolSimLockstep", values);
  return type;
}

GType shake_kind_type() {
  static const GEnumValue values[] = {
      {static_cast<int>(sim::ShakeKind::robot),
       "A robot, at 1.5 to 8 Hz, wholly while it drives .6 m/s or turns 45 degrees a second, and not while "
       "it stands",
       "robot"},
      {static_cast<int>(sim::ShakeKind::hand),
       "A hand, at .5 to 3 Hz, always; hand-held videos shake by about .5 degrees", "hand"},
      {0, nullptr, nullptr}};
  static const GType type = g_enum_register_static("CerberusPatrolSimShakeKind", values);
  return type;
}

GType preset_type() {
  static const GType type = register_pir_presets("CerberusPatrolSimPirPreset");
  return type;
}

using S = PatrolSettings;

const Property<PatrolSettings> kProperties[] = {
    property("plan", &S::plan,
             "File of the floor plan (see the manual: simulation); empty = the office that comes along"),
    property("seed", &S::seed, 0, G_MAXINT,
             "Number from which textures, people, clothes, noise and warm things are made: equal seeds give "
             "equal bytes"),
    property("people", &S::people, 0, CERBERUS_TRUTH_MAX_PERSONS,
             "How many people walk about through all rooms, where `walks` is empty"),
    property(
        "walks", &S::walks,
        "What people do, steps separated by ';' and people by '|': 'at X Y; go X Y [SPEED]; wait SECONDS; "
        "gesture SECONDS', metres; repeated; empty = by the seed"),
    property("path", &S::path,
             "What the robot does, steps separated by ';': 'at X Y [HEADING]; go X Y [SPEED]; turn DEGREES; "
             "wait SECONDS'; repeated; empty = it goes round through all rooms and looks about in each"),
    property("speed", &S::speed, .05, 1.5, "How fast the robot drives, metres a second"),
    property("yaw-rate", &S::yaw_rate, 1, 60, "How fast the robot turns, degrees a second"),
    property("shake", &S::shake, 0, 5,
             "How much the camera shakes: RMS of each angle, degrees; 0 = not at all"),
    property("shake-kind", &S::shake_kind, shake_kind_type, "What shakes the camera, and when"),
    property("camera-height", &S::camera_height, .1, 3, "Height of the camera above the floor, metres"),
    property("horizontal-fov", &S::horizontal_fov, 10, 120,
             "Angle that the camera sees over the picture's width, degrees"),
    property(
        "exposure", &S::exposure,
        "Nanoseconds of the exposure of each picture, which blurs what moves, at most 30 ms; it ends at the "
        "picture's time"),
    property("noise", &S::noise, 0, 30, "Standard deviation of the sensor's noise, grey levels"),
    property("start-pan", &S::start_pan, -180, 180,
             "Pan of the camera until the first pose comes, degrees, positive to the right"),
    property("start-tilt", &S::start_tilt, -60, 60,
             "Tilt of the camera until the first pose comes, degrees, positive up"),
    property("head", &S::head, "Name of the head that turns the camera; empty = any"),
    property("lockstep", &S::lockstep, lockstep_type,
             "Whether a frame waits until the head's pose at its running time is known"),
    property(
        "lockstep-timeout", &S::lockstep_timeout,
        "Nanoseconds of real time without any pose after which a waiting frame ends in an error; 0 = wait "
        "for ever"),
    property(
        "pir-bearings", &S::pir_bearings,
        "Where each PIR sensor looks: degrees, separated by commas, 0 ahead, positive to the right. As many "
        "as there are sensors, 1 to 16"),
    property("pir-preset", &S::pir_preset, preset_type,
             "The module of the PIR sensors: its range, field of view, warm-up, hold and block times"),
    property("pir-field-of-view", &S::pir_field_of_view, 0, 180,
             "Angle in degrees that each PIR sensor sees; 0 = the preset's, 120 without one"),
    property(
        "pir-range", &S::pir_range, 0, 50,
        "How far each PIR sensor finds a person who crosses at 1 m/s, metres; 0 = the preset's, 12 without "
        "one. What begins higher than 1.5 m above the floor is seen within 3 m only"),
    property("camera-name", &S::camera_name,
             "Name of the camera, for the messages of the sensors; empty = none"),
    property("inset", &S::inset,
             "Attach the floor plan, small, to each frame: robot, view and people; motionoverlay draws it in "
             "the upper right corner"),
};

std::string plan_text(const std::string& file, std::string& wrong) {
  if (file.empty()) return kOffice;
  g_autofree gchar* text = nullptr;
  g_autoptr(GError) error = nullptr;
  gsize length = 0;
  if (g_file_get_contents(file.c_str(), &text, &length, &error)) return std::string(text, length);
  wrong = error->message;
  return {};
}

}  // namespace

std::span<const Property<PatrolSettings>> patrol_properties() {
  return kProperties;
}

std::string pir_info(const PatrolSettings& settings, CerberusPirInfo& info) {
  const sensing::PirPreset* preset = pir_preset(settings.pir_preset);
  double field = settings.pir_field_of_view;
  if (!(field > 0)) field = preset ? text::round_to(sensing::degrees(preset->field_of_view), 6) : 120;
  return pir_info(settings.pir_bearings, field, info);
}

double pir_range(const PatrolSettings& settings) {
  if (settings.pir_range > 0) return settings.pir_range;
  const sensing::PirPreset* preset = pir_preset(settings.pir_preset);
  return preset ? preset->range : sim::kPaperReach[0].distance;
}

sensing::PirOptions pir_options(const PatrolSettings& settings) {
  const sensing::PirPreset* preset = pir_preset(settings.pir_preset);
  return preset ? preset->options : sensing::PirOptions{};
}

std::variant<std::unique_ptr<sim::House>, std::string> build_house(const PatrolSettings& settings,
                                                                   const CerberusPirInfo& sensors, int width,
                                                                   int height) {
  std::string wrong;
  const std::string text = plan_text(settings.plan, wrong);
  if (!wrong.empty()) return "The floor plan cannot be read: " + wrong;
  auto plan = sim::read_floor_plan(text);
  if (const auto* fault = std::get_if<std::string>(&plan))
    return "The floor plan " + settings.plan + ": " + *fault + ".";
  sim::HouseSettings house;
  for (const auto& [words, mover, routes] : {std::tuple(&settings.path, sim::Mover::robot, &house.path),
                                             std::tuple(&settings.walks, sim::Mover::person, &house.walks)}) {
    auto read = sim::read_routes(*words, mover);
    if (const auto* fault = std::get_if<std::string>(&read))
      return std::string(mover == sim::Mover::robot ? "path" : "walks") + ": " + *fault + ".";
    *routes = std::get<std::vector<sim::Route>>(std::move(read));
  }
  if (house.walks.size() > CERBERUS_TRUTH_MAX_PERSONS)
    return "walks: there is room for " + std::to_string(CERBERUS_TRUTH_MAX_PERSONS) + " people.";
  constexpr guint64 kLongest = 30 * GST_MSECOND;
  house.seed = static_cast<std::uint32_t>(settings.seed);
  house.lens = {width, height, sensing::radians(settings.horizontal_fov), settings.noise};
  house.camera_height = settings.camera_height;
  house.exposure = time_of(std::min<guint64>(settings.exposure, kLongest));
  house.speed = settings.speed;
  house.yaw_rate = sensing::radians(settings.yaw_rate);
  house.shake = sensing::radians(settings.shake);
  house.shake_kind = static_cast<sim::ShakeKind>(settings.shake_kind);
  house.people = settings.people;
  house.pir = sim::pir_traits(pir_preset(settings.pir_preset), sensing::radians(sensors.field_of_view),
                              pir_range(settings));
  for (guint i = 0; i < sensors.sensors; ++i)
    house.pir_bearings.push_back(sensing::radians(sensors.bearings[i]));
  auto built = sim::House::build(std::get<sim::FloorPlan>(std::move(plan)), house);
  if (const auto* fault = std::get_if<std::string>(&built)) return "In this house: " + *fault + ".";
  return built;
}

}  // namespace cerberus::plugin
