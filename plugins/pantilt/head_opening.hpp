// SPDX-License-Identifier: LGPL-2.1-or-later
// From settings to a head that is open, or being opened, and that nobody else in this process drives.
#pragma once

#include <gst/gst.h>

#include <functional>
#include <memory>

#include "drivers/head/head_runner.h"
#include "head_settings.hpp"

namespace cerberus::plugin {

// A change of state takes at most these together and one stop of 30 ms, whatever the driver does (100 ms is promised).
constexpr auto kOpenPatience = std::chrono::milliseconds(60);
constexpr auto kClosePatience = std::chrono::milliseconds(30);

// nullptr: it cannot be, and `element` has said why. moved, refused: as of the runner.
std::unique_ptr<drivers::HeadRunner> open_head(GstElement* element, const HeadSettings& settings,
                                               std::function<void()> moved, std::function<void()> refused);

}  // namespace cerberus::plugin
