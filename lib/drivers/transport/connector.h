// SPDX-License-Identifier: LGPL-2.1-or-later
// Opens a ByteStream on a thread of its own: looking up a host and connecting to it may take seconds, and its owner must
// notice the silence of its pipeline meanwhile. A connection that is not wanted any more is dropped when it is made.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "drivers/transport/byte_stream.h"

namespace cerberus::drivers {

class Connector {
 public:
  bool busy() const { return attempt_ != nullptr; }
  // Begins to open the device; what was begun before is dropped. Never blocks.
  void start(const std::string& address, int baud);
  // Readable once the attempt is over; -1 while none is made.
  int fd() const;
  // The attempt's error text, once it is over; empty: `stream` has its connection. nullopt: it is not over.
  std::optional<std::string> take(ByteStream& stream);

 private:
  struct Attempt;
  std::shared_ptr<Attempt> attempt_;
};

}  // namespace cerberus::drivers
