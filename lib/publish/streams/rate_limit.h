// SPDX-License-Identifier: LGPL-2.1-or-later
// The limit on wrong passwords, of the page and of the streaming server. Time is a parameter.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace cerberus::publish {

// After some wrong passwords an address waits before the next try at an account, twice as long each time; so do all
// addresses after many, but never long. An IPv6 address counts by its network of 64 bits, of which a host has all
// addresses. Not thread-safe.
class RateLimit {
 public:
  using Time = std::chrono::steady_clock::time_point;
  struct Parameters {
    int free = 5, free_of_all = 50;
    std::chrono::seconds first{1}, longest{60};
    // The longest wait of all together. Chosen: one try in 5 s finds no password, and a user who is right can wait as
    // long. Guarded by the test of many addresses.
    std::chrono::seconds longest_of_all{5};
    std::size_t most = 256;  // addresses and accounts that are remembered
  };

  RateLimit() = default;
  explicit RateLimit(const Parameters& parameters) : parameters_(parameters) {}

  // How long this address must wait before it tries the account; zero: it may try. Failures of other addresses do not
  // delay one of loopback: the machine itself stays usable.
  std::chrono::seconds wait(std::string_view address, std::string_view account, Time now) const;
  void failed(std::string_view address, std::string_view account, Time now);
  // The address begins anew with this account. All together do not: one right password must not make up for wrong ones.
  void succeeded(std::string_view address, std::string_view account);
  // The same for a try that was passed to failed() before it was found right: all together had one failure less.
  void withdraw(std::string_view address, std::string_view account);

 private:
  struct Entry {
    std::string key;
    int failures = 0;
    Time last{}, until{};
  };
  static void fail(Entry& entry, int free, std::chrono::seconds first, std::chrono::seconds longest,
                   Time now);

  Parameters parameters_;
  std::vector<Entry> entries_;
  Entry all_;
};

}  // namespace cerberus::publish
