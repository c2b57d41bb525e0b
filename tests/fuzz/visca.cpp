// SPDX-License-Identifier: LGPL-2.1-or-later
// VISCA: what a camera sends, as datagrams and as a stream; speed tables.
#include "drivers/visca/visca.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>

using namespace cerberus::drivers::visca;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Datagram datagram = parse_datagram({data, size});
  is_sequence_error(datagram);
  Cutter cutter;
  for (const std::span<const std::uint8_t> bytes : {std::span(data, size), datagram.payload}) {
    cutter.append(bytes);
    while (const auto message = cutter.take()) {
      if (message->size() > kMostBytes || message->back() != 0xff) std::abort();
      const Reply reply = parse_reply(*message);
      if (!std::isfinite(reply.pan) || std::abs(reply.tilt) > 2276) std::abort();  // 0x8000 / 14.4
    }
  }
  SpeedTable table;
  if (parse_speed_table({reinterpret_cast<const char*>(data), size}, table).empty())
    for (const double speed : {0.0, -1e300, 7.0, 1e9})
      if (std::abs(speed_step(table.pan, speed)) >= static_cast<int>(table.pan.size())) std::abort();
  return 0;
}
