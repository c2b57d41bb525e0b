// SPDX-License-Identifier: LGPL-2.1-or-later
#include "secret_source.h"

#include <cstdlib>

namespace cerberus {

std::string choose_secret(const SecretSource& source, const SecretOptions& options, std::string& path,
                          std::string& text) {
  path.clear();
  text.clear();
  const int sources = !source.file.empty() + !source.environment.empty() + !source.credential.empty();
  if (sources > 1)
    return std::string("give one of ") + options.file + ", " + options.environment + " and " +
           options.credential;
  path = source.file;
  if (!source.environment.empty()) {
    const char* value = std::getenv(source.environment.c_str());
    if (!value || !*value)
      return "the environment has no variable " + source.environment + ", or it is empty (" +
             options.environment + ")";
    text = value;
  }
  if (!source.credential.empty()) {
    const char* folder = std::getenv("CREDENTIALS_DIRECTORY");
    if (!folder) return std::string(options.credential) + " needs a service of systemd with LoadCredential=";
    if (source.credential.find('/') != std::string::npos) return "a credential's name has no slash";
    path = std::string(folder) + "/" + source.credential;
  }
  return {};
}

}  // namespace cerberus
