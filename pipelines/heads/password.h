// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

#include "secret_source.h"

namespace cerberus::heads {

// Reads a camera's password: the first line of a file, which may be a pipe, or a variable of the environment. Returns
// what is wrong, without the password; empty: `password` is set (to nothing where no source is given).
std::string read_password(const SecretSource& source, std::string& password);

}  // namespace cerberus::heads
