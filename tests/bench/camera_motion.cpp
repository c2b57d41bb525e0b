// SPDX-License-Identifier: LGPL-2.1-or-later
// The error of the estimated camera motion. Synthetic pictures, whose motion is known exactly: what a lens shows of a
// camera that turns and shakes, with noise and a large moving object. And real frames with an independent estimate to
// compare with. Errors are distances between where two transforms take a grid of 16 points, in pixels of the frame.
#include "vision/ego_motion/camera_motion.h"

#include <gst/gst.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "control/base_rate.h"
#include "frames.h"
#include "support/data.h"
#include "support/motions.h"
#include "support/pictures.h"
#include "vision/image/luma/luma.h"

using namespace cerberus;
using namespace cerberus::vision;
using sensing::degrees;
using sensing::radians;

namespace {

constexpr int kAnalysisWidth = 320;
constexpr std::pair<const char*, MotionModel> kModels[] = {{"translation", MotionModel::translation},
                                                           {"similarity", MotionModel::similarity},
                                                           {"affine", MotionModel::affine},
                                                           {"homography", MotionModel::homography}};

double distance(const Transform& a, const Transform& b, Size size) {
  double sum = 0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      const Point p{(i + 0.5) * size.width / 4, (j + 0.5) * size.height / 4}, q = a.apply(p), r = b.apply(p);
      sum += std::hypot(q.x - r.x, q.y - r.y);
    }
  return sum / 16;
}

class Errors {
 public:
  void add(double error) { all_.push_back(error); }
  void print(const char* unit) {
    if (all_.empty()) return;
    std::ranges::sort(all_);
    double sum = 0;
    for (const double e : all_) sum += e;
    const auto at = [&](double share) { return all_[static_cast<std::size_t>(share * (all_.size() - 1))]; };
    std::printf("mean %6.3f  median %6.3f  90 %% %6.3f  most %6.3f %s", sum / all_.size(), at(0.5), at(0.9),
                at(1), unit);
  }

 private:
  std::vector<double> all_;
};

// ---- synthetic

// What a camera does from frame to frame, degrees.
struct Turns {
  const char* name;
  double pan, tilt, roll;  // at most
  double object;           // share of the picture that goes its own way
};
constexpr Turns kTurns[] = {{"a camera that shakes", 0.1, 0.1, 0.1, 0},
                            {"a pan of up to 30 degrees a second", 1, 0.1, 0, 0},
                            {"a pan of up to 90 degrees a second", 3, 0.3, 0.3, 0},
                            {"the same, a quarter of it a person close by", 3, 0.3, 0.3, 0.25},
                            {"the same, 40 % of it", 3, 0.3, 0.3, 0.4}};

// `prior_share`: the share of the turn (but for its roll) in the head's pose; 0: there is no pose.
void synthetic(const Turns& turns, MotionModel model, const char* name, double prior_share = 0) {
  constexpr Size size{320, 240};
  const Lens lens(radians(60), size);
  Errors pixels, angle;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> any(-1, 1);
    const tests::Scene scene(seed), coat(seed + 1000, 60);
    const double pan = radians(turns.pan * any(random)), tilt = radians(turns.tilt * any(random));
    const double roll = radians(turns.roll * any(random));
    const double cx = 0.5 * (size.width - 1), cy = 0.5 * (size.height - 1);
    const Transform truth = Transform::translation(cx, cy) * tests::similarity(1, roll, 0, 0) *
                            Transform::translation(-cx, -cy) * lens.turn(0, 0, pan, tilt);
    Image<std::uint8_t> earlier(size), later(size), object(size);
    tests::look(scene, {}, earlier.view());
    tests::look(scene, truth, later.view());
    tests::look(coat, {}, object.view());
    const double side = std::sqrt(turns.object);
    const int w = static_cast<int>(side * size.width), h = static_cast<int>(side * size.height);
    const int x = static_cast<int>(random() % static_cast<unsigned>(size.width - w - 16)) + 8,
              own = random() % 2 ? 6 : -6;
    for (int row = size.height - h; row < size.height && w > 0; ++row) {
      std::copy_n(object.view().row(row), w, earlier.view().row(row) + x);
      std::copy_n(object.view().row(row), w, later.view().row(row) + x + own);
    }
    tests::add_noise(earlier.view(), 2, 5, random);
    tests::add_noise(later.view(), 2, 5, random);
    CameraMotion camera;
    camera.set_options({model});
    camera.update(earlier.view());
    std::optional<Transform> prior;
    if (prior_share != 0) prior = lens.turn(0, 0, prior_share * pan, prior_share * tilt);
    const CameraMotionResult result = camera.update(later.view(), prior);
    pixels.add(distance(result.transform, truth, size));
    angle.add(std::abs(degrees(control::base_turn(result.transform, lens, size, {}, {}).yaw - pan)));
  }
  std::printf("  %-11s  ", name);
  pixels.print("px, ");
  std::printf("of the pan ");
  angle.print("degrees\n");
}

// ---- real

// Transforms from frame 0 to each frame, as the file of that name beside the frames holds them.
std::vector<Transform> read_homographies(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);  // size:
  std::getline(file, line);  // bounds:
  std::vector<Transform> all;
  for (Transform t;;) {
    for (double& m : t.m)
      if (!(file >> m)) return all;
    all.push_back(t);
  }
}

void real() {
  const auto folder = tests::data_folder();
  const auto truth =
      folder ? read_homographies(*folder / "davis_tennis/homographies.txt") : std::vector<Transform>{};
  if (truth.empty()) return void(std::printf("real frames: %s\n", tests::kNoData));
  const auto frames =
      bench::load_frames("multifilesrc location=" + (*folder / "davis_tennis/frames/%05d.jpg").string() +
                             " start-index=0 stop-index=69 caps=image/jpeg,framerate=24/1 ! jpegdec",
                         "GRAY8", 0, 0, 70);
  if (!frames || frames->data.size() > truth.size())
    return void(std::printf("real frames: they cannot be read\n"));
  const Size size{frames->width, frames->height};
  std::printf(
      "tennis, %d x %d, analysed %d wide, against the homographies of the data set (an estimate too)\n",
      size.width, size.height, kAnalysisWidth);
  for (const auto& [name, model] : kModels) {
    CameraMotion camera;
    camera.set_options({model});
    LumaScaler scaler;
    Errors errors;
    double confidence = 0;
    int cuts = 0;
    for (std::size_t k = 0; k < frames->data.size(); ++k) {
      const GrayView frame = frames->grey(k);
      const LumaSource source{frame.data, frame.width, frame.height, frame.stride};
      const Size small = analysis_size(size, kAnalysisWidth);
      Image<std::uint8_t> picture(small);
      scaler.scale(source, picture.view());
      const CameraMotionResult result = camera.update(picture.view());
      if (k == 0) continue;
      cuts += result.scene_age == 1;
      confidence += result.confidence;
      errors.add(distance(result.transform.rescaled(small, size), truth[k] * truth[k - 1].inverse(), size));
    }
    std::printf("  %-11s  ", name);
    errors.print("px");
    std::printf(", mean confidence %.2f, %d cuts\n", confidence / (frames->data.size() - 1), cuts);
  }
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  std::printf("synthetic frames, 320 x 240 through 60 degrees, noise 2 to 5, 60 pairs each\n");
  for (const Turns& turns : kTurns) {
    std::printf("%s\n", turns.name);
    for (const auto& [name, model] : kModels)
      if (model != MotionModel::affine) synthetic(turns, model, name);
    synthetic(turns, MotionModel::similarity, "..., a head", 1);
    synthetic(turns, MotionModel::similarity, "..., 90 %", 0.9);
  }
  real();
}
