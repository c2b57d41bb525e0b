// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/house/figure.h"

#include <algorithm>
#include <cmath>

#include "sim/house/textures.h"

namespace cerberus::sim {
namespace {

// Of a person 1.75 m tall and .48 m wide; all lengths scale with the height, widths do not.
constexpr double kTall = 1.75;
constexpr double kHip = .93, kThigh = .43, kShin = .42, kUpperArm = .29, kForearm = .25;
constexpr double kShoulder = 1.43, kBesideHip = .085, kBesideShoulder = .172;
constexpr double kRuns = 2.3;  // metres a second

struct Frame {  // of the person: ahead, to its right, up
  double x, y, cos, sin, scale, drop;
  Point at(double ahead, double right, double up) const {
    ahead *= scale;
    return {x + ahead * cos - right * sin, y + ahead * sin + right * cos, (up + drop) * scale};
  }
};

struct Joint {
  double ahead, up;
  // angle: ahead of straight down
  Joint along(double length, double angle) const {
    return {ahead + length * std::sin(angle), up - length * std::cos(angle)};
  }
};

}  // namespace

Clothes clothes_of(std::uint32_t seed) {
  const auto even = [&](std::uint32_t what, double from, double to) {
    return from + (to - from) * (scramble(seed, what) / 4294967296.);
  };
  Clothes made;
  made.seed = seed;
  made.grey = {even(0, 110, 185), even(1, 25, 110), even(2, 20, 225), even(3, 25, 170), even(4, 20, 90)};
  if (even(5, 0, 1) < .25) made.stripes = even(6, 15, 45);
  return made;
}

Body body_of(const Stance& stance, double height) {
  const double scale = height / kTall, speed = stance.speed;
  const bool runs = speed > kRuns;
  const double leg = kThigh + kShin;
  // The step's chord between both feet: 2 leg sin(swing). While it runs, a part of the step is flight.
  const double swing = std::asin(std::min(stance.step / scale / (2 * leg) * (runs ? .8 : 1), .75));
  const double bent = std::min(1., stance.step / .7);
  const double lean = std::min(.02 + .03 * speed, .2);

  std::array<Joint, 2> knee, ankle, toe, elbow, hand;
  double lowest = 0;
  for (int side = 0; side < 2; ++side) {
    const double phase = stance.phase + (side == 0 ? 0 : std::numbers::pi);
    const double hip = swing * std::sin(phase) + (runs ? .15 * bent : .04 * bent);
    const double lifts = std::max(0., std::cos(phase + .45));
    const double flexed = .06 + .08 * bent + (runs ? 1.5 : .95) * bent * lifts;
    const Joint top{0, kHip};
    knee[side] = top.along(kThigh, hip + .3 * flexed);
    ankle[side] = knee[side].along(kShin, hip - .7 * flexed);
    // The foot is level in front and on its toes behind.
    const double pitch = hip < 0 ? .9 * -hip + .5 * lifts * bent : -.35 * hip;
    toe[side] = {ankle[side].ahead + .17 * std::cos(pitch), ankle[side].up - .04 - .17 * std::sin(pitch)};
    lowest =
        side == 0 ? std::min(ankle[side].up, toe[side].up) : std::min({lowest, ankle[side].up, toe[side].up});
    const double swings = -.75 * swing * std::sin(phase) + .03;
    const double crooked = runs ? 1.4 : .18 + .3 * std::max(0., std::sin(phase + std::numbers::pi)) * bent;
    const Joint shoulder{kShoulder * lean * .4, kShoulder};
    double upper = swings, fore = swings + crooked;
    if (side == 1 && stance.gesture > 0) {
      const double g = stance.gesture;
      upper = (1 - g) * upper + g * 1.9, fore = (1 - g) * fore + g * (2.9 + .35 * std::sin(stance.wave));
    }
    elbow[side] = shoulder.along(kUpperArm, upper);
    hand[side] = elbow[side].along(kForearm, fore);
  }

  Frame frame{stance.x, stance.y, std::cos(stance.heading), std::sin(stance.heading), scale, .035 - lowest};
  const auto ahead = [&](double up) { return std::max(0., up - kHip) * lean; };
  Body body;
  body.sideways_x = -frame.sin, body.sideways_y = frame.cos;
  int n = 0;
  const auto add = [&](Point from, Point to, double wide_from, double wide_to, Part part, double flat = 1,
                       double cap = 1) { body.limbs[n++] = {from, to, wide_from, wide_to, flat, cap, part}; };
  const auto spine = [&](double up, double forward = 0) { return frame.at(ahead(up) + forward, 0, up); };
  add(spine(.98), spine(1.16), .15, .135, Part::shirt, .72, .5);       // waist, over the belt
  add(spine(1.14), spine(1.385), .14, .18, Part::shirt, .62, .46);     // chest
  add(spine(.91), spine(1.01), .16, .15, Part::trousers, .75, .4);     // hips
  add(spine(1.44), spine(1.54, .015), .06, .052, Part::skin);          // neck
  add(spine(1.585, .03), spine(1.655, .025), .066, .074, Part::skin);  // face
  add(spine(1.60, -.02), spine(1.675, -.005), .07, .08, Part::hair);   // hair
  const double turn = .02 * std::sin(stance.phase);
  for (int side = 0; side < 2; ++side) {
    const double s = side == 0 ? -1 : 1;
    const auto leg_at = [&](const Joint& j, double out) { return frame.at(j.ahead, s * out, j.up); };
    add(frame.at(0, s * kBesideHip, kHip + .02), leg_at(knee[side], .08), .09, .062, Part::trousers);
    add(leg_at(knee[side], .08), leg_at(ankle[side], .075), .064, .048, Part::trousers);
    add(frame.at(ankle[side].ahead - .03, s * .075, ankle[side].up), leg_at(toe[side], .085), .042, .036,
        Part::shoes);
    const double arm = ahead(kShoulder) + s * turn;
    const auto arm_at = [&](const Joint& j, double out) {
      return frame.at(arm + j.ahead - kShoulder * lean * .4, s * out, j.up);
    };
    const Point shoulder = frame.at(arm, s * kBesideShoulder, kShoulder - .045);
    const Point wrist = arm_at(hand[side], kBesideShoulder + .015);
    const Joint tip = hand[side].along(
        .1, std::atan2(hand[side].ahead - elbow[side].ahead, elbow[side].up - hand[side].up));
    add(shoulder, arm_at(elbow[side], kBesideShoulder + .024), .054, .044, Part::shirt);
    add(arm_at(elbow[side], kBesideShoulder + .024), wrist, .044, .034, Part::shirt);
    add(wrist, arm_at(tip, kBesideShoulder + .01), .032, .036, Part::skin);
  }
  return body;
}

}  // namespace cerberus::sim
