// SPDX-License-Identifier: LGPL-2.1-or-later
// The properties of virtualptz.
#pragma once

#include <span>
#include <string>

#include "head_wait.hpp"
#include "shared/properties.hpp"

namespace cerberus::plugin {

struct WindowSettings {
  int width = 0, height = 0;
  double wide_fov = 60, horizontal_fov = 0;
  double start_pan = 0, start_tilt = 0;
  bool inset = false;
  std::string head = "head";
  int lockstep = LOCKSTEP_AUTO;
  guint64 lockstep_timeout = 10 * GST_SECOND;
};

std::span<const Property<WindowSettings>> window_properties();

}  // namespace cerberus::plugin
