// SPDX-License-Identifier: LGPL-2.1-or-later
// Identities by appearance where positions are not enough.
#include "unit/place.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

// Two come towards each other, meet, stand before each other for a second and a half, and each goes back where he came
// from. Places alone say that they passed. Returns whether each has the identity he had; `dimmed` from their meeting
// on.
bool turn_back(Place& place, Person a, Person b, double dimmed = 1) {
  std::uint32_t left = 0, right = 0;
  for (int k = 0; k < 70; ++k) {
    const double apart = k < 25 ? 14 + 5.0 * (25 - k) : k < 40 ? 14 : 14 + 5.0 * (k - 40);
    a.x = 160 - apart;
    b.x = 160 + apart;
    if (k == 27) place.gain = dimmed;
    place.step({a, b});
    if (k == 15) left = place.at(a.x), right = place.at(b.x);
    // Each is found in the blob where he stands.
    if (k >= 30 && k < 40)
      for (const Track& t : place.tracks)
        ck_assert_double_eq_tol(t.box.x + t.box.width / 2, t.id == left ? a.x : b.x, 8);
  }
  ck_assert_uint_ne(left, 0);
  ck_assert_uint_ne(right, 0);
  return place.at(a.x) == left && place.at(b.x) == right;
}

// Two pass each other, walking on.
bool pass(Place& place, Person a, Person b) {
  std::uint32_t left = 0, right = 0;
  for (int k = 0; k < 50; ++k) {
    a.x = 40 + 5 * k;
    b.x = 280 - 5 * k;
    place.step({a, b});
    if (k == 12) left = place.at(a.x), right = place.at(b.x);
  }
  ck_assert_uint_ne(left, 0);
  ck_assert_uint_ne(right, 0);
  return place.at(a.x) == left && place.at(b.x) == right;
}

constexpr Person kDark{0, 120, kBlack, kBlack}, kLight{0, 122, kWhite, kJeans},
    kMiddle{0, 122, kGrey, kJeans};

}  // namespace

START_TEST(two_appearances_that_meet_and_turn_back_keep_their_identities) {
  for (const Person& other : {kLight, kMiddle}) {
    Place one, two;
    ck_assert(turn_back(one, kDark, other));
    ck_assert(turn_back(two, other, kDark));
  }
}
END_TEST

START_TEST(a_step_of_exposure_while_they_stand_together_changes_nothing) {
  for (const double gain : {0.6, 1.1}) {
    Place place;
    ck_assert(turn_back(place, kDark, kLight, gain));
  }
}
END_TEST

START_TEST(two_persons_who_pass_keep_their_identities_whatever_their_appearance) {
  Place one, two, three;
  ck_assert(pass(one, kDark, kLight));
  ck_assert(pass(two, kLight, kDark));
  ck_assert(pass(three, kDark, kDark));
}
END_TEST

// In equal coats places decide, exactly as they do without the picture.
START_TEST(equal_appearances_are_associated_by_position_alone) {
  Place looking, blind;
  blind.looking = false;
  for (int k = 0; k < 30; ++k) {
    const std::vector<Person> row{{60.0 + 4 * k, 120, kBlack, kBlack}, {100.0 + 4 * k, 120, kBlack, kBlack}};
    std::vector<Region> regions;
    for (const Person& p : row) regions.push_back({p.box(), 1000, 0.4, 1, RegionKind::part});
    looking.step(row, 0, regions);
    blind.step(row, 0, regions);
    ck_assert_uint_eq(looking.tracks.size(), blind.tracks.size());
    for (std::size_t i = 0; i < looking.tracks.size(); ++i) {
      ck_assert_uint_eq(looking.tracks[i].id, blind.tracks[i].id);
      ck_assert_double_eq(looking.tracks[i].box.x, blind.tracks[i].box.x);
    }
  }
}
END_TEST

// After some frames without regions two person-like regions appear, each nearer to the other's predicted position.
START_TEST(appearance_decides_where_positions_would_swap_two_persons) {
  for (const bool looking : {true, false}) {
    Place place;
    place.looking = looking;
    Person a{0, 120, 60, 80}, b{0, 120, 74, 97};  // alike, but for less than half a bin
    std::uint32_t left = 0, right = 0;
    for (int k = 0; k < 30; ++k) {
      a.x = k < 20 ? 60 + 4 * k : 168;
      b.x = k < 20 ? 260 - 4 * k : 154;

      std::vector<Region> regions{{a.box(), 1000, 0.9, 1, RegionKind::person_like},
                                  {b.box(), 1000, 0.9, 1, RegionKind::person_like}};
      if (k >= 18 && k < 22) regions.clear();
      if (k < 18 || k >= 22)
        place.step({a, b}, 0, regions);
      else
        place.step({}, 0, regions);
      if (k == 15) left = place.at(a.x), right = place.at(b.x);
    }
    ck_assert_uint_ne(left, 0);
    ck_assert_uint_ne(right, 0);
    ck_assert((place.at(168) == left && place.at(154) == right) == looking);
  }
}
END_TEST

// A person walks behind a standing one: 2.5 s without an own region, more than coast-time.
START_TEST(an_occluded_person_keeps_the_identity) {
  Place place;
  std::uint32_t standing = 0, walking = 0;
  double x = 0;
  for (int k = 0; k < 66; ++k) {
    Person front = kLight, back = kDark;
    front.x = 90 + 2.0 * std::min(k, 25);  // walks to 140 and stands there
    x = back.x = k < 25 ? 290 - 6 * k : k < 44 ? 140 : 140 + 6 * (k - 44);
    std::vector<Region> regions{{front.box(), 1000, 0.9, 1, RegionKind::person_like}};
    if (std::abs(front.x - back.x) > 18)
      regions.push_back({back.box(), 1000, 0.9, 1, RegionKind::person_like});
    place.step({front, back}, 0, regions);
    if (k == 15) standing = place.at(front.x), walking = place.at(back.x);
    // A person who is not visible has no box.
    if (k == 40) ck_assert_uint_eq(place.tracks.size(), 1);
  }
  ck_assert_uint_ne(standing, 0);
  ck_assert_uint_ne(walking, 0);
  ck_assert_uint_eq(place.at(140), standing);
  ck_assert_uint_eq(place.at(x), walking);
}
END_TEST

// After three seconds the occluded track ends.
START_TEST(an_occluded_person_who_does_not_reappear_leaves_no_track) {
  Place place;
  for (int k = 0; k < 90; ++k) {
    Person front = kLight, back = kDark;
    front.x = 90 + 2.0 * std::min(k, 25);
    back.x = k < 25 ? 290 - 6 * k : 140;
    std::vector<Region> regions{{front.box(), 1000, 0.9, 1, RegionKind::person_like}};
    if (std::abs(front.x - back.x) > 18)
      regions.push_back({back.box(), 1000, 0.9, 1, RegionKind::person_like});
    place.step({front, back}, 0, regions);
    if (k == 15) ck_assert_uint_eq(place.tracks.size(), 2);
    if (k >= 30) ck_assert_uint_eq(place.tracks.size(), 1);
  }
}
END_TEST

// Pavement beside a pole where a person vanishes is not the person, however person-like its region.
START_TEST(a_region_of_another_appearance_does_not_take_the_identity) {
  for (const bool ghost : {true, false}) {
    Place place;
    std::uint32_t id = 0;
    for (int k = 0; k < 26; ++k) {
      Person p = kDark;
      p.x = 60 + 5 * k;
      const bool gone = k >= 20;
      std::vector<Region> regions{{p.box(), 1000, 0.9, 1, RegionKind::person_like}};
      std::vector<Person> people{p};
      if (gone) {
        people[0].x = p.x + 4;
        people[0].coat = people[0].legs = ghost ? kWhite : kBlack;
      }
      place.step(people, 0, regions);
      if (k == 15) id = place.at(p.x);
      if (gone) ck_assert((place.at(p.x) == id) == !ghost);
    }
  }
}
END_TEST

// A person who walks into the shade becomes darker from frame to frame; a cloud darkens everything.
START_TEST(a_gradual_change_of_appearance_keeps_the_identity) {
  Place place;
  std::uint32_t id = 0;
  for (int k = 0; k < 50; ++k) {
    Person p = kLight;
    p.x = 40 + 5 * k;
    const double light = std::clamp(1 - 0.15 * (k - 20), 0.3, 1.0);
    p.coat = static_cast<int>(p.coat * light);
    p.legs = static_cast<int>(p.legs * light);
    place.step({p});
    if (k == 10) id = place.at(p.x);
    if (k >= 10) ck_assert_uint_eq(place.at(p.x), id);
  }
  ck_assert_uint_ne(id, 0);
}
END_TEST

// A person walks out of the picture of a head that stands, and one comes in there two seconds later. A coat that is a quarter
// of a bin lighter passes for the same one where the camera turned away, and not here: others come in by that side, too.
START_TEST(who_comes_in_where_a_person_walked_out_is_the_same_only_in_the_same_coat) {
  const Person gone{0, 120, 60, 80};
  for (const Person& back : {gone, Person{0, 120, 68, 91}, kLight}) {
    Place place;
    place.step({}, 2);
    place.step({}, -2);
    Person p = gone;
    for (p.x = 200; p.x < 340; p.x += 4) {
      place.step({p});
      if (p.x == 280) ck_assert_uint_eq(place.at(p.x), 1);
    }
    for (int k = 0; k < 20; ++k) place.step({});
    ck_assert_uint_eq(place.tracks.size(), 0);
    p = back;
    for (p.x = 330; p.x >= 250; p.x -= 4) place.step({p});
    ck_assert_uint_eq(place.at(p.x + 4), back.coat == gone.coat ? 1 : 2);
  }
}
END_TEST

// The camera turns away from a person, and another one stands there when it comes back.
START_TEST(another_appearance_after_off_screen_is_a_new_track) {
  for (const Person& back : {kDark, kLight}) {
    Place place;
    std::uint32_t id = 0;
    double x = 100;
    Person p = kDark;
    for (int k = 0; k < 20; ++k) {
      p.x = x = 60 + 4 * k;
      place.step({p});
    }
    id = place.at(x);
    ck_assert_uint_ne(id, 0);
    for (int k = 0; k < 30; ++k) {
      const double pan = k < 15 ? -16 : 16;
      x += pan + 1;
      p = k < 15 ? kDark : back;
      p.x = x;
      place.step({p}, pan);
      if (k == 14) ck_assert_uint_eq(place.tracks.size(), 0);
    }
    for (int k = 0; k < 16; ++k) {
      p.x = x += 1;
      place.step({p});
    }
    ck_assert_uint_ne(place.at(x), 0);
    ck_assert(((place.at(x) == id) == (back.coat == kDark.coat)));
  }
}
END_TEST

// One frame in which all are one blob is no reason to take them for pieces of one.
START_TEST(three_persons_in_one_blob_for_a_moment_are_three_afterwards) {
  Place place;
  std::vector<std::uint32_t> ids;
  for (int k = 0; k < 30; ++k) {
    std::vector<Person> people{kDark, kLight, kMiddle};
    std::vector<Region> regions;
    for (int i = 0; i < 3; ++i) {
      people[i].x = 50 + 90 * i + 2 * k;
      regions.push_back({people[i].box(), 1000, 0.4, 1, RegionKind::part});
    }
    if (k == 8) regions = {{{40, 20, 270, 200}, 9000, 0.2, 1, RegionKind::part}};
    place.step(people, 0, regions);
    if (k == 7)
      for (const Person& p : people) ids.push_back(place.at(p.x));
    if (k < 7) continue;
    for (int i = 0; i < 3; ++i) {
      ck_assert_uint_ne(ids[i], 0);
      ck_assert_uint_eq(place.at(people[i].x), ids[i]);
    }
  }
}
END_TEST

START_TEST(appearance_allocates_nothing) {
  Place place;
  turn_back(place, kDark, kLight);
  const std::vector<Region> regions{{{125, 80, 55, 80}, 1000, 0.4, 1, RegionKind::part}};
  const Sight sight{place.luma.view(), place.mask.view()};
  const std::size_t before = cerberus::tests::allocations();
  for (int k = 0; k < 10; ++k) place.tracker.update(regions, {}, 0.1, kFrame, {}, sight);
  ck_assert_uint_eq(cerberus::tests::allocations(), before);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "coats",
      {two_appearances_that_meet_and_turn_back_keep_their_identities,
       a_step_of_exposure_while_they_stand_together_changes_nothing,
       two_persons_who_pass_keep_their_identities_whatever_their_appearance,
       equal_appearances_are_associated_by_position_alone,
       appearance_decides_where_positions_would_swap_two_persons, an_occluded_person_keeps_the_identity,
       an_occluded_person_who_does_not_reappear_leaves_no_track,
       a_region_of_another_appearance_does_not_take_the_identity,
       a_gradual_change_of_appearance_keeps_the_identity, another_appearance_after_off_screen_is_a_new_track,
       who_comes_in_where_a_person_walked_out_is_the_same_only_in_the_same_coat,
       three_persons_in_one_blob_for_a_moment_are_three_afterwards, appearance_allocates_nothing});
}
