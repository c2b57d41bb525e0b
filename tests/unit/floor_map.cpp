// SPDX-License-Identifier: LGPL-2.1-or-later
// Two rooms of 6 x 4 m beside each other, with a doorway of 1 m in the middle of the wall between them. In a corner of a
// picture of 650 x 650 pixels: 13 x 4.8 m with the margin, 15 pixels a metre.
#include "overlay/floor_map.h"

#include <check.h>

#include <numbers>
#include <vector>

#include "support/suite.h"

using namespace cerberus;
using overlay::FloorMap;
using overlay::FloorPlan;
using overlay::FloorScene;

namespace {

constexpr int kWidth = 195, kHeight = 72, kStride = kWidth + 5;
constexpr std::uint32_t kBeyond = 0x01020304u;

FloorPlan plan() {
  return {{{0, 0, 6, 4}, {6.2, 0, 12.2, 4}, {6, 1.5, 6.2, 2.5}}, {{4, .2, 5, 1.2}}, {{2, 3.4, .3}}, {}};
}

struct Drawn {
  FloorMap map{plan(), {650, 650}};
  std::vector<std::uint32_t> words = std::vector<std::uint32_t>(kStride * kHeight, kBeyond);
  void draw(const FloorScene& scene) { map.draw(scene, {words.data(), kWidth, kHeight, kStride}); }
  struct Pixel {
    int a, r, g, b;
  };
  Pixel at(double x, double y) const {
    const std::uint32_t word = words[std::size_t(int((y + .4) * 15) * kStride + int((x + .4) * 15))];
    return {int(word >> 24), int(word >> 16 & 255), int(word >> 8 & 255), int(word & 255)};
  }
  bool is_bright(double x, double y) const { return at(x, y).b > 180; }
  bool is_dark(double x, double y) const { return at(x, y).r < 60 && at(x, y).b < 60; }
  bool is_seen(double x, double y) const { return at(x, y).r > 180 && at(x, y).b < at(x, y).r - 80; }
};

// In the left room, looking to the right.
FloorScene standing() {
  FloorScene scene;
  scene.x = 1, scene.y = 2;
  scene.field_of_view = std::numbers::pi / 3;
  return scene;
}

}  // namespace

START_TEST(it_is_as_large_as_any_inset_or_is_none) {
  ck_assert(FloorMap(plan(), {650, 650}).size() == vision::Size(kWidth, kHeight));
  ck_assert_int_eq(FloorMap(plan(), {60, 60}).size().area(), 0);
}
END_TEST

START_TEST(rooms_and_doorways_are_bright_walls_dark_and_things_between) {
  Drawn drawn;
  drawn.draw(standing());
  ck_assert(drawn.is_bright(.3, .3) && drawn.is_bright(11, 3.7));
  ck_assert(drawn.is_dark(6.1, .5) && drawn.is_dark(6.1, 3.5) && drawn.is_dark(-.2, 2) &&
            drawn.is_dark(5, 4.2));
  ck_assert(!drawn.is_dark(6.1, 2));
  for (const auto& [x, y] : {std::pair(4.5, .7), std::pair(2., 3.4)})
    ck_assert(!drawn.is_bright(x, y) && !drawn.is_dark(x, y));
  for (std::size_t i = 0; i < drawn.words.size(); ++i)
    ck_assert_uint_eq(drawn.words[i] >> 24, i % kStride < kWidth ? 0xffu : 0x01u);
}
END_TEST

START_TEST(what_the_camera_sees_ends_at_walls_and_goes_on_through_doorways) {
  Drawn drawn;
  drawn.draw(standing());
  ck_assert(drawn.is_seen(4, 2.5) && drawn.is_seen(5.8, 3.5) && drawn.is_seen(4, 2));
  ck_assert(!drawn.is_seen(4, 3.9) && !drawn.is_seen(.3, 2));  // 32 degrees aside, and behind
  ck_assert(drawn.is_seen(8, 2.2) && !drawn.is_seen(8, 3.2));  // at the wall: 2.1 and 2.9 m, of 1.5 to 2.5
  FloorScene left = standing();
  left.view = -std::numbers::pi / 2;
  drawn.draw(left);
  ck_assert(drawn.is_seen(1, .5) && !drawn.is_seen(4, 2.5));
}
END_TEST

START_TEST(a_pillar_hides_what_is_behind_it) {
  Drawn drawn;
  FloorScene scene = standing();
  scene.x = 2, scene.y = 2, scene.view = std::numbers::pi / 2;
  drawn.draw(scene);
  ck_assert(drawn.is_seen(2, 2.9) && !drawn.is_seen(2, 3.85) && drawn.is_seen(2.7, 3.85));
}
END_TEST

START_TEST(the_camera_sees_over_low_furniture_and_not_over_high) {
  FloorPlan with_cupboard = plan();
  with_cupboard.furniture.push_back({3, 1.5, 3.4, 2.5});
  FloorScene scene = standing();
  Drawn low{FloorMap(with_cupboard, {650, 650})};
  low.draw(scene);
  ck_assert(low.is_seen(5, 2));
  with_cupboard.high = {with_cupboard.furniture.back()};
  Drawn high{FloorMap(with_cupboard, {650, 650})};
  high.draw(scene);
  ck_assert(high.is_seen(2.5, 2) && !high.is_seen(5, 2));
}
END_TEST

START_TEST(people_are_red_where_the_camera_sees_them_and_grey_elsewhere) {
  Drawn drawn;
  const FloorScene::Person people[] = {{4, 2, true}, {10, 3.5, false}};
  FloorScene scene = standing();
  scene.people = people;
  drawn.draw(scene);
  ck_assert(drawn.at(4, 2).r > 180 && drawn.at(4, 2).g < 60 && drawn.at(4, 2).b < 60);
  ck_assert(std::abs(drawn.at(10, 3.5).r - drawn.at(10, 3.5).b) < 10 && drawn.at(10, 3.5).r < 150);
}
END_TEST

START_TEST(the_robot_points_where_it_drives_and_leaves_its_way) {
  Drawn drawn;
  const auto is_blue = [&](double x, double y) { return drawn.at(x, y).b > drawn.at(x, y).r + 60; };
  FloorScene scene = standing();
  scene.field_of_view = .01;
  for (int i = 0; i <= 20; ++i) {
    scene.x = 1 + .1 * i, scene.y = 1;
    drawn.draw(scene);
  }
  ck_assert(is_blue(3, 1) && is_blue(3.3, 1) && !is_blue(2.7, 1.4) && is_blue(1.5, 1) && is_blue(2, 1));
  ck_assert(!is_blue(1.5, 1.4) && !is_blue(4, 1));
  scene.heading = std::numbers::pi / 2;
  drawn.draw(scene);
  ck_assert(is_blue(3, 1.3) && !is_blue(3.35, 1));
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "floor map",
      {it_is_as_large_as_any_inset_or_is_none, rooms_and_doorways_are_bright_walls_dark_and_things_between,
       what_the_camera_sees_ends_at_walls_and_goes_on_through_doorways, a_pillar_hides_what_is_behind_it,
       the_camera_sees_over_low_furniture_and_not_over_high,
       people_are_red_where_the_camera_sees_them_and_grey_elsewhere,
       the_robot_points_where_it_drives_and_leaves_its_way});
}
