// SPDX-License-Identifier: LGPL-2.1-or-later
// What is promised in real time. A machine with other work may take a time slice anywhere, so the best of several
// rounds counts: what waits for something is slow in each of them.
#pragma once

#include <algorithm>
#include <chrono>
#include <string>

#include <gst/check/gstcheck.h>  // last: its macro `fail` is a name in the library's headers

// Unlock and every change of state.
inline constexpr std::chrono::milliseconds kPromised(100);
inline constexpr int kRounds = 20;

template <typename Action>
std::chrono::milliseconds time_taken(Action&& action) {
  const auto start = std::chrono::steady_clock::now();
  action();
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - start);
}

// round(): how long it took.
template <typename Round>
void assert_prompt(const char* what, Round&& round) {
  auto best = std::chrono::milliseconds::max();
  for (int k = 0; k < kRounds && best >= kPromised; ++k) best = std::min(best, round());
  fail_unless(best < kPromised, "%s takes %d ms", what, static_cast<int>(best.count()));
}

// round(): returns what was reported. A driver's thread may answer after the wait for it has ended, and the lateness
// is then reported: one good round of several is enough. Without such a thread there is no lateness, and the first
// round must be right.
enum class Answers { at_once, on_a_thread };
template <typename Round>
void assert_said(const std::string& expected, Answers answers, Round&& round) {
  const int rounds = answers == Answers::on_a_thread ? kRounds : 1;
  std::string said;
  for (int k = 0; k < rounds && said != expected; ++k) said = round();
  fail_unless(said == expected, "\"%s\" and not \"%s\"", said.c_str(), expected.c_str());
}
