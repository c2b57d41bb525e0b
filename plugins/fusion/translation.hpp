// SPDX-License-Identifier: LGPL-2.1-or-later
// The decisions of the fuser as they ride on buffers.
#pragma once

#include <cerberus/cerberus.h>

#include <string>
#include <string_view>

#include "fusion/fuser.h"
#include "inputs.hpp"

namespace cerberus::plugin {

// The name of the last rule, interned: looked up again only when it is another one.
class RuleName {
 public:
  const gchar* of(std::string_view name);

 private:
  std::string name_;
  const gchar* interned_ = nullptr;
};

CerberusFusion as_fusion(const fusion::Decision& decision, const SensorSnapshot& moment, RuleName& name);

}  // namespace cerberus::plugin
