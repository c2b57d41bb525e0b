// SPDX-License-Identifier: LGPL-2.1-or-later
// Warns of settings with which nothing can ever be found.
#pragma once

#include <gst/gst.h>

#include <string>

#include "cerberus/private/messages.hpp"
#include "shared/complaint.hpp"
#include "vision/detection/limits.h"

namespace cerberus::plugin {

// Returns a warning for limits that exclude every value, else an empty string. `what`: as in the properties minimum-...
// and maximum-...; possible: the largest possible value, 0 = unknown; result: the consequence of the limits.
inline std::string contradiction(const char* what, const vision::Range& range, double possible = 0,
                                 const char* result = "nothing can be found") {
  if (range.most > 0 && range.least > range.most)
    return std::string("minimum-") + what + " is larger than maximum-" + what + ": " + result +
           ". Make it smaller, or set one of the two to 0 (no limit).";
  if (possible > 0 && range.least > possible)
    return std::string("minimum-") + what +
           " is larger than the picture: nothing can be found. Make it smaller, or 0.";
  return {};
}

// Posts each warning when its cause begins, and not with every frame.
class NothingFound {
 public:
  void tell(GstElement* element, const std::string& why) {
    if (complaint_.is_new(why)) CERBERUS_ELEMENT_WARNING(element, RESOURCE, SETTINGS, (why), (nullptr));
  }

 private:
  Complaint complaint_;
};

}  // namespace cerberus::plugin
