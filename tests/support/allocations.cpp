// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/allocations.h"

#include <cstdlib>
#include <new>

namespace {

thread_local std::size_t taken = 0;

void* take(std::size_t bytes, std::size_t alignment) {
  ++taken;
  if (alignment <= alignof(std::max_align_t)) {
    if (void* p = std::malloc(bytes ? bytes : 1)) return p;
  } else if (void* p = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment)) {
    return p;
  }
  throw std::bad_alloc();
}

}  // namespace

namespace cerberus::tests {
std::size_t allocations() { return taken; }
}  // namespace cerberus::tests

// The array and nothrow forms of the standard library call these.
void* operator new(std::size_t bytes) { return take(bytes, 0); }
void* operator new(std::size_t bytes, std::align_val_t a) { return take(bytes, static_cast<std::size_t>(a)); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
