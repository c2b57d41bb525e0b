// SPDX-License-Identifier: LGPL-2.1-or-later
// Converts the decisions of the fuser to those on buffers.
#pragma once

#include <cerberus/cerberus.h>

#include "fusion/decisions.h"

namespace cerberus::plugin {

CerberusFusion as_fusion(const fusion::Decisions::Outcome& outcome);

}  // namespace cerberus::plugin
