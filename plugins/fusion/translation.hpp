// SPDX-License-Identifier: LGPL-2.1-or-later
// Between what rides on buffers and what the fuser knows: its tracks, its decisions.
#pragma once

#include <cerberus/cerberus.h>

#include <string>
#include <string_view>
#include <vector>

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

// The regions on `buffer` that are tracks, in place of what `tracks` held.
void read_tracks(GstBuffer* buffer, std::vector<fusion::Track>& tracks);
CerberusFusion as_fusion(const fusion::Decision& decision, const Moment& moment, RuleName& name);

}  // namespace cerberus::plugin
