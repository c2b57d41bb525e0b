// SPDX-License-Identifier: LGPL-2.1-or-later
// The newest picture and facts of a camera, which its streaming threads leave for the main loop.
#pragma once

#include <mutex>
#include <string>

#include "camera.h"

namespace cerberus::robot {

// Lives as long as a callback may run.
struct Camera::Newest {
  ~Newest() { g_clear_pointer(&picture, g_bytes_unref); }

  std::mutex lock;
  Camera* camera = nullptr;  // nullptr: it is gone; main loop's thread
  GBytes* picture = nullptr;
  guint64 number = 0;
  std::string facts;
  bool show = false;       // else what arrives is dropped
  bool announced = false;  // a call of on_picture is on its way
};

}  // namespace cerberus::robot
