// SPDX-License-Identifier: LGPL-2.1-or-later
// Reads rule tables written by users: TOML, documented in docs/manual/rules.md. Never throws.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "fusion/rules.h"

namespace cerberus::fusion {

struct RuleFile {
  std::optional<RuleTable> table;  // nullopt: `error` has the reason
  std::string error;  // "rules.toml:12: unknown action \"left\" (track, turn-left, ...)", one a line
};

// Reads, parses and checks a file: a returned table has no gaps and no contradictions.
RuleFile load_rules(const std::string& path);
// The same from text; `source` stands for the file's name in errors.
RuleFile parse_rules(std::string_view toml, std::string_view source);

}  // namespace cerberus::fusion
