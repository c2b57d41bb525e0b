// SPDX-License-Identifier: LGPL-2.1-or-later
// What is wrong in a picture: counted, and asserted once. An assertion for each pixel costs more than what it looks at,
// as check writes down each one that it comes by.
#pragma once

#include <check.h>

namespace cerberus::tests {

class Wrong {
 public:
  void unless(bool right, int x, int y) {
    if (right || count_++ > 0) return;
    x_ = x, y_ = y;
  }
  void assert_none(const char* what) const {
    ck_assert_msg(count_ == 0, "%s: wrong in %ld places, the first is %d,%d", what, count_, x_, y_);
  }

 private:
  long count_ = 0;
  int x_ = 0, y_ = 0;
};

}  // namespace cerberus::tests
