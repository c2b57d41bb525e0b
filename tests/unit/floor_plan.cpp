// SPDX-License-Identifier: LGPL-2.1-or-later
// Floor plans as users write them, and what they are told of mistakes.
#include "sim/house/floor_plan.h"

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "support/suite.h"

using namespace cerberus::sim;

namespace {

FloorPlan read(std::string_view text) {
  auto result = read_floor_plan(text);
  if (const auto* wrong = std::get_if<std::string>(&result)) ck_abort_msg("%s", wrong->c_str());
  return std::get<FloorPlan>(std::move(result));
}

}  // namespace

START_TEST(the_office_has_a_corridor_and_three_rooms_with_a_doorway_each) {
  const char* source = std::getenv("CERBERUS_SOURCE");
  ck_assert_ptr_nonnull(source);
  std::ifstream in(std::string(source) + "/pipelines/office.plan");
  const FloorPlan plan = read(std::string{std::istreambuf_iterator<char>(in), {}});
  ck_assert_uint_eq(plan.spaces.size(), 4 + 3);
  ck_assert_str_eq(plan.spaces[0].name.c_str(), "hall");
  ck_assert_uint_eq(plan.spaces[0].openings.size(), 3);
  for (int room = 1; room < 4; ++room) ck_assert_uint_eq(plan.spaces[room].openings.size(), 1);
}
END_TEST

START_TEST(a_doorway_leads_through_the_wall_from_one_room_into_the_other) {
  const FloorPlan plan =
      read("room a 0 0 4 3   # to the left\nroom b 4.2 0 4 3\n\ndoorway a b at=1.5 width=1 height=2\n");
  const int door = plan.space_at(4.1, 1.5);
  ck_assert_int_eq(door, 2);
  ck_assert_int_eq(plan.space_at(4.1, .9), -1);
  ck_assert_double_eq_tol(plan.spaces[door].area.top, 1, 1e-12);
  ck_assert_double_eq_tol(plan.spaces[door].area.bottom, 2, 1e-12);
  ck_assert_double_eq_tol(plan.spaces[door].height, 2, 1e-12);
  const Opening out = plan.spaces[0].openings.at(0), in = plan.spaces[1].openings.at(0);
  ck_assert_int_eq(out.side, Opening::right);
  ck_assert_int_eq(in.side, Opening::left);
  ck_assert_int_eq(out.space, door);
  ck_assert_int_eq(in.space, door);
  for (const Opening& opening : plan.spaces[door].openings)
    ck_assert_int_eq(opening.space, opening.side == Opening::left ? 0 : 1);
}
END_TEST

START_TEST(things_stand_in_their_rooms) {
  const FloorPlan plan = read(
      "room a 0 0 4 3 height=3 wall=brick\nroom b 10 0 4 3\n"
      "box 11 1 1 .5 .7 side=metal top=cloth\npillar 12 2.5 .2\nlamp 1 1 strength=.5\n");
  ck_assert_uint_eq(plan.spaces[0].boxes.size(), 0);
  ck_assert_uint_eq(plan.spaces[1].boxes.size(), 1);
  ck_assert_uint_eq(plan.spaces[1].pillars.size(), 1);
  ck_assert(plan.spaces[0].wall == Surface::brick);
  ck_assert(plan.boxes[0].side == Surface::metal);
  ck_assert(plan.boxes[0].top == Surface::cloth);
  ck_assert_double_eq_tol(plan.boxes[0].area.bottom, 1.5, 1e-12);
  ck_assert_int_eq(plan.lamps[0].space, 0);
}
END_TEST

START_TEST(mistakes_are_named_with_their_line) {
  const char* known[][2] = {
      {"room a 0 0 4\n", "line 1: the length is missing"},
      {"room a 0 0 4 x\n", "line 1: the length: 'x' is no number"},
      {"room a 0 0 4 nan\n", "line 1: the length: 'nan' is no number"},
      {"room a 0 0 4 -3\n", "line 1: the length must be above 0"},
      {"\n# a comment\nroom a 0 0 4 3 7\n", "line 3: '7' is one word too many"},
      {"room a 0 0 4 3 colour=red\n", "line 1: 'colour=' means nothing here"},
      {"room a 0 0 4 3 wall=gold\n", "line 1: no texture is named 'gold'"},
      {"room a 0 0 4 3\nroom a 5 0 4 3\n", "line 2: there is a room 'a' already"},
      {"room a 0 0 4 3\nroom b 3 0 4 3\n", "line 2: 'b' overlaps 'a'"},
      {"roof a\n", "line 1: 'roof' is none of room, corridor, doorway, box, pillar, lamp"},
      {"room a 0 0 4 3\ndoorway a b at=1\n", "line 2: there is no room 'b' above"},
      {"room a 0 0 4 3\nroom b 9 0 4 3\ndoorway a b at=1\n",
       "line 3: 'a' and 'b' have no wall in common: leave one between them, up to .6 m thick"},
      {"room a 0 0 4 3\nroom b 4 0 4 3\ndoorway a b at=1\n",
       "line 3: 'a' and 'b' have no wall in common: leave one between them, up to .6 m thick"},
      {"room a 0 0 4 3\nroom b 150 0 60 3\n", "line 2: the plan is larger than 200 m: lengths are metres"},
      {"room a 0 0 5000 4000\n", "line 1: the plan is larger than 200 m: lengths are metres"},
      {"room a 0 0 4 3\nbox 1 1 1 1 2.8\n", "line 2: the box is higher than its room"},
      {"room a 0 0 4 3\nroom b 4.2 0 4 3\ndoorway a b\n", "line 3: at= is missing"},
      {"room a 0 0 4 3\nroom b 4.2 0 4 3\ndoorway a b at=2.8\n",
       "line 3: the doorway is not within the wall that both rooms have"},
      {"room a 0 0 4 3\nroom b 4.2 0 4 3\ndoorway a b at=1 height=5\n",
       "line 3: the doorway is higher than its rooms"},
      {"room a 0 0 4 3\nroom b 4.2 0 4 3\ndoorway a b at=1\ndoorway a b at=1.5\n",
       "line 4: the doorway meets another one"},
      {"room a 0 0 4 3\nbox 3.5 1 1 1 1\n", "line 2: it is not within one room"},
      {"room a 0 0 4 3\nbox 1 1 1 1 1\nbox 1.5 1 1 1 1\n", "line 3: the box overlaps another one"},
      {"room a 0 0 4 3\nlamp 5 5\n", "line 2: it is not within one room"},
      {"# nothing\n", "the plan has no room"},
  };
  for (const auto& [text, expected] : known) {
    const auto result = read_floor_plan(text);
    const auto* wrong = std::get_if<std::string>(&result);
    ck_assert_msg(wrong != nullptr, "read without an error: %s", text);
    ck_assert_str_eq(wrong->c_str(), expected);
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite("floor_plan",
                                    {the_office_has_a_corridor_and_three_rooms_with_a_doorway_each,
                                     a_doorway_leads_through_the_wall_from_one_room_into_the_other,
                                     things_stand_in_their_rooms, mistakes_are_named_with_their_line});
}
