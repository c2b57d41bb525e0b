// SPDX-License-Identifier: LGPL-2.1-or-later
// The rules of a track's life, each on both sides of its limit. Expected: by hand from LifeCycle::Parameters, the options'
// defaults (confirm-time .2 s, coast-time 1 s, hold-stopped 30 s, away-time 5 s) and frames of .04 s.
#include "vision/tracking/life_cycle.h"

#include <check.h>

#include <cmath>
#include <functional>
#include <vector>

#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr Size kFrame{640, 480};
constexpr double kSeconds = 0.04;

const CameraOrientation& camera() {
  static const CameraOrientation turned{Lens(1.0, kFrame), 0.5, -0.25};
  return turned;
}

// 40 x 100 pixels, so that S is 100, with its left upper corner there.
TrackHypothesis track_at(double x, double y, TrackLife life) {
  TrackHypothesis t = TrackHypothesis::first_seen({{x, y, 40, 100}, 2000, 0.9, 1});
  t.life = life;
  t.id = std::holds_alternative<Tentative>(life) ? 0 : 1;
  t.age = 10;
  return t;
}

// In the middle of the picture.
TrackHypothesis track(TrackLife life) {
  return track_at(300, 190, life);
}

// Seen for long, then slower until it stood.
TrackHypothesis standing(double x = 300) {
  TrackHypothesis t = track_at(x, 190, Confirmed{});
  t.slow = 0.3;
  t.fit.time = t.fit.longest = 0.5;
  t.travel.most = 0.45;
  t.age = 1.55;
  return t;
}

// The state after a frame in which each track has the region of its match.
TrackHypothesis first_after(std::vector<TrackHypothesis> tracks, bool turning = false,
                            const TrackOptions& options = {}, bool head = false) {
  LifeCycle life;
  life.advance(tracks, {kFrame, kSeconds, turning, camera(), head}, options);
  return tracks[0];
}
TrackPhase after(const std::vector<TrackHypothesis>& tracks, bool turning = false,
                 const TrackOptions& options = {}) {
  return first_after(tracks, turning, options).phase();
}

TrackPhase after(const TrackHypothesis& t) {
  return after(std::vector{t});
}

// With a change.
TrackPhase after(TrackHypothesis t, const std::function<void(TrackHypothesis&)>& change,
                 bool turning = false) {
  change(t);
  return after(std::vector{t}, turning);
}

std::optional<TrackState> published(TrackHypothesis t, const std::function<void(TrackHypothesis&)>& change,
                                    bool turning = false) {
  change(t);
  LifeCycle life;
  life.advance({}, {kFrame, kSeconds, turning, camera()}, {});
  return life.published(t);
}

}  // namespace

START_TEST(a_track_is_confirmed_that_was_seen_often_for_long_enough_and_has_moved) {
  const struct {
    int hits, frames;
    double age, travel;
    bool confirmed;
  } cases[] = {
      {3, 6, 0.2, 0.12, true},    // 3 = .5 x 6
      {3, 7, 0.2, 0.12, false},   // 3 < .5 x 7
      {2, 3, 0.2, 0.12, false},   // too few,
      {2, 3, 0.59, 0.12, false},  //
      {2, 3, 0.61, 0.12, true},   // but for a low frame rate: 3 x .2 s
      {3, 5, 0.19, 0.12, false},  // .99 x .2 s
      {3, 5, 0.2, 0.11, false},   // it has not moved
  };
  for (const auto& c : cases) {
    TrackHypothesis t = track(Tentative{c.hits, c.frames});
    t.age = c.age;
    t.travel.most = c.travel;
    t.match.region = 0;
    std::vector<TrackHypothesis> tracks{t, t};
    LifeCycle life;
    life.advance(tracks, {kFrame, kSeconds, false, camera()}, {});
    ck_assert_int_eq(tracks[0].is(TrackPhase::confirmed), c.confirmed);
    ck_assert_uint_eq(tracks[0].id, c.confirmed ? 1 : 0);
    ck_assert_uint_eq(tracks[1].id, c.confirmed ? 2 : 0);
  }
  TrackHypothesis first = track(Tentative{});
  first.age = 0;
  first.match.region = 0;
  ck_assert(after({first}, false, {.confirm_time = 0}) == TrackPhase::confirmed);
}
END_TEST

START_TEST(a_tentative_track_is_lost_that_mostly_had_no_region_and_has_none_for_long) {
  const auto unseen = [](int hits, double before) {
    return after(track(Tentative{hits, 4}), [&](TrackHypothesis& t) { t.unseen = before; });
  };
  ck_assert(unseen(1, 0.09) == TrackPhase::lost);       // .13 s > .5 x .2 s, 1 < .5 x 4
  ck_assert(unseen(1, 0.05) == TrackPhase::tentative);  // .09 s
  ck_assert(unseen(2, 0.09) == TrackPhase::tentative);
}
END_TEST

START_TEST(a_track_without_region_is_coasted_and_lost_after_its_time) {
  const auto coasted = [](double seen, double before, double x = 300) {
    TrackHypothesis t = track_at(x, 190, Confirmed{});
    t.unseen = before;
    t.age = seen + before + kSeconds;
    return after(t);
  };
  ck_assert(coasted(9, 0) == TrackPhase::coasted);
  ck_assert(coasted(9, 0.95) == TrackPhase::coasted);  // .99 s
  ck_assert(coasted(9, 0.97) == TrackPhase::lost);     // 1.01 s
  ck_assert(coasted(0.8, 0.27) == TrackPhase::coasted);
  ck_assert(coasted(0.8, 0.29) == TrackPhase::lost);  // .33 s, .4 of .8
  ck_assert(coasted(9, 0.35, 5) == TrackPhase::coasted);
  ck_assert(coasted(9, 0.37, 5) == TrackPhase::lost);  // at the edge, up to .1 S: .4 of it
  ck_assert(coasted(9, 0.37, 11) == TrackPhase::coasted);
  ck_assert(coasted(9, 0, -19) == TrackPhase::coasted);
  ck_assert(coasted(9, 0, -21) == TrackPhase::lost);  // its centre is outside
}
END_TEST

START_TEST(a_track_stops_that_came_and_stood_before_it_had_no_region) {
  ck_assert(after(standing()) == TrackPhase::stopped);
  const std::function<void(TrackHypothesis&)> lacks[] = {
      [](TrackHypothesis& t) { t.slow = 0.29; },          [](TrackHypothesis& t) { t.fit.time = 0.49; },
      [](TrackHypothesis& t) { t.travel.most = 0.44; },   [](TrackHypothesis& t) { t.age = 1.53; },
      [](TrackHypothesis& t) { t.uncut.leaving = true; },
  };
  for (const auto& lack : lacks) ck_assert(after(standing(), lack) == TrackPhase::coasted);
  TrackHypothesis stops = standing();
  stops.x.velocity = 3;
  LifeCycle::stop(stops);
  ck_assert_double_eq(stops.speed(), 0);
}
END_TEST

START_TEST(a_track_behind_another_one_does_not_stop) {
  TrackHypothesis other = track_at(331, 190, Confirmed{});  // covers 9 of 40 columns
  other.match.region = 0;
  ck_assert(after(std::vector{standing(), other}) == TrackPhase::coasted);
  other.match.region = -1;  // where it is is not seen
  ck_assert(after(std::vector{standing(), other}) == TrackPhase::stopped);
  other = track_at(333, 190, Confirmed{});  // 7 of 40
  other.match.region = 0;
  ck_assert(after(std::vector{standing(), other}) == TrackPhase::stopped);
}
END_TEST

START_TEST(a_track_does_not_stop_where_its_place_looks_as_before_it_came) {
  for (const double x : {5.0, 300.0})
    for (const bool left : {false, true})
      ck_assert(after(standing(x), [left](TrackHypothesis& t) { t.left = left; }) ==
                (left ? TrackPhase::coasted : TrackPhase::stopped));
}
END_TEST

START_TEST(a_stopped_track_is_lost_after_hold_stopped_or_where_it_has_left_its_place) {
  const auto stopped = [](double x, double before, double absent, bool left) {
    return after(track_at(x, 190, Stopped{absent}), [&](TrackHypothesis& t) {
      t.age = 50;
      t.unseen = before;
      t.left = left;
    });
  };
  ck_assert(stopped(300, 29.95, 0, false) == TrackPhase::stopped);
  ck_assert(stopped(300, 29.97, 0, false) == TrackPhase::lost);
  for (const double x : {5.0, 300.0}) {
    ck_assert(stopped(x, 1, 0.35, true) == TrackPhase::stopped);  // .39 s of .4 x 1 s
    ck_assert(stopped(x, 1, 0.37, true) == TrackPhase::lost);
    ck_assert(stopped(x, 1, 0.37, false) == TrackPhase::stopped);
  }
  ck_assert(stopped(-21, 1, 0, false) == TrackPhase::lost);
  TrackHypothesis other = track_at(5, 190, Confirmed{});
  other.match.region = 0;
  TrackHypothesis behind = track_at(5, 190, Stopped{0.37});
  behind.left = true;
  ck_assert(after(std::vector{behind, other}) == TrackPhase::stopped);
}
END_TEST

START_TEST(a_known_object_from_which_the_camera_turns_away_is_off_screen) {
  const auto gone = [](bool turning, const std::function<void(TrackHypothesis&)>& change) {
    TrackHypothesis t = track_at(-21, 190, Coasted{});
    t.fit.longest = 0.5;
    t.travel.most = 0.45;
    return after(t, change, turning);
  };
  ck_assert(gone(true, [](TrackHypothesis&) {}) == TrackPhase::off_screen);
  ck_assert(gone(false, [](TrackHypothesis&) {}) == TrackPhase::lost);
  ck_assert(gone(true, [](TrackHypothesis& t) { t.fit.longest = 0.49; }) == TrackPhase::lost);
  ck_assert(gone(true, [](TrackHypothesis& t) { t.travel.most = 0.44; }) == TrackPhase::lost);
  ck_assert(gone(true, [](TrackHypothesis& t) { t.unseen = 4.95; }) == TrackPhase::off_screen);
  ck_assert(gone(true, [](TrackHypothesis& t) { t.unseen = 4.97; }) == TrackPhase::lost);
  // Nor in the middle of the picture, where something else hides it.
  const auto hidden = [](TrackHypothesis& t) {
    t.x.position = 320;
    t.unseen = 1;
  };
  ck_assert(gone(true, hidden) == TrackPhase::lost);
}
END_TEST

START_TEST(a_known_object_that_walks_out_of_the_picture_of_a_head_is_off_screen) {
  TrackHypothesis t = track_at(-21, 190, Coasted{});
  t.fit.longest = 0.5;
  t.travel.most = 0.45;
  const TrackHypothesis gone = first_after({t}, false, {}, true);
  ck_assert(gone.walked_out());
  ck_assert_double_eq(gone.speed(), 0);
  // Where the camera turns it may be where it was.
  const TrackHypothesis left = first_after({t}, true, {}, true);
  ck_assert(left.is(TrackPhase::off_screen) && !left.walked_out());
  t.travel.most = 0.44;
  ck_assert(first_after({t}, false, {}, true).is(TrackPhase::lost));
}
END_TEST

START_TEST(a_track_that_leaves_keeps_its_direction_and_what_was_not_cut) {
  for (const bool stopped : {false, true}) {
    TrackHypothesis t = track(stopped ? TrackLife(Stopped{}) : TrackLife(Coasted{}));
    t.x.velocity = 5;
    t.uncut = {88, 220, 44, 110, {30, -12}, true};  // as large as a group, once
    t.x.pv = t.x.vv = 1e6;
    t.fit.misfit = 1;
    LifeCycle::leave(t, camera());
    const OffScreen& away = std::get<OffScreen>(t.life);
    // (320, 240) is on the camera's axis.
    ck_assert_double_eq_tol(away.direction.bearing, 0.5, 1e-9);
    ck_assert_double_eq_tol(away.direction.elevation, -0.25, 1e-9);
    ck_assert_double_eq_tol(away.magnification, 1, 1e-9);
    ck_assert_int_eq(away.stopped, stopped);
    ck_assert_double_eq(t.x.velocity, stopped ? 0 : 30);
    ck_assert_double_eq(t.y.velocity, stopped ? 0 : -12);
    ck_assert_double_eq_tol(t.width(), 44, 1e-9);
    ck_assert_double_eq_tol(t.height(), 110, 1e-9);
    ck_assert_double_eq(t.fit.misfit, 0);
    // S is 110: of .3 S/s.
    ck_assert_double_eq_tol(t.x.vv, 33 * 33, 1e-9);
    ck_assert_double_eq(t.x.pv, 0);
  }
  // Never seen whole, it has the largest extent so far.
  TrackHypothesis t = track(Coasted{});
  t.uncut = {88, 220, 0, 0, {30, -12}, true};
  LifeCycle::leave(t, camera());
  ck_assert_double_eq_tol(t.width(), 88, 1e-9);
}
END_TEST

START_TEST(a_stopped_track_whose_place_is_in_view_again_is_whole_there) {
  TrackHypothesis t = track(OffScreen{{}, 1, true, true, 0});
  LifeCycle::resume_stop(t);
  ck_assert_double_eq(t.uncut.whole_width, t.width());
  ck_assert_double_eq(t.uncut.whole_height, t.height());
}
END_TEST

START_TEST(a_track_that_comes_back_is_what_it_was_and_takes_the_place_of_its_region) {
  for (const bool stopped : {false, true}) {
    TrackHypothesis t = track(OffScreen{{}, 1, true, stopped, 0});
    LifeCycle::come_back(t, {100, 50, 30, 80});
    ck_assert(t.is(stopped ? TrackPhase::stopped : TrackPhase::coasted));
    ck_assert_double_eq_tol(t.box().x, 100, 1e-9);
    ck_assert_double_eq_tol(t.box().bottom(), 130, 1e-9);
    // He is 40 x 100, whatever of him is seen.
    ck_assert_double_eq_tol(t.uncut.whole_width, 40, 1e-9);
    ck_assert_double_eq_tol(t.uncut.whole_height, 100, 1e-9);
    LifeCycle::see(t);
    ck_assert(t.is(TrackPhase::confirmed));
  }
}
END_TEST

START_TEST(an_off_screen_track_is_lost_after_its_time_or_where_it_is_expected) {
  const auto away = [](bool stopped, double x, double before, double absent) {
    return after(track_at(x, 190, OffScreen{{}, 1, true, stopped, absent}),
                 [&](TrackHypothesis& t) { t.unseen = before; });
  };
  ck_assert(away(false, -50, 4.95, 0) == TrackPhase::off_screen);
  ck_assert(away(false, -50, 4.97, 0) == TrackPhase::lost);
  ck_assert(away(true, -50, 29.95, 0) == TrackPhase::off_screen);
  ck_assert(away(true, -50, 29.97, 0) == TrackPhase::lost);
  ck_assert(away(false, 300, 2, 0.95) == TrackPhase::off_screen);
  ck_assert(away(false, 300, 2, 0.97) == TrackPhase::lost);       // expected for 1.01 s
  ck_assert(away(false, -1, 2, 0.97) == TrackPhase::off_screen);  // not all of it is
  ck_assert(away(true, 300, 2, 0) == TrackPhase::stopped);        // nothing moves at its place
  const auto outside = [](double before) {
    return after(track_at(-50, 190, OffScreen{{}, 1, true, false, 0, true}),
                 [&](TrackHypothesis& t) { t.unseen = before; });
  };
  ck_assert(outside(29.95) == TrackPhase::off_screen);
  ck_assert(outside(29.97) == TrackPhase::lost);
  TrackHypothesis behind_the_camera = track(OffScreen{{}, 1, false, false, 0.97});
  ck_assert(after(behind_the_camera) == TrackPhase::off_screen);
}
END_TEST

START_TEST(tracks_in_view_are_published_while_their_place_is_certain) {
  const auto as_it_is = [](TrackHypothesis&) {};
  ck_assert(!published(track(Tentative{}), as_it_is));
  ck_assert(!published(track(OffScreen{}), as_it_is));
  ck_assert(!published(track(Lost{}), as_it_is));
  ck_assert(published(track(Confirmed{}), as_it_is) == TrackState::seen);
  ck_assert(published(track(Stopped{}), as_it_is) == TrackState::stopped);
  ck_assert(published(track(Coasted{}), as_it_is) == TrackState::coasted);
  const auto coasted = [](const std::function<void(TrackHypothesis&)>& change) {
    return published(track(Coasted{}), change).has_value();
  };
  ck_assert(coasted([](TrackHypothesis& t) { t.x.pp = 15.9 * 15.9; }));  // .4 x 40
  ck_assert(!coasted([](TrackHypothesis& t) { t.kind = RegionKind::part; }));
  ck_assert(!coasted([](TrackHypothesis& t) { t.x.pp = 16.1 * 16.1; }));
  ck_assert(coasted([](TrackHypothesis& t) { t.x.position = 31; }));
  ck_assert(!coasted([](TrackHypothesis& t) { t.x.position = 29; }));  // its box begins in .1 S
  const auto at_edge = [](double left, double right, double largest) {
    return published(track(Confirmed{}), [=](TrackHypothesis& t) {
      t.x.position = (left + right) / 2;
      t.w.value = std::log(right - left);
      t.uncut.height = largest;
    });
  };
  ck_assert(at_edge(0, 21, 100) && at_edge(619, 640, 100));
  ck_assert(!at_edge(0, 19, 100) && !at_edge(621, 640, 100));  // less than .2 x 100
  ck_assert(at_edge(7, 24, 100));                              // not cut by the edge: beyond .01 x 640
  ck_assert(!at_edge(0, 21, 110));                             // it was higher before
  TrackHypothesis sliver = track(Confirmed{});
  sliver.x.position = 8;
  sliver.w.value = std::log(16);
  ck_assert(!published(sliver, as_it_is));
  ck_assert(published(sliver, as_it_is, true));  // before a camera that turns it may be coming in
  TrackHypothesis piece = track(Confirmed{});  // of a person, at the same edge, though as wide as a whole one
  piece.kind = RegionKind::part;
  ck_assert(published(piece, as_it_is));
  piece.x.position = piece.width() / 2;
  ck_assert(!published(piece, as_it_is));
  ck_assert(published(piece, as_it_is, true));
  for (const TrackLife& life : {TrackLife(Confirmed{}), TrackLife(Coasted{}), TrackLife(Stopped{})}) {
    const auto shared = [&](bool occluded, double unlocated) {
      return published(track(life),
                       [&](TrackHypothesis& t) {
                         t.match.occluded = occluded;
                         t.shared.unlocated = unlocated;
                       })
          .has_value();
    };
    ck_assert(shared(true, 0.29));
    ck_assert(!shared(true, 0.31));
    ck_assert(shared(false, 2.9));
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "life_cycle",
      {a_track_is_confirmed_that_was_seen_often_for_long_enough_and_has_moved,
       a_tentative_track_is_lost_that_mostly_had_no_region_and_has_none_for_long,
       a_track_without_region_is_coasted_and_lost_after_its_time,
       a_track_stops_that_came_and_stood_before_it_had_no_region, a_track_behind_another_one_does_not_stop,
       a_track_does_not_stop_where_its_place_looks_as_before_it_came,
       a_stopped_track_is_lost_after_hold_stopped_or_where_it_has_left_its_place,
       a_known_object_from_which_the_camera_turns_away_is_off_screen,
       a_known_object_that_walks_out_of_the_picture_of_a_head_is_off_screen,
       a_track_that_leaves_keeps_its_direction_and_what_was_not_cut,
       a_stopped_track_whose_place_is_in_view_again_is_whole_there,
       a_track_that_comes_back_is_what_it_was_and_takes_the_place_of_its_region,
       an_off_screen_track_is_lost_after_its_time_or_where_it_is_expected,
       tracks_in_view_are_published_while_their_place_is_certain});
}
