// SPDX-License-Identifier: LGPL-2.1-or-later
// A person who stands until the background model has absorbed him: what is seen of him gets less, the picture of his
// place does not change. And the hole that he leaves there when he goes.
#include "unit/place.h"

#include <check.h>

#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr double kTop = kHeight / 2 - 1;  // the head at the picture's edge
constexpr Person kMan{0, kTop, kBlack, kJeans};

Region piece(double x, double y, double width, double height) {
  return {{x, y, width, height}, 0.6 * width * height, 0.35, 1, RegionKind::part};
}

// The upper share of a person at the top edge.
std::vector<Region> upper(const Person& p, double share) {
  return {piece(p.x - kWidth / 2, 0, kWidth, share * (p.y + kHeight / 2))};
}

// Walks in along the top edge, stands two seconds, and is seen from frame 44 on less and less, from the feet up, until
// nothing is seen of him, in `fading` frames.
constexpr int kStands = 24, kFades = 44;
struct Standing {
  Place place;
  Person man = kMan;
  std::uint32_t id = 0;

  explicit Standing(int fading = 8) {
    for (int k = 0; k < kFades + fading; ++k) {
      man.x = 40 + 5.0 * std::min(k, kStands);
      if (k < kFades)
        place.step({man});
      else
        see(upper(man, 0.95 - 0.8 * (k - kFades) / fading));
      if (k == 20) id = place.at(man.x);
    }
    ck_assert_uint_ne(id, 0);
  }
  // He is there, and this is what is seen of him.
  void see(const std::vector<Region>& regions) { place.step({man}, 0, regions); }
  void is_all_there() const {
    ck_assert_uint_eq(place.tracks.size(), 1);
    const Track& t = place.tracks[0];
    ck_assert_uint_eq(t.id, id);
    ck_assert_double_eq_tol(t.box.x + t.box.width / 2, man.x, 4);
    ck_assert_double_gt(t.box.height, 0.85 * (man.y + kHeight / 2));
    ck_assert_double_lt(t.box.y + t.box.height, man.y + 0.6 * kHeight);
  }
};

}  // namespace

START_TEST(a_person_standing_at_the_edge_and_fading_from_the_feet_keeps_the_whole_box) {
  for (const int fading : {2, 8, 80}) {
    Standing s(fading);
    for (int k = 0; k < 60; ++k) {
      s.see({});
      s.is_all_there();
      ck_assert(s.place.tracks[0].state == TrackState::stopped);
    }
    for (int k = 0; k < 15; ++k) {
      s.man.x += 5;
      s.place.step({s.man});
      if (k > 0) ck_assert_uint_eq(s.place.at(s.man.x), s.id);
    }
  }
}
END_TEST

START_TEST(a_person_passing_in_front_does_not_end_a_stopped_track) {
  Standing s;
  for (int k = 0; k < 80; ++k) {
    const Person other{300 - 4.0 * k, kTop + 6, kWhite, kGrey};
    const bool here = other.x > 20;
    s.place.step(here ? std::vector{other, s.man} : std::vector{s.man}, 0,
                 here ? std::vector{piece(other.x - kWidth / 2, other.y - kHeight / 2, kWidth, kHeight)}
                      : std::vector<Region>{});
  }
  s.is_all_there();
}
END_TEST

START_TEST(a_change_of_exposure_does_not_end_a_stopped_track) {
  Standing s;
  for (int k = 0; k < 60; ++k) {
    s.place.gain = 1 + 0.005 * std::min(k, 30);
    s.see({});
    s.is_all_there();
  }
}
END_TEST

START_TEST(a_stopped_track_at_the_edge_ends_half_a_second_after_its_place_is_empty) {
  Standing s;
  for (int k = 0; k < 20; ++k) s.see({});
  ck_assert_uint_eq(s.place.tracks.size(), 1);
  for (int k = 0; k < 6; ++k) s.place.step({}, 0, std::vector<Region>{});
  ck_assert_uint_eq(s.place.tracks.size(), 0);
}
END_TEST

// He goes out through the edge that he stood at: his feet come up as they do when he fades, and the floor appears.
START_TEST(a_person_who_stood_at_the_edge_and_leaves_is_not_held) {
  for (const double speed : {2.0, 4.0, 8.0}) {  // pixels a frame
    Place place;
    Person man = kMan;
    int unseen = 0;
    for (int k = 0; k < 120; ++k) {
      man.x = 40 + 5.0 * std::min(k, kStands);
      man.y = kTop - speed * std::max(0, k - kFades);
      const bool visible = man.y + kHeight / 2 > 4;
      place.step({man}, 0, visible ? upper(man, 1) : std::vector<Region>{});
      unseen = visible ? 0 : unseen + 1;
      if (unseen > 5) ck_assert_uint_eq(place.tracks.size(), 0);
    }
    ck_assert_int_gt(unseen, 5);
  }
}
END_TEST

// The edge cuts more and more off a person who walks out, so that the visible rest hardly moves.
START_TEST(a_shadow_left_at_the_edge_is_no_stopped_person) {
  for (const double shadow : {292.0, 312.0}) {  // where it ends; as wide as he, or a strip
    Place place;
    Person man{0, 120, kBlack, kJeans};
    const int gone = shadow < 300 ? 34 : 40;
    for (int k = 0; k < 80; ++k) {
      man.x = 190 + 5.0 * k;
      const double from = std::min(man.x - kWidth / 2, shadow);
      std::vector<Region> seen{piece(from, 82, std::min(320 - from, kWidth), kHeight)};
      if (k >= gone) seen.clear();
      place.step({man}, 0, seen);
      if (k >= gone) ck_assert_uint_eq(place.tracks.size(), 0);
    }
  }
}
END_TEST

// He goes behind something, and a piece of fluttering tape takes his track over, too small to be him.
START_TEST(a_remnant_is_no_stopped_person) {
  for (const bool small : {true, false}) {
    Place place;
    Person man{0, 120, kBlack, kJeans};
    bool stopped = false;
    for (int k = 0; k < 90; ++k) {
      man.x = 40 + 5.0 * std::min(k, 30);
      std::vector<Region> seen{piece(man.x - kWidth / 2, 82, kWidth, kHeight)};
      if (k >= 30) seen = {small ? piece(man.x - 5, 110, 10, 12) : piece(man.x - 10, 90, 20, 50)};
      if (k >= 60) seen.clear();
      place.step({man}, 0, seen);
      stopped = stopped || (k >= 60 && !place.tracks.empty() && place.tracks[0].state == TrackState::stopped);
    }
    ck_assert_int_eq(stopped, !small);
  }
}
END_TEST

// What moves of a standing head: its two rims. Side by side, upright, of one size, and touching the edge.
START_TEST(slivers_at_both_sides_of_a_head_at_the_edge_are_not_the_person) {
  Standing s;
  for (int k = 0; k < 40; ++k) {
    std::vector<Region> seen{piece(s.man.x + 6, 0, 5, 20), piece(s.man.x - 12, 2, 5, 18)};
    if (k % 4 == 3) seen.clear();
    s.see(seen);
    s.is_all_there();
  }
}
END_TEST

// An arm moves beside a standing person and gets a track of its own; then the region of both is less than the person.
START_TEST(a_standing_person_does_not_shrink_to_a_fragment_shared_with_an_arm) {
  Standing s;
  for (int k = 0; k < 30; ++k) {
    const double reach = 3.0 * std::min(k, 6);
    std::vector<Region> seen{piece(s.man.x - 30 - reach, 16, 12, 24)};
    if (k > 12 && k < 20) seen = {piece(s.man.x - 48, 14, 60, 28)};
    s.see(seen);
    if (k == 12) ck_assert_uint_eq(s.place.tracks.size(), 2);
    const auto him = std::ranges::find(s.place.tracks, s.id, &Track::id);
    ck_assert(him != s.place.tracks.end());
    ck_assert_double_gt(him->box.height, 60);
  }
  // It comes back before him and walks away with him: his.
  for (int k = 0; k < 12; ++k)
    s.place.step({s.man}, 0, std::vector{piece(s.man.x - 48 + 3.0 * std::min(k, 11), 18, 12, 24)});
  ck_assert_uint_eq(s.place.tracks.size(), 2);
  for (int k = 0; k < 12; ++k) {
    s.man.x += 4;
    s.place.step({s.man});
  }
  ck_assert_uint_eq(s.place.tracks.size(), 1);
  ck_assert_uint_eq(s.place.tracks[0].id, s.id);
}
END_TEST

// Measured where a man had stood for ten seconds: the table behind him gets a region, which the memory takes in from
// one side, then all but a strip.
START_TEST(a_shrinking_hole_has_not_travelled) {
  for (const bool lies : {false, true}) {
    Tracker tracker;
    for (int k = 0; k < 60; ++k) {
      Region hole = piece(394, 67, 120, 168);
      if (k >= 1) hole = piece(394, 67, 103, 168);
      if (k >= 3) hole = piece(446, 156, 41, 79);
      if (k >= 20) hole = piece(446, 190, 41, 45);
      if (lies) hole = piece(hole.box.y, hole.box.x, hole.box.height, hole.box.width);
      ck_assert_uint_eq(tracker.update({&hole, 1}, {}, 0.1, {768, 768}).size(), 0);
    }
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "standing",
      {a_person_standing_at_the_edge_and_fading_from_the_feet_keeps_the_whole_box,
       a_change_of_exposure_does_not_end_a_stopped_track,
       a_person_passing_in_front_does_not_end_a_stopped_track,
       a_stopped_track_at_the_edge_ends_half_a_second_after_its_place_is_empty,
       a_person_who_stood_at_the_edge_and_leaves_is_not_held, a_shadow_left_at_the_edge_is_no_stopped_person,
       a_remnant_is_no_stopped_person, slivers_at_both_sides_of_a_head_at_the_edge_are_not_the_person,
       a_standing_person_does_not_shrink_to_a_fragment_shared_with_an_arm,
       a_shrinking_hole_has_not_travelled});
}
