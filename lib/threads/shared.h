// SPDX-License-Identifier: LGPL-2.1-or-later
// Objects shared by several threads and reused once the last reference is dropped: the steady state allocates nothing.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace cerberus::threads {

template <typename T>
class Pool;

// A counted reference to an object of a Pool. References may be copied and dropped in any thread. The object is
// written only while is_sole() is true: then no other thread can reach it.
template <typename T>
class Shared {
 public:
  Shared() = default;
  Shared(const Shared& other) : node_(other.node_) {
    if (node_) node_->holders.fetch_add(1, std::memory_order_relaxed);
  }
  Shared(Shared&& other) noexcept : node_(std::exchange(other.node_, nullptr)) {}
  Shared& operator=(Shared other) noexcept {
    std::swap(node_, other.node_);
    return *this;
  }
  ~Shared() {
    if (node_ && node_->holders.fetch_sub(1, std::memory_order_acq_rel) == 1) Pool<T>::take_back(node_);
  }

  explicit operator bool() const { return node_ != nullptr; }
  T& operator*() const { return node_->value; }
  T* operator->() const { return &node_->value; }
  bool is_sole() const { return node_ && node_->holders.load(std::memory_order_acquire) == 1; }

 private:
  friend class Pool<T>;
  explicit Shared(typename Pool<T>::Node* node) : node_(node) {}
  typename Pool<T>::Node* node_ = nullptr;
};

// Takes back every object whose last reference is dropped; objects may outlive their pool. An object with a member
// recycle() is asked by it to give back what it holds itself.
template <typename T>
class Pool {
 public:
  // An object that was used before, as it was left, or a new one. Throws std::bad_alloc.
  Shared<T> take() {
    std::unique_ptr<Node> node;
    {
      const std::lock_guard guard(store_->lock);
      if (!store_->unused.empty()) {
        node = std::move(store_->unused.back());
        store_->unused.pop_back();
      } else {
        node = std::make_unique<Node>();
        store_->unused.reserve(++store_->made);  // so that taking back never allocates
      }
    }
    node->home = store_;
    node->holders = 1;
    return Shared<T>(node.release());
  }
  // Returns the bytes of the objects that wait to be reused; bytes_of(object): bytes that an object owns outside
  // itself.
  template <typename BytesOf>
  std::size_t bytes(BytesOf&& bytes_of) const {
    const std::lock_guard guard(store_->lock);
    std::size_t sum = sizeof(Store) + store_->unused.capacity() * sizeof(store_->unused[0]);
    for (const auto& node : store_->unused) sum += sizeof(Node) + bytes_of(node->value);
    return sum;
  }
  static constexpr std::size_t object_bytes() { return sizeof(Node); }

 private:
  friend class Shared<T>;
  struct Store;
  struct Node {
    std::atomic<int> holders = 0;
    std::shared_ptr<Store> home;  // while it is held
    T value;
  };
  struct Store {
    std::mutex lock;
    std::vector<std::unique_ptr<Node>> unused;
    std::size_t made = 0;
  };

  static void take_back(Node* node) noexcept {
    if constexpr (requires { node->value.recycle(); }) node->value.recycle();
    const std::shared_ptr<Store> home = std::move(node->home);
    const std::lock_guard guard(home->lock);
    home->unused.emplace_back(node);
  }

  std::shared_ptr<Store> store_ = std::make_shared<Store>();
};

}  // namespace cerberus::threads
