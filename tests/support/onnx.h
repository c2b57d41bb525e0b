// SPDX-License-Identifier: LGPL-2.1-or-later
// Writes a small ONNX model by hand: protocol buffers with the field numbers of onnx.proto (ONNX project, IR version 7).
#pragma once

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <vector>

namespace cerberus::tests::onnx {

inline std::string varint(std::uint64_t value) {
  std::string bytes;
  for (; value > 127; value >>= 7) bytes += static_cast<char>((value & 127) | 128);
  return bytes + static_cast<char>(value);
}
inline std::string number(int field, std::uint64_t value) {
  return varint(static_cast<std::uint64_t>(field) << 3) + varint(value);
}
inline std::string bytes(int field, const std::string& value) {
  return varint(static_cast<std::uint64_t>(field) << 3 | 2) + varint(value.size()) + value;
}

// ValueInfoProto of floats.
inline std::string value_info(const std::string& name, const std::vector<int>& shape) {
  std::string dimensions;
  for (const int n : shape)
    dimensions += bytes(1, n ? number(1, static_cast<std::uint64_t>(n)) : std::string());
  return bytes(1, name) + bytes(2, bytes(1, number(1, 1) + bytes(2, dimensions)));
}

// TensorProto; type 1: floats, 7: 64-bit integers.
template <typename T>
std::string tensor(const std::string& name, int type, const std::vector<int>& shape,
                   const std::vector<T>& values) {
  std::string all;
  for (const int n : shape) all += number(1, static_cast<std::uint64_t>(n));
  std::string raw(values.size() * sizeof(T), '\0');
  std::memcpy(raw.data(), values.data(), raw.size());
  return all + number(2, static_cast<std::uint64_t>(type)) + bytes(8, name) + bytes(9, raw);
}

inline std::string integers(const std::string& name, std::initializer_list<int> values) {
  std::string all = bytes(1, name) + number(20, 7);
  for (const int n : values) all += number(8, static_cast<std::uint64_t>(n));
  return bytes(5, all);
}

inline std::string model(const std::string& graph) {
  return number(1, 7) + bytes(7, graph) + bytes(8, number(2, 11));
}

// A network that answers every picture of `side` x `side` pixels with the same column of numbers, (side / 8)^2 times:
// 1 x numbers x boxes, as YOLO 8 does. It is a convolution of weights 0, whose bias are the numbers.
inline std::string constant_yolo(int side, const std::vector<float>& numbers) {
  const int n = static_cast<int>(numbers.size()), boxes = side / 8 * (side / 8);
  const std::vector<float> weights(static_cast<std::size_t>(n) * 3 * 8 * 8, 0);
  const std::string convolution = bytes(1, "images") + bytes(1, "weights") + bytes(1, "bias") +
                                  bytes(2, "cells") + bytes(3, "conv") + bytes(4, "Conv") +
                                  integers("kernel_shape", {8, 8}) + integers("strides", {8, 8});
  const std::string reshape =
      bytes(1, "cells") + bytes(1, "shape") + bytes(2, "output0") + bytes(3, "reshape") + bytes(4, "Reshape");
  return model(
      bytes(1, convolution) + bytes(1, reshape) + bytes(2, "constant") +
      bytes(5, tensor("weights", 1, {n, 3, 8, 8}, weights)) + bytes(5, tensor("bias", 1, {n}, numbers)) +
      bytes(5, tensor("shape", 7, {3}, std::vector<std::int64_t>{1, n, boxes})) +
      bytes(11, value_info("images", {1, 3, side, side})) + bytes(12, value_info("output0", {1, n, boxes})));
}

}  // namespace cerberus::tests::onnx
