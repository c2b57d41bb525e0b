// SPDX-License-Identifier: LGPL-2.1-or-later
// The main function that every unit test program shares.
#pragma once

#include <check.h>

#include <cstdlib>
#include <initializer_list>

namespace cerberus::tests {

inline int run_suite(const char* name, std::initializer_list<const TTest*> tests, double timeout = 60) {
  Suite* suite = suite_create(name);
  TCase* cases = tcase_create(name);
  tcase_set_timeout(cases, timeout);
  for (const TTest* test : tests) tcase_add_test(cases, test);
  suite_add_tcase(suite, cases);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

}  // namespace cerberus::tests
