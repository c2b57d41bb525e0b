// SPDX-License-Identifier: LGPL-2.1-or-later
// cerberusd: a whole robot from one configuration file, documented in docs/manual/robot.md.
#include <cstdio>
#include <string>

#include "robot/settings_file.h"

int main(int argc, char** argv) {
  if (argc != 3 || std::string(argv[1]) != "--check") {
    std::fprintf(stderr, "usage: cerberusd --check FILE\n");
    return 2;
  }
  const cerberus::robot::SettingsFile file = cerberus::robot::load_settings(argv[2]);
  if (!file.settings) {
    std::fprintf(stderr, "%s\n", file.errors.c_str());
    return 1;
  }
  std::printf("%s: no mistake\n", argv[2]);
  return 0;
}
