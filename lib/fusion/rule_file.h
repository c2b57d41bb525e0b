// SPDX-License-Identifier: LGPL-2.1-or-later
// Rule tables that users write: TOML, documented in docs/manual/rules.md. Never throws.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "fusion/rules.h"

namespace cerberus::fusion {

struct RuleFile {
  std::optional<RuleTable> table;  // nothing: `error` says why
  std::string error;  // "rules.toml:12: unknown action \"left\" (track, turn-left, ...)", one a line
};

// Reads, parses and checks: a table that is returned has been found free of gaps and contradictions.
RuleFile load_rules(const std::string& path);
// The same from text; `source` stands for the file's name in errors.
RuleFile parse_rules(std::string_view toml, std::string_view source);

}  // namespace cerberus::fusion
