// SPDX-License-Identifier: LGPL-2.1-or-later
// Several threads have something to tell, and it is told in the order in which it was put in. One at a time tells, without a
// lock, for whoever is told may take his time or come back: so what one put in may be told by another, a moment after the
// first one has gone on.
#pragma once

#include <deque>
#include <mutex>
#include <utility>

namespace cerberus {

template <typename T>
class InOrder {
 public:
  void put(T thing) {
    const std::lock_guard guard(lock_);
    things_.push_back(std::move(thing));
  }
  // What was not told yet is told by nobody.
  void clear() {
    const std::lock_guard guard(lock_);
    things_.clear();
  }
  // Whoever has put something in calls this behind it, with no lock held that others need. tell(const T&).
  template <typename Tell>
  void tell(Tell&& tell) {
    std::unique_lock guard(lock_);
    if (telling_) return;
    const Turn turn(*this, guard);
    while (!things_.empty()) {
      const T thing = std::move(things_.front());
      things_.pop_front();
      guard.unlock();
      tell(thing);
      guard.lock();
    }
  }

 private:
  // Ends also when somebody who is told throws.
  class Turn {
   public:
    Turn(InOrder& order, std::unique_lock<std::mutex>& guard) : order_(order), guard_(guard) {
      order_.telling_ = true;
    }
    ~Turn() {
      if (!guard_.owns_lock()) guard_.lock();
      order_.telling_ = false;
    }
    Turn(const Turn&) = delete;

   private:
    InOrder& order_;
    std::unique_lock<std::mutex>& guard_;
  };

  std::mutex lock_;
  std::deque<T> things_;
  bool telling_ = false;
};

}  // namespace cerberus
