// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

#include <check.h>  // last: it defines fail()

namespace cerberus::tests {

inline void assert_text(const std::string& text, const char* expected) {
  ck_assert_str_eq(text.c_str(), expected);
}

}  // namespace cerberus::tests
