// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/change/light_samples.h"

#include <algorithm>
#include <cstring>

namespace cerberus::vision {

static_assert(LightSamples::kColumnStep == 8);  // take_every_eighth()

void LightSamples::take(GrayView reference, GrayView present, std::span<const RowSpan> spans) {
  height_ = present.empty() ? 0 : present.height;
  const int most = (present.width / 3 + kColumnStep) / kColumnStep + 1;
  third_ = (most + kSampleLanes - 1) / kSampleLanes * kSampleLanes;
  rows_.resize(static_cast<std::size_t>((height_ + kRowStep - 1) / kRowStep));
  reference_.resize(start_of(rows()));
  present_.resize(start_of(rows()));
  for (int row = 0; row < rows(); ++row) {
    const int y = picture_row(row);
    const RowSpan span = spans.empty() ? RowSpan{0, present.width} : spans[static_cast<std::size_t>(y)];
    const std::uint8_t *a = reference.row(y), *b = present.row(y);
    int x = span.begin + row % kColumnStep;
    for (int part = 0; part < 3; ++part) {
      const int end = std::min(span.end, (part + 1) * present.width / 3);
      std::uint8_t* to_reference =
          reference_.data() + start_of(row) + static_cast<std::ptrdiff_t>(part) * third_;
      std::uint8_t* to_present = present_.data() + start_of(row) + static_cast<std::ptrdiff_t>(part) * third_;
      const int number = std::max(0, (end - x + kColumnStep - 1) / kColumnStep);
      for (int i = number / kSampleLanes * kSampleLanes; i < third_; i += kSampleLanes)
        std::memset(to_reference + i, 255, kSampleLanes);  // white: no sample
      take_every_eighth(a + x, number, to_reference);
      take_every_eighth(b + x, number, to_present);
      x += number * kColumnStep;
      rows_[static_cast<std::size_t>(row)][static_cast<std::size_t>(part)] =
          static_cast<std::uint16_t>(number);
    }
  }
}

LightSums LightSamples::sums_of_band(int band, std::span<const RowLight> lights) const {
  const int first = first_row(band), number = first_row(band + 1) - first;
  std::array<RowLight, kBandRows> here;
  for (int i = 0; i < number; ++i)
    here[static_cast<std::size_t>(i)] = lights[static_cast<std::size_t>(picture_row(first + i))];
  return sum_samples(reference_.data() + start_of(first), present_.data() + start_of(first), here.data(),
                     number, third_);
}

}  // namespace cerberus::vision
