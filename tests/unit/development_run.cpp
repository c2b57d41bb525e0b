// SPDX-License-Identifier: LGPL-2.1-or-later
// What a run of bench-development measures: who has a box and when, and how well boxes fit.
#include "bench/development_sequences.h"

#include <check.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "support/suite.h"
#include "support/temporary_folder.h"

using namespace cerberus;
using namespace cerberus::bench;

namespace {

constexpr cerberus::vision::Size kPicture{320, 240};
constexpr double kFrame = .1;  // s

// MOT rows: frame from 1, person, x, y, width, height.
DevelopmentSequence sequence_of(const TemporaryFolder& folder, const char* rows) {
  const auto truth = std::filesystem::path(folder.path) / "boxes.txt";
  std::ofstream(truth) << rows;
  return {"drawn", Labels::all, "", truth};
}

Found box(double x, double y, double width, double height, bool group = false) {
  return {{7, {x, y, width, height}}, group};
}

}  // namespace

START_TEST(the_first_box_counts_from_the_first_labelled_frame) {
  const TemporaryFolder folder;
  const auto sequence = sequence_of(folder, "3,1,100,100,40,80\n4,1,100,100,40,80\n5,1,100,100,40,80\n");
  DevelopmentRun run(sequence, false);
  for (int n = 0; n < 5; ++n) {
    // Before the person is there; a group's box; one that overlaps by less than half; the right one.
    const std::vector<Found> found[]{{box(100, 100, 40, 80)},
                                     {},
                                     {box(100, 100, 40, 80, true)},
                                     {box(100, 100, 40, 39)},
                                     {box(100, 100, 40, 80)}};
    run.add(found[n], kPicture, n * kFrame);
  }
  const Outcome outcome = run.outcome();
  ck_assert_uint_eq(outcome.first_boxes.size(), 1);
  ck_assert_double_eq_tol(outcome.first_boxes[0].seconds, .2, 1e-9);
  ck_assert(outcome.first_boxes[0].plain);
  ck_assert_uint_eq(outcome.widths.size(), 2);  // of the last two: groups claim no person
}
END_TEST

START_TEST(who_never_has_a_box_waits_for_ever) {
  const TemporaryFolder folder;
  const auto sequence = sequence_of(folder, "1,1,100,100,40,80\n");
  DevelopmentRun run(sequence, false);
  run.add({}, kPicture, 0);
  ck_assert(std::isinf(run.outcome().first_boxes.at(0).seconds));
}
END_TEST

START_TEST(who_is_small_cut_or_hidden_is_not_plain) {
  const TemporaryFolder folder;
  // Plain; 47 of 240 lines high; at the edge; hidden by the sixth, who is nearer; too high; plain.
  const auto sequence =
      sequence_of(folder,
                  "1,1,100,100,30,60\n1,2,50,100,20,47\n1,3,0,100,30,80\n1,4,200,100,30,80\n"
                  "1,5,260,20,50,200\n1,6,205,110,30,90\n");
  DevelopmentRun run(sequence, false);
  run.add({}, kPicture, 0);
  const bool plain[]{true, false, false, false, false, true};
  const Outcome outcome = run.outcome();
  ck_assert_uint_eq(outcome.first_boxes.size(), 6);
  for (const FirstBox& b : outcome.first_boxes) ck_assert_msg(b.plain == plain[b.person - 1], "%d", b.person);
}
END_TEST

START_TEST(boxes_are_compared_with_the_truth_in_a_mirrored_picture_too) {
  const TemporaryFolder folder;
  const auto sequence = sequence_of(folder, "1,1,20,100,40,80\n");
  for (const bool mirrored : {false, true}) {
    DevelopmentRun run(sequence, mirrored);
    run.add({box(mirrored ? 320 - 20 - 40 : 20, 100, 50, 72)}, kPicture, 0);
    const Outcome outcome = run.outcome();
    ck_assert_uint_eq(outcome.widths.size(), 1);
    ck_assert_double_eq_tol(outcome.widths[0], 1.25, 1e-9);
    ck_assert_double_eq_tol(outcome.heights[0], .9, 1e-9);
    ck_assert_double_eq_tol(outcome.figures[3], 1, 1e-9);  // recall
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "development_run",
      {the_first_box_counts_from_the_first_labelled_frame, who_never_has_a_box_waits_for_ever,
       who_is_small_cut_or_hidden_is_not_plain, boxes_are_compared_with_the_truth_in_a_mirrored_picture_too});
}
