// SPDX-License-Identifier: LGPL-2.1-or-later
// Patches found again: where, which guess they like, how many follow a motion, what noise they leave.
#include "vision/ego_motion/patch_matches.h"

#include <check.h>

#include <cmath>
#include <utility>

#include "support/looks.h"
#include "support/pyramids.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

KeptPyramid pyramid_of(Image<std::uint8_t> image) {
  return {std::move(image), 4};
}

PatchSites sites_of(const Pyramid& pyramid, double noise = 1) {
  PatchSites sites;
  Image<std::int32_t> scratch;
  sites.choose(pyramid, noise, scratch);
  return sites;
}

}  // namespace

START_TEST(patches_are_found_where_they_went_on_every_level) {
  const Transform truth = Transform::translation(5.5, -3.25);
  const KeptPyramid before = pyramid_of(picture(Scene(1))), after = pyramid_of(picture(Scene(1), truth));
  const PatchSites sites = sites_of(before);
  PatchMatches matches(sites);
  ck_assert_int_ge(matches.count(), 180);
  for (const int level : {2, 1, 0}) {
    matches.follow(before, after, level, Transform::translation(5, -3));
    const MotionSamples& s = matches.samples();
    ck_assert_int_ge(s.count, 150);
    int right = 0;
    for (int i = 0; i < s.count; ++i)
      right += std::hypot(s.u[i] - s.x[i] - 5.5, s.v[i] - s.y[i] + 3.25) < 0.1 * (1 << level);
    ck_assert_int_ge(right, s.count * 9 / 10);
  }
}
END_TEST

START_TEST(of_several_guesses_the_right_one_is_found_and_the_first_in_doubt) {
  const Transform truth = Transform::translation(40, 9);
  const KeptPyramid before = pyramid_of(picture(Scene(2))), after = pyramid_of(picture(Scene(2), truth));
  const PatchSites sites = sites_of(before);
  PatchMatches matches(sites);
  const std::array guesses{Transform{}, Transform::translation(-20, 0), Transform::translation(39, 10)};
  ck_assert(matches.follow(before, after, 2, guesses).m == guesses[2].m);
  ck_assert_double_gt(matches.share_of(rate_motion(matches.samples(), truth)).all, 0.7);
  const std::array doubtful{Transform{}, Transform::translation(0.1, 0)};
  ck_assert(matches.follow(before, before, 2, doubtful).is_identity());
}
END_TEST

START_TEST(the_share_is_of_the_patches_that_follow) {
  Image<std::uint8_t> later = picture(Scene(3), Transform::translation(4, 0));
  paste(picture(Scene(99)), later.view(), 160, 0, 160, 240);  // the right half is another place
  const KeptPyramid before = pyramid_of(picture(Scene(3))), after = pyramid_of(std::move(later));
  const PatchSites sites = sites_of(before);
  PatchMatches matches(sites);
  ck_assert_double_eq(matches.share_of({}).all, 0);  // no patch was searched yet
  matches.follow(before, after, 0, Transform::translation(4, 0));
  const PatchMatches::Share share =
      matches.share_of(rate_motion(matches.samples(), Transform::translation(4, 0)));
  ck_assert_double_eq_tol(share.all, 0.5, 0.06);
  ck_assert_double_eq_tol(share.well, 0.5, 0.06);
  ck_assert_double_lt(matches.share_of(rate_motion(matches.samples(), Transform::translation(9, 0))).all,
                      0.05);
}
END_TEST

START_TEST(noise_is_what_the_matches_leave) {
  for (const double sigma : {2.0, 5.0}) {
    std::mt19937 random(4);
    Image<std::uint8_t> a = picture(Scene(4)), b = picture(Scene(4));
    add_noise(a.view(), sigma, sigma, random);
    add_noise(b.view(), sigma, sigma, random);
    const KeptPyramid before = pyramid_of(std::move(a)), after = pyramid_of(std::move(b));
    const PatchSites sites = sites_of(before, sigma);
    PatchMatches matches(sites);
    ck_assert(!matches.noise());
    matches.follow(before, after, 0, Transform{});
    ck_assert(matches.noise().has_value());
    ck_assert_double_eq_tol(*matches.noise(), sigma, 0.35 * sigma);  // of the calmer ones: a little low
  }
}
END_TEST

int main() {
  return run_suite("patch_matches",
                   {patches_are_found_where_they_went_on_every_level,
                    of_several_guesses_the_right_one_is_found_and_the_first_in_doubt,
                    the_share_is_of_the_patches_that_follow, noise_is_what_the_matches_leave});
}
