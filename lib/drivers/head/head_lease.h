// SPDX-License-Identifier: LGPL-2.1-or-later
// Ensures one controller for each head by the names of the heads that are driven in this process.
#pragma once

#include <chrono>
#include <memory>
#include <string>

namespace cerberus::drivers {

// Takes the name until the last copy of the lease is destroyed; returns nullptr if it is already taken. A lease that is
// being returned is waited for, no longer than `patience`. Thread-safe.
std::shared_ptr<void> lease_head(const std::string& name, std::chrono::milliseconds patience = {});
// Announces that this lease will be destroyed as soon as its head has stopped. Thread-safe.
void announce_return(const std::shared_ptr<void>& lease);

}  // namespace cerberus::drivers
