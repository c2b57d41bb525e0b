// SPDX-License-Identifier: LGPL-2.1-or-later
// Pyramid, choice of patches, and following one.
#include "vision/ego_motion/patches.h"

#include <check.h>

#include <cmath>

#include "support/pictures.h"
#include "support/pyramids.h"
#include "support/targets.h"
#include "vision/ego_motion/global_shift.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

KeptPyramid pyramid_of(const Scene& scene, const Transform& motion, Size size, double gain = 1,
                       double offset = 0) {
  Image<std::uint8_t> image(size);
  look(scene, motion, image.view());
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      image.view().at(x, y) = to_byte(gain * image.view().at(x, y) + offset);
  return {std::move(image), 5};
}

}  // namespace

START_TEST(a_pyramid_halves_down_to_one_pixel_and_no_further) {
  Image<std::uint8_t> image({9, 5});
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 9; ++x) image.view().at(x, y) = static_cast<std::uint8_t>(10 * y + x);
  Pyramid pyramid;
  pyramid.borrow(image.view(), Pyramid::kMaxLevels);
  ck_assert_int_eq(pyramid.levels(), 3);
  ck_assert(pyramid.level(1).size() == (Size{4, 2}));
  ck_assert(pyramid.level(2).size() == (Size{2, 1}));
  ck_assert_int_eq(pyramid.level(0).at(8, 4), 48);
  ck_assert_int_eq(pyramid.level(1).at(0, 0), 6);   // (0 + 1 + 10 + 11 + 2) / 4
  ck_assert_int_eq(pyramid.level(1).at(3, 1), 32);  // (26 + 27 + 36 + 37 + 2) / 4
  ck_assert_int_eq(pyramid.level(2).at(0, 0), 17);  // (6 + 8 + 26 + 28 + 2) / 4
}
END_TEST

START_TEST(a_pyramid_needs_a_borrowed_picture_until_another_takes_it_over) {
  Image<std::uint8_t> image({9, 5});
  image.fill_bytes(50);
  Pyramid borrowed, kept;
  borrowed.borrow(image.view(), 2);
  ck_assert_ptr_eq(borrowed.level(0).data, image.view().data);
  const Image<std::uint8_t> other({4, 4});
  kept.borrow(other.view(), 2);
  kept.take(borrowed);
  image.fill_bytes(90);
  ck_assert_int_eq(borrowed.levels(), 0);
  ck_assert(kept.size() == (Size{9, 5}));
  ck_assert_int_eq(kept.levels(), 2);
  ck_assert_ptr_null(kept.level(0).data);
  kept.extend(3);  // of what was taken
  ck_assert_int_eq(kept.level(1).at(3, 1), 50);
  ck_assert_int_eq(kept.level(2).at(1, 0), 50);
}
END_TEST

START_TEST(patches_lie_all_over_a_textured_picture_and_nowhere_in_a_flat_one) {
  Image<std::int32_t> scratch;
  PatchSites sites;
  sites.choose(pyramid_of(Scene(1), {}, {320, 240}), 1, scratch);
  ck_assert_int_ge(sites.count, 180);
  std::array<int, MotionSamples::kRegions> regions{};
  for (int i = 0; i < sites.count; ++i) {
    const PatchSite& s = sites.site[i];
    ck_assert(s.x > 0 && s.y > 0 && s.x < 319 && s.y < 239);
    ck_assert_int_eq(s.region, static_cast<int>(s.y / 60) * 4 + static_cast<int>(s.x / 80));
    ++regions[s.region];
  }
  for (const int n : regions) ck_assert_int_ge(n, 8);
  sites.choose(pyramid_of(Scene(1, 0.5), {}, {320, 240}), 1, scratch);
  ck_assert_int_eq(sites.count, 0);
}
END_TEST

START_TEST(noise_alone_is_not_texture) {
  std::mt19937 random(2);
  Image<std::uint8_t> image({320, 240});
  for (int y = 0; y < 240; ++y) std::memset(image.view().row(y), 120, 320);
  add_noise(image.view(), 6, 6, random);
  Pyramid pyramid;
  pyramid.borrow(image.view(), 3);
  Image<std::int32_t> scratch;
  PatchSites sites;
  sites.choose(pyramid, 6, scratch);
  ck_assert_int_le(sites.count, 4);
}
END_TEST

START_TEST(a_patch_is_chosen_where_there_is_a_corner_not_an_edge) {
  Image<std::uint8_t> image({15, 15});  // one cell; an edge on the left, a corner at (9, 9)
  for (int y = 0; y < 15; ++y)
    for (int x = 0; x < 15; ++x) image.view().at(x, y) = x < 3 || (x >= 9 && y >= 9) ? 200 : 50;
  Pyramid pyramid;
  pyramid.borrow(image.view(), 1);
  Image<std::int32_t> scratch;
  PatchSites sites;
  sites.choose(pyramid, 0, scratch);
  ck_assert_int_eq(sites.count, 1);
  ck_assert_float_eq(sites.site[0].x, 8.5f);
  ck_assert_float_eq(sites.site[0].y, 8.5f);
}
END_TEST

START_TEST(patches_are_followed_to_a_fraction_of_a_pixel_under_any_light) {
  const Size size{160, 120};
  const KeptPyramid earlier = pyramid_of(Scene(3), {}, size);
  Image<std::int32_t> scratch;
  PatchSites sites;
  sites.choose(earlier, 1, scratch);
  ck_assert_int_ge(sites.count, 40);
  for (const double shift : {0.0, 0.3, -0.5, 1.2, -1.8})
    for (const double gain : {1.0, 0.5, 1.5}) {
      const Transform motion = Transform::translation(shift, 0.5 * shift);
      const KeptPyramid later = pyramid_of(Scene(3), motion, size, gain, 128 - 128 * gain);
      int good = 0;
      for (int i = 0; i < sites.count; ++i) {
        const PatchMatch m =
            PatchFollower(earlier.level(0), 0, sites.site[i]).follow(later.level(0), 0, 0, 10);
        ck_assert(m.inside);
        const PatchMatch kept = sites.follower(i).follow(later.level(0), 0, 0, 10);
        ck_assert(kept.dx == m.dx && kept.dy == m.dy && kept.correlation == m.correlation);
        good += std::abs(m.dx - shift) < 0.06 && std::abs(m.dy - 0.5 * shift) < 0.06 && m.correlation > 0.98f;
      }
      ck_assert_msg(good >= 0.8 * sites.count, "shift %g gain %g: %d of %d", shift, gain, good, sites.count);
    }
}
END_TEST

START_TEST(what_lies_outside_or_has_no_texture_is_not_found) {
  const KeptPyramid earlier = pyramid_of(Scene(4), {}, {64, 64});
  const PatchFollower patch(earlier.level(0), 0, {30, 33, 0});
  const PatchMatch outside = patch.follow(earlier.level(0), -40, 0, 3);
  ck_assert(!outside.inside);
  ck_assert_float_eq(outside.correlation, 0);
  ck_assert_float_eq(patch.follow(earlier.level(0), NAN, 0, 3).correlation, 0);
  const KeptPyramid flat = pyramid_of(Scene(4, 0), {}, {64, 64});
  ck_assert_float_eq(
      PatchFollower(flat.level(0), 0, {30, 33, 0}).follow(earlier.level(0), 0, 0, 3).correlation, 0);
  ck_assert_float_eq(patch.follow(flat.level(0), 0, 0, 3).correlation, 0);
  const KeptPyramid tiny = pyramid_of(Scene(4), {}, {9, 9});
  ck_assert_float_eq(PatchFollower(tiny.level(0), 0, {4, 4, 0}).follow(tiny.level(0), 0, 0, 3).correlation,
                     0);
}
END_TEST

START_TEST(the_coarse_search_finds_shifts_of_a_quarter_of_the_picture) {
  const Size size{40, 30};
  Relief earlier;
  earlier.build(pyramid_of(Scene(5), {}, size).level(0));
  const double shifts[][2] = {{0, 0}, {3, -2}, {-10, 1}, {10, 7}, {4.5, -6}};
  for (const auto& s : shifts) {
    Relief later;
    later.build(pyramid_of(Scene(5), Transform::translation(s[0], s[1]), size, 0.6, 30).level(0));
    const Shift found = ShiftSearch{}.run(earlier, later)[0];
    ck_assert_double_eq_tol(found.dx, s[0], 0.35);
    ck_assert_double_eq_tol(found.dy, s[1], 0.35);
    ck_assert_double_lt(found.difference, 0.5);
  }
  Relief other;
  other.build(pyramid_of(Scene(6), {}, size).level(0));
  ck_assert_double_gt(ShiftSearch{}.run(earlier, other)[0].difference, 0.7);
  other.build(pyramid_of(Scene(6), {}, {7, 30}).level(0));  // too small, and of another size: nothing known
  ck_assert_double_eq(ShiftSearch{}.run(earlier, other)[0].dx, 0);
}
END_TEST

int main() {
  return run_suite_on_every_target(
      "patches", {a_pyramid_halves_down_to_one_pixel_and_no_further,
                  a_pyramid_needs_a_borrowed_picture_until_another_takes_it_over,
                  patches_lie_all_over_a_textured_picture_and_nowhere_in_a_flat_one,
                  noise_alone_is_not_texture, a_patch_is_chosen_where_there_is_a_corner_not_an_edge,
                  patches_are_followed_to_a_fraction_of_a_pixel_under_any_light,
                  what_lies_outside_or_has_no_texture_is_not_found,
                  the_coarse_search_finds_shifts_of_a_quarter_of_the_picture});
}
