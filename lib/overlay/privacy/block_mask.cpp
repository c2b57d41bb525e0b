// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/privacy/block_mask.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace cerberus::overlay {

namespace {

constexpr int kBlock = BlockMask::kBlock;

int blocks_of(int pixels) {
  return (pixels + kBlock - 1) / kBlock;
}

// The samples of one component.
class Samples {
 public:
  Samples(const BlendComponent& c, vision::Size frame)
      : c_(c),
        width_((frame.width + (1 << c.shift_x) - 1) >> c.shift_x),
        height_((frame.height + (1 << c.shift_y) - 1) >> c.shift_y) {}

  // Calls use(sample) for each sample of these blocks, as far as they lie in the frame.
  template <typename Use>
  void each(int column, int row, int columns, int rows, const Use& use) const {
    const int left = column * kBlock >> c_.shift_x, top = row * kBlock >> c_.shift_y;
    const int right = std::min((column + columns) * kBlock >> c_.shift_x, width_);
    const int bottom = std::min((row + rows) * kBlock >> c_.shift_y, height_);
    for (int y = top; y < bottom; ++y) {
      std::uint8_t* sample = c_.data + y * c_.stride + static_cast<std::ptrdiff_t>(left) * c_.step;
      for (int x = left; x < right; ++x, sample += c_.step) use(sample);
    }
  }
  int read(const std::uint8_t* sample) const {
    if (c_.bits <= 8) return *sample;
    std::uint16_t word;
    std::memcpy(&word, sample, sizeof word);
    return order(word) >> c_.word_shift;
  }
  void write(std::uint8_t* sample, int value) const {
    if (c_.bits <= 8) {
      *sample = static_cast<std::uint8_t>(value);
      return;
    }
    const std::uint16_t word = order(value << c_.word_shift);
    std::memcpy(sample, &word, sizeof word);
  }
  int clamp(double value) const {
    return static_cast<int>(std::lround(std::clamp(value, 0.0, double((1 << c_.bits) - 1))));
  }

 private:
  std::uint16_t order(int word) const {
    return static_cast<std::uint16_t>(c_.swapped ? (word << 8 | (word >> 8 & 255)) : word);
  }

  const BlendComponent& c_;
  int width_, height_;
};

}  // namespace

void BlockMask::reset(vision::Size size) {
  frame = size;
  columns = blocks_of(size.width);
  rows = blocks_of(size.height);
  covered.assign(static_cast<std::size_t>(columns) * rows, 0);
}

bool BlockMask::any() const {
  return std::ranges::any_of(covered, [](std::uint8_t block) { return block != 0; });
}

void fill(const BlockMask& mask, Color color, std::span<const BlendComponent> picture) {
  for (const BlendComponent& c : picture) {
    const Samples samples(c, mask.frame);
    const int value =
        samples.clamp(255 * (c.red * color.r + c.green * color.g + c.blue * color.b) + c.offset);
    for (int row = 0; row < mask.rows; ++row)
      for (int column = 0; column < mask.columns; ++column)
        if (mask.at(column, row))
          samples.each(column, row, 1, 1, [&](std::uint8_t* sample) { samples.write(sample, value); });
  }
}

void pixelate(const BlockMask& mask, int squares, std::span<const BlendComponent> picture) {
  const int side = std::max(1, blocks_of(mask.frame.height / std::max(1, squares)));
  for (const BlendComponent& c : picture) {
    const Samples samples(c, mask.frame);
    for (int top = 0; top < mask.rows; top += side)
      for (int left = 0; left < mask.columns; left += side) {
        const int right = std::min(left + side, mask.columns), bottom = std::min(top + side, mask.rows);
        bool some = false;
        for (int row = top; row < bottom; ++row)
          for (int column = left; column < right; ++column) some = some || mask.at(column, row);
        if (!some) continue;
        double sum = 0;
        int count = 0;
        samples.each(left, top, side, side,
                     [&](const std::uint8_t* sample) { sum += samples.read(sample), ++count; });
        const int mean = samples.clamp(sum / std::max(count, 1));
        for (int row = top; row < bottom; ++row)
          for (int column = left; column < right; ++column)
            if (mask.at(column, row))
              samples.each(column, row, 1, 1, [&](std::uint8_t* sample) { samples.write(sample, mean); });
      }
  }
}

}  // namespace cerberus::overlay
