// SPDX-License-Identifier: LGPL-2.1-or-later
// Where things are in pictures of a simulated house, against geometry worked out by hand. The focal length of 60 degrees
// over 320 pixels is 160 / tan 30 degrees = 277.1 pixels.
#include "sim/house/house_camera.h"

#include <check.h>

#include <cmath>
#include <numeric>
#include <string>

#include "support/suite.h"

using namespace cerberus::sim;
using cerberus::sensing::radians;

namespace {

const double kFocal = 160 / std::tan(radians(30));

FloorPlan plan_of(const std::string& text) {
  auto result = read_floor_plan(text);
  if (const auto* wrong = std::get_if<std::string>(&result)) ck_abort_msg("%s", wrong->c_str());
  return std::get<FloorPlan>(std::move(result));
}

// Sees the room from the middle of its left side, along x.
LevelPicture level(const FloorPlan& plan, double y = 5) {
  LevelPicture picture(1);
  picture.resize({320, 240, kFocal, 160, 120});
  picture.draw_rooms(plan, Light(plan), {.5, y, .8, 0});
  return picture;
}

// The columns in that row that are at a depth.
std::pair<int, int> columns_at(const LevelPicture& picture, int row, double depth) {
  int first = -1, last = -1;
  for (int column = 0; column < 320; ++column)
    if (std::abs(picture.depth(column)[row] - depth) < 1e-4) {
      if (first < 0) first = column;
      last = column;
    }
  return {first, last};
}

struct Taken {
  std::vector<std::uint8_t> i420;
  std::vector<PersonTruth> truth;
};

// One person who stands and looks at the camera.
Taken take(HouseCamera& camera, const Pose& begin, const Pose& end, double x, double y,
           double height = 1.75) {
  Stance stance;
  stance.x = x, stance.y = y, stance.heading = radians(180);
  const Clothes clothes;
  const HouseCamera::Subject person{&stance, &clothes, height};
  const int parts = camera.parts(begin, end);
  for (int i = 0; i < parts; ++i) {
    Pose pose = begin;
    pose.yaw += (end.yaw - begin.yaw) * i / parts;
    camera.expose(pose, {&person, 1});
  }
  Taken taken;
  camera.develop(taken.i420);
  taken.truth = camera.truth();
  return taken;
}

const char* const kHall = "room hall 0 0 10 10\nlamp 5 5\n";
const Pose kPose{.5, 5};

}  // namespace

START_TEST(a_box_covers_the_columns_and_rows_of_its_corners) {
  // Its front is 4 m away, 1 m wide and 1 m high.
  const LevelPicture picture = level(plan_of("room hall 0 0 10 10\nbox 4.5 4.5 1 1 1\n"));
  const auto [first, last] = columns_at(picture, 130, 4);
  ck_assert_double_eq_tol(first, 160 - .5 * kFocal / 4, 1);
  ck_assert_double_eq_tol(last + 1, 160 + .5 * kFocal / 4, 1);
  const float* depth = picture.depth(160);
  // Rows 106.1 to 175.4; then the floor before it.
  ck_assert_float_eq_tol(depth[107], 4, 1e-4);
  ck_assert_float_eq_tol(depth[174], 4, 1e-4);
  ck_assert_float_eq_tol(depth[105], 9.5, 1e-4);
  ck_assert_float_lt(depth[176], 4);
  // The floor before it, half a metre nearer.
  ck_assert_float_eq_tol(depth[int(120 + .8 * kFocal / 3.5)], 3.5, .05);
}
END_TEST

START_TEST(a_low_box_shows_its_top) {
  const LevelPicture picture = level(plan_of("room hall 0 0 10 10\nbox 2.5 4.5 2 1 .4\n"));
  // .4 m below the eye, 3 m away.
  ck_assert_float_eq_tol(picture.depth(160)[int(120 + .4 * kFocal / 3)], 3, .05);
}
END_TEST

START_TEST(a_doorway_shows_the_next_room_below_its_lintel) {
  const LevelPicture picture =
      level(plan_of("room a 0 0 4.5 10\nroom b 4.7 0 5 10\ndoorway a b at=5 width=1 height=2\n"));
  ck_assert_float_eq_tol(picture.depth(160)[119], 9.2, 1e-4);
  ck_assert_float_eq_tol(picture.depth(160)[int(120 - 1.2 * kFocal / 4) - 2], 4, 1e-4);
  const auto [first, last] = columns_at(picture, 119, 9.2);
  // Its far edges are 4.2 m away, its near ones 4 m.
  ck_assert_double_eq_tol(first, 160 - .5 * kFocal / 4.2, 1);
  ck_assert_double_eq_tol(last + 1, 160 + .5 * kFocal / 4.2, 1);
}
END_TEST

START_TEST(a_pillar_is_round) {
  const LevelPicture picture = level(plan_of("room hall 0 0 10 10\npillar 4.5 5 .5\n"));
  ck_assert_float_eq_tol(picture.depth(160)[119], 3.5, .01);
  // The tangent's angle from the eye: asin(.5 / 4).
  const int edge = int(160 + kFocal * std::tan(std::asin(.5 / 4)));
  ck_assert_float_lt(picture.depth(edge - 1)[119], 4);
  ck_assert_float_eq_tol(picture.depth(edge + 1)[119], 9.5, 1e-4);
}
END_TEST

START_TEST(what_is_near_moves_faster) {
  const FloorPlan plan = plan_of("room hall 0 0 10 10\nbox 2.5 4 .5 .5 2\nbox 4.5 5.5 .5 .5 2\n");
  const LevelPicture before = level(plan), after = level(plan, 5.1);
  const int near = columns_at(before, 119, 2).second - columns_at(after, 119, 2).second;
  const int far = columns_at(before, 119, 4).first - columns_at(after, 119, 4).first;
  ck_assert_double_eq_tol(near, .1 * kFocal / 2, 1);
  ck_assert_double_eq_tol(far, .1 * kFocal / 4, 1);
}
END_TEST

// A step of 1 cm moves the floor 4 m away by .14 rows and that 8 m away by .03, about .08 in the mean: by that share of the
// difference between neighbouring rows it changes, and by twice as much where boards are finer than rows and flicker.
START_TEST(boards_across_the_view_do_not_flicker) {
  const FloorPlan plan = plan_of("room hall 0 0 10 10 floor=wood\nlamp 5 5\n");
  LevelPicture picture(1);
  picture.resize({320, 240, kFocal, 160, 120});
  std::vector<std::uint8_t> before;
  double changed = 0, differs = 0;
  constexpr int kFirst = 148, kLast = 176;  // 8 m and 4 m away
  for (int step = 0; step < 20; ++step) {
    picture.draw_rooms(plan, Light(plan), {.5 + .01 * step, 5, .8, 0});
    std::vector<std::uint8_t> now;
    for (int column = 120; column < 200; ++column)
      now.insert(now.end(), picture.luma(column) + kFirst, picture.luma(column) + kLast);
    for (std::size_t i = 0; i < now.size() && !before.empty(); ++i) {
      changed += std::abs(now[i] - before[i]);
      if ((i + 1) % (kLast - kFirst) != 0) differs += std::abs(now[i] - now[i + 1]);
    }
    before = now;
  }
  ck_assert_msg(changed < .13 * differs, "%.0f of %.0f", changed, differs);
}
END_TEST

START_TEST(a_person_is_as_large_as_its_distance_makes_it) {
  HouseCamera camera(plan_of(kHall), {}, 1);
  const PersonTruth person = take(camera, kPose, kPose, 4.5, 5).truth.at(0);
  ck_assert_double_eq_tol(person.height, 1.75 * kFocal / 4, 4);
  ck_assert_double_eq_tol(person.width, .48 * kFocal / 4, 3);
  ck_assert_double_eq_tol(person.top + person.height, 120 + .8 * kFocal / 4, 3);
  ck_assert_double_eq_tol(person.left + person.width / 2, 160, 2);
  ck_assert_double_eq_tol(person.distance, 4, 1e-9);
  ck_assert_double_eq_tol(person.bearing, 0, 1e-9);
  ck_assert_double_eq_tol(person.visible, 1, .02);
}
END_TEST

START_TEST(the_box_follows_a_camera_that_pitches_and_rolls) {
  HouseCamera camera(plan_of(kHall), {}, 1);
  Pose up = kPose;
  up.pitch = radians(10);
  // The feet are atan(.8 / 4) below the horizon.
  const PersonTruth person = take(camera, up, up, 4.5, 5).truth.at(0);
  ck_assert_double_eq_tol(person.top + person.height, 120 + kFocal * std::tan(std::atan(.8 / 4) + up.pitch),
                          4);
  Pose tilted = kPose;
  tilted.roll = radians(90);
  // The head's side of the horizon is to the left of a camera that was tilted clockwise.
  const PersonTruth lying = take(camera, tilted, tilted, 4.5, 5).truth.at(0);
  ck_assert_double_eq_tol(lying.left + lying.width, 160 + .8 * kFocal / 4, 4);
  ck_assert_double_eq_tol(lying.left, 160 - .95 * kFocal / 4, 4);
}
END_TEST

START_TEST(who_stands_behind_something_is_seen_in_part) {
  const auto seen = [](const std::string& things, const Pose& pose) {
    HouseCamera camera(plan_of(kHall + things), {}, 1);
    return take(camera, pose, pose, 4.5, 5).truth.at(0).visible;
  };
  ck_assert_double_eq_tol(seen("box 3 5 .5 2 2.5\n", kPose), .5, .05);
  ck_assert_double_eq_tol(seen("box 3 4 .5 2 2.5\n", kPose), 0, 1e-9);
  ck_assert_double_eq_tol(seen("pillar 3 5 .4\n", kPose), 0, 1e-9);
  // Behind the person
  ck_assert_double_eq_tol(seen("box 6 4 .5 2 2.5\n", kPose), 1, .02);
  // Up to 1.2 m at its distance: the trunk's upper part, the head and the shoulders
  const double above = seen("box 2.5 4 .5 2 1\n", kPose);
  ck_assert_double_gt(above, .25);
  ck_assert_double_lt(above, .5);
  // The picture ends in its middle
  Pose turned = kPose;
  turned.yaw = radians(30);
  ck_assert_double_eq_tol(seen("", turned), .5, .06);
}
END_TEST

START_TEST(equal_seeds_give_equal_bytes) {
  HouseCamera one(plan_of(kHall), {}, 7), same(plan_of(kHall), {}, 7), other(plan_of(kHall), {}, 8);
  for (int i = 0; i < 3; ++i) {
    const Pose pose{.5 + .1 * i, 5, .8, .2 * i};
    const auto first = take(one, pose, pose, 4.5, 5).i420;
    ck_assert_uint_eq(first.size(), 320 * 240 * 3 / 2);
    ck_assert(first == take(same, pose, pose, 4.5, 5).i420);
    ck_assert(first != take(other, pose, pose, 4.5, 5).i420);
  }
}
END_TEST

START_TEST(a_still_picture_changes_by_its_noise_alone) {
  HouseCamera camera(plan_of(kHall), {}, 7);
  const auto a = take(camera, kPose, kPose, 4.5, 5).i420, b = take(camera, kPose, kPose, 4.5, 5).i420;
  double square = 0;
  for (int i = 0; i < 320 * 240; ++i) square += std::pow(double(a[i]) - b[i], 2);
  // Two pictures' noise of 2 levels, and the rounding of both.
  ck_assert_double_eq_tol(std::sqrt(square / (320 * 240)), std::sqrt(2 * (4 + 1 / 12.)), .1);
}
END_TEST

// By the light of the pixels across an edge: its side is at column 160, its foot at row 120 + .8 kFocal / 2.5 = 208.7. A quarter
// of a pixel of turning or nodding moves them by that much.
START_TEST(edges_move_by_parts_of_a_pixel) {
  Lens lens;
  lens.noise = 0;
  HouseCamera camera(
      plan_of("room hall 0 0 10 10 wall=panels floor=panels\nbox 3 5 .5 1 2.5 side=wood\nlamp 5 5\n"), lens,
      1);
  for (const bool foot : {false, true}) {
    const auto light = [&](double pixels) {
      Pose pose = kPose;
      (foot ? pose.pitch : pose.yaw) += pixels / kFocal;
      const auto picture = take(camera, pose, pose, 9, 1).i420;
      double sum = 0;
      for (int i = -8; i < 8; ++i)
        sum += foot ? picture[(209 + i) * 320 + 200] : picture[120 * 320 + 160 + i];
      return sum;
    };
    const double none = light(0), pixel = light(1) - none;
    ck_assert_double_gt(std::abs(pixel), 8);
    for (const double part : {.25, .5, .75}) ck_assert_double_eq_tol((light(part) - none) / pixel, part, .2);
  }
}
END_TEST

START_TEST(turning_blurs_upright_edges) {
  Lens lens;
  lens.noise = 0;
  HouseCamera camera(plan_of(std::string(kHall) + "box 3 5 .5 1 2.5 side=metal\n"), lens, 1);
  const auto steepest = [&](double turn) {
    Pose end = kPose;
    end.yaw += turn;
    const auto picture = take(camera, kPose, end, 9, 1).i420;
    int most = 0;
    for (int column = 100; column < 220; ++column)
      most = std::max(most, std::abs(picture[120 * 320 + column] - picture[120 * 320 + column + 1]));
    return most;
  };
  // 45 degrees a second for 20 ms: 4.4 pixels.
  ck_assert_int_lt(steepest(radians(.9)), steepest(0) * .6);
}
END_TEST

START_TEST(an_exposure_has_a_part_for_each_pixel_and_a_half_of_turning) {
  const HouseCamera camera(plan_of(kHall), {}, 1);
  const auto parts = [&](double pixels) {
    Pose end = kPose;
    end.yaw += pixels / kFocal;
    return camera.parts(kPose, end);
  };
  ck_assert_int_eq(parts(0), 4);
  ck_assert_int_eq(parts(-5.9), 4);
  ck_assert_int_eq(parts(6.1), 5);
  ck_assert_int_eq(parts(40), 6);
}
END_TEST

// The upper rows look beyond the zenith: at the ceiling, whatever the walls are.
START_TEST(a_camera_that_looks_past_the_zenith_sees_the_ceiling_there) {
  const auto upper = [](const std::string& wall) {
    Lens lens;
    lens.field_of_view = cerberus::sensing::radians(110), lens.noise = 0;
    HouseCamera camera(plan_of("room hall 0 0 10 10 wall=" + wall + "\nlamp 5 5\n"), lens, 1);
    const Pose up{5, 5, .8, 0, cerberus::sensing::radians(60)};
    camera.expose(up, {});
    std::vector<std::uint8_t> picture;
    camera.develop(picture);
    picture.resize(10 * 320);
    return picture;
  };
  ck_assert(upper("brick") == upper("books"));
}
END_TEST

START_TEST(a_lamp_that_is_switched_off_leaves_the_room_darker) {
  HouseCamera camera(plan_of(kHall), {}, 1);
  const auto mean = [&] {
    const auto picture = take(camera, kPose, kPose, 4.5, 5).i420;
    return std::accumulate(picture.begin(), picture.begin() + 320 * 240, 0.) / (320 * 240);
  };
  const double on = mean();
  camera.switch_lamp(0, false);
  ck_assert_double_lt(mean(), .9 * on);
  camera.switch_lamp(0, true);
  ck_assert_double_eq_tol(mean(), on, .5);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "house_camera",
      {a_box_covers_the_columns_and_rows_of_its_corners, a_low_box_shows_its_top,
       a_doorway_shows_the_next_room_below_its_lintel, a_pillar_is_round, what_is_near_moves_faster,
       boards_across_the_view_do_not_flicker, a_person_is_as_large_as_its_distance_makes_it,
       the_box_follows_a_camera_that_pitches_and_rolls, who_stands_behind_something_is_seen_in_part,
       equal_seeds_give_equal_bytes, a_still_picture_changes_by_its_noise_alone, turning_blurs_upright_edges,
       edges_move_by_parts_of_a_pixel, an_exposure_has_a_part_for_each_pixel_and_a_half_of_turning,
       a_camera_that_looks_past_the_zenith_sees_the_ceiling_there,
       a_lamp_that_is_switched_off_leaves_the_room_darker});
}
