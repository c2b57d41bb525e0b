// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/transport/line_buffer.h"

namespace cerberus::drivers {

void LineBuffer::append(std::string_view bytes) {
  for (const char byte : bytes) {
    if (!overlong_) bytes_ += byte;
    if (byte == '\n') {
      overlong_ = false;
      line_begin_ = bytes_.size();
    } else if (bytes_.size() - line_begin_ >= kMostLine) {
      bytes_.resize(line_begin_);
      overlong_ = true;
    }
  }
}

std::optional<std::string> LineBuffer::take() {
  if (line_begin_ == 0) return std::nullopt;
  const std::size_t end = bytes_.find('\n');
  std::string line = bytes_.substr(0, end);
  bytes_.erase(0, end + 1);
  line_begin_ -= end + 1;
  return line;
}

}  // namespace cerberus::drivers
