// SPDX-License-Identifier: LGPL-2.1-or-later
// One controller a head: the names of the heads that are driven in this process.
#pragma once

#include <memory>
#include <string>

namespace cerberus::drivers {

// The name is taken until the last copy of the lease is gone; nullptr: it is taken already. Thread-safe.
std::shared_ptr<void> lease_head(const std::string& name);

}  // namespace cerberus::drivers
