// SPDX-License-Identifier: LGPL-2.1-or-later
// A robot on its patrol through the office that comes along.
#include "sim/house/house.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <tuple>

#include "support/suite.h"

using namespace cerberus::sim;
using namespace std::chrono_literals;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;

namespace {

FloorPlan plan_of(const std::string& text) {
  auto result = read_floor_plan(text);
  if (const auto* wrong = std::get_if<std::string>(&result)) ck_abort_msg("%s", wrong->c_str());
  return std::get<FloorPlan>(std::move(result));
}

FloorPlan office() {
  std::ifstream in(std::string(std::getenv("CERBERUS_SOURCE")) + "/pipelines/office.plan");
  return plan_of(std::string{std::istreambuf_iterator<char>(in), {}});
}

std::unique_ptr<House> built(FloorPlan plan, const HouseSettings& settings) {
  auto result = House::build(std::move(plan), settings);
  if (const auto* wrong = std::get_if<std::string>(&result)) ck_abort_msg("%s", wrong->c_str());
  return std::get<std::unique_ptr<House>>(std::move(result));
}

std::vector<Route> routes(const char* text, Mover mover) {
  return std::get<std::vector<Route>>(read_routes(text, mover));
}

const auto kAhead = [](Time) { return Gaze{}; };

Spot place_of(const House& house, int person) {
  const PersonTruth& truth = house.people()[person];
  const double angle = house.base().yaw() + truth.bearing;
  return {house.base().x() + truth.distance * std::cos(angle),
          house.base().y() + truth.distance * std::sin(angle)};
}

// A small picture, because none is looked at.
HouseSettings small() {
  HouseSettings settings;
  settings.lens.width = 32, settings.lens.height = 24;
  settings.exposure = 0ms;
  return settings;
}

constexpr char kHall[] = "room hall 0 0 12 10\nlamp 5 5\n";

// One person who crosses before a robot that stands at (1, 5) and looks along x.
HouseSettings crossing(const char* walk) {
  HouseSettings settings = small();
  settings.path = routes("at 1 5; wait 1", Mover::robot);
  settings.walks = routes(walk, Mover::person);
  settings.pir_bearings = {0, radians(-120), radians(120)};
  return settings;
}

}  // namespace

START_TEST(a_robot_without_a_path_patrols_every_room_and_meets_no_wall) {
  HouseSettings settings = small();
  settings.people = 0;
  const FloorPlan plan = office();
  const Ways ways(plan, .25);
  const auto house = built(plan, settings);
  std::set<std::string> visited;
  std::vector<std::uint8_t> picture;
  double fastest = 0, turns = 0;
  for (Time t{}; t < 200s; t += 250ms) {
    house->take(t, kAhead, picture);
    const DrivenBase& base = house->base();
    ck_assert(ways.free({base.x(), base.y()}));
    visited.insert(plan.spaces[plan.space_at(base.x(), base.y())].name);
    fastest = std::max(fastest, base.speed()), turns = std::max(turns, std::abs(base.yaw_rate()));
  }
  for (const char* name : {"hall", "office", "lab", "lounge"})
    ck_assert_msg(visited.contains(name), "%s", name);
  ck_assert_double_eq_tol(fastest, .6, 1e-6);
  ck_assert_double_eq_tol(degrees(turns), 45, 1e-3);
}
END_TEST

START_TEST(people_go_from_room_to_room_and_keep_off_walls_and_each_other) {
  const FloorPlan plan = office();
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    HouseSettings settings = small();
    settings.seed = seed;
    settings.people = 4;
    const auto house = built(plan, settings);
    std::vector<std::uint8_t> picture;
    std::vector<std::set<int>> rooms(4);
    for (Time t{}; t < 60s; t += 200ms) {
      house->take(t, kAhead, picture);
      const auto at = [&](int i) { return place_of(*house, i); };
      for (int i = 0; i < 4; ++i) {
        const Spot here = at(i);
        // Half of a body's depth from whatever stands.
        for (int k = 0; k < 8; ++k) {
          const double x = here.x + .15 * std::cos(k * radians(45)),
                       y = here.y + .15 * std::sin(k * radians(45));
          ck_assert_msg(plan.space_at(x, y) >= 0, "seed %u, person %d at %.2f %.2f", seed, i, here.x, here.y);
          for (const Furniture& box : plan.boxes) ck_assert(!box.area.contains(x, y));
        }
        rooms[i].insert(plan.space_at(here.x, here.y));
        for (int other = 0; other < i; ++other)
          ck_assert_double_gt(std::hypot(at(other).x - here.x, at(other).y - here.y), .25);
      }
    }
    ck_assert(std::ranges::any_of(rooms, [](const auto& visited) { return visited.size() >= 3; }));
  }
}
END_TEST

START_TEST(one_seed_gives_the_same_pictures_and_another_gives_others) {
  const auto pictures = [](std::uint32_t seed) {
    HouseSettings settings;
    settings.seed = seed;
    settings.lens.width = 64, settings.lens.height = 48;
    settings.pir_bearings = {0};
    settings.shake = radians(.2);
    const auto house = built(office(), settings);
    std::vector<std::uint8_t> all, one;
    for (Time t{}; t < 4s; t += 33ms) {
      house->take(
          t, [](Time at) { return Gaze{radians(10) * std::sin(cerberus::motion::seconds(at)), 0}; }, one);
      all.insert(all.end(), one.begin(), one.end());
    }
    return all;
  };
  const auto first = pictures(3);
  ck_assert(first == pictures(3));
  ck_assert(first != pictures(4));
}
END_TEST

// Three metres before the camera, at 1 m/s.
START_TEST(the_truth_is_where_the_walk_leads) {
  const auto house = built(plan_of(kHall), crossing("at 4 2 90; go 4 8 1"));
  std::vector<std::uint8_t> picture;
  double before = -1;
  for (Time t{}; t <= 5s; t += 100ms) {
    house->take(t, kAhead, picture);
    const PersonTruth& person = house->people().at(0);
    ck_assert_double_ge(person.bearing, before);
    before = person.bearing;
    ck_assert_double_eq_tol(person.distance * std::cos(person.bearing), 3, .02);
    if (t > 2s && t < 5s) ck_assert_double_eq_tol(person.speed, 1, .01);
  }
  ck_assert_double_gt(degrees(before), 25);
}
END_TEST

START_TEST(a_gaze_to_the_right_moves_the_person_to_the_left) {
  HouseSettings settings = crossing("at 4 5; wait 9");
  settings.lens.width = 320, settings.lens.height = 240;
  const auto house = built(plan_of(kHall), settings);
  std::vector<std::uint8_t> picture;
  house->take(0ms, [](Time) { return Gaze{radians(20), 0}; }, picture);
  const PersonTruth person = house->people().at(0);
  ck_assert_double_eq_tol(degrees(person.bearing), -20, 1e-6);
  ck_assert_double_eq_tol(person.left + person.width / 2, 160 - 277.1 * std::tan(radians(20)), 3);
}
END_TEST

START_TEST(a_sensor_is_triggered_by_who_crosses_its_field_and_not_through_a_wall) {
  const auto first_edge = [](const char* plan, const char* walk) {
    const auto house = built(plan_of(plan), crossing(walk));
    std::vector<std::uint8_t> picture;
    for (Time t{}; t <= 6s; t += 50ms) {
      house->take(t, kAhead, picture);
      for (const PirEdge& edge : house->pir_edges()) {
        ck_assert(edge.high && edge.time <= t && edge.time > t - 50ms);
        return edge.sensor;
      }
    }
    return -1;
  };
  ck_assert_int_eq(first_edge(kHall, "at 5 3 90; go 5 7 1"), 0);
  ck_assert_int_eq(first_edge(kHall, "at 5 5; wait 9"), -1);
  ck_assert_int_eq(first_edge("room hall 0 0 3 10\nroom next 3.2 0 8 10\n", "at 5 3 90; go 5 7 1"), -1);
}
END_TEST

// The bearing of a person who stands, from a robot that stands and then turns.
START_TEST(a_robot_shakes_while_it_moves_and_a_hand_always) {
  for (const ShakeKind kind : {ShakeKind::robot, ShakeKind::hand}) {
    HouseSettings settings = small();
    settings.path = routes("at 1 5; wait 6; turn 720; wait 60", Mover::robot);
    settings.walks = routes("at 4 5; wait 60", Mover::person);
    settings.shake = radians(.5), settings.shake_kind = kind;
    const auto house = built(plan_of(kHall), settings);
    std::vector<std::uint8_t> picture;
    double stands = 0, turns = 0;
    int frames = 0;
    for (Time t{}; t < 11s; t += 50ms) {
      house->take(t, kAhead, picture);
      const double off = cerberus::sensing::wrap(house->people()[0].bearing + house->base().yaw());
      if (t < 5s) stands += off * off, ++frames;
      if (t >= 6s) turns += off * off;
    }
    stands = degrees(std::sqrt(stands / frames)), turns = degrees(std::sqrt(turns / frames));
    ck_assert_double_eq_tol(turns, .5, .2);
    ck_assert_double_eq_tol(stands, kind == ShakeKind::hand ? .5 : 0, .2);
  }
}
END_TEST

// A lane in which nobody can step aside: the robot comes to rest before the person, and passes nobody.
START_TEST(a_robot_waits_for_a_person_in_its_way) {
  HouseSettings settings = small();
  settings.path = routes("at 1 .5; go 9 .5", Mover::robot);
  settings.walks = routes("at 9.1 .5; wait 60", Mover::person);
  const auto house = built(plan_of("room lane 0 0 9.5 1\n"), settings);
  std::vector<std::uint8_t> picture;
  double nearest = 9, stood_at = 0, slowest = 0;
  for (Time t{}; t < 30s; t += 100ms) {
    house->take(t, kAhead, picture);
    nearest = std::min(nearest, house->people()[0].distance);
    slowest = std::min(slowest, house->base().speed());
    if (t > 5s && house->base().speed() == 0 && house->base().yaw_rate() == 0) stood_at = house->base().x();
  }
  ck_assert_double_gt(nearest, .4);
  ck_assert_double_gt(stood_at, 5);
  ck_assert_double_lt(stood_at, 8.8);
  ck_assert_double_lt(slowest, -.1);  // then it backs
}
END_TEST

START_TEST(who_gets_no_further_turns_back_and_comes_again) {
  HouseSettings settings = small();
  settings.path = routes("at 4.1 3; wait 99", Mover::robot);
  settings.walks = routes("at 1 3; go 7 3", Mover::person);
  const auto house =
      built(plan_of("room a 0 0 4 6\nroom b 4.2 0 4 6\ndoorway a b at=3 width=.9\n"), settings);
  std::vector<std::uint8_t> picture;
  int comes = 0;
  bool near = false;
  for (Time t{}; t < 40s; t += 100ms) {
    house->take(t, kAhead, picture);
    const double away = house->people()[0].distance;
    if (!near && away < 1.2) near = true, ++comes;
    if (away > 2) near = false;
  }
  ck_assert_int_ge(comes, 2);
  ck_assert_double_gt(house->people()[0].distance, .3);
}
END_TEST

// Longer than a turn all around and a person's rests.
START_TEST(nobody_and_no_robot_is_stuck_in_the_office) {
  const FloorPlan plan = office();
  for (const auto& [seed, people] : {std::pair{1U, 2}, {3U, 2}, {12U, 2}, {10U, 4}}) {
    HouseSettings settings = small();
    settings.lens.width = 16, settings.lens.height = 16;
    settings.seed = seed;
    settings.people = people;
    const auto house = built(plan, settings);
    std::vector<std::uint8_t> picture;
    Time moved{};
    std::vector<Time> left(people);
    std::vector<Spot> places(people);
    for (Time t{}; t < 120s; t += 100ms) {
      house->take(t, kAhead, picture);
      if (house->base().speed() != 0 || house->base().yaw_rate() != 0) moved = t;
      ck_assert_msg(t - moved < 15s, "seed %u: the robot", seed);
      for (int i = 0; i < people; ++i) {
        const Spot here = place_of(*house, i);
        if (std::hypot(here.x - places[i].x, here.y - places[i].y) > .7) places[i] = here, left[i] = t;
        ck_assert_msg(t - left[i] < 25s, "seed %u: person %d at %.2f %.2f", seed, i, here.x, here.y);
      }
    }
  }
}
END_TEST

// Where another person or the robot stands already.
START_TEST(a_place_beside_somebody_counts_as_reached) {
  for (const char* walks :
       {"at 5 8; go 8 8 1; wait 1; go 9 2 1", "at 5 8; go 2 4 1; wait 1; go 9 2 1 | at 2 4.2; wait 99"}) {
    HouseSettings settings = small();
    settings.path = routes("at 8.2 8.2 180; wait 9", Mover::robot);
    settings.walks = routes(walks, Mover::person);
    const auto house = built(plan_of(kHall), settings);
    std::vector<std::uint8_t> picture;
    double nearest = 9;
    for (Time t{}; t < 25s; t += 100ms) {
      house->take(t, kAhead, picture);
      const Spot here = place_of(*house, 0);
      nearest = std::min(nearest, std::hypot(here.x - 9, here.y - 2));
    }
    ck_assert_double_lt(nearest, .2);
  }
}
END_TEST

// Two who meet head on, and one who meets the robot: what the truth says is how their places change.
START_TEST(who_steps_aside_walks_there) {
  HouseSettings settings = small();
  settings.path = routes("at 6 8; wait 9", Mover::robot);
  settings.walks = routes("at 2 4; go 10 4 1.2 | at 10 4; go 2 4 1.2 | at 2 8; go 10 8 1.5", Mover::person);
  const auto house = built(plan_of(kHall), settings);
  std::vector<std::uint8_t> picture;
  Spot places[3], velocities[3];
  double aside = 0;
  for (int frame = 0; frame < 240; ++frame) {
    house->take(frame * 50ms, kAhead, picture);
    for (int i = 0; i < 3; ++i) {
      const Spot here = place_of(*house, i);
      const Spot velocity{(here.x - places[i].x) / .05, (here.y - places[i].y) / .05};
      if (frame > 0)
        ck_assert_double_eq_tol(std::hypot(velocity.x, velocity.y), house->people()[i].speed, .1);
      if (frame > 1)
        ck_assert_double_le(std::hypot(velocity.x - velocities[i].x, velocity.y - velocities[i].y) / .05,
                            3.05);
      places[i] = here, velocities[i] = velocity;
    }
    aside = std::max(aside, std::abs(places[2].y - 8));
    ck_assert_double_gt(std::hypot(places[0].x - places[1].x, places[0].y - places[1].y), .35);
    ck_assert_double_gt(std::hypot(places[2].x - 6, places[2].y - 8), .35);
  }
  ck_assert_double_gt(aside, .3);
}
END_TEST

START_TEST(lamps_are_switched_at_their_times) {
  const auto brightness = [](const std::string& lamp) {
    HouseSettings settings = crossing("at 1 1; wait 60");
    settings.path = routes("at 6 5; wait 60", Mover::robot);
    const auto house = built(plan_of("room hall 0 0 12 10\n" + lamp), settings);
    std::vector<double> means;
    std::vector<std::uint8_t> picture;
    for (int second = 0; second < 8; ++second) {
      house->take(second * 1s, kAhead, picture);
      double sum = 0;
      for (int i = 0; i < 32 * 24; ++i) sum += picture[i];
      means.push_back(sum / (32 * 24));
    }
    return means;
  };
  const double lit = brightness("lamp 9 5")[0];
  for (const auto& [lamp, dark_from, dark_to] : {std::tuple{"lamp 9 5", 99, 99},
                                                 {"lamp 9 5 off=2 on=5", 2, 5},
                                                 {"lamp 9 5 off=3", 3, 99},
                                                 {"lamp 9 5 on=4", 0, 4}}) {
    const auto means = brightness(lamp);
    for (int second = 0; second < 8; ++second) {
      const bool dark = second >= dark_from && second < dark_to;
      ck_assert_msg(dark == (means[second] < .8 * lit), "%s, %d s: %.0f of %.0f", lamp, second, means[second],
                    lit);
    }
  }
}
END_TEST

START_TEST(settings_that_cannot_be_are_named) {
  HouseSettings settings = small();
  settings.path = routes("at 1 5; go 40 5", Mover::robot);
  const auto refused = House::build(plan_of(kHall), settings);
  ck_assert_str_eq(std::get<std::string>(refused).c_str(),
                   "the robot's path: no free way leads from 1 5 to 40 5, .35 m from walls and things");
  settings.path.clear();
  settings.walks = routes("at 0 0.05; wait 1", Mover::person);
  const auto walled = House::build(plan_of(kHall), settings);
  ck_assert_str_eq(std::get<std::string>(walled).c_str(),
                   "a person's walk: 0 0.05 is not free, .35 m from walls and things");
  // Under the doorway that its way leads through.
  HouseSettings tall = small();
  tall.camera_height = 2.1;
  const char* const rooms = "room a 0 0 4 6\nroom b 4.2 0 4 6\ndoorway a b at=3\n";
  const auto hits = House::build(plan_of(rooms), tall);
  ck_assert_str_eq(std::get<std::string>(hits).c_str(),
                   "the camera is as high as the ceiling of 'a-b', where the robot goes");
  tall.path = routes("at 1 1; wait 1", Mover::robot);
  ck_assert(std::holds_alternative<std::unique_ptr<House>>(House::build(plan_of(rooms), tall)));
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "house_patrol",
      {a_robot_without_a_path_patrols_every_room_and_meets_no_wall,
       people_go_from_room_to_room_and_keep_off_walls_and_each_other,
       one_seed_gives_the_same_pictures_and_another_gives_others, the_truth_is_where_the_walk_leads,
       a_gaze_to_the_right_moves_the_person_to_the_left,
       a_sensor_is_triggered_by_who_crosses_its_field_and_not_through_a_wall,
       a_robot_shakes_while_it_moves_and_a_hand_always, a_robot_waits_for_a_person_in_its_way,
       who_gets_no_further_turns_back_and_comes_again, nobody_and_no_robot_is_stuck_in_the_office,
       a_place_beside_somebody_counts_as_reached, who_steps_aside_walks_there,
       lamps_are_switched_at_their_times, settings_that_cannot_be_are_named});
}
