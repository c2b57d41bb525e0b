// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page_log.h"

#include <glib.h>

#include <cstdio>
#include <deque>
#include <mutex>

namespace cerberus::robot {

namespace {

constexpr std::size_t kMost = 300;  // lines: a day without faults, a minute of many

struct Log {
  std::mutex lock;  // messages come from any thread
  std::deque<std::string> lines;
};
Log& log() {
  static Log all;
  return all;
}

}  // namespace

void collect_log() {
  g_set_printerr_handler([](const gchar* text) {
    std::fputs(text, stderr);
    g_autoptr(GDateTime) now = g_date_time_new_now_local();
    g_autofree gchar* time = g_date_time_format(now, "%F %T ");
    Log& all = log();
    const std::lock_guard guard(all.lock);
    all.lines.push_back(std::string(time) + text);
    if (all.lines.size() > kMost) all.lines.pop_front();
  });
}

std::string collected_log() {
  Log& all = log();
  const std::lock_guard guard(all.lock);
  std::string text;
  for (const std::string& line : all.lines) text += line;
  return text;
}

}  // namespace cerberus::robot
