// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <utility>

#include "vision/image/pyramid.h"

namespace cerberus::tests {

// A pyramid with the picture that it borrows.
class KeptPyramid : public vision::Pyramid {
 public:
  KeptPyramid(vision::Image<std::uint8_t> picture, int levels) : picture_(std::move(picture)) {
    borrow(picture_.view(), levels);
  }
  KeptPyramid(const KeptPyramid&) = delete;
  KeptPyramid& operator=(const KeptPyramid&) = delete;

 private:
  vision::Image<std::uint8_t> picture_;
};

}  // namespace cerberus::tests
