// SPDX-License-Identifier: LGPL-2.1-or-later
// Metadata that another process packed. The first byte is the version; nothing is read beyond the rest, and what is
// accepted packs to the same bytes again.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <set>
#include <string>

#include "publish/packing.h"

using namespace cerberus::publish;

namespace {

struct Example {
  const char* head = nullptr;
  std::uint64_t from = 0;
  const char* name = nullptr;
  std::uint8_t bytes[3] = {};
  std::int32_t number = 0;
};

template <typename Archive>
void exchange(Archive& archive, Example& e) {
  archive(e.head, Moment{e.from}, e.name, e.bytes, e.number);
}

const char* keep(const char* word) {
  static std::set<std::string> words;
  if (words.size() > 1000) words.clear();
  return words.insert(word).first->c_str();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr std::uint64_t kFrame = std::numeric_limits<std::int64_t>::max();  // no distance is cut off
  const auto bytes = std::as_bytes(std::span(data, size)).subspan(1);
  Example example;
  Unpacker from(bytes, data[0], kFrame, keep);
  exchange(from, example);
  if (!from.complete()) return 0;
  if (data[0] != kPackedVersion) std::abort();
  std::array<std::byte, kMostPacked> room;
  Packer to(room, kFrame);
  exchange(to, example);
  if (!to.complete()) std::abort();
  // A word ends at its first NUL, so that bytes behind one are not packed again.
  if (to.bytes().size() > bytes.size()) std::abort();
  if (to.bytes().size() == bytes.size() && std::memcmp(to.bytes().data(), bytes.data(), bytes.size()) != 0)
    std::abort();
  return 0;
}
