// SPDX-License-Identifier: LGPL-2.1-or-later
// Where a program finds a secret: in a file, a variable of the environment or a credential of systemd. A secret is never
// an argument: every user of the machine can read those.
#pragma once

#include <string>

namespace cerberus {

struct SecretSource {
  std::string file;         // a path
  std::string environment;  // a variable's name
  std::string credential;   // of systemd (LoadCredential=): the name of a file in $CREDENTIALS_DIRECTORY
};

// The options that name the sources, for messages.
struct SecretOptions {
  const char *file, *environment, *credential;
};

// Chooses the source. Returns what is wrong, without the secret; empty: `path` names the file that has the secret, or
// `text` is the secret itself, or both are empty and no source is named.
std::string choose_secret(const SecretSource& source, const SecretOptions& options, std::string& path,
                          std::string& text);

}  // namespace cerberus
