// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/allocations.h"

#include <malloc.h>

#include <cstdlib>
#include <new>

namespace {

thread_local std::size_t taken = 0;
thread_local std::ptrdiff_t held = 0;

void* take(std::size_t bytes, std::size_t alignment) {
  void* p = alignment <= alignof(std::max_align_t)
                ? std::malloc(bytes ? bytes : 1)
                : std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (!p) throw std::bad_alloc();
  ++taken;
  held += static_cast<std::ptrdiff_t>(malloc_usable_size(p));
  return p;
}

void give_back(void* p) {
  held -= static_cast<std::ptrdiff_t>(malloc_usable_size(p));
  std::free(p);
}

}  // namespace

namespace cerberus::tests {
std::size_t allocations() {
  return taken;
}
std::ptrdiff_t held_bytes() {
  return held;
}
}  // namespace cerberus::tests

// The array forms of the standard library call these. A sanitizer has nothrow forms of its own, which these take back.
void* operator new(std::size_t bytes) {
  return take(bytes, 0);
}
void* operator new(std::size_t bytes, std::align_val_t a) {
  return take(bytes, static_cast<std::size_t>(a));
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  try {
    return take(bytes, 0);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* p) noexcept {
  give_back(p);
}
void operator delete(void* p, std::size_t) noexcept {
  give_back(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
  give_back(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  give_back(p);
}
