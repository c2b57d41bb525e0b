// SPDX-License-Identifier: LGPL-2.1-or-later
// A message of a broker: the topic's last level on the first line, the payload behind it.
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "publish/fleet.h"
#include "publish/mqtt_report.h"
#include "publish/webhook_queue.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cerberus::publish;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t end = text.find('\n');
  const std::string_view name = text.substr(0, end), payload = end == text.npos ? "" : text.substr(end + 1);
  std::string error;
  const auto command = parse_mqtt_command(name, payload, "move-to stop,follow", error);
  if (command && (!std::isfinite(command->first) || !std::isfinite(command->second))) __builtin_trap();
  if (!command && error.empty()) __builtin_trap();
  Fleet fleet("cerberus");
  fleet.take("cerberus/front/status", "online", {});
  fleet.ask("front", {});
  fleet.take("cerberus/front/" + std::string(name), std::string(payload), {});
  fleet.take(text, "online", {});
  fleet.json();
  webhook_body("1", name, "front", "mode", {}, payload);
  return 0;
}
