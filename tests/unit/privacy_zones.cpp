// SPDX-License-Identifier: LGPL-2.1-or-later
// Which blocks are covered, judged by every pixel: what lies in a polygon is covered, and not much more is; and what is
// written into them, by hand.
#include "overlay/privacy/privacy_zones.h"

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "sensing/angles.h"
#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::overlay;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;
using cerberus::vision::Direction;
using cerberus::vision::Lens;
using cerberus::vision::Size;

namespace {

constexpr Size kSize{320, 180};

PrivacyZones zones(const std::string& text) {
  PrivacyZones zones;
  assert_text(zones.parse(text), "");
  return zones;
}

PrivacyZones::View looking(double pan, double tilt, double margin = 0) {
  return {radians(40), true, radians(pan), radians(tilt), radians(margin)};
}

int covered(const BlockMask& mask) {
  int count = 0;
  for (const auto block : mask.covered) count += block;
  return count;
}

}  // namespace

// A rectangle of pan and tilt: a pixel whose ray lies within it, its corners included, must be covered.
START_TEST(no_pixel_of_a_place_of_the_world_is_seen_wherever_the_camera_looks) {
  std::mt19937 random(7);
  const auto any = [&](double from, double to) { return std::uniform_real_distribution<>(from, to)(random); };
  BlockMask mask;
  long seen = 0, hidden = 0;
  for (int n = 0; n < 50; ++n) {
    const double pan = any(-180, 180), tilt = any(-50, 50);
    const double left = std::remainder(pan + any(-25, 20), 360), width = any(3, 12),
                 low = tilt + any(-14, 10), high = low + any(3, 8);
    if (left < -180 || left + width > 180) continue;  // typed corners are from -180 to 180
    const auto corner = [](double x, double y) { return std::to_string(x) + "," + std::to_string(y) + " "; };
    const PrivacyZones place = zones("world " + corner(left, low) + corner(left + width, low) +
                                     corner(left + width, high) + corner(left, high));
    place.cover(kSize, looking(pan, tilt), mask);
    const Lens lens(radians(40), kSize);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        for (const auto& [dx, dy] : {std::pair{0.0, 0.0}, {1.0, 1.0}, {.5, .5}}) {
          const Direction at = lens.direction({x + dx, y + dy}, radians(pan), radians(tilt));
          const double bearing = degrees(at.bearing), elevation = degrees(at.elevation);
          const double past = std::remainder(bearing - left, 360);
          if (past < 0 || past > width || elevation < low || elevation > high) continue;
          ++seen;
          hidden += mask.at(x / BlockMask::kBlock, y / BlockMask::kBlock);
        }
  }
  ck_assert_int_gt(seen, 50000);
  ck_assert_int_eq(hidden, seen);
}
END_TEST

// 10 x 8 degrees in the middle of 40 degrees: 440 pixels of focal length, 77 x 61.5 of them.
START_TEST(not_much_more_than_the_place_is_covered) {
  const PrivacyZones place = zones("world -5,-4 5,-4 5,4 -5,4");
  BlockMask mask;
  place.cover(kSize, looking(0, 0), mask);
  const int without = covered(mask) * 64;
  ck_assert_int_ge(without, 77 * 61);
  ck_assert_int_le(without, 77 * 61.5 * 1.9);  // a block more on each side
  place.cover(kSize, looking(0, 0, 1), mask);
  ck_assert_int_gt(covered(mask) * 64, without);  // a degree, 7.7 pixels, on each side
  place.cover(kSize, looking(40, 0), mask);
  ck_assert_int_eq(covered(mask), 0);
}
END_TEST

START_TEST(where_the_view_is_unknown_everything_is_covered) {
  const PrivacyZones place = zones("world -5,-4 5,-4 5,4 -5,4");
  BlockMask mask;
  for (int wrong = 0; wrong < 4; ++wrong) {
    PrivacyZones::View view = looking(60, 0);
    if (wrong == 0) view.posed = false;
    if (wrong == 1) view.field_of_view = 0;
    if (wrong == 2) view.pan = std::nan("");
    if (wrong == 3) view.margin = radians(90);
    place.cover(kSize, view, mask);
    ck_assert_int_eq(covered(mask), mask.columns * mask.rows);
  }
  const PrivacyZones picture = zones("0,0 0.1,0 0.1,0.1");
  ck_assert(!picture.need_pose());
  picture.cover(kSize, {}, mask);  // it stays where it is in the picture
  ck_assert(mask.at(0, 0) && !mask.at(30, 15));
}
END_TEST

START_TEST(a_place_behind_180_degrees_is_one_place) {
  const PrivacyZones east = zones("world 175,-4 180,-4 180,4 175,4");
  BlockMask mask;
  east.cover(kSize, looking(-179, 0), mask);  // 1 degree past it: it is to the left of the middle
  ck_assert(mask.at(mask.columns / 2 - 3, mask.rows / 2));
  ck_assert(!mask.at(mask.columns / 2 + 3, mask.rows / 2));
  // Edges go the shorter way: 8 degrees around 180, and not the other 352.
  const PrivacyZones across = zones("world 176,-4 -176,-4 -176,4 176,4");
  across.cover(kSize, looking(180, 0), mask);
  ck_assert(mask.at(mask.columns / 2 - 3, mask.rows / 2) && mask.at(mask.columns / 2 + 3, mask.rows / 2));
  ck_assert(!mask.at(0, mask.rows / 2) && !mask.at(mask.columns - 1, mask.rows / 2));
  across.cover(kSize, looking(0, 0), mask);
  ck_assert_int_eq(covered(mask), 0);
}
END_TEST

START_TEST(what_cannot_be_read_is_said_and_the_old_polygons_stay) {
  PrivacyZones zones;
  assert_text(zones.parse("0,0 1,0 1,1"), "");
  const auto refused = [&](const char* text, const char* words) {
    const std::string error = zones.parse(text);
    ck_assert_msg(error.find(words) != std::string::npos, "%s: %s", text, error.c_str());
    ck_assert_msg(error.starts_with("masks: "), "%s", error.c_str());
    ck_assert(!zones.empty() && !zones.need_pose());
  };
  refused("0,0 1,1", "has 2 corners");
  refused("0,0 1,0 2,1", "\"2,1\" is not a corner: write x,y as fractions");
  refused("world 0,0 10,0 10,91", "\"10,91\" is not a corner: write pan,tilt in degrees");
  refused("earth 0,0 1,0 1,1", "\"earth\" is not a corner");
}
END_TEST

// I420, 16 x 16, one block covered: 64 samples of luma, 16 of each chroma. Y of (.5, .5, .5) in BT.601 is 126.
START_TEST(covered_blocks_have_the_colour_and_no_other_sample_is_touched) {
  std::vector<std::uint8_t> y(256, 7), u(64, 8);
  std::array<BlendComponent, 2> picture;
  picture[0] = {
      .data = y.data(), .stride = 16, .step = 1, .red = .257, .green = .504, .blue = .098, .offset = 16};
  picture[1] = {.data = u.data(),
                .stride = 8,
                .step = 1,
                .shift_x = 1,
                .shift_y = 1,
                .red = -.148,
                .green = -.291,
                .blue = .439,
                .offset = 128};
  BlockMask mask;
  mask.reset({16, 16});
  mask.at(1, 0) = 1;
  cerberus::overlay::fill(mask, Color{.5, .5, .5}, picture);
  for (int row = 0; row < 16; ++row)
    for (int column = 0; column < 16; ++column)
      ck_assert_int_eq(y[row * 16 + column], column >= 8 && row < 8 ? 126 : 7);
  for (int row = 0; row < 8; ++row)
    for (int column = 0; column < 8; ++column)
      ck_assert_int_eq(u[row * 8 + column], column >= 4 && row < 4 ? 128 : 8);
}
END_TEST

// One square: the mean of 0 to 255 is 127.5, in words of 10 bits beginning at bit 6 as in bytes.
START_TEST(squares_show_their_mean) {
  std::vector<std::uint8_t> bytes(256);
  std::vector<std::uint16_t> words(256);
  for (int i = 0; i < 256; ++i)
    bytes[i] = static_cast<std::uint8_t>(i), words[i] = static_cast<std::uint16_t>(i << 6);
  std::array<BlendComponent, 2> picture;
  picture[0] = {.data = bytes.data(), .stride = 16, .step = 1, .red = 1};
  picture[1] = {.data = reinterpret_cast<std::uint8_t*>(words.data()),
                .stride = 32,
                .step = 2,
                .red = 1,
                .bits = 10,
                .word_shift = 6};
  BlockMask mask;
  mask.reset({16, 16});
  mask.at(0, 1) = 1;
  pixelate(mask, 1, picture);
  for (int i = 0; i < 256; ++i) {
    const bool hidden = i % 16 < 8 && i / 16 >= 8;
    ck_assert_int_eq(bytes[i], hidden ? 128 : i);
    ck_assert_int_eq(words[i] >> 6, hidden ? 128 : i);
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "privacy_zones",
      {no_pixel_of_a_place_of_the_world_is_seen_wherever_the_camera_looks,
       not_much_more_than_the_place_is_covered, where_the_view_is_unknown_everything_is_covered,
       a_place_behind_180_degrees_is_one_place, what_cannot_be_read_is_said_and_the_old_polygons_stay,
       covered_blocks_have_the_colour_and_no_other_sample_is_touched, squares_show_their_mean});
}
