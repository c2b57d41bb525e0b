// SPDX-License-Identifier: LGPL-2.1-or-later
// The limit on wrong passwords, of the page and of the streaming server. Time is a parameter.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace cerberus::publish {

// After some wrong passwords an address waits before the next try, twice as long each time; so do all addresses after
// many. Not thread-safe.
class RateLimit {
 public:
  using Time = std::chrono::steady_clock::time_point;
  struct Parameters {
    int free = 5, free_of_all = 50;
    std::chrono::seconds first{1}, longest{60};
    std::size_t most = 256;  // addresses that are remembered
  };

  RateLimit() = default;
  explicit RateLimit(const Parameters& parameters) : parameters_(parameters) {}

  // How long this address must wait; zero: it may try. Failures of other addresses do not delay one of loopback: the
  // machine itself stays usable.
  std::chrono::seconds wait(std::string_view address, Time now) const;
  void failed(std::string_view address, Time now);
  // The address, and all together, begin anew.
  void succeeded(std::string_view address);

 private:
  struct Entry {
    std::string address;
    int failures = 0;
    Time last{}, until{};
  };
  void fail(Entry& entry, int free, Time now) const;

  Parameters parameters_;
  std::vector<Entry> entries_;
  Entry all_;
};

}  // namespace cerberus::publish
