// SPDX-License-Identifier: LGPL-2.1-or-later
// cerberus-heads: lists heads, moves one, measures one.
#pragma once

#include <string>
#include <vector>

#include "drivers/head/head.h"

namespace cerberus::heads {

struct ToolOptions {
  std::string driver;
  drivers::HeadSetup setup;
  double pan = 0, tilt = 0;  // degrees a second, of move
  double seconds = 1;        // of move
  std::string source = "v4l2src ! videoconvert";
  double horizontal_fov = 0;  // degrees
  std::string output = "head.calibration";
  bool yes = false;  // do not ask
};

// Each returns the exit status.
int list_heads(const std::vector<std::string>& named);
int move_head(const ToolOptions& options);
int calibrate_head(const ToolOptions& options);

// Watches the keyboard: the first key, or the end of the input of a terminal, ends what moves.
class Keys {
 public:
  Keys();
  ~Keys();
  Keys(const Keys&) = delete;
  // Prints the text and waits for a key. False: the key is not Enter or a blank, or there is no keyboard.
  static bool ask(const std::string& text);
  bool pressed();
  // Forgets the keys that were pressed.
  void clear();

 private:
  bool terminal_ = false;
};

}  // namespace cerberus::heads
