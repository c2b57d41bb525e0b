// SPDX-License-Identifier: LGPL-2.1-or-later
#include "publish/streams/rate_limit.h"

#include <algorithm>

namespace cerberus::publish {

namespace {

bool is_loopback(std::string_view address) {
  return address == "::1" || address.starts_with("127.") || address.starts_with("::ffff:127.");
}

}  // namespace

void RateLimit::fail(Entry& entry, int free, Time now) const {
  entry.last = now;
  if (++entry.failures < free) return;
  const int doublings = std::min(entry.failures - free, 20);
  entry.until = now + std::min(parameters_.first * (1 << doublings), parameters_.longest);
}

std::chrono::seconds RateLimit::wait(std::string_view address, Time now) const {
  Time until = is_loopback(address) ? Time{} : all_.until;
  for (const Entry& entry : entries_)
    if (entry.address == address) until = std::max(until, entry.until);
  return until <= now ? std::chrono::seconds(0) : std::chrono::ceil<std::chrono::seconds>(until - now);
}

void RateLimit::failed(std::string_view address, Time now) {
  // An hour without a wrong password is forgotten.
  if (now - all_.last > std::chrono::hours(1)) all_ = {};
  std::erase_if(entries_, [&](const Entry& entry) { return now - entry.last > std::chrono::hours(1); });
  fail(all_, parameters_.free_of_all, now);
  auto found = std::ranges::find(entries_, address, &Entry::address);
  if (found == entries_.end()) {
    if (entries_.size() >= parameters_.most)
      entries_.erase(std::ranges::min_element(entries_, {}, &Entry::last));
    found = entries_.insert(entries_.end(), Entry{std::string(address), 0, {}, {}});
  }
  fail(*found, parameters_.free, now);
}

void RateLimit::succeeded(std::string_view address) {
  all_ = {};
  std::erase_if(entries_, [&](const Entry& entry) { return entry.address == address; });
}

}  // namespace cerberus::publish
