// SPDX-License-Identifier: LGPL-2.1-or-later
// What one person and the base below the head do. Radians and seconds; bearings in the world, to the right.
//
//   mix      walks at 1.4 m/s on a line 3 to 8 m away, to and fro between -60 and 60 degrees, turns round at 1.5 m/s2
//   near     the same 3 m away                            far       8 m away
//   run      4 m/s, 4 m away, turns round at 3 m/s2
//   rest     stands within 20 degrees of straight ahead   wander    the same; its box wanders (CameraTraits::wander)
//   step     stands 100 degrees to the right: out of the picture at first, and a sensor's sector says search
//   behind   walks at 1.4 m/s on an arc 3 to 8 m away, to and fro between 0 and 250 degrees: each way it crosses behind
//   turned   the same, and the base turns where it is asked (asked_base.h); its turn is reported
//   zoom     comes from 25 m to 7 m and goes back, to and fro before the robot; hidden for 3 s of each 15; the camera zooms
//   gyro     stands; the base turns 90 degrees to and fro at 45 a second, rests 2 s, and its turn is reported
//   nogyro   the same, and nothing is reported            picture   reported as the picture shows it
#pragma once

#include <functional>
#include <string>

namespace cerberus::sim {

inline constexpr const char* kScenes[] = {"mix",  "near",   "far",    "run",  "rest",   "wander",
                                          "step", "behind", "turned", "gyro", "nogyro", "picture"};

enum class BaseReport { turn, none, from_picture };

struct Scene {
  std::string name;
  double length = 60, skip = 3;                                    // seconds; what is judged begins at `skip`
  std::function<double(double)> person;                            // bearing at a time
  std::function<double(double)> base = [](double) { return 0.; };  // yaw at a time
  BaseReport report = BaseReport::turn;
  bool sector = false;  // a sensor's sector leads to the person while it is out of the picture
  double wander = 0;    // of the box, as in CameraTraits
  bool asks = false;    // the base turns as it is asked, beside `base`
  std::function<double(double)> distance;  // metres at a time; empty: boxes are of no size
  std::function<bool(double)> hidden = [](double) { return false; };
};

// The scene of that name; what differs between persons differs by the seed. An unknown name is a person that stands.
Scene scene(const std::string& name, unsigned seed);

}  // namespace cerberus::sim
