// SPDX-License-Identifier: LGPL-2.1-or-later
#include "publish/streams/rate_limit.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <utility>

namespace cerberus::publish {

namespace {

bool is_loopback(std::string_view address) {
  return address == "::1" || address.starts_with("127.") || address.starts_with("::ffff:127.");
}

// Of an IPv6 address that is none of IPv4 in its form (::ffff:0:0/96), the network; any other text as it is.
std::string network_of(std::string_view address) {
  std::array<unsigned char, 16> bytes{};
  const std::string text(address.substr(0, address.find('%')));
  if (is_loopback(address) || ::inet_pton(AF_INET6, text.c_str(), bytes.data()) != 1)
    return std::string(address);
  constexpr std::array<unsigned char, 12> mapped{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};
  if (std::equal(mapped.begin(), mapped.end(), bytes.begin())) return text;
  std::fill(bytes.begin() + 8, bytes.end(), 0);
  std::array<char, INET6_ADDRSTRLEN> network{};
  ::inet_ntop(AF_INET6, bytes.data(), network.data(), network.size());
  return std::string(network.data()) + "/64";
}

std::string key_of(std::string_view address, std::string_view account) {
  return network_of(address) + ' ' + std::string(account);
}

}  // namespace

void RateLimit::fail(Entry& entry, int free, std::chrono::seconds first, std::chrono::seconds longest,
                     Time now) {
  entry.last = now;
  if (++entry.failures < free) return;
  const int doublings = std::min(entry.failures - free, 20);
  entry.until = now + std::min(first * (1 << doublings), longest);
}

std::chrono::seconds RateLimit::wait(std::string_view address, std::string_view account, Time now) const {
  Time until = is_loopback(address) ? Time{} : all_.until;
  const auto found = std::ranges::find(entries_, key_of(address, account), &Entry::key);
  if (found != entries_.end()) until = std::max(until, found->until);
  return until <= now ? std::chrono::seconds(0) : std::chrono::ceil<std::chrono::seconds>(until - now);
}

void RateLimit::failed(std::string_view address, std::string_view account, Time now) {
  // An hour without a wrong password is forgotten.
  if (now - all_.last > std::chrono::hours(1)) all_ = {};
  std::erase_if(entries_, [&](const Entry& entry) { return now - entry.last > std::chrono::hours(1); });
  fail(all_, parameters_.free_of_all, parameters_.first, parameters_.longest_of_all, now);
  const std::string key = key_of(address, account);
  auto found = std::ranges::find(entries_, key, &Entry::key);
  if (found == entries_.end()) {
    // Tries at invented accounts do not make one forget those at another.
    const auto worth = [](const Entry& entry) { return std::pair(entry.failures, entry.last); };
    if (entries_.size() >= parameters_.most) entries_.erase(std::ranges::min_element(entries_, {}, worth));
    found = entries_.insert(entries_.end(), Entry{key, 0, {}, {}});
  }
  fail(*found, parameters_.free, parameters_.first, parameters_.longest, now);
}

void RateLimit::succeeded(std::string_view address, std::string_view account) {
  const std::string key = key_of(address, account);
  std::erase_if(entries_, [&](const Entry& entry) { return entry.key == key; });
}

void RateLimit::withdraw(std::string_view address, std::string_view account) {
  succeeded(address, account);
  if (all_.failures > 0 && --all_.failures < parameters_.free_of_all) all_.until = {};
}

}  // namespace cerberus::publish
