// SPDX-License-Identifier: LGPL-2.1-or-later
// Ensures one controller for each head by the names and the devices of the heads that are driven in this process.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace cerberus::drivers {

// The right to drive the head of a name and at a device. All functions are thread-safe.
class HeadLease {
 public:
  // device: in words that are the same for all settings that mean it; empty: the head has none. Returns nullptr if
  // another head has that name or device. A head whose last lease is being returned is leased at once, but may only be
  // driven when wait() has returned true.
  static std::shared_ptr<HeadLease> take(const std::string& name, const std::string& device = {});
  // Whether a head has that name.
  static bool is_taken(const std::string& name);
  // Returns the lease.
  ~HeadLease();
  HeadLease(const HeadLease&) = delete;
  HeadLease& operator=(const HeadLease&) = delete;

  // Announces that this lease will be destroyed as soon as its head has stopped.
  void announce_return();
  // Waits until all earlier leases of the name and of the device are returned, no longer than `patience` and no longer
  // than until the return of this one is announced. Returns whether the head may be driven.
  bool wait(std::chrono::steady_clock::duration patience) const;

 private:
  HeadLease() = default;
  bool is_first() const;

  std::vector<std::string> keys_;
  bool returns_ = false;
};

}  // namespace cerberus::drivers
