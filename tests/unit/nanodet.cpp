// SPDX-License-Identifier: LGPL-2.1-or-later
// Outputs of NanoDet, made by hand: one person, whose distances are known in cells.
#include "vision/persons/nanodet.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "support/suite.h"
#include "vision/persons/network_output.h"

using namespace cerberus::vision;

namespace {

// Cells of 8, 16, 32 and 64 pixels: 12 x 8, 6 x 4, 3 x 2 and 2 x 1.
constexpr Size kInput{96, 64};
constexpr int kCells[] = {96, 24, 6, 2};
constexpr int kBins = 8;

struct Output {
  std::vector<float> values;
  std::vector<int> shape;
  float& at(int row, int column) {
    return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(shape.back()) +
                  static_cast<std::size_t>(column)];
  }
};
Output output_of(int rows, int columns, float value) {
  return {std::vector<float>(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns), value),
          {rows, columns}};
}

// A distance in cells, whole or half, from `column` on: all the weight in one bin, or in two alike.
void set_distance(Output& output, int row, int column, double cells) {
  for (const double bin : {std::floor(cells), std::ceil(cells)})
    output.at(row, column + static_cast<int>(bin)) = 90;
}
// From the cell: 1 to the left, 2.5 up, 1.5 to the right, 3 down.
void set_distances(Output& output, int row, int column) {
  const double cells[] = {1, 2.5, 1.5, 3};
  for (int side = 0; side < 4; ++side) set_distance(output, row, column + side * kBins, cells[side]);
}

// Scores of all levels, then distances of all levels, as nanodet.onnx has them. The person is of 16 pixels' cell 2, 3 (row
// 3 of 4): number 20 of its level.
std::vector<Output> pairs(int classes, int person, int levels = 3) {
  std::vector<Output> outputs;
  for (int level = 0; level < levels; ++level) outputs.push_back(output_of(kCells[level], classes, .02f));
  for (int level = 0; level < levels; ++level) outputs.push_back(output_of(kCells[level], 4 * kBins, -3));
  outputs[1].at(20, person) = .7f;
  set_distances(outputs[static_cast<std::size_t>(levels + 1)], 20, 0);
  return outputs;
}
// The same in one list, behind the 96 cells of 8 pixels.
Output plus(int classes, int person, int cells = 128) {
  Output output = output_of(cells, classes + 4 * kBins, -3);
  for (int row = 0; row < cells; ++row)
    for (int n = 0; n < classes; ++n) output.at(row, n) = .02f;
  output.at(96 + 20, person) = .7f;
  set_distances(output, 96 + 20, classes);
  return output;
}

struct Reading {
  std::vector<PersonDetection> hits;
  std::string wrong;
  NetworkInput input;
};
Reading read(const std::vector<Output>& outputs, PersonClass person = {}) {
  std::vector<NetworkOutput> given;
  for (const Output& output : outputs) given.push_back({output.values, output.shape});
  NetworkReader reader(kInput, person);
  Reading reading;
  reading.wrong = reader.read(given, .5, reading.hits).value_or("");
  reading.input = reader.usual_input();
  return reading;
}
void expect_box(const char* what, const Reading& reading, const Box& box) {
  ck_assert_msg(reading.wrong.empty(), "%s: %s", what, reading.wrong.c_str());
  ck_assert_msg(reading.hits.size() == 1, "%s: %zu hits", what, reading.hits.size());
  const Box& found = reading.hits[0].box;
  ck_assert_msg(std::abs(found.x - box.x) < 1e-3 && std::abs(found.y - box.y) < 1e-3 &&
                    std::abs(found.width - box.width) < 1e-3 && std::abs(found.height - box.height) < 1e-3,
                "%s: %g,%g %gx%g", what, found.x, found.y, found.width, found.height);
  ck_assert_double_eq_tol(reading.hits[0].score, .7, 1e-6);
}

// Cell 2, 3 of 16 pixels has its middle at 40, 56 and its corner at 32, 48.
constexpr Box kFromMiddle{24, 16, 40, 88}, kFromCorner{16, 8, 40, 88};

}  // namespace

START_TEST(nanodet_measures_its_boxes_from_the_middles_of_its_cells) {
  expect_box("three levels", read(pairs(80, 0)), kFromMiddle);
  expect_box("four levels", read(pairs(80, 0, 4)), kFromMiddle);
  expect_box("one class", read(pairs(1, 0)), kFromMiddle);
  expect_box("as many classes as distances", read(pairs(32, 0)), kFromMiddle);
  expect_box("another class", read(pairs(80, 7), {.number = 7, .classes = 80}), kFromMiddle);
  ck_assert(read(pairs(80, 7)).hits.empty());
  std::vector<Output> turned = pairs(80, 0);
  std::swap(turned[1], turned[4]);
  for (Output& output : turned) output.shape.insert(output.shape.begin(), 1);
  expect_box("in another order, with a batch", read(turned), kFromMiddle);
}
END_TEST

START_TEST(nanodet_plus_measures_them_from_the_corners) {
  expect_box("80 classes", read({plus(80, 0)}), kFromCorner);
  expect_box("one class", read({plus(1, 0)}), kFromCorner);
  expect_box("cells of three sizes", read({plus(80, 0, 126)}), kFromCorner);
  expect_box("another class", read({plus(80, 7)}, {.number = 7, .classes = 80}), kFromCorner);
}
END_TEST

START_TEST(nanodet_takes_levels_about_the_mean_of_its_pictures) {
  for (const Reading& reading : {read(pairs(80, 0)), read({plus(80, 0)})}) {
    ck_assert_double_eq(reading.input.mean[0], 103.53);
    ck_assert_double_eq(reading.input.scale[2], 1 / 58.395);
  }
}
END_TEST

START_TEST(scores_without_a_sigmoid_are_refused) {
  std::vector<Output> outputs = pairs(80, 0);
  for (int level = 0; level < 3; ++level) outputs[static_cast<std::size_t>(level)].at(0, 3) = -4.5f;
  const Reading reading = read(outputs);
  ck_assert_msg(reading.wrong.find("scores are no probabilities") != std::string::npos, "%s",
                reading.wrong.c_str());
  ck_assert(
      read(pairs(80, 0), {.number = 80, .classes = 81}).wrong.find("80 classes, and the labels name 81") !=
      std::string::npos);
}
END_TEST

START_TEST(scores_that_a_later_picture_shows_to_be_none_are_refused) {
  std::vector<Output> outputs = pairs(80, 0);
  NetworkReader reader(kInput, {});
  std::vector<PersonDetection> hits;
  const auto look = [&] {
    std::vector<NetworkOutput> given;
    for (const Output& output : outputs) given.push_back({output.values, output.shape});
    return reader.read(given, .5, hits);
  };
  ck_assert(!look());
  outputs[2].at(0, 0) = 12;
  const auto wrong = look();
  ck_assert(wrong && wrong->find("no probabilities") != std::string::npos);
  ck_assert_uint_eq(hits.size(), 1);
  outputs.pop_back();
  ck_assert(look()->find("there are fewer than before") != std::string::npos);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "nanodet",
      {nanodet_measures_its_boxes_from_the_middles_of_its_cells, nanodet_plus_measures_them_from_the_corners,
       nanodet_takes_levels_about_the_mean_of_its_pictures, scores_without_a_sigmoid_are_refused,
       scores_that_a_later_picture_shows_to_be_none_are_refused});
}
