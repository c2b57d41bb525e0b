// SPDX-License-Identifier: LGPL-2.1-or-later
// Which heads of this process somebody drives: two who pull at one head would each see a fault.
#pragma once

#include <memory>
#include <string>

namespace cerberus::plugin {

// The name is taken until the last copy of the lease is gone; nullptr: it is taken already.
std::shared_ptr<void> lease_head(const std::string& name);

}  // namespace cerberus::plugin
