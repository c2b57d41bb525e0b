// SPDX-License-Identifier: LGPL-2.1-or-later
// A robot on its patrol through a house with people: what its camera takes, what its PIR sensors do, and the truth. The
// same settings give the same pictures. Metres, seconds, radians; bearings and headings clockwise.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "sim/house/driven_base.h"
#include "sim/house/house_camera.h"
#include "sim/house/routes.h"
#include "sim/house/walker.h"
#include "sim/house/ways.h"
#include "sim/pir_sensor.h"

namespace cerberus::sim {

// What carries the camera. A robot shakes it while it moves, at 1.5 to 8 Hz (assumed). A hand always, at .5 to 3 Hz; measured on
// four hand-held indoor sequences: .4 to .85 degrees to the sides and .2 to .5 up and down within a second.
enum class ShakeKind { robot, hand };

struct HouseSettings {
  std::uint32_t seed = 1;
  Lens lens;
  double camera_height = .8;
  Time exposure = std::chrono::milliseconds(10);
  double speed = .6;                       // of the base, a second
  double yaw_rate = sensing::radians(45);  // of the base, a second
  double shake = 0;                        // RMS of each of the camera's angles
  ShakeKind shake_kind = ShakeKind::robot;
  std::vector<Route> path;   // of the base, one; none: it patrols all rooms
  std::vector<Route> walks;  // of people; none: `people` of them, by the seed
  int people = 2;
  PirTraits pir;
  std::vector<double> pir_bearings;
};

struct Gaze {
  double pan = 0, tilt = 0;
};

struct PirEdge {
  Time time{};
  int sensor = 0;
  bool high = false;
};

class House {
 public:
  // What is wrong with the settings, if something is: a sentence without its point.
  static std::variant<std::unique_ptr<House>, std::string> build(FloorPlan plan,
                                                                 const HouseSettings& settings);

  // The picture whose exposure ends at `time`; gaze: where the head looks at a time during the exposure. Y, U and V
  // planes without padding.
  void take(Time time, const std::function<Gaze(Time)>& gaze, std::vector<std::uint8_t>& i420);
  // Of the last picture: one a person, hidden ones too.
  const std::vector<PersonTruth>& people() const { return camera_.truth(); }
  const DrivenBase& base() const { return base_; }
  const FloorPlan& plan() const { return camera_.plan(); }
  // Since the picture before, oldest first; the level that each sensor begins with is low.
  const std::vector<PirEdge>& pir_edges() const { return edges_; }

 private:
  struct Person {
    Walker walker;
    Clothes clothes;
  };
  struct Thing {  // that is warmer or colder than the wall behind it, and stands
    Spot at;
    double width, contrast;
  };
  House(FloorPlan plan, const HouseSettings& settings, DrivenBase base);

  void elapse(Time now);
  void keep_off(Person& person, const Spot& before) const;
  void step_aside();
  void see_progress();
  void heed_people();
  void sense(Time now);
  Pose pose(Time now, const Gaze& gaze) const;

  HouseSettings settings_;
  HouseCamera camera_;
  Ways room_to_step_;  // with a person's clearance at the least
  DrivenBase base_;
  std::vector<Person> people_;
  std::vector<Thing> things_;
  std::vector<PirSensor> sensors_;
  std::vector<Warmth> seen_;
  std::vector<PirEdge> edges_;
  std::vector<HouseCamera::Subject> subjects_;
  std::vector<Shake> shakes_;  // yaw, pitch, roll
  Time stepped_{};
};

}  // namespace cerberus::sim
