// SPDX-License-Identifier: LGPL-2.1-or-later
// Counts what this program takes from the heap with operator new (which is all that lib/ uses), per thread.
#pragma once

#include <cstddef>

namespace cerberus::tests {

// Calls of operator new, in any form, made by the calling thread so far.
std::size_t allocations();

// Bytes that the calling thread has taken and not given back, as the heap rounds them.
std::ptrdiff_t held_bytes();

}  // namespace cerberus::tests
