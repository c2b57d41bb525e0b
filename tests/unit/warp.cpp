// SPDX-License-Identifier: LGPL-2.1-or-later
// The warp against its floating point reference and against hand-made cases.
#include "vision/geometry/warp.h"

#include <check.h>

#include "support/allocations.h"
#include "support/motions.h"
#include "support/pictures.h"
#include "support/targets.h"
#include "support/wrong.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr std::uint8_t kFill = 7;

Transform pan(Size size, double degrees) {
  const double f = size.width, a = degrees * M_PI / 180, cx = 0.5 * (size.width - 1),
               cy = 0.5 * (size.height - 1);
  const Transform k{{f, 0, cx, 0, f, cy, 0, 0, 1}};
  return k * Transform{{std::cos(a), 0, -std::sin(a), 0, 1, 0, std::sin(a), 0, std::cos(a)}} * k.inverse();
}

// Random motions as cameras make them, and wilder ones.
std::vector<Transform> motions(Size size) {
  return {Transform::translation(2.25, -1.5),
          Transform::translation(-0.37, 0.81),
          similarity(1.01, 0.01, 3, -4),
          similarity(0.9, -0.2, 5, 6),
          similarity(1.4, 0.6, -9, 2),
          similarity(1, M_PI / 2, size.height - 1.0, 0),
          Transform{{1.1, 0.2, 3, -0.1, 0.8, 1, 0, 0, 1}},
          pan(size, 2.5),
          pan(size, -10) * similarity(1.05, 0.1, 2, 1)};
}

bool inside(RowSpan span, int x) {
  return x >= span.begin && x < span.end;
}

long valid_pixels(const Warp& warp) {
  long valid = 0;
  for (const RowSpan span : warp.spans()) valid += span.end - span.begin;
  return valid;
}

}  // namespace

START_TEST(identity_is_a_copy_and_everything_is_valid) {
  std::mt19937 random(1);
  for (const Size size : {Size{1, 1}, Size{33, 35}, Size{320, 240}}) {
    const GuardedPicture source(size, 3), target(size, 1);
    fill_random(source.view(), random);
    Warp warp;
    ck_assert(warp.prepare({}, size));
    ck_assert(warp.is_identity());
    warp.bilinear(source.view(), target.view());
    for (int y = 0; y < size.height; ++y) {
      ck_assert(warp.spans()[y] == (RowSpan{0, size.width}));
      ck_assert_int_eq(std::memcmp(source.view().row(y), target.view().row(y), size.width), 0);
    }
  }
}
END_TEST

START_TEST(a_shift_by_whole_pixels_moves_them_unchanged) {
  std::mt19937 random(2);
  const Size size{50, 20};
  Image<std::uint8_t> source(size), target(size);
  fill_random(source.view(), random);
  const int shifts[][2] = {{3, -2}, {-7, 5}, {0, 1}, {49, 19}, {50, 0}, {-51, 0}, {0, 20}};
  for (const auto& s : shifts) {
    Warp warp;
    ck_assert(warp.prepare(Transform::translation(s[0], s[1]), size));
    for (const bool nearest : {false, true}) {
      nearest ? warp.nearest(source.view(), target.view(), kFill)
              : warp.bilinear(source.view(), target.view(), kFill);
      Wrong validity, value;
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
          const int u = x - s[0], v = y - s[1];
          const bool valid = u >= 0 && v >= 0 && u < size.width && v < size.height;
          validity.unless(inside(warp.spans()[y], x) == valid, x, y);
          value.unless(target.view().at(x, y) == (valid ? source.view().at(u, v) : kFill), x, y);
        }
      validity.assert_none("validity");
      value.assert_none("value");
    }
  }
}
END_TEST

START_TEST(half_a_pixel_is_the_mean_of_two) {
  const std::uint8_t pixels[] = {10, 20, 41, 255, 0};
  std::uint8_t out[5];
  Warp warp;
  warp.prepare(Transform::translation(0.5, 0), {5, 1});
  warp.bilinear(GrayView{pixels, 5, 1, 5}, {out, 5, 1, 5}, kFill);
  const std::uint8_t expected[] = {kFill, 15, 31, 148, 128};
  for (int x = 0; x < 5; ++x) ck_assert_int_eq(out[x], expected[x]);
  ck_assert(warp.spans()[0] == (RowSpan{1, 5}));
}
END_TEST

START_TEST(every_motion_matches_the_reference_and_stays_inside_its_memory) {
  std::mt19937 random(3);
  for (const Size size :
       {Size{320, 240}, Size{33, 35}, Size{64, 1}, Size{1, 64}, Size{2, 2}, Size{1, 1}, Size{17, 9}})
    for (const Transform& motion : motions(size)) {
      const GuardedPicture source(size, 2), target(size, 3);
      Image<std::uint8_t> exact(size);
      fill_random(source.view(), random);
      Warp warp;
      if (!warp.prepare(motion, size)) continue;
      warp.bilinear(source.view(), target.view(), kFill);
      warp_bilinear_reference(motion, source.view(), exact.view(), kFill);
      double sum = 0;
      long compared = 0;
      Wrong filled, close;
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
          // A position on the edge may be rounded to either side.
          const RowSpan span = warp.spans()[y];
          filled.unless(inside(span, x) || target.view().at(x, y) == kFill, x, y);
          if (!inside(span, x - 1) || !inside(span, x + 1)) continue;
          const int error = std::abs(target.view().at(x, y) - exact.view().at(x, y));
          close.unless(error <= 5, x, y);  // 2/128 of 255
          sum += error, ++compared;
        }
      filled.assert_none("what no camera saw");
      close.assert_none("far from the reference");
      ck_assert_double_le(sum, 0.12 * compared + 1);
    }
}
END_TEST

START_TEST(valid_pixels_are_those_whose_source_is_inside) {
  const Size size{97, 61};
  for (const Transform& motion : motions(size)) {
    Warp warp;
    ck_assert(warp.prepare(motion, size));
    const Transform inverse = motion.inverse();
    Wrong validity;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const Point p = inverse.apply({double(x), double(y)});
        const double depth = std::min({p.x, p.y, size.width - 1 - p.x, size.height - 1 - p.y});
        validity.unless(std::abs(depth) <= 0.01 || inside(warp.spans()[y], x) == (depth > 0), x, y);
      }
    validity.assert_none("validity");
  }
}
END_TEST

START_TEST(the_scene_seen_through_the_warp_is_the_scene_seen_from_there) {
  const Size size{320, 240};
  const Scene scene(5);
  for (const Transform& motion : {similarity(1.02, 0.02, -3.3, 4.1), pan(size, 1.5)}) {
    Image<std::uint8_t> earlier(size), later(size), registered(size);
    look(scene, {}, earlier.view());
    look(scene, motion, later.view());
    Warp warp;
    warp.prepare(motion, size);
    warp.bilinear(earlier.view(), registered.view());
    double sum = 0;
    for (int y = 0; y < size.height; ++y)
      for (int x = warp.spans()[y].begin; x < warp.spans()[y].end; ++x)
        sum += std::abs(registered.view().at(x, y) - later.view().at(x, y));
    ck_assert_double_lt(sum / valid_pixels(warp), 1.0);
  }
}
END_TEST

START_TEST(nearest_takes_existing_values_only_and_the_right_ones) {
  const Size size{67, 43};
  // Each pixel's value is its place; no column or row has this number.
  constexpr std::uint8_t kNowhere = 255;
  Image<std::uint8_t> columns(size), rows(size), column(size), row(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      columns.view().at(x, y) = static_cast<std::uint8_t>(x);
      rows.view().at(x, y) = static_cast<std::uint8_t>(y);
    }
  for (const Transform& motion : motions(size)) {
    Warp warp;
    warp.prepare(motion, size);
    warp.nearest(columns.view(), column.view(), kNowhere);
    warp.nearest(rows.view(), row.view(), kNowhere);
    const Transform inverse = motion.inverse();
    Wrong filled, place;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        if (!inside(warp.spans()[y], x)) {
          filled.unless(column.view().at(x, y) == kNowhere && row.view().at(x, y) == kNowhere, x, y);
          continue;
        }
        const Point p = inverse.apply({double(x), double(y)});
        place.unless(
            std::abs(column.view().at(x, y) - p.x) <= 0.51 && std::abs(row.view().at(x, y) - p.y) <= 0.51, x,
            y);
      }
    filled.assert_none("what no camera saw");
    place.assert_none("whence it came");
  }
}
END_TEST

START_TEST(a_motion_that_is_none_fills) {
  const Size size{20, 10};
  Image<std::uint8_t> source(size), target(size);
  for (const Transform& motion :
       {Transform{{0, 0, 0, 0, 0, 0, 0, 0, 0}}, Transform{{1, 0, NAN, 0, 1, 0, 0, 0, 1}},
        Transform{{-1, 0, 0, 0, 1, 0, 0, 0, 1}}, Transform{{1, 0, 0, 0, 1, 0, 0.2, 0, -1}}}) {
    Warp warp;
    ck_assert(!warp.prepare(motion, size));
    ck_assert_int_eq(valid_pixels(warp), 0);
    warp.bilinear(source.view(), target.view(), kFill);
    Wrong filled;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) filled.unless(target.view().at(x, y) == kFill, x, y);
    filled.assert_none("what no camera saw");
  }
  for (const double far : {1e4, -1e9, 1e15}) {  // sane, but out of sight
    Warp warp;
    ck_assert(warp.prepare(Transform::translation(far, 0.5), size));
    ck_assert_int_eq(valid_pixels(warp), 0);
  }
  Warp warp;
  ck_assert(!warp.prepare({}, {0, 0}));
}
END_TEST

START_TEST(the_steady_state_allocates_nothing) {
  const Size size{320, 240};
  Image<std::uint8_t> source(size), target(size);
  Warp warp;
  warp.prepare({}, size);
  const std::size_t before = allocations();
  const Transform turned = similarity(1, 0.1, 1, 2), panned = pan(size, 2);
  for (const Transform* motion : {&turned, &panned}) {
    warp.prepare(*motion, size);
    warp.bilinear(source.view(), target.view());
    warp.nearest(source.view(), target.view());
  }
  ck_assert_uint_eq(allocations() - before, 0);
}
END_TEST

int main() {
  return run_suite_on_every_target(
      "warp",
      {identity_is_a_copy_and_everything_is_valid, a_shift_by_whole_pixels_moves_them_unchanged,
       half_a_pixel_is_the_mean_of_two, every_motion_matches_the_reference_and_stays_inside_its_memory,
       valid_pixels_are_those_whose_source_is_inside,
       the_scene_seen_through_the_warp_is_the_scene_seen_from_there,
       nearest_takes_existing_values_only_and_the_right_ones, a_motion_that_is_none_fills,
       the_steady_state_allocates_nothing});
}
