// SPDX-License-Identifier: LGPL-2.1-or-later
// Writes a small ONNX model by hand: protocol buffers with the field numbers of onnx.proto (ONNX project, IR version 7).
#pragma once

#include <algorithm>
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

// NodeProto. attributes: of integers(), or empty.
inline std::string node(const std::string& type, const std::vector<std::string>& inputs,
                        const std::string& output, const std::string& attributes = {}) {
  std::string all;
  for (const std::string& input : inputs) all += bytes(1, input);
  return bytes(1, all + bytes(2, output) + bytes(3, output) + bytes(4, type) + attributes);
}
inline std::string weights(const std::string& name, const std::vector<int>& shape,
                           const std::vector<float>& values) {
  return bytes(5, tensor(name, 1, shape, values));
}
inline std::string reshape(const std::string& input, const std::string& output,
                           const std::vector<int>& shape) {
  const std::vector<std::int64_t> lengths(shape.begin(), shape.end());
  return node("Reshape", {input, output + "_shape"}, output) +
         bytes(5, tensor(output + "_shape", 7, {static_cast<int>(shape.size())}, lengths));
}
// Convolution: the numbers, once for each cell of 8 x 8 pixels. light: weight of each pixel in the last number.
inline std::string cells(const std::string& name, const std::vector<float>& numbers, float light = 0) {
  const int n = static_cast<int>(numbers.size());
  std::vector<float> of_pixels(static_cast<std::size_t>(n) * 3 * 8 * 8, 0);
  std::fill_n(of_pixels.rbegin(), 3 * 8 * 8, light);
  return node("Conv", {"images", name + "_weights", name + "_bias"}, name,
              integers("kernel_shape", {8, 8}) + integers("strides", {8, 8})) +
         weights(name + "_weights", {n, 3, 8, 8}, of_pixels) + weights(name + "_bias", {n}, numbers);
}

// A network that answers every picture of `side` x `side` pixels with the same column of numbers, (side / 8)^2 times:
// 1 x numbers x boxes, as YOLO 8 does. light: of cells().
inline std::string constant_yolo(int side, const std::vector<float>& numbers, float light = 0) {
  const int n = static_cast<int>(numbers.size()), boxes = side / 8 * (side / 8);
  return model(cells("cells", numbers, light) + reshape("cells", "output0", {1, n, boxes}) +
               bytes(2, "constant") + bytes(11, value_info("images", {1, 3, side, side})) +
               bytes(12, value_info("output0", {1, n, boxes})));
}

// The same, with boxes in cells that are multiplied by the size of a cell at the end, as Ultralytics' tools write YOLO 8:
// the boxes are 1 x 4 x boxes, the sizes 1 x boxes.
inline std::string constant_yolo_in_cells(int side, const std::vector<float>& box,
                                          const std::vector<float>& scores) {
  const int n = static_cast<int>(scores.size()), boxes = side / 8 * (side / 8);
  return model(cells("in_cells", box) + reshape("in_cells", "boxes", {1, 4, boxes}) +
               weights("sizes", {1, boxes}, std::vector<float>(static_cast<std::size_t>(boxes), 8)) +
               node("Mul", {"boxes", "sizes"}, "in_pixels") + cells("class_cells", scores) +
               reshape("class_cells", "scores", {1, n, boxes}) +
               node("Concat", {"in_pixels", "scores"}, "output0",
                    bytes(5, bytes(1, "axis") + number(3, 1) + number(20, 2))) +
               bytes(2, "constant") + bytes(11, value_info("images", {1, 3, side, side})) +
               bytes(12, value_info("output0", {1, 4 + n, boxes})));
}

struct Output {
  std::string name;
  std::vector<int> shape;
  std::vector<float> values;
};

// A network that answers every picture of `side` x `side` pixels with these outputs.
inline std::string constant_network(int side, const std::vector<Output>& outputs) {
  std::string graph =
      node("Conv", {"images", "none", "zero"}, "nothing",
           integers("kernel_shape", {side, side}) + integers("strides", {side, side})) +
      weights("none", {1, 3, side, side}, std::vector<float>(static_cast<std::size_t>(side) * side * 3, 0)) +
      weights("zero", {1}, {0});
  for (const Output& output : outputs) {
    const int total = static_cast<int>(output.values.size());
    graph += weights(output.name + "_zeros", {total, 1, 1, 1}, std::vector<float>(output.values.size(), 0)) +
             weights(output.name + "_values", {total}, output.values) +
             node("Conv", {"nothing", output.name + "_zeros", output.name + "_values"}, output.name + "_row",
                  integers("kernel_shape", {1, 1})) +
             reshape(output.name + "_row", output.name, output.shape) +
             bytes(12, value_info(output.name, output.shape));
  }
  return model(graph + bytes(2, "constant") + bytes(11, value_info("images", {1, 3, side, side})));
}

}  // namespace cerberus::tests::onnx
