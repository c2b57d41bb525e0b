// SPDX-License-Identifier: LGPL-2.1-or-later
// What the corridor is told and what it tells: properties of the stages, messages, planes, the bin and its presets.
#include <cstdlib>
#include <map>
#include <set>
#include <string>

#include "scene.h"
#include "support.h"

namespace {

using scene::Line;
using scene::Regions;
using scene::World;

// The figure comes in from the left: wholly inside from frame 20 to 100.
World entering() {
  World world;
  world.start = -45;
  return world;
}

// Pixels of the moving area in a plane of the buffer.
long moving_pixels(GstBuffer* buffer) {
  const CerberusPlaneMeta* plane = cerberus_buffer_get_plane_meta(buffer, CERBERUS_PLANE_MASK);
  fail_unless(plane != nullptr);
  GstMapInfo map;
  fail_unless(gst_buffer_map(plane->buffer, &map, GST_MAP_READ));
  long pixels = 0, neither = 0;  // counted: an assertion for each pixel costs more than the detection
  for (int y = 0; y < plane->height; ++y)
    for (int x = 0; x < plane->width; ++x) {
      const guint8 value = map.data[y * plane->stride + x];
      pixels += value != 0;
      neither += value != 0 && value != 255;
    }
  gst_buffer_unmap(plane->buffer, &map);
  fail_unless_equals_int(neither, 0);
  return pixels;
}

// ---- the camera

GST_START_TEST(a_turning_camera_is_measured_and_the_figure_found) {
  World world;
  world.pan = 4;
  world.start = 200;
  Line line("motiondetect confirm-time=0 ! identity");
  int found = 0;
  line.run(world, 0, 25, [&](int k, GstBuffer* out) {
    const CerberusCameraMotionMeta* meta = cerberus_buffer_get_camera_motion_meta(out);
    fail_unless(meta != nullptr);
    fail_unless_equals_int(meta->motion.scene_age, k + 1);
    if (k == 0) {
      fail_unless_equals_uint64(meta->motion.from, GST_CLOCK_TIME_NONE);
      return;
    }
    fail_unless_equals_uint64(meta->motion.from, (k - 1) * scene::kStep);
    fail_unless(std::abs(meta->motion.matrix[2] + 4) < 0.2 && std::abs(meta->motion.matrix[5]) < 0.2,
                "frame %d: the camera is said to shift by %.2f %.2f", k, meta->motion.matrix[2],
                meta->motion.matrix[5]);
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
      const CerberusPlaneMeta* plane = cerberus_buffer_get_plane_meta(out, CERBERUS_PLANE_LUMA);
      fail_unless_equals_int(plane->width, strstr(launch, "160") ? 160 : 320);
      const CerberusCameraMotionMeta* meta = cerberus_buffer_get_camera_motion_meta(out);
      if (k > 0) fail_unless(std::abs(meta->motion.matrix[2] + 6) < 0.4, "%.2f", meta->motion.matrix[2]);
    });
  }
}
GST_END_TEST

GST_START_TEST(model_none_says_that_the_camera_stands) {
  World world;
  world.pan = 6;
  Line line("cameramotion model=none ! identity");
  line.run(world, 0, 5, [&](int, GstBuffer* out) {
    const CerberusCameraMotionMeta* meta = cerberus_buffer_get_camera_motion_meta(out);
    fail_unless(meta->motion.matrix[2] == 0 && meta->motion.matrix[0] == 1);
  });
}
GST_END_TEST

// ---- properties while playing

GST_START_TEST(the_area_changes_while_playing) {
  Line line("fuzzythreshold memory=false name=t ! identity");
  GstElement* threshold = gst_bin_get_by_name(GST_BIN(line.harness->element), "t");
  const World world;
  line.run(world, 0, 10);
  long all = 0, leading = 0, common = 0;
  line.run(world, 10, 11, [&](int, GstBuffer* out) { all = moving_pixels(out); });
  gst_util_set_object_arg(G_OBJECT(threshold), "area", "leading");
  line.run(world, 11, 12, [&](int, GstBuffer* out) { leading = moving_pixels(out); });
  gst_util_set_object_arg(G_OBJECT(threshold), "area", "common");
  line.run(world, 12, 13, [&](int, GstBuffer* out) { common = moving_pixels(out); });
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
      fail_unless_equals_int(cerberus_buffer_get_plane_meta(out, CERBERUS_PLANE_MASK)->width,
                             width > 0 ? width : 320);
      found += Regions(out).size();
    });
    fail_unless(found > 0, "nothing found at width %d", width);
    k += 10;
  }
  gst_object_unref(detect);
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

// The lens 0.8 m above the floor, pitched down by 10 degrees: the feet's ray falls steeper, so they are nearer.
GST_START_TEST(the_tilt_of_a_pose_on_the_frame_counts_for_the_distance) {
  const World world = entering();
  Line line("motiondetect confirm-time=0 horizontal-fov=60 preset=traffic ! identity");
  CerberusPose pose;
  cerberus_pose_init(&pose);
  pose.tilt = -10;
  guint seen = 0;
  for (int k = 0; k < 80; ++k) {
    GstBuffer* in = scene::grey_buffer(world, k);
    cerberus_buffer_set_pose(in, &pose);
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

// That regions were looked for is known behind tees, queues, converters and scalers, even where none was left.
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

// ---- messages

// A figure that leaves the picture: frames 0 to 59 with it, the empty wall afterwards.
GST_START_TEST(motion_starts_once_and_ends_after_hold_time) {
  Line line("motiondetect coast-time=0 hold-stopped=0 hold-time=400000000 ! identity");
  World world;
  world.start = 200;
  world.speed = 4;
  int from = -1, until = -1;
  line.run(world, 0, 80, [&](int k, GstBuffer* out) {
    if (Regions(out).size() == 0) return;
    if (from < 0) from = k;
    until = k;
  });
  fail_unless(from > 0 && until < 60);
  GstMessage* message = gst_bus_pop_filtered(line.bus, GST_MESSAGE_ELEMENT);
  gboolean started = FALSE;
  GstClockTime time = 0;
  GPtrArray* objects = nullptr;
  fail_unless(message && cerberus_message_parse_motion(message, &started, &time, &objects));
  fail_unless(started);
  fail_unless_equals_uint64(time, from * scene::kStep);
  fail_unless_equals_int(objects->len, 1);
  g_ptr_array_unref(objects);
  gst_message_unref(message);
  message = gst_bus_pop_filtered(line.bus, GST_MESSAGE_ELEMENT);
  fail_unless(message && cerberus_message_parse_motion(message, &started, &time, nullptr));
  fail_if(started);
  fail_unless_equals_uint64(time, (until + 10) * scene::kStep);
  gst_message_unref(message);
  fail_unless(gst_bus_pop_filtered(line.bus, GST_MESSAGE_ELEMENT) == nullptr);
}
GST_END_TEST

GST_START_TEST(motion_ends_with_the_stream_and_with_the_element_but_once) {
  for (const bool eos : {true, false}) {
    Line line("motiondetect ! identity");
    line.run(World{}, 0, 30);
    if (eos) gst_harness_push_event(line.harness, gst_event_new_eos());
    gst_element_set_state(line.harness->element, GST_STATE_READY);
    const std::vector<std::string> states = line.messages(GST_MESSAGE_ELEMENT);
    fail_unless_equals_int(states.size(), 2);
    ck_assert_str_eq(states[0].c_str(), "started");
    ck_assert_str_eq(states[1].c_str(), "ended");
    gst_element_set_state(line.harness->element, GST_STATE_PLAYING);
  }
}
GST_END_TEST

GST_START_TEST(an_empty_scene_posts_nothing) {
  Line line("motiondetect ! identity");
  World world;
  world.figure = false;
  line.run(world, 0, 40, [](int, GstBuffer* out) { fail_unless_equals_int(Regions(out).size(), 0); });
  gst_harness_push_event(line.harness, gst_event_new_eos());
  fail_unless(line.messages(GST_MESSAGE_ELEMENT).empty());
}
GST_END_TEST

// ---- planes

int planes_of(GstBuffer* buffer) {
  int count = 0;
  for (int kind = CERBERUS_PLANE_LUMA; kind <= CERBERUS_PLANE_LABELS; ++kind)
    count += cerberus_buffer_get_plane_meta(buffer, static_cast<CerberusPlaneKind>(kind)) != nullptr;
  return count;
}

GstPadProbeReturn want_planes(GstPad*, GstPadProbeInfo* info, gpointer) {
  GstQuery* query = GST_PAD_PROBE_INFO_QUERY(info);
  if (!cerberus_query_is_planes(query)) return GST_PAD_PROBE_OK;
  cerberus_query_set_planes_wanted(query, TRUE);
  return GST_PAD_PROBE_HANDLED;
}

GST_START_TEST(planes_stay_only_where_somebody_asks_for_them) {
  struct Case {
    const char* launch;
    bool asked;
    bool kept;
  };
  const Case cases[] = {
      {"motiondetect ! queue ! identity", false, false},
      {"motiondetect ! queue ! identity", true, true},
      {"motiondetect keep-planes=never ! identity", true, false},
      {"motiondetect keep-planes=always ! identity", false, true},
      {"motiontrack ! identity", false, false},
      {"motiontrack ! identity", true, true},
  };
  const Case& c = cases[__i__];
  GstHarness* harness = gst_harness_new_parse(c.launch);
  if (c.asked)
    gst_pad_add_probe(harness->sinkpad, GST_PAD_PROBE_TYPE_QUERY_DOWNSTREAM, want_planes, nullptr, nullptr);
  gst_harness_set_src_caps_str(harness, scene::caps("GRAY8", scene::kWidth, scene::kHeight).c_str());
  for (int k = 0; k < 10; ++k) {
    gst_harness_push(harness, scene::grey_buffer(World{}, k));
    GstBuffer* out = gst_harness_pull(harness);
    fail_unless((planes_of(out) > 0) == c.kept, "%s, %s: %d planes", c.launch,
                c.asked ? "asked" : "not asked", planes_of(out));
    gst_buffer_unref(out);
  }
  gst_harness_teardown(harness);
}
GST_END_TEST

// Somebody is linked later and asks upstream to reconfigure.
GST_START_TEST(planes_stay_after_a_reconfigure_event_when_they_are_wanted_then) {
  Line line("motiondetect ! identity");
  line.run(World{}, 0, 5, [](int, GstBuffer* out) { fail_unless_equals_int(planes_of(out), 0); });
  gst_pad_add_probe(line.harness->sinkpad, GST_PAD_PROBE_TYPE_QUERY_DOWNSTREAM, want_planes, nullptr,
                    nullptr);
  gst_harness_push_upstream_event(line.harness, gst_event_new_reconfigure());
  line.run(World{}, 5, 8, [](int k, GstBuffer* out) {
    if (k > 5) fail_unless(planes_of(out) > 0);
    fail_unless(k < 5 || cerberus_buffer_get_threshold_meta(out)->threshold.ready,
                "the scene ended with a question");
  });
}
GST_END_TEST

// The mask is cleaned in place, except where another branch of a tee still looks at the uncleaned one.
GST_START_TEST(another_branch_keeps_its_uncleaned_mask) {
  Line threshold("fuzzythreshold"),
      regions("motionregions keep-planes=always zones=\"exclude 0,0.5 1,0.5 1,1 0,1\" ! identity");
  const World world = entering();
  long changed = 0;
  for (int k = 0; k < 40; ++k) {
    GstBuffer* out = threshold.through(scene::grey_buffer(world, k));
    GstBuffer* other = gst_buffer_copy(out);  // shares the planes
    const long before = moving_pixels(other);
    GstBuffer* cleaned = regions.through(out);
    changed += moving_pixels(cleaned) != before;
    fail_unless_equals_int(moving_pixels(other), before);
    gst_buffer_unref(other);
    gst_buffer_unref(cleaned);
  }
  fail_unless(changed > 0, "cleaning never changed anything: this test proves nothing");
}
GST_END_TEST

// ---- the bin

GST_START_TEST(a_property_that_was_set_wins_over_the_preset_in_any_order) {
  gint weighting = -1, area = -1, order = 0;
  gboolean memory = TRUE, people = TRUE;
  GstElement* first = gst_element_factory_make("motiondetect", nullptr);
  gst_util_set_object_arg(G_OBJECT(first), "weighting", "log");
  gst_util_set_object_arg(G_OBJECT(first), "preset", "paper");
  g_object_get(first, "weighting", &weighting, "area", &area, "memory", &memory, "people", &people, "order",
               &order, nullptr);
  fail_unless_equals_int(weighting, 1);
  fail_unless_equals_int(area, 0);
  fail_if(memory || people);
  gst_util_set_object_arg(G_OBJECT(first), "preset", "default");
  g_object_get(first, "weighting", &weighting, "area", &area, "memory", &memory, nullptr);
  fail_unless_equals_int(weighting, 1);
  fail_unless_equals_int(area, 2);
  fail_unless(memory);

  GstElement* last = gst_element_factory_make("motiondetect", nullptr);
  gst_util_set_object_arg(G_OBJECT(last), "preset", "paper");
  gst_util_set_object_arg(G_OBJECT(last), "weighting", "log");
  g_object_get(last, "weighting", &weighting, "area", &area, nullptr);
  fail_unless_equals_int(weighting, 1);
  fail_unless_equals_int(area, 0);
  gst_object_unref(first);
  gst_object_unref(last);
}
GST_END_TEST

// A thread that sets a property while another one's preset is on its way to the stages, as soon as the first stage tells.
GST_START_TEST(a_property_that_another_thread_sets_meanwhile_wins_over_the_preset) {
  GstElement* detect = gst_element_factory_make("motiondetect", nullptr);
  GstElement* stage = gst_bin_get_by_name(GST_BIN(detect), "threeframediff");
  guint told = 0;
  g_object_set_data(G_OBJECT(stage), "told", &told);
  g_signal_connect(stage, "notify::blur", G_CALLBACK(+[](GObject* from, GParamSpec*, gpointer bin) {
                     ++*static_cast<guint*>(g_object_get_data(from, "told"));
                     const auto set_order = [](gpointer on) -> gpointer {
                       g_object_set(on, "order", 3, nullptr);
                       return nullptr;
                     };
                     g_thread_join(g_thread_new("application", set_order, bin));
                   }),
                   detect);
  gst_util_set_object_arg(G_OBJECT(detect), "preset", "paper");  // says order=1
  gint order = 0;
  g_object_get(detect, "order", &order, nullptr);
  fail_unless_equals_int(told, 1);
  fail_unless_equals_int(order, 3);
  gst_object_unref(stage);
  gst_object_unref(detect);
}
GST_END_TEST

GST_START_TEST(the_human_gate_is_off_in_preset_traffic) {
  gdouble speed = 0, width = 0;
  GstElement* detect = gst_element_factory_make("motiondetect", nullptr);
  g_object_get(detect, "maximum-speed-metres", &speed, "maximum-width-metres", &width, nullptr);
  fail_unless(speed == 4.0 && width > 0.48);
  gst_util_set_object_arg(G_OBJECT(detect), "preset", "traffic");
  g_object_get(detect, "maximum-speed-metres", &speed, "maximum-width-metres", &width, nullptr);
  fail_unless(speed == 0 && width == 0);
  gst_object_unref(detect);
}
GST_END_TEST

GST_START_TEST(every_preset_works_and_each_property_reaches_its_stage) {
  for (const char* preset : {"default", "paper", "traffic"}) {
    guint found = 0;
    Line line(
        std::string("motiondetect confirm-time=0 ! identity").insert(12, std::string(" preset=") + preset));
    line.run(World{}, 0, 30, [&](int, GstBuffer* out) { found += Regions(out).size(); });
    fail_unless(found > 0, "preset %s finds nothing", preset);
  }
  GstElement* detect = gst_element_factory_make("motiondetect", nullptr);
  g_object_set(detect, "horizontal-fov", 61.5, "mounting-height", 2.5, "closing", 7, "hold-time", GST_SECOND,
               nullptr);
  for (const char* name : {"motionregions", "motiontrack"}) {
    GstElement* stage = gst_bin_get_by_name(GST_BIN(detect), name);
    gdouble fov = 0, height = 0;
    g_object_get(stage, "horizontal-fov", &fov, "mounting-height", &height, nullptr);
    fail_unless(fov == 61.5 && height == 2.5);
    gst_object_unref(stage);
  }
  gst_object_unref(detect);
}
GST_END_TEST

// Every property of every stage is on the bin, with the same default: nobody has to open it. Where stages share one and
// say what each of them does with it, the bin says it in the words of one.
GST_START_TEST(the_bin_has_every_property_of_its_stages) {
  GstElement* detect = gst_element_factory_make("motiondetect", nullptr);
  std::map<std::string, bool> worded;
  for (const char* name :
       {"cameramotion", "threeframediff", "fuzzythreshold", "motionregions", "motiontrack"}) {
    GstElement* stage = gst_element_factory_make(name, nullptr);
    guint count = 0;
    GParamSpec** specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(stage), &count);
    for (guint i = 0; i < count; ++i) {
      if (g_type_is_a(GST_TYPE_BASE_TRANSFORM, specs[i]->owner_type)) continue;  // name, parent, qos
      GParamSpec* spec = g_object_class_find_property(G_OBJECT_GET_CLASS(detect), specs[i]->name);
      fail_unless(spec != nullptr, "motiondetect lacks %s", specs[i]->name);
      worded[spec->name] |= g_str_equal(g_param_spec_get_blurb(spec), g_param_spec_get_blurb(specs[i]));
      GValue a = G_VALUE_INIT, b = G_VALUE_INIT;
      g_value_init(&a, spec->value_type);
      g_value_init(&b, spec->value_type);
      g_param_value_set_default(specs[i], &a);
      g_object_get_property(G_OBJECT(detect), specs[i]->name, &b);
      fail_unless_equals_int(g_param_values_cmp(spec, &a, &b), 0);
      g_value_unset(&a);
      g_value_unset(&b);
    }
    g_free(specs);
    gst_object_unref(stage);
  }
  for (const auto& [name, same] : worded) fail_unless(same, "%s: no stage says it like this", name.c_str());
  gst_object_unref(detect);
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
  tcase_add_test(tests, model_none_says_that_the_camera_stands);
  tcase_add_test(tests, the_area_changes_while_playing);
  tcase_add_test(tests, the_analysis_width_changes_while_playing);
  tcase_add_test(tests, zones_change_while_playing_and_a_typo_keeps_the_old_ones);
  tcase_add_test(tests, limits_of_size_drop_what_is_outside);
  tcase_add_test(tests, bearing_and_distance_follow_from_the_lens);
  tcase_add_test(tests, the_tilt_of_a_pose_on_the_frame_counts_for_the_distance);
  tcase_add_test(tests, limits_of_speed_drop_what_is_outside);
  tcase_add_test(tests, tracks_have_identity_velocity_age_and_state);
  tcase_add_loop_test(tests, what_motionregions_dropped_is_not_found_again_downstream, 0, 4);
  tcase_add_test(tests, motion_starts_once_and_ends_after_hold_time);
  tcase_add_test(tests, motion_ends_with_the_stream_and_with_the_element_but_once);
  tcase_add_test(tests, an_empty_scene_posts_nothing);
  tcase_add_loop_test(tests, planes_stay_only_where_somebody_asks_for_them, 0, 6);
  tcase_add_test(tests, planes_stay_after_a_reconfigure_event_when_they_are_wanted_then);
  tcase_add_test(tests, another_branch_keeps_its_uncleaned_mask);
  tcase_add_test(tests, a_property_that_was_set_wins_over_the_preset_in_any_order);
  tcase_add_test(tests, a_property_that_another_thread_sets_meanwhile_wins_over_the_preset);
  tcase_add_test(tests, the_human_gate_is_off_in_preset_traffic);
  tcase_add_test(tests, every_preset_works_and_each_property_reaches_its_stage);
  tcase_add_test(tests, the_bin_has_every_property_of_its_stages);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(detect);
