// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdio>
#include <string>

// That a text for users holds `what`; else the text is shown.
inline bool says(const std::string& text, const std::string& what) {
  if (text.find(what) != text.npos) return true;
  std::fprintf(stderr, "\"%s\" does not say \"%s\"\n", text.c_str(), what.c_str());
  return false;
}
