// SPDX-License-Identifier: LGPL-2.1-or-later
// Outputs of networks, made by hand in the layouts that export tools write: a person, a car, and boxes with low scores.
#include "vision/persons/network_output.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "support/suite.h"

using namespace cerberus::vision;

namespace {

// Cells of 8, 16 and 32 pixels: 12 x 8, 6 x 4 and 3 x 2.
constexpr Size kInput{96, 64};
constexpr int kCells = 96 + 24 + 6, kTinyCells = 24 + 6;
constexpr double kThreshold = 0.5;

// The person is at 20, 10 and of 12 x 32 pixels, with a score of .72; the car of .9 at 50, 30.
const std::vector<float> kPerson{26, 26, 12, 32}, kCar{65, 40, 30, 20};
const std::vector<float> kPersonCorners{20, 10, 32, 42}, kCarCorners{50, 30, 80, 50};

struct Output {
  std::vector<float> values;
  std::vector<int> shape;
};

// Rows as `numbers` columns; shape: without the batch.
Output rows_of(const std::vector<std::vector<float>>& rows) {
  Output output{{}, {static_cast<int>(rows.size()), static_cast<int>(rows[0].size())}};
  for (const auto& row : rows) output.values.insert(output.values.end(), row.begin(), row.end());
  return output;
}
Output transposed(const Output& from) {
  Output output{from.values, {from.shape[1], from.shape[0]}};
  for (int y = 0; y < from.shape[0]; ++y)
    for (int x = 0; x < from.shape[1]; ++x)
      output.values[static_cast<std::size_t>(x * from.shape[0] + y)] =
          from.values[static_cast<std::size_t>(y * from.shape[1] + x)];
  return output;
}
Output with_batch(Output output) {
  output.shape.insert(output.shape.begin(), 1);
  return output;
}

std::vector<float> joined(std::vector<float> a, const std::vector<float>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}
// Scores of `classes` classes: the one with this number, and little of the others.
std::vector<float> scores_of(int classes, int number, float score) {
  std::vector<float> scores(static_cast<std::size_t>(classes), 0.01f);
  if (number < classes) scores[static_cast<std::size_t>(number)] = score;
  return scores;
}

// What YOLO returns: boxes all over the picture, of which one is the person and, beside other classes, one a car (class
// 2). object: with a score that there is an object, .9 for both.
std::vector<std::vector<float>> yolo(int boxes, int classes, bool object) {
  std::vector<std::vector<float>> rows;
  for (int i = 0; i < boxes; ++i) {
    const bool person = i == boxes / 3, car = i == boxes / 2;
    const float x = 1 + static_cast<float>(i * 7 % 95), y = 1 + static_cast<float>(i * 5 % 63);
    std::vector<float> row = person ? kPerson : car ? kCar : std::vector<float>{x, y, 9, 5};
    if (object) row.push_back(person || car ? .9f : .02f);
    rows.push_back(joined(row, person ? scores_of(classes, 0, object ? .8f : .72f)
                               : car  ? scores_of(classes, 2, object ? 1.f : .9f)
                                      : scores_of(classes, 0, .01f)));
  }
  return rows;
}
// The same with coordinates in shares of the input.
std::vector<std::vector<float>> in_shares(std::vector<std::vector<float>> rows) {
  for (auto& row : rows)
    for (std::size_t n = 0; n < 4; ++n) row[n] /= n % 2 == 0 ? 96 : 64;
  return rows;
}
std::vector<std::vector<float>> end_to_end(int boxes) {
  std::vector<std::vector<float>> rows{
      joined(kCarCorners, {.9f, 2}), joined(kPersonCorners, {.72f, 0}), {1, 2, 30, 9, .03f, 17}};
  rows.resize(static_cast<std::size_t>(boxes), std::vector<float>(6, 0));
  return rows;
}

struct Reading {
  std::vector<PersonDetection> hits;
  std::string wrong;
  bool takes_bytes = false;
};

Reading read(const std::vector<Output>& outputs, PersonClass person = {}) {
  std::vector<NetworkOutput> given;
  for (const Output& output : outputs) given.push_back({output.values, output.shape});
  NetworkReader reader(kInput, person);
  Reading reading;
  reading.wrong = reader.read(given, kThreshold, reading.hits).value_or("");
  reading.takes_bytes = reader.usual_input().scale[0] == 1;
  return reading;
}

void expect_person(const char* what, const std::vector<Output>& outputs, PersonClass person = {}) {
  const Reading reading = read(outputs, person);
  ck_assert_msg(reading.wrong.empty(), "%s: %s", what, reading.wrong.c_str());
  ck_assert_msg(reading.hits.size() == 1, "%s: %zu hits", what, reading.hits.size());
  const Box box = reading.hits[0].box;
  ck_assert_msg(std::abs(box.x - 20) < 1e-3 && std::abs(box.y - 10) < 1e-3 &&
                    std::abs(box.width - 12) < 1e-3 && std::abs(box.height - 32) < 1e-3,
                "%s: %g,%g %gx%g", what, box.x, box.y, box.width, box.height);
  ck_assert_double_eq_tol(reading.hits[0].score, .72, 1e-4);
}

void expect_refused(const char* what, const std::vector<Output>& outputs, const char* why,
                    PersonClass person = {}) {
  const Reading reading = read(outputs, person);
  ck_assert_msg(reading.wrong.find(why) != std::string::npos, "%s: \"%s\"", what, reading.wrong.c_str());
  ck_assert_msg(reading.hits.empty(), "%s", what);
}

// As its own tools write it beside the list: 1 x 3 x height x width x numbers for each size of cells.
std::vector<Output> maps_of_yolo_5() {
  std::vector<Output> maps;
  for (const auto& [height, width] : {std::pair(8, 12), std::pair(4, 6), std::pair(2, 3)})
    maps.push_back({std::vector<float>(static_cast<std::size_t>(3 * height * width * 85), -4.5f),
                    {1, 3, height, width, 85}});
  return maps;
}

}  // namespace

START_TEST(yolo_with_an_objects_score_is_known_by_three_boxes_for_each_cell_or_its_classes) {
  for (const int classes : {80, 2, 1}) {
    const Output output = rows_of(yolo(3 * kCells, classes, true));
    expect_person("YOLO 5", {with_batch(output)});
    expect_person("without a batch", {output});
    expect_person("transposed", {with_batch(transposed(output))});
  }
  expect_person("tiny", {with_batch(rows_of(yolo(3 * kTinyCells, 1, true)))});
  expect_person("in shares", {with_batch(rows_of(in_shares(yolo(3 * kCells, 80, true))))});
  expect_person("another number of boxes", {with_batch(rows_of(yolo(300, 80, true)))});
  expect_person("known by its labels", {with_batch(rows_of(yolo(300, 7, true)))},
                {.number = 0, .classes = 7});
  // Segmentation: 32 numbers behind the classes, and a second output.
  std::vector<std::vector<float>> rows = yolo(3 * kCells, 80, true);
  for (auto& row : rows) row.resize(117, -2.5f);
  expect_person("segmentation",
                {with_batch(rows_of(rows)), {std::vector<float>(32 * 16 * 24), {1, 32, 16, 24}}});
}
END_TEST

START_TEST(yolo_without_an_objects_score_is_read_in_both_orders) {
  for (const int classes : {80, 2, 1}) {
    const Output output = transposed(rows_of(yolo(kCells, classes, false)));
    expect_person("YOLO 8", {with_batch(output)});
    expect_person("without a batch", {output});
  }
  expect_person("box by box", {with_batch(rows_of(yolo(kCells, 80, false)))});
  expect_person("box by box, one class", {with_batch(rows_of(yolo(kCells, 1, false)))});
  expect_person("box by box, two classes", {with_batch(rows_of(yolo(kCells, 2, false)))},
                {.number = 0, .classes = 2});
  expect_person("in shares", {with_batch(rows_of(in_shares(yolo(300, 80, false))))});
  expect_person("another number of boxes", {with_batch(transposed(rows_of(yolo(300, 2, false))))});
  std::vector<std::vector<float>> rows = yolo(kCells, 1, false);
  for (auto& row : rows) row.resize(56, 40);  // joints, in pixels
  expect_person("joints", {with_batch(transposed(rows_of(rows)))});
}
END_TEST

START_TEST(end_to_end_boxes_are_not_taken_for_those_of_yolo_5) {
  const Output output = rows_of(end_to_end(300));
  expect_person("YOLO 10", {with_batch(output)});
  expect_person("without a batch", {output});
  expect_person("transposed", {with_batch(transposed(output))});
  expect_person("in shares", {rows_of(in_shares(end_to_end(300)))});
  expect_person("as many as a tiny YOLO has", {rows_of(end_to_end(kTinyCells))});
  expect_person("a few", {rows_of(end_to_end(3))});
  expect_person("the person's class", {rows_of(end_to_end(3))}, {.number = 0, .classes = 80});
  ck_assert_double_eq_tol(read({with_batch(output)}, {.number = 2, .classes = 80}).hits.at(0).score, .9,
                          1e-4);
  std::vector<std::vector<float>> rows = end_to_end(300);
  for (auto& row : rows) std::swap(row[4], row[5]);
  expect_person("the class before the score", {with_batch(rows_of(rows))});
  expect_person("one class", {rows_of({joined(kPersonCorners, {.72f}), {1, 2, 30, 9, .03f}})});
}
END_TEST

START_TEST(a_layout_is_decided_when_there_is_a_box) {
  const Output none{std::vector<float>(1800, 0), {1, 300, 6}}, some = with_batch(rows_of(end_to_end(300)));
  NetworkReader reader(kInput, {});
  std::vector<PersonDetection> hits;
  ck_assert(!reader.read(std::vector<NetworkOutput>{{{}, {0, 6}}}, kThreshold, hits));
  ck_assert(!reader.read(std::vector<NetworkOutput>{{none.values, none.shape}}, kThreshold, hits));
  ck_assert(!reader.read(std::vector<NetworkOutput>{{some.values, some.shape}}, kThreshold, hits));
  ck_assert_uint_eq(hits.size(), 1);
  const Output one = rows_of({joined(kPersonCorners, {.72f, 0})});
  ck_assert(!reader.read(std::vector<NetworkOutput>{{one.values, one.shape}}, kThreshold, hits));
  ck_assert_uint_eq(hits.size(), 2);
}
END_TEST

START_TEST(ssd_is_read_from_one_output_and_from_two_in_either_order) {
  const Output seven = rows_of({{0, 1, .72f, 20 / 96.f, 10 / 64.f, 32 / 96.f, 42 / 64.f},
                                {0, 2, .9f, .5f, .5f, .8f, .8f},
                                {-1, 0, 0, 0, 0, 0, 0}});
  expect_person("seven numbers", {with_batch(with_batch(seven))});
  // A softmax of three classes, the first of which is the background.
  const Output corners = with_batch(rows_of(in_shares({kPersonCorners, kCarCorners, {0, 0, 9, 9}})));
  const Output softmax = with_batch(rows_of({{.2f, .72f, .08f}, {.05f, .05f, .9f}, {.98f, .01f, .01f}}));
  expect_person("two outputs", {corners, softmax});
  expect_person("the other way round", {softmax, corners});
  expect_person("labels without a background", {corners, softmax}, {.number = 0, .classes = 2});
  expect_person("labels with a background", {corners, softmax}, {.number = 1, .classes = 3});
}
END_TEST

START_TEST(two_outputs_without_a_background_begin_with_the_first_class) {
  Output corners = rows_of({kPersonCorners, kCarCorners, {0, 0, 9, 9}});
  const Output scores = rows_of({{.72f, .3f, .01f}, {.1f, .01f, .9f}, {.01f, .02f, .01f}});
  expect_person("in pixels", {with_batch(corners), with_batch(scores)});
  expect_person("number after number", {with_batch(transposed(corners)), with_batch(transposed(scores))});
  corners.shape = {1, 3, 1, 4};  // YOLO 4
  expect_person("a dimension of length 1", {corners, with_batch(scores)});
}
END_TEST

START_TEST(of_several_outputs_the_list_of_boxes_is_read_wherever_it_stands) {
  const Output list = with_batch(rows_of(yolo(3 * kCells, 80, true)));
  for (std::size_t place = 0; place <= 3; ++place) {
    std::vector<Output> outputs = maps_of_yolo_5();
    outputs.insert(outputs.begin() + static_cast<std::ptrdiff_t>(place), list);
    expect_person("among maps", outputs);
    for (Output& output : outputs)  // maps as lists: each has the boxes of one size of cells
      if (output.shape.size() == 5)
        output.shape = {1, output.shape[1] * output.shape[2] * output.shape[3], 85};
    expect_person("among lists", outputs);
  }
}
END_TEST

// Cell 96 + 6 + 2 is the third of the second row of 16 pixels. x = (2 + .5) 16, y = (1 + .25) 16, width = e^0 16, height =
// 2 x 16.
START_TEST(boxes_of_yolox_are_decoded_and_its_pictures_have_values_to_255) {
  std::vector<std::vector<float>> rows(kCells, joined({.3f, -.2f, -1.5f, .4f, .02f}, scores_of(80, 0, .01f)));
  rows[104] = joined({.5f, .25f, 0, std::numbers::ln2_v<float>, .9f}, scores_of(80, 0, .8f));
  const Reading raw = read({with_batch(rows_of(rows))});
  ck_assert_msg(raw.wrong.empty(), "%s", raw.wrong.c_str());
  ck_assert_uint_eq(raw.hits.size(), 1);
  ck_assert_double_eq_tol(raw.hits[0].box.x, 40 - 8, 1e-4);
  ck_assert_double_eq_tol(raw.hits[0].box.y, 20 - 16, 1e-4);
  ck_assert_double_eq_tol(raw.hits[0].box.width, 16, 1e-4);
  ck_assert_double_eq_tol(raw.hits[0].box.height, 32, 1e-4);
  ck_assert(raw.takes_bytes);
  for (auto& row : rows) row[2] = row[3] = .4f;  // none is smaller than its cell
  ck_assert_uint_eq(read({with_batch(rows_of(rows))}).hits.size(), 1);
  ck_assert_double_eq_tol(read({with_batch(rows_of(rows))}).hits[0].box.width, 16 * std::exp(.4), 1e-4);
  const Output decoded = with_batch(rows_of(yolo(kCells, 80, true)));
  expect_person("decoded", {decoded});
  ck_assert(read({decoded}).takes_bytes);
  // YOLO 6 has the same shape. It is certain of every object, and takes values to 1.
  rows = yolo(kCells, 80, true);
  for (auto& row : rows) {
    for (std::size_t n = 5; n < row.size(); ++n) row[n] *= row[4];
    row[4] = 1;
  }
  expect_person("YOLO 6", {with_batch(rows_of(rows))});
  ck_assert(!read({with_batch(rows_of(rows))}).takes_bytes);
  ck_assert(!read({with_batch(rows_of(yolo(3 * kCells, 80, true)))}).takes_bytes);
}
END_TEST

START_TEST(a_box_that_is_clipped_away_at_the_edge_is_left_out_and_ends_no_stream) {
  for (const std::size_t side : {std::size_t{2}, std::size_t{3}})
    for (const float size : {0.f, -.5f}) {
      auto rows = yolo(kCells, 80, false);
      rows[5] = rows[kCells / 3];  // another person
      rows[5][side] = size;
      expect_person("YOLO 8", {with_batch(transposed(rows_of(rows)))});
    }
  auto rows = end_to_end(300);
  rows[2] = {96, 10, 96, 42, .9f, 0};
  expect_person("end to end", {with_batch(rows_of(rows))});
  rows = end_to_end(300);
  rows[0] = rows[1] = rows[2] = {0, 64, 30, 64, .9f, 0};  // the only boxes
  const Reading alone = read({with_batch(rows_of(rows))});
  ck_assert(alone.wrong.empty() && alone.hits.empty());
}
END_TEST

// The first run decides the layout; each later one is judged, too.
START_TEST(a_later_run_most_of_whose_boxes_have_no_size_is_refused) {
  NetworkReader reader(kInput, {});
  std::vector<PersonDetection> hits;
  auto rows = yolo(kCells, 80, false);
  const auto wrong = [&] {
    const Output output = with_batch(transposed(rows_of(rows)));
    return reader.read(std::vector{NetworkOutput{output.values, output.shape}}, kThreshold, hits)
        .value_or("");
  };
  ck_assert(wrong().empty() && hits.size() == 1);
  for (std::size_t i = 0; i < kCells / 2 + 1; ++i) rows[i][2] = 0;
  ck_assert(wrong().find("have no size") != std::string::npos);
  ck_assert(hits.size() == 1);
  rows[0][2] = rows[1][2] = 9;
  ck_assert(wrong().empty());
}
END_TEST

START_TEST(what_cannot_be_read_is_refused_with_its_shape_and_the_reason) {
  std::vector<std::vector<float>> rows = yolo(kCells, 80, false);
  rows[3][4] = -3.5f;
  expect_refused("logits", {with_batch(transposed(rows_of(rows)))}, "84 x 126 cannot be read: scores are no");
  rows = yolo(3 * kCells, 80, true);
  rows[3][4] = 1.76f;
  expect_refused("an object's score above 1", {with_batch(rows_of(rows))}, "no probabilities (1.76");
  rows = yolo(kCells, 80, false);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i][2] = -1;
  expect_refused("boxes that are not decoded", {with_batch(transposed(rows_of(rows)))}, "have no size");
  rows = end_to_end(300);
  for (auto& row : rows) row[5] += .5f;
  expect_refused("six numbers without a class", {with_batch(rows_of(rows))}, "no probabilities");
  expect_refused("five or six numbers and classes", {with_batch(rows_of(yolo(300, 7, true)))},
                 "name all of them with labels=");
  expect_refused("labels that do not fit", {with_batch(rows_of(yolo(300, 7, true)))},
                 "12 numbers, which are not 4 or 5 and the 80 classes", {.number = 0, .classes = 80});
  expect_refused("two classes, or one and an object", {with_batch(rows_of(yolo(kCells, 2, false)))},
                 "labels=");
  expect_refused("labels of another network", {with_batch(transposed(rows_of(yolo(kCells, 20, false))))},
                 "has 20 classes, and the labels name 80", {.number = 0, .classes = 80});
  expect_refused("classes elsewhere",
                 {with_batch(rows_of(std::vector(9, joined(kPersonCorners, {.72f})))),
                  with_batch(Output{std::vector<float>(9, 0), {9}})},
                 "classes of its boxes are missing");
  const std::vector<float> numbers(1600 * 80, .1f);
  const auto list = [&](int boxes, int each) {
    return Output{{numbers.begin(), numbers.begin() + boxes * each}, {boxes, each}};
  };
  expect_refused("NanoDet, 320 x 320",
                 {list(1600, 80), list(400, 80), list(100, 80), list(1600, 32), list(400, 32), list(100, 32)},
                 "more than one may be");
  expect_refused("maps alone", maps_of_yolo_5(), "no list of boxes");
  expect_refused("a classifier", {with_batch(Output{std::vector<float>(1000, .001f), {1000}})},
                 "no list of boxes");
  expect_refused("another size than its numbers", {Output{{1, 2, 3}, {1, 6, 8}}}, "another size");
  expect_refused("nothing", {}, "no list of boxes");
  expect_refused("DETR: middles and logits",
                 {with_batch(rows_of({{.5f, .5f, .2f, .3f}, {.4f, .4f, .1f, .1f}})), with_batch(list(2, 92))},
                 "not left, top, right");
}
END_TEST

START_TEST(numbers_that_are_not_finite_are_no_boxes) {
  std::vector<std::vector<float>> rows = yolo(kCells, 80, false);
  rows[1][0] = NAN, rows[1][4] = .9f;
  rows[2][2] = INFINITY, rows[2][4] = .9f;
  rows[3][4] = NAN;
  expect_person("not finite", {with_batch(transposed(rows_of(rows)))});
}
END_TEST

// OpenCV gives boxes in shares, and scores of classes that are multiplied by the object's already.
START_TEST(each_output_of_darknet_is_a_list_of_boxes) {
  std::vector<std::vector<float>> first(12, {.5f, .5f, .2f, .3f, .01f, 0, 0}), second(6, first[0]);
  first[5] = {26 / 96.f, 26 / 64.f, 12 / 96.f, 32 / 64.f, .9f, .72f, 0};
  second[2] = {65 / 96.f, 40 / 64.f, 30 / 96.f, 20 / 64.f, .95f, 0, .9f};
  const std::vector<Output> outputs{rows_of(first), rows_of(second)};
  const auto read_darknet = [&](PersonClass person, int classes) {
    std::vector<NetworkOutput> given;
    for (const Output& output : outputs) given.push_back({output.values, output.shape});
    NetworkReader reader(kInput, person, classes);
    Reading reading;
    reading.wrong = reader.read(given, kThreshold, reading.hits).value_or("");
    ck_assert_double_eq(reader.usual_input().scale[0], 1 / 255.0);
    return reading;
  };
  const Reading person = read_darknet({}, 2), car = read_darknet({.number = 1, .classes = 2}, 2);
  ck_assert(person.wrong.empty() && person.hits.size() == 1 && car.hits.size() == 1);
  ck_assert_double_eq_tol(person.hits[0].box.x, 20, 1e-4);
  ck_assert_double_eq_tol(person.hits[0].box.height, 32, 1e-4);
  ck_assert_double_eq_tol(person.hits[0].score, .72, 1e-6);
  ck_assert_double_eq_tol(car.hits[0].box.width, 30, 1e-4);
  ck_assert(read_darknet({}, 3).wrong.find("a box has 8 numbers by its configuration") != std::string::npos);
  ck_assert(read_darknet({.number = 2, .classes = 3}, 2).wrong.find("it has 2 classes") != std::string::npos);
}
END_TEST

START_TEST(numbers_for_the_planes_are_read_in_every_locale) {
  const auto one = plane_numbers("0.5"), three = plane_numbers(" 103.53, 116.28,-1e2 ");
  ck_assert(one && (*one)[0] == .5 && (*one)[2] == .5);
  ck_assert(three && (*three)[0] == 103.53 && (*three)[1] == 116.28 && (*three)[2] == -100);
  for (const char* wrong :
       {"", ",", "1,2", "1,2,3,4", "1,2,", "1;2;3", "x", "1 2 3", "nan", "inf,0,0", "0x1p"})
    ck_assert_msg(!plane_numbers(wrong), "%s", wrong);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "network_output",
      {yolo_with_an_objects_score_is_known_by_three_boxes_for_each_cell_or_its_classes,
       yolo_without_an_objects_score_is_read_in_both_orders,
       end_to_end_boxes_are_not_taken_for_those_of_yolo_5, a_layout_is_decided_when_there_is_a_box,
       ssd_is_read_from_one_output_and_from_two_in_either_order,
       two_outputs_without_a_background_begin_with_the_first_class,
       of_several_outputs_the_list_of_boxes_is_read_wherever_it_stands,
       boxes_of_yolox_are_decoded_and_its_pictures_have_values_to_255,
       a_box_that_is_clipped_away_at_the_edge_is_left_out_and_ends_no_stream,
       a_later_run_most_of_whose_boxes_have_no_size_is_refused,
       what_cannot_be_read_is_refused_with_its_shape_and_the_reason, numbers_that_are_not_finite_are_no_boxes,
       each_output_of_darknet_is_a_list_of_boxes, numbers_for_the_planes_are_read_in_every_locale});
}
