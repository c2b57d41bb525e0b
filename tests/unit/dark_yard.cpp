// SPDX-License-Identifier: LGPL-2.1-or-later
// The complete chain before a yard in the dark: what the beam of a lamp that sweeps over it lights up does not look like a
// person, and a person who walks there at dusk is found.
#include <algorithm>
#include <cmath>

#include "support/chain.h"
#include "support/yard.h"
//
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

struct Beam {
  double speed;   // pixels a second
  double radius;  // pixels, at which its light has fallen to .6
  double light;   // of the middle, times the yard's own
  double dark;    // that light, as a share of daylight
};

struct Seen {
  int frames = 0;   // with all of the person in the picture
  int found = 0;    // with a track on the person
  int tracks = 0;   // elsewhere, summed over frames
  int persons = 0;  // of them, person-like
};

// speed: pixels a second of a person who walks to and fro; 0: nobody.
Seen watch(const Beam& beam, double seconds, double speed) {
  Yard yard{.size = {320, 240}, .rate = 25};
  Chain chain;
  Seen seen;
  const auto to_and_fro = [&](double gone, double beyond) {
    const double way = yard.size.width + 2 * beyond, at = std::fmod(gone, 2 * way);
    return std::min(at, 2 * way - at) - beyond;
  };
  for (int k = 0; k < seconds * yard.rate; ++k) {
    const double t = k / yard.rate;
    Yard::Person person;
    if (speed > 0) person.way = speed * t, person.x = to_and_fro(person.way, 40);
    yard.draw(person);
    const double x0 = to_and_fro(beam.speed * t, 2 * beam.radius), y0 = 0.55 * yard.size.height;
    for (int y = 0; y < yard.size.height; ++y)
      for (int x = 0; x < yard.size.width; ++x) {
        const double r = std::hypot(x - x0, y - y0) / beam.radius;
        yard.scene[static_cast<std::size_t>(y) * yard.size.width + x] *=
            static_cast<float>(beam.dark * (1 + beam.light * std::exp(-r * r / 2)));
      }
    chain.step(yard.shoot(), 1 / yard.rate);
    const Box box = yard.box(person);
    bool found = false;
    for (const Track& track : chain.tracks()) {
      const bool on = overlap_area(track.box, box) > box.area() / 3;
      found = found || on;
      seen.tracks += !on;
      seen.persons += !on && track.kind == RegionKind::person_like;
    }
    if (speed <= 0 || t < 2 || box.x < 0 || box.right() > yard.size.width) continue;
    ++seen.frames;
    seen.found += found;
  }
  return seen;
}

constexpr Beam kBeams[] = {
    {60, 25, 4, .2}, {120, 25, 4, .2}, {60, 40, 2, .3}, {200, 40, 4, .2}, {30, 20, 4, .2}};

}  // namespace

START_TEST(a_beam_that_sweeps_is_no_person) {
  for (const Beam& beam : kBeams) {
    const Seen seen = watch(beam, 20, 0);
    ck_assert_msg(seen.persons <= seen.tracks / 50, "at %.0f pixels a second %d of %d tracks are person-like",
                  beam.speed, seen.persons, seen.tracks);
  }
}
END_TEST

START_TEST(who_walks_there_at_dusk_is_found) {
  // Noise moves the corners of so faint a scene, but nothing passes a camera that stands by.
  const Seen seen = watch({60, 25, 0, .5}, 20, 30);
  ck_assert_msg(seen.found >= seen.frames * 3 / 4, "in %d of %d frames", seen.found, seen.frames);
}
END_TEST

int main() {
  return run_suite("dark_yard", {a_beam_that_sweeps_is_no_person, who_walks_there_at_dusk_is_found});
}
