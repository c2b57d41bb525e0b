// SPDX-License-Identifier: LGPL-2.1-or-later
// Several threads have something to tell, and it is told in the order in which it was put in. One at a time tells,
// without a lock, for whoever is told may take his time or come back: so what one put in may be told by another, a
// moment after the first one has gone on. Thread-safe; allocates when it is made and never again.
#pragma once

#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

namespace cerberus::threads {

// T has a default value. kMost: as many wait at most, while one who is told keeps the one who tells; the usual number
// is that of the poses of a moving head in five seconds. Of more the oldest goes that a younger one replaces, so that
// what is said rarely outlasts what is said all the time; if none is replaced, the oldest of all.
template <typename T, std::size_t kMost = 256>
class InOrder {
 public:
  // Who has heard the newer one misses nothing without the older one. Called with the lock held.
  using Replaces = bool (*)(const T& newer, const T& older);

  explicit InOrder(Replaces replaces = [](const T&, const T&) { return true; }) : replaces_(replaces) {}

  void put(T thing) {
    const std::lock_guard guard(lock_);
    if (waiting_ == kMost) drop_one(thing);
    things_[(first_ + waiting_++) % kMost] = std::move(thing);
  }
  // What was not told yet is told by nobody.
  void clear() {
    const std::lock_guard guard(lock_);
    while (waiting_ > 0) take();
  }
  // Whoever has put something in calls this behind it, with no lock held that others need. tell(const T&).
  template <typename Tell>
  void tell(Tell&& tell) {
    std::unique_lock guard(lock_);
    if (telling_) return;
    const Turn turn(*this, guard);
    while (waiting_ > 0) {
      const T thing = take();
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

  // The oldest that waits, of which nothing stays. With the lock held.
  T take() {
    T thing = std::exchange(things_[first_], T{});
    first_ = (first_ + 1) % kMost;
    --waiting_;
    return thing;
  }

  T& at(std::size_t place) { return things_[(first_ + place) % kMost]; }

  // Makes room for `next`. With the lock held, and all places taken.
  void drop_one(const T& next) {
    const auto is_replaced = [&](std::size_t place) {
      if (replaces_(next, at(place))) return true;
      for (std::size_t younger = place + 1; younger < kMost; ++younger)
        if (replaces_(at(younger), at(place))) return true;
      return false;
    };
    std::size_t place = 0;
    while (place < kMost && !is_replaced(place)) ++place;
    if (place == kMost) place = 0;
    for (; place > 0; --place) at(place) = std::move(at(place - 1));  // the older ones move up
    take();
  }

  const Replaces replaces_;
  std::mutex lock_;
  std::vector<T> things_ = std::vector<T>(kMost);  // its owner may have no room for them
  std::size_t first_ = 0, waiting_ = 0;
  bool telling_ = false;
};

}  // namespace cerberus::threads
