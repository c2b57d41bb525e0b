// SPDX-License-Identifier: LGPL-2.1-or-later
// The camera's effect on an object without region: all of its lengths scale with the picture's. And the evidence of a
// region about the extent of its track.
#include "vision/tracking/track_hypothesis.h"

#include <check.h>

#include <cmath>
#include <numbers>

#include "support/motions.h"
#include "support/suite.h"
#include "vision/tracking/life_cycle.h"

using namespace cerberus::vision;

namespace {

constexpr Size kFrame{640, 480};
constexpr double kDegree = std::numbers::pi / 180;

TrackHypothesis walker(double x, double y) {
  TrackHypothesis track = TrackHypothesis::first_seen({{x - 20, y - 50, 40, 100}, 2000, 0.9, 1});
  track.uncut.width = 44;
  track.uncut.height = 110;
  track.uncut.whole_width = 44;
  track.uncut.whole_height = 110;
  track.x.velocity = track.uncut.velocity.x = 30;
  track.y.velocity = track.uncut.velocity.y = -12;
  track.x.pv = 7;
  return track;
}

// `before`, `scale` times as large; `more`: by which its place is less sure.
void check_scaled(const TrackHypothesis& before, const TrackHypothesis& after, double scale, double more,
                  double tolerance) {
  const auto equal = [&](double is, double should) {
    ck_assert_double_eq_tol(is, should, tolerance * std::abs(should));
  };
  equal(after.width(), scale * before.width());
  equal(after.height(), scale * before.height());
  equal(after.uncut.width, scale * before.uncut.width);
  equal(after.uncut.height, scale * before.uncut.height);
  equal(after.uncut.whole_width, scale * before.uncut.whole_width);
  equal(after.uncut.whole_height, scale * before.uncut.whole_height);
  equal(after.x.velocity, scale * before.x.velocity);
  equal(after.y.velocity, scale * before.y.velocity);
  equal(after.uncut.velocity.x, scale * before.uncut.velocity.x);
  equal(after.uncut.velocity.y, scale * before.uncut.velocity.y);
  equal(after.x.pp, scale * scale * (before.x.pp + more));
  equal(after.x.pv, scale * scale * before.x.pv);
  equal(after.x.vv, scale * scale * before.x.vv);
  equal(after.y.pp, scale * scale * (before.y.pp + more));
}

}  // namespace

START_TEST(a_zoom_scales_all_of_its_lengths) {
  const TrackHypothesis before = walker(200, 240);
  TrackHypothesis after = before;
  ck_assert(after.carry(cerberus::tests::similarity(1.5, 0, 0, 0), kFrame));
  const double grain = after.x.pp / 2.25 - before.x.pp;  // a pixel of the analysed picture, whatever that is
  ck_assert_double_gt(grain, 0);
  check_scaled(before, after, 1.5, grain, 1e-9);
}
END_TEST

START_TEST(a_camera_that_rolls_turns_the_velocity) {
  TrackHypothesis track = walker(200, 240);
  ck_assert(track.carry({{0, -1, 400, 1, 0, 0, 0, 0, 1}}, kFrame));  // a quarter: x becomes y
  ck_assert_double_eq_tol(track.x.velocity, 12, 1e-9);
  ck_assert_double_eq_tol(track.y.velocity, 30, 1e-9);
  ck_assert_double_eq_tol(track.uncut.velocity.x, 12, 1e-9);
  ck_assert_double_eq_tol(track.uncut.velocity.y, 30, 1e-9);
}
END_TEST

// Seen whole: the track's own region, of its extent, away from the picture's edge, also of one that stands at the edge.
START_TEST(what_the_edge_cuts_or_another_shares_is_not_seen_whole) {
  const auto see = [](double x, double width, bool alone, bool stands) {
    TrackHypothesis track = walker(200, 240);
    track.x.position = x;
    if (stands) {
      track.slow = 1;
      track.there = true;
    }
    ck_assert(track.predict(0.1));
    const double left = std::max(0.0, x - width / 2);
    track.correct({{left, 190, x + width / 2 - left, 100}, 2000, 0.9, 1}, alone, 0.1, kFrame);
    return track.uncut.whole_width;
  };
  ck_assert_double_eq_tol(see(200, 40, true, false), 40, 1);
  ck_assert_double_eq(see(200, 40, false, false), 44);
  ck_assert_double_eq(see(200, 15, true, false), 44);  // of another extent
  ck_assert_double_eq(see(14, 40, true, false), 44);
  ck_assert_double_eq(see(14, 40, true, true), 44);
}
END_TEST

// A standing person of whom a fragment is seen. The camera follows the fragment, or stands.
START_TEST(a_fragment_replaces_the_track_if_it_leaves_its_place_in_the_scene) {
  for (const bool walks : {false, true})
    for (const bool turns : {false, true}) {
      TrackHypothesis track = walker(200, 240);
      track.x.velocity = track.y.velocity = 0;
      track.fit.time = track.slow = 2;
      const double step = 8, scene = turns ? -step : 0, piece = walks ? scene + step : scene;
      for (int k = 0; k < 9; ++k) {
        track.predict(0.1);
        if (k > 0 && turns) track.carry(Transform::translation(scene, 0), kFrame);
        const Region seen{{210 + piece * k, 220, 14, 20}, 200, 0.2, 1};
        track.correct(seen, true, 0.1, kFrame);
      }
      if (walks)
        ck_assert_double_lt(track.height(), 40);
      else
        ck_assert_double_gt(track.height(), 90);
    }
}
END_TEST

START_TEST(towards_the_picture_s_middle_an_off_screen_track_shrinks_as_a_pinhole_projects_it) {
  // 40 degrees off the axis, then on it, then 40 degrees off again. The oracle: a square of a thousandth of a radian,
  // projected.
  const Lens lens(90 * kDegree, kFrame);
  const auto side = [&](double pan) {
    const auto at = [&](double bearing, double elevation) {
      return *lens.project({40 * kDegree + bearing, elevation}, pan, 0);
    };
    const Point left = at(-5e-4, 0), right = at(5e-4, 0), top = at(0, 5e-4), foot = at(0, -5e-4);
    return std::sqrt((right.x - left.x) * (foot.y - top.y));
  };
  const double scale = side(40 * kDegree) / side(0);
  ck_assert_double_lt(scale, 0.7);
  TrackHypothesis track = walker(320 + 320 * std::tan(40 * kDegree), 240);
  LifeCycle::leave(track, {lens, 0, 0});
  track.x.pv = 7;
  const TrackHypothesis before = track;
  track.predict_off_screen(0, {lens, 40 * kDegree, 0});
  ck_assert_double_eq_tol(track.x.position, 320, 1);
  check_scaled(before, track, scale, 0, 1e-4);
  track.predict_off_screen(0, {lens, 0, 0});
  check_scaled(before, track, 1, 0, 1e-9);
}
END_TEST

START_TEST(it_stays_where_it_has_stood_for_a_second_while_its_place_differs) {
  TrackHypothesis track = walker(200, 240);
  track.slow = 0.9;
  track.there = true;
  ck_assert(!track.stays());
  track.slow = 1;
  ck_assert(track.stays());
  track.there = false;
  ck_assert(!track.stays());
}
END_TEST

// One end of the region stays where he stood, as the background model has not learnt the place yet. The camera stands, or
// pans by more than he runs.
START_TEST(a_region_of_a_person_running_off_stretches) {
  constexpr double kRuns = 300;  // pixels a second
  for (const double seconds : {0.04, 0.1})
    for (const double camera : {0.0, -25.0, 25.0}) {
      Region region{{1800, 200, 40, 80}, 3200, 0.3, 1};
      TrackHypothesis track = TrackHypothesis::first_seen(region);
      const auto see = [&](double width) {
        ck_assert(track.predict(seconds));
        ck_assert(track.carry(Transform::translation(camera, 0), {4000, 480}));
        region.box = {region.box.x + camera, 200, width, 80};
        track.correct(region, true, seconds, {4000, 480});
        return track.width();
      };
      double width = 0, time = 0;
      for (; time < 0.6; time += seconds) see(40);  // its extent is well known
      for (time = seconds; time < 0.42; time += seconds) width = see(40 + kRuns * time);
      ck_assert_double_gt(width, 110);
    }
}
END_TEST

// The box of a group, and in it one person who is seen alone.
START_TEST(a_person_s_own_region_replaces_a_group_s_extent_at_once_and_a_person_s_after_a_while) {
  for (const RegionKind before : {RegionKind::group, RegionKind::thing, RegionKind::person_like}) {
    TrackHypothesis track = TrackHypothesis::first_seen({{200, 100, 200, 120}, 20000, 0.9, 1, before});
    LifeCycle::confirm(track, 7);
    const Region person{{300, 110, 40, 100}, 3000, 0.9, 1, RegionKind::person_like};
    track.correct(person, true, 0.04, kFrame);
    const bool adopted = std::abs(track.width() - 40) < 1;
    ck_assert(adopted == (before != RegionKind::person_like));
    for (int k = 0; k < 8; ++k) track.correct(person, true, 0.04, kFrame);
    ck_assert_double_eq_tol(track.width(), 40, 1);
  }
}
END_TEST

START_TEST(a_track_that_has_a_group_s_box_or_shares_its_region_for_long_is_a_group) {
  struct Case {
    RegionKind before;
    double least;  // s
  };
  for (const auto& [before, least] : {Case{RegionKind::person_like, 1.0}, {RegionKind::thing, 0.2}}) {
    TrackHypothesis track = walker(200, 240);
    LifeCycle::confirm(track, 7);
    track.kind = before;
    const auto see_group = [&track](int frames) {
      for (int k = 0; k < frames; ++k)
        track.correct({{182, 192, 40, 100}, 2000, 0.9, 1, RegionKind::group}, false, 0.04, kFrame);
      return track.kind;
    };
    const int enough = static_cast<int>(std::lround(least / 0.04));
    ck_assert(see_group(enough - 1) == before);
    track.miss(0.04);  // a frame without region: the time begins anew
    ck_assert(see_group(enough - 1) == before);
    ck_assert(see_group(2) == RegionKind::group);
    TrackHypothesis other = walker(200, 240);
    LifeCycle::confirm(other, 7);
    other.kind = before;
    other.correct({{150, 192, 200, 100}, 9000, 0.9, 1, RegionKind::group}, false, 0.04, kFrame);
    ck_assert(other.kind == before);
    other.shared.time = least;
    other.correct({{150, 192, 200, 100}, 9000, 0.9, 1, RegionKind::group}, false, 0.04, kFrame);
    ck_assert(other.kind == RegionKind::group);
  }
}
END_TEST

// The kind of a track at (200, 240) after so many frames in which it had a region of this kind alone.
static RegionKind see_alone(TrackHypothesis& track, RegionKind kind, int frames) {
  for (int k = 0; k < frames; ++k)
    track.correct({{180, 190, 40, 100}, 2000, 0.9, 1, kind}, true, 0.04, kFrame);
  return track.kind;
}

START_TEST(what_is_a_group_for_some_frames_stays_what_it_was_and_is_a_group_when_it_lasts) {
  TrackHypothesis track = walker(200, 240);
  LifeCycle::confirm(track, 7);
  const auto see = [&](RegionKind kind, int frames) { return see_alone(track, kind, frames); };
  ck_assert(see(RegionKind::person_like, 1) == RegionKind::person_like);
  for (int round = 0; round < 3; ++round) {
    ck_assert(see(RegionKind::group, 24) == RegionKind::person_like);
    ck_assert(see(RegionKind::person_like, 1) == RegionKind::person_like);
  }
  ck_assert(see(RegionKind::group, 26) == RegionKind::group);
  ck_assert(see(RegionKind::part, 1) == RegionKind::part);
  ck_assert(see(RegionKind::group, 24) == RegionKind::part);
  ck_assert(see(RegionKind::group, 2) == RegionKind::group);
}
END_TEST

// One frame as a thing does not make a person's group of less than a second one.
START_TEST(a_person_who_was_a_thing_for_a_frame_is_no_group_sooner) {
  TrackHypothesis track = walker(200, 240);
  LifeCycle::confirm(track, 7);
  const auto see = [&](RegionKind kind, int frames) { return see_alone(track, kind, frames); };
  ck_assert(see(RegionKind::person_like, 1) == RegionKind::person_like);
  ck_assert(see(RegionKind::thing, 1) == RegionKind::thing);
  ck_assert(see(RegionKind::group, 20) == RegionKind::thing);
  ck_assert(see(RegionKind::group, 6) == RegionKind::group);
}
END_TEST

// Frames until a region of half the height has replaced the extent of a moving track.
static int frames_until_shrunk(double seconds, bool camera_moves) {
  TrackHypothesis track = walker(200, 240);
  for (int frame = 1;; ++frame) {
    ck_assert(track.predict(seconds, camera_moves));
    track.correct({{track.x.position - 20, track.y.position - 25, 40, 50}, 1000, 0.9, 1}, true, seconds,
                  kFrame);
    if (track.height() < 75 || frame == 100) return frame;
  }
}

START_TEST(a_moving_camera_s_track_shrinks_in_its_second_frame) {
  ck_assert_int_eq(frames_until_shrunk(0.0334, true), 2);
  ck_assert_int_eq(frames_until_shrunk(0.0334, false), 9);  // .3 s before a camera that stands
  ck_assert_int_eq(frames_until_shrunk(0.1001, true), 2);   // one frame alone is not believed
}
END_TEST

START_TEST(before_a_moving_camera_a_track_s_velocity_is_less_certain) {
  TrackHypothesis still = walker(200, 240), panned = still;
  const double known = still.x.vv;
  still.predict(0.1), panned.predict(0.1, true);
  ck_assert_double_gt(still.x.vv, known);
  ck_assert_double_gt(panned.x.vv - known, 4 * (still.x.vv - known));
}
END_TEST

// 2 S/s are 200 pixels a second: beyond it the deviation is in proportion to the speed, the variance to its square.
START_TEST(the_velocity_of_what_is_faster_than_a_jogger_is_less_certain) {
  const auto more = [](double speed) {
    TrackHypothesis t = walker(200, 240);
    t.x.velocity = speed, t.y.velocity = 0;
    const double known = t.x.vv;
    t.predict(0.1);
    return t.x.vv - known;
  };
  ck_assert_double_eq_tol(more(200), more(30), 1e-9);
  ck_assert_double_eq_tol(more(1000), 25 * more(30), 1e-9 * more(1000));
}
END_TEST

// By 75 pixels in .04 s.
START_TEST(after_a_leap_the_velocity_is_that_of_the_leap) {
  for (const bool leapt : {true, false}) {
    Region region{{100, 100, 40, 30}, 1000, 0.4, 1};
    TrackHypothesis t = TrackHypothesis::first_seen(region);
    t.predict(0.04);
    region.box.x += 75;
    t.match.leapt = leapt;
    t.correct(region, true, 0.04, kFrame, {});
    ck_assert_int_eq(t.x.velocity > 0.95 * 75 / 0.04, leapt);
    ck_assert_double_le(t.x.velocity, 1.05 * 75 / 0.04);
    ck_assert_double_eq_tol(t.y.velocity, 0, 1e-9);
  }
}
END_TEST

// Twice as wide at the same height is a stride, and takes effect at once. What is wider than a stride, or lower, is not, nor
// is a region that another track shares, or a group's.
START_TEST(a_track_becomes_as_wide_as_somebody_in_mid_stride) {
  const auto width_after = [](const Box& seen, bool alone = true, RegionKind kind = RegionKind::thing) {
    TrackHypothesis track = TrackHypothesis::first_seen({{200, 100, 25, 100}, 2000, 0.9, 1});
    track.predict(0.04);
    track.correct({seen, 2000, 0.9, 1, kind}, alone, 0.04, kFrame);
    return track.width();
  };
  ck_assert_double_gt(width_after({187, 100, 50, 100}), 27);
  ck_assert_double_eq_tol(width_after({180, 100, 65, 100}), 25, 1e-9);
  ck_assert_double_eq_tol(width_after({187, 100, 50, 60}), 25, 1e-9);
  ck_assert_double_eq_tol(width_after({187, 100, 50, 100}, false), 25, 1e-9);
  ck_assert_double_eq_tol(width_after({187, 100, 50, 100}, true, RegionKind::group), 25, 1e-9);
}
END_TEST

// The rounded overlap of a box with itself may be more than 1.
START_TEST(a_region_that_fits_exactly_is_at_no_distance) {
  for (int k = 0; k < 1000; ++k) {
    const Region seen{{700 + k / 7.0, 45 + k / 11.0, 10 + k / 70.0, 37 + k / 60.0}, 300, 0.9, 1};
    const TrackHypothesis t = TrackHypothesis::first_seen(seen);
    ck_assert_double_ge(t.distance(t.box(), kFrame), 0);
    ck_assert_double_le(t.distance(t.box(), kFrame), 1e-6);
  }
}
END_TEST

START_TEST(each_transition_leads_to_its_state) {
  const Box seen{180, 190, 40, 100};
  const CameraOrientation camera{Lens(60 * kDegree, kFrame), 0, 0};
  TrackHypothesis track = walker(200, 240);
  ck_assert(track.is(TrackPhase::tentative) && !track.in_view());
  LifeCycle::confirm(track, 7);
  ck_assert(track.is(TrackPhase::confirmed) && track.in_view() && track.id == 7);
  LifeCycle::coast(track);
  ck_assert(track.is(TrackPhase::coasted) && track.in_view() && !track.stands());
  LifeCycle::stop(track);
  ck_assert(track.is(TrackPhase::stopped) && track.in_view() && track.stands());
  ck_assert_double_eq(track.speed(), 0);
  LifeCycle::see(track);
  ck_assert(track.is(TrackPhase::confirmed));
  // A stopped track comes back as a stopped one, another as a coasted one: the region that it is matched with corrects
  // it.
  for (const bool stopped : {true, false}) {
    LifeCycle::coast(track);
    if (stopped) LifeCycle::stop(track);
    LifeCycle::leave(track, camera);
    ck_assert(track.is(TrackPhase::off_screen) && !track.in_view() && track.stands() == stopped);
    LifeCycle::come_back(track, seen);
    ck_assert(track.is(stopped ? TrackPhase::stopped : TrackPhase::coasted));
    LifeCycle::see(track);
    ck_assert(track.is(TrackPhase::confirmed));
  }
  // One that walked out of the picture has no place where it would stand.
  LifeCycle::coast(track);
  LifeCycle::stop(track);
  LifeCycle::walk_out(track, camera);
  ck_assert(track.is(TrackPhase::off_screen) && track.walked_out() && !track.stands());
  LifeCycle::come_back(track, seen);
  ck_assert(track.is(TrackPhase::coasted) && !track.walked_out());
  LifeCycle::stop(track);
  LifeCycle::leave(track, camera);
  std::get<OffScreen>(track.life).absent = 0.4;
  LifeCycle::resume_stop(track);
  ck_assert_double_eq(std::get<Stopped>(track.life).absent, 0.4);
  LifeCycle::lose(track);
  ck_assert(track.is(TrackPhase::lost) && !track.in_view());
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "track_hypothesis",
      {a_moving_camera_s_track_shrinks_in_its_second_frame,
       before_a_moving_camera_a_track_s_velocity_is_less_certain,
       the_velocity_of_what_is_faster_than_a_jogger_is_less_certain,
       after_a_leap_the_velocity_is_that_of_the_leap, a_track_becomes_as_wide_as_somebody_in_mid_stride,
       a_region_that_fits_exactly_is_at_no_distance, each_transition_leads_to_its_state,
       a_zoom_scales_all_of_its_lengths, what_the_edge_cuts_or_another_shares_is_not_seen_whole,
       a_camera_that_rolls_turns_the_velocity,
       a_fragment_replaces_the_track_if_it_leaves_its_place_in_the_scene,
       towards_the_picture_s_middle_an_off_screen_track_shrinks_as_a_pinhole_projects_it,
       a_person_s_own_region_replaces_a_group_s_extent_at_once_and_a_person_s_after_a_while,
       a_track_that_has_a_group_s_box_or_shares_its_region_for_long_is_a_group,
       a_person_who_was_a_thing_for_a_frame_is_no_group_sooner,
       what_is_a_group_for_some_frames_stays_what_it_was_and_is_a_group_when_it_lasts,
       it_stays_where_it_has_stood_for_a_second_while_its_place_differs,
       a_region_of_a_person_running_off_stretches});
}
