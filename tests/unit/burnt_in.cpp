// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/burnt_in/burnt_in.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr Size kSize{320, 240};
constexpr double kRate = 25;
constexpr int kThreshold = 16;

// Two fonts of digits, a bit a dot, the topmost row first: three dots by five, and four by seven.
constexpr int kSmall[10][5] = {{7, 5, 5, 5, 7}, {2, 6, 2, 2, 7}, {7, 1, 7, 4, 7}, {7, 1, 7, 1, 7},
                               {5, 5, 7, 1, 1}, {7, 4, 7, 1, 7}, {7, 4, 7, 5, 7}, {7, 1, 1, 2, 2},
                               {7, 5, 7, 5, 7}, {7, 5, 7, 1, 7}};
constexpr int kTall[10][7] = {{6, 9, 9, 9, 9, 9, 6},  {2, 6, 2, 2, 2, 2, 7},    {6, 9, 1, 2, 4, 8, 15},
                              {6, 9, 1, 6, 1, 9, 6},  {2, 6, 10, 10, 15, 2, 2}, {15, 8, 14, 1, 1, 9, 6},
                              {6, 8, 14, 9, 9, 9, 6}, {15, 1, 2, 2, 4, 4, 4},   {6, 9, 9, 6, 9, 9, 6},
                              {6, 9, 9, 7, 1, 9, 6}};

struct Font {
  const int* dots;
  int columns, rows, scale;
  int width() const { return (columns + 1) * scale; }
  int height() const { return rows * scale; }
};
constexpr Font kFonts[] = {{&kSmall[0][0], 3, 5, 2}, {&kTall[0][0], 4, 7, 2}};

// White on black, as wide as its digits.
Box write(MutableGrayView picture, const std::string& text, const Font& font, int left, int top) {
  const int width = static_cast<int>(text.size()) * font.width() + 2, height = font.height() + 4;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int letter = (x - 2) / font.width(), column = (x - 2) % font.width() / font.scale,
                row = (y - 2) / font.scale;
      bool ink = false;
      if (x >= 2 && y >= 2 && letter < static_cast<int>(text.size()) && column < font.columns &&
          row < font.rows) {
        const char c = text[static_cast<std::size_t>(letter)];
        ink = c == ':' ? column == 1 && (row == 1 || row == 3)
                       : font.dots[(c - '0') * font.rows + row] >> (font.columns - 1 - column) & 1;
      }
      picture.at(left + x, top + y) = ink ? 240 : 16;
    }
  return {static_cast<double>(left), static_cast<double>(top), static_cast<double>(width),
          static_cast<double>(height)};
}

std::string clock_at(double seconds) {
  const int s = static_cast<int>(seconds) + 41;
  char out[40];
  std::snprintf(out, sizeof out, "12:%02d:%02d", s / 60, s % 60);
  return out;
}

// A textured wall, wider than the camera's picture, which stands or goes along it; the scene's and the camera's
// differences as the stages before would make them.
struct World {
  Image<std::uint8_t> wall{{1200, kSize.height}}, picture{kSize}, before{kSize}, difference{kSize},
      mask{kSize};
  BurntIn burnt_in;
  double seconds = 0;
  int position = 400, last_position = 400, frame = 0;

  World() {
    std::mt19937 random(3);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < 1200; ++x) wall.view().at(x, y) = 60;
    for (int i = 0; i < 900; ++i) {
      const int x0 = static_cast<int>(random() % 1190), y0 = static_cast<int>(random() % 230),
                w = 4 + static_cast<int>(random() % 20), h = 4 + static_cast<int>(random() % 20);
      const auto grey = static_cast<std::uint8_t>(40 + random() % 160);
      for (int y = y0; y < std::min(y0 + h, kSize.height); ++y)
        for (int x = x0; x < std::min(x0 + w, 1200); ++x) wall.view().at(x, y) = grey;
    }
  }
  // One frame; speed: analysis pixels by which the scene goes to the right. True where the boxes change.
  bool see(int speed, const std::function<void(MutableGrayView)>& draw) {
    last_position = position;
    position -= speed;
    for (int y = 0; y < kSize.height; ++y)
      std::copy_n(wall.view().row(y) + position, kSize.width, picture.view().row(y));
    if (draw) draw(picture.view());
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        const int from = x - speed;
        const bool known = frame > 0 && from >= 0 && from < kSize.width;
        const int d = known ? std::abs(picture.view().at(x, y) - before.view().at(from, y)) : 0;
        difference.view().at(x, y) = static_cast<std::uint8_t>(d);
        mask.view().at(x, y) = d > kThreshold ? 255 : 0;
      }
    picture.swap(before);
    ++frame;
    seconds += 1 / kRate;
    return burnt_in.update({before.view(), difference.view(), kThreshold, Transform::translation(speed, 0),
                            speed == 0, 1 / kRate},
                           mask.view());
  }
  // To and fro, so that the wall does not end.
  int sweep() const { return frame / 60 % 2 ? 4 : -4; }
  int foreground() const {
    int count = 0;
    for (int y = 0; y < kSize.height; ++y)
      count += static_cast<int>(std::count(mask.view().row(y), mask.view().row(y) + kSize.width, 255));
    return count;
  }
};

constexpr int kCorners[4][2] = {{12, 12}, {200, 12}, {12, 206}, {200, 206}};

bool covers(std::span<const Box> boxes, const Box& writing) {
  double covered = 0;
  for (const Box& b : boxes) covered += overlap_area(b, writing);
  return covered > .5 * writing.area();
}

void fill(MutableGrayView picture, int left, int top, int width, int height, int grey) {
  for (int y = std::max(top, 0); y < std::min(top + height, picture.height); ++y)
    for (int x = std::max(left, 0); x < std::min(left + width, picture.width); ++x)
      picture.at(x, y) = static_cast<std::uint8_t>(grey);
}

}  // namespace

START_TEST(a_clock_is_no_foreground_five_seconds_after_the_start_the_camera_standing_or_turning) {
  for (const bool turns : {false, true})
    for (const Font& font : kFonts)
      for (const auto& [left, top] : kCorners) {
        World world;
        int with_foreground = 0, frames = 0;
        while (world.seconds < 25) {
          world.see(turns ? world.sweep() : 0, [&](MutableGrayView picture) {
            write(picture, clock_at(world.seconds), font, left, top);
          });
          if (world.seconds > 5) ++frames, with_foreground += world.foreground() > 20;
        }
        ck_assert_msg(with_foreground <= frames / 100, "%s, %d rows, at %d %d: %d of %d",
                      turns ? "turning" : "standing", font.height(), left, top, with_foreground, frames);
      }
}
END_TEST

START_TEST(a_logo_that_blinks_is_no_foreground_five_seconds_after_the_start) {
  for (const bool turns : {false, true}) {
    World world;
    int with_foreground = 0, frames = 0;
    while (world.seconds < 20) {
      world.see(turns ? world.sweep() : 0, [&](MutableGrayView picture) {
        if (std::fmod(world.seconds, 1.0) < .5) write(picture, "8008", kFonts[1], 200, 12);
      });
      if (world.seconds > 5) ++frames, with_foreground += world.foreground() > 20;
    }
    ck_assert_msg(with_foreground <= frames / 100, "%s: %d of %d", turns ? "turning" : "standing",
                  with_foreground, frames);
  }
}
END_TEST

START_TEST(its_place_is_reported_once) {
  World world;
  Box clock;
  std::size_t reported = 0;
  while (world.seconds < 15) {
    world.see(world.sweep(), [&](MutableGrayView picture) {
      clock = write(picture, clock_at(world.seconds), kFonts[1], 12, 12);
    });
    reported += world.burnt_in.found().is_new.count();
  }
  ck_assert_uint_eq(reported, 1);
  ck_assert_int_eq(static_cast<int>(world.burnt_in.boxes().size()), 1);
  const Box& found = world.burnt_in.boxes()[0];
  ck_assert(covers(world.burnt_in.boxes(), clock));
  ck_assert_double_lt(found.area(), 2.5 * clock.area());
}
END_TEST

START_TEST(a_person_who_comes_and_stands_waving_is_not_learnt) {
  World world;
  std::mt19937 random(5);
  int arm = 0, leg = 0;
  while (world.seconds < 60) {
    const double t = world.seconds;
    const int x = static_cast<int>(std::min(t * 40, 150.0));
    if (random() % 5 == 0) arm = static_cast<int>(random() % 12);
    if (t * 40 < 150) leg = static_cast<int>(t * 20) % 8;
    world.see(0, [&](MutableGrayView picture) {
      fill(picture, x, 80, 10, 10, 200);
      fill(picture, x - 4, 90, 18, 30, 30);
      fill(picture, x - 12, 95 + arm, 36, 5, 180);
      fill(picture, x - 3 + leg, 120, 6, 30, 90), fill(picture, x + 8 - leg, 120, 6, 30, 90);
    });
    ck_assert_msg(world.burnt_in.boxes().empty(), "after %.1f s", t);
  }
}
END_TEST

// Head and trunk keep their place to the pixel, which no head can do; arms and legs swing.
START_TEST(a_person_followed_by_the_head_is_not_learnt) {
  World world;
  while (world.seconds < 30) {
    const int swing = static_cast<int>(std::lround(7 * std::sin(8 * world.seconds)));
    world.see(world.sweep(), [&](MutableGrayView picture) {
      fill(picture, 150, 80, 10, 10, 200 + (world.frame & 7));
      fill(picture, 146, 90, 18, 30, 30);
      fill(picture, 152, 90, 6, 16, 200);
      fill(picture, 146 + swing, 120, 8, 34, 220), fill(picture, 156 - swing, 120, 8, 34, 20);
    });
    ck_assert_msg(world.burnt_in.boxes().empty(), "after %.1f s", world.seconds);
  }
}
END_TEST

START_TEST(it_is_forgotten_when_it_vanishes) {
  for (const bool turns : {false, true}) {
    World world;
    while (world.seconds < 8)
      world.see(turns ? world.sweep() : 0,
                [&](MutableGrayView picture) { write(picture, clock_at(world.seconds), kFonts[0], 12, 12); });
    ck_assert(!world.burnt_in.boxes().empty());
    const double end = world.seconds + (turns ? 12 : 35);
    while (world.seconds < end) world.see(turns ? world.sweep() : 0, {});
    ck_assert_msg(world.burnt_in.boxes().empty(), "%s", turns ? "turning" : "standing");
  }
}
END_TEST

// What is foreground above and below the writing is so behind it, and nothing else there.
START_TEST(a_person_behind_the_writing_stays_in_one_piece) {
  World world;
  while (world.seconds < 8)
    world.see(0,
              [&](MutableGrayView picture) { write(picture, clock_at(world.seconds), kFonts[0], 100, 100); });
  ck_assert(!world.burnt_in.boxes().empty());
  const Box box = world.burnt_in.boxes()[0];
  MutableGrayView mask = world.mask.view();
  for (int y = 0; y < mask.height; ++y) std::fill_n(mask.row(y), mask.width, std::uint8_t{0});
  const int x = static_cast<int>(box.x) + 4;
  fill(mask, x, static_cast<int>(box.y) - 20, 5, static_cast<int>(box.height) + 40, 255);
  fill(mask, x + 8, static_cast<int>(box.y), 5, static_cast<int>(box.height), 255);
  world.burnt_in.update({world.before.view(), world.difference.view(), kThreshold, {}, true, 1 / kRate},
                        mask);
  for (int y = static_cast<int>(box.y); y < static_cast<int>(box.bottom()); ++y) {
    ck_assert_int_eq(mask.at(x, y), 255);
    ck_assert_int_eq(mask.at(x + 4, y), 255);
    ck_assert_int_eq(mask.at(x + 8, y), 0);
  }
}
END_TEST

START_TEST(a_picture_that_flashes_teaches_nothing) {
  World world;
  while (world.seconds < 20) {
    const bool lit = static_cast<int>(world.seconds) % 2;
    world.see(0, [&](MutableGrayView picture) {
      for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
          picture.at(x, y) = static_cast<std::uint8_t>(picture.at(x, y) / 2 + (lit ? 60 : 0));
    });
    ck_assert(world.burnt_in.boxes().empty());
  }
}
END_TEST

START_TEST(it_allocates_at_the_first_frame_only) {
  World world;
  world.see(0, {});
  const std::size_t before = cerberus::tests::allocations();
  while (world.seconds < 12)
    world.see(world.seconds < 6 ? 0 : world.sweep(), [&](MutableGrayView picture) {
      if (world.frame % 25 < 12) fill(picture, 12, 12, 60, 16, 240);
    });
  ck_assert_uint_eq(cerberus::tests::allocations(), before);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "burnt_in",
      {a_clock_is_no_foreground_five_seconds_after_the_start_the_camera_standing_or_turning,
       a_logo_that_blinks_is_no_foreground_five_seconds_after_the_start, its_place_is_reported_once,
       a_person_who_comes_and_stands_waving_is_not_learnt, a_person_followed_by_the_head_is_not_learnt,
       it_is_forgotten_when_it_vanishes, a_person_behind_the_writing_stays_in_one_piece,
       a_picture_that_flashes_teaches_nothing, it_allocates_at_the_first_frame_only});
}
