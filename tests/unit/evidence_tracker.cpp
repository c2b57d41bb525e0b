// SPDX-License-Identifier: LGPL-2.1-or-later
// Tracks of which motion and a people detector are the witnesses, before painted walls and bodies.
#include "vision/tracking/evidence/evidence_tracker.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "support/allocations.h"
#include "support/suite.h"
#include "support/textures.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr Size kFrame{640, 480}, kSmall{320, 240};
constexpr double kSeconds = 1.0 / 24;  // a frame
constexpr int kLook = 6;               // frames from look to look: 4 a second
constexpr double kSure = 2, kDoubtful = 0.6, kLikely = 0.75;
constexpr double kGone = 60;  // frame pixels, a quarter of a body's height: it has moved

// Frame pixels.
Box body_at(double x) {
  return {x, 120, 80, 240};
}

bool near(const Box& a, const Box& b, double pixels = 12) {
  return std::abs(a.x - b.x) < pixels && std::abs(a.y - b.y) < pixels &&
         std::abs(a.width - b.width) < pixels && std::abs(a.height - b.height) < pixels;
}

Track motion_track(std::uint32_t id, const Box& box, double vx = 0,
                   RegionKind kind = RegionKind::person_like) {
  Track track;
  track.id = id, track.box = box, track.vx = vx, track.kind = kind;
  return track;
}

class Scene {
 public:
  double calm = 1;
  bool still = true;
  double seconds = kSeconds;
  double pan = 0;         // frame pixels a frame by which the wall moves
  bool encloses = false;  // EvidenceLook::encloses
  bool persons_only = false;
  std::function<bool(const Box&)> counts;
  bool goes_on = false;  // it has begun before the first frame

  // Bodies at these columns of the frame. late: what the look at an earlier frame has shown.
  std::span<const EvidenceResult> frame(const std::vector<double>& bodies,
                                        const std::vector<Track>& motion = {},
                                        const std::optional<std::vector<PersonDetection>>& late = {},
                                        double period = kLook * kSeconds, bool at_once = false) {
    wall_ += pan / 2;
    paint(picture_, all_of(kSmall), wall_, 0, 1);
    for (const double x : bodies) {
      const Box box = body_at(x);
      paint(picture_, {box.x / 2, box.y / 2, box.width / 2, box.height / 2}, box.x / 2, box.y / 2, 5);
    }
    EvidenceFrame f;
    f.seconds = seconds;
    f.fresh = number_++ == 0 && !goes_on;
    f.persons_only = persons_only;
    f.counts = counts;
    f.size = kFrame;
    f.picture = picture_.view();
    f.motion = Transform::translation(pan, 0);
    f.still = still, f.calm = calm;
    std::optional<EvidenceLook> look;
    if (late) look = EvidenceLook{*late, period, at_once, encloses};
    return tracker.update(f, motion, look);
  }
  // Looks at the last frame; the result is there in the next one.
  void look() { tracker.begin_look(); }

  EvidenceTracker tracker;

 private:
  Image<std::uint8_t> picture_{kSmall};
  double wall_ = 0;
  int number_ = 0;
};

// A body that goes `step` pixels a frame, seen with this score at every look, whose results are `delay` frames late.
// Returns what is published in each frame.
std::vector<std::vector<EvidenceResult>> walk(Scene& scene, int frames, double step, double score,
                                              int delay = 1, bool detected = true) {
  std::vector<std::vector<EvidenceResult>> all;
  std::vector<PersonDetection> seen;
  int looked = -1;
  for (int n = 0; n < frames; ++n) {
    std::optional<std::vector<PersonDetection>> late;
    if (looked >= 0 && n == looked + delay) late = seen, looked = -1;
    const auto found = scene.frame({200 + step * n}, {}, late);
    all.emplace_back(found.begin(), found.end());
    if (n % kLook != 0) continue;
    seen.clear();
    if (detected) seen.push_back({body_at(200 + step * n), score});
    scene.look();
    looked = n;
  }
  return all;
}

// The motion track 7 goes from one place to the other.
void bring(Scene& scene, const Box& from, const Box& to) {
  constexpr int kFrames = 20;
  for (int n = 0; n <= kFrames; ++n) {
    const double share = double(n) / kFrames;
    const Box box{from.x + share * (to.x - from.x), from.y + share * (to.y - from.y), to.width, to.height};
    scene.frame({box.x}, {motion_track(7, box)});
  }
}

}  // namespace

START_TEST(who_is_seen_surely_is_published_after_two_looks_and_followed_between_them) {
  for (const int delay : {1, 4}) {
    Scene scene;
    scene.calm = 0.4, scene.still = false;
    const auto frames = walk(scene, 48, 4, kSure, delay);
    int first = -1;
    for (int n = 0; n < 48; ++n) {
      if (frames[n].empty()) continue;
      if (first < 0) first = n;
      ck_assert_int_eq(frames[n].size(), 1);
      ck_assert_uint_eq(frames[n][0].id, 1);
      ck_assert(frames[n][0].person && frames[n][0].motion < 0);
      ck_assert_msg(near(frames[n][0].box, body_at(200 + 4 * n)), "delay %d, frame %d: at %.0f, not %.0f",
                    delay, n, frames[n][0].box.x, 200.0 + 4 * n);
    }
    ck_assert_int_ge(first, kLook);
    ck_assert_int_le(first, 2 * kLook + delay);
    ck_assert_double_eq_tol(frames[47][0].velocity.x, 4 / kSeconds, 15);
  }
}
END_TEST

START_TEST(who_a_late_look_shows_is_where_the_camera_has_carried_him) {
  Scene scene;
  scene.calm = 0.4, scene.still = false, scene.pan = 12;  // 4 frames are more than the search for him reaches
  const auto frames = walk(scene, 16, scene.pan, kSure, 4);
  ck_assert_int_eq(frames.back().size(), 1);
  ck_assert_msg(near(frames.back()[0].box, body_at(200 + 12 * 15)), "at %.0f", frames.back()[0].box.x);
}
END_TEST

START_TEST(what_rests_and_is_seen_doubtfully_is_nobody) {
  Scene scene;
  for (const auto& found : walk(scene, 96, 0, kDoubtful)) ck_assert(found.empty());
  Scene shaken;
  shaken.calm = 0.4, shaken.still = false;
  for (const auto& found : walk(shaken, 96, 0, kDoubtful)) ck_assert(found.empty());
}
END_TEST

START_TEST(who_walks_needs_less_of_a_score_than_who_rests) {
  Scene scene;
  scene.calm = 0.4, scene.still = false;
  ck_assert(!walk(scene, 72, 4, kLikely).back().empty());
  Scene other;
  other.calm = 0.4, other.still = false;
  ck_assert(walk(other, 72, 0, kLikely).back().empty());
}
END_TEST

START_TEST(a_person_whom_no_look_shows_any_more_ends) {
  Scene scene;
  scene.calm = 0.4, scene.still = false;
  ck_assert(!walk(scene, 24, 0, kSure).back().empty());
  ck_assert(walk(scene, 48, 0, kSure, 1, false).back().empty());
  ck_assert(walk(scene, 3, 0, kSure).back().empty());  // and begins anew
}
END_TEST

START_TEST(before_a_still_camera_a_motion_track_is_published_as_it_is_once_it_has_gone_somewhere) {
  Scene scene;
  for (int n = 0; n < 30; ++n) {
    const Box box = body_at(200 + 4 * n);
    const auto found = scene.frame({200.0 + 4 * n}, {motion_track(7, box)});
    if (4 * n < kGone) ck_assert(found.empty());
    if (4 * n < kGone + 8) continue;
    ck_assert_int_eq(found.size(), 1);
    ck_assert_uint_eq(found[0].id, 1);
    ck_assert(!found[0].person && found[0].moves && found[0].motion == 0);
    ck_assert(near(found[0].box, box, 0.01));
  }
  ck_assert(scene.frame({}).empty());  // it ends with it
}
END_TEST

START_TEST(what_sways_in_one_place_is_nobody_unless_a_look_shows_it) {
  for (const bool looks : {false, true}) {
    Scene scene;
    bool published = false;
    for (int n = 0; n < 72; ++n) {
      const double x = 200 + 8 * std::sin(n);
      std::optional<std::vector<PersonDetection>> late;
      if (looks && n % kLook == 1) late = {{body_at(x), kSure}};
      published = !scene.frame({x}, {motion_track(7, body_at(x))}, late).empty();
      ck_assert(looks || !published);
      if (n % kLook == 0) scene.look();
    }
    ck_assert(published == looks);
  }
}
END_TEST

// A track that goes across the wall where nobody is.
START_TEST(before_a_moving_camera_a_motion_track_without_motion_inside_is_nobody) {
  Scene scene;
  scene.still = false, scene.pan = 2;
  for (int n = 0; n < 24; ++n)
    ck_assert(
        scene.frame({}, {motion_track(7, body_at(200 + (240 * kSeconds + scene.pan) * n), 240)}).empty());
}
END_TEST

START_TEST(before_a_moving_camera_a_motion_track_must_move_inside_for_a_while) {
  for (const double speed : {0.0, 120.0, 240.0}) {  // pixels a second; half a height, a height
    Scene scene;
    scene.still = false, scene.pan = 2;
    bool published = false;
    for (int n = 0; n < 24; ++n) {
      const double x = 200 + (speed * kSeconds + scene.pan) * n;
      std::vector<Track> motion;
      if (n > 0)
        motion.push_back(motion_track(7, body_at(x), speed));  // of one frame nothing is known to move
      published = !scene.frame({x}, motion).empty();
      ck_assert_msg(n > 6 || !published, "frame %d", n);
    }
    ck_assert(published == (speed > 0));
  }
}
END_TEST

START_TEST(in_a_shaken_scene_motion_tracks_are_no_witness) {
  Scene scene;
  scene.still = false, scene.calm = 0.4;
  for (int n = 0; n < 48; ++n) {
    const double x = 100 + 10.0 * n;
    ck_assert(scene.frame({x}, {motion_track(7, body_at(x), 240)}).empty());
  }
}
END_TEST

START_TEST(a_look_makes_a_motion_track_a_person_and_leaves_its_box_and_identity) {
  Scene scene;
  const Box narrow{210, 130, 60, 220};
  bring(scene, {narrow.x - kGone, narrow.y, narrow.width, narrow.height}, narrow);
  scene.look();
  const auto found =
      scene.frame({200}, {motion_track(7, narrow)}, std::vector<PersonDetection>{{body_at(200), kSure}});
  ck_assert_int_eq(found.size(), 1);
  ck_assert(found[0].person && found[0].id == 1);
  ck_assert(near(found[0].box, narrow, 0.01));
}
END_TEST

START_TEST(a_group_is_replaced_by_the_people_in_it) {
  Scene scene;
  for (int n = 0; n < 49; ++n) {
    const double x = 100 + 4 * n;
    const Track both = motion_track(7, {x - 5, 115, 180, 250}, 0, RegionKind::group);
    std::optional<std::vector<PersonDetection>> late;
    if (n > 24 && n % kLook == 1) late = {{body_at(x - 4), kSure}, {body_at(x + 86), kSure}};
    const auto found = scene.frame({x, x + 90}, {both}, late);
    if (n % kLook == 0) scene.look();
    if (n == 24) ck_assert(found.size() == 1 && found[0].id == 1 && found[0].kind == RegionKind::group);
    if (n < 48) continue;
    ck_assert_int_eq(found.size(), 2);
    ck_assert(found[0].person && found[1].person && found[0].id != found[1].id);
    ck_assert(near(found[0].box, body_at(x)) && near(found[1].box, body_at(x + 90)));
  }
}
END_TEST

START_TEST(somebody_before_a_vehicle_does_not_stand_for_it) {
  Scene scene;
  for (int n = 0; n < 49; ++n) {
    const double x = 100 + 4 * n;
    const Track van = motion_track(7, {x - 40, 20, 370, 350}, 0, RegionKind::group);
    std::optional<std::vector<PersonDetection>> late;
    if (n > 24 && n % kLook == 1) late = {{body_at(x - 4), kSure}};
    const auto found = scene.frame({x}, {van}, late);
    if (n % kLook == 0) scene.look();
    if (n < 48) continue;
    ck_assert_int_eq(found.size(), 2);
    ck_assert(std::ranges::any_of(found, [&](const EvidenceResult& r) { return near(r.box, van.box, 1); }));
  }
}
END_TEST

START_TEST(what_never_moves_before_a_still_camera_is_nobody_however_sure_a_detector_is) {
  Scene scene;
  for (const auto& found : walk(scene, 72, 0, kSure)) ck_assert(found.empty());
}
END_TEST

START_TEST(who_stands_before_a_still_camera_is_published_where_looks_enclose_bodies) {
  Scene scene;
  scene.encloses = true;
  const auto frames = walk(scene, 72, 0, kSure);
  ck_assert_int_eq(frames.back().size(), 1);
  ck_assert(near(frames.back()[0].box, body_at(200)));
}
END_TEST

// As a poster: before a camera that moves, and before one that stands.
START_TEST(whom_looks_alone_show_is_stopped_after_a_while_at_one_place_and_seen_on_the_way) {
  for (const bool still : {true, false})
    for (const bool walks : {false, true}) {
      Scene scene;
      scene.encloses = true;
      scene.still = still, scene.pan = still ? 0 : 2;
      const double step = scene.pan + (walks ? 4 : 0);
      const auto frames = walk(scene, 96, step, kSure);
      ck_assert(frames[12].size() == 1 && frames[12][0].state == TrackState::seen);
      int last_seen = 0;
      for (int n = 13; n < 96; ++n) {
        if (200 + step * n > kFrame.width - 80) break;  // at the picture's edge
        ck_assert_int_eq(frames[n].size(), 1);
        if (frames[n][0].state == TrackState::seen)
          last_seen = n;
        else
          ck_assert(frames[n][0].state == TrackState::stopped);
        ck_assert_msg(!walks || last_seen == n, "frame %d", n);
      }
      ck_assert_msg(walks || last_seen < 72, "frame %d", last_seen);
    }
}
END_TEST

START_TEST(who_stops_is_stopped_and_who_goes_on_is_seen_again) {
  Scene scene;
  scene.calm = 0.4, scene.still = false;
  std::vector<PersonDetection> shown;
  double x = 100;
  for (int n = 0; n < 192; ++n) {
    if (n < 48 || n >= 144) x += 5;
    std::optional<std::vector<PersonDetection>> late;
    if (n % kLook == 1) late = shown;
    const auto found = scene.frame({x}, {}, late);
    if (n % kLook == 0) shown = {{body_at(x), kSure}}, scene.look();
    if (n < 24) continue;
    ck_assert_msg(found.size() == 1, "frame %d", n);
    if (n < 48 || n >= 168) ck_assert_msg(found[0].state == TrackState::seen, "frame %d", n);
    if (n >= 108 && n < 144) ck_assert_msg(found[0].state == TrackState::stopped, "frame %d", n);
  }
}
END_TEST

// Motion shows the legs only, or the body half a width aside, while the camera moves.
START_TEST(before_a_moving_camera_looks_go_before_a_motion_track_that_does_not_fit) {
  const struct {
    double left, top, width, height;  // of the motion track: shares of the body
    bool encloses, fits;
  } cases[] = {{0, .55, 1, .45, true, false}, {0, .55, 1, .45, false, false}, {.3, .6, .4, .4, false, false},
               {.5, 0, 1, 1, true, false},    {.5, 0, 1, 1, false, true},     {0, .3, 1, .7, false, true}};
  for (const auto& each : cases) {
    Scene scene;
    scene.encloses = each.encloses;
    scene.still = false, scene.pan = 2;
    for (int n = 0; n < 48; ++n) {
      const double x = 200 + 5 * n;
      const Box body = body_at(x);
      const Box moving{body.x + each.left * body.width, body.y + each.top * body.height,
                       each.width * body.width, each.height * body.height};
      std::optional<std::vector<PersonDetection>> late;
      if (n % kLook == 1) late = {{body_at(x - 5), kSure}};
      const auto found = scene.frame({x}, {motion_track(7, moving, 120)}, late);
      if (n % kLook == 0) scene.look();
      if (n < 47) continue;
      ck_assert_int_eq(found.size(), 1);
      ck_assert(found[0].person);
      ck_assert_msg(near(found[0].box, each.fits ? moving : body), "case %d",
                    static_cast<int>(&each - cases));
    }
  }
}
END_TEST

// Motion shows the upper half of somebody who comes nearer; a single window that is too large says nothing.
START_TEST(before_a_still_camera_a_window_goes_before_a_piece_once_some_looks_show_it) {
  for (const int every : {1, 2}) {  // look
    Scene scene;
    for (int n = 0; n <= 9 * kLook; ++n) {
      const double x = 200 + 4 * n;
      const Box body = body_at(x), upper{body.x, body.y, body.width, .45 * body.height};
      const bool whole = n / kLook % every == 0;
      std::optional<std::vector<PersonDetection>> late;
      if (n % kLook == 1) late = {{whole ? body_at(x - 4) : upper, kSure}};
      const auto found = scene.frame({x}, {motion_track(7, upper, 96)}, late);
      if (n % kLook == 0) scene.look();
      if (n < 2 * kLook) continue;
      ck_assert_int_eq(found.size(), 1);
      ck_assert_uint_eq(found[0].id, 1);
      if (n < 3 * kLook || every > 1) ck_assert(near(found[0].box, upper));
      if (n > 5 * kLook && every == 1) ck_assert_msg(near(found[0].box, body), "frame %d", n);
    }
  }
}
END_TEST

START_TEST(a_doubtful_look_makes_no_person_of_what_moves) {
  Scene scene;
  bring(scene, body_at(200 - kGone), body_at(200));
  scene.look();
  const auto found =
      scene.frame({200}, {motion_track(7, body_at(200))}, std::vector<PersonDetection>{{body_at(200), 0.1}});
  ck_assert(found.size() == 1 && !found[0].person);
}
END_TEST

namespace {

// A motion track walks, and looks show it as they are asked to: one score each, nothing for 0. Returns the last results.
std::vector<EvidenceResult> walk_past(const std::vector<double>& scores, const Box& box = body_at(100)) {
  Scene scene;
  std::vector<PersonDetection> seen;
  std::vector<EvidenceResult> last;
  int look = 0;
  bring(scene, {box.x - kGone, box.y, box.width, box.height}, box);
  for (int n = 0; look <= static_cast<int>(scores.size()); ++n) {
    const Box now{box.x + n, box.y, box.width, box.height};
    std::optional<std::vector<PersonDetection>> late;
    if (n % kLook == 1) late = seen;
    const auto found = scene.frame({now.x}, {motion_track(7, now, 1 / kSeconds)}, late);
    last.assign(found.begin(), found.end());
    if (n % kLook != 0) continue;
    seen.clear();
    if (look < static_cast<int>(scores.size()) && scores[look] > 0) seen.push_back({now, scores[look]});
    if (++look <= static_cast<int>(scores.size())) scene.look();
  }
  ck_assert_int_eq(last.size(), 1);
  return last;
}

}  // namespace

START_TEST(what_one_look_at_the_threshold_shows_is_no_person_after_some_that_do_not) {
  ck_assert(walk_past({.55})[0].person);
  ck_assert(walk_past({.55, 0, 0})[0].person);
  ck_assert(!walk_past({.55, 0, 0, 0, 0, 0, 0, 0})[0].person);
}
END_TEST

START_TEST(a_person_whom_looks_show_no_more_becomes_what_only_moves) {
  ck_assert(walk_past({kSure, 0})[0].person);  // a look may miss somebody
  std::vector<double> scores(30, 0);           // 7 s
  scores[0] = kSure;
  ck_assert(!walk_past(scores)[0].person);
  scores.push_back(kSure);
  ck_assert(walk_past(scores)[0].person);
  ck_assert(walk_past({kSure, 0, kSure, 0, 0, kSure, 0, kSure, 0, 0})[0].person);
}
END_TEST

START_TEST(the_confidence_of_a_person_is_what_looks_say) {
  const double one = walk_past({kSure})[0].confidence, two = walk_past({kSure, kSure})[0].confidence,
               missed = walk_past({kSure, kSure, 0})[0].confidence,
               many = walk_past({kSure, kSure, kSure, kSure})[0].confidence;
  ck_assert(0 < one && one < two && missed < two && missed > 0 && many == 1);
}
END_TEST

// At the picture's edge a detector sees nobody.
START_TEST(looks_that_cannot_see_a_person_say_nothing) {
  const Box cut{100, 0, 80, 240};
  ck_assert(walk_past({.55, 0, 0, 0, 0, 0, 0, 0}, cut)[0].person);
}
END_TEST

// A detector does not see who has become smaller than it sees people.
START_TEST(who_goes_away_from_the_camera_stays_a_person) {
  Scene scene;
  bring(scene, body_at(200 - kGone), body_at(200));
  std::span<const EvidenceResult> found;
  for (int n = 0; n < 96; ++n) {
    const double height = 240 * std::pow(.99, n);
    const Box box{240 - height / 6, 360 - height, height / 3, height};
    std::optional<std::vector<PersonDetection>> late;
    if (n % kLook == 1)
      late = n < kLook ? std::vector<PersonDetection>{{box, .55}} : std::vector<PersonDetection>{};
    found = scene.frame({200}, {motion_track(7, box)}, late);
    if (n % kLook == 0) scene.look();
  }
  ck_assert(found.size() == 1 && found[0].person);
}
END_TEST

START_TEST(who_is_shown_once_a_second_is_published_all_the_time) {
  Scene scene;
  scene.calm = 0.4, scene.still = false;
  std::vector<PersonDetection> seen;
  for (int n = 0; n < 120; ++n) {
    std::optional<std::vector<PersonDetection>> late;
    if (n % 24 == 1) late = {{body_at(200 + 2 * (n - 1)), kSure}};
    const auto found = scene.frame({200.0 + 2 * n}, {}, late, 1);
    if (n % 24 == 0) scene.look();
    if (n < 30) continue;
    ck_assert_msg(found.size() == 1, "frame %d", n);
    ck_assert(found[0].state == TrackState::seen);
  }
}
END_TEST

// Looks come every two seconds, and one more right behind the second.
START_TEST(a_look_in_between_makes_nobody_vanish_until_the_next) {
  Scene scene;
  scene.calm = 0.4, scene.still = false;
  constexpr int kRare = 48, kBetween = kRare + 6;
  int before = 0;
  for (int n = 0; n < 3 * kRare; ++n) {
    const int since = n - 1 - before;
    const bool due = n > 0 && ((n - 1) % kRare == 0 || n - 1 == kBetween);
    std::optional<std::vector<PersonDetection>> late;
    if (due) late = {{body_at(200), kSure}};
    const auto found = scene.frame({200}, {}, late, since * kSeconds);
    if (due) before = n - 1;
    if (n % kRare == 0 || n == kBetween) scene.look();
    if (n > kBetween) ck_assert_msg(found.size() == 1, "frame %d", n);
  }
}
END_TEST

START_TEST(a_look_counts_however_late_it_is) {
  Scene scene;
  scene.calm = 0.4, scene.still = false;
  int published = 0;
  for (int n = 0; n < 240; ++n) {
    std::optional<std::vector<PersonDetection>> late;
    if (n % 48 == 40) late = {{body_at(200 + (n - 40)), kSure}};
    published += !scene.frame({200.0 + n}, {}, late, 2).empty();
    if (n % 48 == 0) scene.look();
  }
  ck_assert_int_gt(published, 100);
}
END_TEST

// As of boxes that ride on the frame itself.
START_TEST(a_look_at_the_very_frame_shows_where_the_body_is_now) {
  Scene scene;
  scene.calm = 0.4, scene.still = false;
  for (int n = 0; n < 13; ++n) {
    std::optional<std::vector<PersonDetection>> now;
    if (n % kLook == 0) now = {{body_at(200 + 4 * n), kSure}};
    const auto found = scene.frame({200.0 + 4 * n}, {}, now, kLook * kSeconds, true);
    if (n < kLook) continue;
    ck_assert_int_eq(found.size(), 1);
    ck_assert(found[0].person && near(found[0].box, body_at(200 + 4 * n), 6));
  }
}
END_TEST

// Motion ends for who stands still, and is another track when the person goes on.
START_TEST(who_stops_and_is_looked_at_keeps_the_identity_when_motion_ends) {
  for (const bool shown : {true, false}) {
    Scene scene;
    bring(scene, body_at(200 - kGone), body_at(200));
    std::span<const EvidenceResult> found;
    for (int n = 0; n < 96; ++n) {
      std::vector<Track> motion;
      if (n < 24) {  // held where it stands
        motion.push_back(motion_track(7, body_at(200)));
        if (n > 6) motion.back().state = TrackState::stopped;
      }
      if (n >= 84) motion.push_back(motion_track(8, body_at(200 + 4 * (n - 84))));
      std::optional<std::vector<PersonDetection>> late;
      if (n % kLook == 1)
        late = n < 6 || shown ? std::vector<PersonDetection>{{body_at(200), kSure}}
                              : std::vector<PersonDetection>{};
      found = scene.frame({200.0 + std::max(0, 4 * (n - 84))}, motion, late);
      if (n % kLook == 0) scene.look();
      if (n < 2 || (n >= 24 && !shown)) continue;
      ck_assert_msg(found.size() == 1 && found[0].id == 1 && found[0].person, "frame %d", n);
      ck_assert(near(found[0].box, body_at(200 + std::max(0, 4 * (n - 84)))));
    }
    ck_assert(shown || found.empty() || found[0].id != 1);
  }
}
END_TEST

// Somebody who comes straight on: the box grows about its middle.
START_TEST(what_grows_by_a_quarter_within_a_second_has_moved) {
  for (const double growth : {1.0, 1.5}) {
    Scene scene;
    bool published = false;
    for (int n = 0; n < 24; ++n) {
      const double height = 120 * std::pow(growth, n / 24.0), width = height / 3;
      published =
          !scene.frame({}, {motion_track(7, {320 - width / 2, 240 - height / 2, width, height})}).empty();
      ck_assert(growth > 1 || !published);
    }
    ck_assert(published == (growth > 1));
  }
}
END_TEST

// As of a frame that repeats another and has its time.
START_TEST(a_frame_of_the_same_time_leaves_a_velocity_that_is_a_number) {
  Scene scene;
  scene.calm = 0.4, scene.still = false;
  ck_assert(!walk(scene, 24, 4, kSure).back().empty());
  scene.seconds = 0;
  for (int n = 0; n < 2; ++n) {
    const auto found = scene.frame({200 + 4 * 23});
    ck_assert_int_eq(found.size(), 1);
    ck_assert_double_eq_tol(found[0].velocity.x, 4 / kSeconds, 15);
    ck_assert_double_eq_tol(found[0].velocity.y, 0, 15);
    ck_assert(near(found[0].box, body_at(200 + 4 * 23)));
  }
}
END_TEST

START_TEST(an_identity_that_motion_gives_back_is_the_persons_again) {
  Scene scene;
  const auto frames = walk(scene, 24, 4, kSure);
  ck_assert(!frames.back().empty());
  const std::uint32_t id = frames.back()[0].id;
  const Box box = body_at(292);
  scene.frame({292}, {motion_track(3, box)});  // takes the place of the person's
  scene.frame({292}, {});                      // ends with it
  const auto found = scene.frame({292}, {motion_track(3, box)});
  ck_assert_int_eq(found.size(), 1);
  ck_assert(found[0].id == id && found[0].person);
}
END_TEST

// A person whom looks show first, then a motion track that is published at frame 40, while another never is.
START_TEST(identities_count_in_the_order_of_publication) {
  for (const bool persons_only : {false, true}) {
    Scene scene;
    scene.encloses = true;
    scene.persons_only = persons_only;
    std::vector<PersonDetection> seen;
    std::span<const EvidenceResult> found;
    for (int n = 0; n < 96; ++n) {
      const double x = n < 36 ? 100 : std::min(100 + 4.0 * (n - 36), 300.0);
      std::vector<Track> motion{motion_track(5, body_at(x)), motion_track(9, {20, 300, 30, 60})};
      std::optional<std::vector<PersonDetection>> late;
      if (n % kLook == 1) late = seen;
      found = scene.frame({x, 500}, motion, late);
      seen = {{body_at(500), kSure}};
      if (persons_only && n > 60) seen.push_back({body_at(x), kSure});
      if (n % kLook == 0) scene.look();
    }
    ck_assert_int_eq(found.size(), 2);
    ck_assert(found[0].id == 1 && found[0].motion < 0 && near(found[0].box, body_at(500)));
    ck_assert(found[1].id == 2 && near(found[1].box, body_at(300)));
  }
}
END_TEST

// Of two, the left one stands for a while where only what motion shows counts.
START_TEST(who_does_not_count_takes_no_identity_and_makes_no_group_vanish) {
  Scene scene;
  scene.calm = 0.4, scene.still = false;
  scene.counts = [](const Box& box) { return box.x > 250; };
  bool seen = false;
  for (int n = 0; n < 48; ++n) {
    std::vector<PersonDetection> late{{body_at(100), kSure}};
    if (n > 24) late.push_back({body_at(400), kSure});
    const bool due = n % kLook == 1;
    for (const EvidenceResult& found :
         scene.frame({100, 400}, {}, due ? std::optional(late) : std::nullopt)) {
      ck_assert_msg(found.id == 1 && found.box.x > 250, "%u at %.0f", found.id, found.box.x);
      seen = true;
    }
    if (n % kLook == 0) scene.look();
  }
  ck_assert(seen);

  Scene group;
  group.counts = [](const Box&) { return false; };
  for (int n = 0; n < 72; ++n) {
    const double x = 200 + 4 * n;
    const Track both = motion_track(7, {x - 5, 115, 180, 250}, 0, RegionKind::group);
    const std::vector<PersonDetection> late{{body_at(x - 4), kSure}, {body_at(x + 86), kSure}};
    const auto found =
        group.frame({x, x + 90}, {both}, n > 24 && n % kLook == 1 ? std::optional(late) : std::nullopt);
    if (n >= 24) ck_assert_msg(found.size() == 1 && found[0].motion == 0, "frame %d: %zu", n, found.size());
    if (n % kLook == 0) group.look();
  }
}
END_TEST

START_TEST(what_has_been_published_alone_keeps_its_identity_when_looks_begin_and_when_they_end) {
  Scene scene;
  ck_assert_uint_eq(scene.tracker.publish_alone(3), 1);
  ck_assert_uint_eq(scene.tracker.publish_alone(8), 2);
  ck_assert_uint_eq(scene.tracker.publish_alone(3), 1);
  scene.goes_on = true;
  const std::vector<Track> motion{motion_track(8, body_at(400)), motion_track(4, body_at(50))};
  auto found = scene.frame({400, 50}, motion);
  ck_assert_int_eq(found.size(), 1);
  ck_assert(found[0].id == 2 && found[0].motion == 0);
  for (int n = 0; n < 24; ++n)
    found = scene.frame({400, 50.0 + 4 * n}, {motion[0], motion_track(4, body_at(50 + 4 * n))});
  ck_assert(found.size() == 2 && found[1].id == 3 && found[1].motion == 1);
  scene.tracker.drop_tracks();
  ck_assert_uint_eq(scene.tracker.publish_alone(4), 3);
  ck_assert_uint_eq(scene.tracker.publish_alone(8), 2);
  ck_assert_uint_eq(scene.tracker.publish_alone(10), 4);
}
END_TEST

START_TEST(after_a_reset_nothing_is_known_and_no_identity_is_given_twice) {
  Scene scene;
  ck_assert(!walk(scene, 24, 4, kSure).back().empty());
  scene.tracker.reset();
  ck_assert(scene.frame({300}).empty());
  const auto found = walk(scene, 24, 4, kSure).back();
  ck_assert(!found.empty() && found[0].id == 2);
}
END_TEST

START_TEST(the_steady_state_allocates_nothing) {
  Scene scene;
  const std::vector<Track> motion{motion_track(7, body_at(400)), motion_track(8, body_at(100))};
  std::vector<PersonDetection> bodies{{body_at(400), kSure}, {body_at(250), kSure}};
  const auto run = [&](int frames) {
    for (int n = 0; n < frames; ++n) {
      scene.frame({400, 250, 100}, motion, n % kLook == 1 ? std::optional(bodies) : std::nullopt);
      if (n % kLook == 0) scene.look();
    }
  };
  EvidenceFrame f;
  Image<std::uint8_t> picture(kSmall);
  f.seconds = kSeconds, f.size = kFrame, f.picture = picture.view();
  const auto run_black = [&] {
    for (int n = 0; n < 24; ++n) {
      if (n % kLook == 1)
        scene.tracker.update(f, motion, EvidenceLook{bodies});
      else
        scene.tracker.update(f, motion);
      if (n % kLook == 0) scene.tracker.begin_look();
    }
  };
  run(24);
  run_black();
  const std::size_t bytes = scene.tracker.bytes();
  const auto before = allocations();
  run_black();
  ck_assert_uint_eq(allocations(), before);
  ck_assert_uint_eq(scene.tracker.bytes(), bytes);
}
END_TEST

int main() {
  return run_suite("evidence_tracker",
                   {who_is_seen_surely_is_published_after_two_looks_and_followed_between_them,
                    who_a_late_look_shows_is_where_the_camera_has_carried_him,
                    what_rests_and_is_seen_doubtfully_is_nobody,
                    who_walks_needs_less_of_a_score_than_who_rests,
                    a_person_whom_no_look_shows_any_more_ends,
                    before_a_still_camera_a_motion_track_is_published_as_it_is_once_it_has_gone_somewhere,
                    what_sways_in_one_place_is_nobody_unless_a_look_shows_it,
                    before_a_moving_camera_a_motion_track_without_motion_inside_is_nobody,
                    before_a_moving_camera_a_motion_track_must_move_inside_for_a_while,
                    in_a_shaken_scene_motion_tracks_are_no_witness,
                    a_look_makes_a_motion_track_a_person_and_leaves_its_box_and_identity,
                    a_group_is_replaced_by_the_people_in_it,
                    somebody_before_a_vehicle_does_not_stand_for_it,
                    what_never_moves_before_a_still_camera_is_nobody_however_sure_a_detector_is,
                    who_stands_before_a_still_camera_is_published_where_looks_enclose_bodies,
                    whom_looks_alone_show_is_stopped_after_a_while_at_one_place_and_seen_on_the_way,
                    who_stops_is_stopped_and_who_goes_on_is_seen_again,
                    before_a_moving_camera_looks_go_before_a_motion_track_that_does_not_fit,
                    before_a_still_camera_a_window_goes_before_a_piece_once_some_looks_show_it,
                    a_doubtful_look_makes_no_person_of_what_moves,
                    what_one_look_at_the_threshold_shows_is_no_person_after_some_that_do_not,
                    a_person_whom_looks_show_no_more_becomes_what_only_moves,
                    the_confidence_of_a_person_is_what_looks_say,
                    looks_that_cannot_see_a_person_say_nothing,
                    who_goes_away_from_the_camera_stays_a_person,
                    who_is_shown_once_a_second_is_published_all_the_time,
                    a_look_in_between_makes_nobody_vanish_until_the_next,
                    a_look_counts_however_late_it_is,
                    a_look_at_the_very_frame_shows_where_the_body_is_now,
                    who_stops_and_is_looked_at_keeps_the_identity_when_motion_ends,
                    what_grows_by_a_quarter_within_a_second_has_moved,
                    a_frame_of_the_same_time_leaves_a_velocity_that_is_a_number,
                    an_identity_that_motion_gives_back_is_the_persons_again,
                    identities_count_in_the_order_of_publication,
                    who_does_not_count_takes_no_identity_and_makes_no_group_vanish,
                    what_has_been_published_alone_keeps_its_identity_when_looks_begin_and_when_they_end,
                    after_a_reset_nothing_is_known_and_no_identity_is_given_twice,
                    the_steady_state_allocates_nothing});
}
