// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/scenes.h"

#include <cmath>
#include <random>

#include "sensing/angles.h"
#include "sim/shuttle.h"

namespace cerberus::sim {

using sensing::radians;

namespace {

// On a line `distance` metres away. phase: where it begins, of half the line.
std::function<double(double)> walker(double distance, double speed, double acceleration, double phase) {
  const double half = distance * std::tan(radians(60));
  const Shuttle line(2 * half, speed, acceleration);
  const double begin = line.passes(half * (1 + phase));
  return [=](double t) { return std::atan2(line.at(t + begin) - half, distance); };
}

// On an arc of that radius, to and fro between straight ahead and `angle`.
std::function<double(double)> arc_walker(double radius, double angle, double speed, double acceleration) {
  const Shuttle arc(radius * angle, speed, acceleration);
  return [=](double t) { return arc.at(t) / radius; };
}

std::function<double(double)> standing(double bearing) {
  return [=](double) { return bearing; };
}

}  // namespace

Scene scene(const std::string& name, unsigned seed) {
  std::mt19937 random(seed);
  const auto between = [&](double from, double to) {
    return std::uniform_real_distribution<>(from, to)(random);
  };
  const double phase = between(-.25, .25), distance = between(3, 8);
  Scene made;
  made.name = name;
  made.person = standing(radians(between(-20, 20)));
  if (name == "mix") made.person = walker(distance, 1.4, 1.5, phase);
  if (name == "near") made.person = walker(3, 1.4, 1.5, phase);
  if (name == "far") made.person = walker(8, 1.4, 1.5, phase);
  if (name == "run") made.person = walker(4, 4, 3, phase);
  if (name == "wander") made.wander = .3;
  made.asks = name == "turned";
  if (name == "behind" || name == "turned") made.person = arc_walker(distance, radians(250), 1.4, 1.5);
  if (name == "zoom") {
    // On a line that leads by at 1.5 m at most, so that the bearing changes, too. Nearer than 7 m the widest view is too long.
    const Shuttle line(18, 1.4, 1.5, 5);
    const double side = between(-1.5, 1.5);
    made.distance = [=](double t) { return std::hypot(25 - line.at(t), side); };
    made.person = [=](double t) { return std::atan2(side, 25 - line.at(t)); };
    made.hidden = [](double t) { return std::fmod(t, 15) > 12; };
    made.length = 90;
  }
  if (name == "step") {
    made.person = standing(radians(100));
    made.sector = true;
    made.length = 12;
    made.skip = 8;
  }
  if (name == "gyro" || name == "nogyro" || name == "picture") {
    made.person = standing(radians(between(20, 60)));
    const Shuttle turning(radians(90), radians(45), radians(90), 2);
    made.base = [turning](double t) { return turning.at(t); };
    made.length = 56;
    if (name == "nogyro") made.report = BaseReport::none;
    if (name == "picture") made.report = BaseReport::from_picture;
  }
  return made;
}

}  // namespace cerberus::sim
