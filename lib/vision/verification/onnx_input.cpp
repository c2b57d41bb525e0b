// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/verification/onnx_input.h"

#include <array>
#include <string_view>
#include <vector>

namespace cerberus::vision {

namespace {

using Bytes = std::span<const std::uint8_t>;

// A field of a protocol buffer: its number, and its value, a number or bytes.
struct Field {
  std::uint64_t number = 0, value = 0;
  Bytes bytes;
};

// Reads a message field by field.
class Message {
 public:
  explicit Message(Bytes bytes) : rest_(bytes) {}

  // nullopt: at the end, or the bytes are no message (is_broken()).
  std::optional<Field> next() {
    if (rest_.empty() || broken_) return std::nullopt;
    const std::uint64_t key = varint();
    Field field;
    field.number = key >> 3;
    switch (key & 7) {
      case 0:
        field.value = varint();
        break;
      case 1:
        field.bytes = take(8);
        break;
      case 2:
        field.bytes = take(varint());
        break;
      case 5:
        field.bytes = take(4);
        break;
      default:
        broken_ = true;
    }
    if (field.number == 0) broken_ = true;
    return broken_ ? std::nullopt : std::optional(field);
  }
  bool is_broken() const { return broken_; }

 private:
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      if (rest_.empty()) break;
      const std::uint8_t byte = rest_.front();
      rest_ = rest_.subspan(1);
      value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
      if (!(byte & 0x80)) return value;
    }
    broken_ = true;
    return 0;
  }
  Bytes take(std::uint64_t length) {
    if (length > rest_.size()) {
      broken_ = true;
      return {};
    }
    const Bytes taken = rest_.first(length);
    rest_ = rest_.subspan(length);
    return taken;
  }

  Bytes rest_;
  bool broken_ = false;
};

// The bytes of the first field with this number.
Bytes find(Bytes message, std::uint64_t number) {
  Message reader(message);
  while (const auto field = reader.next())
    if (field->number == number) return field->bytes;
  return {};
}

// ValueInfoProto.type.tensor_type.shape: the numbers of its dimensions, 0 where one has none.
std::vector<std::uint64_t> shape_of(Bytes value_info) {
  std::vector<std::uint64_t> shape;
  Message dimensions(find(find(find(value_info, 2), 1), 2));
  while (const auto dimension = dimensions.next()) {
    if (dimension->number != 1) continue;
    std::uint64_t length = 0;
    Message reader(dimension->bytes);
    while (const auto field = reader.next())
      if (field->number == 1) length = field->value;
    shape.push_back(length);
  }
  return shape;
}

}  // namespace

std::optional<Size> onnx_input_size(Bytes model) {
  constexpr std::uint64_t kVersion = 1, kGraph = 7, kInput = 11;  // of ModelProto, ModelProto and GraphProto
  constexpr std::uint64_t kLargest = 8192;
  Bytes graph;
  std::uint64_t version = 0;
  Message reader(model);
  while (const auto field = reader.next()) {
    if (field->number == kVersion) version = field->value;
    if (field->number == kGraph) graph = field->bytes;
  }
  if (reader.is_broken() || version < 3 || version > 10) return std::nullopt;
  Message inputs(graph);
  while (const auto input = inputs.next()) {
    if (input->number != kInput) continue;
    const auto shape = shape_of(input->bytes);
    if (shape.size() != 4 || shape[0] > 1 || shape[1] != 3) continue;  // a weight, in files of old
    if (shape[2] == 0 || shape[2] > kLargest || shape[3] == 0 || shape[3] > kLargest) return std::nullopt;
    return Size{static_cast<int>(shape[3]), static_cast<int>(shape[2])};
  }
  return std::nullopt;
}

}  // namespace cerberus::vision
