// SPDX-License-Identifier: LGPL-2.1-or-later
// Whose identity is whose once people have parted, on bodies whose looks are given.
#include "vision/tracking/identity_swap.h"

#include <check.h>

#include <vector>

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr double kFrame = 0.1;  // s

// Coat and legs of one brightness each: all in one bin.
AppearanceModel looks(int bin) {
  AppearanceModel look;
  for (auto& band : look.share) band[bin] = AppearanceModel::kAll;
  return look;
}

// Somebody 100 pixels tall who has long been known by that look.
TrackHypothesis person(std::uint32_t id, double x, int bin) {
  TrackHypothesis b = TrackHypothesis::first_seen({{x - 20, 100, 40, 100}, 2000, 0.9, 1});
  b.confirm(id);
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

// Two who were mixed up and look like each other for `frames` since.
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

START_TEST(two_who_look_like_each_other_since_they_were_close_get_their_identities_back) {
  auto two = swapped();
  two[0].top_speed = 7;
  const double place = two[0].x.position, age = two[0].age, other = two[1].age;
  two[0].age += 3;
  undo_identity_swaps(two);
  ck_assert(exchanged(two));
  // What is known of the person goes with the identity, where he is stays with the body.
  ck_assert_double_eq(two[0].x.position, place);
  ck_assert_double_eq(two[0].age, other);
  ck_assert_double_eq(two[1].age, age + 3);
  ck_assert_double_eq(two[1].top_speed, 7);
  ck_assert_double_eq(appearance_distance(two[0].appearance.model, looks(6)), 0);
  ck_assert_double_eq(appearance_distance(two[1].appearance.model, looks(1)), 0);
  undo_identity_swaps(two);
  ck_assert(exchanged(two));  // once
}
END_TEST

START_TEST(who_looks_as_before_stays_who_he_is) {
  std::vector<TrackHypothesis> two{person(1, 200, 1), person(2, 260, 6)};
  for (TrackHypothesis& b : two) b.touch();
  seen_alone(two[0], 1, 3);
  seen_alone(two[1], 6, 3);
  undo_identity_swaps(two);
  ck_assert_uint_eq(two[0].id, 1);
  ck_assert_uint_eq(two[1].id, 2);
}
END_TEST

START_TEST(two_frames_tell_nothing_yet) {
  auto two = swapped(60, 2);
  undo_identity_swaps(two);
  ck_assert(!exchanged(two));
}
END_TEST

// After 0.3 s apart: 0.6 S and 0.45 S.
START_TEST(who_is_too_far_away_was_not_mixed_up_with_anybody) {
  auto near = swapped(100), far = swapped(110);
  undo_identity_swaps(near);
  undo_identity_swaps(far);
  ck_assert(exchanged(near));
  ck_assert(!exchanged(far));
}
END_TEST

START_TEST(one_of_them_may_be_hidden_still) {
  std::vector<TrackHypothesis> two{person(1, 200, 1), person(2, 260, 6)};
  for (TrackHypothesis& b : two) b.touch();
  seen_alone(two[0], 6, 3);
  undo_identity_swaps(two);
  ck_assert(exchanged(two));
}
END_TEST

START_TEST(who_is_unconfirmed_or_away_takes_part_in_nothing) {
  auto one = swapped(), two = swapped();
  one[1].state = TrackHypothesis::State::tentative;
  two[1].state = TrackHypothesis::State::off_screen;
  undo_identity_swaps(one);
  undo_identity_swaps(two);
  ck_assert_uint_eq(one[0].id, 1);
  ck_assert_uint_eq(two[0].id, 1);
}
END_TEST

// Two who have never been close, and each looks as the other did: one came into the sun, the other into the shade.
START_TEST(who_was_never_close_to_anybody_keeps_the_identity) {
  std::vector<TrackHypothesis> two{person(1, 200, 1), person(2, 260, 6)};
  seen_alone(two[0], 6, 4);
  seen_alone(two[1], 1, 4);
  ck_assert(two[0].is_ambiguous() && two[1].is_ambiguous());
  undo_identity_swaps(two);
  ck_assert_uint_eq(two[0].id, 1);
}
END_TEST

// Half a second after somebody else was close a look is learnt again, not before; one that is another now, only after
// four.
START_TEST(a_look_is_not_learnt_while_it_may_be_somebody_else) {
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
    if (k < 4) ck_assert_double_eq(appearance_distance(b.appearance.model, looks(1)), 0);
  }
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
      "identities",
      {two_who_look_like_each_other_since_they_were_close_get_their_identities_back,
       who_looks_as_before_stays_who_he_is, two_frames_tell_nothing_yet,
       who_is_too_far_away_was_not_mixed_up_with_anybody, one_of_them_may_be_hidden_still,
       who_is_unconfirmed_or_away_takes_part_in_nothing, who_was_never_close_to_anybody_keeps_the_identity,
       a_look_is_not_learnt_while_it_may_be_somebody_else, settling_allocates_nothing});
}
