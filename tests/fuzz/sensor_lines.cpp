// SPDX-License-Identifier: LGPL-2.1-or-later
// The line protocol of sensors, in pieces of any size.
#include "drivers/external/sensor_lines.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "drivers/transport/line_buffer.h"

using namespace cerberus::drivers;

namespace {

constexpr int kMost = cerberus::sensing::kMaxSensors;

void check(bool holds) {
  if (!holds) std::abort();
}

void read(std::string_view text) {
  const auto line = parse_sensor_line(text);
  if (!line) return;
  if (const auto* hello = std::get_if<SensorHello>(&*line)) {
    check(hello->version >= 1 && hello->sensors >= 0 && hello->sensors <= kMost);
    check((hello->version == kSensorProtocol) == (hello->sensors > 0));
  }
  if (const auto* levels = std::get_if<SensorLevels>(&*line)) {
    check(levels->count >= 1 && levels->count <= kMost);
    for (const float volts : levels->volts) check(std::isnan(volts) || std::abs(volts) <= kMostSensorVolts);
  }
  if (const auto* fault = std::get_if<SensorFaultText>(&*line))
    check(fault->text.size() <= 200 &&
          std::ranges::all_of(fault->text, [](char c) { return c >= ' ' && c <= '~'; }));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  LineBuffer lines;
  const std::size_t piece = size > 0 ? 1 + data[0] % 32 : 1;
  for (std::size_t at = 0; at < size; at += piece) {
    lines.append({reinterpret_cast<const char*>(data + at), std::min(piece, size - at)});
    while (const auto line = lines.take()) {
      check(line->size() < kMostLine);
      read(*line);
    }
  }
  return 0;
}
