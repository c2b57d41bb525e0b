// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/duplicate_frames.h"

#include <cstring>

namespace cerberus::vision {
namespace {

// Ends at the first row that differs: where a camera's noise is in the picture, at the first of all.
bool equal(GrayView a, GrayView b) {
  for (int y = 0; y < a.height; ++y)
    if (std::memcmp(a.row(y), b.row(y), static_cast<std::size_t>(a.width)) != 0) return false;
  return true;
}

}  // namespace

bool DuplicateFrames::repeats(const GrayPicture& luma, bool follows, bool short_enough) {
  const bool comparable = follows && last_ && last_->size() == luma->size();
  const bool same = comparable && equal(last_->view(), luma->view());
  if (same && moved_ && short_enough) return true;
  moved_ = comparable && !same;
  last_ = luma;
  return false;
}

}  // namespace cerberus::vision
