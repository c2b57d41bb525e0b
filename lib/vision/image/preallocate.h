// SPDX-License-Identifier: LGPL-2.1-or-later
// Vectors whose memory is allocated once for the largest content at one size of picture.
#pragma once

#include <cstddef>
#include <vector>

namespace cerberus::vision {

// Empties `v` and reserves exactly `most` elements: memory of an earlier, larger picture is freed.
template <typename T>
void preallocate(std::vector<T>& v, std::size_t most) {
  std::vector<T> fresh;
  fresh.reserve(most);
  v.swap(fresh);
}

template <typename T>
std::size_t bytes_of(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

}  // namespace cerberus::vision
