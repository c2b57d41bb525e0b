// SPDX-License-Identifier: LGPL-2.1-or-later
// A queue whose entries keep the number of their arrival while others leave at its front. Its memory grows to the
// largest size that was needed and stays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace cerberus::record {

using Number = std::uint64_t;

template <typename Entry>
class NumberedQueue {
 public:
  Number begin() const { return begin_; }
  Number end() const { return end_; }
  bool empty() const { return begin_ == end_; }
  // `number` is in [begin(), end()).
  const Entry& operator[](Number number) const { return slots_[number % slots_.size()]; }
  Entry& operator[](Number number) { return slots_[number % slots_.size()]; }
  const Entry& front() const { return (*this)[begin_]; }
  const Entry& back() const { return (*this)[end_ - 1]; }
  Entry& front() { return slots_[begin_ % slots_.size()]; }
  Entry& back() { return slots_[(end_ - 1) % slots_.size()]; }

  void push(Entry entry) {
    if (end_ - begin_ == slots_.size()) grow();
    slots_[end_ % slots_.size()] = std::move(entry);
    ++end_;
  }
  void pop() {
    slots_[begin_ % slots_.size()] = Entry();
    ++begin_;
  }
  void clear() {
    while (!empty()) pop();
  }

 private:
  void grow() {
    std::vector<Entry> larger(slots_.empty() ? 64 : 2 * slots_.size());
    for (Number k = begin_; k != end_; ++k) larger[k % larger.size()] = std::move(slots_[k % slots_.size()]);
    slots_ = std::move(larger);
  }

  std::vector<Entry> slots_;
  Number begin_ = 0, end_ = 0;
};

}  // namespace cerberus::record
