// SPDX-License-Identifier: LGPL-2.1-or-later
// Ensures one controller for each head by the names of the heads that are driven in this process.
#pragma once

#include <chrono>
#include <memory>
#include <string>

namespace cerberus::drivers {

// The right to drive the head of a name. All functions are thread-safe.
class HeadLease {
 public:
  // Returns nullptr if the head is in use. A head whose last lease is being returned is leased at once, but may only be
  // driven when wait() has returned true.
  static std::shared_ptr<HeadLease> take(const std::string& name);
  // Returns the lease.
  ~HeadLease();
  HeadLease(const HeadLease&) = delete;
  HeadLease& operator=(const HeadLease&) = delete;

  // Announces that this lease will be destroyed as soon as its head has stopped.
  void announce_return();
  // Waits until all earlier leases of the name are returned, no longer than `patience` and no longer than until the
  // return of this one is announced. Returns whether the head may be driven.
  bool wait(std::chrono::steady_clock::duration patience) const;

 private:
  explicit HeadLease(const std::string& name) : name_(name) {}

  std::string name_;
  bool returns_ = false;
};

}  // namespace cerberus::drivers
