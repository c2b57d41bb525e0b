// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/painter.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::overlay;

namespace {

Object person(std::uint32_t id, double x, double y, ObjectState state = ObjectState::seen) {
  Object object;
  object.id = id;
  object.x = x, object.y = y, object.width = 60, object.height = 140;
  object.speed = 40 + x;
  object.distance = NAN;
  object.state = state;
  return object;
}

struct Stage {
  Painter painter;
  std::vector<Object> objects;
  Scene scene;
  Stage() {
    scene.frame = {1280, 720};
    scene.system.decision = true;
    scene.system.rule = "rule 1";
    scene.system.action = "track";
    scene.system.lights = {{1, 1}, {2, 0}};
  }
  std::vector<Patch> paint() {
    scene.objects = objects;
    std::vector<Patch> patches;
    painter.paint(scene, patches);
    return patches;
  }
};

std::size_t same(const std::vector<Patch>& a, const std::vector<Patch>& b) {
  return static_cast<std::size_t>(std::ranges::count_if(a, [&](const Patch& p) {
    return std::ranges::any_of(b, [&](const Patch& q) { return p.pixels == q.pixels && p.area == q.area; });
  }));
}

}  // namespace

START_TEST(what_stays_as_it_is_keeps_its_pictures) {
  Stage stage;
  stage.objects = {person(1, 100, 300), person(2, 400, 300, ObjectState::stopped)};
  const auto before = stage.paint();
  ck_assert_uint_eq(before.size(), 4 + 4 + 2 + 1);  // boxes, labels, panel
  ck_assert_uint_eq(same(before, stage.paint()), before.size());
  stage.objects[0].x += 0.5;
  stage.objects[0].speed += 7;
  ck_assert_uint_eq(same(before, stage.paint()), 4 + 1 + 1);  // the other's box and label, and the panel
  stage.scene.system.action = "hold";
  ck_assert_uint_eq(same(before, stage.paint()), 4 + 1);
}
END_TEST

// A patch that is still held downstream is not drawn over.
START_TEST(a_picture_that_is_held_is_not_used_again) {
  Stage stage;
  stage.objects = {person(1, 100, 300)};
  const auto held = stage.paint();
  std::vector<std::vector<std::uint32_t>> words;
  for (const Patch& p : held) words.push_back(p.pixels->words);
  for (int k = 1; k < 20; ++k) {
    stage.objects[0] = person(1, 100 + 3.7 * k, 300);
    stage.paint();
  }
  for (std::size_t i = 0; i < held.size(); ++i) ck_assert(held[i].pixels->words == words[i]);
}
END_TEST

START_TEST(each_state_has_its_line) {
  const auto opaque_in_left_side = [](ObjectState state) {
    Stage stage;
    stage.scene.ids = false;
    stage.scene.system = {};
    stage.objects = {person(1, 400, 300, state)};
    int rows = 0;
    for (const Patch& p : stage.paint())
      if (p.area.x < 405 && p.area.width < 30)
        for (int y = 0; y < p.area.height; ++y) rows += p.pixels->view().at(400 - p.area.x, y) >> 24 > 150;
    return rows;
  };
  const int solid = opaque_in_left_side(ObjectState::seen),
            dashed = opaque_in_left_side(ObjectState::coasted);
  ck_assert_int_gt(solid, 90);
  ck_assert_msg(dashed > solid / 3 && dashed < 4 * solid / 5, "%d of %d", dashed, solid);
  ck_assert_int_ne(opaque_in_left_side(ObjectState::stopped), solid);
}
END_TEST

START_TEST(the_steady_state_allocates_nothing) {
  Stage stage;
  stage.scene.system = {};
  std::vector<Trails::Trail> trails(2);
  for (std::uint32_t id : {1u, 2u}) {
    trails[id - 1].id = id;
    for (int k = 0; k < 50; ++k)
      trails[id - 1].points.push_back({{100 + 3.0 * k, 400.0 + 80 * id}, 0.04 * k});
  }
  stage.scene.trails = trails;
  stage.scene.time = 2;
  std::vector<Patch> patches;
  std::size_t taken = 0;
  for (int k = 0; k < 100; ++k) {
    if (k == 60) taken = cerberus::tests::allocations();
    stage.objects = {};
    stage.objects.reserve(0);
    const Object both[] = {person(1, 100 + k % 20, 300), person(2, 600 - k % 20, 200)};
    stage.scene.objects = both;
    patches.clear();
    stage.painter.paint(stage.scene, patches);
  }
  ck_assert_uint_eq(cerberus::tests::allocations(), taken);
}
END_TEST

// Two seconds of a walk to the right: the line is there, older ends are fainter, nothing lies far from it.
START_TEST(a_trail_lies_where_the_points_were_and_fades) {
  Stage stage;
  stage.scene.system = {};
  std::vector<Trails::Trail> trails(1);
  trails[0].id = 1;
  for (int k = 0; k <= 50; ++k) trails[0].points.push_back({{100 + 6.0 * k, 400}, 0.04 * k});
  stage.scene.trails = trails;
  stage.scene.time = 2;
  const auto patches = stage.paint();
  const auto alpha = [&](int x, int y) {
    unsigned most = 0;
    for (const Patch& p : patches)
      if (!p.area.intersection({x, y, 1, 1}).empty())
        most = std::max(most, p.pixels->view().at(x - p.area.x, y - p.area.y) >> 24);
    return most;
  };
  for (int x = 110; x < 390; ++x) ck_assert_uint_gt(alpha(x, 400), 15);
  ck_assert_uint_gt(alpha(380, 400), 200);
  ck_assert_uint_gt(alpha(380, 400), alpha(250, 400));
  ck_assert_uint_gt(alpha(250, 400), alpha(120, 400));
  for (const int y : {388, 412})
    for (int x = 80; x < 420; ++x) ck_assert_uint_eq(alpha(x, y), 0);
}
END_TEST

// The line is translucent: where two patches drew the same pixel it would be darker.
START_TEST(no_pixel_of_a_trail_is_drawn_twice) {
  Stage stage;
  stage.scene.system = {};
  std::vector<Trails::Trail> trails(1);
  trails[0].id = 1;
  for (int k = 0; k <= 100; ++k)
    trails[0].points.push_back({{100 + 4.0 * k, 400 + 60 * std::sin(0.1 * k)}, 0.02 * k});
  stage.scene.trails = trails;
  stage.scene.time = 2;
  const auto patches = stage.paint();
  ck_assert_uint_gt(patches.size(), 3);
  for (int y = 300; y < 500; ++y)
    for (int x = 80; x < 520; ++x) {
      int drawn = 0;
      for (const Patch& p : patches)
        if (!p.area.intersection({x, y, 1, 1}).empty())
          drawn += p.pixels->view().at(x - p.area.x, y - p.area.y) != 0;
      ck_assert_msg(drawn <= 1, "%d times at %d, %d", drawn, x, y);
    }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "painter", {what_stays_as_it_is_keeps_its_pictures, a_picture_that_is_held_is_not_used_again,
                  each_state_has_its_line, the_steady_state_allocates_nothing,
                  a_trail_lies_where_the_points_were_and_fades, no_pixel_of_a_trail_is_drawn_twice});
}
