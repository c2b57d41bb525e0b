// SPDX-License-Identifier: LGPL-2.1-or-later
// The stages' properties changed while they play, and their results: camera, zones, limits, places, tracks.
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "scene.h"
#include "support.h"

namespace {

using scene::entering;
using scene::Line;
using scene::moving_pixels;
using scene::Regions;
using scene::World;

GST_START_TEST(a_turning_camera_is_measured_and_the_figure_found) {
  World world;
  world.pan = 4;
  world.start = 200;
  Line line("motiondetect confirm-time=0 ! identity");
  int found = 0;
  line.run(world, 0, 25, [&](int k, GstBuffer* out) {
    const CerberusCameraMotion* motion = cerberus_buffer_peek_camera_motion(out);
    fail_unless(motion != nullptr);
    fail_unless_equals_int(motion->scene_age, k + 1);
    if (k == 0) {
      fail_unless_equals_uint64(motion->from, GST_CLOCK_TIME_NONE);
      return;
    }
    fail_unless_equals_uint64(motion->from, (k - 1) * scene::kStep);
    fail_unless(std::abs(motion->matrix[2] + 4) < 0.2 && std::abs(motion->matrix[5]) < 0.2,
                "frame %d: the camera is said to shift by %.2f %.2f", k, motion->matrix[2],
                motion->matrix[5]);
    const Regions regions(out);
    for (guint i = 0; i < regions.size(); ++i) found += scene::overlaps_figure(regions[i], world, k);
  });
  fail_unless(found > 10, "the figure was found %d times", found);
}
GST_END_TEST

GST_START_TEST(the_motion_is_in_frame_pixels_whatever_the_analysis_width) {
  for (const char* launch :
       {"cameramotion analysis-width=160 ! identity", "cameramotion analysis-width=0 ! identity"}) {
    World world;
    world.pan = 6;
    Line line(launch);
    line.run(world, 0, 10, [&](int k, GstBuffer* out) {
      fail_unless_equals_int((*records::record_of(out)->luma)->size().width,
                             strstr(launch, "160") ? 160 : 320);
      const CerberusCameraMotion* motion = cerberus_buffer_peek_camera_motion(out);
      if (k > 0) fail_unless(std::abs(motion->matrix[2] + 6) < 0.4, "%.2f", motion->matrix[2]);
    });
  }
}
GST_END_TEST

namespace {

// Grey levels as 4 % of the range of a deep format, from a third of it on. offset: of the range too.
GstBuffer* faint(const char* format, const World& world, int k, double offset) {
  GstVideoInfo info;
  gst_video_info_set_format(&info, gst_video_format_from_string(format), world.width, world.height);
  GstBuffer* out = gst_buffer_new_allocate(nullptr, info.size, nullptr);
  gst_buffer_memset(out, 0, 0, info.size);
  const std::vector<std::uint8_t> grey = world.picture(k);
  GstVideoFrame frame;
  fail_unless(gst_video_frame_map(&frame, &info, out, GST_MAP_WRITE));
  const double range = 1 << GST_VIDEO_INFO_COMP_DEPTH(&info, 0);
  for (int y = 0; y < world.height; ++y)
    for (int x = 0; x < world.width; ++x) {
      const double level = grey[static_cast<std::size_t>(y) * static_cast<std::size_t>(world.width) +
                                static_cast<std::size_t>(x)];
      const auto word = static_cast<guint16>(static_cast<int>((0.33 + offset + 0.04 * level / 255) * range)
                                             << GST_VIDEO_FORMAT_INFO_SHIFT(info.finfo, 0));
      guint8* p = static_cast<guint8*>(GST_VIDEO_FRAME_COMP_DATA(&frame, 0)) +
                  static_cast<gssize>(y) * GST_VIDEO_FRAME_COMP_STRIDE(&frame, 0) + 2 * x;
      if (GST_VIDEO_FORMAT_INFO_IS_LE(info.finfo))
        GST_WRITE_UINT16_LE(p, word);
      else
        GST_WRITE_UINT16_BE(p, word);
    }
  gst_video_frame_unmap(&frame);
  GST_BUFFER_PTS(out) = static_cast<GstClockTime>(k) * scene::kStep;
  GST_BUFFER_DURATION(out) = scene::kStep;
  return out;
}

}  // namespace

// A thermal camera uses a few percent of 16 bits. After its shutter has closed, all values are shifted (of 16 bits: 131).
GST_START_TEST(somebody_in_a_few_percent_of_a_deep_formats_range_is_found) {
  static const char* const formats[] = {"GRAY16_LE", "GRAY16_BE", "P010_10LE", "I420_10LE", "Y444_12BE"};
  const char* format = formats[__i__];
  const World world = entering();
  Line line("motiondetect", scene::caps(format, world.width, world.height));
  int found = 0, others = 0;
  std::set<guint> identities;
  for (int k = 0; k < 100; ++k) {
    GstBuffer* out = line.through(faint(format, world, k, k < 60 ? 0 : 0.002));
    const Regions regions(out);
    bool here = false;
    for (guint i = 0; i < regions.size(); ++i) {
      const bool figure = scene::overlaps_figure(regions[i], world, k);
      here = here || figure, others += !figure;
      if (figure) identities.insert(regions[i].id);
    }
    found += here && k >= 20;
    gst_buffer_unref(out);
  }
  fail_unless(found >= 76, "%s: found in %d of 80 frames", format, found);
  fail_unless(identities.size() == 1 && others <= 2, "%s: %d identities, %d others", format,
              static_cast<int>(identities.size()), others);
}
GST_END_TEST

GST_START_TEST(a_frame_in_twenty_that_is_stamped_hours_off_renews_no_identity) {
  const World world = entering();
  static const GstClockTimeDiff offs[] = {3 * 3600 * GST_SECOND, -2 * GST_SECOND};
  Line line("motiondetect");
  std::set<guint> identities;
  int found = 0;
  for (int k = 0; k < 100; ++k) {
    GstBuffer* in = scene::grey_buffer(world, k);
    GST_BUFFER_PTS(in) +=
        10 * GST_SECOND + (k % 20 == 19 || (__i__ > 1 && k % 20 == 18) ? offs[__i__ % 2] : 0);
    GstBuffer* out = line.through(in);
    const Regions regions(out);
    for (guint i = 0; i < regions.size(); ++i) identities.insert(regions[i].id);
    found += k >= 20 && regions.size() > 0;
    gst_buffer_unref(out);
  }
  fail_unless(identities.size() == 1, "%d identities", static_cast<int>(identities.size()));
  fail_unless(found >= 76, "found in %d of 80 frames", found);
}
GST_END_TEST

GST_START_TEST(model_none_says_that_the_camera_stands) {
  World world;
  world.pan = 6;
  Line line("cameramotion model=none ! identity");
  line.run(world, 0, 5, [&](int, GstBuffer* out) {
    const CerberusCameraMotion* motion = cerberus_buffer_peek_camera_motion(out);
    fail_unless(motion->matrix[2] == 0 && motion->matrix[0] == 1);
  });
}
GST_END_TEST

GST_START_TEST(the_area_changes_while_playing) {
  const bool own = __i__ == 0;  // differences; otherwise they are requested upstream
  Line line(std::string(own ? "" : "threeframediff ! ") + "fuzzythreshold memory=false name=t ! identity");
  GstElement* threshold = gst_bin_get_by_name(GST_BIN(line.harness->element), "t");
  const World world;
  line.run(world, 0, 10);
  long all = 0, leading = 0, common = 0;
  line.run(world, 10, 11, [&](int, GstBuffer* out) { all = moving_pixels(out); });
  gst_util_set_object_arg(G_OBJECT(threshold), "area", "leading");
  // What they need of the third frame was not kept so far: two frames without an answer, not with a wrong one.
  const auto ready = [](GstBuffer* out) { return records::threshold_facts_of(out)->result.ready; };
  line.run(world, 11, 13, [&](int k, GstBuffer* out) {
    fail_unless_equals_int(ready(out), own && k == 12);
    if (!ready(out)) fail_unless_equals_int(moving_pixels(out), 0);
  });
  line.run(world, 13, 14, [&](int, GstBuffer* out) { leading = moving_pixels(out); });
  gst_util_set_object_arg(G_OBJECT(threshold), "area", "common");
  line.run(world, 14, 15, [&](int, GstBuffer* out) { common = moving_pixels(out); });
  fail_unless(all > 0 && leading > 0 && common > 0 && leading < all && common < all, "%ld %ld %ld", all,
              leading, common);
  gst_object_unref(threshold);
}
GST_END_TEST

GST_START_TEST(the_analysis_width_changes_while_playing) {
  Line line("motiondetect name=d confirm-time=0 keep-planes=always ! identity");
  GstElement* detect = gst_bin_get_by_name(GST_BIN(line.harness->element), "d");
  const World world;
  int k = 0;
  for (const int width : {320, 160, 0, 200, 320}) {
    g_object_set(detect, "analysis-width", width, nullptr);
    guint found = 0;
    line.run(world, k, k + 10, [&](int, GstBuffer* out) {
      fail_unless_equals_int(records::mask_of(out).width, width > 0 ? width : 320);
      found += Regions(out).size();
    });
    fail_unless(found > 0, "nothing found at width %d", width);
    k += 10;
  }
  gst_object_unref(detect);
}
GST_END_TEST

// A crop removes the regions and the record that a detector ran: they are found again in the cropped picture.
GST_START_TEST(behind_a_crop_the_regions_are_found_again) {
  Line line("motiondetect confirm-time=0 ! videocrop left=16 ! motiontrack confirm-time=0 ! identity");
  guint found = 0;
  line.run(World{}, 0, 30, [&](int, GstBuffer* out) {
    fail_unless(cerberus_buffer_regions_known(out));
    found += Regions(out).size();
  });
  fail_unless(found > 10, "%u regions", found);
}
GST_END_TEST

GST_START_TEST(zones_change_while_playing_and_a_typo_keeps_the_old_ones) {
  Line line("motionregions name=r ! identity");
  GstElement* regions = gst_bin_get_by_name(GST_BIN(line.harness->element), "r");
  const World world;
  guint found = 0;
  const auto count = [&](int, GstBuffer* out) { found += Regions(out).size(); };
  line.run(world, 0, 10, count);
  fail_unless(found > 0);
  found = 0;
  g_object_set(regions, "zones", "include 0,0 1,0 1,0.2 0,0.2", nullptr);  // the figure walks below
  line.run(world, 10, 15, count);
  fail_unless_equals_int(found, 0);
  g_object_set(regions, "zones", "include 0,0 1,0", nullptr);
  line.run(world, 15, 20, count);
  fail_unless_equals_int(found, 0);
  fail_unless_equals_int(line.messages(GST_MESSAGE_WARNING).size(), 1);
  g_object_set(regions, "zones", nullptr, nullptr);
  line.run(world, 20, 25, count);
  fail_unless(found > 0);
  gst_object_unref(regions);
}
GST_END_TEST

// The camera turns by a pixel a frame, and its poses say so: a lens of 60 degrees, focal length 160 / tan 30. The zone
// is as high as the picture; boxes whose middle is 2 degrees within it lie in it with at least half of their width.
GST_START_TEST(a_zone_of_the_world_hides_a_place_while_the_camera_turns) {
  const char* const lines[] = {"motiondetect name=r confirm-time=0 horizontal-fov=60 ! identity",
                               "cameramotion horizontal-fov=60 ! motionregions name=r horizontal-fov=60"};
  World world;
  world.pan = 1;
  const double f = 160 / std::tan(M_PI / 6), degrees = 180 / M_PI;
  for (const char* text : lines)
    for (const bool excluded : {false, true}) {
      Line line(text);
      g_autoptr(GstElement) regions_of = gst_bin_get_by_name(GST_BIN(line.harness->element), "r");
      if (excluded) g_object_set(regions_of, "zones", "exclude world -20,80 0,80 0,-80 -20,-80", nullptr);
      int inside = 0, outside = 0;
      for (int k = 0; k < 80; ++k) {
        GstBuffer* in = scene::grey_buffer(world, k);
        CerberusPose pose;
        cerberus_pose_init(&pose);
        pose.pan = world.pan * k / f * degrees;
        cerberus_buffer_set_pose(in, &pose);
        GstBuffer* out = line.through(in);
        const Regions regions(out);
        for (guint i = 0; i < regions.size(); ++i) {
          const double middle = regions[i].x + regions[i].width / 2 - 160;
          const double bearing = pose.pan + std::atan(middle / f) * degrees;
          (bearing > -18 && bearing < -2 ? inside : outside) += 1;
        }
        gst_buffer_unref(out);
      }
      fail_unless(outside > 10, "%s: %d outside", text, outside);
      fail_unless(excluded ? inside == 0 : inside > 10, "%s: %d inside", text, inside);
      fail_unless(line.messages(GST_MESSAGE_WARNING).empty());
    }
}
END_TEST

GST_START_TEST(a_zone_of_the_world_without_a_pose_hides_nothing_and_is_warned_of_once) {
  Line line(
      "motiondetect confirm-time=0 horizontal-fov=60 zones=\"exclude world -90,80 90,80 90,-80 -90,-80\" ! "
      "identity");
  guint found = 0;
  line.run(World{}, 0, 80, [&](int, GstBuffer* out) { found += Regions(out).size(); });
  fail_unless(found > 10);
  fail_unless_equals_int(line.messages(GST_MESSAGE_WARNING).size(), 1);
}
END_TEST

// A camera on a mast over a textured yard: a window of 40 degrees into a picture of 90, 800 pixels wide, with noise.
// A box of 130 x 70 pixels stands at home, and another one 30 degrees to the right.
struct Yard {
  static constexpr int kWidth = 800, kHeight = 300;
  std::vector<std::uint8_t> plain;
  bool walker = false;

  Yard() : plain(static_cast<std::size_t>(kWidth) * kHeight) {
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const bool car = y >= 150 && y < 220 && ((x >= 340 && x < 470) || (x >= 580 && x < 680));
        plain[static_cast<std::size_t>(y) * kWidth + x] = static_cast<std::uint8_t>(
            car ? 150 + 0.4 * scene::texture(x, y, 14, 5) : 30 + 0.35 * scene::texture(x, y, 9, 1));
      }
  }
  // Noise of at most 3 levels; where it walks, a figure of 20 x 60 that began at column 300 at frame 0.
  GstBuffer* buffer(int k) const {
    GstBuffer* out = gst_buffer_new_allocate(nullptr, plain.size(), nullptr);
    GstMapInfo map;
    gst_buffer_map(out, &map, GST_MAP_WRITE);
    std::uint32_t state = 2654435761u * static_cast<std::uint32_t>(k + 1);
    for (std::size_t i = 0; i < plain.size(); ++i) {
      state = state * 1664525u + 1013904223u;
      map.data[i] = static_cast<std::uint8_t>(plain[i] + (state >> 29) % 7 - 3);
    }
    for (int y = 120; walker && y < 180; ++y)
      for (int x = 0; x < 20; ++x)
        map.data[y * kWidth + 300 + 3 * (k % 60) + x] =
            static_cast<std::uint8_t>(190 + 0.2 * scene::texture(x, y, 5, 77));
    gst_buffer_unmap(out, &map);
    GST_BUFFER_PTS(out) = k * scene::kStep;
    return out;
  }
};

// Home for 2 s, 30 degrees to the right at 15 or 60 degrees a second, a second there, and back for 2 s.
GST_START_TEST(a_parked_car_is_no_object_when_the_camera_returns_to_it) {
  Line line(
      "virtualptz lockstep=off wide-fov=90 horizontal-fov=40 width=320 height=240 ! "
      "motiondetect horizontal-fov=40",
      scene::caps("GRAY8", Yard::kWidth, Yard::kHeight));
  Yard yard;
  const int turn = __i__ == 0 ? 50 : 12, away = 50 + turn, back = away + 25, home = back + turn;
  const auto pan_at = [&](int k) {
    return 30 * (std::clamp((k - 50.0) / turn, 0.0, 1.0) - std::clamp((k - back) * 1.0 / turn, 0.0, 1.0));
  };
  int parked = 0, walking = 0;
  for (int k = 0; k < home + 90; ++k) {
    CerberusPose pose;
    cerberus_pose_init(&pose);
    pose.pan = pan_at(k);
    pose.pan_speed = (pan_at(k + 1) - pose.pan) * 25;
    pose.moving = pose.pan_speed != 0;
    pose.valid_from = k * scene::kStep;
    pose.source = CERBERUS_POSE_MEASURED;
    gst_harness_push_upstream_event(line.harness, cerberus_event_new_pose(&pose));
    yard.walker = k >= home + 50;
    GstBuffer* out = line.through(yard.buffer(k));
    const Regions regions(out);
    (yard.walker ? walking : parked) += static_cast<int>(regions.size());
    gst_buffer_unref(out);
  }
  fail_unless_equals_int(parked, 0);
  fail_unless(walking > 20, "the figure is in %d frames", walking);
}
END_TEST

GST_START_TEST(limits_of_size_drop_what_is_outside) {
  const auto found = [](const std::string& properties) {
    guint count = 0;
    Line line("motionregions " + properties + " ! identity");
    line.run(entering(), 0, 45, [&](int k, GstBuffer* out) { count += k >= 20 ? Regions(out).size() : 0; });
    return count;
  };
  const guint all = found("");
  fail_unless(all > 0);
  fail_unless_equals_int(found("minimum-width=20 maximum-width=45 minimum-height=60 maximum-height=90"), all);
  fail_unless_equals_int(found("minimum-width=60"), 0);
  fail_unless_equals_int(found("maximum-width=20"), 0);
  fail_unless_equals_int(found("minimum-height=100"), 0);
  fail_unless_equals_int(found("maximum-height=40"), 0);
  // 60 degrees over 320 pixels: f = 277. Feet 48 pixels below the middle, 0.8 m up: 4.6 m away, so 28 pixels are .47 m.
  fail_unless_equals_int(found("horizontal-fov=60"), all);
  fail_unless_equals_int(found("horizontal-fov=60 minimum-width-metres=1"), 0);
  fail_unless_equals_int(found("horizontal-fov=60 maximum-width-metres=0.3"), 0);
  fail_unless_equals_int(found("minimum-width-metres=1"), all);  // unknown lens: not judged
}
GST_END_TEST

GST_START_TEST(bearing_and_distance_follow_from_the_lens) {
  const World world = entering();
  Line line("motiondetect confirm-time=0 horizontal-fov=60 ! identity");
  guint seen = 0;
  line.run(world, 0, 80, [&](int k, GstBuffer* out) {
    if (k < 25) return;
    const Regions regions(out);
    for (guint i = 0; i < regions.size(); ++i) {
      ++seen;
      // Pinhole: the figure's middle, 160 pixels = 30 degrees from the axis, f = 160 / tan 30.
      const double f = 160 / std::tan(M_PI / 6);
      const double middle = world.figure_left(k) + scene::kFigureWidth / 2.0;
      const double bearing = std::atan((middle - 160) / f) * 180 / M_PI;
      const double feet = world.figure_top() + scene::kFigureHeight - 120;
      const double ahead = 0.8 * f / feet;
      const double distance = std::hypot(ahead, ahead * (middle - 160) / f);
      fail_unless(std::abs(regions[i].bearing - bearing) < 1.5, "bearing %.2f, not %.2f", regions[i].bearing,
                  bearing);
      fail_unless(std::abs(regions[i].distance - distance) < 0.6, "distance %.2f, not %.2f",
                  regions[i].distance, distance);
    }
  });
  fail_unless(seen > 5);
}
GST_END_TEST

// The lens is 0.8 m above the floor, pitched down by 10 degrees: the ray to the feet falls steeper, so they are
// nearer. The pitch comes from the pose on the frame or from the property; the pose takes precedence.
GST_START_TEST(the_tilt_of_the_camera_counts_for_the_distance) {
  const World world = entering();
  const char* const tilts[] = {"", "tilt=-10", "tilt=30"};
  const bool posed = __i__ != 1;
  Line line("motiondetect confirm-time=0 horizontal-fov=60 preset=traffic " + std::string(tilts[__i__]) +
            " ! identity");
  CerberusPose pose;
  cerberus_pose_init(&pose);
  pose.tilt = -10;
  guint seen = 0;
  for (int k = 0; k < 80; ++k) {
    GstBuffer* in = scene::grey_buffer(world, k);
    if (posed) cerberus_buffer_set_pose(in, &pose);
    GstBuffer* out = line.through(in);
    const Regions regions(out);
    for (guint i = 0; k >= 25 && i < regions.size(); ++i) {
      ++seen;
      const double f = 160 / std::tan(M_PI / 6), pitch = 10 * M_PI / 180;
      const double right = (world.figure_left(k) + scene::kFigureWidth / 2.0 - 160) / f;
      const double down = (world.figure_top() + scene::kFigureHeight - 120) / f;
      // The ray (right, down, 1) turned about the horizontal axis.
      const double falls = down * std::cos(pitch) + std::sin(pitch);
      const double ahead = std::cos(pitch) - down * std::sin(pitch);
      const double distance = 0.8 * std::hypot(right, ahead) / falls;
      fail_unless(std::abs(regions[i].distance - distance) < 0.3, "distance %.2f, not %.2f",
                  regions[i].distance, distance);
    }
    gst_buffer_unref(out);
  }
  fail_unless(seen > 5);
}
GST_END_TEST

// A fixed camera 5 m up, 60 degrees wide, that looks down by 35. By hand: f = 160
// / tan 30 = 277.13; feet in row 168, 48 below the middle, are 9.826 degrees
// below the axis, so 44.826 below the horizon, and 5 / tan 44.826 = 5.030 m away.
GST_START_TEST(a_fixed_camera_that_looks_down_measures_distances) {
  World world = entering();
  Line line(
      "motiondetect confirm-time=0 horizontal-fov=60 mounting-height=5 tilt=-35 preset=traffic ! identity");
  guint seen = 0;
  line.run(world, 0, 80, [&](int k, GstBuffer* out) {
    const Regions regions(out);
    const double off = std::abs(world.figure_left(k) + scene::kFigureWidth / 2.0 - 160);
    for (guint i = 0; off < 10 && i < regions.size(); ++i, ++seen)
      fail_unless(std::abs(regions[i].distance - 5.03) < 0.3, "%.3f", regions[i].distance);
  });
  fail_unless(seen > 3);
}
GST_END_TEST

// Of the same camera: one pixel at the feet is 5 / (48 / f cos 35 + sin 35) / f = 0.0252 m wide, so that a person 28
// to 36 pixels wide passes the limit of 1.44 m. Level, it would be 5 / 48 = 0.104 m, and the person would not pass.
GST_START_TEST(the_tilt_counts_for_the_limits_in_metres) {
  for (const bool looks_down : {true, false}) {
    Line line(std::string("motionregions horizontal-fov=60 mounting-height=5 ") +
              (looks_down ? "tilt=-35 ! identity" : "! identity"));
    const World world = entering();
    guint seen = 0;
    line.run(world, 0, 80, [&](int k, GstBuffer* out) {
      if (k >= 40) seen += Regions(out).size();
    });
    fail_unless(looks_down ? seen >= 35 : seen == 0, "%u", seen);
  }
}
GST_END_TEST

GST_START_TEST(limits_of_speed_drop_what_is_outside) {
  const auto found = [](const std::string& properties) {
    guint count = 0;
    Line line("motiontrack confirm-time=0 " + properties + " ! identity");
    line.run(entering(), 0, 60, [&](int k, GstBuffer* out) { count += k >= 35 ? Regions(out).size() : 0; });
    return count;
  };
  // 3 pixels a frame at 25 frames a second: 75 pixels a second; at 4.6 m and f = 277: 1.25 m/s.
  fail_unless(found("") > 0);
  fail_unless(found("minimum-speed=50 maximum-speed=150") > 0);
  fail_unless_equals_int(found("minimum-speed=150"), 0);
  fail_unless_equals_int(found("maximum-speed=30"), 0);
  fail_unless(found("horizontal-fov=60") > 0);
  fail_unless_equals_int(found("horizontal-fov=60 minimum-speed-metres=2.5"), 0);
  fail_unless_equals_int(found("horizontal-fov=60 maximum-speed-metres=0.5"), 0);
}
GST_END_TEST

GST_START_TEST(tracks_have_identity_velocity_age_and_state) {
  Line line("motiondetect ! identity");
  std::set<guint> ids;
  double vx = 0;
  GstClockTime age = 0;
  line.run(entering(), 0, 70, [&](int k, GstBuffer* out) {
    const Regions regions(out);
    for (guint i = 0; i < regions.size(); ++i) {
      fail_unless(regions[i].tracked);
      fail_unless_equals_int(regions[i].state, CERBERUS_REGION_SEEN);
      fail_unless(regions[i].age >= age);
      age = regions[i].age;
      ids.insert(regions[i].id);
      if (k == 69) vx = regions[i].vx;
    }
  });
  fail_unless_equals_int(ids.size(), 1);
  fail_unless(std::abs(vx - 75) < 8, "%.1f pixels a second instead of 75", vx);
  fail_unless(age > GST_SECOND);
}
GST_END_TEST

// From the third frame of a scene on, as for the regions; by default a track is confirmed later.
GST_START_TEST(without_confirm_time_a_region_is_an_object_at_once) {
  Line regions("motionregions"), at_once("motiontrack confirm-time=0"), later("motiontrack");
  const World world;
  for (int k = 0; k < 4; ++k) {
    GstBuffer* found = regions.through(scene::grey_buffer(world, k));
    const guint count = Regions(found).size();
    fail_unless_equals_int(count > 0, k >= 2);
    GstBuffer* now = at_once.through(gst_buffer_copy(found));
    GstBuffer* after = later.through(found);
    fail_unless_equals_int(Regions(now).size(), count);
    if (count > 0) fail_unless(Regions(now)[0].tracked && Regions(now)[0].state == CERBERUS_REGION_SEEN);
    fail_unless_equals_int(Regions(after).size(), 0);
    gst_buffer_unref(now);
    gst_buffer_unref(after);
  }
}
GST_END_TEST

GST_START_TEST(what_motionregions_dropped_is_not_found_again_downstream) {
  static const char* const between[] = {"identity", "queue", "videoconvert ! video/x-raw,format=RGBx",
                                        "videoscale ! video/x-raw,width=160,height=120"};
  const auto found = [&](const char* properties) {
    guint count = 0;
    Line line(std::string("motionregions ") + properties + " ! " + between[__i__] +
              " ! motiontrack confirm-time=0");
    for (int k = 0; k < 30; ++k) {
      gst_harness_push(line.harness, scene::grey_buffer(World{}, k));
      GstBuffer* out = gst_harness_pull(line.harness);
      count += Regions(out).size();
      gst_buffer_unref(out);
    }
    return count;
  };
  fail_unless(found("") > 0);
  fail_unless_equals_int(found("minimum-width=300"), 0);
}
GST_END_TEST

Suite* detect_suite() {
  Suite* suite = suite_create("detect");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 300);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_test(tests, a_turning_camera_is_measured_and_the_figure_found);
  tcase_add_test(tests, the_motion_is_in_frame_pixels_whatever_the_analysis_width);
  tcase_add_loop_test(tests, somebody_in_a_few_percent_of_a_deep_formats_range_is_found, 0, 5);
  tcase_add_loop_test(tests, a_frame_in_twenty_that_is_stamped_hours_off_renews_no_identity, 0, 4);
  tcase_add_test(tests, model_none_says_that_the_camera_stands);
  tcase_add_loop_test(tests, the_area_changes_while_playing, 0, 2);
  tcase_add_test(tests, the_analysis_width_changes_while_playing);
  tcase_add_test(tests, behind_a_crop_the_regions_are_found_again);
  tcase_add_test(tests, zones_change_while_playing_and_a_typo_keeps_the_old_ones);
  tcase_add_test(tests, a_zone_of_the_world_hides_a_place_while_the_camera_turns);
  tcase_add_test(tests, a_zone_of_the_world_without_a_pose_hides_nothing_and_is_warned_of_once);
  tcase_add_loop_test(tests, a_parked_car_is_no_object_when_the_camera_returns_to_it, 0, 2);
  tcase_add_test(tests, limits_of_size_drop_what_is_outside);
  tcase_add_test(tests, bearing_and_distance_follow_from_the_lens);
  tcase_add_loop_test(tests, the_tilt_of_the_camera_counts_for_the_distance, 0, 3);
  tcase_add_test(tests, a_fixed_camera_that_looks_down_measures_distances);
  tcase_add_test(tests, the_tilt_counts_for_the_limits_in_metres);
  tcase_add_test(tests, limits_of_speed_drop_what_is_outside);
  tcase_add_test(tests, tracks_have_identity_velocity_age_and_state);
  tcase_add_test(tests, without_confirm_time_a_region_is_an_object_at_once);
  tcase_add_loop_test(tests, what_motionregions_dropped_is_not_found_again_downstream, 0, 4);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(detect);
