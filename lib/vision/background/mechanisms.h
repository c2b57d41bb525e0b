// SPDX-License-Identifier: LGPL-2.1-or-later
// Mechanisms of the foreground mask that have no number by which they can be switched off. Only benches leave one out, to
// measure what it is good for (tests/bench/mechanisms.h).
#pragma once

#include "vision/components/components.h"

namespace cerberus::vision {

struct ForegroundMechanisms {
  bool light = true;        // background_light.h
  bool alignment = true;    // alignment.h
  bool mosaic = true;       // mosaic.h
  bool motion_blur = true;  // motion_blur.h
  ComponentMechanisms components;
};

}  // namespace cerberus::vision
