// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/helper/program_check.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>

#include "drivers/helper/helper_process.h"

namespace cerberus::drivers {

namespace {

using Clock = std::chrono::steady_clock;

// Derived: a shell or a helper that only reads its words needs milliseconds; a loaded machine a hundred times as long.
constexpr std::chrono::seconds kPatience{3};

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
         c == '.' || c == '/' || c == '+';
}

}  // namespace

std::string first_line_of(const std::vector<std::string>& arguments) {
  HelperProcess process;
  if (!process.start(arguments).empty()) return {};
  ::shutdown(process.fd(), SHUT_WR);
  std::string all;
  const Clock::time_point end = Clock::now() + kPatience;
  bool open = true;
  while (open && all.find('\n') == all.npos) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd wait{process.fd(), POLLIN, 0};
    if (left <= 0 || ::poll(&wait, 1, static_cast<int>(left)) <= 0) break;
    open = process.receive(all);
  }
  process.finish();
  return all.substr(0, std::min(all.find('\n'), all.size()));
}

std::string command_fault(const std::string& command) {
  const std::size_t begin = command.find_first_not_of(" \t");
  if (begin == command.npos) return "it is empty: name a program";
  const std::string word = command.substr(begin, command.find_first_of(" \t", begin) - begin);
  // Quotes, variables, assignments: only the shell itself knows what they run.
  if (!std::ranges::all_of(word, is_plain)) return {};
  if (!first_line_of({"/bin/sh", "-c", "command -v -- \"$0\"", word}).empty()) return {};
  return "there is no program \"" + word + "\" that could be run: install it, or give its path";
}

}  // namespace cerberus::drivers
