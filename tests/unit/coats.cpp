// SPDX-License-Identifier: LGPL-2.1-or-later
// Who is who where places alone do not tell: tracks of people whose coats are known.
#include "vision/tracks.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr Size kFrame{320, 240};
constexpr double kWidth = 30, kHeight = 75;

struct Person {
  double x = 0, y = 0;  // centre
  int coat = 0, legs = 0;
  Box box() const { return {x - kWidth / 2, y - kHeight / 2, kWidth, kHeight}; }
};
constexpr int kBlack = 20, kJeans = 80, kGrey = 100, kWhite = 220;

// 10 frames a second of people on a paved place. Who touch each other are one blob, of which nobody knows how many it is.
struct Place {
  Tracker tracker;
  Image<std::uint8_t> luma{kFrame}, mask{kFrame};
  double gain = 1;
  double shift = 0;     // of the camera, so far
  bool looking = true;  // the tracker is given the picture
  std::vector<Track> tracks;

  // The first is drawn last: it stands in front.
  std::span<const Track> step(const std::vector<Person>& people, double pan = 0,
                              std::optional<std::vector<Region>> told = {}) {
    shift += pan;
    for (int y = 0; y < kFrame.height; ++y)
      for (int x = 0; x < kFrame.width; ++x) {
        const int slab = (static_cast<int>(std::floor((x - shift) / 24)) + y / 24) & 1;
        paint(x, y, 130 + 30 * slab);
      }
    mask.fill_bytes(0);
    for (auto p = people.rbegin(); p != people.rend(); ++p) {
      const Box b = p->box();
      for (int y = std::max(0, static_cast<int>(b.y)); y < std::min<double>(b.bottom(), kFrame.height); ++y)
        for (int x = std::max(0, static_cast<int>(b.x)); x < std::min<double>(b.right(), kFrame.width); ++x) {
          paint(x, y, y < p->y ? p->coat : p->legs);
          mask.view().at(x, y) = 255;
        }
    }
    const std::vector<Region> regions = told ? *told : blobs(people);
    const Sight sight = looking ? Sight{luma.view(), mask.view()} : Sight{};
    const auto found = tracker.update(regions, pan != 0 ? Transform::translation(pan, 0) : Transform{}, 0.1,
                                      kFrame, {}, sight);
    tracks.assign(found.begin(), found.end());
    return tracks;
  }
  // The track at a place; 0: none.
  std::uint32_t at(double x) const {
    for (const Track& t : tracks)
      if (std::abs(t.box.x + t.box.width / 2 - x) < 12 && t.state == TrackState::seen) return t.id;
    return 0;
  }

 private:
  void paint(int x, int y, int grey) {
    luma.view().at(x, y) = static_cast<std::uint8_t>(std::min(255.0, grey * gain));
  }
  static std::vector<Region> blobs(const std::vector<Person>& people) {
    std::vector<Region> regions;
    for (const Person& p : people) {
      Box b = p.box();
      const double right = std::min<double>(b.right(), kFrame.width);
      b.x = std::max(b.x, 0.0);
      b.width = right - b.x;
      if (b.width < 4) continue;
      bool joined = false;
      for (Region& r : regions) {
        if (overlap_area({r.box.x - 4, r.box.y, r.box.width + 8, r.box.height}, b) <= 0) continue;
        const double x1 = std::max(r.box.right(), b.right()), y1 = std::max(r.box.bottom(), b.bottom());
        r.box.x = std::min(r.box.x, b.x);
        r.box.y = std::min(r.box.y, b.y);
        r.box.width = x1 - r.box.x;
        r.box.height = y1 - r.box.y;
        joined = true;
      }
      if (!joined) regions.push_back({b, b.area(), 0.4, 1});
    }
    return regions;
  }
};

// Two come towards each other, meet, stand before each other for a second and a half, and each goes back where he came
// from. Places alone say that they passed. Returns whether each has the identity he had; `dimmed` from their meeting on.
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

START_TEST(two_in_different_coats_who_meet_and_turn_back_keep_their_identities) {
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

START_TEST(two_who_pass_each_other_keep_their_identities_whatever_they_wear) {
  Place one, two, three;
  ck_assert(pass(one, kDark, kLight));
  ck_assert(pass(two, kLight, kDark));
  ck_assert(pass(three, kDark, kDark));
}
END_TEST

// In equal coats places decide, exactly as they do without the picture.
START_TEST(equal_coats_are_told_apart_by_their_places_alone) {
  Place looking, blind;
  blind.looking = false;
  for (int k = 0; k < 30; ++k) {
    const std::vector<Person> row{{60.0 + 4 * k, 120, kBlack, kBlack}, {100.0 + 4 * k, 120, kBlack, kBlack}};
    std::vector<Region> regions;
    for (const Person& p : row) regions.push_back({p.box(), 1000, 0.4, 1});
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

// Two whole people come out of a second in which nobody was seen, each nearer to the other's place than to his own.
START_TEST(the_look_decides_where_places_would_swap_two_people) {
  for (const bool looking : {true, false}) {
    Place place;
    place.looking = looking;
    Person a{0, 120, 60, 80}, b{0, 120, 74, 97};  // alike, but for less than half a bin
    std::uint32_t left = 0, right = 0;
    for (int k = 0; k < 30; ++k) {
      a.x = k < 20 ? 60 + 4 * k : 168;
      b.x = k < 20 ? 260 - 4 * k : 154;

      std::vector<Region> regions{{a.box(), 1000, 0.9, 1}, {b.box(), 1000, 0.9, 1}};
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

// Someone walks behind somebody who stands: 2.5 s without a region of his own, more than coast-time.
START_TEST(who_was_hidden_behind_somebody_is_the_same_when_he_comes_out) {
  Place place;
  std::uint32_t standing = 0, walking = 0;
  double x = 0;
  for (int k = 0; k < 66; ++k) {
    Person front = kLight, back = kDark;
    front.x = 90 + 2.0 * std::min(k, 25);  // walks to 140 and stands there
    x = back.x = k < 25 ? 290 - 6 * k : k < 44 ? 140 : 140 + 6 * (k - 44);
    std::vector<Region> regions{{front.box(), 1000, 0.9, 1}};
    if (std::abs(front.x - back.x) > 18) regions.push_back({back.box(), 1000, 0.9, 1});
    place.step({front, back}, 0, regions);
    if (k == 15) standing = place.at(front.x), walking = place.at(back.x);
    // Whoever is not seen has no box.
    if (k == 40) ck_assert_uint_eq(place.tracks.size(), 1);
  }
  ck_assert_uint_ne(standing, 0);
  ck_assert_uint_ne(walking, 0);
  ck_assert_uint_eq(place.at(140), standing);
  ck_assert_uint_eq(place.at(x), walking);
}
END_TEST

// But not for ever: who does not come out for three seconds is nobody's ghost before the one who stands there.
START_TEST(who_does_not_come_out_again_leaves_no_ghost) {
  Place place;
  for (int k = 0; k < 90; ++k) {
    Person front = kLight, back = kDark;
    front.x = 90 + 2.0 * std::min(k, 25);
    back.x = k < 25 ? 290 - 6 * k : 140;
    std::vector<Region> regions{{front.box(), 1000, 0.9, 1}};
    if (std::abs(front.x - back.x) > 18) regions.push_back({back.box(), 1000, 0.9, 1});
    place.step({front, back}, 0, regions);
    if (k == 15) ck_assert_uint_eq(place.tracks.size(), 2);
    if (k >= 30) ck_assert_uint_eq(place.tracks.size(), 1);
  }
}
END_TEST

// The pavement beside a pole where somebody vanishes is not the person, however person-like its region.
START_TEST(a_region_that_looks_like_nobody_does_not_take_the_identity) {
  for (const bool ghost : {true, false}) {
    Place place;
    std::uint32_t id = 0;
    for (int k = 0; k < 26; ++k) {
      Person p = kDark;
      p.x = 60 + 5 * k;
      const bool gone = k >= 20;
      std::vector<Region> regions{{p.box(), 1000, 0.9, 1}};
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

// But who walks into the shade, and is darker there from step to step, stays who he is; and when a cloud comes, too.
START_TEST(who_gets_darker_step_by_step_stays_the_same) {
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

// The camera turns away from somebody, and in his place somebody stands when it comes back.
START_TEST(who_comes_back_in_another_coat_is_somebody_else) {
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
    for (int k = 0; k < 8; ++k) {
      p.x = x += 1;
      place.step({p});
    }
    ck_assert_uint_ne(place.at(x), 0);
    ck_assert(((place.at(x) == id) == (back.coat == kDark.coat)));
  }
}
END_TEST

// One frame in which all are one blob is no reason to take them for pieces of one.
START_TEST(three_who_are_one_blob_for_a_moment_are_three_afterwards) {
  Place place;
  std::vector<std::uint32_t> ids;
  for (int k = 0; k < 30; ++k) {
    std::vector<Person> people{kDark, kLight, kMiddle};
    std::vector<Region> regions;
    for (int i = 0; i < 3; ++i) {
      people[i].x = 50 + 90 * i + 2 * k;
      regions.push_back({people[i].box(), 1000, 0.4, 1});
    }
    if (k == 8) regions = {{{40, 20, 270, 200}, 9000, 0.2, 1}};
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

START_TEST(looking_allocates_nothing) {
  Place place;
  turn_back(place, kDark, kLight);
  const std::vector<Region> regions{{{125, 80, 55, 80}, 1000, 0.4, 1}};
  const Sight sight{place.luma.view(), place.mask.view()};
  const std::size_t before = cerberus::tests::allocations();
  for (int k = 0; k < 10; ++k) place.tracker.update(regions, {}, 0.1, kFrame, {}, sight);
  ck_assert_uint_eq(cerberus::tests::allocations(), before);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "coats",
      {two_in_different_coats_who_meet_and_turn_back_keep_their_identities,
       a_step_of_exposure_while_they_stand_together_changes_nothing,
       two_who_pass_each_other_keep_their_identities_whatever_they_wear,
       equal_coats_are_told_apart_by_their_places_alone, the_look_decides_where_places_would_swap_two_people,
       who_was_hidden_behind_somebody_is_the_same_when_he_comes_out,
       who_does_not_come_out_again_leaves_no_ghost,
       a_region_that_looks_like_nobody_does_not_take_the_identity,
       who_gets_darker_step_by_step_stays_the_same, who_comes_back_in_another_coat_is_somebody_else,
       three_who_are_one_blob_for_a_moment_are_three_afterwards, looking_allocates_nothing});
}
