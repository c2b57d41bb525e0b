// SPDX-License-Identifier: LGPL-2.1-or-later
// Pelco-D: the positions that a head answers.
#include <cstdint>
#include <cstdlib>

#include "drivers/pelco/pelco_d.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  cerberus::drivers::pelco::Answers answers;
  const std::size_t half = size / 2;
  for (const auto part : {std::span(data, half), std::span(data + half, size - half)}) {
    answers.append(part);
    while (const auto position = answers.take())
      if (!(position->degrees >= -180 && position->degrees < 180)) std::abort();
  }
  return 0;
}
