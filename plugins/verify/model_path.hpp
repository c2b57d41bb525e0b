// SPDX-License-Identifier: LGPL-2.1-or-later
// Where a model is that is named without a folder.
#pragma once

#include <glib.h>

#include <string>

namespace cerberus::plugin {

// Returns the name as it is where it has a folder or such a file is there; else the first file of that name in
// cerberus/models below the user's and the system's folders of data (XDG_DATA_HOME, XDG_DATA_DIRS), and the name as it is
// where there is none.
inline std::string model_path(const std::string& name) {
  if (name.empty() || name.find('/') != std::string::npos || g_file_test(name.c_str(), G_FILE_TEST_EXISTS))
    return name;
  const auto below = [&](const char* folder) {
    g_autofree char* path = g_build_filename(folder, "cerberus", "models", name.c_str(), nullptr);
    return std::string(g_file_test(path, G_FILE_TEST_EXISTS) ? path : "");
  };
  if (std::string path = below(g_get_user_data_dir()); !path.empty()) return path;
  for (const char* const* folder = g_get_system_data_dirs(); *folder; ++folder)
    if (std::string path = below(*folder); !path.empty()) return path;
  return name;
}

}  // namespace cerberus::plugin
