// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/rule_check.h"

#include <check.h>

#include <algorithm>
#include <limits>
#include <random>
#include <string>

#include "sensing/angles.h"
#include "support/suite.h"

using namespace cerberus::fusion;
using cerberus::sensing::radians;
using Kind = RuleProblem::Kind;

namespace {

Band band(double from, double to, Action action) {
  return {.lower = radians(from), .upper = radians(to), .action = action};
}

// camera found: track; else turn right below 0 degrees, left above, hold at 0.
RuleTable sound_table() {
  return {.name = "sound",
          .sensors = 1,
          .precedence = Precedence::exact,
          .rules = {{.number = 1, .name = "rule 1", .camera = Camera::found, .bands = {{}}},
                    {.number = 2,
                     .name = "rule 2",
                     .camera = Camera::missing,
                     .bands = {{.upper = 0, .upper_included = false, .action = Action::turn_right},
                               {.lower = 0, .lower_included = false, .action = Action::turn_left},
                               {.lower = 0, .upper = 0, .action = Action::hold}}}}};
}

void assert_only_problem(const RuleTable& table, Kind kind, const char* text) {
  const std::vector<RuleProblem> problems = check(table, 0);
  ck_assert_int_eq(static_cast<int>(problems.size()), 1);
  ck_assert(problems[0].kind == kind);
  ck_assert_str_eq(problems[0].text.c_str(), text);
}

}  // namespace

START_TEST(a_sound_table_has_no_problems) {
  ck_assert(check(sound_table()).empty());
  ck_assert(check(paper_rules()).empty());
}
END_TEST

START_TEST(a_gap_of_a_single_angle_is_named) {
  RuleTable table = sound_table();
  table.rules[1].bands.pop_back();
  table.rules[1].all = 1;
  table.rules.push_back({.number = 3, .name = "rule 3", .camera = Camera::missing, .none = 1, .bands = {{}}});
  assert_only_problem(table, Kind::open, "camera not found, infer1 fired, pan at 0 degrees: no rule applies");
}
END_TEST

START_TEST(a_gap_names_the_sensors_and_the_angles) {
  RuleTable table = paper_rules();
  table.rules.pop_back();  // without rule 7
  assert_only_problem(table, Kind::open, "camera not found, no sensor fired, any pan angle: no rule applies");

  table = paper_rules();
  table.rules[1]
      .bands.pop_back();  // rule 5 without its "else": the rules behind it take over, but not everywhere
  ck_assert(check(table).empty());
  table.rules.erase(table.rules.begin() + 2, table.rules.begin() + 6);
  const std::vector<RuleProblem> problems = check(table, 0);
  ck_assert_int_eq(static_cast<int>(problems.size()), 7);
  ck_assert_str_eq(
      problems[2].text.c_str(),
      "camera not found, infer1 and infer2 fired, pan from -90 up to 0 degrees: no rule applies");
  ck_assert_str_eq(
      problems[6].text.c_str(),
      "camera not found, infer1, infer2 and infer3 fired, pan from -90 up to 0 degrees: no rule applies");
  ck_assert_int_eq(static_cast<int>(check(table, 3).size()), 3);
}
END_TEST

START_TEST(the_papers_rules_contradict_each_other_unless_their_order_counts) {
  RuleTable table = paper_rules();
  table.precedence = Precedence::exact;
  bool named = false;
  for (const RuleProblem& problem : check(table, 0)) {
    ck_assert(problem.kind == Kind::contradiction);
    named =
        named ||
        problem.text ==
            "camera found, infer1 fired, pan up to -45 degrees: rule 1 says track, rule 2 says turn-right";
  }
  ck_assert(named);
}
END_TEST

START_TEST(two_rules_that_say_the_same_are_no_contradiction) {
  RuleTable table = sound_table();
  table.rules.push_back({.number = 3, .name = "rule 3", .camera = Camera::found, .all = 1, .bands = {{}}});
  ck_assert(check(table).empty());
  table.rules[2].bands[0].action = Action::zero;
  assert_only_problem(table, Kind::contradiction,
                      "camera found, infer1 fired, any pan angle: rule 1 says track, rule 3 says zero");
}
END_TEST

START_TEST(bands_of_one_rule_must_agree_where_they_meet_unless_their_order_counts) {
  RuleTable table = sound_table();
  table.rules[1].bands = {
      band(-200, -45, Action::turn_right), band(-60, 200, Action::turn_left), {.action = Action::hold}};
  assert_only_problem(
      table, Kind::contradiction,
      "rule 2, pan from -60 up to -45 degrees: one band says turn-right, another says turn-left");
  table.precedence = Precedence::order;
  ck_assert(check(table).empty());
}
END_TEST

START_TEST(searches_of_different_places_contradict_each_other) {
  RuleTable table = sound_table();
  table.rules[0].bands[0] = {.action = Action::search, .search = {radians(-10), radians(20)}};
  table.rules.push_back(table.rules[0]);
  ck_assert(check(table).empty());
  table.rules[2].name = "rule 3";
  table.rules[2].bands[0].search.to = radians(30);
  assert_only_problem(
      table, Kind::contradiction,
      "camera found, no sensor fired, any pan angle: rule 1 says search (-10 to 20 degrees), rule 3 "
      "says search (-10 to 30 degrees)");
}
END_TEST

START_TEST(a_malformed_table_is_reported_before_anything_else) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  RuleTable table = sound_table();
  table.sensors = 17;
  assert_only_problem(table, Kind::malformed, "the number of sensors is not 1 to 16");
  table = sound_table();
  table.rules[0].all = 0b100;
  assert_only_problem(table, Kind::malformed, "rule 1: names a sensor beyond the 1 there are");
  table = sound_table();
  table.rules[0].all = table.rules[0].none = 1;
  assert_only_problem(table, Kind::malformed, "rule 1: asks a sensor to detect and not to detect");
  table = sound_table();
  table.rules[0].any = table.rules[0].none = 1;
  assert_only_problem(table, Kind::malformed, "rule 1: asks a sensor to detect and not to detect");
  table = sound_table();
  table.rules[0].bands.clear();
  assert_only_problem(table, Kind::malformed, "rule 1: has no action");
  for (const Band& bad : {band(10, -10, Action::track), band(unknown, 10, Action::track),
                          Band{.lower = 0, .upper = 0, .upper_included = false}}) {
    table = sound_table();
    table.rules[0].bands.push_back(bad);
    ck_assert(check(table).size() == 1 && check(table)[0].kind == Kind::malformed);
  }
  for (const cerberus::sensing::Interval& bad : {cerberus::sensing::Interval{1, 0}, {0, unknown}}) {
    table = sound_table();
    table.rules[0].bands = {{.action = Action::search, .search = bad}};
    ck_assert(check(table).size() == 1 && check(table)[0].kind == Kind::malformed);
  }
}
END_TEST

// The checker against trying: on random tables with edges at whole degrees, whole and half degrees are all there is.
START_TEST(the_checker_finds_what_trying_every_case_finds) {
  std::mt19937 random(5);
  int sound = 0, bad = 0;
  for (int round = 0; round < 4000; ++round) {
    RuleTable table{.name = "random",
                    .sensors = 2,
                    .precedence = random() % 2 ? Precedence::exact : Precedence::order,
                    .rules = {}};
    for (unsigned n = 1 + random() % 4; n > 0; --n) {
      Rule rule{.number = static_cast<int>(n), .name = "r"};
      rule.camera = static_cast<Camera>(random() % 3);
      const auto some = [&] { return static_cast<SensorBits>(random() % 4 ? 0 : random() % 4); };
      rule.all = some();
      rule.any = some();
      rule.none = static_cast<SensorBits>(some() & ~rule.all & ~rule.any);
      const int edge = static_cast<int>(random() % 3) - 1;
      const bool included = random() % 2;
      if (random() % 2) {
        rule.bands.push_back(
            {.upper = radians(edge), .upper_included = included, .action = Action::turn_right});
        rule.bands.push_back({.lower = radians(edge),
                              .lower_included = random() % 4 ? !included : included,
                              .action = random() % 2 ? Action::turn_right : Action::turn_left});
      } else {
        rule.bands.push_back({.action = random() % 2 ? Action::turn_right : Action::turn_left});
      }
      table.rules.push_back(rule);
    }
    bool expected = true;
    for (const bool camera : {false, true})
      for (SensorBits fired = 0; fired < 4; ++fired)
        for (double degree = -3; degree <= 3; degree += 0.5) {
          bool left = false, right = false;
          for (const Rule& rule : table.rules) {
            if (!rule.matches(camera, fired)) continue;
            for (const Band& each : rule.bands) {
              if (!each.holds(radians(degree))) continue;
              (each.action == Action::turn_left ? left : right) = true;
            }
          }
          expected = expected && (left || right);
          if (table.precedence == Precedence::exact) expected = expected && !(left && right);
        }
    // Bands that contradict each other in a rule which never applies are still refused; so is this oracle's luck.
    const bool found =
        std::ranges::all_of(check(table), [](const RuleProblem& p) { return p.kind == Kind::idle; });
    if (found != expected) {
      if (table.precedence == Precedence::order || !expected)
        ck_abort_msg("round %d: the checker says %d", round, found);
      continue;
    }
    ++(found ? sound : bad);
  }
  ck_assert_int_gt(sound, 100);
  ck_assert_int_gt(bad, 100);
}
END_TEST

// The user who sets the file waits for this: 16 sensors are 131072 cases.
START_TEST(a_table_of_any_size_is_checked_soon_or_refused) {
  const auto table = [](int sensors, int rules, int bands) {
    RuleTable table{.name = "large", .sensors = 16, .precedence = Precedence::exact, .rules = {}};
    for (int i = 0; i < rules; ++i) {
      Rule rule{.number = i + 1, .name = "rule " + std::to_string(i + 1)};
      rule.all = static_cast<SensorBits>(1U << i % sensors);
      rule.none = static_cast<SensorBits>(rule.all - 1);
      for (int k = 0; k < bands; ++k)
        rule.bands.push_back(band(-170 + k + 0.01 * i, -169.5 + k + 0.01 * i, Action::turn_right));
      rule.bands.push_back({.action = Action::hold});
      table.rules.push_back(rule);
    }
    table.rules.push_back(
        {.number = 99, .name = "rest", .none = static_cast<SensorBits>((1U << sensors) - 1), .bands = {{}}});
    return table;
  };
  ck_assert(check(table(16, 16, 3)).empty());
  ck_assert(check(table(16, 16, 8)).empty());
  assert_only_problem(
      table(16, 160, 40), Kind::malformed,
      "the table is too large to be checked: 161 rules that name 16 sensors, with 4110 edges of "
      "bands");
  const auto refused = [](const RuleTable& table) {
    const auto problems = check(table);
    ck_assert(problems.size() == 1 && problems[0].text.starts_with("the table is too large"));
  };
  refused(table(1, 1, 30000));  // one rule, as long as a file may be
  refused(table(1, 3000, 10));
}
END_TEST

START_TEST(what_never_applies_is_named) {
  RuleTable table = paper_rules();
  table.rules.insert(table.rules.begin(), {.number = 9, .name = "all", .bands = {{}}});
  std::string named;
  for (const RuleProblem& problem : check(table, 0)) {
    ck_assert(problem.kind == Kind::idle);
    named += problem.text + '\n';
  }
  ck_assert(
      named.starts_with("rule 1 never applies: the rules before it decide in every case\nrule 5 never"));
  ck_assert_int_eq(static_cast<int>(std::ranges::count(named, '\n')), 7);

  table = sound_table();  // a band behind the "else", whatever the precedence
  table.rules[0].bands.push_back(band(10, 20, Action::hold));
  for (const Precedence precedence : {Precedence::exact, Precedence::order}) {
    table.precedence = precedence;
    assert_only_problem(
        table, Kind::idle,
        "rule 1: the band that says hold pan from 10 up to 20 degrees never applies: what stands "
        "before it decides in every case");
  }
}
END_TEST

START_TEST(what_lies_beyond_the_limits_is_named) {
  const cerberus::sensing::Interval limits{radians(-170), radians(170)};
  ck_assert(out_of_reach(paper_rules(), limits).empty());
  RuleTable table = sound_table();
  const auto says = [&](const char* text) {
    const std::vector<std::string> found = out_of_reach(table, limits);
    ck_assert_int_eq(static_cast<int>(found.size()), 1);
    ck_assert_str_eq(found[0].c_str(), text);
  };
  table.rules[0].bands = {{.action = Action::search, .search = {radians(175), radians(185)}}};
  says("rule 1: the sweep from 175 to 185 degrees lies beyond the head's limits, -170 to 170 degrees");
  table.rules[0].bands[0].search.from = radians(160);  // the head goes as far as it can
  ck_assert(out_of_reach(table, limits).empty());
  table.rules[0].bands = {{.lower = radians(400)}, {}};
  says("rule 1, pan from 400 degrees: the head turns from -170 to 170 degrees only, so that never applies");
  table.rules[0].bands[0] = {.upper = radians(-170), .upper_included = false};
  ck_assert_int_eq(static_cast<int>(out_of_reach(table, limits).size()), 1);
  table.rules[0].bands[0].upper_included = true;  // at the stop
  ck_assert(out_of_reach(table, limits).empty());
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "rule_check",
      {a_sound_table_has_no_problems, a_gap_of_a_single_angle_is_named,
       a_gap_names_the_sensors_and_the_angles,
       the_papers_rules_contradict_each_other_unless_their_order_counts,
       two_rules_that_say_the_same_are_no_contradiction,
       bands_of_one_rule_must_agree_where_they_meet_unless_their_order_counts,
       searches_of_different_places_contradict_each_other, a_malformed_table_is_reported_before_anything_else,
       the_checker_finds_what_trying_every_case_finds, a_table_of_any_size_is_checked_soon_or_refused,
       what_never_applies_is_named, what_lies_beyond_the_limits_is_named});
}
