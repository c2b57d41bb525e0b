// SPDX-License-Identifier: LGPL-2.1-or-later
// Reads the configuration file of a robot: TOML, documented in docs/manual/robot.md. Never throws.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "robot/settings.h"
#include "robot/tables/table_reader.h"

namespace cerberus::robot {

struct SettingsFile {
  std::optional<Settings> settings;  // nullopt: `errors` has the reasons
  std::string errors;                // "robot.toml:12: unknown key ...", one a line, by line
};

// Reads and checks a file. Paths in it are relative to its folder; files that it names (secrets, rules, calibrations)
// must be there, and secrets be readable for their owner alone (mode 0600 or 0640). `credentials` is the folder of
// credentials of systemd; empty: the service's, of which none is looked at.
SettingsFile load_settings(const std::string& path, std::string_view credentials = {});

// The same from text, without a look at any file. `source` stands for the file's name in errors, `folder` is put before
// relative paths (empty: they stay).
SettingsFile parse_settings(std::string_view toml, std::string_view source, std::string_view folder);

// "robot.toml:12: ..." of each mistake, one a line, by line.
std::string describe(Mistakes mistakes, std::string_view source);

// The secret in a file: its first line. Returns nullopt and what is wrong, which never contains the secret.
std::optional<std::string> read_secret(const std::string& path, std::string& error);

}  // namespace cerberus::robot
