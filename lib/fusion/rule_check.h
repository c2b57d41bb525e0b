// SPDX-License-Identifier: LGPL-2.1-or-later
// Is there an answer, and only one, in every case of a rule table? Decided by enumeration, not by sampling: the edges
// of all bands cut the pan axis into finitely many pieces (points and open intervals) on which nothing changes.
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

// Everything that is wrong, the first `most` of it (0 = all). Empty: the table may be used.
//   open           no rule applies (either precedence)
//   contradiction  precedence exact: two rules, or two limited bands of one rule, give different actions
//   malformed      sensor count not in 1..16, a rule that names other sensors, asks one to detect and not to, or has no
//                  bands; a band that is empty or has NaN limits; a search without a proper interval; or all of it is
//                  too large to be checked in some seconds: dozens of rules and hundreds of bands for 16 sensors are
//   idle           a rule, or a band of one, that decides in no case, because others go before it: its author did not
//                  mean that
std::vector<RuleProblem> check(const RuleTable& table, int most = 8);

// What a head with these pan limits (radians) never does of it, in
// words: sweeps and bands of angles that lie beyond them altogether.
std::vector<std::string> out_of_reach(const RuleTable& table, const sensing::Interval& limits);

}  // namespace cerberus::fusion
