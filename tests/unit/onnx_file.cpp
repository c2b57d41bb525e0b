// SPDX-License-Identifier: LGPL-2.1-or-later
// Small ONNX models, written by hand: what is read from their files, and what is written anew in them.
#include "vision/persons/onnx_file.h"

#include <array>
#include <random>
#include <string>
#include <vector>

#include "support/onnx.h"
#include "support/suite.h"

using namespace cerberus::vision;
namespace onnx = cerberus::tests::onnx;

namespace {

std::span<const std::uint8_t> bytes_of(const std::string& file) {
  return {reinterpret_cast<const std::uint8_t*>(file.data()), file.size()};
}

std::string with_full_factors(const std::string& file) {
  const auto other = onnx_with_full_factors(bytes_of(file));
  return other ? std::string(other->begin(), other->end()) : std::string();
}

// `boxes` is multiplied by `sizes`, which is `constant`; the output is 1 x 6 x 3.
std::string graph_with(const std::string& constant, const char* type = "Mul") {
  return onnx::model(constant + onnx::node(type, {"boxes", "sizes"}, "output0") +
                     onnx::bytes(11, onnx::value_info("images", {1, 3, 64, 64})) +
                     onnx::bytes(12, onnx::value_info("output0", {1, 6, 3})));
}

const std::vector<float> kSizes{8, 16, 32};
const std::vector<float> kFull{8, 16, 32, 8, 16, 32, 8, 16, 32, 8, 16, 32};

}  // namespace

START_TEST(the_input_size_of_an_onnx_model_is_read_from_its_file) {
  const auto size_in = [](const std::string& file) { return onnx_input_size(bytes_of(file)); };
  const std::string good = onnx::constant_yolo(64, {1, 2, 3, 4, 5});
  ck_assert(size_in(good) == Size(64, 64));
  const auto with_input = [](std::vector<int> shape) {
    return onnx::model(onnx::bytes(11, onnx::value_info("weight", {8, 3})) +
                       onnx::bytes(11, onnx::value_info("x", std::move(shape))));
  };
  ck_assert(size_in(with_input({0, 3, 480, 640})) == Size(640, 480));
  for (const auto& shape : std::vector<std::vector<int>>{
           {1, 3, 0, 0}, {1, 4, 64, 64}, {1, 3, 64}, {2, 3, 64, 64}, {1, 3, 9000, 64}})
    ck_assert(!size_in(with_input(shape)));
  std::string newer = good;  // begins with the IR version
  newer[1] = 13;
  ck_assert(size_in(newer) == Size(64, 64));
  newer[1] = 2;
  ck_assert(!size_in(newer));
  for (const char* text : {"", "not a model", "\x08", "\x3a\xff\xff\xff\xff\x7f"}) ck_assert(!size_in(text));
  for (std::size_t n = 0; n < good.size(); n += 7) size_in(good.substr(0, n));  // reads nothing beyond
}
END_TEST

START_TEST(factors_of_boxes_are_written_out_for_each_number_of_a_box) {
  const std::string wanted = graph_with(onnx::weights("sizes", {1, 4, 3}, kFull));
  // As Ultralytics' tools write it, and as a node that is a constant.
  const auto as_node = [](const std::string& tensor) {
    return onnx::bytes(1, onnx::bytes(2, "sizes") + onnx::bytes(4, "Constant") +
                              onnx::bytes(5, onnx::bytes(1, "value") + onnx::bytes(5, tensor)));
  };
  const auto names_first = [](std::vector<int> shape, const std::vector<float>& values) {
    std::string lengths;
    for (const int n : shape) lengths += onnx::number(1, static_cast<std::uint64_t>(n));
    const std::string raw(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
    return onnx::bytes(8, "sizes") + lengths + onnx::number(2, 1) + onnx::bytes(9, raw);
  };
  const std::string full = names_first({1, 4, 3}, kFull);
  ck_assert(with_full_factors(graph_with(onnx::weights("sizes", {1, 3}, kSizes))) ==
            graph_with(onnx::bytes(5, full)));
  ck_assert(with_full_factors(graph_with(as_node(names_first({1, 3}, kSizes)))) == graph_with(as_node(full)));
  // Lengths and floats packed into a field each.
  const std::string packed =
      onnx::bytes(8, "sizes") + onnx::bytes(1, std::string("\1\3")) + onnx::number(2, 1) +
      onnx::bytes(4,
                  std::string(reinterpret_cast<const char*>(kSizes.data()), kSizes.size() * sizeof(float)));
  ck_assert(with_full_factors(graph_with(onnx::bytes(5, packed))) == graph_with(onnx::bytes(5, full)));
}
END_TEST

START_TEST(a_model_without_such_factors_stays_as_it_is) {
  const auto sizes = onnx::weights("sizes", {1, 3}, kSizes);
  ck_assert(with_full_factors(graph_with(sizes, "Add")).empty());
  ck_assert(with_full_factors(graph_with(onnx::weights("others", {1, 3}, kSizes))).empty());
  ck_assert(with_full_factors(graph_with(onnx::weights("sizes", {1, 2}, {1, 2}))).empty());
  ck_assert(with_full_factors(graph_with(onnx::weights("sizes", {3}, kSizes))).empty());
  ck_assert(with_full_factors(graph_with(onnx::weights("sizes", {1, 4, 3}, kFull))).empty());
  ck_assert(with_full_factors(graph_with(onnx::weights("sizes", {1, 3}, {1, 2}))).empty());  // too few
  ck_assert(with_full_factors("").empty());
  ck_assert(with_full_factors("not a model").empty());
}
END_TEST

// Cut anywhere, or with a byte changed: no read beyond the file (sanitizers), and no endless loop.
START_TEST(a_damaged_file_is_read_to_its_end_at_most) {
  const std::string good = onnx::constant_yolo_in_cells(32, {1, 1, 1, 1}, {.5f});
  ck_assert(!with_full_factors(good).empty());
  for (std::size_t n = 0; n < good.size(); n += 5) {
    const std::vector<std::uint8_t> cut(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(n));
    onnx_with_full_factors(cut);
  }
  std::mt19937 random(1);
  for (int n = 0; n < 3000; ++n) {
    std::vector<std::uint8_t> damaged(good.begin(), good.end());
    damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
    damaged[random() % 200] = static_cast<std::uint8_t>(random());
    onnx_with_full_factors(damaged), onnx_input_size(damaged);
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "onnx_file", {the_input_size_of_an_onnx_model_is_read_from_its_file,
                    factors_of_boxes_are_written_out_for_each_number_of_a_box,
                    a_model_without_such_factors_stays_as_it_is, a_damaged_file_is_read_to_its_end_at_most});
}
