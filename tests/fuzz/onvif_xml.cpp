// SPDX-License-Identifier: LGPL-2.1-or-later
// XML that a camera answers, through every reader of answers.
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "drivers/onvif/address.h"
#include "drivers/onvif/answers.h"
#include "drivers/onvif/discovery.h"
#include "drivers/onvif/soap/xml.h"

using namespace cerberus::drivers::onvif;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto document = XmlDocument::parse({reinterpret_cast<const char*>(data), size});
  if (!document) return 0;
  const auto element = document->root().find("Position");
  element.text();
  element.attribute("x");
  for (const auto number : {element.number(), element.number("x")})
    if (number && !std::isfinite(*number)) std::abort();
  const auto body = body_of(*document);
  if (const auto status = read_status(body);
      status && status->position && !std::isfinite(status->position->x.from))
    std::abort();
  read_fault(body);
  read_system_date_and_time(body);
  const Services services = read_services(body);
  reachable(services.ptz, {});
  read_profiles(body);
  read_configuration_options(body);
  read_nodes(body);
  read_presets(body);
  std::string relates_to;
  for (const ProbeMatch& match : read_probe_matches(*document, relates_to)) read_match(match, "192.0.2.1");
  return 0;
}
