// SPDX-License-Identifier: LGPL-2.1-or-later
// The window on the screen, where there is one: a pipeline of its own, so that whatever happens to it (no display after
// all, closed by its user) ends there and changes nothing else.
#pragma once

#include <gst/gst.h>

namespace cerberus::demo {

class Screen {
 public:
  Screen() = default;
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  // Shows what leaves `pad`, as much of it as the screen keeps up
  // with. Says so where a display is there and cannot be used.
  void show(GstPad* pad);

 private:
  bool open();

  GstElement* pipeline_ = nullptr;
};

}  // namespace cerberus::demo
