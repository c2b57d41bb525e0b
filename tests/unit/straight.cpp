// SPDX-License-Identifier: LGPL-2.1-or-later
// A person who walks straight up or down the picture, or towards the camera: only the fronts are seen to move, head,
// waist and feet, and his middle may stay where it is.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "support/motions.h"
#include "support/room.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

struct Clothes {
  float head, coat, trousers;
};

// In shares of his width and height; nothing: he is not there.
std::optional<float> person(const Clothes& clothes, double u, double v) {
  if (v < 0.15) {
    const double across = (u - 0.5) / 0.19, down = (v - 0.075) / 0.075;
    return across * across + down * down < 1 ? std::optional(clothes.head) : std::nullopt;
  }
  if (v < 0.55)
    return std::abs(u - 0.5) < std::min(0.42, 0.3 + 2 * (v - 0.15)) ? std::optional(clothes.coat)
                                                                    : std::nullopt;
  return std::abs(std::abs(u - 0.5) - 0.2) < 0.18 ? std::optional(clothes.trousers) : std::nullopt;
}

// How bright it is at a pixel: he stands at `him` in the room.
float brightness(const Clothes& clothes, const Box& him, int x, int y) {
  constexpr int kSub = 4;  // samples of a pixel, each way
  const float behind = room(x, y);
  if (x + 1 < him.x || x > him.right() || y + 1 < him.y || y > him.bottom()) return behind;
  float sum = 0;
  for (int k = 0; k < kSub * kSub; ++k) {
    const double u = (x + (k % kSub + 0.5) / kSub - him.x) / him.width;
    const double v = (y + (k / kSub + 0.5) / kSub - him.y) / him.height;
    sum += u >= 0 && u < 1 && v >= 0 && v < 1 ? person(clothes, u, v).value_or(behind) : behind;
  }
  return sum / (kSub * kSub);
}

enum class Way { down, up, towards };

// Where he is `walked` pixels after he set out. Towards: seen from hip height, where his middle stays.
Box place(Way way, double walked) {
  if (way == Way::down) return {145, 20 + walked, 30, 90};
  if (way == Way::up) return {145, 125 - walked, 30, 90};
  const double height = 60 + 2 * walked;
  return {160 - height / 6, 105 - height / 2, height / 3, height};
}

struct Shares {
  double regions, tracks;  // of the frames with one that is he
  int wrong;               // regions and tracks that are not on him
};

// He is there from the first frame on, and sets out with it.
Shares watch(Way way, double speed, const Clothes& clothes) {
  constexpr int kFrames = 110;
  RoomCamera camera;
  int regions = 0, tracks = 0, wrong = 0;
  for (int k = 0; k < kFrames; ++k) {
    const Box him = place(way, speed * k);
    const Chain& chain = camera.see([&](int x, int y) { return brightness(clothes, him, x, y); });
    const auto is_he = [&](const auto& found) { return intersection_over_union(found.box, him) >= 0.3; };
    const auto is_elsewhere = [&](const auto& found) { return overlap_area(found.box, him) <= 0; };
    regions += std::ranges::any_of(chain.regions(), is_he);
    tracks += std::ranges::any_of(chain.tracks(), is_he);
    wrong += static_cast<int>(std::ranges::count_if(chain.regions(), is_elsewhere) +
                              std::ranges::count_if(chain.tracks(), is_elsewhere));
  }
  return {static_cast<double>(regions) / kFrames, static_cast<double>(tracks) / kFrames, wrong};
}

constexpr double kStep = 0.1;  // s between frames with regions

Region piece(double x, double y, double width, double height, double confidence = 0.3) {
  return {{x, y, width, height},
          0.7 * width * height,
          confidence,
          1,
          confidence < 0.5 ? RegionKind::part : RegionKind::person_like};
}

std::vector<Track> update(Tracker& tracker, const std::vector<Region>& regions,
                          const Transform& motion = {}) {
  const auto tracks = tracker.update(regions, motion, kStep, RoomCamera::kSize);
  return {tracks.begin(), tracks.end()};
}

}  // namespace

START_TEST(a_person_walking_straight_down_up_or_near_is_found_within_a_second) {
  struct Case {
    const char* name;
    Way way;
    double speed;                    // of his feet, pixels a frame
    double regions = 0, tracks = 0;  // at least
  };
  constexpr Clothes kBlack{50, 40, 60}, kWhite{70, 215, 45};
  for (const Case& c : {Case{"down", Way::down, 0.5, 0.75, 0.65},
                        {"up", Way::up, 0.5, 0.75, 0.65},
                        {"near", Way::towards, 0.5, 0.6, 0.5},
                        {"nearer", Way::towards, 1, 0.8, 0.7}})
    for (const Clothes& clothes : {kBlack, kWhite}) {
      const Shares found = watch(c.way, c.speed, clothes);
      ck_assert_msg(found.regions >= c.regions && found.tracks >= c.tracks && found.wrong == 0,
                    "%s at %.1f, coat %.0f: regions %.2f, tracks %.2f, %d wrong", c.name, c.speed,
                    clothes.coat, found.regions, found.tracks, found.wrong);
    }
}
END_TEST

START_TEST(moving_edges_that_become_one_region_are_one_track) {
  Tracker tracker;
  std::vector<Track> tracks;
  // Head, waist and feet go down and grow, as what they have left is seen of them.
  for (int k = 0; k < 12; ++k)
    tracks =
        update(tracker, {piece(149, 28, 22, 8 + k), piece(149, 54, 22, 8 + k), piece(149, 80, 22, 8 + k)});
  for (int k = 0; k < 5; ++k) tracks = update(tracker, {piece(149, 28 + k, 22, 72)});
  ck_assert_uint_eq(tracks.size(), 1);
  ck_assert_double_gt(intersection_over_union(tracks[0].box, {149, 32, 22, 72}), 0.8);
}
END_TEST

START_TEST(two_upright_people_in_one_region_stay_two) {
  Tracker tracker;
  std::vector<Track> tracks;
  // They come from both sides, and one stands higher up in the picture, aslant behind the other.
  for (int k = 0; k <= 10; ++k)
    tracks = update(tracker, {piece(90 + 5 * k, 60, 16, 40, 0.9), piece(210 - 5 * k, 100, 20, 50, 0.9)});
  ck_assert_uint_eq(tracks.size(), 2);
  for (int k = 0; k < 8; ++k) tracks = update(tracker, {piece(140, 60, 40, 90)});
  ck_assert_uint_eq(tracks.size(), 2);
}
END_TEST

START_TEST(an_approaching_person_is_published_though_the_centre_stays) {
  Tracker tracker;
  std::vector<Track> tracks;
  for (int k = 0; k < 20 && tracks.empty(); ++k) {
    const double height = 60 + 3.0 * k;
    tracks = update(tracker, {piece(160 - height / 6, 120 - height / 2, height / 3, height)});
  }
  ck_assert_uint_eq(tracks.size(), 1);
  ck_assert_double_ge(tracks[0].box.height, 1.3 * 60);
  ck_assert_double_lt(tracks[0].box.height, 1.7 * 60);
}
END_TEST

START_TEST(a_person_leaving_a_place_of_the_background_is_published_though_the_place_is_foreground) {
  constexpr double kPace = 3, kHeight = 97;  // pixels a step of 0.1 s: half a body a second
  for (const bool down : {true, false}) {
    Tracker tracker;
    std::vector<Track> tracks =
        update(tracker, {piece(146, down ? 33 : 18, 27, 82)});  // without head, or feet
    double gone = 0;
    for (; tracks.empty() && gone < kHeight; gone += kPace)
      tracks = update(tracker, {piece(146, down ? 18 : 18 - gone, 28, kHeight + gone)});
    ck_assert_msg(gone > 0.1 * kHeight && gone < 0.2 * kHeight, "%s: after %.0f pixels", down ? "down" : "up",
                  gone);
  }
}
END_TEST

START_TEST(the_same_holds_at_any_picture_size_before_a_trembling_camera) {
  constexpr double kPace = 3, kHeight = 97;
  for (const double scale : {1.0, 6.0}) {  // pixels a pixel of the picture that was analysed
    const Size size{static_cast<int>(320 * scale), static_cast<int>(240 * scale)};
    Tracker tracker;
    double gone = 0;
    for (int k = 0; gone < kHeight; gone += kPace, ++k) {
      Region region = piece(146 * scale, 18 * scale, 28 * scale, (kHeight + gone) * scale);
      if (!tracker
               .update({&region, 1}, Transform::translation(k % 2 ? 0.3 * scale : -0.3 * scale, 0), kStep,
                       size)
               .empty())
        break;
    }
    ck_assert_msg(gone > 0.1 * kHeight && gone < 0.25 * kHeight, "%.0f: after %.0f pixels", scale, gone);
  }
}
END_TEST

START_TEST(an_object_that_shows_more_and_less_of_itself_has_not_travelled) {
  Tracker leaps, lies, stands, turns;
  for (int k = 0; k < 16; ++k)
    ck_assert_uint_eq(update(leaps, {piece(146, 40, 28, k % 4 < 2 ? 90 : 107)}).size(), 0);
  for (int k = 0; k < 14; ++k) ck_assert_uint_eq(update(lies, {piece(100, 100, 80, 40 + k)}).size(), 0);
  for (int k = 0; k < 50; ++k)  // and the camera sinks into its mount
    ck_assert_uint_eq(
        update(stands, {piece(146, 40 + 0.4 * k, 28, 90)}, Transform::translation(0, 0.4)).size(), 0);
  for (int k = 0; k < 10; ++k)  // and the camera turns
    ck_assert_uint_eq(
        update(turns, {piece(146 + 2 * k, 40, 28, 90 + 2 * k)}, Transform::translation(2, 0)).size(), 0);
}
END_TEST

START_TEST(growth_along_one_axis_or_by_zoom_is_no_approach) {
  Tracker grows, zoomed;
  constexpr double kZoom = 1.04;
  for (int k = 0; k < 20; ++k) {
    const double height = 60 + 3.0 * k, scale = std::pow(kZoom, k);
    ck_assert_uint_eq(update(grows, {piece(150, 120 - height / 2, 20 + 0.1 * k, height)}).size(), 0);
    const Transform zoom =
        Transform::translation(160, 120) * similarity(kZoom, 0, 0, 0) * Transform::translation(-160, -120);
    ck_assert_uint_eq(
        update(zoomed, {piece(160 - 10 * scale, 120 - 30 * scale, 20 * scale, 60 * scale)}, zoom).size(), 0);
  }
}
END_TEST

int main() {
  return run_suite(
      "straight",
      {a_person_walking_straight_down_up_or_near_is_found_within_a_second,
       moving_edges_that_become_one_region_are_one_track, two_upright_people_in_one_region_stay_two,
       an_approaching_person_is_published_though_the_centre_stays,
       a_person_leaving_a_place_of_the_background_is_published_though_the_place_is_foreground,
       the_same_holds_at_any_picture_size_before_a_trembling_camera,
       an_object_that_shows_more_and_less_of_itself_has_not_travelled,
       growth_along_one_axis_or_by_zoom_is_no_approach},
      60);
}
