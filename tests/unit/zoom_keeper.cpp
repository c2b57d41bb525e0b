// SPDX-License-Identifier: LGPL-2.1-or-later
// The law of the zoom before a simulated lens: a person of 1.7 m, a picture of 16:9.
#include "control/following/zoom_keeper.h"
#include "sim/zoom_lens.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <check.h>

#include "support/suite.h"

using namespace cerberus::control;
using namespace cerberus::sim;
using cerberus::sensing::radians;
using std::chrono::milliseconds;

namespace {

double log_tangent(double field_of_view) {
  return std::log(std::tan(field_of_view / 2));
}

// The share of the picture's height that the person has at a distance in metres.
double share(double distance, double field_of_view) {
  constexpr double kPerson = 1.7, kPicture = 9. / 16;
  return kPerson / distance / (2 * std::tan(field_of_view / 2) * kPicture);
}

struct Run {
  double share = 0;             // at the end
  double field_of_view = 0;     // at the end
  double fastest = 0;           // of the lens, 1/s over a second
  int steps = 0;                // commands
  int narrower = 0, wider = 0;  // of these
  int reversals = 0;            // of the lens
};

// The sight of a person at `distance`, as a picture shows it; nothing: it is not in the picture.
using Sight = std::optional<ZoomKeeper::Sight>;
using See = std::function<Sight(double seconds, const ZoomLens& lens)>;

See at(std::function<double(double)> distance) {
  return [distance](double seconds, const ZoomLens& lens) {
    const double height = share(distance(seconds), lens.field_of_view());
    return ZoomKeeper::Sight{std::min(1., height), height < 1, 0, lens.reported()};
  };
}

Run run(double length, const See& see, const ZoomTraits& traits = {}) {
  constexpr int kPeriod = 40;  // ms from picture to picture
  ZoomLens lens(traits);
  ZoomKeeper keeper;
  Run result;
  double commanded = 0, direction = 0, before = log_tangent(lens.field_of_view());
  for (int k = 0; k * kPeriod < 1000 * length; ++k) {
    const auto now = Time(milliseconds(k * kPeriod));
    lens.elapse(now);
    const double seconds = cerberus::motion::seconds(now);
    const auto wanted = keeper.update(seconds, see(seconds, lens), {traits.widest, traits.narrowest});
    if (wanted) {
      ++result.steps;
      if (commanded > 0) (*wanted < commanded ? result.narrower : result.wider) += *wanted != commanded;
      commanded = *wanted;
      lens.command(*wanted, now);
    }
    if (k % 25 == 0) {
      const double here = log_tangent(lens.field_of_view()), way = here - before;
      result.fastest = std::max(result.fastest, std::abs(way));
      if (std::abs(way) > .01) {
        result.reversals += way * direction < 0;
        direction = way;
      }
      before = here;
    }
  }
  result.field_of_view = lens.field_of_view();
  const Sight last = see(length, lens);
  result.share = last ? last->height : 0;
  return result;
}

}  // namespace

START_TEST(a_person_far_away_is_brought_to_a_third_of_the_height_slowly) {
  const Run far = run(40, at([](double) { return 20.; }));
  ck_assert_double_eq_tol(far.share, 1. / 3, .04);
  ck_assert_int_eq(far.wider, 0);
  // Twice as near within five seconds: log 2 / 5 = .139. A second has five steps, or six.
  ck_assert_double_le(far.fastest, .139 * 1.21);
  ck_assert_double_ge(far.fastest, .12);
}
END_TEST

START_TEST(a_person_that_comes_and_goes_costs_one_turn_each) {
  // From 20 m to 5 m at 1 m/s, 10 s there, and back.
  const Run walk = run(80, at([](double t) { return std::clamp(std::abs(t - 40.), 5., 20.); }));
  ck_assert_double_eq_tol(walk.share, 1. / 3, .09);
  ck_assert_int_le(walk.reversals, 2);
}
END_TEST

START_TEST(a_height_within_the_dead_band_moves_nothing) {
  std::mt19937 random(5);
  std::normal_distribution<> noise(0, .1);
  // 9 m: .29 with the widest lens, each box off by a tenth.
  const Run still = run(60, [&](double, const ZoomLens& lens) -> Sight {
    return ZoomKeeper::Sight{share(9, lens.field_of_view()) * std::exp(noise(random)), true, 0,
                             lens.reported()};
  });
  ck_assert_int_eq(still.steps, 0);
}
END_TEST

START_TEST(while_the_person_is_lost_the_zoom_stands) {
  ZoomKeeper keeper;
  const ZoomKeeper::Range range{radians(60), radians(4)};
  const ZoomKeeper::Sight small{.1, true, 0, radians(60)};
  double seconds = 0;
  int steps = 0;
  for (; seconds < 3; seconds += .04) steps += keeper.update(seconds, small, range).has_value();
  ck_assert_int_gt(steps, 5);
  for (; seconds < 6; seconds += .04) ck_assert(!keeper.update(seconds, std::nullopt, range));
  // Found again: no narrower before half a second.
  for (double found = seconds; seconds < found + .45; seconds += .04)
    ck_assert(!keeper.update(seconds, small, range));
  steps = 0;
  for (double end = seconds + 1; seconds < end; seconds += .04)
    steps += keeper.update(seconds, small, range).has_value();
  ck_assert_int_gt(steps, 1);
}
END_TEST

START_TEST(a_box_that_the_edge_cuts_widens_the_view_and_never_narrows_it) {
  ZoomTraits traits;
  traits.narrowest = radians(4);
  const auto cut = [&](double height) {
    return run(20, [height](double, const ZoomLens& lens) -> Sight {
      return ZoomKeeper::Sight{height, false, 0, lens.reported()};
    });
  };
  const Run low = cut(.1);  // the legs are below the picture: how tall it is is not known
  ck_assert_int_eq(low.steps, 0);
  ZoomKeeper keeper;
  const ZoomKeeper::Sight tall{1, false, 0, radians(10)};
  double widest = 0;
  for (double seconds = 0; seconds < 3; seconds += .04)
    widest = std::max(widest, keeper.update(seconds, tall, {radians(60), radians(4)}).value_or(0));
  ck_assert_double_gt(widest, radians(10));
}
END_TEST

START_TEST(legs_below_the_picture_make_no_person_smaller) {
  ZoomKeeper keeper;
  double seconds = 0;
  const auto stands = [&](double length, double height, bool whole) {
    for (const double end = seconds + length; seconds < end; seconds += .04)
      if (keeper.update(seconds, ZoomKeeper::Sight{height, whole, 0, radians(30)}, {radians(60), radians(4)}))
        return false;
    return true;
  };
  ck_assert(stands(3, .4, true));
  ck_assert(stands(5, .15, false));
  ck_assert(stands(3, .4, true));
}
END_TEST

START_TEST(a_person_off_the_middle_is_not_brought_nearer) {
  const auto off = [](double height, double by) {
    return run(20, [=](double, const ZoomLens& lens) -> Sight {
      return ZoomKeeper::Sight{height, true, by, lens.reported()};
    });
  };
  ck_assert_int_eq(off(.1, .6).steps, 0);
  ck_assert_int_gt(off(.1, .2).narrower, 5);
}
END_TEST

START_TEST(a_lens_that_does_not_obey_is_asked_for_little) {
  ZoomKeeper keeper;
  const ZoomKeeper::Sight small{.05, true, 0, radians(60)};
  double asked = radians(60);
  for (double seconds = 0; seconds < 60; seconds += .04)
    asked = keeper.update(seconds, small, {radians(60), radians(4)}).value_or(asked);
  // 1.4 s and a step ahead of the report: tan(30) e^(-.14 1.6) is 24.77 degrees to each side.
  ck_assert_double_ge(asked, radians(2 * 24.6));
}
END_TEST

START_TEST(the_ends_of_the_lens_are_kept_and_strange_numbers_are_no_sight) {
  const Run far = run(60, at([](double) { return 500.; }));
  ck_assert_double_ge(far.field_of_view, radians(4));
  ck_assert_double_le(far.field_of_view, radians(4 * 1.06));  // it stops within a factor of 1.05
  const double nan = std::nan("");
  ZoomKeeper keeper;
  for (const ZoomKeeper::Sight& strange :
       {ZoomKeeper::Sight{nan, true, 0, 1}, ZoomKeeper::Sight{0, true, 0, 1},
        ZoomKeeper::Sight{.1, true, nan, 1}, ZoomKeeper::Sight{.1, true, 0, nan},
        ZoomKeeper::Sight{.1, true, 0, 0}})
    for (double seconds = 0; seconds < 2; seconds += .04)
      ck_assert(!keeper.update(seconds, strange, {radians(60), radians(4)}));
  const ZoomKeeper::Sight small{.1, true, 0, radians(60)};
  for (double seconds = 0; seconds < 2; seconds += .04) ck_assert(!keeper.update(seconds, small, {0, 0}));
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "zoom_keeper",
      {a_person_far_away_is_brought_to_a_third_of_the_height_slowly,
       a_person_that_comes_and_goes_costs_one_turn_each, a_height_within_the_dead_band_moves_nothing,
       while_the_person_is_lost_the_zoom_stands,
       a_box_that_the_edge_cuts_widens_the_view_and_never_narrows_it,
       legs_below_the_picture_make_no_person_smaller, a_person_off_the_middle_is_not_brought_nearer,
       a_lens_that_does_not_obey_is_asked_for_little,
       the_ends_of_the_lens_are_kept_and_strange_numbers_are_no_sight});
}
