// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <type_traits>

#include "vision/image/image.h"

namespace cerberus::vision {

// Moves the content of a picture by (dx, dy) whole pixels; uncovered pixels are set to `fill`.
template <typename T>
void shift_content(View<T> v, int dx, int dy, T fill) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto move_row = [&](int y) {
    const int from = y - dy;
    T* out = v.row(y);
    if (from < 0 || from >= v.height || std::abs(dx) >= v.width) {
      std::fill_n(out, v.width, fill);
      return;
    }
    const T* in = v.row(from);
    const std::size_t bytes = sizeof(T) * static_cast<std::size_t>(v.width - std::abs(dx));
    if (dx >= 0) {
      std::memmove(out + dx, in, bytes);
      std::fill_n(out, dx, fill);
    } else {
      std::memmove(out, in - dx, bytes);
      std::fill_n(out + v.width + dx, -dx, fill);
    }
  };
  if (dy > 0)
    for (int y = v.height - 1; y >= 0; --y) move_row(y);
  else
    for (int y = 0; y < v.height; ++y) move_row(y);
}

}  // namespace cerberus::vision
