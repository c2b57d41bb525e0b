// SPDX-License-Identifier: LGPL-2.1-or-later
// Persons between the looks of a detector, and the line of their heights. The pictures are grey: they say nothing, so that
// what is expected follows from the looks alone.
#include "vision/verification/followed_person.h"

#include <algorithm>
#include <vector>

#include "support/suite.h"
#include "vision/verification/height_line.h"
#include "vision/verification/person_verifier.h"

using namespace cerberus::vision;

namespace {

constexpr Size kFrame{640, 480}, kSmall{320, 240};
const VerificationParameters kNumbers;

struct Stream {
  Image<std::uint8_t> grey{kSmall};
  PictureHistory pictures;
  void next(const Transform& motion = {}) { pictures.add(grey.view(), kFrame, motion); }
  void follow(FollowedPerson& person, int frames, const Transform& motion = {}) {
    for (int n = 0; n < frames; ++n) {
      next(motion);
      person.follow(pictures.number(), pictures, kNumbers);
    }
  }
};

Box person_at(double x) {
  return {x, 100, 60, 160};
}

// On a ground whose horizon is row 100, people are .8 times as high as their feet are below it.
Box standing(double foot, double times = 1) {
  const double height = times * 0.8 * (foot - 100);
  return {200, foot - height, height / 3, height};
}

void learn(HeightLine& line) {
  for (const double foot : {250, 280, 310, 340, 370, 400, 430}) line.learn(standing(foot), kNumbers);
}

}  // namespace

START_TEST(two_looks_show_how_fast_a_person_goes) {
  Stream stream;
  stream.next();
  FollowedPerson person;
  person.begin(person_at(100), 1, stream.pictures, kNumbers);
  stream.follow(person, 6);
  ck_assert_double_eq_tol(person.box().x, 100, 1e-9);
  person.correct(person_at(160), 7, stream.pictures, kNumbers);
  ck_assert_double_eq_tol(person.velocity().x, 10, 1e-9);  // 60 pixels in 6 frames
  ck_assert_double_eq_tol(person.box().x, 160, 1e-9);
  stream.follow(person, 6);
  ck_assert_double_eq_tol(person.box().x, 220, 1e-9);
  ck_assert(person.moved());
}
END_TEST

START_TEST(a_look_that_comes_late_counts_from_its_frame) {
  Stream stream;
  stream.next();
  FollowedPerson person;
  person.begin(person_at(100), 1, stream.pictures, kNumbers);
  stream.follow(person, 9);
  // Of frame 7, three frames ago: 160 then, 10 a frame since.
  person.correct(person_at(160), 7, stream.pictures, kNumbers);
  ck_assert_double_eq_tol(person.box().x, 190, 1e-9);
}
END_TEST

START_TEST(the_cameras_own_turning_is_no_velocity_of_the_person) {
  Stream stream;
  stream.next();
  FollowedPerson person;
  person.begin(person_at(100), 1, stream.pictures, kNumbers);
  const Transform turns = Transform::translation(6, 0);
  stream.follow(person, 5, turns);
  ck_assert_double_eq_tol(person.box().x, 130, 1e-6);
  person.correct(person_at(150), 6, stream.pictures, kNumbers);  // 20 of 50 are the person's own
  ck_assert_double_eq_tol(person.velocity().x, 4, 1e-6);
  stream.follow(person, 5);  // the camera stands
  ck_assert_double_eq_tol(person.box().x, 170, 1e-6);
}
END_TEST

// The camera turns by 6 frame pixels a frame, and the person walks 4 of his own; three of the pictures follow the look's, and
// nothing else is known of him.
START_TEST(the_pictures_around_the_first_look_show_how_fast_a_person_goes_while_the_camera_turns) {
  const auto texture = [](int x, int y) {
    return static_cast<std::uint8_t>((static_cast<std::uint32_t>(x * 73 + y * 151) * 2654435761u) >> 24);
  };
  Stream stream;
  const auto left = [](int n) { return 50 + (3 + 2) * n; };  // of the person, in the reduced pictures
  for (int n = 1; n <= 7; ++n) {
    for (int y = 0; y < kSmall.height; ++y)
      for (int x = 0; x < kSmall.width; ++x) {
        const bool person = x >= left(n) && x < left(n) + 30 && y >= 50 && y < 130;
        stream.grey.view().at(x, y) = person ? texture(x - left(n) + 1000, y) : texture(x - 3 * n, y);
      }
    stream.next(Transform::translation(6, 0));
  }
  FollowedPerson person;
  person.begin(person_at(2 * left(4)), 4, stream.pictures, kNumbers);
  ck_assert_double_eq_tol(person.velocity().x, 4, 0.5);
  ck_assert_double_eq_tol(person.velocity().y, 0, 0.5);
  ck_assert_double_eq_tol(person.box().x, 2 * left(7), 1.5);
  ck_assert(person.walks());
}
END_TEST

START_TEST(a_person_whom_the_edge_cuts_does_not_slow_down) {
  Stream stream;
  stream.next();
  FollowedPerson person;
  person.begin(person_at(500), 1, stream.pictures, kNumbers);
  stream.follow(person, 6);
  person.correct(person_at(560), 7, stream.pictures, kNumbers);
  stream.follow(person, 4);  // to 600, of which 40 are in the picture
  person.correct({595, 100, 45, 160}, 11, stream.pictures, kNumbers);
  ck_assert_double_eq_tol(person.velocity().x, 10, 1e-9);
}
END_TEST

START_TEST(heights_are_judged_by_where_the_feet_are) {
  HeightLine line;
  ck_assert(line.judge(standing(300), kNumbers) == HeightLine::Fit::unknown);
  learn(line);
  for (const double foot : {260, 300, 420}) {
    ck_assert(line.judge(standing(foot), kNumbers) == HeightLine::Fit::fits);
    ck_assert(line.judge(standing(foot, 0.6), kNumbers) == HeightLine::Fit::contradicts);
    ck_assert(line.judge(standing(foot, 1.6), kNumbers) == HeightLine::Fit::contradicts);
  }
  // Above the horizon nobody stands, and nothing is known.
  ck_assert(line.judge({200, 20, 20, 60}, kNumbers) == HeightLine::Fit::unknown);
  line.reset();
  ck_assert(line.judge(standing(300), kNumbers) == HeightLine::Fit::unknown);
}
END_TEST

START_TEST(two_wrong_heights_do_not_bend_the_line) {
  HeightLine line;
  learn(line), learn(line);
  line.learn(standing(300, 0.4), kNumbers), line.learn(standing(400, 0.4), kNumbers);
  ck_assert(line.judge(standing(350), kNumbers) == HeightLine::Fit::fits);
  ck_assert(line.judge(standing(350, 0.75), kNumbers) == HeightLine::Fit::contradicts);
}
END_TEST

START_TEST(the_line_tilts_with_the_camera) {
  HeightLine line;
  learn(line);
  line.move(Transform::translation(0, 80));
  Box moved = standing(300);
  ck_assert(line.judge(moved, kNumbers) == HeightLine::Fit::contradicts);
  moved.y += 80;
  ck_assert(line.judge(moved, kNumbers) == HeightLine::Fit::fits);
}
END_TEST

namespace {

// People among a group that never ends, frames of 40 ms.
struct Rig {
  Image<std::uint8_t> grey{kSmall};
  PersonVerifier verifier;
  std::vector<Candidate> tracks{{.id = 9, .box = {20, 90, 600, 200}, .kind = RegionKind::group}};
  void frames(int count) {
    for (int n = 0; n < count; ++n) verifier.update(grey.view(), kFrame, {}, 0.04, tracks);
  }
  void look(std::vector<PersonDetection> found) {
    frames(1);
    const auto look = verifier.choose();
    ck_assert(look.has_value());
    verifier.apply(*look, found, 1.7, 3.7);
  }
  const VerifiedRegion* person() {
    for (const VerifiedRegion& each : verifier.result())
      if (each.person) return &each;
    return nullptr;
  }
};

}  // namespace

START_TEST(who_was_hidden_for_less_than_three_seconds_keeps_the_identity) {
  for (const double seconds : {1.0, 2.5, 3.5}) {
    Rig rig;
    rig.look({{person_at(200), 3}});
    rig.look({{person_at(200), 3}});
    ck_assert_ptr_nonnull(rig.person());
    const auto before = rig.person()->id;
    for (int n = 0; n < 3; ++n) rig.look({});
    ck_assert_ptr_null(rig.person());
    rig.frames(static_cast<int>(seconds / 0.04));
    rig.look({{person_at(200), 3}});
    ck_assert_ptr_nonnull(rig.person());
    ck_assert((rig.person()->id == before) == (seconds < 3));
  }
}
END_TEST

// Three looks in a row have shown the person where the track was, or none has shown the place for .3 s.
START_TEST(a_person_follows_a_whole_track_that_looks_found_right_or_left_out) {
  struct Case {
    int looks, frames;
    bool follows;
  };
  for (const Case& c : {Case{3, 5, false}, {4, 5, true}, {3, 10, true}}) {
    Rig rig;
    rig.tracks = {{.id = 4, .box = person_at(200)}};
    for (int n = 0; n < c.looks; ++n) rig.look({{person_at(200), 3}});
    for (int n = 1; n <= c.frames; ++n) {
      rig.tracks[0].box = person_at(200 + 4 * n);
      rig.frames(1);
    }
    const bool followed = rig.person()->box.x > 208;
    ck_assert(followed == c.follows);
  }
}
END_TEST

// A track of 1.3 times the height may hold somebody else as well.
START_TEST(a_person_does_not_follow_a_track_that_is_not_whole) {
  Rig rig;
  Box track = person_at(200);
  track.height *= 1.3;
  rig.tracks = {{.id = 4, .box = track}};
  for (int n = 0; n < 4; ++n) rig.look({{person_at(200), 3}});
  for (int n = 1; n <= 10; ++n) {
    rig.tracks[0].box.x = 200 + 4 * n;
    rig.frames(1);
  }
  ck_assert_double_lt(rig.person()->box.x, 208);
}
END_TEST

START_TEST(a_weak_detection_does_not_take_the_place_of_a_strong_one) {
  Rig rig;
  for (int n = 0; n < 2; ++n) rig.look({{person_at(200), 3}});
  rig.look({{person_at(228), 3}, {person_at(176), 1.2}});  // IoU .36 and .43
  const auto persons = std::ranges::count_if(rig.verifier.result(), &VerifiedRegion::person);
  ck_assert_int_eq(persons, 1);
  ck_assert_double_gt(rig.person()->box.x, 205);
}
END_TEST

// The surest detection is nearer to the right one of two persons, but a second one fits that person still better.
START_TEST(detections_go_to_the_persons_whom_they_fit_best) {
  Rig rig;
  const auto ids = [&] {
    std::vector<std::uint32_t> all;
    for (const VerifiedRegion& each : rig.verifier.result())
      if (each.person) all.push_back(each.id);
    return all;
  };
  for (int n = 0; n < 2; ++n) rig.look({{person_at(200), 3}, {person_at(248), 3.2}});
  const auto before = ids();
  ck_assert_uint_eq(before.size(), 2);
  rig.look({{person_at(226), 3}, {person_at(254), 2}});
  ck_assert(ids() == before);
}
END_TEST

START_TEST(an_identity_is_published_once) {
  Rig rig;
  rig.tracks = {{.id = 4, .box = person_at(200)}};
  rig.look({{person_at(200), 3}});
  rig.look({{person_at(200), 3}});
  ck_assert_uint_eq(rig.person()->id, 4);
  rig.tracks[0].box = person_at(500);  // the track has gone to somebody else
  rig.frames(1);
  ck_assert_uint_eq(rig.verifier.result().size(), 1);
  ck_assert_uint_eq(rig.person()->id, 4);
  rig.look({});  // the person is left out, but the identity does not jump to somebody else
  ck_assert(rig.verifier.result().empty());
}
END_TEST

START_TEST(a_hit_that_is_not_as_high_as_people_are_is_none) {
  Rig rig;
  for (const double foot : {260, 270, 275, 280, 285, 288, 265}) rig.look({{standing(foot), 3}});
  for (int n = 0; n < 3; ++n) rig.look({});
  ck_assert_ptr_null(rig.person());
  rig.look({{standing(282, 0.6), 3}});
  ck_assert_ptr_null(rig.person());
  rig.look({{standing(282), 1.8}});
  ck_assert_ptr_nonnull(rig.person());
}
END_TEST

START_TEST(other_ground_is_learnt_anew) {
  Rig rig;
  for (const double foot : {260, 270, 275, 280, 285, 288, 265}) rig.look({{standing(foot), 3}});
  int looks = 0;
  for (; looks < 40; ++looks) {
    for (int n = 0; n < 3; ++n) rig.look({});
    rig.look({{standing(260 + looks % 5 * 5, 0.6), 3}});
    if (rig.person()) break;
  }
  ck_assert_int_lt(looks, 20);
}
END_TEST

// Weak: below the threshold of 1.7, down to .65 of it.
START_TEST(a_weak_hit_shows_a_person_who_is_known) {
  for (const double score : {1.2, 0.0}) {
    Rig rig;
    rig.look({{person_at(200), 3}});
    rig.look({{person_at(200), 3}});
    for (int n = 0; n < 4; ++n) score > 0 ? rig.look({{person_at(204), score}}) : rig.look({});
    ck_assert((rig.person() != nullptr) == (score > 0));
  }
}
END_TEST

START_TEST(a_weak_hit_shows_a_new_person_only_where_it_is_as_high_as_people_are_and_in_its_second_look) {
  Rig rig;
  rig.look({{standing(270), 1.2}});
  rig.look({{standing(270), 1.2}});
  ck_assert_ptr_null(rig.person());  // nothing is known of the heights yet
  for (const double foot : {260, 270, 275, 280, 285, 288, 265}) rig.look({{standing(foot), 3}});
  for (int n = 0; n < 3; ++n) rig.look({});
  ck_assert_ptr_null(rig.person());
  rig.tracks.push_back({.id = 4, .box = standing(282)});  // a track of its own does not change that
  rig.look({{standing(282), 1.2}});
  ck_assert_ptr_null(rig.person());
  ck_assert(std::ranges::any_of(rig.verifier.result(), [](const VerifiedRegion& r) { return r.id == 4; }));
  rig.look({{standing(282), 1.2}});
  ck_assert_ptr_nonnull(rig.person());
}
END_TEST

// Two walk by, 6 pixels from look to look; the nearer one's feet are lower. Three looks do not show the other one, and
// more than a second of looks.
START_TEST(who_is_hidden_by_a_nearer_person_is_not_refuted_for_a_second) {
  for (const bool hidden : {true, false}) {
    Rig rig;
    double x = 200;
    const auto behind = [&] { return PersonDetection{{x, 100, 60, 160}, 3}; };
    const auto other = [&] { return PersonDetection{{x + (hidden ? 26 : 100), 110, 80, 210}, 3}; };
    const auto persons = [&] {
      return std::ranges::count_if(rig.verifier.result(), &VerifiedRegion::person);
    };
    for (int n = 0; n < 6; ++n, x += 6) rig.look({behind(), other()});
    ck_assert_int_eq(persons(), 2);
    for (int n = 0; n < 3; ++n, x += 6) rig.look({other()});
    ck_assert_int_eq(persons(), hidden ? 2 : 1);
    for (int n = 0; n < 25; ++n, x += 6) rig.look({other()});
    ck_assert_int_eq(persons(), 1);
    for (int n = 0; n < 6; ++n, x += 6) rig.look({behind(), other()});
    for (int n = 0; n < 2; ++n, x += 6) rig.look({});  // who is not seen hides nobody
    ck_assert_int_eq(persons(), 0);
  }
}
END_TEST

// Farther away, of .57 of the nearer one's height, and as high as people are there: no part of the other.
START_TEST(who_is_small_because_farther_away_is_no_part_of_the_nearer_person) {
  Rig rig;
  for (const double foot : {260, 270, 275, 280, 285, 288, 265, 330, 340, 350})
    rig.look({{standing(foot), 3}});
  for (int n = 0; n < 3; ++n) rig.look({});
  const Box far = standing(240);  // 112 high
  Box near = standing(345);       // 196
  near.x = far.x + far.width * 0.2;
  for (int n = 0; n < 3; ++n) rig.look({{far, 3}});
  const auto persons = [&] { return std::ranges::count_if(rig.verifier.result(), &VerifiedRegion::person); };
  ck_assert_int_eq(persons(), 1);
  for (int n = 0; n < 3; ++n) rig.look({{near, 3}});
  ck_assert_int_eq(persons(), 2);
}
END_TEST

START_TEST(a_part_that_was_taken_for_a_person_ends_when_a_look_shows_the_whole) {
  Rig rig;
  const Box head_and_trunk{205, 105, 45, 100}, whole{200, 100, 70, 190};
  rig.look({{head_and_trunk, 3}});
  rig.look({{head_and_trunk, 3}});
  rig.look({{whole, 3}});
  const auto all = rig.verifier.result();
  ck_assert_int_eq(std::ranges::count_if(all, &VerifiedRegion::person), 1);
  ck_assert_double_gt(rig.person()->box.height, 150);
}
END_TEST

// A wide box of a track beside somebody who is as high as people are there holds more than half of the person.
START_TEST(who_is_as_high_as_people_are_is_no_part_of_a_box_beside) {
  for (const bool within : {false, true}) {
    Rig rig;
    for (const double foot : {260, 270, 275, 280, 285, 288, 265, 330, 340, 350})
      rig.look({{standing(foot), 3}});
    for (int n = 0; n < 3; ++n) rig.look({});
    const Box far = standing(240);  // of .57 of the box's height; .55 of it lies in the box, or .81
    Box wide = standing(345);
    wide.width = 150, wide.x = far.x + (within ? 0 : 0.32 * far.width);
    rig.tracks.push_back({.id = 3, .box = wide});
    rig.look({{far, 3}});
    ck_assert_int_eq(std::ranges::count_if(rig.verifier.result(), &VerifiedRegion::person), within ? 0 : 1);
  }
}
END_TEST

// Before a camera at the height of heads, where a torso is as high as somebody farther away. Every other look shows the torso
// alone.
START_TEST(a_part_of_a_nearer_person_does_not_show_who_is_behind) {
  for (const bool within : {true, false}) {
    Rig rig;
    for (const double foot : {260, 270, 275, 280, 285, 288, 265, 330, 340, 350})
      rig.look({{standing(foot, 1.25), 3}});
    for (int n = 0; n < 3; ++n) rig.look({});
    const Box far = standing(240, 1.25);
    Box near = standing(340, 1.25);
    near.x = far.x + (within ? -10 : 0.45 * far.width);
    for (int n = 0; n < 3; ++n) rig.look({{far, 3}});
    for (int n = 0; n < 3; ++n) rig.look({{near, 3}});
    const auto persons = [&] {
      return std::ranges::count_if(rig.verifier.result(), &VerifiedRegion::person);
    };
    ck_assert_int_eq(persons(), 2);
    for (int n = 0; n < 30; ++n) rig.look({{far, 3}}), rig.look({{near, 3}});
    ck_assert_int_eq(persons(), within ? 1 : 2);
  }
}
END_TEST

// 64 rows of the person are less than the detector sees, and 96 are not; one that fits regions to its own input sees both.
START_TEST(a_look_in_which_a_person_is_too_small_to_be_seen_misses_nobody) {
  for (const double scale : {0.4, 0.6})
    for (const bool fits : {false, true}) {
      Rig rig;
      rig.verifier.set_fits_regions(true);
      rig.verifier.set_fits_regions(fits);
      rig.look({{person_at(200), 3}});
      rig.frames(1);
      auto look = *rig.verifier.choose();
      look.regions = {{{{0, 0, kFrame.width, kFrame.height, scale}}}, 1};
      rig.verifier.apply(look, {}, 1.7, 3.7);
      ck_assert_int_eq(rig.person() != nullptr, scale < 0.5 && !fits);
    }
}
END_TEST

START_TEST(a_detection_of_another_height_does_not_show_the_person) {
  Rig rig;
  rig.look({{Box{200, 90, 70, 190}, 3}});
  rig.look({{Box{200, 90, 70, 190}, 3}});
  const auto id = rig.person()->id;
  for (int n = 0; n < 4; ++n) rig.look({{Box{215, 95, 48, 120}, 3}});  // overlaps by .43 of the union
  for (const VerifiedRegion& each : rig.verifier.result()) ck_assert(!each.person || each.id != id);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "followed_person",
      {two_looks_show_how_fast_a_person_goes,
       a_look_that_comes_late_counts_from_its_frame,
       the_cameras_own_turning_is_no_velocity_of_the_person,
       the_pictures_around_the_first_look_show_how_fast_a_person_goes_while_the_camera_turns,
       a_person_whom_the_edge_cuts_does_not_slow_down,
       heights_are_judged_by_where_the_feet_are,
       two_wrong_heights_do_not_bend_the_line,
       the_line_tilts_with_the_camera,
       who_was_hidden_for_less_than_three_seconds_keeps_the_identity,
       a_person_follows_a_whole_track_that_looks_found_right_or_left_out,
       a_person_does_not_follow_a_track_that_is_not_whole,
       a_weak_detection_does_not_take_the_place_of_a_strong_one,
       detections_go_to_the_persons_whom_they_fit_best,
       an_identity_is_published_once,
       a_hit_that_is_not_as_high_as_people_are_is_none,
       other_ground_is_learnt_anew,
       a_weak_hit_shows_a_person_who_is_known,
       a_weak_hit_shows_a_new_person_only_where_it_is_as_high_as_people_are_and_in_its_second_look,
       who_is_hidden_by_a_nearer_person_is_not_refuted_for_a_second,
       who_is_small_because_farther_away_is_no_part_of_the_nearer_person,
       a_part_that_was_taken_for_a_person_ends_when_a_look_shows_the_whole,
       who_is_as_high_as_people_are_is_no_part_of_a_box_beside,
       a_part_of_a_nearer_person_does_not_show_who_is_behind,
       a_look_in_which_a_person_is_too_small_to_be_seen_misses_nobody,
       a_detection_of_another_height_does_not_show_the_person});
}
