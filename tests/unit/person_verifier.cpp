// SPDX-License-Identifier: LGPL-2.1-or-later
// Persons beside tracks: detections made by hand on pictures of noise, in which patches move.
#include "vision/verification/person_verifier.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "support/allocations.h"
#include "support/suite.h"
#include "vision/verification/hit_merging.h"
#include "vision/verification/look_worker.h"
#include "vision/verification/patch_matching.h"

using namespace cerberus::vision;
using cerberus::tests::allocations;

namespace {

constexpr Size kFrame{640, 480}, kSmall{320, 240};
constexpr double kFloor = 1.7, kCertain = 3.7;

Image<std::uint8_t> noise(Size size, unsigned seed) {
  std::mt19937 random(seed);
  Image<std::uint8_t> image(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) image.view().at(x, y) = static_cast<std::uint8_t>(random());
  return image;
}

// A scene of noise in which the texture of each box stands where the box is.
class Scene {
 public:
  GrayView with(std::initializer_list<Box> boxes) {
    for (int y = 0; y < kSmall.height; ++y)
      std::copy_n(background_.view().row(y), kSmall.width, picture_.view().row(y));
    int n = 0;
    for (const Box& box : boxes) {
      const int left = static_cast<int>(box.x / 2), top = static_cast<int>(box.y / 2);
      for (int y = 0; y < box.height / 2; ++y)
        for (int x = 0; x < box.width / 2; ++x)
          if (left + x >= 0 && left + x < kSmall.width && top + y >= 0 && top + y < kSmall.height)
            picture_.view().at(left + x, top + y) = texture_.view().at(x + 60 * n, y);
      ++n;
    }
    return picture_.view();
  }

 private:
  Image<std::uint8_t> background_ = noise(kSmall, 1), texture_ = noise({320, 240}, 2), picture_{kSmall};
};

struct Rig {
  Scene scene;
  PersonVerifier verifier;
  void frame(std::initializer_list<Box> boxes, std::vector<Candidate> tracks) {
    verifier.update(scene.with(boxes), kFrame, {}, 0.04, tracks);
  }
  void found(const PersonVerifier::Look& look, std::vector<PersonDetection> detections) {
    verifier.apply(look, detections, kFloor, kCertain);
  }
  std::vector<VerifiedRegion> result() {
    const auto all = verifier.result();
    return {all.begin(), all.end()};
  }
};

Box person_at(double x) {
  return {x, 100, 60, 160};
}

}  // namespace

// The texture of the person goes on before the look and after it, hidden by somebody who stands in half of the pictures.
// Where the picture's edge cuts the person, the pictures after the look are followed one by one; where all is grey the
// velocity is 0.
START_TEST(the_first_look_finds_the_velocity_in_the_pictures_around_it) {
  const VerificationParameters numbers;
  for (const double step : {6.0, -6.0, 5.0, 0.0}) {
    Scene scene;
    PictureHistory pictures;
    for (int n = 0; n < 8; ++n) {
      const Box person = person_at(300 + step * n), passer{person.x - 10, 90, 80, 200};
      pictures.add(n == 2 || n == 4 || n == 7 ? scene.with({person, passer}) : scene.with({person}), kFrame,
                   {});
    }
    FollowedPerson person;
    person.begin(person_at(300 + step * 5), 6, pictures, numbers);
    ck_assert_double_eq_tol(person.velocity().x, step, 0.6);
    ck_assert_double_eq_tol(person.velocity().y, 0, 0.6);
  }
  Scene scene;
  Image<std::uint8_t> grey(kSmall);
  PictureHistory moving, plain;
  for (int n = 0; n < 8; ++n) {
    moving.add(scene.with({person_at(560 + 6 * n)}), kFrame, {});
    plain.add(grey.view(), kFrame, {});
  }
  FollowedPerson cut, unseen;
  cut.begin(person_at(590), 6, moving, numbers);
  unseen.begin(person_at(300), 8, plain, numbers);
  ck_assert_double_eq(unseen.velocity().x, 0);
  ck_assert_double_gt(cut.velocity().x, 0.5);  // of the pictures after the look, one by one
}
END_TEST

// Of a patch of 8 x 8 the left half differs by 200, the right half by 10; a shift by more than half of it out of the
// picture leaves too little.
START_TEST(a_pixel_that_differs_much_counts_as_one_that_is_hidden) {
  Image<std::uint8_t> before({32, 32}), now({32, 32});
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) before.view().at(x, y) = 20, now.view().at(x, y) = x < 14 ? 220 : 30;
  const auto difference = patch_difference(before.view(), now.view(), {10, 10, 8, 8}, {0, 0}, 30);
  ck_assert(difference.has_value());
  ck_assert_double_eq_tol(*difference, (30 + 10) / 2.0, 1e-9);
  ck_assert_double_eq_tol(*patch_difference(before.view(), now.view(), {10, 10, 8, 8}, {4, 0}, 30), 10, 1e-9);
  ck_assert(!patch_difference(before.view(), now.view(), {10, 10, 8, 8}, {-15, 0}, 30));
}
END_TEST

START_TEST(the_third_frame_of_a_scene_shows_what_moves) {
  Rig rig;
  for (int n = 0; n < 3; ++n) {
    rig.frame({person_at(300 + 12 * n)}, {});
    ck_assert(rig.verifier.choose().has_value() == (n == 2));
  }
}
END_TEST

START_TEST(hits_of_one_person_become_their_weighted_mean_and_parts_of_it_are_dropped) {
  // Weights score - 1: 2 and 1. The third lies in the first; the fourth stands apart.
  std::vector<PersonDetection> hits{
      {{6, 3, 30, 60}, 2}, {{0, 0, 30, 60}, 3}, {{5, 30, 12, 25}, 2.5}, {{100, 0, 30, 60}, 1.5}};
  std::vector<PersonDetection> other{hits[2], hits[3], hits[0], hits[1]};
  for (auto* each : {&hits, &other}) {
    merge_hits(*each, 1);
    ck_assert_uint_eq(each->size(), 2);
    ck_assert_double_eq_tol((*each)[0].box.x, 2, 1e-9);
    ck_assert_double_eq_tol((*each)[0].box.y, 1, 1e-9);
    ck_assert_double_eq((*each)[0].score, 3);
    ck_assert_double_eq_tol((*each)[1].box.x, 100, 1e-9);
  }
}
END_TEST

START_TEST(a_patch_is_found_where_it_went_and_between_pixels) {
  Scene scene;
  Image<std::uint8_t> before(kSmall);
  const GrayView first = scene.with({{200, 100, 60, 80}});
  for (int y = 0; y < kSmall.height; ++y) std::copy_n(first.row(y), kSmall.width, before.view().row(y));
  const GrayView now = scene.with({{208, 96, 60, 80}});
  const Box patch{104, 54, 20, 30};
  const Point way = match_patch(before.view(), now, patch, {1, 0}, 4);
  ck_assert_double_eq_tol(way.x, 4, 0.2);
  ck_assert_double_eq_tol(way.y, -2, 0.2);
  // What lies outside the picture has no place: the guess holds.
  const Point nowhere = match_patch(before.view(), now, {400, 10, 20, 20}, {1.5, 2}, 3);
  ck_assert_double_eq(nowhere.x, 1.5);
  ck_assert_double_eq(nowhere.y, 2);
}
END_TEST

START_TEST(the_most_doubtful_box_is_looked_at_with_neighbours_that_fit) {
  const VerificationParameters p;
  std::array<LookTarget, 4> targets{{{{300, 100, 40, 90}, 3, 90},
                                     {{350, 105, 40, 80}, 1, 80},
                                     {{20, 900, 40, 90}, 1, 90},
                                     {{500, 100, 9, 12}, 9, 12}}};
  const LookRegions chosen = choose_look(targets, {2000, 1500}, 1, p);
  ck_assert_uint_eq(chosen.count, 1);
  const LookRegion* look = chosen.all.data();
  ck_assert_double_eq_tol(look->scale, p.look_height / 80, 1e-9);  // of the lowest who is looked for
  ck_assert(look->x < 300 && look->x + look->width > 390 && look->y < 100 && look->y + look->height > 195);
  ck_assert(look->width * look->height * look->scale * look->scale <= p.most_area * 1.05);
  ck_assert(look->y + look->height < 900);
  ck_assert_uint_eq(choose_look({}, {2000, 1500}, 1, p).count, 0);
  // A group as wide as the picture is cut to what a look may cost.
  std::array<LookTarget, 1> wide{{{{0, 100, 4000, 90}, 1, 90}}};
  const LookRegion middle = choose_look(wide, {4000, 1500}, 1, p).all[0];
  ck_assert_int_lt(middle.width, 4000);
  ck_assert(middle.width * middle.height * middle.scale * middle.scale <= p.most_area * 1.05);
  // Also a low one, of which whole pixels are a larger share.
  std::array<LookTarget, 1> low{{{{3, 100, 630, 40}, 1, 26}}};
  ck_assert_uint_eq(choose_look(low, {640, 480}, 1, p).count, 1);
  // A further region has what the first one leaves, and is not cut.
  std::array<LookTarget, 2> both{{{{0, 100, 1200, 90}, 2, 90}, {{0, 900, 3900, 200}, 1, 200}}};
  ck_assert_uint_eq(choose_look(both, {4000, 1500}, LookRegions::kMost, p).count, 1);
  std::array<LookTarget, 2> also_small{{{{0, 100, 1800, 90}, 2, 90}, {{0, 900, 12, 30}, 1, 30}}};
  ck_assert_uint_eq(choose_look(also_small, {2000, 1500}, LookRegions::kMost, p).count, 2);
}
END_TEST

START_TEST(somebody_farther_away_is_shown_in_a_region_and_at_a_scale_of_its_own) {
  const VerificationParameters p;
  const std::array<LookTarget, 3> all{
      {{{100, 100, 80, 240}, 2, 240}, {{230, 100, 80, 230}, 2, 230}, {{320, 110, 32, 100}, 1, 100}}};
  auto targets = all;
  const LookRegions look = choose_look(targets, {640, 480}, LookRegions::kMost, p);
  ck_assert_uint_eq(look.count, 2);
  ck_assert_double_eq_tol(look.all[0].scale, p.look_height / 230, 1e-9);
  ck_assert_double_eq_tol(look.all[1].scale, p.look_height / 100, 1e-9);
  ck_assert(look.all[1].x < 320 && look.all[1].x + look.all[1].width > 352);
  double area = 0;
  for (const LookRegion& each : look.chosen()) area += each.width * each.height * each.scale * each.scale;
  ck_assert_double_le(area, p.most_area * 1.01);
  for (const LookTarget& each : targets) ck_assert_double_eq(each.doubt, 0);
  // The small one lies in the first region as well, where it is too small to be seen.
  LookRegions near = look;
  near.count = 1;
  ck_assert(shows(near, all[0].box, 240, p) && shows(near, all[1].box, 230, p));
  ck_assert(!shows(near, all[2].box, 100, p) && shows(look, all[2].box, 100, p));
  // One region where that is all that a detector is to see.
  targets = all;
  ck_assert_uint_eq(choose_look(targets, {640, 480}, 1, p).count, 1);
  ck_assert_double_eq(targets[2].doubt, 1);
  Rig rig;
  for (const std::size_t most : {2, 1, 2}) {  // also where a network was used before
    rig.verifier.reset();
    rig.verifier.set_fits_regions(most == 1);
    rig.frame({all[0].box}, {{.id = 1, .box = all[0].box}, {.id = 2, .box = all[2].box}});
    ck_assert_uint_eq(rig.verifier.choose()->regions.count, most);
  }
}
END_TEST

// Three of different heights: the lowest lies in the region of the highest, and no region is left.
START_TEST(who_was_too_small_in_a_look_comes_first_in_the_next) {
  Rig rig;
  const std::vector<Candidate> tracks{{.id = 1, .box = {100, 100, 80, 240}},
                                      {.id = 2, .box = {230, 100, 32, 100}},
                                      {.id = 3, .box = {185, 110, 14, 40}}};
  rig.frame({}, tracks);
  const auto first = rig.verifier.choose();
  ck_assert_uint_eq(first->regions.count, 2);
  rig.frame({}, tracks);
  ck_assert_double_eq_tol(rig.verifier.choose()->regions.all[0].scale,
                          VerificationParameters{}.look_height / 40, 1e-9);
}
END_TEST

START_TEST(whom_the_frames_edge_cuts_is_shown_once_a_look) {
  Rig rig;
  const Box cut{600, 100, 80, 160};  // half of it
  rig.frame({cut}, {{.id = 1, .box = cut}});
  ck_assert_uint_eq(rig.verifier.choose()->regions.count, 1);
}
END_TEST

START_TEST(a_detection_makes_its_track_a_person_with_the_tracks_identity) {
  Rig rig;
  rig.frame({person_at(200)}, {{.id = 4, .box = person_at(200)}});
  const auto look = rig.verifier.choose();
  ck_assert(look.has_value());
  ck_assert(!rig.result()[0].person);
  // The person walks on while the detector works; the detection is carried along.
  for (int n = 1; n <= 3; ++n)
    rig.frame({person_at(200 + 6 * n)}, {{.id = 4, .box = person_at(200 + 6 * n)}});
  rig.found(*look, {{person_at(202), 3}});
  const auto all = rig.result();
  ck_assert_uint_eq(all.size(), 1);
  ck_assert(all[0].person && all[0].id == 4 && all[0].candidate == 0);
  ck_assert_double_eq_tol(all[0].box.x, 219, 5);
  ck_assert_double_eq_tol(all[0].confidence, 0.5 + 0.5 * (3 - kFloor) / (kCertain - kFloor), 1e-9);
  rig.verifier.set_margins(0.03, 0.02);
  const Box trimmed = rig.result()[0].box, &whole = all[0].box;
  ck_assert_double_eq_tol(trimmed.y, whole.y + 0.03 * whole.height, 1e-9);
  ck_assert_double_eq_tol(trimmed.bottom(), whole.bottom() - 0.02 * whole.height, 1e-9);
}
END_TEST

START_TEST(two_people_in_one_track_are_followed_with_identities_of_their_own) {
  Rig rig;
  const Box both{195, 95, 150, 170};
  const auto track = [&](double by) {
    return std::vector<Candidate>{
        {.id = 9, .box = {both.x + by, both.y, both.width, both.height}, .kind = RegionKind::group}};
  };
  rig.frame({person_at(200), person_at(280)}, track(0));
  const auto look = rig.verifier.choose();
  rig.found(*look, {{person_at(200), 3}, {person_at(280), 2.5}});
  auto all = rig.result();
  ck_assert_uint_eq(all.size(), 2);
  const auto first = all[0].id, second = all[1].id;
  ck_assert(first >= PersonVerifier::kFirstOwn && second >= PersonVerifier::kFirstOwn && first != second);
  for (int n = 1; n <= 10; ++n) rig.frame({person_at(200 + 4 * n), person_at(280 + 4 * n)}, track(4 * n));
  all = rig.result();
  ck_assert_uint_eq(all.size(), 2);
  ck_assert(all[0].id == first && all[1].id == second);
  ck_assert_double_eq_tol(all[0].box.x, 240, 6);
  ck_assert_double_eq_tol(all[1].box.x, 320, 6);
}
END_TEST

namespace {

// Two people with coats of these grey levels stand side by side, `apart` pixels, at two looks; half a second later both are
// `farther` to the right, where the first is nearer to the place of the second. Whose identity has the first one then, 0 or 1;
// -1: of neither? The last look is surer of that one, which tells to whom it gave the detection.
int identity_of_the_first(std::array<int, 2> coats, double apart, double farther) {
  const Image<std::uint8_t> texture = noise(kSmall, 1);
  Image<std::uint8_t> picture(kSmall);
  PersonVerifier verifier;
  const std::vector<Candidate> group{{.id = 9, .box = {180, 95, 150, 170}, .kind = RegionKind::group}};
  std::uint64_t frame = 0;
  const auto look = [&](std::array<double, 2> places, double seconds, std::array<double, 2> scores) {
    for (int y = 0; y < kSmall.height; ++y)
      for (int x = 0; x < kSmall.width; ++x) {
        int grey = texture.view().at(x, y);
        for (int i = 0; i < 2; ++i)
          if (y >= 50 && y < 130 && x >= places[i] / 2 && x < places[i] / 2 + 30) grey = coats[i] + grey % 8;
        picture.view().at(x, y) = static_cast<std::uint8_t>(grey);
      }
    verifier.update(picture.view(), kFrame, {}, seconds, group);
    const PersonVerifier::Look whole{{{{{0, 0, kFrame.width, kFrame.height, 1}}}, 1}, ++frame};
    verifier.apply(
        whole,
        std::vector<PersonDetection>{{person_at(places[0]), scores[0]}, {person_at(places[1]), scores[1]}},
        kFloor, kCertain);
    std::vector<VerifiedRegion> people;
    for (const VerifiedRegion& each : verifier.result())
      if (each.person) people.push_back(each);
    return people;
  };
  look({200, 200 + apart}, 0.04, {2.5, 2.5});
  auto before = look({200, 200 + apart}, 0.04, {2.5, 2.5});
  ck_assert_uint_eq(before.size(), 2);
  std::ranges::sort(before, {}, [](const VerifiedRegion& each) { return each.box.x; });
  const auto surest = std::ranges::max(look({200 + farther, 200 + apart + farther}, 0.5, {kCertain, kFloor}),
                                       {}, &VerifiedRegion::confidence);
  return surest.id == before[0].id ? 0 : surest.id == before[1].id ? 1 : -1;
}

}  // namespace

// Looks at which the one hides 40 % of the other teach nothing of either.
START_TEST(a_detection_goes_to_the_person_whose_appearance_it_has) {
  ck_assert_int_eq(identity_of_the_first({30, 220}, 52, 30), 0);
  ck_assert_int_eq(identity_of_the_first({30, 30}, 52, 30), 1);
  ck_assert_int_eq(identity_of_the_first({30, 220}, 36, 24), 1);
}
END_TEST

START_TEST(a_track_that_persons_cover_in_part_is_a_group) {
  Rig rig;
  const std::vector<Candidate> track{{.id = 9, .box = {100, 95, 400, 170}, .kind = RegionKind::thing}};
  rig.frame({person_at(200)}, track);
  rig.found(*rig.verifier.choose(), {{person_at(200), 3}});
  const auto all = rig.result();
  ck_assert_uint_eq(all.size(), 2);
  ck_assert(all[0].person);
  ck_assert(!all[1].person && all[1].id == 9 && all[1].kind == RegionKind::group);
}
END_TEST

START_TEST(what_looks_like_a_person_where_nothing_moves_is_none_and_what_never_moved_ends) {
  Rig rig;
  const std::vector<Candidate> track{{.id = 2, .box = person_at(200)}};
  rig.frame({person_at(200)}, track);
  rig.found(*rig.verifier.choose(), {{person_at(420), 3}, {{205, 180, 30, 80}, 2}});
  ck_assert_uint_eq(rig.result().size(), 1);
  ck_assert(!rig.result()[0].person);  // elsewhere, and legs
  rig.frame({person_at(200)}, track);  // the same frame is not looked at twice
  rig.found(*rig.verifier.choose(), {{person_at(200), 3}});
  ck_assert(rig.result()[0].person);
  for (int n = 0; n < 20; ++n) rig.frame({}, {});  // .8 s without its track
  ck_assert(rig.result().empty());
}
END_TEST

START_TEST(a_person_whom_looks_do_not_confirm_is_none_any_more) {
  Rig rig;
  const std::vector<Candidate> track{{.id = 2, .box = person_at(200)}};
  rig.frame({person_at(200)}, track);
  rig.found(*rig.verifier.choose(), {{person_at(200), 3}});
  for (int n = 0; n < 8; ++n) {
    rig.frame({person_at(200)}, track);
    const auto look = rig.verifier.choose();
    if (n < 2) ck_assert(rig.result()[0].person || n > 0);
    if (look) rig.found(*look, {});
  }
  ck_assert_uint_eq(rig.result().size(), 1);
  ck_assert(!rig.result()[0].person);
}
END_TEST

START_TEST(a_person_without_a_track_whom_a_look_misses_is_left_out_and_comes_back_with_its_identity) {
  Rig rig;
  const std::vector<Candidate> group{{.id = 9, .box = {195, 95, 150, 170}, .kind = RegionKind::group}};
  const PersonDetection left{person_at(200), 3}, right{person_at(280), 2.5};
  const auto see = [&](std::vector<PersonDetection> found) {
    rig.frame({person_at(200), person_at(280)}, group);
    const auto look = rig.verifier.choose();
    ck_assert(look.has_value());
    rig.found(*look, std::move(found));
    return rig.result();
  };
  see({left, right});
  const auto both = see({left, right});
  ck_assert_uint_eq(both.size(), 2);
  const auto one = see({left});
  ck_assert_uint_eq(std::ranges::count_if(one, &VerifiedRegion::person), 1);
  ck_assert_uint_eq(one[0].id, both[0].id);
  const auto again = see({left, right});
  ck_assert_uint_eq(again.size(), 2);
  ck_assert(again[0].id == both[0].id && again[1].id == both[1].id);
}
END_TEST

START_TEST(a_region_without_identity_keeps_that_of_the_one_before_which_it_overlaps_most) {
  std::uint32_t last = 7;
  const std::vector<Candidate> before{{.id = 3, .box = {0, 0, 100, 100}},
                                      {.id = 5, .box = {300, 0, 100, 100}}};
  // Moved by 20: overlap 80 of 120 columns. The second would be the same one's, which is taken. The third is new.
  std::vector<Candidate> now{{.box = {20, 0, 100, 100}},
                             {.box = {30, 0, 100, 100}},
                             {.box = {600, 0, 50, 50}},
                             {.box = {310, 0, 100, 100}}};
  keep_identities(before, now, last);
  ck_assert_uint_eq(now[0].id, 3);
  ck_assert_uint_eq(now[1].id, 8);
  ck_assert_uint_eq(now[2].id, 9);
  ck_assert_uint_eq(now[3].id, 5);
  ck_assert_uint_eq(last, 9);
  std::vector<Candidate> known{{.id = 4, .box = {0, 0, 100, 100}}, {.box = {0, 0, 100, 100}}};
  keep_identities(before, known, last);
  ck_assert_uint_eq(known[0].id, 4);  // it has one
  ck_assert_uint_eq(known[1].id, 3);
}
END_TEST

START_TEST(following_and_choosing_allocate_nothing) {
  Rig rig;
  std::vector<Candidate> track{{.id = 2, .box = person_at(200)}};
  const std::vector<PersonDetection> strong{{person_at(200), 3}}, weak{{person_at(202), 1.3}};
  std::size_t before = 0;
  for (int n = 0; n < 120; ++n) {
    if (n == 80) before = allocations();
    rig.verifier.update(rig.scene.with({person_at(200)}), kFrame, {}, 0.04, track);
    const auto look = rig.verifier.choose();
    if (look) rig.verifier.apply(*look, n % 2 == 0 ? strong : weak, kFloor, kCertain);
    rig.verifier.result();
  }
  ck_assert_uint_eq(allocations(), before);
}
END_TEST

namespace {

class Scripted : public PersonDetector {
 public:
  std::optional<std::string> detect(const PersonPicture& picture, double scale,
                                    std::vector<PersonDetection>& hits) override {
    if (scale > 9) throw std::runtime_error("too large");
    if (scale > 8) return "The scale is refused.";
    hits.push_back({{0, 0, double(picture.luma.width), double(picture.luma.height)}, scale});
    return std::nullopt;
  }
};

}  // namespace

START_TEST(the_worker_returns_what_its_detector_found_refused_or_threw) {
  const std::vector<std::uint8_t> pixels(30 * 60);
  LookWorker worker;
  worker.start(std::make_unique<Scripted>());
  for (const double scale : {2.0, 3.0}) {
    worker.picture(0).take({.luma = {.data = pixels.data(), .width = 30, .height = 60, .stride = 30}}, 0, 0,
                           {30, 60}, false);
    worker.picture(1).take({.luma = {.data = pixels.data(), .width = 10, .height = 20, .stride = 10}}, 0, 0,
                           {10, 20}, false);
    worker.begin({{{{7, 5, 30, 60, scale}, {100, 90, 10, 20, 1}}}, 2});
    const auto& hits = worker.wait();
    ck_assert_uint_eq(hits.size(), 2);
    ck_assert(!worker.refusal());
    ck_assert_double_eq(hits[0].score, scale);
    ck_assert(hits[0].box.x == 7 && hits[0].box.y == 5 && hits[0].box.height == 60);  // in the frame
    ck_assert(hits[1].score == 1 && hits[1].box.x == 100 && hits[1].box.y == 90 && hits[1].box.height == 20);
  }
  worker.begin({{{{0, 0, 30, 60, 9}, {0, 0, 10, 20, 1}}}, 2});
  worker.wait();
  ck_assert(worker.refusal() == "The scale is refused.");
  worker.begin({{{{0, 0, 30, 60, 10}}}, 1});
  bool thrown = false;
  try {
    worker.wait();
  } catch (const std::runtime_error&) {
    thrown = true;
  }
  ck_assert(thrown);
  worker.begin({{{{0, 0, 30, 60, 1}}}, 1});  // in progress at the end
  worker.stop();
  ck_assert(!worker.is_running());
}
END_TEST

// Where the camera stands, a place that changes is looked at before there is a track. Who walks there is a person at once;
// who only came into sight is one in the second look.
START_TEST(a_person_whom_no_track_shows_is_found_where_the_picture_changes) {
  for (const bool walks : {true, false}) {
    Rig rig;
    std::optional<PersonVerifier::Look> look;
    for (int n = 0; n < 12; ++n) {
      ck_assert(!(look = rig.verifier.choose()));
      rig.frame({}, {});
    }
    const auto at = [&](int n) { return person_at(walks ? 200 + 4 * n : 228); };
    for (int n = walks ? 0 : 5; n < 8; ++n) rig.frame({at(n)}, {});
    look = rig.verifier.choose();
    ck_assert(look.has_value());
    const Box person = person_at(228);
    const LookRegion& region = look->regions.all[0];
    ck_assert(region.x <= person.x && region.x + region.width >= person.right());
    ck_assert(region.y <= person.y && region.y + region.height >= person.bottom());
    rig.found(*look, {{person, 2}, {person_at(450), 3}});  // not certain; nothing changes at the second place
    ck_assert_uint_eq(rig.result().size(), walks ? 1 : 0);
    if (walks) ck_assert_double_eq_tol(rig.result()[0].box.x, 228, 4);
    for (int n = 8; n < (walks ? 12 : 10); ++n) rig.frame({at(n)}, {});
    look = rig.verifier.choose();
    ck_assert(look.has_value());
    rig.found(*look, {{at(walks ? 11 : 9), 2}});
    ck_assert_uint_eq(rig.result().size(), 1);
    ck_assert(rig.result()[0].person && rig.result()[0].candidate == -1);
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "person_verifier",
      {a_pixel_that_differs_much_counts_as_one_that_is_hidden,
       the_third_frame_of_a_scene_shows_what_moves,
       the_first_look_finds_the_velocity_in_the_pictures_around_it,
       hits_of_one_person_become_their_weighted_mean_and_parts_of_it_are_dropped,
       a_patch_is_found_where_it_went_and_between_pixels,
       the_most_doubtful_box_is_looked_at_with_neighbours_that_fit,
       somebody_farther_away_is_shown_in_a_region_and_at_a_scale_of_its_own,
       who_was_too_small_in_a_look_comes_first_in_the_next,
       whom_the_frames_edge_cuts_is_shown_once_a_look,
       a_detection_makes_its_track_a_person_with_the_tracks_identity,
       two_people_in_one_track_are_followed_with_identities_of_their_own,
       a_detection_goes_to_the_person_whose_appearance_it_has,
       a_track_that_persons_cover_in_part_is_a_group,
       what_looks_like_a_person_where_nothing_moves_is_none_and_what_never_moved_ends,
       a_person_whom_looks_do_not_confirm_is_none_any_more,
       a_person_without_a_track_whom_a_look_misses_is_left_out_and_comes_back_with_its_identity,
       a_region_without_identity_keeps_that_of_the_one_before_which_it_overlaps_most,
       following_and_choosing_allocate_nothing,
       the_worker_returns_what_its_detector_found_refused_or_threw,
       a_person_whom_no_track_shows_is_found_where_the_picture_changes});
}
