// SPDX-License-Identifier: LGPL-2.1-or-later
// Whether people detectors know the figures of the simulated house for people, and what a picture costs.
//
//   bench-house [PLAN]        by default the office that comes along
//
// A person counts while it is 60 to 200 of 240 lines high, whole inside the picture, and at least .9 of it is visible. Recall
// at IoU .5, and boxes a picture that are nobody (IoU below .3). Each must come within .1 of the recall on real people of the
// same height, who are neither cut off nor hidden: nine development sequences, brought to 240 lines, .87 with HOG and .97
// with the published network of 403 people.
#include <gst/gst.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "asked.h"
#include "sim/house/house_camera.h"
#include "sim/house/walker.h"
#include "support/data.h"
#include "verify/detector_use.hpp"
#include "vision/geometry/box.h"
#include "vision/persons/whole_frame_detector.h"

using namespace cerberus;
using namespace cerberus::bench;

namespace {

constexpr double kReal[] = {.87, .97}, kNear = .1;
constexpr double kRate = 30, kTimes = 5;        // pictures a second, and how many times as fast it must be
constexpr double kExposure = .01;               // seconds
constexpr int kPictures = 480, kEvery = 15;     // of a place; a look each
constexpr double kLowest = 60, kHighest = 200;  // lines

struct Place {
  double x, y, yaw;
  sim::Rectangle walks;
};
constexpr Place kPlaces[] = {{3.6, 9, .1, {6, 7, 12.8, 13.3}},
                             {12.5, 13, -2.4, {4, 7.2, 11, 12}},
                             {.6, 5.3, 0, {3, 4.6, 15, 6}},
                             {10, 3.6, -2.8, {5.6, 1.4, 8, 3.6}}};

struct Person {
  sim::Walker walker;
  sim::Clothes clothes;
};

std::vector<Person> people_of(const Place& place, unsigned seed) {
  std::mt19937 random(seed);
  const auto between = [&](double from, double to) {
    return std::uniform_real_distribution<>(from, to)(random);
  };
  std::vector<Person> people;
  for (unsigned i = 0; i < 3; ++i) {
    std::vector<sim::Instruction> way;
    for (int n = 0; n < 6; ++n) {
      sim::Instruction go{sim::Instruction::go};
      go.x = between(place.walks.left, place.walks.right),
      go.y = between(place.walks.top, place.walks.bottom);
      go.speed = between(.5, 2), go.stops = n % 3 == 2;
      way.push_back(go);
      if (go.stops) way.push_back({n == 5 ? sim::Instruction::gesture : sim::Instruction::stand, 0, 0, 0, 2});
    }
    const double x = between(place.walks.left, place.walks.right);
    const double y = between(place.walks.top, place.walks.bottom), heading = between(-3, 3);
    people.push_back({{x, y, heading, way, {between(1.5, 1.9)}}, sim::clothes_of(seed * 8 + i)});
  }
  return people;
}

// The pictures that are looked at, and the truth of each.
struct Look {
  std::vector<std::uint8_t> i420;
  std::vector<sim::PersonTruth> truth;
};

// The camera turns to and fro at up to 45 degrees a second. Adds its CPU seconds.
void take(const sim::FloorPlan& plan, const sim::Lens& lens, std::vector<Look>& looks, double& seconds) {
  unsigned seed = 0;
  for (const Place& place : kPlaces) {
    sim::HouseCamera camera(plan, lens, ++seed);
    std::vector<Person> people = people_of(place, seed);
    const auto pose = [&](double t) {
      return sim::Pose{place.x, place.y, .8, place.yaw + .3 * std::sin(sensing::radians(45) / .3 * t)};
    };
    std::vector<sim::HouseCamera::Subject> subjects;
    for (const Person& p : people) subjects.push_back({&p.walker.stance(), &p.clothes, p.walker.height()});
    Look look;
    for (int n = 0; n < kPictures; ++n) {
      const std::clock_t start = std::clock();
      const double t = n / kRate;
      const int parts = camera.parts(pose(t), pose(t + kExposure));
      for (int i = 0; i < parts; ++i) {
        const double now = t + kExposure * i / parts;
        for (Person& p : people) p.walker.elapse(sim::Time(std::int64_t(now * 1e9)));
        camera.expose(pose(now), subjects);
      }
      camera.develop(look.i420);
      seconds += double(std::clock() - start) / CLOCKS_PER_SEC;
      if (n % kEvery != 0) continue;
      look.truth = camera.truth();
      looks.push_back(look);
    }
  }
}

vision::Box box_of(const sim::PersonTruth& truth) {
  return {truth.left, truth.top, truth.width, truth.height};
}

bool counts(const sim::PersonTruth& truth, const sim::Lens& lens) {
  return truth.height >= kLowest && truth.height < kHighest && truth.visible >= .9 && truth.left >= 0 &&
         truth.top >= 0 && truth.left + truth.width <= lens.width && truth.top + truth.height <= lens.height;
}

double recall_of(vision::WholeFrameDetector& detector, const std::vector<Look>& looks,
                 const sim::Lens& lens) {
  int all = 0, right = 0, others = 0;
  std::vector<vision::PersonDetection> found;
  for (const Look& look : looks) {
    const std::uint8_t* luma = look.i420.data();
    const int area = lens.width * lens.height;
    const auto plane = [](const std::uint8_t* data, int width, int height) {
      vision::LumaSource source;
      source.data = data, source.width = width, source.height = height, source.stride = width;
      return source;
    };
    vision::PictureSource source;
    source.luma = plane(luma, lens.width, lens.height);
    source.blue = plane(luma + area, lens.width / 2, lens.height / 2);
    source.red = plane(luma + area + area / 4, lens.width / 2, lens.height / 2);
    source.planes = vision::ColourPlanes::difference_full;
    vision::PictureCopy picture;
    picture.take(source, 0, 0, {lens.width, lens.height}, detector.sees_colours());
    if (const auto refusal = detector.find(picture.view(), found)) {
      std::fprintf(stderr, "bench-house: %s\n", refusal->c_str());
      return 0;
    }
    const auto overlap = [](const sim::PersonTruth& truth, const vision::PersonDetection& body) {
      return vision::intersection_over_union(box_of(truth), body.box);
    };
    for (const sim::PersonTruth& truth : look.truth) {
      if (!counts(truth, lens)) continue;
      ++all;
      right += std::ranges::any_of(found, [&](const auto& body) { return overlap(truth, body) >= .5; });
    }
    for (const vision::PersonDetection& body : found)
      others +=
          std::ranges::none_of(look.truth, [&](const auto& truth) { return overlap(truth, body) >= .3; });
  }
  std::printf("  of %d people recall %.3f; nobody %.2f a picture\n", all, double(right) / std::max(1, all),
              double(others) / double(std::max<std::size_t>(1, looks.size())));
  return double(right) / std::max(1, all);
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  const std::string file = argc > 1 ? argv[1] : CERBERUS_OFFICE;
  std::ifstream in(file);
  const auto read = sim::read_floor_plan(std::string{std::istreambuf_iterator<char>(in), {}});
  if (const auto* wrong = std::get_if<std::string>(&read)) {
    std::fprintf(stderr, "bench-house: %s: %s\n", file.c_str(), wrong->c_str());
    return 1;
  }
  const sim::Lens lens;
  std::vector<Look> looks;
  double seconds = 0;
  take(std::get<sim::FloorPlan>(read), lens, looks, seconds);
  Asked asked;
  const double milliseconds = 1e3 * seconds / (double(std::size(kPlaces)) * kPictures);
  std::printf("CPU ms a picture %.2f%s\n", milliseconds,
              asked.at_most("CPU ms a picture", milliseconds, 1e3 / kRate / kTimes).c_str());
  plugin::ModelSettings model;
  std::string wrong;
  const auto judge = [&](const char* name, plugin::DetectorKind kind, double real) {
    const auto detector = plugin::make_whole_frame_detector(kind, model, wrong);
    if (!detector) std::fprintf(stderr, "bench-house: %s\n", wrong.c_str());
    std::printf("%s\n", name);
    const double recall = detector ? recall_of(*detector, looks, lens) : 0;
    std::printf("%s\n", asked.at_least(std::string("recall of ") + name, recall, real - kNear).c_str());
  };
  judge("hog", plugin::DetectorKind::hog, kReal[0]);
  if (const auto models = tests::models_folder()) {
    model.model = *models / "yolo-fastest-1.1_body.weights";
    judge("the network", plugin::DetectorKind::model, kReal[1]);
  } else {
    std::printf("%s\n", tests::kNoModels);
  }
  return asked.verdict();
}
