// SPDX-License-Identifier: LGPL-2.1-or-later
// Identity swaps, on tracks whose appearances are given.
#include "vision/tracking/identity_swap.h"

#include <check.h>

#include <vector>

#include "support/allocations.h"
#include "support/suite.h"
#include "vision/tracking/life_cycle.h"

using namespace cerberus::vision;

namespace {

constexpr double kFrame = 0.1;  // s

// Coat and legs of one brightness each: all in one bin.
AppearanceModel looks(int bin) {
  AppearanceModel look;
  for (auto& band : look.share) band[bin] = AppearanceModel::kAll;
  return look;
}

// A person 100 pixels tall whose appearance has long been learnt.
TrackHypothesis person(std::uint32_t id, double x, int bin) {
  TrackHypothesis b = TrackHypothesis::first_seen({{x - 20, 100, 40, 100}, 2000, 0.9, 1});
  LifeCycle::confirm(b, id);
  for (int k = 0; k < 50; ++k) {
    b.predict(kFrame);
    b.remember(looks(bin), kFrame, true);
  }
  return b;
}

// `frames` more in which it stands alone and looks so.
void seen_alone(TrackHypothesis& b, int bin, int frames) {
  for (int k = 0; k < frames; ++k) {
    b.predict(kFrame);
    b.remember(looks(bin), kFrame, true);
  }
}

// Two tracks whose identities were swapped at contact: the appearance of each has been the other's for `frames` since.
std::vector<TrackHypothesis> swapped(double apart = 60, int frames = 3) {
  std::vector<TrackHypothesis> two{person(1, 200, 1), person(2, 200 + apart, 6)};
  for (TrackHypothesis& b : two) b.touch();
  seen_alone(two[0], 6, frames);
  seen_alone(two[1], 1, frames);
  return two;
}

bool exchanged(const std::vector<TrackHypothesis>& two) {
  return two[0].id == 2 && two[1].id == 1;
}

}  // namespace

START_TEST(two_that_look_like_each_other_since_contact_get_their_identities_back) {
  auto two = swapped();
  two[0].top_speed = 7;
  two[0].appearance.learnt = 9;
  const double place = two[0].x.position, age = two[0].age, other = two[1].age;
  two[0].age += 3;
  undo_identity_swaps(two);
  ck_assert(exchanged(two));
  // The history goes with the identity, position and extent stay.
  ck_assert_double_eq(two[0].x.position, place);
  ck_assert_double_eq(two[0].age, other);
  ck_assert_double_eq(two[1].age, age + 3);
  ck_assert_double_eq(two[1].top_speed, 7);
  ck_assert_double_eq(two[1].appearance.learnt, 9);
  ck_assert_double_eq(appearance_distance(two[0].appearance.model, looks(6)), 0);
  ck_assert_double_eq(appearance_distance(two[1].appearance.model, looks(1)), 0);
  undo_identity_swaps(two);
  ck_assert(exchanged(two));  // once
}
END_TEST

START_TEST(unchanged_appearances_keep_their_identities) {
  std::vector<TrackHypothesis> two{person(1, 200, 1), person(2, 260, 6)};
  for (TrackHypothesis& b : two) b.touch();
  seen_alone(two[0], 1, 3);
  seen_alone(two[1], 6, 3);
  undo_identity_swaps(two);
  ck_assert_uint_eq(two[0].id, 1);
  ck_assert_uint_eq(two[1].id, 2);
}
END_TEST

START_TEST(two_frames_of_recent_appearance_are_too_few) {
  auto two = swapped(60, 2);
  undo_identity_swaps(two);
  ck_assert(!exchanged(two));
}
END_TEST

// After 0.3 s apart: 0.6 S and 0.45 S.
START_TEST(tracks_too_far_apart_keep_their_identities) {
  auto near = swapped(100), far = swapped(110);
  undo_identity_swaps(near);
  undo_identity_swaps(far);
  ck_assert(exchanged(near));
  ck_assert(!exchanged(far));
}
END_TEST

START_TEST(one_of_the_two_may_still_be_occluded) {
  std::vector<TrackHypothesis> two{person(1, 200, 1), person(2, 260, 6)};
  for (TrackHypothesis& b : two) b.touch();
  seen_alone(two[0], 6, 3);
  undo_identity_swaps(two);
  ck_assert(exchanged(two));
}
END_TEST

START_TEST(tentative_and_off_screen_tracks_take_no_part) {
  auto one = swapped(), two = swapped();
  one[1].life = Tentative{};
  two[1].life = OffScreen{};
  undo_identity_swaps(one);
  undo_identity_swaps(two);
  ck_assert_uint_eq(one[0].id, 1);
  ck_assert_uint_eq(two[0].id, 1);
}
END_TEST

// No contact, and each looks as the other did: one came into the sun, the other into the shade.
START_TEST(without_contact_identities_stay) {
  std::vector<TrackHypothesis> two{person(1, 200, 1), person(2, 260, 6)};
  seen_alone(two[0], 6, 4);
  seen_alone(two[1], 1, 4);
  ck_assert(two[0].is_ambiguous() && two[1].is_ambiguous());
  undo_identity_swaps(two);
  ck_assert_uint_eq(two[0].id, 1);
}
END_TEST

// Learning goes on half a second after contact; a changed appearance is learnt after four.
START_TEST(the_appearance_model_is_frozen_after_contact) {
  TrackHypothesis b = person(1, 200, 1), suddenly = person(2, 400, 1);
  AppearanceModel a_little = looks(1);
  for (auto& band : a_little.share) {
    band[1] -= AppearanceModel::kAll / 5;
    band[2] += AppearanceModel::kAll / 5;
  }
  b.touch();
  for (int k = 0; k < 20; ++k) {
    b.predict(kFrame);
    b.remember(a_little, kFrame, true);
    if (k >= 4) continue;
    ck_assert_double_eq(appearance_distance(b.appearance.model, looks(1)), 0);
    ck_assert_double_eq_tol(b.appearance.learnt, 50 * kFrame, 1e-9);
  }
  ck_assert_double_gt(b.appearance.learnt, 64 * kFrame);
  ck_assert_double_gt(appearance_distance(b.appearance.model, looks(1)), 0.07);
  suddenly.touch();
  seen_alone(suddenly, 6, 39);
  ck_assert_double_eq(appearance_distance(suddenly.appearance.model, looks(1)), 0);
  seen_alone(suddenly, 6, 60);
  ck_assert_double_lt(appearance_distance(suddenly.appearance.model, looks(6)), 0.3);
}
END_TEST

START_TEST(settling_allocates_nothing) {
  auto two = swapped();
  const std::size_t before = cerberus::tests::allocations();
  undo_identity_swaps(two);
  ck_assert_uint_eq(cerberus::tests::allocations(), before);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "identities", {two_that_look_like_each_other_since_contact_get_their_identities_back,
                     unchanged_appearances_keep_their_identities, two_frames_of_recent_appearance_are_too_few,
                     tracks_too_far_apart_keep_their_identities, one_of_the_two_may_still_be_occluded,
                     tentative_and_off_screen_tracks_take_no_part, without_contact_identities_stay,
                     the_appearance_model_is_frozen_after_contact, settling_allocates_nothing});
}
