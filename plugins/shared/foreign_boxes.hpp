// SPDX-License-Identifier: LGPL-2.1-or-later
// Boxes of objects that other elements than ours have found on a frame: regions of interest, and the object detections of
// GstAnalytics (1.24).
#pragma once

#include <gst/gst.h>

#include <cstddef>
#include <vector>

#include "vision/geometry/box.h"
#include "vision/image/image.h"

namespace cerberus::plugin {

// More objects than a detector finds on a frame; each is compared with each.
constexpr std::size_t kMostForeignBoxes = 256;

struct ForeignBox {
  vision::Box box;         // pixels, inside the frame
  double confidence = 1;   // 0 to 1; 1 where the element gives none
  bool person = false;     // so its label says
  const char* label = "";  // lives as long as the process
};

// Replaces `boxes`. Boxes outside the frame and those of less than a pixel are left out, those of a negative confidence or one
// that is no number, too, and what comes after
// the first kMostForeignBoxes. An object that is there in both forms comes twice.
void read_foreign_boxes(GstBuffer* buffer, vision::Size frame, std::vector<ForeignBox>& boxes);

// Labels of persons; upper and lower case count alike.
inline constexpr const char* kPersonLabels[] = {"person", "pedestrian", "human", "people",
                                                "body",   "man",        "woman", "child"};

}  // namespace cerberus::plugin
