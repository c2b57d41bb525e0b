// SPDX-License-Identifier: LGPL-2.1-or-later
// Checks that a rule table has exactly one answer in every case. The check enumerates all cases: the edges of all bands
// cut the pan axis into finitely many pieces (points and open intervals) on which no answer changes.
#pragma once

#include <string>
#include <vector>

#include "fusion/rules.h"

namespace cerberus::fusion {

struct RuleProblem {
  enum class Kind { open, contradiction, malformed, idle };
  Kind kind;
  // For a user, with the case in words: "camera not found, infer2 and infer3 fired, pan from -60 to 0 degrees: no rule
  // applies", "camera found, infer1 fired, pan up to -45 degrees: rule 1 says track, rule 2 says turn-right".
  std::string text;
};

// Returns the problems of a table, at most the first `most` (0 = all). Empty: the table may be used.
//   open           no rule applies (either precedence)
//   contradiction  precedence exact: two rules, or two limited bands of one rule, give different actions
//   malformed      sensor count not in 1..16; a rule that names other sensors, requires one to detect and not to
//                  detect, or has no bands; a band that is empty or has NaN limits; a search without a proper interval;
//                  or a table too large to be checked in some seconds (dozens of rules with hundreds of bands for 16
//                  sensors)
//   idle           a rule, or a band of one, that decides in no case because others precede it, which its author
//                  cannot have intended
std::vector<RuleProblem> check(const RuleTable& table, int most = 8);

// Returns, as texts for the user, the sweeps and bands of a table that lie wholly beyond these pan limits (radians) and
// never apply.
std::vector<std::string> out_of_reach(const RuleTable& table, const sensing::Interval& limits);

}  // namespace cerberus::fusion
