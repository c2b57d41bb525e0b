// SPDX-License-Identifier: LGPL-2.1-or-later
// Where a window lies, against angles worked out by hand and against the lens; its pixels, against the definition in
// floating point.
#include "vision/geometry/window.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "support/pictures.h"
#include "support/suite.h"
#include "vision/geometry/lens.h"
#include "vision/geometry/window_misfit.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr double kDegree = M_PI / 180;

double sample(const Samples<const std::uint8_t>& from, double x, double y, int channel) {
  const auto held = [](double p, int size) {
    return std::clamp(std::floor(p * 128 + 0.5) / 128, 0.0, size - 1.0);
  };
  x = held(x, from.width), y = held(y, from.height);
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  const int jx = std::min(ix + 1, from.width - 1), jy = std::min(iy + 1, from.height - 1);
  const double fx = x - ix, fy = y - iy;
  const auto at = [&](int u, int v) {
    return static_cast<double>(from.data[v * from.stride + u * from.step + channel]);
  };
  return (at(ix, iy) * (1 - fx) + at(jx, iy) * fx) * (1 - fy) +
         (at(ix, jy) * (1 - fx) + at(jx, jy) * fx) * fy;
}

struct Layout {
  int step, channels;
};

// Draws and compares every byte, also those between the samples, which must stay as they are.
void compare(WindowResampler& resampler, Size big, Size small, Layout layout, WindowResampler::Grid grid,
             std::mt19937& random) {
  const int wide = big.width * layout.step, across = small.width * layout.step;
  const GuardedPicture source({wide, big.height}, 3), target({across, small.height}, 5);
  fill_random(source.view(), random);
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < across; ++x) target.view().at(x, y) = 77;
  const Samples<const std::uint8_t> from{source.view().data,   big.width,   big.height,
                                         source.view().stride, layout.step, layout.channels};
  resampler.draw(
      from,
      {target.view().data, small.width, small.height, target.view().stride, layout.step, layout.channels},
      grid);
  for (int j = 0; j < small.height; ++j)
    for (int k = 0; k < across; ++k) {
      const int i = k / layout.step, c = k % layout.step;
      double expected = 77;
      if (c < layout.channels)
        expected = std::floor(sample(from, grid.left + (i + 0.5) * grid.scale_x - 0.5,
                                     grid.top + (j + 0.5) * grid.scale_y - 0.5, c) +
                              0.5);
      ck_assert_msg(target.view().at(k, j) == expected, "%d x %d at %g %g scale %g, pixel %d %d byte %d",
                    small.width, small.height, grid.left, grid.top, grid.scale_x, i, j, c);
    }
}

}  // namespace

START_TEST(straight_ahead_is_the_middle_of_the_picture) {
  const WindowGeometry geometry(60 * kDegree, {768, 576}, {320, 240});
  ck_assert(geometry.fits());
  const auto place = geometry.at(0, 0);
  ck_assert_double_eq_tol(place.left, 224, 1e-9);
  ck_assert_double_eq_tol(place.top, 168, 1e-9);
  ck_assert(!place.limited);
}
END_TEST

// By hand: F = 384 / tan 30 = 665.108; the window sees 2 atan(160 / F) = 27.052 degrees; it reaches atan(224 / F) =
// 18.612 degrees to each side and atan(168 / F) = 14.176 up and down.
START_TEST(fov_and_reach_are_those_worked_out_by_hand) {
  const WindowGeometry geometry(60 * kDegree, {768, 576}, {320, 240});
  ck_assert_double_eq_tol(geometry.fov() / kDegree, 27.0524, 1e-3);
  ck_assert_double_eq_tol(geometry.pan_reach() / kDegree, 18.612, 1e-3);
  ck_assert_double_eq_tol(geometry.tilt_reach() / kDegree, 14.176, 1e-3);
  ck_assert_double_eq(geometry.scale(), 1);
}
END_TEST

START_TEST(pan_to_the_right_moves_to_the_right_and_tilt_up_moves_up) {
  const WindowGeometry geometry(60 * kDegree, {768, 576}, {320, 240});
  ck_assert_double_eq_tol(geometry.at(10 * kDegree, 0).left, 224 + 665.108 * 0.176327, 1e-2);
  ck_assert_double_eq_tol(geometry.at(0, 5 * kDegree).top, 168 - 665.108 * 0.087489, 1e-2);
}
END_TEST

// The lens of the wide picture is the independent oracle: what it sees along (pan, tilt) is in the window's middle.
START_TEST(the_window_has_in_its_middle_what_the_head_looks_at) {
  const Size picture{1920, 1080}, window{640, 360};
  const WindowGeometry geometry(80 * kDegree, picture, window);
  const Lens lens(80 * kDegree, picture);
  for (const double pan : {-20.0, -3.0, 0.0, 11.0})
    for (const double tilt : {-9.0, 0.0, 7.5}) {
      const auto place = geometry.at(pan * kDegree, tilt * kDegree);
      ck_assert(!place.limited);
      const Direction seen =
          lens.direction({place.left + 0.5 * window.width, place.top + 0.5 * window.height}, 0, 0);
      ck_assert_double_eq_tol(seen.bearing / kDegree, pan, 1e-6);
      ck_assert_double_eq_tol(seen.elevation / kDegree, tilt, 1e-6);
      ck_assert_double_eq_tol(place.pan / kDegree, pan, 1e-9);
      ck_assert_double_eq_tol(place.tilt / kDegree, tilt, 1e-9);
    }
}
END_TEST

START_TEST(the_window_ends_at_the_pictures_edges_and_reports_it) {
  const WindowGeometry geometry(60 * kDegree, {768, 576}, {320, 240});
  const auto right = geometry.at(80 * kDegree, -80 * kDegree);
  ck_assert(right.limited);
  ck_assert_double_eq_tol(right.left, 448, 1e-9);
  ck_assert_double_eq_tol(right.top, 336, 1e-9);
  ck_assert_double_eq_tol(right.pan, geometry.pan_reach(), 1e-12);
  const auto left = geometry.at(-4, 4);
  ck_assert_double_eq_tol(left.left, 0, 1e-9);
  ck_assert_double_eq_tol(left.top, 0, 1e-9);
  // Each direction alone is enough to say so.
  ck_assert(geometry.at(20 * kDegree, 0).limited);
  ck_assert(geometry.at(0, 20 * kDegree).limited);
  const auto lost = geometry.at(NAN, NAN);
  ck_assert_double_eq_tol(lost.left, 224, 1e-9);
}
END_TEST

START_TEST(a_field_of_view_scales_the_window) {
  const WindowGeometry geometry(60 * kDegree, {768, 576}, {320, 240}, 30 * kDegree);
  ck_assert(geometry.fits());
  ck_assert_double_eq_tol(geometry.scale(), 2 * 665.108 * 0.267949 / 320, 1e-5);
  ck_assert_double_eq_tol(geometry.fov(), 30 * kDegree, 1e-12);
}
END_TEST

START_TEST(a_window_that_does_not_fit_is_refused) {
  ck_assert(!WindowGeometry().fits());
  ck_assert(!WindowGeometry(1, {320, 240}, {321, 240}).fits());
  ck_assert(!WindowGeometry(1, {320, 240}, {320, 241}).fits());
  ck_assert(!WindowGeometry(1, {320, 240}, {160, 120}, 1.1).fits());
  ck_assert(!WindowGeometry(0, {320, 240}, {160, 120}).fits());
  ck_assert(!WindowGeometry(M_PI, {320, 240}, {160, 120}).fits());
  ck_assert(!WindowGeometry(NAN, {320, 240}, {160, 120}).fits());
  ck_assert(!WindowGeometry(1, {320, 240}, {160, 120}, NAN).fits());
  ck_assert(!WindowGeometry(1, {0, 0}, {0, 0}).fits());
  const WindowGeometry all(1, {320, 240}, {320, 240});
  ck_assert(all.fits());
  ck_assert_double_eq(all.at(0.3, 0.3).left, 0);
  ck_assert(WindowGeometry(1, {320, 240}, {160, 120}, 1).fits());
}
END_TEST

START_TEST(a_whole_position_is_a_copy) {
  std::mt19937 random(1);
  const GuardedPicture source({64, 48}), target({20, 10});
  fill_random(source.view(), random);
  WindowResampler resampler;
  resampler.draw({source.view().data, 64, 48, source.view().stride, 1, 1},
                 {target.view().data, 20, 10, target.view().stride, 1, 1}, {.left = 44, .top = 38});
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 20; ++x) ck_assert_int_eq(target.view().at(x, y), source.view().at(x + 44, y + 38));
}
END_TEST

START_TEST(every_layout_is_drawn_as_defined) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> share(0, 1);
  WindowResampler resampler;
  for (const Layout layout : {Layout{1, 1}, {2, 2}, {3, 3}, {4, 4}, {2, 1}, {4, 1}})
    for (const auto& [big, small] : {std::pair<Size, Size>{{1, 1}, {1, 1}},
                                     {{7, 5}, {3, 2}},
                                     {{61, 43}, {33, 17}},
                                     {{64, 48}, {64, 48}}})
      for (int round = 0; round < 6; ++round) {
        WindowResampler::Grid grid{share(random) * (big.width - small.width),
                                   share(random) * (big.height - small.height), 1, 1};
        if (round == 4) grid.scale_x = grid.scale_y = 0.63;
        if (round == 5) grid = {0, 0, double(big.width) / small.width, double(big.height) / small.height};
        compare(resampler, big, small, layout, grid, random);
      }
}
END_TEST

START_TEST(beyond_the_edge_the_edge_is_repeated) {
  std::mt19937 random(3);
  WindowResampler resampler;
  for (const auto& [left, top] : {std::pair{-3.4, 2.2}, {58.7, 40.9}, {-100.0, 500.0}})
    compare(resampler, {61, 43}, {9, 8}, {1, 1}, {left, top, 1, 1}, random);
}
END_TEST

START_TEST(the_text_about_a_misfit_names_sizes_and_angles) {
  ck_assert(window_misfit({320, 240}, 60, {640, 480}, 0) ==
            "A window of 640 x 480 pixels does not fit into the picture of 320 x 240 pixels.");
  ck_assert(window_misfit({320, 240}, 60, {160, 120}, 75.5) ==
            "A window of 160 x 120 pixels that sees 75.5 degrees does not fit into the picture of 320 x 240 "
            "pixels that sees 60 degrees.");
}
END_TEST

int main() {
  return run_suite(
      "window",
      {the_text_about_a_misfit_names_sizes_and_angles, straight_ahead_is_the_middle_of_the_picture,
       fov_and_reach_are_those_worked_out_by_hand, pan_to_the_right_moves_to_the_right_and_tilt_up_moves_up,
       the_window_has_in_its_middle_what_the_head_looks_at,
       the_window_ends_at_the_pictures_edges_and_reports_it, a_field_of_view_scales_the_window,
       a_window_that_does_not_fit_is_refused, a_whole_position_is_a_copy, every_layout_is_drawn_as_defined,
       beyond_the_edge_the_edge_is_repeated});
}
