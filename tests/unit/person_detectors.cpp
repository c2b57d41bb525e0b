// SPDX-License-Identifier: LGPL-2.1-or-later
// The detectors that OpenCV runs: on drawn bodies, and small networks that return the same for every picture.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/bodies.h"
#include "support/darknet.h"
#include "support/data.h"
#include "support/onnx.h"
#include "support/suite.h"
#include "support/temporary_folder.h"
#include "verify/detector_use.hpp"
#include "verify/hog_detector.hpp"
#include "verify/model_detector.hpp"
#include "vision/persons/whole_frame_detector.h"

using namespace cerberus;
using namespace cerberus::vision;

namespace {

constexpr int kSide = 64;
constexpr Size kFrame{320, 240};

class Files {
 public:
  std::string write(const std::string& name, const std::string& content) const {
    const std::string path = folder_.path + "/" + name;
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }
  std::string path(const std::string& name) const { return folder_.path + "/" + name; }

 private:
  TemporaryFolder folder_;
};

plugin::ModelSettings settings_of(const std::string& model) {
  plugin::ModelSettings settings;
  settings.model = model, settings.threshold = .4;
  return settings;
}

std::vector<PersonDetection> hits_of(const plugin::ModelSettings& settings, std::uint8_t level = 0) {
  std::string wrong;
  const auto detector = plugin::make_model_detector(settings, wrong);
  ck_assert_msg(detector != nullptr, "%s", wrong.c_str());
  Image<std::uint8_t> picture({kSide, kSide});
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) picture.view().at(x, y) = level;
  std::vector<PersonDetection> hits;
  const auto refusal = detector->detect(GrayView(picture.view()), 1, hits);
  ck_assert_msg(!refusal, "%s", refusal.value_or("").c_str());
  return hits;
}

void expect_refused(const plugin::ModelSettings& settings, const std::string& why) {
  std::string wrong;
  ck_assert(!plugin::make_model_detector(settings, wrong));
  ck_assert_msg(wrong.find(why) != std::string::npos, "%s", wrong.c_str());
}

// The first anchor is a person of .9, the second one of a class that the labels name otherwise.
std::vector<tests::darknet::Anchor> anchors(float object = 20) {
  return {{16, 60, object, {2.2f, -9}}, {40, 20, object, {-9, 3}}};
}

void expect_body(const Box& found, const Box& drawn) {
  ck_assert_msg(intersection_over_union(found, drawn) > .5, "%g,%g %gx%g for %g,%g %gx%g", found.x, found.y,
                found.width, found.height, drawn.x, drawn.y, drawn.width, drawn.height);
}

}  // namespace

START_TEST(histograms_of_gradients_find_the_bodies_of_a_whole_frame) {
  Image<std::uint8_t> frame(kFrame);
  tests::fill(frame.view(), 0, 0, kFrame.width, kFrame.height, 170);
  const Box left = tests::draw_person(frame.view(), 70, 80, 110, 60),
            right = tests::draw_person(frame.view(), 210, 110, 80, 60);
  for (const auto kind : {plugin::DetectorKind::daimler, plugin::DetectorKind::hog}) {
    std::string wrong;
    const auto detector = plugin::make_whole_frame_detector(kind, {}, wrong);
    std::vector<PersonDetection> bodies;
    ck_assert(!detector->find(GrayView(frame.view()), bodies));
    ck_assert_uint_ge(bodies.size(), 2);
    expect_body(bodies[0].box, bodies[0].box.x < 160 ? left : right);
    expect_body(bodies[1].box, bodies[0].box.x < 160 ? right : left);
  }
}
END_TEST

START_TEST(a_picture_smaller_than_the_window_has_no_hits) {
  Image<std::uint8_t> picture({8, 8});
  for (const auto weights : {plugin::HogWeights::daimler, plugin::HogWeights::inria})
    for (const double scale : {.01, .2, 1., 3.})
      for (const int padding : {0, 16, 64}) {
        std::vector<PersonDetection> hits;
        ck_assert(!plugin::make_hog_detector(weights, {.threshold = 9, .padding = padding})
                       ->detect(GrayView(picture.view()), scale, hits));
        ck_assert(hits.empty());
      }
}
END_TEST

START_TEST(darknet_weights_are_read_with_the_configuration_beside_them) {
  const Files files;
  auto settings = settings_of(files.write("net.weights", tests::darknet::weights(kSide, anchors())));
  files.write("net.cfg", tests::darknet::cfg(kSide, anchors()));
  auto hits = hits_of(settings);
  ck_assert_uint_eq(hits.size(), 1);
  ck_assert_double_eq_tol(hits[0].box.x, 24, .01);
  ck_assert_double_eq_tol(hits[0].box.y, 2, .01);
  ck_assert_double_eq_tol(hits[0].box.height, 60, .01);
  ck_assert_double_eq_tol(hits[0].score, .9, .01);
  // The other layer's box is of the second class.
  settings.labels = files.write("names", "car\nperson\n");
  hits = hits_of(settings);
  ck_assert_uint_eq(hits.size(), 1);
  ck_assert_double_eq_tol(hits[0].box.width, 40, .01);
}
END_TEST

START_TEST(the_configuration_may_be_named) {
  const Files files;
  auto settings = settings_of(files.write("a.weights", tests::darknet::weights(kSide, anchors())));
  settings.config = files.write("b.cfg", tests::darknet::cfg(kSide, anchors()));
  ck_assert_uint_eq(hits_of(settings).size(), 1);
}
END_TEST

// OpenCV's own threshold is .2.
START_TEST(darknet_boxes_are_found_down_to_the_threshold) {
  const Files files;
  // Objects of .9 with a class of .12.
  const std::vector<tests::darknet::Anchor> faint{{16, 60, 2.2f, {-2}}};
  auto settings = settings_of(files.write("net.weights", tests::darknet::weights(kSide, faint)));
  files.write("net.cfg", tests::darknet::cfg(kSide, faint));
  settings.threshold = .05;
  ck_assert_uint_eq(hits_of(settings).size(), 1);
}
END_TEST

START_TEST(a_threshold_below_what_is_of_use_by_default_finds_fainter_bodies) {
  const Files files;
  const std::vector<tests::darknet::Anchor> faint{{16, 60, 2.2f, {-2}}};  // .11
  plugin::ModelSettings settings;
  settings.model = files.write("net.weights", tests::darknet::weights(kSide, faint));
  files.write("net.cfg", tests::darknet::cfg(kSide, faint));
  Image<std::uint8_t> frame({kSide, kSide});
  tests::fill(frame.view(), 0, 0, kSide, kSide, 0);
  for (const double threshold : {.05, .15, .55}) {
    std::string wrong;
    const auto detector = plugin::make_whole_frame_detector(plugin::DetectorKind::model, settings, wrong,
                                                            plugin::kWholeFrameLines, threshold);
    ck_assert_msg(detector != nullptr, "%s", wrong.c_str());
    std::vector<PersonDetection> bodies;
    ck_assert(!detector->find(GrayView(frame.view()), bodies));
    ck_assert_uint_eq(bodies.size(), threshold < .11 ? 1 : 0);
  }
}
END_TEST

START_TEST(files_of_darknet_that_do_not_fit_are_refused_by_name) {
  const Files files;
  const std::string weights = tests::darknet::weights(kSide, anchors());
  auto settings = settings_of(files.write("net.weights", weights));
  expect_refused(settings, files.path("net.cfg") + " cannot be read");
  files.write("net.cfg", "[net]\nwidth=64\nheight=64\n");
  expect_refused(settings, files.path("net.cfg") + " cannot be used: it has no [yolo] layer");
  files.write("net.cfg", tests::darknet::cfg(kSide, anchors()));
  files.write("net.weights", weights.substr(0, weights.size() - 4000));
  expect_refused(settings, "needs");
  expect_refused(settings, "another network's, or incomplete");
  files.write("net.weights", "<html>not found</html>");
  expect_refused(settings, files.path("net.weights") + " holds no darknet weights");
  expect_refused(settings_of(files.path("net.cfg")), "no darknet weights, whose name ends in .weights");
  std::filesystem::remove(files.path("net.weights"));
  std::filesystem::create_directory(files.path("net.weights"));
  expect_refused(settings, "it is no file");
}
END_TEST

// A network whose score is .5 and a thousandth of the mean level of the last plane, 64 pixels a cell.
START_TEST(mean_and_scale_replace_what_the_layout_says_of_the_input) {
  const Files files;
  constexpr float kLight = .001f / (3 * 8 * 8);
  auto settings =
      settings_of(files.write("net.onnx", tests::onnx::constant_yolo(kSide, {32, 32, 16, 60, .5f}, kLight)));
  const auto score = [&] { return hits_of(settings, 200).at(0).score; };
  ck_assert_double_eq_tol(score(), .5 + .001 * 200 / 255, 1e-5);
  settings.scale = "1";
  ck_assert_double_eq_tol(score(), .7, 1e-4);
  settings.mean = "50";
  ck_assert_double_eq_tol(score(), .65, 1e-4);
  settings.mean = "50, 100,150", settings.scale = "1,2,0";
  ck_assert_double_eq_tol(score(), .5 + .001 * (150 + 200) / 3, 1e-4);
  settings.mean = "1,2";
  expect_refused(settings, "The property mean takes one number or three, not \"1,2\"");
  settings.mean = "", settings.scale = "a quarter";
  expect_refused(settings, "The property scale takes one number or three");
}
END_TEST

// Whatever is in the picture, only the first plane counts: .5, and a thousandth of its level.
START_TEST(colours_reach_the_planes_of_the_network_in_their_order) {
  const Files files;
  constexpr float kLight = .001f / (8 * 8);
  auto settings =
      settings_of(files.write("net.onnx", tests::onnx::constant_yolo(kSide, {32, 32, 16, 60, .5f}, kLight)));
  const auto plane = [](int width, int height, std::uint8_t level) {
    Image<std::uint8_t> image({width, height});
    tests::fill(image.view(), 0, 0, width, height, level);
    return image;
  };
  const auto luma = plane(128, 128, 81), blue = plane(64, 64, 90), red = plane(64, 64, 240);
  PersonPicture picture{GrayView(luma.view())};
  picture.blue = blue.view(), picture.red = red.view(), picture.planes = ColourPlanes::difference_video;
  const auto score = [&](const char* scale) {
    settings.scale = scale;
    std::string wrong;
    std::vector<PersonDetection> hits;
    ck_assert(!plugin::make_model_detector(settings, wrong)->detect(picture, 1, hits));
    return hits.at(0).score;
  };
  ck_assert_double_eq_tol(score("1,0,0"), .5 + .001 * 255, .002);
  ck_assert_double_eq_tol(score("0,1,0"), .5, .002);
  ck_assert_double_eq_tol(score("0,0,1"), .5, .002);
}
END_TEST

// Of the four cells of 32 pixels the last one is a person's.
START_TEST(nanodet_is_read_from_an_onnx_file) {
  const Files files;
  std::vector<tests::onnx::Output> outputs;
  const int cells[] = {64, 16, 4};
  for (const int n : cells)
    outputs.push_back(
        {"scores" + std::to_string(n), {n, 1}, std::vector<float>(static_cast<std::size_t>(n), .02f)});
  for (const int n : cells)
    outputs.push_back(
        {"distances" + std::to_string(n), {n, 32}, std::vector<float>(static_cast<std::size_t>(n) * 32, -3)});
  outputs[2].values[3] = .8f;                           // its middle is at 48, 48
  for (const std::size_t bin : {2, 8 + 1, 16 + 1, 24})  // cells to the left, up, to the right and down
    outputs[5].values[3 * 32 + bin] = 90;
  const auto hits =
      hits_of(settings_of(files.write("net.onnx", tests::onnx::constant_network(kSide, outputs))));
  ck_assert_uint_eq(hits.size(), 1);
  ck_assert_double_eq_tol(hits[0].box.x, 48 - 64, 1e-3);
  ck_assert_double_eq_tol(hits[0].box.y, 48 - 32, 1e-3);
  ck_assert_double_eq_tol(hits[0].box.width, 96, 1e-3);
  ck_assert_double_eq_tol(hits[0].box.height, 32, 1e-3);
  ck_assert_double_eq_tol(hits[0].score, .8, 1e-5);
}
END_TEST

START_TEST(published_networks_can_be_used) {
  const auto folder = tests::models_folder();
  if (!folder) return void(std::printf("skipped: %s\n", tests::kNoModels));
  for (const char* name : {"nanodet.onnx", "yolo-fastest-1.1_body.weights", "yolo-fastest-1.1_body.onnx"}) {
    std::string wrong;
    ck_assert_msg(plugin::make_model_detector(settings_of(*folder / name), wrong) != nullptr, "%s",
                  wrong.c_str());
  }
}
END_TEST

int main() {
  return tests::run_suite("person_detectors",
                          {histograms_of_gradients_find_the_bodies_of_a_whole_frame,
                           a_picture_smaller_than_the_window_has_no_hits,
                           darknet_weights_are_read_with_the_configuration_beside_them,
                           the_configuration_may_be_named, darknet_boxes_are_found_down_to_the_threshold,
                           a_threshold_below_what_is_of_use_by_default_finds_fainter_bodies,
                           files_of_darknet_that_do_not_fit_are_refused_by_name,
                           mean_and_scale_replace_what_the_layout_says_of_the_input,
                           colours_reach_the_planes_of_the_network_in_their_order,
                           nanodet_is_read_from_an_onnx_file, published_networks_can_be_used});
}
