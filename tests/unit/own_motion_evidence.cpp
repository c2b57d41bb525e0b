// SPDX-License-Identifier: LGPL-2.1-or-later
// Which tracks are believed in a scene that the camera's motion does not explain.
#include "vision/change/own_motion_evidence.h"

#include <check.h>

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr double kFrame = 0.04, kCalm = 0.95, kParallax = 0.5;
constexpr Box kWalker{100, 60, 40, 100};

// What registration leaves over: `ghosts` grey levels everywhere, and `walker` inside the box.
Image<std::uint8_t> difference(int ghosts, int walker) {
  Image<std::uint8_t> d({320, 240});
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) {
      const bool inside = x >= kWalker.x && x < kWalker.right() && y >= kWalker.y && y < kWalker.bottom();
      d.view().at(x, y) = static_cast<std::uint8_t>(inside ? walker : ghosts);
    }
  return d;
}

// Whether the track is believed in the last of so many frames.
bool believed(OwnMotionEvidence& evidence, const Image<std::uint8_t>& d, int frames, double calm = kParallax,
              bool seen = true, std::uint32_t id = 1) {
  bool last = false;
  for (int k = 0; k < frames; ++k) {
    evidence.begin_frame(d.view(), calm, kFrame);
    last = evidence.supports(id, kWalker, seen);
  }
  return last;
}

}  // namespace

START_TEST(in_a_calm_scene_every_track_is_believed_at_once) {
  OwnMotionEvidence evidence;
  ck_assert(believed(evidence, difference(20, 20), 1, kCalm));
}
END_TEST

START_TEST(in_another_only_one_that_stands_out_and_after_a_while) {
  OwnMotionEvidence walker, ghost;
  ck_assert(!believed(walker, difference(10, 40), 1));
  ck_assert(believed(walker, difference(10, 40), 15));
  ck_assert(!believed(ghost, difference(20, 24), 50));
  OwnMotionEvidence faint;  // twice as much, of nothing
  ck_assert(!believed(faint, difference(1, 2), 50));
}
END_TEST

// 1.3 times what is around makes no track believed, and keeps one that is.
START_TEST(a_track_that_was_believed_needs_only_more_inside_than_around) {
  OwnMotionEvidence seen, calm, fresh;
  ck_assert(believed(seen, difference(10, 40), 25));
  ck_assert(believed(seen, difference(20, 26), 100));
  ck_assert(believed(calm, difference(20, 26), 25, kCalm));
  ck_assert(believed(calm, difference(20, 26), 100));
  ck_assert(!believed(fresh, difference(20, 26), 100));
}
END_TEST

START_TEST(a_track_that_stands_out_no_more_is_doubted_and_a_hidden_one_keeps_what_it_had) {
  OwnMotionEvidence evidence;
  ck_assert(believed(evidence, difference(10, 40), 25));
  ck_assert(believed(evidence, difference(20, 20), 25, kParallax, false));
  ck_assert(!believed(evidence, difference(20, 18), 100));
  evidence.reset();
  ck_assert(!believed(evidence, difference(10, 40), 1));
}
END_TEST

START_TEST(what_was_seen_while_the_scene_was_calm_counts_when_it_is_no_longer) {
  OwnMotionEvidence evidence;
  ck_assert(believed(evidence, difference(2, 40), 25, kCalm));
  ck_assert(believed(evidence, difference(10, 40), 1));
}
END_TEST

START_TEST(without_a_difference_every_track_is_believed) {
  OwnMotionEvidence evidence;
  evidence.begin_frame({}, kParallax, kFrame);
  ck_assert(evidence.supports(1, kWalker, true));
}
END_TEST

START_TEST(boxes_outside_the_picture_and_many_tracks_do_no_harm) {
  OwnMotionEvidence evidence;
  const Image<std::uint8_t> d = difference(10, 40);
  evidence.begin_frame(d.view(), kParallax, 0);
  ck_assert(!evidence.supports(1, {-50, -50, 20, 20}, true));
  ck_assert(!evidence.supports(2, {310, 230, 1e6, 1e6}, true));
  const std::size_t before = allocations();
  for (std::uint32_t id = 3; id < 2000; ++id) believed(evidence, d, 1, kParallax, true, id);
  ck_assert_uint_eq(allocations(), before);
  ck_assert(believed(evidence, d, 20, kParallax, true, 1999));
}
END_TEST

int main() {
  return run_suite(
      "own_motion_evidence",
      {in_a_calm_scene_every_track_is_believed_at_once, in_another_only_one_that_stands_out_and_after_a_while,
       a_track_that_was_believed_needs_only_more_inside_than_around,
       a_track_that_stands_out_no_more_is_doubted_and_a_hidden_one_keeps_what_it_had,
       what_was_seen_while_the_scene_was_calm_counts_when_it_is_no_longer,
       without_a_difference_every_track_is_believed, boxes_outside_the_picture_and_many_tracks_do_no_harm});
}
