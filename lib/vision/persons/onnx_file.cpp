// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/persons/onnx_file.h"

#include <algorithm>
#include <string_view>

namespace cerberus::vision {

namespace {

using Bytes = std::span<const std::uint8_t>;

// Numbers of fields: of ModelProto, GraphProto, NodeProto, AttributeProto, TensorProto and ValueInfoProto.
constexpr std::uint64_t kModelVersion = 1, kModelGraph = 7;
constexpr std::uint64_t kGraphNode = 1, kGraphInitializer = 5, kGraphInput = 11, kGraphOutput = 12;
constexpr std::uint64_t kNodeInput = 1, kNodeOutput = 2, kNodeType = 4, kNodeAttribute = 5;
constexpr std::uint64_t kAttributeTensor = 5;
constexpr std::uint64_t kTensorLengths = 1, kTensorType = 2, kTensorFloats = 4, kTensorName = 8,
                        kTensorRaw = 9;
constexpr std::uint64_t kFloats = 1;  // a TensorProto's type
constexpr std::uint64_t kBoxNumbers = 4;

// A field of a protocol buffer: its number, and its value, a number or bytes; and the whole of it, as it stands.
struct Field {
  std::uint64_t number = 0, value = 0;
  Bytes bytes, whole;
};

// Reads a message field by field.
class Message {
 public:
  explicit Message(Bytes bytes) : rest_(bytes) {}

  // nullopt: at the end, or the bytes are no message (is_broken()).
  std::optional<Field> next() {
    if (rest_.empty() || broken_) return std::nullopt;
    const Bytes start = rest_;
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
    field.whole = start.first(start.size() - rest_.size());
    return broken_ ? std::nullopt : std::optional(field);
  }
  // The same of numbers one after the other, without fields.
  std::optional<std::uint64_t> next_number() {
    if (rest_.empty() || broken_) return std::nullopt;
    const std::uint64_t value = varint();
    return broken_ ? std::nullopt : std::optional(value);
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

std::string_view text(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

using Buffer = std::vector<std::uint8_t>;

void append(Buffer& out, Bytes bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}
void append_varint(Buffer& out, std::uint64_t value) {
  for (; value > 0x7f; value >>= 7) out.push_back(static_cast<std::uint8_t>(value | 0x80));
  out.push_back(static_cast<std::uint8_t>(value));
}
void append_number(Buffer& out, std::uint64_t field, std::uint64_t value) {
  append_varint(out, field << 3);
  append_varint(out, value);
}
void append_bytes(Buffer& out, std::uint64_t field, Bytes bytes) {
  append_varint(out, field << 3 | 2);
  append_varint(out, bytes.size());
  append(out, bytes);
}

// A message with some of its fields in another form. change(field, bytes): fills in the bytes that the field has instead,
// and returns true, or false for a field that stays. nullopt: the bytes are no message.
template <typename Change>
std::optional<Buffer> rewritten(Bytes message, Change&& change) {
  Buffer out;
  Message fields(message);
  while (const auto field = fields.next()) {
    if (Buffer other; change(*field, other))
      append_bytes(out, field->number, other);
    else
      append(out, field->whole);
  }
  return fields.is_broken() ? std::nullopt : std::optional(std::move(out));
}

struct Names {
  std::vector<std::string_view> all;
  bool has(Bytes name) const { return std::ranges::find(all, text(name)) != all.end(); }
};

// 1 x N floats as 1 x 4 x N. nullopt: the tensor is none of these.
std::optional<Buffer> full_factors(Bytes tensor, const std::vector<std::uint64_t>& box_counts) {
  std::vector<std::uint64_t> shape;
  Buffer floats, out;
  Message fields(tensor);
  while (const auto field = fields.next()) {
    if (field->number == kTensorLengths && field->bytes.empty()) {
      shape.push_back(field->value);
    } else if (field->number == kTensorLengths) {
      Message packed(field->bytes);
      while (const auto length = packed.next_number()) shape.push_back(*length);
    } else if (field->number == kTensorFloats || field->number == kTensorRaw) {
      append(floats, field->bytes);
    } else if (field->number == kTensorType && field->value != kFloats) {
      return std::nullopt;
    } else if (field->number == kTensorName) {
      append(out, field->whole);
    }
  }
  if (fields.is_broken() || shape.size() != 2 || shape[0] != 1 ||
      std::ranges::find(box_counts, shape[1]) == box_counts.end() ||
      floats.size() != shape[1] * sizeof(float))
    return std::nullopt;
  for (const std::uint64_t length : {std::uint64_t{1}, kBoxNumbers, shape[1]})
    append_number(out, kTensorLengths, length);
  append_number(out, kTensorType, kFloats);
  Buffer copies;
  for (std::uint64_t n = 0; n < kBoxNumbers; ++n) append(copies, floats);
  append_bytes(out, kTensorRaw, copies);
  return out;
}

}  // namespace

std::optional<Size> onnx_input_size(Bytes model) {
  constexpr std::uint64_t kLargest = 8192;
  // Versions of the format; the fields that are read here are the same in all. From kNoVersion on the number shows that
  // the file is no ONNX model. Chosen: ten times the version of 2024.
  constexpr std::uint64_t kOldestVersion = 3, kNoVersion = 100;
  Bytes graph;
  std::uint64_t version = 0;
  Message reader(model);
  while (const auto field = reader.next()) {
    if (field->number == kModelVersion) version = field->value;
    if (field->number == kModelGraph) graph = field->bytes;
  }
  if (reader.is_broken() || version < kOldestVersion || version >= kNoVersion) return std::nullopt;
  Message inputs(graph);
  while (const auto input = inputs.next()) {
    if (input->number != kGraphInput) continue;
    const auto shape = shape_of(input->bytes);
    if (shape.size() != 4 || shape[0] > 1 || shape[1] != 3) continue;  // a weight, in files of old
    if (shape[2] == 0 || shape[2] > kLargest || shape[3] == 0 || shape[3] > kLargest) return std::nullopt;
    return Size{static_cast<int>(shape[3]), static_cast<int>(shape[2])};
  }
  return std::nullopt;
}

std::optional<std::vector<std::uint8_t>> onnx_with_full_factors(Bytes model) {
  const Bytes graph = find(model, kModelGraph);
  Names factors;
  std::vector<std::uint64_t> box_counts;
  Message fields(graph);
  while (const auto field = fields.next()) {
    if (field->number == kGraphOutput) {
      const auto shape = shape_of(field->bytes);
      if (shape.size() == 3) box_counts.push_back(shape[2]);
    }
    if (field->number != kGraphNode || text(find(field->bytes, kNodeType)) != "Mul") continue;
    Message node(field->bytes);
    while (const auto input = node.next())
      if (input->number == kNodeInput) factors.all.push_back(text(input->bytes));
  }
  bool any = false;
  const auto fill = [&](Bytes tensor, Buffer& other) {
    auto full = full_factors(tensor, box_counts);
    if (full) other = std::move(*full), any = true;
    return full.has_value();
  };
  const auto constant = [&](const Field& attribute, Buffer& other) {
    const auto changed = rewritten(attribute.bytes, [&](const Field& field, Buffer& tensor) {
      return field.number == kAttributeTensor && fill(field.bytes, tensor);
    });
    if (changed) other = *changed;
    return attribute.number == kNodeAttribute && changed;
  };
  const auto in_graph = [&](const Field& field, Buffer& other) {
    if (field.number == kGraphInitializer)
      return factors.has(find(field.bytes, kTensorName)) && fill(field.bytes, other);
    if (field.number != kGraphNode || text(find(field.bytes, kNodeType)) != "Constant" ||
        !factors.has(find(field.bytes, kNodeOutput)))
      return false;
    const auto changed = rewritten(field.bytes, constant);
    if (changed) other = *changed;
    return changed.has_value();
  };
  auto changed = rewritten(model, [&](const Field& field, Buffer& other) {
    const auto rest = field.number == kModelGraph ? rewritten(field.bytes, in_graph) : std::nullopt;
    if (rest) other = *rest;
    return rest.has_value();
  });
  return any ? changed : std::nullopt;
}

}  // namespace cerberus::vision
