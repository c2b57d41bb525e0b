// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/target_override.h"

namespace cerberus::fusion {

TargetOverride::Answer TargetOverride::watch(bool here, Time time) {
  if (id_ == 0) return Answer::none;
  if (!since_) since_ = time;
  if (here) {
    seen_ = time;
    return Answer::here;
  }
  if (time - seen_.value_or(*since_) < kPatience) return seen_ ? Answer::awaited : Answer::none;
  choose(0);
  return Answer::lost;
}

}  // namespace cerberus::fusion
