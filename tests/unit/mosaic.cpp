// SPDX-License-Identifier: LGPL-2.1-or-later
// The part of the background model that lies beyond the picture.
#include "vision/background/mosaic.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "support/allocations.h"
#include "support/motions.h"
#include "support/suite.h"
#include "vision/image/shift_content.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr Size kSize{80, 64};
constexpr int kStep = 12, kOld = 30;

int texture(int x, int y) {
  const unsigned n = static_cast<unsigned>(x * 7919 + y * 104729 + 12345);
  return static_cast<int>(40 + (n ^ n >> 7) % 160);
}
int even_wall(int, int) {
  return 90;
}
// Rises by a level every two columns and four rows.
int slope(int x, int y) {
  return 60 + x / 2 + y / 4;
}

// A model that has learnt all of the scene that its picture shows; `left`, `top`: of the picture in the scene.
class Model {
 public:
  explicit Model(int (*scene)(int, int), std::uint8_t spread = 20) : scene_(scene), spread_of_all_(spread) {
    mean_.resize(kSize);
    for (auto* plane : {&spread_, &age_, &quiet_}) plane->resize(kSize);
    mosaic.preallocate(kSize);
    learn();
  }
  BackgroundPixels pixels() { return {mean_.view(), spread_.view(), age_.view(), quiet_.view()}; }
  void learn() {
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        mean_.view().at(x, y) = static_cast<std::uint16_t>(scene_(left + x, top + y) << 8);
        spread_.view().at(x, y) = spread_of_all_;
        age_.view().at(x, y) = kOld;
        quiet_.view().at(x, y) = 200;
      }
  }
  // The picture moves to the right and down by this. Only content that the mosaic holds is restored in the new part.
  void look(int dx, int dy) {
    const Transform next = Transform::translation(-dx, -dy);
    mosaic.store(pixels(), next);
    shift_content<std::uint16_t>(mean_.view(), -dx, -dy, 0);
    for (auto* plane : {&spread_, &age_}) shift_content<std::uint8_t>(plane->view(), -dx, -dy, 0);
    shift_content<std::uint8_t>(quiet_.view(), -dx, -dy, 77);
    mosaic.restore(pixels(), next);
    left += dx;
    top += dy;
  }
  // To and back again by steps; all is learnt on the way there, nothing on the way back.
  void go_and_return(int dx, int dy, int steps) {
    for (int k = 0; k < steps; ++k) look(dx, dy), learn();
    for (int k = 0; k < steps; ++k) look(-dx, -dy);
  }
  long unknown() {
    const auto a = age_.view();
    long n = 0;
    for (int y = 0; y < kSize.height; ++y) n += std::count(a.row(y), a.row(y) + kSize.width, 0);
    return n;
  }

  Mosaic mosaic;
  int left = 0, top = 0;

 private:
  int (*scene_)(int, int);
  std::uint8_t spread_of_all_;
  Image<std::uint16_t> mean_;
  Image<std::uint8_t> spread_, age_, quiet_;
};

}  // namespace

START_TEST(content_that_left_comes_back_as_means_of_4_by_4_pixels) {
  struct Way {
    int dx, dy, steps;
  };
  for (const Way way : {Way{kStep, 0, 4}, Way{-kStep, 0, 4}, Way{5, 0, 7}, Way{0, 3, 2}, Way{-7, 2, 3}}) {
    Model model(texture);
    model.go_and_return(way.dx, way.dy, way.steps);
    const auto p = model.pixels();
    long returned = 0;
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        if (p.age.at(x, y) != Mosaic::kOldest) continue;
        // By definition, in the picture's own squares: its corner is a cell's corner.
        double sum = 0;
        for (int v = y / 4 * 4; v < y / 4 * 4 + 4; ++v)
          for (int u = x / 4 * 4; u < x / 4 * 4 + 4; ++u) sum += texture(u, v);
        ck_assert_double_eq_tol(p.mean.at(x, y) / 256.0, sum / 16, 0.51);
        ck_assert_int_eq(p.quiet.at(x, y), 0);
        ++returned;
      }
    // All that went out of the picture but the cells that its other edges cut.
    const long out = kSize.area() - (kSize.width - std::abs(way.dx * way.steps)) *
                                        static_cast<long>(kSize.height - std::abs(way.dy * way.steps));
    ck_assert_int_ge(returned, out - (way.dy ? 16 * kSize.width + 16 * kSize.height : 0));
    if (way.dy == 0) ck_assert_int_eq(model.unknown(), 0);
  }
}
END_TEST

START_TEST(details_that_the_means_leave_out_count_as_spread) {
  Model flat(even_wall);
  flat.go_and_return(kStep, 0, 2);
  ck_assert_int_eq(flat.pixels().spread.at(0, 0), 20);
  // Columns of 80 and 110 by turns: 15 grey levels from their mean, in sixteenths.
  Model stripes([](int x, int) { return x % 2 ? 110 : 80; });
  stripes.go_and_return(kStep, 0, 2);
  ck_assert_int_eq(stripes.pixels().spread.at(0, 0), 15 * 16);
  ck_assert_int_eq(stripes.pixels().mean.at(0, 0), 95 << 8);
}
END_TEST

START_TEST(pixels_without_age_are_not_stored) {
  Model model(texture);
  const auto p = model.pixels();
  for (int y = 0; y < kSize.height; ++y) std::fill_n(p.age.row(y), 24, std::uint8_t{0});
  model.go_and_return(kStep, 0, 1);
  // The model learnt them on the way, but they had no age at the step itself.
  ck_assert_int_eq(p.age.at(0, 0), 0);
  ck_assert_int_eq(p.age.at(kStep - 1, 20), 0);
}
END_TEST

START_TEST(the_mosaic_follows_the_camera_and_drops_its_far_end) {
  for (const int way : {kStep, -kStep}) {
    Model model(slope);
    // Two pictures.
    const int steps = 2 * kSize.width / kStep;
    for (int k = 0; k < steps; ++k) model.look(way, 0), model.learn();
    int background = 0, unknown = 0;
    const int x = way > 0 ? 2 : kSize.width - 3;
    for (int k = 0; k < steps; ++k) {
      model.look(-way, 0);
      const auto p = model.pixels();
      if (p.age.at(x, 30) == 0) {
        ++unknown;
        continue;
      }
      // All restored content is right, and none lies beyond a gap.
      ck_assert_int_eq(unknown, 0);
      ck_assert_int_le(std::abs((p.mean.at(x, 30) >> 8) - slope(model.left + x, model.top + 30)), 2);
      ++background;
    }
    // The mosaic is two and a half pictures wide, one of which is this one, and follows by steps of its own.
    ck_assert_int_ge(background * kStep, kSize.width);
    ck_assert_int_le(background * kStep, kSize.width * 3 / 2);
    ck_assert_int_gt(unknown, 0);
  }
}
END_TEST

START_TEST(a_turning_camera_restores_content_at_its_place) {
  // As a rotating camera sees it, 70 pixels of focal length: 0.05 radians a step, 5 there and 5 back.
  const double f = 70, angle = 0.05;
  const auto turn = [&](double a) {
    const double c = std::cos(a), s = std::sin(a);
    const Transform rotation{{c, 0, -s * f, 0, 1, 0, s / f, 0, c}};
    const Point m{(kSize.width - 1) / 2.0, (kSize.height - 1) / 2.0};
    return Transform::translation(m.x, m.y) * rotation * Transform::translation(-m.x, -m.y);
  };
  Model model(slope);
  const auto p = model.pixels();
  Transform seen;  // first picture's pixel to this one's
  const auto draw = [&](bool all) {
    const Transform back = seen.inverse();
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        const Point q = back.apply({static_cast<double>(x), static_cast<double>(y)});
        const bool before = q.x >= 0 && q.x < kSize.width && q.y >= 0 && q.y < kSize.height;
        p.age.at(x, y) = all || before ? kOld : 0;
        p.mean.at(x, y) = static_cast<std::uint16_t>((60 + q.x / 2 + q.y / 4) * 256);
        p.spread.at(x, y) = 20;
      }
  };
  for (int k = 0; k < 5; ++k) {
    model.mosaic.store(p, turn(angle));
    seen = turn(angle) * seen;
    draw(true);
    model.mosaic.restore(p, turn(angle));
  }
  long recalled = 0;
  for (int k = 0; k < 5; ++k) {
    model.mosaic.store(p, turn(-angle));
    const Transform next = turn(-angle);
    // The model follows the camera: pixels that the picture before did not show have no age.
    Image<std::uint8_t> background(kSize);
    const Transform back = next.inverse();
    seen = next * seen;
    draw(true);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        const Point q = back.apply({static_cast<double>(x), static_cast<double>(y)});
        if (q.x >= 0 && q.x < kSize.width && q.y >= 0 && q.y < kSize.height) continue;
        p.age.at(x, y) = 0;
        p.mean.at(x, y) = 0;
      }
    model.mosaic.restore(p, next);
    const Transform first = seen.inverse();
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        const Point q = first.apply({static_cast<double>(x), static_cast<double>(y)});
        // The model's own content stays.
        if (p.age.at(x, y) == kOld)
          ck_assert_double_eq_tol(p.mean.at(x, y) / 256.0, 60 + q.x / 2 + q.y / 4, 0.01);
        if (p.age.at(x, y) != Mosaic::kOldest) continue;
        // A quarter's size to each side: 4 pixels, and what the perspective stretches.
        ck_assert_double_eq_tol(p.mean.at(x, y) / 256.0, 60 + q.x / 2 + q.y / 4, 4);
        ++recalled;
      }
  }
  ck_assert_int_ge(recalled, 5 * 3 * kSize.height / 2);
}
END_TEST

START_TEST(content_that_comes_back_in_another_light_is_dropped) {
  for (const int change : {0, 5, -30, 30}) {
    Model model(even_wall, 10);
    model.go_and_return(kStep, 0, 1);
    const auto p = model.pixels();
    Image<std::uint8_t> frame(kSize), background(kSize);
    std::vector<RowSpan> shown(static_cast<std::size_t>(kSize.height), {0, kSize.width});
    for (int y = 0; y < kSize.height; ++y) {
      std::fill_n(frame.view().row(y), kSize.width, static_cast<std::uint8_t>(90 + change));
      std::fill_n(background.view().row(y), kSize.width, std::uint8_t{90});
    }
    p.age.at(5, 30) = kOld;
    model.mosaic.verify(p, frame.view(), background.view(), shown);
    ck_assert_int_eq(p.age.at(3, 30), std::abs(change) > 20 ? 0 : Mosaic::kOldest);
    ck_assert_int_eq(p.age.at(5, 30), kOld);
    ck_assert_int_eq(p.age.at(kStep, 30), kOld);
    // Only once.
    for (int y = 0; y < kSize.height; ++y) std::fill_n(frame.view().row(y), kSize.width, std::uint8_t{0});
    model.mosaic.verify(p, frame.view(), background.view(), shown);
    ck_assert_int_eq(p.age.at(3, 30), std::abs(change) > 20 ? 0 : Mosaic::kOldest);
  }
  // A person filling half of it is no reason, nor are pixels outside the frame.
  for (const bool person : {true, false}) {
    Model model(even_wall, 10);
    model.go_and_return(kStep, 0, 1);
    const auto p = model.pixels();
    Image<std::uint8_t> frame(kSize), background(kSize);
    std::vector<RowSpan> shown(static_cast<std::size_t>(kSize.height), {person ? 0 : kStep - 2, kSize.width});
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        background.view().at(x, y) = 90;
        frame.view().at(x, y) = person ? (y < kSize.height / 2 ? 10 : 90) : (x < kStep - 2 ? 10 : 90);
      }
    model.mosaic.verify(p, frame.view(), background.view(), shown);
    ck_assert_int_eq(p.age.at(3, 30), Mosaic::kOldest);
  }
}
END_TEST

START_TEST(a_change_of_light_reaches_content_out_of_view) {
  Model model(even_wall);
  model.look(kStep, 0);
  model.mosaic.relight(128, 10 * 256);
  model.look(-kStep, 0);
  ck_assert_int_eq(model.pixels().mean.at(0, 0), (90 / 2 + 10) << 8);
}
END_TEST

START_TEST(a_reset_drops_the_old_scene) {
  Model model(texture);
  for (int k = 0; k < 3; ++k) model.look(kStep, 0), model.learn();
  model.mosaic.reset(kSize);
  for (int k = 0; k < 3; ++k) model.look(-kStep, 0);
  ck_assert_int_eq(model.unknown(), 3 * kStep * kSize.height);
  // Nor does it come back when content is stored again.
  model.go_and_return(kStep, 0, 3);
  model.learn();
  model.mosaic.reset(kSize);
  model.look(kStep, 0);
  ck_assert_int_eq(model.unknown(), kStep * kSize.height);
}
END_TEST

START_TEST(a_zoom_beyond_the_limit_drops_the_content) {
  for (const double zoom : {1.5, 2.5, 0.4}) {
    Model model(even_wall);
    model.look(kStep, 0);
    model.mosaic.restore(model.pixels(), similarity(zoom, 0, 0, 0));
    model.mosaic.restore(model.pixels(), similarity(1 / zoom, 0, 0, 0));
    model.look(-kStep, 0);
    ck_assert_int_eq(model.pixels().age.at(2, 30), zoom == 1.5 ? Mosaic::kOldest : 0);
  }
}
END_TEST

START_TEST(impossible_motions_do_no_harm_and_nothing_is_allocated) {
  Model model(texture);
  const auto p = model.pixels();
  const std::size_t before = allocations();
  for (const Transform& t :
       {Transform::translation(1e7, -1e7), Transform::translation(kSize.width, kSize.height),
        similarity(3, 0, 0, 0), similarity(0.2, 1, 5, 5), similarity(1, 3.1, 0, 0),
        Transform{{1, 0, 0, 0, 1, 0, 0.012, 0, 1}}, Transform{}}) {
    model.mosaic.store(p, t);
    model.mosaic.restore(p, t);
    model.learn();
  }
  ck_assert_uint_eq(allocations(), before);
  // Three eighths of a byte a pixel at most.
  ck_assert_uint_le(model.mosaic.bytes(), static_cast<std::size_t>(kSize.area()) * 3 / 8);
}
END_TEST

int main() {
  return run_suite(
      "mosaic",
      {content_that_left_comes_back_as_means_of_4_by_4_pixels,
       details_that_the_means_leave_out_count_as_spread, pixels_without_age_are_not_stored,
       the_mosaic_follows_the_camera_and_drops_its_far_end, a_turning_camera_restores_content_at_its_place,
       content_that_comes_back_in_another_light_is_dropped, a_change_of_light_reaches_content_out_of_view,
       a_reset_drops_the_old_scene, a_zoom_beyond_the_limit_drops_the_content,
       impossible_motions_do_no_harm_and_nothing_is_allocated});
}
