// SPDX-License-Identifier: LGPL-2.1-or-later
// The complete chain in rain: what is seen in one frame only, each time elsewhere, is no object, and who walks in it is one.
#include <cstdio>
#include <random>
#include <set>
#include <string>

#include "support/chain.h"
#include "support/yard.h"
//
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

struct Rain {
  int streaks = 6;  // a frame
  double length = 35;
  float brightness = 45;
};

struct Seen {
  int identities = 0;  // away from the person
  int frames = 0;      // in which all of the person is in the picture
  int found = 0;       // with a box on him
};

// speed: S a second of a person who walks to and fro; 0: nobody.
Seen watch(Yard yard, const Rain& rain, double seconds, double speed) {
  Chain chain;
  std::mt19937 random(yard.seed);
  Seen seen;
  std::set<std::uint32_t> others;
  const double way = yard.size.width + 40 * yard.scale();
  for (int k = 0; k < seconds * yard.rate; ++k) {
    Yard::Person person;
    if (speed > 0) {
      person.way = speed * 34 * yard.scale() * k / yard.rate;
      const double at = std::fmod(person.way, 2 * way);
      person.x = std::min(at, 2 * way - at) - 20 * yard.scale();
    }
    yard.draw(person);
    yard.rain(rain.streaks, rain.length * yard.scale() * 2 / 3, rain.brightness, random);
    chain.step(yard.shoot(), 1 / yard.rate);
    const Box box = yard.box(person);
    bool found = false;
    for (const Track& t : chain.tracks()) {
      const bool on = overlap_area(t.box, box) > box.area() / 3;
      found = found || on;
      if (overlap_area(t.box, box) <= 0) others.insert(t.id);
    }
    if (speed <= 0 || k < 3 * yard.rate || box.x < 0 || box.right() > yard.size.width) continue;
    ++seen.frames;
    seen.found += found;
  }
  seen.identities = static_cast<int>(others.size());
  return seen;
}

}  // namespace

START_TEST(rain_is_nobody) {
  for (const double rate : {10.0, 15.0, 25.0})
    for (const double length : {20.0, 35.0}) {
      const auto ids = [&](int streaks) {
        return watch({.size = {320, 180}, .rate = rate}, {streaks, length}, 20, 0).identities;
      };
      const int light = ids(6), heavy = ids(30);
      ck_assert_msg(light <= 0, "%g/s, streaks of %g: %d identities", rate, length, light);
      ck_assert_msg(heavy <= 3, "%g/s, streaks of %g, heavy: %d identities", rate, length, heavy);
    }
}
END_TEST

START_TEST(who_walks_in_the_rain_is_found) {
  for (const double rate : {5.0, 10.0, 15.0, 25.0})
    for (const int streaks : {0, 6, 15, 30})
      for (const double speed : {.5, 1.0, 1.6}) {
        const Seen seen = watch({.size = {320, 180}, .rate = rate}, {streaks}, 15, speed);
        ck_assert_msg(3 * seen.found >= 2 * seen.frames,
                      "%g/s, %d streaks, speed %g: found in %d of %d frames", rate, streaks, speed,
                      seen.found, seen.frames);
      }
}
END_TEST

int main() {
  return run_suite("rain", {rain_is_nobody, who_walks_in_the_rain_is_found}, 200);
}
