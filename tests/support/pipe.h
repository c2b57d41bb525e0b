// SPDX-License-Identifier: LGPL-2.1-or-later
// A pipe for the scripted head, which blocks on what a script names: descriptors, as text.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <string>

namespace cerberus::tests {

struct Pipe {
  int ends[2];
  Pipe() {
    if (::pipe(ends) != 0) std::abort();
  }
  ~Pipe() {
    close_writer();
    ::close(ends[0]);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  std::string reader() const { return std::to_string(ends[0]); }
  std::string writer() const { return std::to_string(ends[1]); }
  void close_writer() {
    if (ends[1] >= 0) ::close(ends[1]);
    ends[1] = -1;
  }
  // What was written so far; waits for the first of it.
  std::string read() const {
    char text[4096];
    const ssize_t count = ::read(ends[0], text, sizeof text);
    return count > 0 ? std::string(text, static_cast<std::size_t>(count)) : std::string();
  }
  std::string line() const {
    std::string text;
    for (char c = 0; ::read(ends[0], &c, 1) == 1 && c != '\n';) text += c;
    return text;
  }
};

}  // namespace cerberus::tests
