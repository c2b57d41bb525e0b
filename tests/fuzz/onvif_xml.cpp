// SPDX-License-Identifier: LGPL-2.1-or-later
// XML that a camera answers.
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "drivers/onvif/xml.h"

using cerberus::drivers::onvif::XmlDocument;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto document = XmlDocument::parse({reinterpret_cast<const char*>(data), size});
  if (!document) return 0;
  const auto element = document->root().find("Position");
  element.text();
  element.attribute("x");
  for (const auto number : {element.number(), element.number("x")})
    if (number && !std::isfinite(*number)) std::abort();
  return 0;
}
