// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/zones/zones.h"

#include <check.h>

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "support/german.h"
#include "support/suite.h"
#include "vision/detector.h"

using namespace cerberus::vision;

namespace {

void accepted(Zones& zones, const char* text) {
  const std::string error = zones.parse(text);
  ck_assert_msg(error.empty(), "%s", error.c_str());
}

std::vector<std::string> drawn(const char* text, Size size, const std::optional<Zones::View>& view = {}) {
  Zones zones;
  accepted(zones, text);
  Image<std::uint8_t> plane(size);
  zones.draw(plane.view(), view);
  std::vector<std::string> rows;
  for (int y = 0; y < size.height; ++y) {
    rows.emplace_back();
    for (int x = 0; x < size.width; ++x) rows.back() += plane.view().at(x, y) == 255 ? '#' : '.';
  }
  return rows;
}

void same_picture(const std::vector<std::string>& rows, const std::vector<std::string>& expected) {
  ck_assert_uint_eq(rows.size(), expected.size());
  for (std::size_t y = 0; y < rows.size(); ++y) ck_assert_str_eq(rows[y].c_str(), expected[y].c_str());
}

// The error names the word and the correct form.
void refused(const char* text, std::string_view word, std::string_view advice) {
  Zones zones;
  const std::string error = zones.parse(text);
  ck_assert_msg(error.find(word) != std::string::npos, "%s", error.c_str());
  ck_assert_msg(error.find(advice) != std::string::npos, "%s", error.c_str());
  ck_assert_msg(error.find("for example") != std::string::npos, "%s", error.c_str());
  ck_assert(zones.everywhere());
}

}  // namespace

START_TEST(without_polygons_motion_counts_everywhere) {
  for (const char* text : {"", "   ", ";", " ; ; \n"}) same_picture(drawn(text, {3, 2}), {"###", "###"});
}
END_TEST

START_TEST(an_included_rectangle_covers_the_pixels_whose_centres_it_holds) {
  // x from 2 to 6 of 8 pixels, y from 1 to 3 of 4.
  same_picture(drawn("include 0.25,0.25 0.75,0.25 0.75,0.75 0.25,0.75", {8, 4}),
               {"........", "..####..", "..####..", "........"});
  // The full picture, corners on its very edge.
  same_picture(drawn("include 0,0 1,0 1,1 0,1", {3, 2}), {"###", "###"});
}
END_TEST

START_TEST(a_triangle_is_cut_where_centres_cross_its_side) {
  // Corners (0,0) (4,4) (0,4): centres with x <= y are inside or on the diagonal; on it x = y belongs to the
  // right.
  same_picture(drawn("include 0,0 1,1 0,1", {4, 4}), {"....", "#...", "##..", "###."});
}
END_TEST

START_TEST(an_exclude_takes_away_from_everywhere_and_from_includes_whatever_the_order) {
  same_picture(drawn("exclude 0,0 0.5,0 0.5,1 0,1", {4, 1}), {"..##"});
  same_picture(drawn("exclude 0,0 0.5,0 0.5,1 0,1; include 0,0 0.75,0 0.75,1 0,1", {4, 1}), {"..#."});
  same_picture(drawn("include 0,0 0.25,0 0.25,1 0,1\ninclude 0.75,0 1,0 1,1 0.75,1;", {4, 1}), {"#..#"});
}
END_TEST

START_TEST(a_polygon_that_crosses_itself_is_filled_even_odd) {
  // A square drawn twice round encloses nothing.
  same_picture(drawn("include 0,0 1,0 1,1 0,1 0,0 1,0 1,1 0,1", {3, 1}), {"..."});
  // An hourglass (0,0) (4,0) (0,4) (4,4): on row 0.5 from 0.5 to 3.5, on row 1.5 from 1.5 to 2.5.
  same_picture(drawn("include 0,0 1,0 0,1 1,1", {4, 4}), {"###.", ".#..", ".#..", "###."});
}
END_TEST

START_TEST(wrong_words_are_named_with_what_to_write_instead) {
  refused("includ 0,0 1,0 1,1", "\"includ\"", "include nor exclude");
  refused("0,0 1,0 1,1", "\"0,0\"", "include nor exclude");
  refused("include 0,0 1,0 1;1", "\"1\"", "x,y");
  refused("include 0,0 1,0 0.5,1.2", "\"0.5,1.2\"", "from 0 to 1");
  refused("include 0,0 1,0 -0.1,1", "\"-0.1,1\"", "from 0 to 1");
  refused("include 0,0 1,0 0,5,0,5", "\"0,5,0,5\"", "decimal points");
  refused("include 0,0 1,0 nan,1", "\"nan,1\"", "x,y");
  refused("include 0,0 1,0 0.5px,1", "\"0.5px,1\"", "x,y");
  refused("include 0,0 1,0 , ", "\",\"", "x,y");
  refused("include 0,0 1,1; exclude", "include 0,0 1,1", "2 corners");
  refused("exclude", "\"exclude\"", "at least three");
  refused("exclude world 0,0 190,0 1,1", "\"190,0\"", "pan,tilt in degrees");
  refused("exclude world 0,0 1,95 1,1", "\"1,95\"", "pan,tilt in degrees");
}
END_TEST

START_TEST(a_wrong_text_leaves_the_old_polygons_in_place) {
  Zones zones;
  accepted(zones, "exclude 0,0 0.5,0 0.5,1 0,1");
  ck_assert(!zones.parse("nonsense").empty());
  Image<std::uint8_t> mask({4, 1});
  mask.fill_bytes(255);
  zones.apply(mask.view());
  ck_assert_int_eq(mask.view().at(1, 0), 0);
  ck_assert_int_eq(mask.view().at(2, 0), 255);
}
END_TEST

START_TEST(the_mask_loses_what_does_not_count_at_every_size_and_after_every_change) {
  Zones zones;
  accepted(zones, "include 0,0 0.5,0 0.5,1 0,1");
  for (const int width : {4, 8, 4}) {
    Image<std::uint8_t> mask({width, 2});
    mask.fill_bytes(255);
    mask.view().at(0, 1) = 0;
    zones.apply(mask.view());
    ck_assert_int_eq(mask.view().at(0, 0), 255);
    ck_assert_int_eq(mask.view().at(0, 1), 0);
    ck_assert_int_eq(mask.view().at(width / 2 - 1, 1), 255);
    ck_assert_int_eq(mask.view().at(width / 2, 0), 0);
  }
  accepted(zones, "exclude 0,0 0.5,0 0.5,1 0,1");
  Image<std::uint8_t> mask({4, 2});
  mask.fill_bytes(255);
  zones.apply(mask.view());
  ck_assert_int_eq(mask.view().at(0, 0), 0);
  ck_assert_int_eq(mask.view().at(3, 0), 255);
}
END_TEST

// A sliver may hold no pixel's centre in a small picture, and some in a large one.
START_TEST(polygons_that_leave_nothing_are_known_once_a_mask_was_seen) {
  Zones zones;
  const auto nowhere = [&](const char* text, int width) {
    accepted(zones, text);
    ck_assert(!zones.nowhere());
    Image<std::uint8_t> mask({width, 4});
    zones.apply(mask.view());
    return zones.nowhere();
  };
  ck_assert(nowhere("include 0.5,0.5 0.5,0.5 0.5,0.5", 4));
  ck_assert(nowhere("exclude 0,0 1,0 1,1 0,1", 4));
  ck_assert(nowhere("include 0,0 0.1,0 0.1,1 0,1", 4));
  ck_assert(!nowhere("include 0,0 0.1,0 0.1,1 0,1", 40));
  ck_assert(!nowhere("exclude 0,0 1,0 1,0.7 0,0.7", 4));
  ck_assert(!nowhere("", 4));
}
END_TEST

START_TEST(decimal_points_are_read_in_a_german_locale) {
  if (const cerberus::tests::German german; german)
    same_picture(drawn("exclude 0,0 0.5,0 0.5,1 0,1", {4, 1}), {"..##"});
}
END_TEST

// A lens of 90 degrees over 8 x 8 pixels: focal length 4, so that column centres lie at 3.5, 2.5, 1.5, .5 pixels from
// the axis on both sides: 41.2, 32.0, 20.6, 7.1 degrees; rows on the axis's column likewise (up and down), and a
// little less beside it. By hand: elevation = atan(up / hypot(4, right)).
constexpr double kDegree = 3.14159265358979323846 / 180;

Zones::View looking(double pan, double tilt = 0) {
  return {{Lens(90 * kDegree, {8, 8}), pan * kDegree, tilt * kDegree}, {8, 8}};
}

constexpr char kAhead[] = "exclude world -25,80 25,80 25,-80 -25,-80";

START_TEST(a_zone_of_the_world_moves_through_the_picture_as_the_camera_turns) {
  const auto rows = [](const char* row) { return std::vector<std::string>(8, row); };
  same_picture(drawn(kAhead, {8, 8}, looking(0)), rows("##....##"));
  // 30 degrees to the right: bearings -11.2, -2, 9.4, 22.9, 37.1 ...: what was ahead is now on the left.
  same_picture(drawn(kAhead, {8, 8}, looking(30)), rows("....####"));
  same_picture(drawn(kAhead, {8, 8}, looking(-30)), rows("####...."));
  same_picture(drawn(kAhead, {8, 8}, looking(180)), rows("########"));
  same_picture(drawn("include world -25,80 25,80 25,-80 -25,-80", {8, 8}, looking(30)), rows("####...."));
  // Analysed at half the frame's size: column centres 3 and 1 pixels from the axis, 36.9 and 14.0 degrees.
  same_picture(drawn(kAhead, {4, 4}, looking(0)), std::vector<std::string>(4, "#..#"));
}
END_TEST

START_TEST(a_zone_of_the_world_may_lie_across_the_bearing_of_180_degrees) {
  const char* behind = "exclude world 155,80 -155,80 -155,-80 155,-80";
  same_picture(drawn(behind, {8, 8}, looking(180)), std::vector<std::string>(8, "##....##"));
  same_picture(drawn(behind, {8, 8}, looking(0)), std::vector<std::string>(8, "########"));
}
END_TEST

START_TEST(the_tilt_moves_zones_of_the_world_up_and_down) {
  // Everything above the horizon, in two polygons; rows 0 to 3 are above the axis.
  const char* sky =
      "exclude world -90,0 0,0 90,0 90,90 0,90 -90,90; exclude world 90,0 180,0 -90,0 -90,90 180,90 90,90";
  const auto rows = drawn(sky, {8, 8}, looking(0));
  for (int y = 0; y < 8; ++y)
    ck_assert_str_eq(rows[static_cast<std::size_t>(y)].c_str(), y < 4 ? "........" : "########");
  // 10 degrees down: the horizon is 4 tan 10 = .7 pixels above the middle, so above the centre of row 3 (.5).
  const auto tilted = drawn(sky, {8, 8}, looking(77, -10));
  for (int y = 0; y < 8; ++y)
    ck_assert_str_eq(tilted[static_cast<std::size_t>(y)].c_str(), y < 3 ? "........" : "########");
}
END_TEST

// Nothing is hidden silently.
START_TEST(zones_of_the_world_hide_nothing_where_the_orientation_is_unknown) {
  const std::vector<std::string> all(8, "########"), right(8, "....####");
  Zones::View blind = looking(0);
  blind.camera.lens = {};
  for (const std::optional<Zones::View>& view : {std::optional<Zones::View>(), std::optional(blind)}) {
    same_picture(drawn(kAhead, {8, 8}, view), all);
    same_picture(drawn("include world 0,0 1,0 1,1", {8, 8}, view), all);
    same_picture(drawn("include world 0,0 1,0 1,1; include 0,0 0.5,0 0.5,1 0,1", {8, 8}, view), all);
    same_picture(drawn("include world 0,0 1,0 1,1; exclude 0,0 0.5,0 0.5,1 0,1", {8, 8}, view), right);
  }
}
END_TEST

START_TEST(the_mask_is_cut_where_the_camera_looks_at_each_frame) {
  Zones zones;
  accepted(zones, kAhead);
  const auto cut = [&](const std::optional<Zones::View>& view) {
    Image<std::uint8_t> mask({8, 8});
    mask.fill_bytes(255);
    zones.apply(mask.view(), view);
    std::string row;
    for (int x = 0; x < 8; ++x) row += mask.view().at(x, 5) ? '#' : '.';
    return row;
  };
  ck_assert(zones.need_orientation());
  ck_assert(cut(looking(0)) == "##....##");
  ck_assert(cut(looking(30)) == "....####");
  ck_assert(cut({}) == "########");
  ck_assert(cut(looking(0)) == "##....##");
  accepted(zones, "include world 170,1 175,1 175,5");
  ck_assert(cut(looking(0)) == "........");
  ck_assert(!zones.nowhere());  // elsewhere something is left
}
END_TEST

// The detector places them only where a look, a lens and a zoom are all known.
START_TEST(zones_of_the_world_need_a_look_and_a_field_of_view) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  constexpr DetectorFrame::Look kLook;
  const auto unplaced = [](std::optional<DetectorFrame::Look> look, double field_of_view, double usual = 0) {
    DetectorOptions options;
    options.field_of_view = usual;
    Detector detector;
    detector.set_options(options);
    accepted(detector.zones(), kAhead);
    Image<std::uint8_t> picture({64, 48});
    picture.fill_bytes(90);
    DetectorFrame frame;
    frame.size = {64, 48};
    frame.look = look;
    frame.field_of_view = field_of_view;
    const GrayView view = picture.view();
    const auto record = detector.begin({view.data, view.width, view.height, view.stride});
    detector.run(*record, frame);
    return detector.zones_unplaced();
  };
  ck_assert(!unplaced(kLook, 90 * kDegree));
  ck_assert(unplaced({}, 90 * kDegree));
  ck_assert(unplaced(kLook, 0));
  ck_assert(unplaced(kLook, kUnknown));
  ck_assert(!unplaced(kLook, 0, 90 * kDegree));
  ck_assert(unplaced(kLook, kUnknown, 90 * kDegree));  // zoomed, nobody knows how far
}
END_TEST

START_TEST(points_are_in_the_polygons_in_which_their_pixels_are) {
  Zones zones;
  accepted(
      zones,
      "include world -25,80 25,80 25,-80 -25,-80; include 0,0 0.1,0 0.1,1 0,1; exclude 0,0.5 1,0.5 1,1 0,1");
  const Direction ahead{0.1, 0}, aside{0.6, 0};
  ck_assert(zones.contain({0.5, 0.2}, ahead));
  ck_assert(!zones.contain({0.5, 0.2}, aside));
  ck_assert(zones.contain({0.05, 0.2}, aside));
  ck_assert(!zones.contain({0.5, 0.7}, ahead));
  ck_assert(zones.contain({0.5, 0.2}, {}));
  ck_assert(!zones.contain({0.5, 0.7}, {}));
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "zones",
      {without_polygons_motion_counts_everywhere,
       an_included_rectangle_covers_the_pixels_whose_centres_it_holds,
       a_triangle_is_cut_where_centres_cross_its_side,
       an_exclude_takes_away_from_everywhere_and_from_includes_whatever_the_order,
       a_polygon_that_crosses_itself_is_filled_even_odd, wrong_words_are_named_with_what_to_write_instead,
       a_wrong_text_leaves_the_old_polygons_in_place,
       the_mask_loses_what_does_not_count_at_every_size_and_after_every_change,
       polygons_that_leave_nothing_are_known_once_a_mask_was_seen,
       a_zone_of_the_world_moves_through_the_picture_as_the_camera_turns,
       a_zone_of_the_world_may_lie_across_the_bearing_of_180_degrees,
       the_tilt_moves_zones_of_the_world_up_and_down,
       zones_of_the_world_hide_nothing_where_the_orientation_is_unknown,
       the_mask_is_cut_where_the_camera_looks_at_each_frame,
       zones_of_the_world_need_a_look_and_a_field_of_view,
       points_are_in_the_polygons_in_which_their_pixels_are, decimal_points_are_read_in_a_german_locale});
}
