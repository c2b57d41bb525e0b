// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/patrols.h"

#include <cmath>
#include <numbers>
#include <random>

#include "sensing/angles.h"
#include "sim/shuttle.h"

namespace cerberus::sim {

using sensing::radians;

namespace {

constexpr double kPath = 40;  // metres, after which the things of a straight way repeat

double angle_of(double width, double distance) {
  return 2 * std::atan(width / 2 / distance);
}

// Walks at `speed` metres a second across the line of sight, and perhaps turns round every 4 s.
std::function<double(double)> walk(double speed, double distance, std::mt19937& random) {
  constexpr double kLeg = 4, kTurnsRound = .4;
  constexpr int kLegs = 32;
  std::bernoulli_distribution is_left(.5), turns(kTurnsRound);
  std::vector<double> ways;  // 1 or -1, of each leg
  double way = is_left(random) ? -1 : 1;
  for (int i = 0; i < kLegs; ++i) {
    ways.push_back(way);
    if (turns(random)) way = -way;
  }
  return [=](double t) {
    double angle = 0;
    for (std::size_t i = 0; t > 0 && i < ways.size(); ++i, t -= kLeg)
      angle += ways[i] * std::min(t, kLeg) * speed / distance;
    return angle;
  };
}

}  // namespace

void Patrol::look(double seconds, std::vector<Warmth>& seen) const {
  seen.clear();
  for (const Thing& thing : things) {
    double x = thing.x;
    if (speed != 0) x = std::remainder(thing.x - speed * seconds, kPath);
    const double away = std::hypot(x, thing.y);
    seen.push_back(
        {sensing::wrap(std::atan2(thing.y, x) - yaw(seconds)), angle_of(thing.width, away), thing.contrast});
  }
}

Warmth Patrol::person(double bearing) const {
  return {bearing, angle_of(width, distance), contrast};
}

Patrol patrol(const std::string& name, unsigned seed) {
  std::mt19937 random(seed);
  const auto between = [&](double from, double to) {
    return std::uniform_real_distribution<>(from, to)(random);
  };
  const auto side = [&] { return between(0, 1) < .5 ? -1 : 1; };
  Patrol made;
  made.name = name;
  made.comes = between(5, 14);  // at any moment of a patrol's period
  made.distance = between(2, 8);
  made.first = radians(between(40, 180));
  made.first *= side();
  const double walking = between(.5, 1.5);
  made.walked = walk(walking, made.distance, random);

  const bool drives = name == "drive" || name == "hall";
  if (!drives && name != "around") {
    const Shuttle turning(radians(90), radians(45), radians(90), 2);
    made.yaw = [turning](double t) { return turning.at(t); };
  }
  if (drives) made.speed = .5;
  // Radiators, windows, screens: a metre wide and 8 to 25 K from the wall.
  const auto add = [&](double x, double y) {
    const double contrast = between(8, 25);
    made.things.push_back({x, y, 1, contrast * side()});
  };
  if (drives)
    for (double x = 0; x < kPath; x += name == "hall" ? 4 : 8) {
      const double along = x + between(-1, 1), away = between(1.5, 4);
      add(along, away * side());
    }
  const int count = name == "warm" ? 8 : name == "cool" || drives ? 0 : 2;
  for (int i = 0; i < count; ++i) {
    const double bearing = 2 * std::numbers::pi * (i + between(0, 1)) / count;
    const double away = between(2, 5);
    add(away * std::cos(bearing), away * std::sin(bearing));
  }
  return made;
}

}  // namespace cerberus::sim
