// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/rules.h"

#include <check.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "sensing/angles.h"
#include "support/suite.h"

using namespace cerberus::fusion;
using cerberus::sensing::radians;

namespace {

// The paper's truth table, written out by hand from its rules (II.D): R and L turn right and left, T tracks, Z goes to
// zero. Rules 2 to 4 turn at their edge ("<=", ">="), rules 5 and 6 track at it ("<", ">").
constexpr double kAngles[] = {
    -170,                                                                           //
    -120.1, -120, -119.9, -90.1, -90, -89.9, -60.1, -60, -59.9, -45.1, -45, -44.9,  //
    -0.1,   0,    0.1,    44.9,  45,  45.1,  59.9,  60,  60.1,  119.9, 120, 120.1,  //
    170,
};
struct Row {
  bool camera;
  unsigned sensors;  // bit 0: infer1
  int rule;
  const char* actions;  // blanks only for the eye
};
// clang-format off
constexpr Row kPaper[] = {
    //               -170 -120 -90 -60 -45  0   45  60  120 170
    {false, 0b000, 7, "Z  ZZZ ZZZ ZZZ ZZZ ZZZ ZZZ ZZZ ZZZ  Z"},
    {false, 0b001, 2, "R  RRR RRR RRR RRT TTT TLL LLL LLL  L"},
    {false, 0b010, 3, "R  RRT TTT TLL LLL LLL LLL LLL LLL  L"},
    {false, 0b011, 5, "R  RRR RTT TTT TTT TTL LLL LLL LLL  L"},
    {false, 0b100, 4, "R  RRR RRR RRR RRR RRR RRR RRT TLL  L"},
    {false, 0b101, 6, "R  RRR RRR RRR RRR RTT TTT TTT TTL  L"},
    {false, 0b110, 3, "R  RRT TTT TLL LLL LLL LLL LLL LLL  L"},  // ours: the paper has no rule for it
    {false, 0b111, 5, "R  RRR RTT TTT TTT TTL LLL LLL LLL  L"},  // ours
    {true,  0b000, 1, "T  TTT TTT TTT TTT TTT TTT TTT TTT  T"},
    {true,  0b001, 1, "T  TTT TTT TTT TTT TTT TTT TTT TTT  T"},
    {true,  0b010, 1, "T  TTT TTT TTT TTT TTT TTT TTT TTT  T"},
    {true,  0b011, 1, "T  TTT TTT TTT TTT TTT TTT TTT TTT  T"},
    {true,  0b100, 1, "T  TTT TTT TTT TTT TTT TTT TTT TTT  T"},
    {true,  0b101, 1, "T  TTT TTT TTT TTT TTT TTT TTT TTT  T"},
    {true,  0b110, 1, "T  TTT TTT TTT TTT TTT TTT TTT TTT  T"},
    {true,  0b111, 1, "T  TTT TTT TTT TTT TTT TTT TTT TTT  T"},
};
// clang-format on

Action action(char letter) {
  switch (letter) {
    case 'R':
      return Action::turn_right;
    case 'L':
      return Action::turn_left;
    case 'Z':
      return Action::zero;
    default:
      ck_assert_int_eq(letter, 'T');
      return Action::track;
  }
}

}  // namespace

START_TEST(the_papers_rules_answer_as_its_truth_table_in_416_cases) {
  int cases = 0;
  for (const Row& row : kPaper) {
    const char* letter = row.actions;
    for (const double angle : kAngles) {
      letter += std::strspn(letter, " ");
      const RuleTable::Match match =
          paper_rules().evaluate(row.camera, static_cast<SensorBits>(row.sensors), radians(angle));
      ck_assert_ptr_nonnull(match.rule);
      ck_assert_msg(match.rule->number == row.rule, "camera %d, sensors %u, pan %g: rule %d, not %d",
                    row.camera, row.sensors, angle, match.rule->number, row.rule);
      ck_assert_msg(match.band->action == action(*letter), "camera %d, sensors %u, pan %g: %s, not %c",
                    row.camera, row.sensors, angle, name(match.band->action).data(), *letter);
      ++letter;
      ++cases;
    }
    ck_assert_int_eq(*letter, '\0');
  }
  ck_assert_int_eq(cases, 416);
}
END_TEST

START_TEST(sensors_beyond_the_papers_three_change_nothing) {
  for (const Row& row : kPaper)
    for (const double angle : kAngles) {
      const auto sensors = static_cast<SensorBits>(row.sensors);
      const auto more = static_cast<SensorBits>(row.sensors | 0b11111000);
      ck_assert_ptr_eq(paper_rules().evaluate(row.camera, sensors, radians(angle)).band,
                       paper_rules().evaluate(row.camera, more, radians(angle)).band);
    }
}
END_TEST

START_TEST(an_unknown_pan_angle_meets_only_what_holds_everywhere) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  ck_assert_int_eq(paper_rules().evaluate(true, 0, unknown).rule->number, 1);
  ck_assert_int_eq(paper_rules().evaluate(false, 0, unknown).rule->number, 7);
  // Rule 2's "else": no turn without knowing where the head is.
  ck_assert(paper_rules().evaluate(false, 1, unknown).band->action == Action::track);
}
END_TEST

START_TEST(a_band_ends_at_its_limits) {
  const Band closed{.lower = 1, .upper = 2},
      open{.lower = 1, .upper = 2, .lower_included = false, .upper_included = false};
  ck_assert(closed.holds(1) && closed.holds(2) && closed.holds(1.5) && !closed.holds(0.999) &&
            !closed.holds(2.001));
  ck_assert(!open.holds(1) && !open.holds(2) && open.holds(1.5));
  ck_assert(!closed.unlimited() && Band{}.unlimited() && Band{}.holds(-1e300));
}
END_TEST

START_TEST(a_rule_asks_for_all_for_any_and_for_none) {
  const Rule rule{.number = 1,
                  .name = "r",
                  .camera = Camera::missing,
                  .all = 0b0001,
                  .any = 0b0110,
                  .none = 0b1000,
                  .bands = {}};
  ck_assert(rule.matches(false, 0b0011) && rule.matches(false, 0b0101) && rule.matches(false, 0b0111));
  ck_assert(!rule.matches(true, 0b0011) && !rule.matches(false, 0b0001) && !rule.matches(false, 0b0110) &&
            !rule.matches(false, 0b1011));
}
END_TEST

START_TEST(a_rule_without_a_band_for_the_angle_lets_the_next_one_speak) {
  const RuleTable table{
      .name = "t",
      .sensors = 1,
      .precedence = Precedence::order,
      .rules = {{.number = 1, .name = "left", .bands = {{.upper = 0, .action = Action::turn_right}}},
                {.number = 2, .name = "rest", .bands = {{.action = Action::hold}}}}};
  ck_assert_int_eq(table.evaluate(false, 0, -1).rule->number, 1);
  ck_assert_int_eq(table.evaluate(false, 0, 1).rule->number, 2);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "rules",
      {the_papers_rules_answer_as_its_truth_table_in_416_cases,
       sensors_beyond_the_papers_three_change_nothing, an_unknown_pan_angle_meets_only_what_holds_everywhere,
       a_band_ends_at_its_limits, a_rule_asks_for_all_for_any_and_for_none,
       a_rule_without_a_band_for_the_angle_lets_the_next_one_speak});
}
