// SPDX-License-Identifier: LGPL-2.1-or-later
// Recognises frames that repeat the last picture sample by sample: a changed frame rate upstream, whose duplicates have
// lost the flag that marks them. Analysed as a picture, a duplicate shows that nothing moves. Not thread-safe.
#pragma once

#include "vision/analysis.h"

namespace cerberus::vision {

class DuplicateFrames {
 public:
  void forget() { last_ = {}; }

  // Returns whether `luma` is the last picture again and is not to be analysed; else it is the last picture from now on.
  // A picture that is equal to its predecessor is no duplicate where that one was equal to its own predecessor, too:
  // a still scene without noise (a drawing, a test pattern) is analysed as it is. follows: the frame continues the
  // scene of the last picture. short_enough: the last picture is recent enough to be repeated.
  bool repeats(const GrayPicture& luma, bool follows, bool short_enough);

 private:
  GrayPicture last_;
  bool moved_ = false;  // last_ differs from its predecessor
};

}  // namespace cerberus::vision
