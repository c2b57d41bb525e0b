// SPDX-License-Identifier: LGPL-2.1-or-later
// Simulated PIR modules and the surroundings of their robots against numbers worked out by hand.
#include "sim/patrols.h"

#include <check.h>

#include <cmath>
#include <functional>
#include <vector>

#include "sensing/angles.h"
#include "support/suite.h"

using namespace cerberus::sim;
using namespace std::chrono_literals;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;

namespace {

// Zones of 10 degrees from -60 to 60, answers at once.
const PirTraits kTraits{.field = radians(120), .zones = 12, .response = 0};

// One thing, whose bearing in degrees is a function of the time; the times in ms at which the output changes.
struct Trial {
  PirSensor sensor{kTraits, 0};
  std::function<double(double)> bearing;
  double width = 10, contrast = 6;

  std::vector<long> changes(Time length) {
    std::vector<long> found;
    for (Time now{}; now <= length; now += 10ms) {
      const bool before = sensor.output();
      const Warmth thing{radians(bearing(cerberus::motion::seconds(now))), radians(width), contrast};
      sensor.elapse(now, std::vector{thing});
      if (sensor.output() != before) found.push_back(now / 1ms);
    }
    return found;
  }
};

}  // namespace

// From 5 degrees on at 10 a second: borders at .5 and 1.5 s, then it stands; held for 2.5 s from the last one.
START_TEST(what_crosses_zones_triggers_and_what_stands_does_not) {
  Trial trial{.bearing = [](double t) { return 5.001 + 10 * std::min(t, 2.); }};
  ck_assert(trial.changes(10s) == std::vector<long>({500, 4000}));
  Trial standing{.bearing = [](double) { return 5.; }};
  ck_assert(standing.changes(10s).empty());
}
END_TEST

START_TEST(only_the_field_of_a_sensor_sees) {
  Trial trial{.bearing = [](double t) { return 61.001 + 10 * t; }};
  ck_assert(trial.changes(10s).empty());
  Trial enters{.bearing = [](double t) { return -64.999 + 10 * std::min(t, 1.); }};
  ck_assert(enters.changes(10s) == std::vector<long>({500, 3000}));
}
END_TEST

// 10 degrees a second: 1 Hz, of which the band passes .95; the threshold is 2 K.
START_TEST(what_is_faint_or_narrow_or_slow_does_not_trigger) {
  const auto triggers = [](double contrast, double width, double rate) {
    Trial trial{.bearing = [rate](double t) { return -50 + rate * t; }};
    trial.contrast = contrast;
    trial.width = width;
    return !trial.changes(20s).empty();
  };
  ck_assert(triggers(2.2, 20, 10));
  ck_assert(triggers(-2.2, 20, 10));  // colder than the wall
  ck_assert(!triggers(2, 20, 10));
  ck_assert(triggers(6, 4, 10));
  ck_assert(!triggers(6, 3, 10));
  ck_assert(!triggers(6, 10, 1));    // .1 Hz: a third of it passes
  ck_assert(!triggers(6, 10, 400));  // 40 Hz: a fifth
}
END_TEST

// Whether a person who walks on a circle around the module is found.
static bool finds(double metres, double speed, double low = 0, double range = 12) {
  PirTraits traits = kTraits;
  traits.threshold = threshold_for(traits, range);
  PirSensor sensor(traits, 0);
  const double rate = speed / metres;
  bool found = false;
  for (Time now{}; cerberus::motion::seconds(now) < radians(118) / rate; now += 10ms) {
    const double bearing = rate * cerberus::motion::seconds(now) - radians(59);
    const Warmth thing{bearing, 2 * std::atan(.24 / metres), 6, metres, low};
    sensor.elapse(now, std::vector{thing});
    found = found || sensor.output();
  }
  return found;
}

// The paper's Figure 1: zone A to 12 m for what is up to 1.5 m high, zone C to 3 m for what is up to 2.5 m high.
START_TEST(a_module_sees_as_far_as_its_zones_reach) {
  ck_assert(finds(3, 1) && finds(11.9, 1));
  ck_assert(!finds(12.1, 1));
  ck_assert(finds(2.9, 1, 2.4) && finds(11.9, 1, 1.4));
  ck_assert(!finds(3.1, 1, 1.6) && !finds(2.9, 1, 2.6));
}
END_TEST

// The paper's people walk at .1 to 4 m/s.
START_TEST(a_module_finds_slow_and_fast_people_who_are_near) {
  for (const double speed : {.1, .5, 1., 2., 4.})
    for (const double metres : {1.5, 3., 5.})
      ck_assert_msg(finds(metres, speed), "%.1f m/s, %.1f m", speed, metres);
  ck_assert(finds(11, 2) && finds(11, 4));
  ck_assert(!finds(11, .1));
  // A module of 5 m is the less sensitive one.
  ck_assert(finds(4.8, 1, 0, 5) && !finds(8, 1, 0, 5));
}
END_TEST

START_TEST(a_module_is_blind_for_a_moment_after_its_output_fell) {
  // Borders at .5 s and, after a rest, at `second`.
  const auto changes = [](double second) {
    Trial trial{.bearing = [second](double t) {
      return 4.999 + 10 * std::min(t, 1.) + 10 * std::clamp(t - second + .5, 0., 1.);
    }};
    return trial.changes(8s);
  };
  ck_assert(changes(3.1) == std::vector<long>({510, 3010}));
  ck_assert(changes(3.4) == std::vector<long>({510, 3010, 3410, 5910}));
}
END_TEST

START_TEST(a_robot_that_drives_passes_what_stands_beside_its_way) {
  const Patrol patrol = cerberus::sim::patrol("drive", 3);
  ck_assert_double_eq(patrol.speed, .5);
  std::vector<Warmth> seen, later;
  patrol.look(10, seen);
  patrol.look(10.1, later);
  ck_assert_uint_eq(seen.size(), patrol.things.size());
  int near = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (std::abs(degrees(seen[i].bearing)) > 150 || std::abs(degrees(seen[i].bearing)) < 30) continue;
    ++near;
    ck_assert(std::abs(later[i].bearing) > std::abs(seen[i].bearing));  // it falls behind
    ck_assert((later[i].bearing > 0) == (seen[i].bearing > 0));
  }
  ck_assert_int_ge(near, 1);
}
END_TEST

START_TEST(a_robot_that_turns_sees_everything_turn_the_other_way) {
  const Patrol patrol = cerberus::sim::patrol("patrol", 5);
  std::vector<Warmth> before, after;
  patrol.look(2, before);
  patrol.look(4.5, after);
  for (std::size_t i = 0; i < before.size(); ++i)
    ck_assert_double_eq_tol(std::abs(degrees(cerberus::sensing::wrap(before[i].bearing - after[i].bearing))),
                            90, 1e-6);
}
END_TEST

START_TEST(a_person_comes_out_of_sight_and_walks_across) {
  for (const char* name : kPatrols)
    for (unsigned seed = 1; seed < 20; ++seed) {
      const Patrol patrol = cerberus::sim::patrol(name, seed);
      ck_assert(std::abs(patrol.first) >= radians(40) && std::abs(patrol.first) <= radians(180));
      ck_assert(patrol.walked(0) == 0);
      const double metres = std::abs(patrol.walked(1)) * patrol.distance;
      ck_assert(metres >= .5 && metres <= 1.5);
    }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "sim_pir",
      {what_crosses_zones_triggers_and_what_stands_does_not, only_the_field_of_a_sensor_sees,
       what_is_faint_or_narrow_or_slow_does_not_trigger, a_module_sees_as_far_as_its_zones_reach,
       a_module_finds_slow_and_fast_people_who_are_near, a_module_is_blind_for_a_moment_after_its_output_fell,
       a_robot_that_drives_passes_what_stands_beside_its_way,
       a_robot_that_turns_sees_everything_turn_the_other_way, a_person_comes_out_of_sight_and_walks_across});
}
