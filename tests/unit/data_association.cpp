// SPDX-License-Identifier: LGPL-2.1-or-later
// Data association on tracks and regions whose pairs are plain by hand.
#include "vision/tracking/data_association.h"

#include <check.h>

#include <cstdint>
#include <vector>

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr Size kFrame{640, 480};

Region region(double x, double y, double width, double height, double confidence = 0.4) {
  return {{x, y, width, height},
          width * height,
          confidence,
          1,
          confidence < 0.5 ? RegionKind::part : RegionKind::person_like};
}

// A track at this box, seen for `age` seconds.
TrackHypothesis track(const Box& box, const TrackLife& life = Confirmed{}, double age = 2) {
  TrackHypothesis t = TrackHypothesis::first_seen({box, box.area(), 0.9, 1, RegionKind::person_like});
  if (phase_of(life) != TrackPhase::tentative) t.id = 1;
  t.life = life;
  t.age = age;
  for (MovingValue* a : {&t.x, &t.y}) a->pp = a->vv = 1;
  return t;
}

struct Scene {
  std::vector<TrackHypothesis> tracks;
  std::vector<Region> regions;
  DataAssociation association;
  RegionAppearances appearances;

  std::span<const Match> associate(double maximum_speed = 0) {
    appearances.update({}, regions, {}, kFrame);
    association.associate(tracks, regions, appearances, {kFrame, 0.1, maximum_speed});
    return association.matches();
  }
};

}  // namespace

START_TEST(each_track_has_the_region_at_its_place_and_what_is_left_is_new) {
  Scene s{{track({100, 100, 40, 100}), track({300, 100, 40, 100})},
          {region(303, 102, 40, 100), region(500, 100, 40, 100), region(98, 101, 40, 100)},
          {},
          {}};
  const auto matches = s.associate();
  ck_assert_int_eq(matches[0].region, 2);
  ck_assert_int_eq(matches[1].region, 0);
  for (const Match& m : matches) ck_assert(m.sharers == 1 && !m.occluded && !m.reshaped && !m.merged);
  ck_assert(!s.association.is_new(0) && s.association.is_new(1) && !s.association.is_new(2));
}
END_TEST

START_TEST(a_track_in_view_comes_before_a_tentative_one_that_is_nearer) {
  Scene s{{track({100, 100, 40, 100}, Tentative{}), track({108, 100, 40, 100}, Coasted{})},
          {region(100, 100, 40, 100)},
          {},
          {}};
  const auto matches = s.associate();
  ck_assert_int_eq(matches[0].region, -1);
  ck_assert_int_eq(matches[1].region, 0);
}
END_TEST

START_TEST(an_off_screen_track_comes_before_a_tentative_one_and_has_no_region_while_it_is_behind_the_camera) {
  for (const bool in_front : {true, false}) {
    Scene s{{track({100, 100, 40, 100}, Tentative{}), track({108, 100, 40, 100}, OffScreen{})},
            {region(100, 100, 40, 100)},
            {},
            {}};
    std::get<OffScreen>(s.tracks[1].life).in_front = in_front;
    const auto matches = s.associate();
    ck_assert_int_eq(matches[in_front ? 1 : 0].region, 0);
    ck_assert_int_eq(matches[in_front ? 0 : 1].region, -1);
  }
}
END_TEST

// A fragment of neither extent may be anybody's.
START_TEST(a_track_comes_back_as_a_region_of_its_height_or_of_its_width) {
  for (const Box& box : {Box{0, 100, 16, 100}, Box{0, 100, 40, 40}, Box{0, 100, 16, 40}}) {
    for (const bool away : {true, false}) {
      Scene s{{track({0, 100, 40, 100}, away ? TrackLife(OffScreen{}) : TrackLife(Coasted{}))},
              {region(box.x, box.y, box.width, box.height)},
              {},
              {}};
      ck_assert_int_eq(s.associate()[0].region, away && box.area() == 640 ? -1 : 0);
    }
  }
}
END_TEST

// Neither fits well: both cost more than a pair may.
START_TEST(of_two_tracks_that_may_have_come_back_the_nearer_one_has) {
  for (const bool first : {true, false}) {
    Scene s{{track({first ? 80.0 : 150.0, 100, 60, 150}, OffScreen{}),
             track({first ? 150.0 : 80.0, 100, 60, 150}, OffScreen{})},
            {region(0, 130, 20, 110)},
            {},
            {}};
    for (TrackHypothesis& t : s.tracks)
      for (MovingValue* a : {&t.x, &t.y}) a->pp = 100 * 100;
    for (const TrackHypothesis& t : s.tracks) ck_assert_double_gt(t.distance(s.regions[0].box, kFrame), 2);
    const auto matches = s.associate();
    ck_assert_int_eq(matches[first ? 0 : 1].region, 0);
    ck_assert_int_eq(matches[first ? 1 : 0].region, -1);
  }
}
END_TEST

START_TEST(a_fragment_completes_the_region_of_its_track) {
  Scene s{{track({100, 100, 40, 100})}, {region(100, 130, 40, 70), region(110, 100, 20, 20)}, {}, {}};
  ck_assert_int_eq(s.associate()[0].region, 0);
  ck_assert_double_eq(s.regions[0].box.y, 100);
  ck_assert_double_eq(s.regions[0].box.bottom(), 200);
  ck_assert_double_eq(s.regions[0].box.width, 40);
  ck_assert(!s.association.is_new(1));
}
END_TEST

START_TEST(a_person_like_region_is_neither_a_fragment_nor_completed) {
  for (const int whole : {0, 1}) {
    Scene s{{track({100, 100, 40, 100})}, {region(100, 130, 40, 70), region(110, 100, 20, 20)}, {}, {}};
    s.regions[static_cast<std::size_t>(whole)].kind = RegionKind::person_like;
    ck_assert_int_eq(s.associate()[0].region, 0);
    ck_assert_double_eq(s.regions[0].box.y, 130);
    ck_assert(s.association.is_new(1));
  }
}
END_TEST

// A box of 100 x 100 was a group: 40 and 40 columns with a gap of 20, all of its height.
START_TEST(two_upright_regions_side_by_side_are_two_persons_and_not_fragments_of_one) {
  Scene s{{track({100, 100, 100, 100})}, {region(100, 100, 40, 100), region(160, 100, 40, 100)}, {}, {}};
  const Match match = s.associate()[0];
  ck_assert_int_ge(match.region, 0);
  ck_assert(match.reshaped);
  ck_assert(s.association.is_new(match.region == 0 ? 1 : 0));
}
END_TEST

START_TEST(a_track_without_region_shares_the_blob_it_is_expected_in_unless_it_has_stopped) {
  for (const TrackLife& life : {TrackLife(Confirmed{}), TrackLife(Coasted{}), TrackLife(Stopped{})}) {
    Scene s{
        {track({100, 100, 40, 100}), track({150, 100, 40, 100}, life)}, {region(95, 98, 100, 104)}, {}, {}};
    s.tracks[1].id = 2;
    s.tracks[0].x.position = 140;  // the blob's centre is nearer to it
    const auto matches = s.associate();
    const bool shares = phase_of(life) != TrackPhase::stopped;
    ck_assert_int_eq(matches[0].region, 0);
    ck_assert_int_eq(matches[1].region, shares ? 0 : -1);
    ck_assert_int_eq(matches[0].sharers, shares ? 2 : 1);
  }
}
END_TEST

// Head and legs of one person, the legs seen for longer, in the person's own region since .3 s.
START_TEST(fragments_one_above_the_other_merge_into_the_older_one) {
  for (const double shared : {0.25, 0.3}) {
    Scene s{{track({100, 100, 40, 40}, Confirmed{}, 1), track({100, 145, 40, 55})},
            {region(100, 100, 40, 100)},
            {},
            {}};
    s.tracks[0].shared.time = s.tracks[1].shared.time = shared;
    const auto matches = s.associate();
    const bool merges = shared >= 0.3;
    ck_assert_int_eq(matches[0].region, 0);
    ck_assert_int_eq(matches[1].region, 0);
    ck_assert(matches[0].merged == merges && !matches[1].merged);
    ck_assert(matches[1].reshaped == merges);
    ck_assert_int_eq(matches[1].sharers, merges ? 1 : 2);
  }
}
END_TEST

START_TEST(others_are_expected_only_in_a_larger_region_that_holds_half_of_them) {
  const DataAssociation association;
  const std::vector<TrackHypothesis> tracks{track({100, 100, 40, 100}), track({150, 100, 40, 100}),
                                            track({400, 100, 40, 100}), track({150, 100, 40, 100}, Lost{})};
  const auto expected = [&](const Box& box) {
    return association.others_expected(tracks, tracks[0], box, kFrame);
  };
  ck_assert(expected({100, 100, 71, 100}));   // 21 of 40 columns of the second
  ck_assert(!expected({100, 100, 69, 100}));  // 19
  ck_assert(!expected({150, 100, 51, 100}));  // 5100 of 4000 pixels are not 1.3 times as many
  ck_assert(!expected({200, 100, 100, 100}));
}
END_TEST

START_TEST(a_region_is_crowded_where_another_track_covers_a_fifth_of_it) {
  const DataAssociation association;
  std::vector<TrackHypothesis> tracks{track({100, 100, 40, 100}), track({131, 100, 40, 100})};
  const Box box{100, 100, 40, 100};
  ck_assert(association.crowded(tracks, tracks[0], box));  // 9 of 40 columns
  tracks[1].x.position += 2;
  ck_assert(!association.crowded(tracks, tracks[0], box));  // 7
  tracks[1].x.position -= 2;
  tracks[1].life = Tentative{};
  ck_assert(!association.crowded(tracks, tracks[0], box));
}
END_TEST

// Two coats alike on the left, black or white on the right. Each region lies nearer to the one track, but its appearance
// differs by .15 from that of the other one and by .35 from that of this one, whether the camera moves or not.
START_TEST(an_appearance_that_was_learnt_for_long_outweighs_a_place_and_a_new_one_does_not) {
  Image<std::uint8_t> luma(kFrame), mask(kFrame);
  for (int y = 0; y < kFrame.height; ++y)
    for (int x = 0; x < kFrame.width; ++x) {
      const std::uint8_t coat = x < kFrame.width / 2 ? 20 : 230;
      luma.view().row(y)[x] = x / 20 % 2 == 0 ? 90 : coat;
      mask.view().row(y)[x] = 255;
    }
  Scene s;
  s.regions = {region(280, 100, 40, 100, 0.9), region(320, 100, 40, 100, 0.9)};
  s.appearances.update({luma.view(), mask.view()}, s.regions, {}, kFrame);
  for (const bool is_left : {true, false}) {
    TrackHypothesis t = track({is_left ? 290.0 : 310.0, 100, 40, 100});
    t.appearance.model = s.appearances.of(is_left ? 1 : 0);
    t.appearance.model.learn(s.appearances.of(is_left ? 0 : 1), 0.3);
    t.appearance.frames = 10;
    s.tracks.push_back(t);
  }
  const auto exchanged = [&s](double learnt, bool camera_moved) {
    for (TrackHypothesis& t : s.tracks) {
      t.appearance.learnt = learnt;
      t.camera_moved = camera_moved;
    }
    s.association.associate(s.tracks, s.regions, s.appearances, {kFrame, 0.1, 0});
    const auto matches = s.association.matches();
    ck_assert_int_eq(matches[0].region + matches[1].region, 1);
    return matches[0].region == 1;
  };
  for (const bool camera_moved : {false, true}) {
    ck_assert(!exchanged(1, camera_moved));
    ck_assert(exchanged(20, camera_moved));
  }
}
END_TEST

// Its frame is the second one since it was first seen; 2 S are 80 pixels.
START_TEST(an_object_that_leaps_is_followed_where_nothing_else_can_be_it) {
  const auto leaps = [](const std::vector<TrackHypothesis>& tracks, const std::vector<Region>& regions,
                        double maximum_speed = 0) {
    Scene s{tracks, regions, {}, {}};
    const Match match = s.associate(maximum_speed)[0];
    ck_assert_int_eq(match.leapt, match.region >= 0);
    return match.leapt;
  };
  const TrackHypothesis seen_once = track({100, 100, 40, 30}, Tentative{1, 2});
  ck_assert(leaps({seen_once}, {region(175, 100, 40, 30)}));
  ck_assert(!leaps({seen_once}, {region(185, 100, 40, 30)}));
  ck_assert(!leaps({seen_once}, {region(175, 100, 70, 30)}));  // another extent
  ck_assert(!leaps({seen_once}, {region(175, 100, 40, 60)}));
  ck_assert(!leaps({seen_once}, {region(175, 100, 40, 30), region(175, 300, 40, 30)}));
  ck_assert(!leaps({seen_once, track({250, 100, 40, 30}, Tentative{1, 2})}, {region(175, 100, 40, 30)}));
  ck_assert(!leaps({track({100, 100, 40, 30}, Tentative{1, 3})}, {region(175, 100, 40, 30)}));
  ck_assert(!leaps({track({100, 100, 40, 30})}, {region(175, 100, 40, 30)}));
  ck_assert(leaps({seen_once}, {region(175, 100, 40, 30)}, 700));  // 75 pixels in .1 s, .15 of 40 are slack
  ck_assert(!leaps({seen_once}, {region(175, 100, 40, 30)}, 650));
}
END_TEST

START_TEST(as_many_pairs_as_reserved_take_no_memory) {
  constexpr std::size_t kTracks = 8, kRegions = 16;
  Scene s;
  for (std::size_t i = 0; i < kTracks; ++i) s.tracks.push_back(track({60.0 * i, 100, 30, 80}));
  for (std::size_t i = 0; i < kRegions; ++i)
    s.regions.push_back(region(60.0 * (i % kTracks), i < kTracks ? 100 : 300, 30, 80));
  s.appearances.update({}, s.regions, {}, kFrame);
  s.association.reserve(kTracks, kRegions);
  const std::size_t bytes = s.association.bytes(), before = cerberus::tests::allocations();
  s.association.associate(s.tracks, s.regions, s.appearances, {kFrame, 0.1, 0});
  ck_assert_uint_eq(cerberus::tests::allocations(), before);
  ck_assert_uint_eq(s.association.bytes(), bytes);
  for (std::size_t i = 0; i < kTracks; ++i)
    ck_assert_int_eq(s.association.matches()[i].region, static_cast<int>(i));
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "data_association",
      {each_track_has_the_region_at_its_place_and_what_is_left_is_new,
       a_track_in_view_comes_before_a_tentative_one_that_is_nearer,
       an_off_screen_track_comes_before_a_tentative_one_and_has_no_region_while_it_is_behind_the_camera,
       a_track_comes_back_as_a_region_of_its_height_or_of_its_width,
       of_two_tracks_that_may_have_come_back_the_nearer_one_has, a_fragment_completes_the_region_of_its_track,
       a_person_like_region_is_neither_a_fragment_nor_completed,
       two_upright_regions_side_by_side_are_two_persons_and_not_fragments_of_one,
       a_track_without_region_shares_the_blob_it_is_expected_in_unless_it_has_stopped,
       fragments_one_above_the_other_merge_into_the_older_one,
       others_are_expected_only_in_a_larger_region_that_holds_half_of_them,
       a_region_is_crowded_where_another_track_covers_a_fifth_of_it,
       an_appearance_that_was_learnt_for_long_outweighs_a_place_and_a_new_one_does_not,
       an_object_that_leaps_is_followed_where_nothing_else_can_be_it,
       as_many_pairs_as_reserved_take_no_memory});
}
