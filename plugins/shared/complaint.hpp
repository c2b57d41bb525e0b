// SPDX-License-Identifier: LGPL-2.1-or-later
// Posts one message for each failure: upstream repeats with every frame what has failed.
#pragma once

#include <string>
#include <string_view>

namespace cerberus::plugin {

class Complaint {
 public:
  // `wrong`: the present failure; empty: none. Returns true if it is to be posted: it is new or has changed.
  bool is_new(std::string_view wrong) {
    if (wrong == reported_) return false;
    reported_ = wrong;
    return !reported_.empty();
  }
  // Begins anew: the next failure is posted again.
  void forget() { reported_.clear(); }

 private:
  std::string reported_;
};

}  // namespace cerberus::plugin
