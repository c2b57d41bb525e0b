// SPDX-License-Identifier: LGPL-2.1-or-later
// A locale with a decimal comma, for as long as this lives. Where
// none is installed it is made: its source comes with libc.
#pragma once

#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace cerberus::tests {

class German {
 public:
  German() {
    const char* temporary = std::getenv("TMPDIR");
    std::string folder = std::string(temporary ? temporary : "/tmp") + "/cerberus-XXXXXX";
    const bool place = ::mkdtemp(folder.data()) != nullptr;
    if (place && does("localedef -i de_DE -f UTF-8 '" + folder + "/de_DE.UTF-8' 2>/dev/null"))
      ::setenv("LOCPATH", folder.c_str(), 1);
    there_ = std::setlocale(LC_ALL, "de_DE.UTF-8") && *std::localeconv()->decimal_point == ',';
    if (place) does("rm -r '" + folder + "'");
    if (!there_) std::puts("skipped: no German locale is installed, and localedef cannot make one");
  }
  ~German() { std::setlocale(LC_ALL, "C"); }
  German(const German&) = delete;
  German& operator=(const German&) = delete;

  // Returns false, with a message, if there is none.
  explicit operator bool() const { return there_; }

 private:
  static bool does(const std::string& command) { return std::system(command.c_str()) == 0; }

  bool there_ = false;
};

}  // namespace cerberus::tests
