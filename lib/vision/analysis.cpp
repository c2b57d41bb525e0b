// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/analysis.h"

namespace cerberus::vision {

bool Analysis::has(Stage stage) const {
  switch (stage) {
    case Stage::luma:
      return static_cast<bool>(luma);
    case Stage::camera:
      return static_cast<bool>(camera);
    case Stage::differences:
      return static_cast<bool>(differences);
    case Stage::foreground:
      return static_cast<bool>(foreground);
    case Stage::regions:
      return static_cast<bool>(regions);
    case Stage::tracks:
      break;
  }
  return static_cast<bool>(tracks);
}

void Analysis::clear_from(Stage stage) {
  if (stage <= Stage::luma) luma.clear();
  if (stage <= Stage::camera) camera.clear();
  if (stage <= Stage::differences) differences.clear();
  if (stage <= Stage::foreground) foreground.clear();
  if (stage <= Stage::regions) regions.clear();
  tracks.clear();
}

GrayView Analysis::mask() const {
  if (regions) return regions->mask->view();
  if (foreground && foreground->mask) return foreground->mask->view();
  return {};
}

std::size_t Analysis::bytes() const {
  std::size_t sum = threads::Pool<Analysis>::object_bytes() + regions->regions.capacity() * sizeof(Region) +
                    tracks->capacity() * sizeof(Track);
  for (const GrayPicture* picture :
       {&*luma, &differences->current, &differences->previous, &differences->tolerant, &foreground->mask,
        &foreground->background, &regions->mask})
    if (*picture) sum += threads::Pool<Image<std::uint8_t>>::object_bytes() + (*picture)->bytes();
  if (regions->labels) sum += threads::Pool<Image<std::uint16_t>>::object_bytes() + regions->labels->bytes();
  return sum;
}

}  // namespace cerberus::vision
