// SPDX-License-Identifier: LGPL-2.1-or-later
// The pixels of labels, target brackets, panel, crosshair and trails, from their measures. Text is compared with cairo's.
#include "overlay/marks/labels.h"

#include <cairo.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <vector>

#include "overlay/cairo_helpers.h"
#include "overlay/marks/glyphs.h"
#include "overlay/marks/line_kernels.h"
#include "overlay/marks/radar.h"
#include "overlay/marks/system_panel.h"
#include "overlay/marks/target_marks.h"
#include "overlay/marks/trail_line.h"
#include "overlay/painter.h"
//
#include <check.h>

#include "support/targets.h"

using namespace cerberus::overlay;

namespace {

constexpr double kFont = 20;
constexpr Area kFrame{0, 0, 640, 480};

// The pixel (x, y) of the frame as the patches, which do not overlap, have it.
std::uint32_t pixel(const std::vector<Patch>& patches, int x, int y) {
  for (const Patch& p : patches)
    if (!p.area.intersection({x, y, 1, 1}).empty()) return p.pixels->view().at(x - p.area.x, y - p.area.y);
  return 0;
}

// Expects a word, its bytes within 1: 255 times a product, rounded.
void expect(std::uint32_t is, std::uint32_t should, const char* what) {
  for (int shift = 0; shift < 32; shift += 8)
    if (std::abs(static_cast<int>(is >> shift & 255) - static_cast<int>(should >> shift & 255)) > 1)
      ck_abort_msg("%s: %08x, not %08x", what, is, should);
}

Object object(std::uint32_t id, ObjectState state = ObjectState::seen, double speed = NAN,
              double distance = NAN) {
  Object o;
  o.id = id;
  o.state = state;
  o.speed = speed;
  o.distance = distance;
  return o;
}

struct Writer {
  PicturePool pool;
  Labels labels;
  Writer() { labels.begin(kFont, pool); }
  std::shared_ptr<const Picture> label(const Object& o) { return labels.label(o, true, true); }
};

}  // namespace

START_TEST(letters_are_those_of_cairo_side_by_side) {
  for (const bool bold : {false, true}) {
    Glyphs glyphs;
    glyphs.select(23, bold);
    const int width = 160, height = 40;
    std::vector<std::uint32_t> is(static_cast<std::size_t>(width * height), 0xff000000u), should = is;
    glyphs.draw("47 px/s", 10, 30, {1, 1, 1}, {is.data(), width, height, width});
    const SurfacePtr surface(cairo_image_surface_create_for_data(
        reinterpret_cast<unsigned char*>(should.data()), CAIRO_FORMAT_ARGB32, width, height, 4 * width));
    const ContextPtr cr(cairo_create(surface.get()));
    select_font(cr.get(), 23, bold);
    set_color(cr.get(), {1, 1, 1});
    double x = 10;
    for (const char letter : {'4', '7', ' ', 'p', 'x', '/', 's'}) {
      const char text[2] = {letter, 0};
      cairo_move_to(cr.get(), std::round(x), 30);
      cairo_show_text(cr.get(), text);
      x += text_width(cr.get(), text);
    }
    cairo_surface_flush(surface.get());
    ck_assert_double_eq_tol(glyphs.width("47 px/s"), x - 10, 1e-9);
    int written = 0;
    for (std::size_t i = 0; i < is.size(); ++i) {
      expect(is[i], should[i], "letter");
      written += is[i] == 0xffffffffu;
    }
    ck_assert_int_gt(written, 50);
  }
}
END_TEST

// Height 1.35 * 20 = 27, and a pixel on all sides. Orange is (.902, .624, 0): times .95 and 255 (219, 151, 0); its alpha
// over the dark rim .95 + .05 * .55 = .9775.
START_TEST(a_label_is_a_pill_in_the_colour_of_its_identity) {
  Writer writer;
  const auto label = writer.label(object(1));
  ck_assert_int_eq(label->height, 29);
  const int middle = label->width / 2;
  expect(label->view().at(middle, 3), 0xf9db9700, "body");
  expect(label->view().at(middle, 0), 0x46000000, "rim");  // half covered: .55 / 2
  expect(label->view().at(0, 0), 0, "corner");
  expect(label->view().at(label->width - 1, 28), 0, "corner");
  // .8 of the colour: alpha .8 + .2 * .55 = .91.
  expect(writer.label(object(1, ObjectState::coasted))->view().at(middle, 3), 0xe8b87f00, "coasted");
  // Text on orange is dark.
  bool dark = false;
  for (int y = 8; y < 22; ++y)
    for (int x = 6; x < label->width - 6; ++x) dark = dark || label->view().at(x, y) == 0xff0d0d0du;
  ck_assert(dark);
}
END_TEST

// Without an identity the bars stand alone: 8 before and behind, 10 for the bars, at 9 and 9 + 6.4, 3.2 wide; upright
// from 1 + 27 / 4 = 7.75 on, 13.5 high. Ink is 13 on white times .95, 242.
START_TEST(two_bars_mark_an_object_that_stands) {
  Writer writer;
  const auto label = writer.label(object(0, ObjectState::stopped));
  ck_assert_int_eq(label->width, 28);
  const auto view = label->view();
  for (const int x : {9, 10, 11, 16, 17})
    for (const int y : {8, 14, 20}) expect(view.at(x, y), 0xff0d0d0d, "bar");
  for (const int x : {8, 13, 14, 19}) expect(view.at(x, 14), 0xf9f2f2f2, "beside the bars");
  expect(view.at(12, 14), 0xfac4c4c4, "a fifth");       // 242 - .2 * 229
  expect(view.at(15, 14), 0xfd696969, "three fifths");  // 242 - .6 * 229
  expect(view.at(9, 7), 0xfbb9b9b9, "a quarter");       // 242 - .25 * 229
  expect(view.at(9, 21), 0xfbb9b9b9, "a quarter");
  ck_assert_ptr_null(writer.label(object(0)).get());
}
END_TEST

START_TEST(only_the_numbers_of_a_label_are_drawn_again) {
  Writer writer;
  const auto before = writer.label(object(3, ObjectState::seen, 45.2, 12));
  const std::vector<std::uint32_t> kept = before->words;
  ck_assert_ptr_eq(writer.label(object(3, ObjectState::seen, 45.4, 12)).get(),
                   before.get());  // both "45 px/s"
  const auto after = writer.label(object(3, ObjectState::seen, 46.2, 12));
  ck_assert_ptr_ne(after.get(), before.get());
  ck_assert(before->words == kept);  // may still be held downstream
  ck_assert_int_eq(after->width, before->width);
  int changed = 0;
  for (int y = 0; y < after->height; ++y)
    for (int x = 0; x < after->width; ++x) {
      const bool differs = after->view().at(x, y) != before->view().at(x, y);
      ck_assert_msg(!differs || (x > after->width / 4 && x < after->width * 2 / 3), "%d, %d", x, y);
      changed += differs;
    }
  ck_assert_int_gt(changed, 10);
  // What is drawn piece by piece is what is drawn at once, in another state, and without numbers again.
  Writer other;
  ck_assert(other.label(object(3, ObjectState::seen, 46.2, 12))->words == after->words);
  for (const Object& o :
       {object(3, ObjectState::coasted, 46.2, 12), object(3, ObjectState::stopped, 46.2), object(3)}) {
    Writer fresh;
    ck_assert(fresh.label(o)->words == writer.label(o)->words);
  }
}
END_TEST

// Line 2: brackets 5 outside the box, strokes 3.2 wide from 95 - 1.6 on, arms of .25 * 60 + 5 - 1.6 = 18.4, a casing of
// 1.2 (opacity .6) that does not reach beyond the arms' ends.
START_TEST(brackets_stand_at_the_corners_of_the_target) {
  Object target = object(1);
  target.x = 100, target.y = 80, target.width = 60, target.height = 120;
  PicturePool pool;
  std::vector<Patch> patches;
  draw_target_marks(target, 2, kFrame, pool, patches);
  ck_assert_uint_eq(patches.size(), 4);
  const struct {
    int x, y;
    std::uint32_t word;
  } kExpected[] = {
      {100, 74, 0xffe69f00}, {100, 75, 0xffe69f00}, {94, 90, 0xffe69f00},  // colour: (230, 159, 0)
      {100, 73, 0xd68a5f00},                         // .6 of it; alpha .6 + .4 * .6 = .84
      {100, 72, 0x7a000000}, {100, 77, 0x7a000000},  // .8 of the casing
      {94, 93, 0x8b5c4000},                          // .4 of colour and casing: alpha .4 + .6 * .24
      {100, 78, 0},          {110, 90, 0},          {91, 80, 0},
      {120, 74, 0},          {112, 76, 0xd68a5f00}, {113, 74, 0x8b5c4000},
  };
  for (const auto& [x, y, word] : kExpected) {
    expect(pixel(patches, x, y), word, "upper left");
    expect(pixel(patches, 259 - x, y), word, "upper right");
    expect(pixel(patches, x, 279 - y), word, "lower left");
    expect(pixel(patches, 259 - x, 279 - y), word, "lower right");
  }
}
END_TEST

// Edge 12, margin 10, rows of 27 pixels from 17 on, lights of radius 10 every 24: middles at 32, 56, 80 and 30.5.
START_TEST(the_panel_shows_the_sensors_as_lights_in_their_order) {
  PicturePool pool;
  SystemPanel panel;
  ck_assert_ptr_null(panel.patch({}, kFont, kFrame, pool).pixels.get());
  System system;
  system.decision = true;
  system.action = "hold";
  system.lights = {{2, 1}, {1, 0}, {3, 2}};
  const Patch patch = panel.patch(system, kFont, kFrame, pool);
  const std::vector<Patch> one{patch};
  ck_assert_int_eq(patch.area.height, 39);  // 10 + 27, and a pixel on both sides
  expect(pixel(one, 24, 30), 0xffff2619, "red: detects");
  expect(pixel(one, 48, 30), 0xff2659ff, "blue: does not");
  expect(pixel(one, 72, 30), 0xff808080, "grey: invalid");
  expect(pixel(one, 20, 17), 0x99000000, "ground: .6");
  expect(pixel(one, 11, 11), 0, "round corner");
  int white = 0;
  for (int y = 20; y < 41; ++y)
    for (int x = 95; x < patch.area.x + patch.area.width; ++x) white += pixel(one, x, y) == 0xffffffffu;
  ck_assert_int_gt(white, 20);  // "hold"
  ck_assert_ptr_eq(panel.patch(system, kFont, kFrame, pool).pixels.get(), patch.pixels.get());
  system.lights[1].reading = 1;
  const std::vector<Patch> next{panel.patch(system, kFont, kFrame, pool)};
  expect(pixel(next, 48, 30), 0xffff2619, "red now");
  system.pose = true;
  ck_assert_int_eq(panel.patch(system, kFont, kFrame, pool).area.height, 66);  // two rows
}
END_TEST

// Radius .13 x 480 = 62.4 pixels in a rim of 6.24, .02 x 640 = 12.8 from the edges: the middle is (81.44, 398.56).
START_TEST(the_radar_shows_sensors_view_and_objects_where_they_are) {
  PicturePool pool;
  Radar radar;
  radar.field_of_view = std::numbers::pi / 3;
  radar.pan = std::numbers::pi / 2;  // to the right
  constexpr double kSide = 2 * std::numbers::pi / 3;
  radar.sensors = {{0, 0, 0, 1, false}, {-kSide, 0, 0, 0, false}, {kSide, 0, 0, 1, true}};
  divide_round(radar.sensors);
  radar.objects = {{1, std::numbers::pi / 2, 6, true}, {2, std::numbers::pi, 100, false}};
  const std::vector<Patch> drawn{draw_radar(radar, kFrame, pool)};
  const auto at = [&](double bearing, double metres) {  // red, green, blue
    const double away = metres / 12 * 62.4;
    const std::uint32_t word = pixel(drawn, static_cast<int>(81.44 + away * std::sin(bearing)),
                                     static_cast<int>(398.56 - away * std::cos(bearing)));
    return std::array{static_cast<int>(word >> 16 & 255), static_cast<int>(word >> 8 & 255),
                      static_cast<int>(word & 255)};
  };
  const auto ahead = at(.2, 9), left = at(-kSide, 9), right = at(kSide + .6, 9), view = at(1.8, 9);
  ck_assert(ahead[0] > 150 && ahead[1] < 60);                 // detects
  ck_assert(left[2] > left[0] + 20 && left[0] < 80);          // does not
  ck_assert(right[0] > right[2] + 20 && right[0] < 120);      // does not count
  ck_assert(view[0] > 120 && view[1] > 100 && view[2] < 60);  // yellow
  ck_assert(at(.95, 9)[0] > 150 && at(-.95, 9)[0] > 150 && at(1.15, 9)[1] > 60 && at(-1.15, 9)[0] < 80);
  const Color one = identity_color(1);
  const auto dot = at(std::numbers::pi / 2, 6), rim = at(std::numbers::pi / 2, 6 - 1.6);
  ck_assert(std::abs(dot[0] - 255 * one.r) < 12 && std::abs(dot[2] - 255 * one.b) < 12);
  ck_assert(rim[0] > 200 && rim[1] > 200 && rim[2] > 200);  // of the target
  const Color two = identity_color(2);
  ck_assert(std::abs(at(std::numbers::pi, 11.9)[2] - 255 * two.b) < 12);  // at the rim, whatever its distance
  expect(pixel(drawn, 12, 330), 0, "corner");
  ck_assert_ptr_null(draw_radar(radar, {0, 0, 80, 60}, pool).pixels.get());
}
END_TEST

START_TEST(sectors_end_halfway_to_the_neighbours) {
  const auto degrees = [](double radians) { return std::lround(radians * 180 / std::numbers::pi); };
  const auto radians = [](double degrees) { return degrees * std::numbers::pi / 180; };
  std::vector<RadarSensor> three{{radians(-20)}, {0}, {radians(20)}}, alone{{1}},
      behind{{radians(170)}, {radians(-150)}};
  for (auto* sensors : {&three, &alone, &behind}) divide_round(*sensors);
  ck_assert(degrees(three[0].left) == 60 && degrees(three[0].right) == 10);
  ck_assert(degrees(three[1].left) == 10 && degrees(three[1].right) == 10);
  ck_assert(degrees(alone[0].left) == 60 && degrees(alone[0].right) == 60);
  ck_assert(degrees(behind[0].right) == 20 && degrees(behind[1].left) == 20 &&
            degrees(behind[1].right) == 60);
}
END_TEST

// Arms from 8.64 to 28.8 from the middle (320, 240), 2 wide, casing 4.4 wide.
START_TEST(the_crosshair_leaves_its_middle_free) {
  Painter painter;
  Scene scene;
  scene.frame = {640, 480};
  scene.line_width = 2;
  scene.crosshair = true;
  std::vector<Patch> patches;
  painter.paint(scene, patches);
  ck_assert_uint_eq(patches.size(), 1);
  for (const int along : {300, 339}) {
    for (const int across : {-1, 0}) {
      expect(pixel(patches, along, 240 + across), 0xffffffff, "level arm");
      expect(pixel(patches, 320 + across, along - 80), 0xffffffff, "upright arm");
    }
    expect(pixel(patches, along, 238), 0x99000000, "casing");
    expect(pixel(patches, along, 237), 0x1f000000, "a fifth of the casing");
    expect(pixel(patches, along, 236), 0, "beside");
  }
  expect(pixel(patches, 316, 240), 0, "gap");
  expect(pixel(patches, 287, 240), 0, "beyond");
  ck_assert_uint_gt(pixel(patches, 320, 240) >> 24, 200);  // the dot in the middle
}
END_TEST

// All fresh: freshness 1 - .5 / 8, width 4 (.5 + .7 * .9375) = 4.625, casing 1.4 to both sides.
START_TEST(a_fresh_trail_is_a_line_with_a_casing) {
  Trails::Trail trail{1, {}};
  for (int k = 0; k <= 50; ++k) trail.points.push_back({{20 + 2.0 * k, 50}, 3});
  TrailLine line;
  PicturePool pool;
  std::vector<Patch> patches;
  line.draw(trail, {3, 2, 4}, kFrame, pool, patches);
  for (const int x : {30, 70, 100}) {
    for (const int y : {48, 49, 50, 51}) expect(pixel(patches, x, y), 0xf2db9700, "line");  // .95
    for (const int y : {47, 52})
      expect(pixel(patches, x, y), 0x9b442f00, "edge");  // .3125 of the line, .6875 of .45
    for (const int y : {46, 53}) expect(pixel(patches, x, y), 0x52000000, "casing");  // .7125 of .45
    for (const int y : {45, 54}) expect(pixel(patches, x, y), 0, "beside");
  }
}
END_TEST

// The deepest stretch counts; columns and rows as far as they were asked for.
START_TEST(depths_are_those_of_the_definition) {
  std::mt19937 random(5);
  const auto between = [&](double low, double high) {
    return static_cast<float>(std::uniform_real_distribution<double>(low, high)(random));
  };
  constexpr int kSide = 48;
  for (int round = 0; round < 50; ++round) {
    std::vector<float> depth(kSide * kSide, -1e6f), strength(kSide * kSide, 0);
    const DepthMap map{depth.data(), strength.data(), kSide};
    std::vector<Stretch> stretches;
    for (int k = 0; k < 5; ++k) {
      stretches.push_back(
          {between(0, 48), between(0, 48), between(-9, 9), between(-9, 9), between(0.3, 4), between(0, 1)});
      if (k == 4) stretches.back().dx = stretches.back().dy = 0;  // a dot
      measure_stretch(stretches.back(), map, 3, 41, 5, 40);
    }
    for (int y = 0; y < kSide; ++y)
      for (int x = 3; x < 41; ++x) {
        double best = -1e6, chosen = 0;
        for (const Stretch& s : stretches) {
          const double px = x + 0.5 - s.x, py = y + 0.5 - s.y, square = s.dx * s.dx + s.dy * s.dy;
          const double t = square > 0 ? std::clamp((px * s.dx + py * s.dy) / square, 0.0, 1.0) : 0;
          const double here = s.half - std::hypot(px - t * s.dx, py - t * s.dy);
          if (here > best) best = here, chosen = s.strength;
        }
        if (y < 5 || y >= 40) best = -1e6, chosen = 0;
        const auto at = static_cast<std::size_t>(y * kSide + x);
        if (std::abs(depth[at] - best) > 1e-3) ck_abort_msg("depth %g, not %g", depth[at], best);
        if (std::abs(strength[at] - chosen) > 1e-6) {  // two as deep
          const bool tie =
              std::ranges::any_of(stretches, [&](const Stretch& s) { return s.strength == strength[at]; });
          if (!tie) ck_abort_msg("strength %g, not %g", strength[at], chosen);
        }
      }
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite_on_every_target(
      "marks",
      {letters_are_those_of_cairo_side_by_side, a_label_is_a_pill_in_the_colour_of_its_identity,
       two_bars_mark_an_object_that_stands, only_the_numbers_of_a_label_are_drawn_again,
       brackets_stand_at_the_corners_of_the_target, the_panel_shows_the_sensors_as_lights_in_their_order,
       the_radar_shows_sensors_view_and_objects_where_they_are, sectors_end_halfway_to_the_neighbours,
       the_crosshair_leaves_its_middle_free, a_fresh_trail_is_a_line_with_a_casing,
       depths_are_those_of_the_definition});
}
