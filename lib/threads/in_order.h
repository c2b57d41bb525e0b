// SPDX-License-Identifier: LGPL-2.1-or-later
// A queue through which several threads publish items in the order in which they were put in. One thread at a time
// delivers, without holding a lock, because a callback may take long or call back. An item may therefore be delivered
// by another thread, after deliver() has returned to the thread that put it in. Thread-safe; allocates only in the
// constructor.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace cerberus::threads {

// T has a default value. kMost: the largest number of waiting items while a callback blocks the delivery; the default
// is that of the poses of a moving head in five seconds. A full queue drops the oldest item that a newer one replaces,
// so that rare items are not displaced by frequent ones; if no item is replaced, it drops the oldest of all.
template <typename T, std::size_t kMost = 256>
class InOrder {
 public:
  // Returns whether the older item is superfluous once the newer one is delivered. Called with the lock held.
  using Replaces = bool (*)(const T& newer, const T& older);

  explicit InOrder(Replaces replaces = [](const T&, const T&) { return true; }) : replaces_(replaces) {}

  void put(T thing) {
    const std::lock_guard guard(lock_);
    if (waiting_ == kMost) drop_one(thing);
    things_[(first_ + waiting_++) % kMost] = std::move(thing);
  }
  // Discards the items that were not delivered yet.
  void clear() {
    const std::lock_guard guard(lock_);
    while (waiting_ > 0) take();
  }
  // Delivers the waiting items by deliver(const T&), unless another thread is delivering. Call it after put(), without a
  // lock that other threads need.
  template <typename Deliver>
  void deliver(Deliver&& deliver) {
    std::unique_lock guard(lock_);
    if (delivering_) return;
    const Turn turn(*this, guard);
    while (waiting_ > 0) {
      const T thing = take();
      guard.unlock();
      deliver(thing);
      guard.lock();
    }
  }
  // Waits until no other thread is delivering, so that every item put in before has been delivered when the caller has
  // called deliver(). Returns at once inside a delivery, and after `limit`: a callback may itself wait for the caller.
  void wait(std::chrono::nanoseconds limit) {
    std::unique_lock guard(lock_);
    idle_.wait_for(guard, limit, [&] { return !delivering_ || deliverer_ == std::this_thread::get_id(); });
  }

 private:
  // Marks the delivery as in progress; the mark is also removed when a callback throws.
  class Turn {
   public:
    Turn(InOrder& order, std::unique_lock<std::mutex>& guard) : order_(order), guard_(guard) {
      order_.delivering_ = true;
      order_.deliverer_ = std::this_thread::get_id();
    }
    ~Turn() {
      if (!guard_.owns_lock()) guard_.lock();
      order_.delivering_ = false;
      order_.idle_.notify_all();
    }
    Turn(const Turn&) = delete;

   private:
    InOrder& order_;
    std::unique_lock<std::mutex>& guard_;
  };

  // Removes and returns the oldest waiting item; its place is reset. Called with the lock held.
  T take() {
    T thing = std::exchange(things_[first_], T{});
    first_ = (first_ + 1) % kMost;
    --waiting_;
    return thing;
  }

  T& at(std::size_t place) { return things_[(first_ + place) % kMost]; }

  // Makes room for `next`. Called with the lock held and all places taken.
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
  std::vector<T> things_ = std::vector<T>(kMost);  // on the heap, so that the owner stays small
  std::size_t first_ = 0, waiting_ = 0;
  bool delivering_ = false;
  std::thread::id deliverer_;  // the thread that delivers, while delivering_
  std::condition_variable idle_;
};

}  // namespace cerberus::threads
