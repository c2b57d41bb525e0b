// SPDX-License-Identifier: LGPL-2.1-or-later
// What motionoverlay draws: boxes, labels, the panel in the corner.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "overlay_rig.h"

using namespace outputs;

GST_START_TEST(a_frame_in_which_nothing_moves_passes_untouched) {
  Harness h = started();
  GstBuffer* in = frame(info_of(kCaps));
  GstMemory* memory = gst_buffer_peek_memory(in, 0);
  GstBuffer* out = through(h.get(), in);
  fail_unless(gst_buffer_peek_memory(out, 0) == memory);
  for (const guint8 byte : bytes(out)) fail_unless_equals_int(byte, 100);
  gst_buffer_unref(out);
}
GST_END_TEST

// In every format: the box's outline is there, its inside and the rest of the frame are as they were.
GST_START_TEST(a_box_is_drawn_into_every_format) {
  for (const char* format : kFormats) {
    const std::string caps = caps_string(format, 321, 241);  // odd: chroma planes round up
    const GstVideoInfo info = info_of(caps);
    Harness h = started("motionoverlay show-ids=false", caps);
    GstBuffer* out = through(h.get(), with_region(info, region(1, 100, 80, 60, 90)));
    GstVideoFrame f;
    fail_unless(gst_video_frame_map(&f, &info, out, GST_MAP_READ));
    int edge = 0;
    for (int y = 95; y < 155; ++y) edge += level(&f, 100, y) != 100 && level(&f, 160, y) != 100;
    fail_unless_equals_int(edge, 60);
    fail_unless_equals_int(changed_pixels(&f, 108, 88, 152, 162, 100), 0);
    fail_unless_equals_int(changed_pixels(&f, 0, 0, 321, 74, 100), 0);
    fail_unless_equals_int(changed_pixels(&f, 0, 176, 321, 241, 100), 0);
    fail_unless_equals_int(changed_pixels(&f, 0, 0, 94, 241, 100), 0);
    fail_unless_equals_int(changed_pixels(&f, 167, 0, 321, 241, 100), 0);
    gst_video_frame_unmap(&f);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

// GStreamer's own converter is the judge: the middle of a thick orange line has the samples that it gives orange.
GST_START_TEST(colours_are_right_in_every_format) {
  std::vector<std::string> all;
  for (const char* format : kFormats) all.push_back(caps_string(format, 320, 240));
  for (const char* colorimetry : {"bt709", "bt601", "bt2020", "1:4:0:0"})  // the last one: full range
    all.push_back(caps_string("I420", 320, 240, (std::string(",colorimetry=") + colorimetry).c_str()));
  const GstVideoInfo rgb = info_of(caps_string("RGB", 320, 240));
  GstBuffer* orange = frame(rgb);
  const guint8 color[3] = {230, 159, 0};
  for (gsize at = 0; at + 3 <= rgb.size; at += 3) gst_buffer_fill(orange, at, color, 3);
  for (const std::string& caps : all) {
    const GstVideoInfo info = info_of(caps);
    Harness h = started("motionoverlay show-ids=false line-width=16", caps);
    GstBuffer* out = through(h.get(), with_region(info, region(1, 100, 60, 120, 120)));
    GstBuffer* judge = frame(info);
    GstVideoFrame from, should, is;
    fail_unless(gst_video_frame_map(&from, &rgb, orange, GST_MAP_READ));
    fail_unless(gst_video_frame_map(&should, &info, judge, GST_MAP_WRITE));
    fail_unless(gst_video_frame_map(&is, &info, out, GST_MAP_READ));
    GstVideoConverter* converter = gst_video_converter_new(&rgb, &info, nullptr);
    gst_video_converter_frame(converter, &from, &should);
    gst_video_converter_free(converter);
    for (const auto& [x, y] : {std::pair{101, 120}, {219, 120}, {160, 61}, {160, 179}})
      for (guint i = 0; i < GST_VIDEO_FORMAT_INFO_N_COMPONENTS(info.finfo); ++i) {
        const auto sample = [&](GstVideoFrame& f) {
          return sample_at(&f, i, x >> GST_VIDEO_FORMAT_INFO_W_SUB(info.finfo, i),
                           y >> GST_VIDEO_FORMAT_INFO_H_SUB(info.finfo, i));
        };
        fail_unless(std::abs(sample(is) - sample(should)) <= 2, "%s: component %u is %d, should be %d",
                    caps.c_str(), i, sample(is), sample(should));
      }
    gst_video_frame_unmap(&from);
    gst_video_frame_unmap(&should);
    gst_video_frame_unmap(&is);
    gst_buffer_unref(out);
    gst_buffer_unref(judge);
  }
  gst_buffer_unref(orange);
}
GST_END_TEST

GST_START_TEST(tiny_and_odd_frames_are_drawn_on) {
  for (const char* format : kFormats) {
    const std::string caps = caps_string(format, 33, 35);
    Harness h = started("motionoverlay crosshair=true", caps);
    GstBuffer* out = through(h.get(), with_region(info_of(caps), region(1, 5, 6, 20, 22)));
    const auto all = bytes(out);
    fail_unless(std::any_of(all.begin(), all.end(), [](guint8 b) { return b != 100; }), "%s", format);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

// Left is where the leftmost looks, whatever its number is.
GST_START_TEST(lights_lie_as_their_sensors_look) {
  const std::string caps = caps_string("RGBx", kWidth, kHeight);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const struct {
    std::array<double, 3> bearings;
    bool first_is_left;  // of the second
  } cases[] = {{{0, -120, 120}, false}, {{-10, 10, 30}, true},
               {{190, -160, 0}, true},                                  // the first looks to -170
               {{350, 340, 0}, false},  {{kNan, -1, HUGE_VAL}, false},  // as straight ahead
               {{0, 0, 0}, true}};
  for (const auto& c : cases) {
    CerberusFusion fusion;
    cerberus_fusion_init(&fusion);
    fusion.n_sensors = 3;
    std::ranges::copy(c.bearings, fusion.bearings);
    fusion.sensors[0] = 1;
    fusion.sensors[2] = 2;
    Harness h = started("motionoverlay", caps);
    GstBuffer* in = frame(info_of(caps));
    cerberus_buffer_set_fusion(in, &fusion);
    GstBuffer* out = through(h.get(), in);
    const auto all = bytes(out);
    gst_buffer_unref(out);
    std::array<std::size_t, 2> sum{}, count{};  // of red and blue: x
    for (std::size_t i = 0; i + 3 < all.size(); i += 4)
      for (const bool blue : {false, true})
        if (all[i + 2 * blue] > 200 && all[i + 2 * !blue] < 80) sum[blue] += i / 4 % kWidth, ++count[blue];
    fail_unless(count[0] > 10 && count[1] > 10);
    fail_unless((sum[0] / count[0] < sum[1] / count[1]) == c.first_is_left, "%g, %g", c.bearings[0],
                c.bearings[1]);
  }
}
GST_END_TEST

GST_START_TEST(head_sensors_and_decision_are_shown_in_the_corner) {
  const std::string caps = caps_string("RGBx", kWidth, kHeight);
  CerberusPose pose;
  cerberus_pose_init(&pose);
  pose.pan = NAN, pose.tilt = 1e300;
  CerberusFusion fusion;
  cerberus_fusion_init(&fusion);
  fusion.rule = 2;
  fusion.n_sensors = 3;
  // Lights of each kind that some sensors give, in the panel's corner: pixels clearly red, clearly blue.
  std::size_t widest = 200;
  const auto lights = [&](const char* line, std::array<guint8, 3> sensors, bool head) {
    std::copy(sensors.begin(), sensors.end(), fusion.sensors);
    Harness h = started(line, caps);
    GstBuffer* in = frame(info_of(caps));
    if (head) cerberus_buffer_set_pose(in, &pose);
    cerberus_buffer_set_fusion(in, &fusion);
    GstBuffer* out = through(h.get(), in);
    const auto all = bytes(out);
    gst_buffer_unref(out);
    int red = 0, blue = 0, dark = 0;
    for (std::size_t i = 0; i + 3 < all.size(); i += 4) {
      red += all[i] > 200 && all[i + 2] < 80;
      blue += all[i + 2] > 200 && all[i] < 80;
      dark += all[i] < 80 && all[i + 1] < 80 && all[i + 2] < 80;
      const std::size_t x = i / 4 % kWidth, y = i / 4 / kWidth;
      if (x > widest || y > 60) fail_unless(all[i] == 100 && all[i + 2] == 100);
    }
    return std::array{red, blue, dark};
  };
  const auto one = lights("motionoverlay", {1, 2, 2}, true);
  fail_unless(one[0] > 10 && one[1] == 0);
  const auto all = lights("motionoverlay", {1, 0, 0}, false);
  // Discs of one size, up to how their edges fall on pixels.
  fail_unless(std::abs(all[0] - one[0]) <= one[0] / 3 && std::abs(all[1] - 2 * all[0]) <= all[0] / 3,
              "red %d and %d, blue %d", one[0], all[0], all[1]);
  fail_unless(one[2] > all[2], "two lines need more room than one");
  // Of a rule without a number there is the name.
  fusion.rule = 0;
  fusion.rule_name = "none";
  const int short_name = lights("motionoverlay", {1, 0, 0}, false)[2];
  fusion.rule_name = "overlapping";
  fail_unless(lights("motionoverlay", {1, 0, 0}, false)[2] > short_name, "the rule's name is not shown");
  widest = 300;
  fusion.rule_name = "a rule whose name is longer than any panel, and longer than this picture is wide";
  lights("motionoverlay", {1, 0, 0}, false);
  fusion.rule_name = "\xff\n";
  lights("motionoverlay", {1, 0, 0}, false);
  fail_unless((lights("motionoverlay show-system=false", {1, 0, 0}, true) == std::array{0, 0, 0}));
}
GST_END_TEST

// Radius .13 x 240 = 31.2 pixels for 12 m in a rim of 3.12, .02 x 320 = 6.4 from the edges: the middle is (40.72, 199.28).
GST_START_TEST(the_radar_is_drawn_where_the_lens_is_known) {
  const std::string caps = caps_string("RGBx", kWidth, kHeight);
  const auto through_line = [&](const char* line) {
    Harness h = started(line, caps);
    GstBuffer* in = frame(info_of(caps));
    CerberusPose pose;
    cerberus_pose_init(&pose);
    pose.pan = -90;
    cerberus_buffer_set_pose(in, &pose);
    CerberusFusion fusion;
    cerberus_fusion_init(&fusion);
    fusion.n_sensors = 2;
    fusion.bearings[1] = 180;
    fusion.sensors[0] = fusion.sensors[1] = 1;
    fusion.doubtful = 2;
    cerberus_buffer_set_fusion(in, &fusion);
    CerberusRegion known = region(1, 200, 20, 20, 30), unknown = region(2, 230, 40, 20, 80);
    known.bearing = 15, known.distance = 4;
    add(in, known);
    add(in,
        unknown);  // 16.1 degrees to the right of the axis; its feet at the half: (.95 - .65 / 2) x 12 = 7.5 m
    GstBuffer* out = through(h.get(), in);
    const auto all = bytes(out);
    gst_buffer_unref(out);
    return all;
  };
  const auto all = through_line("motionoverlay horizontal-fov=60 show-system=false");
  const auto at = [&](double bearing, double metres) {
    const double angle = bearing * G_PI / 180, away = metres / 12 * 31.2;
    const auto x = std::size_t(40.72 + away * std::sin(angle)),
               y = std::size_t(199.28 - away * std::cos(angle));
    return &all[4 * (y * kWidth + x)];
  };
  fail_unless(at(0, 8)[0] > 150 && at(0, 8)[2] < 100);                             // detects
  fail_unless(at(180, 8)[0] < at(0, 8)[0] - 40 && at(180, 8)[0] > at(180, 8)[2]);  // does, and does not count
  fail_unless(at(-105, 9)[0] > 150 && at(-105, 9)[1] > 120 && at(-105, 9)[2] < 80);  // the view
  fail_unless(at(-90 + 15, 4)[0] > 200 && at(-90 + 15, 4)[2] < 60);                  // 1 is orange
  fail_unless(at(-90 + 16.1, 7.5)[2] > 200 && at(-90 + 16.1, 7.5)[0] < 120);         // 2 is blue
  const auto none = through_line("motionoverlay show-system=false");
  for (std::size_t y = 160; y < kHeight; ++y)
    for (std::size_t x = 0; x < 80; ++x) fail_unless_equals_int(none[4 * (y * kWidth + x)], 100);
}
GST_END_TEST

GST_START_TEST(labels_keep_clear_of_the_radar) {
  Harness h = attaching("motionoverlay show-boxes=false show-trails=false horizontal-fov=60");
  const auto low = drawn(h.get(), with_region(info_of(kCaps), region(2, 20, 2, 40, 158)));
  fail_unless_equals_int(low.size(), 2);
  fail_unless(low[0].y < 100, "%d", low[0].y);  // below the box is the radar
}
GST_END_TEST

GST_START_TEST(nothing_is_drawn_beyond_the_frame) {
  Harness h = attaching("motionoverlay line-width=9 crosshair=true");
  const double far = 1e6;
  int number = 0;
  for (const CerberusRegion& r :
       {region(1, -20, -30, 60, 90), region(2, 300, 220, 100, 100), region(3, 0, 0, 320, 240),
        region(4, 5, 235, 9, 90), region(5, 2, 2, far, far), region(6, -far, -far, 2 * far, 2 * far),
        region(7, 318, 1, 1, 1)})
    for (const Rectangle& a : drawn(h.get(), with_region(info_of(kCaps), r, number++))) {
      fail_unless(a.x >= 0 && a.y >= 0 && a.width > 0 && a.height > 0);
      fail_unless(a.x + static_cast<int>(a.width) <= kWidth && a.y + static_cast<int>(a.height) <= kHeight);
    }
}
GST_END_TEST

GST_START_TEST(what_lies_outside_or_is_nonsense_is_not_drawn) {
  Harness h = attaching("motionoverlay show-trails=false");
  int number = 0;
  for (const CerberusRegion& r :
       {region(1, 400, 50, 20, 20), region(2, 50, 1e6, 20, 20), region(3, 50, 50, 0, 20)})
    fail_unless(drawn(h.get(), with_region(info_of(kCaps), r, number++)).empty());
}
GST_END_TEST

GST_START_TEST(speeds_and_distances_that_are_not_numbers_leave_a_label_without_them) {
  const auto label_width = [](double vx, double distance) {
    Harness h = attaching("motionoverlay show-boxes=false show-trails=false");
    CerberusRegion r = region(1, 100, 80, 60, 90);
    r.vx = vx;
    r.distance = distance;
    const auto all = drawn(h.get(), with_region(info_of(kCaps), r));
    fail_unless_equals_int(all.size(), 1);
    return all[0].width;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const unsigned bare = label_width(nan, nan);
  fail_unless_equals_int(label_width(inf, -inf), bare);
  fail_unless(label_width(12, nan) > bare);
  fail_unless(label_width(12, 3.5) > label_width(12, nan));
  fail_unless(label_width(1e308, nan) < 200);
}
GST_END_TEST

GST_START_TEST(labels_keep_clear_of_each_other) {
  Harness h = attaching("motionoverlay show-boxes=false show-trails=false");
  GstBuffer* in = frame(info_of(kCaps));
  add(in, region(1, 100, 80, 30, 60));
  add(in, region(2, 110, 82, 30, 60));
  add(in, region(3, 120, 78, 30, 60));
  const auto all = drawn(h.get(), in);
  fail_unless_equals_int(all.size(), 3);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const auto &a = all[i], &b = all[j];
      const bool apart = a.x + int(a.width) <= b.x || b.x + int(b.width) <= a.x ||
                         a.y + int(a.height) <= b.y || b.y + int(b.height) <= a.y;
      fail_unless(apart);
    }
}
GST_END_TEST

// Above the box, where the frame leaves room there; below it; inside.
GST_START_TEST(a_label_lies_where_there_is_room) {
  const auto label = [](double top, double height) {
    Harness h = attaching("motionoverlay show-boxes=false show-trails=false");
    const auto all = drawn(h.get(), with_region(info_of(kCaps), region(1, 100, top, 60, height)));
    fail_unless_equals_int(all.size(), 1);
    return all[0];
  };
  const Rectangle above = label(80, 90), below = label(4, 90), inside = label(0, kHeight);
  fail_unless(above.y + static_cast<int>(above.height) <= 80, "%d", above.y);
  fail_unless(below.y >= 4 + 90, "%d", below.y);
  fail_unless(inside.y >= 0 && inside.y < 20, "%d", inside.y);
}
GST_END_TEST

GST_START_TEST(the_track_that_the_head_follows_has_corners) {
  Harness h = attaching("motionoverlay show-ids=false show-trails=false show-system=false");
  const GstVideoInfo info = info_of(kCaps);
  int number = 0;
  const auto count = [&](guint target, CerberusFusionAction action) {
    CerberusFusion fusion;
    cerberus_fusion_init(&fusion);
    fusion.target = target;
    fusion.action = action;
    GstBuffer* in = with_region(info, region(1, 100, 80, 60, 90), number++);
    add(in, region(2, 200, 80, 60, 90));
    cerberus_buffer_set_fusion(in, &fusion);
    const auto all = drawn(h.get(), in);
    const auto beside = [&](const Rectangle& r) { return r.x < 180; };
    return std::array{std::ranges::count_if(all, beside), std::ranges::count_if(all, std::not_fn(beside))};
  };
  const auto none = count(0, CERBERUS_FUSION_TRACK);
  fail_unless(none[0] == none[1]);
  fail_unless((count(1, CERBERUS_FUSION_TRACK) == std::array{none[0] + 4, none[1]}));
  fail_unless((count(2, CERBERUS_FUSION_TRACK) == std::array{none[0], none[1] + 4}));
  fail_unless(count(1, CERBERUS_FUSION_HOLD) == none);
}
GST_END_TEST

GST_START_TEST(the_corners_lie_round_the_box) {
  Harness h = attaching("motionoverlay show-ids=false show-trails=false show-system=false");
  int number = 0;
  // Left, top, right and bottom of all that is drawn.
  const auto extent = [&](CerberusFusionAction action) {
    CerberusFusion fusion;
    cerberus_fusion_init(&fusion);
    fusion.target = 1;
    fusion.action = action;
    GstBuffer* in = with_region(info_of(kCaps), region(1, 100, 80, 60, 90), number++);
    cerberus_buffer_set_fusion(in, &fusion);
    std::array sides{kWidth, kHeight, 0, 0};
    for (const Rectangle& r : drawn(h.get(), in)) {
      sides[0] = std::min(sides[0], r.x);
      sides[1] = std::min(sides[1], r.y);
      sides[2] = std::max(sides[2], r.x + static_cast<int>(r.width));
      sides[3] = std::max(sides[3], r.y + static_cast<int>(r.height));
    }
    return sides;
  };
  const auto box = extent(CERBERUS_FUSION_HOLD), all = extent(CERBERUS_FUSION_TRACK);
  const int room = box[0] - all[0];
  fail_unless(room >= 2);
  fail_unless_equals_int(box[1] - all[1], room);
  fail_unless_equals_int(all[2] - box[2], room);
  fail_unless_equals_int(all[3] - box[3], room);
}
GST_END_TEST

GST_START_TEST(regions_without_identity_have_a_box_only) {
  Harness h = attaching("motionoverlay show-boxes=false");
  CerberusRegion r = region(1, 100, 80, 60, 90);
  r.tracked = FALSE;
  for (int k = 0; k < 3; ++k) fail_unless(drawn(h.get(), with_region(info_of(kCaps), r, k)).empty());
  GstElement* element = gst_harness_find_element(h.get(), "motionoverlay");
  g_object_set(element, "show-boxes", TRUE, nullptr);
  gst_object_unref(element);
  fail_if(drawn(h.get(), with_region(info_of(kCaps), r, 4)).empty());
}
GST_END_TEST

GST_START_TEST(properties_change_while_playing) {
  Harness h = attaching("motionoverlay name=o show-trails=false");
  GstElement* element = gst_harness_find_element(h.get(), "motionoverlay");
  const CerberusRegion r = region(1, 100, 80, 60, 90);
  int number = 0;
  const auto count = [&] {
    return static_cast<int>(drawn(h.get(), with_region(info_of(kCaps), r, number++)).size());
  };
  const int both = count();
  g_object_set(element, "show-ids", FALSE, nullptr);
  fail_unless_equals_int(count(), both - 1);
  g_object_set(element, "show-boxes", FALSE, nullptr);
  fail_unless_equals_int(count(), 0);
  g_object_set(element, "crosshair", TRUE, nullptr);
  fail_unless_equals_int(count(), 1);
  gst_object_unref(element);
}
GST_END_TEST

GST_START_TEST(lines_are_as_wide_as_asked) {
  const auto outline = [](const char* line) {
    Harness h = started(line);
    const GstVideoInfo info = info_of(kCaps);
    GstBuffer* out = through(h.get(), with_region(info, region(1, 100, 80, 60, 90)));
    GstVideoFrame f;
    fail_unless(gst_video_frame_map(&f, &info, out, GST_MAP_READ));
    const int width = changed_pixels(&f, 85, 130, 130, 131, 100);
    gst_video_frame_unmap(&f);
    gst_buffer_unref(out);
    return width;
  };
  const int thin = outline("motionoverlay show-ids=false line-width=1"),
            thick = outline("motionoverlay show-ids=false line-width=6");
  fail_unless(thin >= 1 && thin <= 5, "%d", thin);      // the line, and a pixel of casing on each side
  fail_unless(thick >= 6 && thick <= 16, "%d", thick);  // casing grows with the line
}
GST_END_TEST

// Five hundred of 12 x 18 pixels, one above the other where they must be.
GST_START_TEST(a_crowd_is_drawn) {
  constexpr int kMany = 500, kWide = 12, kHigh = 18;
  const auto left = [](int id) { return id * 37 % 300; };
  const auto top = [](int id) { return id * 53 % 220; };
  const auto crowd = [&] {
    GstBuffer* in = frame(info_of(kCaps));
    for (int id = 1; id <= kMany; ++id)
      add(in, region(static_cast<guint>(id), left(id), top(id), kWide, kHigh));
    return in;
  };

  // Each has a box, which is as large as it is, and a number that touches the box, or nearly, and lies in the frame.
  constexpr int kNear = 5;
  Harness h = attaching("motionoverlay show-trails=false");
  const auto all = drawn(h.get(), crowd());
  fail_unless_equals_int(all.size(), 2 * kMany);
  for (int id = 1; id <= kMany; ++id) {
    const Rectangle &box = all[id - 1], &label = all[kMany + id - 1];
    const int x = left(id), y = top(id);
    const auto end = [](int from, unsigned length) { return from + static_cast<int>(length); };
    // Beyond its line by a pixel, if the frame goes on there, and not by many; to the left and upwards all is negative.
    const auto reaches = [](int line, int beyond, int end_of_frame) {
      return beyond >= std::min(line + 1, end_of_frame) && beyond <= line + kNear;
    };
    fail_unless(reaches(-x, -box.x, 0) && reaches(-y, -box.y, 0), "box %d: %d, %d", id, box.x, box.y);
    fail_unless(reaches(x + kWide, end(box.x, box.width), kWidth), "box %d: %u wide", id, box.width);
    fail_unless(reaches(y + kHigh, end(box.y, box.height), kHeight), "box %d: %u high", id, box.height);
    fail_unless(label.x >= 0 && label.y >= 0 && end(label.x, label.width) <= kWidth &&
                    end(label.y, label.height) <= kHeight,
                "label %d: %d, %d", id, label.x, label.y);
    fail_unless(label.x < x + kWide && end(label.x, label.width) > x && label.y <= y + kHigh + kNear &&
                    end(label.y, label.height) >= y - kNear,
                "label %d: %d, %d", id, label.x, label.y);
  }

  // In the picture as well: lines may cover each other, but the frame's own grey remains on no side of a person.
  Harness into = started("motionoverlay show-trails=false");
  const GstVideoInfo info = info_of(kCaps);
  GstBuffer* out = through(into.get(), crowd());
  GstVideoFrame f;
  fail_unless(gst_video_frame_map(&f, &info, out, GST_MAP_READ));
  for (int id = 1; id <= kMany; ++id) {
    const int x = left(id), y = top(id);
    for (const int row : {y, y + kHigh})
      fail_unless(changed_pixels(&f, x + 4, row - 1, x + 8, row + 1, 100) > 0, "%d: row %d", id, row);
    for (const int column : {x, x + kWide})
      fail_unless(changed_pixels(&f, column - 1, y + 6, column + 1, y + 12, 100) > 0, "%d: column %d", id,
                  column);
  }
  gst_video_frame_unmap(&f);
  gst_buffer_unref(out);
}
GST_END_TEST

static Suite* motionoverlay_suite() {
  watch_library_log();
  Suite* s = suite_create("motionoverlay");
  TCase* tc = tcase_create("all");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, a_frame_in_which_nothing_moves_passes_untouched);
  tcase_add_test(tc, a_box_is_drawn_into_every_format);
  tcase_add_test(tc, colours_are_right_in_every_format);
  tcase_add_test(tc, tiny_and_odd_frames_are_drawn_on);
  tcase_add_test(tc, lights_lie_as_their_sensors_look);
  tcase_add_test(tc, head_sensors_and_decision_are_shown_in_the_corner);
  tcase_add_test(tc, the_radar_is_drawn_where_the_lens_is_known);
  tcase_add_test(tc, labels_keep_clear_of_the_radar);
  tcase_add_test(tc, nothing_is_drawn_beyond_the_frame);
  tcase_add_test(tc, what_lies_outside_or_is_nonsense_is_not_drawn);
  tcase_add_test(tc, speeds_and_distances_that_are_not_numbers_leave_a_label_without_them);
  tcase_add_test(tc, labels_keep_clear_of_each_other);
  tcase_add_test(tc, a_label_lies_where_there_is_room);
  tcase_add_test(tc, the_track_that_the_head_follows_has_corners);
  tcase_add_test(tc, the_corners_lie_round_the_box);
  tcase_add_test(tc, regions_without_identity_have_a_box_only);
  tcase_add_test(tc, properties_change_while_playing);
  tcase_add_test(tc, lines_are_as_wide_as_asked);
  tcase_add_test(tc, a_crowd_is_drawn);
  return s;
}

GST_CHECK_MAIN(motionoverlay)
