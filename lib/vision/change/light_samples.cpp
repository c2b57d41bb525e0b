// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/change/light_samples.h"

namespace cerberus::vision {

void LightSamples::take(GrayView reference, GrayView present, std::span<const RowSpan> spans) {
  height_ = present.empty() ? 0 : present.height;
  rows_.resize(static_cast<std::size_t>((height_ + kRowStep - 1) / kRowStep));
  const std::size_t most = rows_.size() * static_cast<std::size_t>(present.width / kColumnStep + 1);
  reference_.resize(most);
  present_.resize(most);
  std::size_t number = 0;
  for (int row = 0; row < rows(); ++row) {
    const int y = picture_row(row);
    const RowSpan span = spans.empty() ? RowSpan{0, present.width} : spans[static_cast<std::size_t>(y)];
    const std::uint8_t *a = reference.row(y), *b = present.row(y);
    Row& r = rows_[static_cast<std::size_t>(row)];
    r.begin = number;
    int x = span.begin + row % kColumnStep;
    for (int third = 0; third < 3; ++third) {
      const int end = std::min(span.end, (third + 1) * present.width / 3);
      for (; x < end; x += kColumnStep, ++number) reference_[number] = a[x], present_[number] = b[x];
      r.ends[static_cast<std::size_t>(third)] = number;
    }
  }
}

}  // namespace cerberus::vision
