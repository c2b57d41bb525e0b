// SPDX-License-Identifier: LGPL-2.1-or-later
// Vector kernels are chosen for the processor at run time; a test of them runs on every choice this processor has.
#pragma once

#include <hwy/highway.h>

#include <cstdlib>
#include <initializer_list>
#include <string>

#include "support/suite.h"

namespace cerberus::tests {

inline int run_suite_on_every_target(const char* name, std::initializer_list<const TTest*> tests) {
  bool passed = true;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    const std::string suite = std::string(name) + " on " + hwy::TargetName(target);
    passed = run_suite(suite.c_str(), tests) == EXIT_SUCCESS && passed;
  }
  return passed ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace cerberus::tests
