// SPDX-License-Identifier: LGPL-2.1-or-later
// The record of one frame: everything that the stages of detection know of it.
//
// Fields are filled from left to right; the stage that owns a field writes it once. An absent field means that no
// stage has looked, a present and empty one that nothing was found. Pictures are counted references, so that a copy of
// a record (a branch of a tee that goes on by itself) copies no pixels.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "threads/shared.h"
#include "vision/background/foreground_mask.h"
#include "vision/burnt_in/burnt_in_boxes.h"
#include "vision/change/three_frame_difference.h"
#include "vision/detection/region.h"
#include "vision/ego_motion/camera_motion.h"
#include "vision/image/image.h"
#include "vision/tracking/tracker.h"

namespace cerberus::vision {

// In the order in which they are written.
enum class Stage { luma, camera, differences, foreground, regions, tracks };

using GrayPicture = threads::Shared<Image<std::uint8_t>>;
using LabelPicture = threads::Shared<Image<std::uint16_t>>;

// A value that is absent until it is written. Memory that it holds is kept when it is cleared.
template <typename T>
class Field {
 public:
  explicit operator bool() const { return present_; }
  const T& operator*() const { return value_; }
  const T* operator->() const { return &value_; }
  // To be filled by the stage that owns the field, once.
  T& write() {
    assert(!present_);
    present_ = true;
    return value_;
  }
  // For the stage that takes over a picture of an earlier field.
  T& stored() { return value_; }
  void clear() {
    if (!present_) return;
    present_ = false;
    if constexpr (requires { value_.clear(); })
      value_.clear();
    else
      value_ = T{};
  }

 private:
  T value_{};
  bool present_ = false;
};

struct Differences {
  GrayPicture current;   // D(k), analysis pixels
  GrayPicture previous;  // D(k-1); none where no stage or element reads it
  GrayPicture tolerant;  // D(k) without what a displacement of a pixel explains; none where the camera stands
  Histogram histogram{};
  DifferenceResult result;  // with the change of light that was taken out
  bool blurred = false;     // the pictures were
};

struct Foreground {
  GrayPicture mask;             // 0 or 255; none once the regions stage has taken it over, see FoundRegions
  GrayPicture background;       // what the model had learnt before; none where the camera moves
  ForegroundMaskResult result;  // threshold and noise
  FuzzyThresholdOptions chosen_with;     // how the threshold was chosen from the histogram
  std::optional<BurntInBoxes> burnt_in;  // left out of the mask; none where it is not learnt
  bool blurred = false;                  // made of blurred pictures: see BoxEdgeParameters
};

struct FoundRegions {
  GrayPicture
      mask;  // cleaned: what the regions were made from; the foreground's own where no element reads that
  LabelPicture labels;          // none where no element reads them
  std::vector<Region> regions;  // boxes in frame pixels, within the limits of size
  void clear() {
    mask = {};
    labels = {};
    regions.clear();
  }
};

struct Analysis {
  Size frame;                        // of the frame that this is the record of, pixels
  Field<GrayPicture> luma;           // F(k), analysis pixels
  Field<CameraMotionResult> camera;  // frame k-1 to k, frame pixels
  Field<Differences> differences;
  Field<Foreground> foreground;
  Field<FoundRegions> regions;
  Field<std::vector<Track>> tracks;  // frame pixels, within the limits of speed

  bool has(Stage stage) const;
  // Makes the field of `stage` and of every later stage absent.
  void clear_from(Stage stage);
  void recycle() { clear_from(Stage::luma); }
  // The moving area as far as it is known: the cleaned mask, else the threshold's. An empty view: neither is there.
  GrayView mask() const;
  // Bytes that the record and its pictures hold.
  std::size_t bytes() const;
};

using Record = threads::Shared<Analysis>;

}  // namespace cerberus::vision
