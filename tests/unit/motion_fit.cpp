// SPDX-License-Identifier: LGPL-2.1-or-later
// The robust fit on correspondences made from a known motion.
#include "vision/ego_motion/motion_fit.h"

#include <check.h>

#include <cmath>
#include <random>

#include "support/allocations.h"
#include "support/motions.h"
#include "support/suite.h"
#include "vision/ego_motion/motion_least_squares.h"
#include "vision/geometry/lens.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr Size kSize{320, 240};
constexpr double kDegree = M_PI / 180;

// A grid of 16 x 12 honest samples of standard deviation 0.1.
MotionSamples samples_of(const Transform& motion, std::mt19937& random, double sigma = 0.1) {
  std::normal_distribution<double> normal;  // of deviation 1: 0 is not allowed there
  MotionSamples s;
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 16; ++x) {
      const int n = s.count++;
      s.x[n] = static_cast<float>(10 + 20 * x), s.y[n] = static_cast<float>(10 + 20 * y);
      const Point p = motion.apply({s.x[n], s.y[n]});
      s.u[n] = static_cast<float>(p.x + sigma * normal(random)),
      s.v[n] = static_cast<float>(p.y + sigma * normal(random));
      s.wxx[n] = s.wyy[n] = 100, s.wxy[n] = 0;
      s.evidence[n] = 1;
      s.region[n] = static_cast<std::uint8_t>(y / 3 * 4 + x / 4);
    }
  return s;
}

double disagreement(const Transform& a, const Transform& b) {
  double worst = 0;
  for (const Point p : {Point{0, 0}, Point{319, 0}, Point{0, 239}, Point{319, 239}, Point{160, 120}}) {
    const Point q = a.apply(p), r = b.apply(p);
    worst = std::max(worst, std::hypot(q.x - r.x, q.y - r.y));
  }
  return worst;
}

const Transform kTurn = similarity(1.04, 0.05, -12, 7);
const Transform kShear{{1.03, 0.04, -5, 0.01, 0.98, 6, 0, 0, 1}};
const Transform kPan{{1.02, 0.01, 8, 0.005, 1.01, -3, 1e-4, -5e-5, 1}};

}  // namespace

START_TEST(every_model_recovers_its_own_motion) {
  std::mt19937 random(1);
  const struct {
    MotionModel model;
    Transform motion;
  } cases[] = {{MotionModel::translation, Transform::translation(7.5, -3.25)},
               {MotionModel::similarity, kTurn},
               {MotionModel::affine, kShear},
               {MotionModel::homography, kPan}};
  for (const auto& c : cases) {
    const MotionFit fit = fit_motion(samples_of(c.motion, random), c.model, kSize, {}, 96);
    ck_assert_msg(disagreement(fit.transform, c.motion) < 0.12, "model %d off by %g",
                  static_cast<int>(c.model), disagreement(fit.transform, c.motion));
    ck_assert_double_gt(fit.agreeing, 185);  // 1 % of 192 lie beyond the gate
    ck_assert_double_eq_tol(fit.residual, 0.1 * std::sqrt(2), 0.02);
  }
}
END_TEST

START_TEST(exact_samples_give_the_exact_motion) {
  std::mt19937 random(2);
  ck_assert_double_lt(
      disagreement(fit_motion(samples_of(kTurn, random, 0), MotionModel::similarity, kSize, {}, 96).transform,
                   kTurn),
      2e-3);
}
END_TEST

START_TEST(a_compact_object_of_45_percent_is_left_out) {
  std::mt19937 random(3);
  MotionSamples s = samples_of(kTurn, random);
  const MotionSamples other = samples_of(Transform::translation(20, 1), random);
  int object = 0;
  for (int i = 0; i < s.count; ++i)
    if (s.x[i] > 60 && s.x[i] < 240 && s.y[i] > 40) {  // 9 x 10 of 192
      s.u[i] = other.u[i], s.v[i] = other.v[i];
      ++object;
    }
  ck_assert_int_eq(object, 90);
  const MotionFit fit = fit_motion(s, MotionModel::similarity, kSize, {}, 96);
  ck_assert_double_lt(disagreement(fit.transform, kTurn), 0.15);
  ck_assert_double_lt(fit.agreeing, 104);
}
END_TEST

START_TEST(scattered_nonsense_of_60_percent_is_left_out) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> anywhere(-60, 60);
  MotionSamples s = samples_of(kPan, random);
  for (int i = 0; i < s.count; ++i)
    if (i % 5 < 3) s.u[i] += anywhere(random), s.v[i] += anywhere(random);
  ck_assert_double_lt(disagreement(fit_motion(s, MotionModel::homography, kSize, {}, 96).transform, kPan),
                      0.3);
}
END_TEST

START_TEST(agreement_all_over_the_picture_beats_the_same_number_in_one_place) {
  std::mt19937 random(5);
  MotionSamples s = samples_of({}, random);
  for (int i = 0; i < s.count; ++i)
    if (s.x[i] > 150) s.u[i] += 30;  // more than half: 9 of 16 columns
  const double everywhere = rate_motion(s, {}).support;
  MotionSamples compact = s;
  for (int i = 0; i < s.count; ++i) compact.region[i] = 5;
  ck_assert_double_gt(everywhere, 1.5 * rate_motion(compact, {}).support);
}
END_TEST

// A person who covers nearly half of the picture, from the lower edge on, and a wall with little on it.
START_TEST(what_surrounds_the_middle_of_the_picture_is_the_background) {
  std::mt19937 random(15);
  for (const Transform& camera : {Transform::translation(-6, 1), Transform{}, kTurn}) {
    MotionSamples s = samples_of(camera, random);
    int near = 0, bare = 0;
    for (int i = 0; i < s.count; ++i)
      if (s.x[i] > 60 && s.x[i] < 260 && s.y[i] > 60)
        s.u[i] = s.x[i] + 5, s.v[i] = s.y[i] - 1, ++near;
      else if (i % 3 == 0)
        s.evidence[i] = 0.05f, s.wxx[i] = s.wyy[i] = 0.2f, ++bare;
    ck_assert_int_eq(near, 90);
    ck_assert_int_gt(bare, 30);
    const MotionFit fit = fit_motion(s, MotionModel::similarity, kSize, {}, 96);
    ck_assert_double_lt(disagreement(fit.transform, camera), 0.3);
    ck_assert(fit.rival);
    ck_assert_double_lt(disagreement(*fit.rival, Transform::translation(5, -1)), 0.3);
  }
}
END_TEST

START_TEST(where_all_go_along_nothing_competes) {
  std::mt19937 random(18);
  for (int i = 0; i < 20; ++i)
    ck_assert(!fit_motion(samples_of(kTurn, random), MotionModel::similarity, kSize, {}, 96).rival);
}
END_TEST

START_TEST(edges_that_know_one_direction_only_are_combined) {
  // Half of the samples know x only, half y only; what they do not know is wildly wrong.
  std::mt19937 random(6);
  std::uniform_real_distribution<float> anywhere(-3, 3);
  MotionSamples s = samples_of(kTurn, random);
  for (int i = 0; i < s.count; ++i) {
    (i % 2 ? s.wxx : s.wyy)[i] = 0.01f;
    (i % 2 ? s.u : s.v)[i] += anywhere(random);
  }
  const std::array guess{kTurn};
  ck_assert_double_lt(disagreement(fit_motion(s, MotionModel::similarity, kSize, guess, 96).transform, kTurn),
                      0.15);
}
END_TEST

START_TEST(a_richer_model_is_taken_only_where_it_earns_its_unknowns) {
  std::mt19937 random(10);
  int affine = 0;
  for (int i = 0; i < 50; ++i)
    affine +=
        fit_motion(samples_of(kTurn, random), MotionModel::homography, kSize, {}, 96).transform.is_affine();
  ck_assert_int_ge(affine, 48);
  for (int i = 0; i < 50; ++i)
    ck_assert(
        !fit_motion(samples_of(kPan, random), MotionModel::homography, kSize, {}, 96).transform.is_affine());
}
END_TEST

// By chance one in a thousand does; in a thousand, more than five have one chance in 1700.
START_TEST(chance_gives_an_affine_motion_one_time_in_a_thousand) {
  std::mt19937 random(12);
  int affine = 0;
  for (int i = 0; i < 1000; ++i) {
    const Transform t = fit_motion(samples_of(kTurn, random), MotionModel::affine, kSize, {}, 96).transform;
    affine += std::abs(t.m[0] - t.m[4]) > 1e-6 || std::abs(t.m[1] + t.m[3]) > 1e-6;
  }
  ck_assert_msg(affine <= 5, "%d of 1000", affine);
}
END_TEST

// K R K^-1 with the principal point in the middle.
Transform turn_of(double field_of_view, double pan, double tilt, double roll) {
  return Lens(field_of_view, kSize).turn(0, 0, pan, tilt) * Transform::translation(159.5, 119.5) *
         similarity(1, roll, 0, 0) * Transform::translation(-159.5, -119.5);
}

MotionFit turn_in(const MotionSamples& samples, const LensBend& known = {}) {
  return fit_turn(samples, kSize, fit_motion(samples, MotionModel::similarity, kSize, {}, 96, 24, known),
                  known);
}

START_TEST(a_similarity_bends_as_a_turning_camera_does_whatever_its_lens) {
  std::mt19937 random(11);
  for (const double view : {30.0, 60.0, 90.0})
    for (const auto& [pan, tilt, roll] :
         {std::array{2.0, 0.0, 0.0}, std::array{-1.5, 0.7, 0.3}, std::array{0.0, -2.0, 0.0}}) {
      const Transform truth = turn_of(view * kDegree, pan * kDegree, tilt * kDegree, roll * kDegree);
      const Transform t = turn_in(samples_of(truth, random)).transform;
      ck_assert_msg(disagreement(t, truth) < 0.25, "a lens of %g degrees, %g %g %g: off by %g", view, pan,
                    tilt, roll, disagreement(t, truth));
    }
}
END_TEST

START_TEST(a_turn_through_a_lens_takes_one_point_to_the_other_and_bends) {
  const MotionLeastSquares squares(kSize);
  for (const double bend : {0.0, 0.34, MotionLeastSquares::kMostBend}) {
    const Transform t = squares.turn({300, 20}, {287, 23}, bend);
    const Point q = t.apply({300, 20});
    ck_assert_double_eq_tol(q.x, 287, 1e-9);
    ck_assert_double_eq_tol(q.y, 23, 1e-9);
    ck_assert(t.is_affine() == (bend == 0));
  }
  // As the lens does, to first order: of 90 degrees, bend is (half diagonal / half width)^2.
  const Transform turn = Lens(90 * kDegree, kSize).turn(0, 0, kDegree, 0);
  ck_assert_double_lt(disagreement(squares.turn({300, 20}, turn.apply({300, 20}), 1.5625), turn), 0.1);
}
END_TEST

START_TEST(a_known_wide_lens_turns_behind_a_close_person) {
  std::mt19937 random(16);
  for (const double pan : {-3.0, 2.5, 3.0}) {
    const Transform truth = turn_of(95 * kDegree, pan * kDegree, 0.3 * kDegree, 0);
    MotionSamples s = samples_of(truth, random);
    for (int i = 0; i < s.count; ++i)  // a third of the picture
      if (s.x[i] > 80 && s.x[i] < 220 && s.y[i] > 60) s.u[i] = s.x[i] + 6, s.v[i] = s.y[i];
    LensBend known;
    for (int i = 0; i < 5; ++i) known.learn(turn_in(samples_of(truth, random), known).lens);
    ck_assert_double_lt(disagreement(turn_in(s, known).transform, truth), 0.6);
  }
}
END_TEST

// A similarity follows neither the whole of such a turn nor more samples than a person who goes another way.
START_TEST(an_unknown_wide_lens_turns_behind_a_close_person) {
  std::mt19937 random(19);
  for (const double view : {65.0, 80.0, 100.0})
    for (const double pan : {-4.0, 4.0}) {
      const Transform truth = turn_of(view * kDegree, pan * kDegree, 0.3 * kDegree, 0);
      MotionSamples s = samples_of(truth, random);
      for (int i = 0; i < s.count; ++i)  // a quarter of the picture
        if (s.x[i] > 80 && s.x[i] < 200 && s.y[i] > 80) s.u[i] = s.x[i] + 6, s.v[i] = s.y[i];
      const double off = disagreement(turn_in(s).transform, truth);
      ck_assert_msg(off < 0.6, "a lens of %g degrees, %g: off by %g", view, pan, off);
    }
}
END_TEST

START_TEST(a_turn_that_the_samples_do_not_show_comes_out_unbent) {
  std::mt19937 random(17);
  for (int i = 0; i < 50; ++i) {
    const MotionSamples s = samples_of(Transform::translation(9, -4), random);
    MotionFit turn;
    turn.transform = MotionLeastSquares(kSize).turn({170, 110}, {179, 106}, 0.77);
    const Transform t = fit_turn(s, kSize, turn, {}).transform;
    ck_assert_double_lt(disagreement(t, Transform::translation(9, -4)), 0.2);
  }
}
END_TEST

START_TEST(what_is_not_bent_stays_a_similarity) {
  std::mt19937 random(12);
  int alike = 0;
  for (int i = 0; i < 50; ++i) {
    const Transform t = turn_in(samples_of(kTurn, random)).transform;
    alike += t.is_affine() && std::abs(t.m[0] - t.m[4]) < 1e-9;
  }
  ck_assert_int_ge(alike, 48);
  // No lens bends the other way.
  const Transform inside_out = Transform::translation(159.5, 119.5) *
                               Transform{{1, 0, 12, 0, 1, 0, 3e-4, 0, 1}} *
                               Transform::translation(-159.5, -119.5);
  ck_assert(turn_in(samples_of(inside_out, random)).transform.is_affine());
}
END_TEST

// A pan that becomes faster, seen row after row: rows below have gone further. 6 pixels a frame, then 9, and the
// shutter takes a frame's time from the first row to the last.
START_TEST(a_rolling_shutter_shears_a_pan_and_stretches_a_tilt) {
  std::mt19937 random(13);
  const double jerk = 3.0 / kSize.height;
  const Transform middle = Transform::translation(159.5, 119.5),
                  back = Transform::translation(-159.5, -119.5);
  for (const Transform& rolling :
       {Transform{{1, jerk, 0, 0, 1, 0, 0, 0, 1}}, Transform{{1, 0, 0, 0, 1 - jerk, 0, 0, 0, 1}}}) {
    const Transform truth = middle * rolling * back * turn_of(60 * kDegree, 1.5 * kDegree, 0, 0);
    const MotionSamples samples = samples_of(truth, random);
    ck_assert_double_lt(disagreement(turn_in(samples).transform, truth), 0.3);
    ck_assert_double_gt(
        disagreement(fit_motion(samples, MotionModel::similarity, kSize, {}, 96).transform, truth), 1.0);
  }
}
END_TEST

MotionSamples only_the_middle_of(const MotionSamples& all) {
  MotionSamples s = all;
  s.count = 0;
  for (int i = 0; i < all.count; ++i) {
    if (std::abs(all.x[i] - 160) > 60 || std::abs(all.y[i] - 120) > 60) continue;
    const int n = s.count++;
    s.x[n] = all.x[i], s.y[n] = all.y[i], s.u[n] = all.u[i], s.v[n] = all.v[i];
    s.wxx[n] = all.wxx[i], s.wxy[n] = all.wxy[i], s.wyy[n] = all.wyy[i];
    s.evidence[n] = all.evidence[i], s.region[n] = all.region[i];
  }
  return s;
}

START_TEST(a_lens_that_is_known_bends_what_too_few_samples_show) {
  std::mt19937 random(14);
  const Transform truth = turn_of(60 * kDegree, 2 * kDegree, 0, 0);
  LensBend lens;
  for (int i = 0; i < 10; ++i) lens.learn(turn_in(samples_of(truth, random), lens).lens);
  const double half_diagonal = 200, focal_length = 160 / std::tan(30 * kDegree);
  ck_assert_double_eq_tol(lens.bend, std::pow(half_diagonal / focal_length, 2), 0.05);
  double unknown = 0, known = 0;
  for (int i = 0; i < 20; ++i) {
    const MotionSamples few = only_the_middle_of(samples_of(truth, random));
    ck_assert_int_ge(few.count, 12);
    unknown += disagreement(turn_in(few).transform, truth) / 20;
    known += disagreement(turn_in(few, lens).transform, truth) / 20;
  }
  ck_assert_msg(known < 0.6 * unknown, "off by %g, by %g without knowing the lens", known, unknown);
  // Seen from a robot that drives past, the same wall is not bent: what was learnt is given up.
  const Transform along = Transform::translation(10, 0);
  for (int i = 0; i < 3; ++i) lens.learn(turn_in(samples_of(along, random), lens).lens);
  ck_assert_double_lt(disagreement(turn_in(samples_of(along, random), lens).transform, along), 0.3);
}
END_TEST

START_TEST(few_samples_give_the_simplest_motion_that_they_carry) {
  std::mt19937 random(7);
  MotionSamples s = samples_of(Transform::translation(4, 2), random, 0);
  s.count = 1;
  for (const MotionModel model :
       {MotionModel::translation, MotionModel::similarity, MotionModel::homography}) {
    const MotionFit fit = fit_motion(s, model, kSize, {}, 96);
    ck_assert(fit.transform.is_sane(kSize));
    ck_assert_double_lt(disagreement(fit.transform, Transform::translation(4, 2)), 0.2);
  }
  s.count = 0;
  ck_assert(fit_motion(s, MotionModel::similarity, kSize, {}, 96).transform.is_identity());
  const std::array guess{kTurn};
  ck_assert(fit_motion(s, MotionModel::similarity, kSize, guess, 96).transform.m == kTurn.m);
}
END_TEST

START_TEST(no_model_takes_the_best_guess_as_it_is) {
  std::mt19937 random(8);
  const std::array guesses{Transform{}, kTurn, Transform::translation(3, 3)};
  ck_assert(fit_motion(samples_of(kTurn, random), MotionModel::none, kSize, guesses, 96).transform.m ==
            kTurn.m);
}
END_TEST

START_TEST(a_fit_allocates_nothing) {
  std::mt19937 random(9);
  const MotionSamples s = samples_of(kPan, random);
  const std::size_t before = allocations();
  fit_motion(s, MotionModel::homography, kSize, {}, 96);
  ck_assert_uint_eq(allocations() - before, 0);
}
END_TEST

int main() {
  return run_suite("motion_fit", {every_model_recovers_its_own_motion,
                                  exact_samples_give_the_exact_motion,
                                  a_compact_object_of_45_percent_is_left_out,
                                  scattered_nonsense_of_60_percent_is_left_out,
                                  agreement_all_over_the_picture_beats_the_same_number_in_one_place,
                                  what_surrounds_the_middle_of_the_picture_is_the_background,
                                  where_all_go_along_nothing_competes,
                                  a_turn_through_a_lens_takes_one_point_to_the_other_and_bends,
                                  a_known_wide_lens_turns_behind_a_close_person,
                                  an_unknown_wide_lens_turns_behind_a_close_person,
                                  a_turn_that_the_samples_do_not_show_comes_out_unbent,
                                  edges_that_know_one_direction_only_are_combined,
                                  a_richer_model_is_taken_only_where_it_earns_its_unknowns,
                                  chance_gives_an_affine_motion_one_time_in_a_thousand,
                                  a_similarity_bends_as_a_turning_camera_does_whatever_its_lens,
                                  what_is_not_bent_stays_a_similarity,
                                  a_rolling_shutter_shears_a_pan_and_stretches_a_tilt,
                                  a_lens_that_is_known_bends_what_too_few_samples_show,
                                  few_samples_give_the_simplest_motion_that_they_carry,
                                  no_model_takes_the_best_guess_as_it_is,
                                  a_fit_allocates_nothing});
}
