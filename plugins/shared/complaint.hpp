// SPDX-License-Identifier: LGPL-2.1-or-later
// One message a failure: upstream tries again with every frame what has failed.
#pragma once

#include <string>
#include <string_view>

namespace cerberus::plugin {

class Complaint {
 public:
  // What is wrong now; empty: nothing. True where that is to be told: it was not so, or otherwise, before.
  bool is_new(std::string_view wrong) {
    if (wrong == told_) return false;
    told_ = wrong;
    return !told_.empty();
  }
  // Who begins anew is told anew.
  void forget() { told_.clear(); }

 private:
  std::string told_;
};

}  // namespace cerberus::plugin
