// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/best_moment.h"

#include <check.h>

#include <cmath>

#include "support/suite.h"
#include "vision/image/image.h"

using namespace cerberus;
using namespace cerberus::record;
using vision::Box;
using vision::Size;

namespace {

constexpr Size kFrame{640, 480};

bool near(double a, double b) {
  return std::abs(a - b) < 1e-9;
}

}  // namespace

START_TEST(a_ramp_is_as_sharp_as_it_is_steep) {
  vision::Image<std::uint8_t> image({40, 30});
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) image.view().at(x, y) = static_cast<std::uint8_t>(3 * x + 2 * y);
  // 3 to the right, 2 below: (3 + 2) / 2
  ck_assert(near(sharpness(image.view(), {5, 5, 20, 20}), 2.5));
  ck_assert(near(sharpness(image.view(), {-100, -100, 1000, 1000}), 2.5));
  ck_assert(near(sharpness(image.view(), {50, 5, 20, 20}), 0));
}
END_TEST

START_TEST(a_large_box_is_read_in_samples) {
  vision::Image<std::uint8_t> image({3000, 2000});
  for (int y = 0; y < 2000; ++y)
    for (int x = 0; x < 3000; ++x) image.view().at(x, y) = static_cast<std::uint8_t>((x + y) % 7 * 10);
  BestMomentParameters all;
  all.most_samples = 1 << 30;
  const double exact = sharpness(image.view(), {0, 0, 3000, 2000}, all);
  ck_assert(std::abs(sharpness(image.view(), {0, 0, 3000, 2000}) - exact) < .05 * exact);
}
END_TEST

START_TEST(the_score_is_the_formula) {
  // A quarter of the frame in its middle: sqrt(1/4) * (7 + 1) / (7 + 1 + 8) = 1/4.
  ck_assert(near(view_score({160, 120, 320, 240}, kFrame, 7), .25));
  // In the corner: its centre is half of the half diagonal away, which costs a quarter.
  ck_assert(near(view_score({0, 0, 320, 240}, kFrame, 7), .25 * .75));
}
END_TEST

START_TEST(larger_sharper_and_more_central_is_better) {
  const double score = view_score({300, 200, 60, 120}, kFrame, 7);
  ck_assert(view_score({290, 180, 80, 160}, kFrame, 7) > score);
  ck_assert(view_score({300, 200, 60, 120}, kFrame, 12) > score);
  ck_assert(view_score({300, 200, 60, 120}, kFrame, 2) < score);  // blurred
  ck_assert(view_score({500, 200, 60, 120}, kFrame, 7) < score);
}
END_TEST

START_TEST(twice_the_size_in_the_corner_is_better_than_the_centre) {
  ck_assert(view_score({0, 0, 120, 240}, kFrame, 7) > view_score({290, 180, 60, 120}, kFrame, 7));
}
END_TEST

START_TEST(only_what_is_in_the_frame_counts) {
  ck_assert(near(view_score({-320, 0, 640, 480}, kFrame, 7), view_score({0, 0, 320, 480}, kFrame, 7)));
  ck_assert(near(view_score({700, 0, 60, 60}, kFrame, 7), 0));
  ck_assert(near(view_score({10, 10, std::nan(""), 60}, kFrame, 7), 0));
}
END_TEST

int main() {
  Suite* suite = suite_create("best moment");
  TCase* cases = tcase_create("best moment");
  for (const TTest* test :
       {a_ramp_is_as_sharp_as_it_is_steep, a_large_box_is_read_in_samples, the_score_is_the_formula,
        larger_sharper_and_more_central_is_better, twice_the_size_in_the_corner_is_better_than_the_centre,
        only_what_is_in_the_frame_counts})
    tcase_add_test(cases, test);
  suite_add_tcase(suite, cases);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
