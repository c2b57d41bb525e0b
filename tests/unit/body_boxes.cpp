// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/persons/body_boxes.h"

#include <algorithm>
#include <random>
#include <vector>

#include "support/allocations.h"
#include "support/suite.h"
#include "vision/persons/whole_frame_detector.h"

using namespace cerberus::vision;

namespace {

// Overlaps the box 0,0 100x100 by this share of the union: moved to the right.
Box moved_for(double iou) {
  return {100 * (1 - iou) / (1 + iou), 0, 100, 100};
}

std::vector<PersonDetection> kept(std::vector<PersonDetection> bodies) {
  keep_one_box_a_body(bodies);
  return bodies;
}

// Returns what it was given, and remembers how it was asked.
class FakeDetector : public PersonDetector {
 public:
  std::vector<PersonDetection> hits;
  std::optional<std::string> refusal;
  double* scale = nullptr;
  std::optional<std::string> detect(const PersonPicture&, double asked,
                                    std::vector<PersonDetection>& found) override {
    *scale = asked;
    found.insert(found.end(), hits.begin(), hits.end());
    return refusal;
  }
};

}  // namespace

START_TEST(of_windows_that_overlap_by_more_than_half_the_best_one_stays) {
  std::vector<PersonDetection> hits{
      {moved_for(.51), 1}, {{0, 0, 100, 100}, 2}, {moved_for(.49), .5}, {{500, 0, 100, 100}, 3}};
  suppress_overlaps(hits);
  ck_assert_uint_eq(hits.size(), 3);
  ck_assert_double_eq(hits[0].score, 3);
  ck_assert_double_eq(hits[1].score, 2);
  ck_assert_double_eq(hits[2].score, .5);
}
END_TEST

START_TEST(a_window_that_is_left_out_leaves_no_other_one_out) {
  std::vector<PersonDetection> hits{{{0, 0, 100, 100}, 3}, {{30, 0, 100, 100}, 2}, {{60, 0, 100, 100}, 1}};
  suppress_overlaps(hits);
  ck_assert_uint_eq(hits.size(), 2);
  ck_assert_double_eq(hits[1].score, 1);
}
END_TEST

START_TEST(a_torso_within_a_body_is_the_same_body_and_the_better_score_stays) {
  const PersonDetection body{{100, 100, 40, 120}, 1}, torso{{105, 110, 30, 50}, 2};
  ck_assert(is_one_body(body.box, torso.box) && is_one_body(torso.box, body.box));
  const auto both = kept({body, torso});
  ck_assert_uint_eq(both.size(), 1);
  ck_assert_double_eq(both[0].score, 2);
  ck_assert_double_eq(both[0].box.height, 50);
}
END_TEST

START_TEST(one_body_needs_65_percent_of_the_smaller) {
  const Box body{100, 100, 40, 120};
  // 100 high, of which 65 or 64 lie in the body; 40 wide, of which 26 or 25 do.
  ck_assert(is_one_body(body, {100, 155, 40, 100}));
  ck_assert(!is_one_body(body, {100, 156, 40, 100}));
  ck_assert(is_one_body(body, {114, 110, 40, 60}));
  ck_assert(!is_one_body(body, {115, 110, 40, 60}));
  ck_assert(!is_one_body(body, {100, 100, 0, 0}));
  ck_assert_uint_eq(kept({{body, 1}, {{115, 110, 40, 60}, 2}}).size(), 2);
}
END_TEST

START_TEST(the_order_of_the_hits_is_of_no_account) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> place(0, 60), size(20, 60), score(0, 3);
  std::vector<PersonDetection> hits;
  for (int i = 0; i < 60; ++i)
    hits.push_back(
        {{double(place(random)), double(place(random)), double(size(random)), double(size(random))},
         double(score(random))});
  std::vector<PersonDetection> first = hits;
  hits_to_bodies(first, {.5, .8});
  for (int turn = 0; turn < 10; ++turn) {
    std::vector<PersonDetection> other = hits;
    std::ranges::shuffle(other, random);
    hits_to_bodies(other, {.5, .8});
    ck_assert_uint_eq(other.size(), first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
      ck_assert_double_eq(other[i].box.x, first[i].box.x);
      ck_assert_double_eq(other[i].box.y, first[i].box.y);
      ck_assert_double_eq(other[i].score, first[i].score);
    }
  }
}
END_TEST

START_TEST(bodies_lie_in_the_middle_of_their_windows) {
  std::vector<PersonDetection> hits{{{100, 200, 64, 128}, 1}};
  hits_to_bodies(hits, {.5, .75});
  ck_assert_double_eq(hits[0].box.x, 116);
  ck_assert_double_eq(hits[0].box.y, 216);
  ck_assert_double_eq(hits[0].box.width, 32);
  ck_assert_double_eq(hits[0].box.height, 96);
}
END_TEST

// A torso's window overlaps the body's by a third of the union.
START_TEST(hits_of_a_body_and_of_its_torso_become_one_body) {
  std::vector<PersonDetection> hits{{{100, 200, 64, 128}, 2}, {{114, 210, 36, 72}, 1}};
  ck_assert(intersection_over_union(hits[0].box, hits[1].box) < .5);
  hits_to_bodies(hits, {.5, .75});
  ck_assert_uint_eq(hits.size(), 1);
  ck_assert_double_eq(hits[0].score, 2);
}
END_TEST

START_TEST(reducing_hits_allocates_nothing) {
  std::vector<PersonDetection> hits;
  for (int i = 0; i < 50; ++i) hits.push_back({{10.0 * (i % 7), 5.0 * (i % 5), 64, 128}, i * .1});
  const auto before = cerberus::tests::allocations();
  hits_to_bodies(hits, {.5, .75});
  ck_assert_uint_eq(cerberus::tests::allocations() - before, 0);
}
END_TEST

START_TEST(a_whole_frame_is_scanned_at_its_lines_and_the_bodies_are_those_of_this_frame) {
  double scale = 0;
  auto fake = std::make_unique<FakeDetector>();
  fake->scale = &scale;
  fake->hits = {{{100, 200, 64, 128}, 1}, {{101, 200, 64, 128}, 2}};
  WholeFrameDetector detector(std::move(fake), 480, {.5, .75});
  Image<std::uint8_t> frame({1280, 960});
  std::vector<PersonDetection> bodies{{{1, 1, 1, 1}, 9}};
  ck_assert(!detector.find(GrayView(frame.view()), bodies));
  ck_assert_double_eq(scale, .5);
  ck_assert_uint_eq(bodies.size(), 1);
  ck_assert_double_eq(bodies[0].box.x, 117);
  ck_assert_double_eq(bodies[0].score, 2);
}
END_TEST

START_TEST(a_detector_that_cannot_be_used_says_so_through_the_whole_frame) {
  double scale = 0;
  auto fake = std::make_unique<FakeDetector>();
  fake->scale = &scale;
  fake->refusal = "It is none.";
  WholeFrameDetector detector(std::move(fake), 0, {});
  Image<std::uint8_t> frame({64, 48});
  std::vector<PersonDetection> bodies;
  ck_assert(detector.find(GrayView(frame.view()), bodies) == std::optional<std::string>("It is none."));
  ck_assert_double_eq(scale, 1);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "body_boxes", {of_windows_that_overlap_by_more_than_half_the_best_one_stays,
                     a_window_that_is_left_out_leaves_no_other_one_out,
                     a_torso_within_a_body_is_the_same_body_and_the_better_score_stays,
                     one_body_needs_65_percent_of_the_smaller, the_order_of_the_hits_is_of_no_account,
                     bodies_lie_in_the_middle_of_their_windows,
                     hits_of_a_body_and_of_its_torso_become_one_body, reducing_hits_allocates_nothing,
                     a_whole_frame_is_scanned_at_its_lines_and_the_bodies_are_those_of_this_frame,
                     a_detector_that_cannot_be_used_says_so_through_the_whole_frame});
}
