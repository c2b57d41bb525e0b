// SPDX-License-Identifier: LGPL-2.1-or-later
// The complete chain over long stretches in which nothing moves, over cuts and seeks, and over the largest frames: no
// region that is not a moving object.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "support/chain.h"
#include "support/pictures.h"
#include "support/sensor.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr Size kSize{320, 240};
constexpr double kFrame = 1.0 / 25;

// A wall: smooth texture, panels with sharp edges, all brightnesses, no two frames of it needed.
std::vector<float> wall(Size size, std::uint32_t seed) {
  const Scene scene(seed, 30);
  std::vector<float> out(static_cast<std::size_t>(size.area()));
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      out[static_cast<std::size_t>(y) * size.width + x] = static_cast<float>(scene.at(x, y));
  std::mt19937 random(seed);
  const auto any = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int panel = 0; panel < size.area() / 4000; ++panel) {
    const int x0 = any(size.width), y0 = any(size.height), w = 12 + any(50), h = 12 + any(50);
    const auto level = static_cast<float>(any(160) - 80);
    for (int y = y0; y < std::min(y0 + h, size.height); ++y)
      for (int x = x0; x < std::min(x0 + w, size.width); ++x)
        out[static_cast<std::size_t>(y) * size.width + x] += level;
  }
  for (float& v : out) v = std::clamp(v, 5.0f, 250.0f);
  return out;
}

LumaSource source(GrayView v) {
  LumaSource s;
  s.data = v.data, s.width = v.width, s.height = v.height, s.stride = v.stride;
  return s;
}

struct Count {
  int regions = 0, tracks = 0;  // frames with any
  std::string first;
};

// 1000 frames of a scene; `light_of` returns its light. Frames within 3 of a step may have regions, never tracks.
template <typename LightOf>
Count watch(const std::vector<float>& scene, LightOf&& light_of) {
  Noise noise;
  Chain chain;
  Image<std::uint8_t> frame(kSize);
  Count count;
  double exposure = 1;
  int since_step = 100;
  for (int k = 0; k < 1000; ++k) {
    const Light light = light_of(k);
    ++since_step;
    if (std::abs(light.exposure - exposure) > 0.09) since_step = 0;
    exposure = light.exposure;
    expose(scene.data(), kSize.width, light, noise, frame.view());
    chain.step(source(frame.view()), kFrame);
    const bool wrong = !chain.regions().empty() && since_step >= 3;
    count.regions += wrong;
    count.tracks += !chain.tracks().empty();
    if (std::getenv("STEADY_VERBOSE"))
      for (const Region& r : chain.regions())
        std::printf("frame %d (%d) age %d: %.0f,%.0f %.0fx%.0f\n", k, since_step, chain.motion().scene_age,
                    r.box.x, r.box.y, r.box.width, r.box.height);
    if ((wrong || !chain.tracks().empty()) && count.first.empty()) {
      count.first = "frame " + std::to_string(k);
      for (const Region& r : chain.regions())
        count.first += " region " + std::to_string(r.box.x) + "," + std::to_string(r.box.y) + " " +
                       std::to_string(r.box.width) + "x" + std::to_string(r.box.height);
    }
  }
  return count;
}

template <typename LightOf>
Count watch(std::uint32_t seed, LightOf&& light_of) {
  return watch(wall(kSize, seed), light_of);
}

void nothing(const Count& count) {
  ck_assert_msg(count.regions == 0 && count.tracks == 0,
                "%d frames with regions, %d with tracks; the first: %s", count.regions, count.tracks,
                count.first.c_str());
}

// A scene with two textured things that walk to and fro before a wall.
class Street {
 public:
  Street(std::uint32_t seed, Size size, double pan)
      : size_(size), pan_(pan), wall_size_{size.width * 2, size.height}, wall_(wall(wall_size_, seed)) {
    picture_.resize(static_cast<std::size_t>(size.area()));
    const double w = size.width / 320.0, h = size.height / 240.0;
    walkers_[0] = {40 * w, 60 * h, 30 * w, 70 * h, 2.5 * w, seed + 100, {}};
    walkers_[1] = {220 * w, 120 * h, 36 * w, 80 * h, -2 * w, seed + 200, {}};
    for (Walker& walker : walkers_)
      walker.coat = wall({static_cast<int>(walker.width), static_cast<int>(walker.height)}, walker.seed);
  }
  // Frame k of it; boxes() are where the walkers are then.
  const std::vector<float>& draw(int k) {
    const int shift = static_cast<int>(pan_ * k);
    for (int y = 0; y < size_.height; ++y)
      std::copy_n(wall_.begin() + static_cast<std::ptrdiff_t>(y) * wall_size_.width + shift, size_.width,
                  picture_.begin() + static_cast<std::ptrdiff_t>(y) * size_.width);
    boxes_.clear();
    for (const Walker& walker : walkers_) {
      const int w = static_cast<int>(walker.width), h = static_cast<int>(walker.height);
      const double room = size_.width - walker.width;
      double at = std::fmod(walker.x + walker.step * k + 20 * room, 2 * room);
      if (at > room) at = 2 * room - at;
      const int x0 = static_cast<int>(at), y0 = static_cast<int>(walker.y);
      for (int y = 0; y < h; ++y)
        std::copy_n(walker.coat.begin() + static_cast<std::ptrdiff_t>(y) * w, w,
                    picture_.begin() + static_cast<std::ptrdiff_t>(y0 + y) * size_.width + x0);
      boxes_.push_back(
          {static_cast<double>(x0), static_cast<double>(y0), static_cast<double>(w), static_cast<double>(h)});
    }
    return picture_;
  }
  const std::vector<Box>& boxes() const { return boxes_; }
  // Walkers without texture: inside their outlines nothing moves.
  void dress_evenly(float left, float right) {
    std::ranges::fill(walkers_[0].coat, left);
    std::ranges::fill(walkers_[1].coat, right);
  }

 private:
  struct Walker {
    double x = 0, y = 0, width = 0, height = 0, step = 0;
    std::uint32_t seed = 0;
    std::vector<float> coat{};
  };
  Size size_;
  double pan_;
  Size wall_size_;
  std::vector<float> wall_, picture_;
  Walker walkers_[2];
  std::vector<Box> boxes_;
};

// Frames of streets through one chain; what the regions are worth is counted on the way.
struct Walk {
  explicit Walk(Size size) : size(size), frame(size) {}
  void see(Street& street, int k, double exposure = 1) {
    Light light;
    light.exposure = exposure;
    expose(street.draw(k).data(), size.width, light, noise, frame.view());
    chain.step(source(frame.view()), kFrame);
    regions = static_cast<int>(chain.regions().size());
    wrong = 0;
    std::size_t found = 0;
    for (const Region& r : chain.regions()) {
      const bool right = std::ranges::any_of(
          street.boxes(), [&](const Box& truth) { return overlap_area(r.box, truth) > 0; });
      wrong += !right;
      if (!right && std::getenv("STEADY_VERBOSE"))
        std::printf("wrong in frame %d age %d still %d: %.0f,%.0f %.0fx%.0f\n", k, chain.motion().scene_age,
                    chain.motion().still, r.box.x, r.box.y, r.box.width, r.box.height);
    }
    for (const Box& truth : street.boxes())
      found += std::ranges::any_of(chain.regions(),
                                   [&](const Region& r) { return overlap_area(r.box, truth) > 0; });
    all_found = found == street.boxes().size();
  }
  Size size;
  Image<std::uint8_t> frame;
  Noise noise;
  Chain chain;
  int regions = 0, wrong = 0;
  bool all_found = false;
};

struct Entered {
  int complete = 0, wrong = 0;  // frames in which both walkers are seen; regions that overlap none
};

// The first 60 frames of a street that nothing has been seen of: `start` is its frame to begin with. No region before
// the third.
Entered enter(Walk& walk, Street& street, int start) {
  Entered result;
  for (int k = 0; k < 60; ++k) {
    walk.see(street, start + k);
    ck_assert_int_eq(walk.chain.motion().scene_age, k + 1);
    if (k < 2) ck_assert_msg(walk.regions == 0, "a region in frame %d of the scene", k + 1);
    result.wrong += walk.wrong;
    result.complete += walk.all_found;
  }
  if (std::getenv("STEADY_VERBOSE"))
    std::printf("60 frames: %d regions wrong, %d complete\n", result.wrong, result.complete);
  return result;
}

// Where a person stood in the first frame of a scene, the memory has the person's picture, and the strip he leaves
// looks like a thing that moves beside him. No region is that strip alone.
void enter_right(Walk& walk, Street& street, int start) {
  const Entered result = enter(walk, street, start);
  ck_assert_msg(result.complete >= 45, "both seen in only %d of 60 frames", result.complete);
  ck_assert_msg(result.wrong == 0, "%d regions wrong", result.wrong);
}

}  // namespace

START_TEST(noise_makes_no_region) {
  nothing(watch(1, [](int) { return Light{}; }));
}
END_TEST

START_TEST(flicker_of_the_whole_picture_makes_no_region) {
  nothing(watch(2, [](int k) {
    Light light;
    light.global = 0.05;
    light.phase = 0.35 * k;
    return light;
  }));
}
END_TEST

START_TEST(bands_of_flicker_make_no_region) {
  nothing(watch(3, [](int k) {
    Light light;
    light.bands = 0.05;
    light.phase = 0.21 * k;
    return light;
  }));
}
END_TEST

START_TEST(steps_of_exposure_make_no_region) {
  nothing(watch(4, [](int k) {
    static constexpr double kSteps[] = {1, 1.25, 0.9, 1.1, 0.7, 1.3, 1};
    Light light;
    light.exposure = kSteps[k / 75 % 7];
    return light;
  }));
}
END_TEST

START_TEST(all_of_it_together_makes_no_region) {
  // Parts of the wall become white and come back.
  for (const std::uint32_t seed : {5u, 6u, 7u})
    nothing(watch(seed, [](int k) {
      static constexpr double kSteps[] = {1, 0.8, 1.15, 0.9};
      Light light;
      light.exposure = kSteps[k / 125 % 4];
      light.global = 0.05;
      light.bands = 0.05;
      light.phase = 0.27 * k;
      return light;
    }));
}
END_TEST

// A wall with windows: too bright for the sensor but for the bars before them, and so is all of the lower third but for
// a narrow post.
std::vector<float> windows(std::uint32_t seed) {
  std::vector<float> scene = wall(kSize, seed);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const bool window = x % 160 >= 70 && y >= 30 && y < 140, floor = y >= 160;
      const bool bar = x % 40 < 3 || y % 37 < 3, post = x >= 200 && x < 216;
      float& v = scene[static_cast<std::size_t>(y) * kSize.width + x];
      if (window) v = bar ? 90 + v / 4 : 200 + v / 5;
      if (floor) v = post ? 60 + v / 3 : 195 + v / 4;
    }
  return scene;
}

// Bands that come back with every third frame, as 100 Hz before 30 frames a second.
START_TEST(bands_before_what_is_white_in_some_exposures_make_no_region) {
  for (const std::uint32_t seed : {72u, 73u})
    nothing(watch(windows(seed), [](int k) {
      static constexpr double kSteps[] = {1, 0.7, 1, 1.4, 1, 0.8};
      Light light;
      light.exposure = kSteps[(k + 50) / 100 % 6];
      light.bands = 0.05;
      light.period = 100;
      light.phase = 2 * std::numbers::pi / 3 / 1.7 * k;
      return light;
    }));
}
END_TEST

START_TEST(a_picture_that_was_all_white_makes_no_region) {
  const std::vector<float> scene(static_cast<std::size_t>(kSize.area()), 150);
  nothing(watch(scene, [](int k) {
    static constexpr double kSteps[] = {1, 2, 1, 0.5};
    Light light;
    light.exposure = kSteps[k / 125 % 4];
    return light;
  }));
}
END_TEST

START_TEST(what_moves_is_seen_through_steps_of_exposure) {
  Walk walk(kSize);
  Street street(11, kSize, 0);
  int complete = 0, wrong = 0;
  for (int k = 0; k < 240; ++k) {
    static constexpr double kSteps[] = {1, 1.25, 0.85, 1.1, 0.8, 1};
    walk.see(street, k, kSteps[k / 40]);
    if (k < 3) continue;
    if (k % 40 >= 3) {
      wrong += walk.wrong;
      complete += walk.all_found;
    }
  }
  if (std::getenv("STEADY_VERBOSE")) std::printf("steps: wrong %d, complete %d\n", wrong, complete);
  ck_assert_msg(complete >= 200, "both seen in only %d of 222 frames", complete);
  ck_assert_msg(wrong <= 30, "%d regions wrong", wrong);
}
END_TEST

START_TEST(after_a_cut_regions_begin_with_the_third_frame) {
  Walk walk(kSize);
  Street here(21, kSize, 0), there(22, kSize, 0);
  enter_right(walk, here, 0);
  enter_right(walk, there, 100);
  enter_right(walk, here, 300);
}
END_TEST

START_TEST(after_a_cut_to_a_camera_that_pans_regions_are_right) {
  Walk walk(kSize);
  // Not 2: against that the second walker stands still in the picture.
  Street here(31, kSize, 0), there(32, kSize, 4);
  enter_right(walk, here, 0);
  enter_right(walk, there, 0);
  enter_right(walk, here, 200);
}
END_TEST

// A figure brighter than the wall, and a camera that turns slower than it walks: the place where it stood when the
// scene began is soon far from it.
START_TEST(after_a_cut_to_a_turning_camera_the_place_that_was_left_is_no_region) {
  const std::vector<float> scene = wall({2 * kSize.width, kSize.height}, 61);
  for (const double pan : {2.0, 5.0, 8.0}) {
    Chain chain;
    Image<std::uint8_t> frame(kSize);
    Noise noise;
    int found = 0;
    for (int k = 0; k < 20; ++k) {
      const int shift = static_cast<int>(pan * k), left = 40 + 4 * k;
      std::vector<float> picture(static_cast<std::size_t>(kSize.area()));
      for (int y = 0; y < kSize.height; ++y)
        for (int x = 0; x < kSize.width; ++x)
          picture[static_cast<std::size_t>(y) * kSize.width + x] =
              x >= left && x < left + 28 && y >= 96 && y < 168
                  ? 200.0f + 2 * (y % 7)
                  : 0.5f * scene[static_cast<std::size_t>(y) * 2 * kSize.width + x + shift];
      expose(picture.data(), kSize.width, {}, noise, frame.view());
      chain.step(source(frame.view()), kFrame);
      const Box figure{static_cast<double>(left), 96, 28, 72};
      for (const Region& r : chain.regions()) {
        const bool right = overlap_area(r.box, figure) > 0;
        ck_assert_msg(right, "pan %.0f frame %d: %.0f,%.0f %.0fx%.0f", pan, k, r.box.x, r.box.y, r.box.width,
                      r.box.height);
        found += right;
      }
    }
    ck_assert_int_ge(found, 15);
  }
}
END_TEST

START_TEST(after_a_cut_to_people_in_even_coats_regions_are_right) {
  Walk walk(kSize);
  for (int scene = 0; scene < 4; ++scene) {
    Street street(51 + static_cast<std::uint32_t>(scene), kSize, 0);
    street.dress_evenly(60.0f + 10 * scene, 200.0f - 15 * scene);
    enter_right(walk, street, 70 * scene);
  }
}
END_TEST

START_TEST(after_a_seek_regions_begin_with_the_third_frame) {
  Walk walk(kSize);
  Street street(41, kSize, 0);
  enter_right(walk, street, 0);
  walk.chain.reset();
  enter_right(walk, street, 500);
  walk.chain.reset();
  enter_right(walk, street, 90);
}
END_TEST

// One pixel of a frame of this size counts up to 8.3 million in one class.
START_TEST(what_moves_is_seen_in_the_largest_frame_at_its_own_size) {
  constexpr Size kLargest{3840, 2160};
  Walk walk(kLargest);
  walk.chain.set_analysis_width(0);
  Street street(51, kLargest, 0);
  for (int k = 0; k < 8; ++k) {
    walk.see(street, k);
    ck_assert(walk.chain.analysis_size() == kLargest);
    if (k < 2) ck_assert_int_eq(walk.regions, 0);
    if (k >= 4) ck_assert_msg(walk.all_found, "one is not seen in frame %d", k);
  }
}
END_TEST

int main() {
  return run_suite(
      "steady",
      {noise_makes_no_region, flicker_of_the_whole_picture_makes_no_region, bands_of_flicker_make_no_region,
       steps_of_exposure_make_no_region, all_of_it_together_makes_no_region,
       bands_before_what_is_white_in_some_exposures_make_no_region,
       a_picture_that_was_all_white_makes_no_region, what_moves_is_seen_through_steps_of_exposure,
       after_a_cut_regions_begin_with_the_third_frame, after_a_cut_to_a_camera_that_pans_regions_are_right,
       after_a_cut_to_a_turning_camera_the_place_that_was_left_is_no_region,
       after_a_cut_to_people_in_even_coats_regions_are_right, after_a_seek_regions_begin_with_the_third_frame,
       what_moves_is_seen_in_the_largest_frame_at_its_own_size},
      120);
}
