// SPDX-License-Identifier: LGPL-2.1-or-later
// Ensures one controller for each head by the names of the heads that are driven in this process.
#pragma once

#include <memory>
#include <string>

namespace cerberus::drivers {

// Takes the name until the last copy of the lease is destroyed; returns nullptr if it is already taken. Thread-safe.
std::shared_ptr<void> lease_head(const std::string& name);

}  // namespace cerberus::drivers
