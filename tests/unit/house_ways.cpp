// SPDX-License-Identifier: LGPL-2.1-or-later
// Free ways through a floor plan, and the text that says who goes where.
#include "sim/house/ways.h"

#include <check.h>

#include <cmath>
#include <string>

#include "sensing/angles.h"
#include "sim/house/routes.h"
#include "support/suite.h"

using namespace cerberus::sim;

namespace {

FloorPlan plan_of(const std::string& text) {
  auto result = read_floor_plan(text);
  if (const auto* wrong = std::get_if<std::string>(&result)) ck_abort_msg("%s", wrong->c_str());
  return std::get<FloorPlan>(std::move(result));
}

const char* const kTwoRooms =
    "room a 0 0 4 6\nroom b 4.2 0 4 6\ndoorway a b at=5 width=1\nbox 1.5 2 1 1 .5\npillar 6 3 .3\n";

double length_of(Spot from, const std::vector<Spot>& way) {
  double length = 0;
  for (const Spot& to : way) {
    length += std::hypot(to.x - from.x, to.y - from.y);
    from = to;
  }
  return length;
}

std::string wrong_with(const char* text, Mover mover) {
  const auto read = read_routes(text, mover);
  const auto* wrong = std::get_if<std::string>(&read);
  return wrong ? *wrong : "";
}

}  // namespace

START_TEST(a_way_goes_through_the_doorway_and_around_what_stands) {
  const Ways ways(plan_of(kTwoRooms), .3);
  const Spot from{2, 1.05}, to{7, 1.05};
  const auto way = ways.way(from, to);
  ck_assert_uint_ge(way.size(), 2);
  ck_assert_double_eq(way.back().x, to.x);
  ck_assert_double_eq(way.back().y, to.y);
  // Through the doorway, whose free part ends .3 m from its edge at 4.5: 3.75 m down and up again, at least.
  bool passes = false;
  Spot here = from;
  for (const Spot& next : way) {
    for (double share = 0; share <= 1; share += .01) {
      const Spot at{here.x + share * (next.x - here.x), here.y + share * (next.y - here.y)};
      ck_assert(ways.free(at));
      passes = passes || (at.x > 4 && at.x < 4.2 && at.y > 4.5 && at.y < 5.5);
    }
    here = next;
  }
  ck_assert(passes);
  const double least = std::hypot(2, 3.75) + .2 + std::hypot(2.8, 3.75);
  ck_assert_double_ge(length_of(from, way), least - .2);
  ck_assert_double_le(length_of(from, way), 1.15 * least);
}
END_TEST

START_TEST(nothing_is_free_within_the_clearance) {
  const Ways ways(plan_of(kTwoRooms), .3);
  ck_assert(ways.free({1, 1}));
  ck_assert(!ways.free({.15, 1}));                          // the wall
  ck_assert(!ways.free({1.35, 2.5}));                       // the box
  ck_assert(!ways.free({6, 3.55}) && ways.free({6, 3.8}));  // the pillar
  ck_assert(!ways.free({4.1, 1}) && ways.free({4.1, 5}));   // between the rooms
  ck_assert(!ways.free({-5, 1}) && !ways.free({50, 1}));
}
END_TEST

START_TEST(no_way_leads_into_a_closed_room_or_a_wall) {
  const Ways ways(plan_of("room a 0 0 4 6\nroom b 4.2 0 4 6\n"), .3);
  ck_assert(ways.way({2, 2}, {6, 2}).empty());
  ck_assert(ways.way({2, 2}, {4.1, 2}).empty());
  ck_assert_uint_eq(ways.way({2, 2}, {3, 4}).size(), 1);
}
END_TEST

START_TEST(a_robot_sees_over_a_table_and_not_through_a_wall) {
  const Ways ways(plan_of(kTwoRooms), .3);
  ck_assert(ways.sees({2, 1}, {2, 4}));   // the box is .5 m high
  ck_assert(!ways.sees({2, 1}, {6, 1}));  // the wall
  ck_assert(ways.sees({3, 5}, {7, 5}));   // the doorway
  ck_assert(!ways.sees({5, 3}, {7, 3}));  // the pillar
}
END_TEST

START_TEST(what_hangs_hides_nothing_below_it_and_people_pass_below_what_hangs_high) {
  const Ways ways(plan_of("room a 0 0 6 6\nbox 1 2 4 .4 1.8 from=1.2\nbox 1 4 4 .4 2.6 from=2.1\n"), .3);
  ck_assert(ways.sees({3, 1}, {3, 5}));
  ck_assert(!ways.free({3, 2.2}) && ways.free({3, 4.2}));
}
END_TEST

START_TEST(routes_are_read_as_they_are_written) {
  const auto robot = read_routes("at 1 2 90; go 3.5 2; turn -45; wait 1.5;", Mover::robot);
  const auto* one = std::get_if<std::vector<Route>>(&robot);
  ck_assert(one != nullptr);
  ck_assert_uint_eq(one->size(), 1);
  ck_assert_double_eq((*one)[0].begin.y, 2);
  ck_assert_double_eq_tol((*one)[0].heading, cerberus::sensing::radians(90), 1e-12);
  const auto& steps = (*one)[0].steps;
  ck_assert_uint_eq(steps.size(), 3);
  ck_assert(steps[0].kind == RouteStep::go && steps[0].to.x == 3.5 && steps[0].speed == 0);
  ck_assert(steps[1].kind == RouteStep::turn);
  ck_assert_double_eq_tol(steps[1].angle, cerberus::sensing::radians(-45), 1e-12);
  ck_assert(steps[2].kind == RouteStep::wait && steps[2].seconds == 1.5);

  const auto people = read_routes(" at 1 1 ; go 2 1 .5\n| at 3 3; gesture 2", Mover::person);
  const auto* two = std::get_if<std::vector<Route>>(&people);
  ck_assert(two != nullptr);
  ck_assert_uint_eq(two->size(), 2);
  ck_assert_double_eq((*two)[0].steps[0].speed, .5);
  ck_assert((*two)[1].steps[0].kind == RouteStep::gesture);
  const auto none = read_routes("", Mover::person);
  ck_assert(std::get<std::vector<Route>>(none).empty());
}
END_TEST

START_TEST(what_is_wrong_with_a_route_is_named) {
  ck_assert(wrong_with("go 1 1", Mover::robot) ==
            "'go 1 1' should be at X Y [HEADING], first of all and only once");
  ck_assert(wrong_with("at 1 1; go 1", Mover::robot).find("' go 1' should be go X Y") == 0);
  ck_assert(wrong_with("at 1 1; go 1 1 9", Mover::person).find(".1 to 4") != std::string::npos);
  ck_assert(wrong_with("at 1 1; go 1 1 3", Mover::person).empty());
  ck_assert(wrong_with("at 1 1; go 1 1 3", Mover::robot).find(".05 to 1.5") != std::string::npos);
  ck_assert(wrong_with("at 1 1; go 1 1 .05", Mover::robot).empty());
  ck_assert(!wrong_with("at 1 1; turn 90", Mover::person).empty());
  ck_assert(!wrong_with("at 1 1; gesture 1", Mover::robot).empty());
  ck_assert(!wrong_with("at 1 1; wait 0", Mover::robot).empty());
  ck_assert(!wrong_with("at 1 nan", Mover::robot).empty());
  ck_assert(!wrong_with("at 1 1 | at 2 2", Mover::robot).empty());
  ck_assert(wrong_with("at 1 1 | at 2 2", Mover::person).empty());
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "house_ways",
      {a_way_goes_through_the_doorway_and_around_what_stands, nothing_is_free_within_the_clearance,
       no_way_leads_into_a_closed_room_or_a_wall, a_robot_sees_over_a_table_and_not_through_a_wall,
       what_hangs_hides_nothing_below_it_and_people_pass_below_what_hangs_high,
       routes_are_read_as_they_are_written, what_is_wrong_with_a_route_is_named});
}
