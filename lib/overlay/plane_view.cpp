// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/plane_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "overlay/color.h"

namespace cerberus::overlay {

namespace {

int nearest(int to_index, int to, int from) {
  return static_cast<int>((2 * static_cast<std::int64_t>(to_index) + 1) * from /
                          (2 * static_cast<std::int64_t>(to)));
}

std::uint32_t word(Color c) {
  const auto byte = [](double share) { return static_cast<std::uint32_t>(std::lround(255 * share)); };
  return byte(c.r) << 16 | byte(c.g) << 8 | byte(c.b);
}

}  // namespace

void Canvas::fill_black() const {
  for (int y = 0; y < height; ++y) std::memset(row(y), 0, row_bytes());
}

void Canvas::clear_padding(std::size_t bytes) const {
  if (stride <= static_cast<std::ptrdiff_t>(row_bytes())) return;
  for (int y = 0; y < height; ++y) {
    const std::size_t begin = static_cast<std::size_t>(y) * static_cast<std::size_t>(stride) + row_bytes();
    const std::size_t end =
        std::min(bytes, static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(stride));
    if (begin < end) std::memset(data + begin, 0, end - begin);
  }
}

const std::vector<int>& Enlarger::columns(int from, int to) {
  if (columns_from_ != from || columns_.size() != static_cast<std::size_t>(to)) {
    columns_.resize(static_cast<std::size_t>(to));
    for (int x = 0; x < to; ++x) columns_[static_cast<std::size_t>(x)] = nearest(x, to, from);
    columns_from_ = from;
  }
  return columns_;
}

// Calls write(row of the plane, columns, row of the canvas) for every new row; repeated rows are copied.
template <typename T, typename Write>
void Enlarger::walk(vision::View<const T> plane, const Canvas& canvas, Write write) {
  const std::vector<int>& column = columns(plane.width, canvas.width);
  int last = -1;
  for (int y = 0; y < canvas.height; ++y) {
    const int from = nearest(y, canvas.height, plane.height);
    if (from == last)
      std::memcpy(canvas.row(y), canvas.row(y - 1), canvas.row_bytes());
    else
      write(plane.row(from), column.data(), canvas.row(y));
    last = from;
  }
}

void Enlarger::show(vision::GrayView plane, double gain, const Canvas& canvas) {
  std::array<std::uint8_t, 256> level;
  for (int i = 0; i < 256; ++i) level[i] = static_cast<std::uint8_t>(std::min(std::lround(i * gain), 255L));
  walk(plane, canvas, [&](const std::uint8_t* from, const int* column, std::uint8_t* to) {
    if (canvas.gray) {
      for (int x = 0; x < canvas.width; ++x) to[x] = level[from[column[x]]];
    } else {
      auto* words = reinterpret_cast<std::uint32_t*>(to);
      for (int x = 0; x < canvas.width; ++x) words[x] = level[from[column[x]]] * 0x010101u;
    }
  });
}

void Enlarger::show_labels(vision::View<const std::uint16_t> plane, const Canvas& canvas) {
  constexpr unsigned kColors = 7;  // the palette's period
  std::array<std::uint32_t, kColors> colors;
  for (unsigned i = 0; i < kColors; ++i) colors[i] = word(identity_color(i + 1));
  walk(plane, canvas, [&](const std::uint16_t* from, const int* column, std::uint8_t* to) {
    auto* words = reinterpret_cast<std::uint32_t*>(to);
    for (int x = 0; x < canvas.width; ++x) {
      const unsigned label = from[column[x]];
      words[x] = label ? colors[(label - 1) % kColors] : 0;
    }
  });
}

void Enlarger::show_boxes(vision::GrayView plane, std::span<const vision::Box> boxes, const Canvas& canvas) {
  show(plane, 1, canvas);
  const std::uint32_t color = word(identity_color(1));
  const std::vector<int>& columns = this->columns(plane.width, canvas.width);
  for (const vision::Box& box : boxes) {
    const auto inside = [](double from, double extent, double at, double by) {
      return at >= from + by && at < from + extent - by;
    };
    for (int y = 0; y < canvas.height; ++y) {
      const int row = nearest(y, canvas.height, plane.height);
      if (!inside(box.y, box.height, row, 0)) continue;
      const bool edge = !inside(box.y, box.height, row, 1);
      auto* words = reinterpret_cast<std::uint32_t*>(canvas.row(y));
      for (int x = 0; x < canvas.width; ++x) {
        const int column = columns[static_cast<std::size_t>(x)];
        if (inside(box.x, box.width, column, 0) && (edge || !inside(box.x, box.width, column, 1)))
          words[x] = color;
      }
    }
  }
}

}  // namespace cerberus::overlay
