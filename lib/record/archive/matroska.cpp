// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/archive/matroska.h"

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace cerberus::record {

namespace {

// Identifiers with their marker bits (RFC 9559).
constexpr std::uint64_t kSegment = 0x18538067, kCluster = 0x1F43B675, kSimpleBlock = 0xA3, kBlockGroup = 0xA0;
constexpr std::uint64_t kUnknownSize = UINT64_MAX;
constexpr std::size_t kLongestHead = 12;  // bytes: an identifier of 4, a size of 8

struct Element {
  std::uint64_t id = 0, size = 0;  // kUnknownSize: up to the next element of its level
  std::uint64_t content = 0;       // offset
};

// A number whose first byte says by its leading zeros how long it is (RFC 8794). `marked`: with that bit. Returns its
// length, 0: there is none.
std::size_t read_number(const std::uint8_t* bytes, std::size_t there, std::size_t longest, bool marked,
                        std::uint64_t& number) {
  if (there == 0 || bytes[0] == 0) return 0;
  const auto length = static_cast<std::size_t>(std::countl_zero(bytes[0])) + 1;
  if (length > longest || length > there) return 0;
  number = marked ? bytes[0] : bytes[0] & (0xff >> length);
  bool all_ones = number == (0xffu >> length);
  for (std::size_t k = 1; k < length; ++k) {
    number = number << 8 | bytes[k];
    all_ones = all_ones && bytes[k] == 0xff;
  }
  if (!marked && all_ones) number = kUnknownSize;
  return length;
}

std::optional<Element> read_element(int fd, std::uint64_t offset) {
  std::array<std::uint8_t, kLongestHead> bytes{};
  const ssize_t got = pread(fd, bytes.data(), bytes.size(), static_cast<off_t>(offset));
  if (got <= 0) return std::nullopt;
  const auto there = static_cast<std::size_t>(got);
  Element element;
  const std::size_t id = read_number(bytes.data(), there, 4, true, element.id);
  if (id == 0) return std::nullopt;
  const std::size_t size = read_number(bytes.data() + id, there - id, 8, false, element.size);
  if (size == 0) return std::nullopt;
  element.content = offset + id + size;
  return element;
}

}  // namespace

bool has_block(int fd) {
  struct stat about{};
  if (fstat(fd, &about) != 0) return false;
  const auto file = static_cast<std::uint64_t>(about.st_size);
  for (std::uint64_t at = 0; at < file;) {
    const std::optional<Element> element = read_element(fd, at);
    if (!element) return false;
    at = element->content;
    if (element->id == kSegment || element->id == kCluster) continue;  // what is in it is looked at
    if (element->size > file - at) return false;                       // cut off
    if (element->id == kSimpleBlock || element->id == kBlockGroup) return true;
    at += element->size;
  }
  return false;
}

}  // namespace cerberus::record
