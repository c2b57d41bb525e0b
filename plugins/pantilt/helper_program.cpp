// SPDX-License-Identifier: LGPL-2.1-or-later
#include "helper_program.hpp"

#include <dlfcn.h>
#include <glib.h>

namespace cerberus::plugin {

std::string helper_program() {
  if (const char* named = g_getenv("CERBERUS_HEAD"); named && *named) return named;
  Dl_info module{};
  if (dladdr(reinterpret_cast<const void*>(&helper_program), &module) && module.dli_fname) {
    gchar* folder = g_path_get_dirname(module.dli_fname);
    gchar* built = g_build_filename(folder, "..", "..", "pipelines", "cerberus-head", nullptr);
    const std::string path = g_file_test(built, G_FILE_TEST_IS_EXECUTABLE) ? built : "";
    g_free(built);
    g_free(folder);
    if (!path.empty()) return path;
  }
  return CERBERUS_LIBEXEC "/cerberus-head";
}

}  // namespace cerberus::plugin
