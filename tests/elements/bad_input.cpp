// SPDX-License-Identifier: LGPL-2.1-or-later
// Input that should not occur and does: a clear error or a sane result, never a crash, never a wrong result. The C++
// headers come first: check's macros (fail) break standard headers.
#include "records.h"

#include <algorithm>
#include <limits>

#include "outputs.h"
#include "scene.h"
#include "support.h"

namespace {

using scene::kElementCount;
using scene::kElements;
using scene::Line;
using scene::Regions;
using scene::World;

constexpr const char* kDetect = "motiondetect confirm-time=0 ! identity";

// Consumes both frames; at the end at least one object must have been found.
void assert_same_regions(GstBuffer* found, GstBuffer* expected, bool at_the_end) {
  const std::string is = Regions(found).text(), should = Regions(expected).text();
  ck_assert_str_eq(is.c_str(), should.c_str());
  if (at_the_end) fail_unless(!should.empty());
  gst_buffer_unref(found);
  gst_buffer_unref(expected);
}

GstBuffer* sized(gsize bytes, GstClockTime pts) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, bytes, nullptr);
  gst_buffer_memset(buffer, 0, 90, bytes);
  GST_BUFFER_PTS(buffer) = pts;
  return buffer;
}

// The same frame with a video meta: any stride, any offset.
GstBuffer* strided(const World& world, int frame, gint stride, gsize offset) {
  const std::vector<std::uint8_t> grey = world.picture(frame);
  const gsize bytes = offset + static_cast<gsize>(stride) * world.height;
  GstBuffer* buffer = sized(bytes, frame * scene::kStep);
  for (int y = 0; y < world.height; ++y)
    gst_buffer_fill(buffer, offset + static_cast<gsize>(y) * stride,
                    &grey[static_cast<std::size_t>(y) * world.width], world.width);
  gsize offsets[GST_VIDEO_MAX_PLANES] = {offset};
  gint strides[GST_VIDEO_MAX_PLANES] = {stride};
  gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_GRAY8, world.width,
                                 world.height, 1, offsets, strides);
  return buffer;
}

GST_START_TEST(empty_and_truncated_buffers_pass_with_one_warning_and_detection_goes_on) {
  Line line(std::string(kElements[__i__]) + " ! identity");
  const World world;
  line.run(world, 0, 10);
  int k = 10;
  for (const gsize bytes : {gsize{0}, gsize{1}, gsize{scene::kWidth * scene::kHeight - 1}}) {
    GstBuffer* out = line.through(sized(bytes, k++ * scene::kStep));
    fail_unless_equals_uint64(gst_buffer_get_size(out), bytes);
    fail_unless(GST_BUFFER_FLAG_IS_SET(out, GST_BUFFER_FLAG_CORRUPTED));
    fail_unless_equals_int(Regions(out).size(), 0);
    gst_buffer_unref(out);
  }
  const std::vector<std::string> warnings = line.messages(GST_MESSAGE_WARNING);
  fail_unless_equals_int(warnings.size(), 1);
  fail_unless(warnings[0].find("does not hold the picture") != std::string::npos);
  guint found = 0;
  line.run(world, k, k + 20, [&](int, GstBuffer* out) {
    fail_if(GST_BUFFER_FLAG_IS_SET(out, GST_BUFFER_FLAG_CORRUPTED));
    found += Regions(out).size();
  });
  if (__i__ >= 3) fail_unless(found > 0);
}
GST_END_TEST

GST_START_TEST(a_stride_far_above_the_width_changes_nothing) {
  const World world;
  Line plain(kDetect), wide(kDetect);
  for (int k = 0; k < 20; ++k) {
    GstBuffer* a = plain.through(scene::grey_buffer(world, k));
    GstBuffer* b = wide.through(strided(world, k, 4096 + 3, 77));
    assert_same_regions(b, a, k == 19);
  }
}
GST_END_TEST

// As decoders of padded pictures make them: the meta is larger than the caps, the picture its top left part.
GST_START_TEST(a_video_meta_larger_than_the_caps_changes_nothing) {
  World world, larger;
  larger.width = 352;
  larger.height = 288;
  Line plain(kDetect), padded(kDetect);
  for (int k = 0; k < 20; ++k) {
    GstBuffer* in = sized(static_cast<gsize>(larger.width) * larger.height, k * scene::kStep);
    const std::vector<std::uint8_t> grey = world.picture(k);
    for (int y = 0; y < world.height; ++y)
      gst_buffer_fill(in, static_cast<gsize>(y) * larger.width,
                      &grey[static_cast<std::size_t>(y) * world.width], world.width);
    gst_buffer_add_video_meta(in, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_GRAY8, larger.width,
                              larger.height);
    GstBuffer* a = plain.through(scene::grey_buffer(world, k));
    GstBuffer* b = padded.through(in);
    assert_same_regions(b, a, k == 19);
  }
}
GST_END_TEST

GST_START_TEST(a_video_meta_that_does_not_fit_is_an_unusable_buffer) {
  const World world;
  struct Lie {
    GstVideoFormat format;
    guint width, height;
    gint stride;
    gsize offset;
  };
  const Lie lies[] = {
      {GST_VIDEO_FORMAT_GRAY8, 320, 240, 1 << 20, 0},           // rows far behind the memory
      {GST_VIDEO_FORMAT_GRAY8, 320, 240, 320, 1},               // the last byte is missing
      {GST_VIDEO_FORMAT_GRAY8, 320, 240, 320, gsize{1} << 40},  // begins nowhere
      {GST_VIDEO_FORMAT_GRAY8, 320, 240, -320, 0},              // bottom-up, begins at the top
      {GST_VIDEO_FORMAT_GRAY8, 320, 240, std::numeric_limits<gint>::min(), 0},
      {GST_VIDEO_FORMAT_GRAY8, 320, 240, 100, 0},  // rows over one another
      {GST_VIDEO_FORMAT_GRAY8, 320, 240, 0, 0},
      {GST_VIDEO_FORMAT_GRAY8, 64, 48, 320, 0},   // another size
      {GST_VIDEO_FORMAT_NV12, 320, 240, 320, 0},  // another format
  };
  for (const Lie& lie : lies) {
    Line line(kDetect);
    line.run(world, 0, 5);
    GstBuffer* in = scene::grey_buffer(world, 5);
    gsize offsets[GST_VIDEO_MAX_PLANES] = {lie.offset, lie.offset};
    gint strides[GST_VIDEO_MAX_PLANES] = {lie.stride, lie.stride};
    GstVideoMeta* meta =
        gst_buffer_add_video_meta(in, GST_VIDEO_FRAME_FLAG_NONE, lie.format, lie.width, lie.height);
    std::copy(offsets, offsets + 4, meta->offset);
    std::copy(strides, strides + 4, meta->stride);
    gst_buffer_unref(line.through(in));
    fail_unless_equals_int(line.messages(GST_MESSAGE_WARNING).size(), 1);
    line.run(world, 6, 10);
  }
}
GST_END_TEST

GST_START_TEST(missing_timestamps_are_no_obstacle) {
  Line timed(kDetect), timeless(kDetect);
  const World world;
  guint found = 0;
  for (int k = 0; k < 30; ++k) {
    GstBuffer* in = scene::grey_buffer(world, k);
    GST_BUFFER_PTS(in) = GST_BUFFER_DTS(in) = GST_BUFFER_DURATION(in) = GST_CLOCK_TIME_NONE;
    GstBuffer* a = timeless.through(in);
    GstBuffer* b = timed.through(scene::grey_buffer(world, k));
    const std::string without = Regions(a).text(), with = Regions(b).text();
    ck_assert_str_eq(without.c_str(), with.c_str());
    found += Regions(a).size();
    gst_buffer_unref(a);
    gst_buffer_unref(b);
  }
  fail_unless(found > 0);
}
GST_END_TEST

struct Stamps {
  GstClockTime (*of)(int frame);
  bool warned;
};
const Stamps kStamps[] = {
    {[](int k) -> GstClockTime { return (100 - k) * scene::kStep; }, true},
    {[](int k) -> GstClockTime { return (k + 2 - (k % 10 == 9 ? 2 : 0)) * scene::kStep; }, true},
    {[](int k) -> GstClockTime { return (k + 2 - (k % 5 == 4 ? 2 : 0)) * scene::kStep; }, true},
    {[](int k) { return static_cast<GstClockTime>(k); }, false},
    {[](int) -> GstClockTime { return GST_SECOND; }, false},
    {[](int) -> GstClockTime { return GST_CLOCK_TIME_NONE; }, false},
};
constexpr int kStampCount = G_N_ELEMENTS(kStamps);

// Frames in order with wrong timestamps: objects are found all the same, and one warning names the remedy. A large
// step back begins a new scene.
GST_START_TEST(timestamps_out_of_order_do_not_stop_the_detection) {
  const char* const lines[] = {"motiondetect ! identity",
                               "threeframediff ! fuzzythreshold ! motionregions ! motiontrack"};
  const Stamps& kind = kStamps[__i__ % kStampCount];
  Line line(lines[__i__ / kStampCount]), ordered(lines[__i__ / kStampCount]);
  const World world = scene::entering();
  int found = 0, expected = 0;
  for (int k = 0; k < 90; ++k) {
    GstBuffer* in = scene::grey_buffer(world, k);
    GST_BUFFER_PTS(in) = kind.of(k);
    GstBuffer* out = line.through(in);
    const Regions regions(out);
    found += regions.size() > 0;
    for (guint i = 0; i < regions.size(); ++i)
      fail_unless(scene::overlaps_figure(regions[i], world, k), "frame %d: %s", k, regions.text().c_str());
    gst_buffer_unref(out);
    out = ordered.through(scene::grey_buffer(world, k));
    expected += Regions(out).size() > 0;
    gst_buffer_unref(out);
  }
  fail_unless(expected > 50);
  fail_unless(std::abs(found - expected) <= 2, "found in %d frames instead of %d", found, expected);
  const auto warnings = line.messages(GST_MESSAGE_WARNING);
  fail_unless_equals_int(warnings.size(), kind.warned);
  if (kind.warned)
    fail_unless(warnings[0].find("do-timestamp") != std::string::npos, "%s", warnings[0].c_str());
  fail_unless(ordered.messages(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST

// With the frame rate of the caps, or with none: then 25 frames a second are assumed, as for speeds. Ten frames
// without an object are therefore 0.4 s.
GST_START_TEST(motion_ends_after_hold_time_whatever_the_timestamps_say) {
  const Stamps& kind = kStamps[__i__ % kStampCount];
  Line line("motiondetect coast-time=0 hold-stopped=0 hold-time=400000000 ! identity");
  if (__i__ >= kStampCount) line.push_caps(scene::caps("GRAY8", scene::kWidth, scene::kHeight, ""));
  World world;
  world.start = 200;
  world.speed = 4;
  int last_seen = -1, ended = -1;
  for (int k = 0; k < 80 && ended < 0; ++k) {
    GstBuffer* in = scene::grey_buffer(world, k);
    GST_BUFFER_PTS(in) = kind.of(k);
    GST_BUFFER_DTS(in) = GST_BUFFER_DURATION(in) = GST_CLOCK_TIME_NONE;
    GstBuffer* out = line.through(in);
    if (Regions(out).size() > 0) last_seen = k;
    gst_buffer_unref(out);
    for (const std::string& state : line.messages(GST_MESSAGE_ELEMENT))
      if (state == "ended") ended = k;
  }
  fail_unless(last_seen > 0);
  fail_unless(std::abs(ended - last_seen - 10) <= 1, "seen until frame %d, ended at %d", last_seen, ended);
}
GST_END_TEST

// One buffer in ten without a picture, at rest and while the
// camera turns: the others go on as if it had not been there.
GST_START_TEST(lost_pictures_end_no_scene) {
  const char* const lines[] = {
      "motiondetect ! identity",
      "cameramotion ! threeframediff ! fuzzythreshold ! motionregions ! motiontrack"};
  World world = scene::entering();
  world.pan = __i__ / 2 * 5;
  world.speed = 3 + world.pan;
  Line line(lines[__i__ % 2]);
  guint id = 0;
  int found = 0;
  for (int k = 0; k < 90; ++k) {
    const bool lost = k % 10 == 5;
    GstBuffer* out = line.through(lost ? sized(0, k * scene::kStep) : scene::grey_buffer(world, k));
    const Regions regions(out);
    if (k >= 40 && !lost) {
      ++found;
      fail_unless_equals_int(regions.size(), 1);
      fail_unless(id == 0 || regions[0].id == id, "frame %d: another identity", k);
      id = regions[0].id;
      fail_unless(std::abs(regions[0].vx - world.speed * 25) < 20, "frame %d: %f px/s", k, regions[0].vx);
    }
    gst_buffer_unref(out);
  }
  fail_unless_equals_int(found, 45);
  fail_unless_equals_int(line.messages(GST_MESSAGE_WARNING).size(), 1);
}
GST_END_TEST

// Metas of our types from another element, with numbers that are not finite or out of range.
GST_START_TEST(metas_of_other_elements_do_no_harm) {
  Line line(std::string(kElements[__i__]) + " ! identity");
  Line alone(std::string(kElements[__i__]) + " ! identity");
  const World world;
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  bool seen_alone = false;
  for (int k = 0; k < 20; ++k) {
    GstBuffer* in = scene::grey_buffer(world, k);
    CerberusCameraMotion motion;
    cerberus_camera_motion_init(&motion);
    motion.matrix[k % 9] = k % 3 == 0 ? nan : k % 3 == 1 ? inf : -1e300;
    motion.confidence = k % 2 ? nan : -7;
    motion.residual = inf;
    motion.from = k > 0 ? (k - 1) * scene::kStep : GST_CLOCK_TIME_NONE;
    motion.scene_age = k + 1;
    cerberus_buffer_set_camera_motion(in, &motion);
    CerberusRegion region;
    cerberus_region_init(&region);
    region.x = -1e9;
    region.width = 1e9;
    region.height = 1;
    region.confidence = nan;
    cerberus_buffer_add_region(in, &region);
    gst_buffer_add_video_region_of_interest_meta(in, "face", 10, 20, 30, 40);
    GstBuffer* out = line.through(in);
    guint faces = 0;
    gpointer position = nullptr;
    while (GstMeta* meta =
               gst_buffer_iterate_meta_filtered(out, &position, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE))
      faces += reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta)->roi_type == g_quark_from_string("face");
    fail_unless_equals_int(faces, 1);
    // Where the camera motion is measured anew, everything downstream is computed anew: the result equals the one
    // without foreign metas. The other elements cannot follow such a camera, and find only what the foreign planes
    // contain.
    GstBuffer* without = alone.through(scene::grey_buffer(world, k));
    const std::string is = Regions(out).text(), should = Regions(without).text();
    const std::string element = kElements[__i__];
    if (element == "motiondetect")
      fail_unless(is == should, "frame %d: %s instead of %s", k, is.c_str(), should.c_str());
    else if (k % 2 == 0 && (element == "motionregions" || element == "motiontrack"))
      fail_unless(is.empty(), "frame %d: %s", k, is.c_str());
    seen_alone = seen_alone || !should.empty();
    gst_buffer_unref(without);
    gst_buffer_unref(out);
  }
  fail_unless_equals_int(seen_alone, __i__ >= 3);
  fail_unless(line.messages(GST_MESSAGE_ERROR).empty());
}
GST_END_TEST

// The times are consecutive; the transforms are meaningless or would mirror the picture.
GST_START_TEST(a_camera_motion_that_none_can_be_is_not_believed) {
  const double nonsense[][9] = {
      {std::numeric_limits<double>::quiet_NaN(), 0, 0, 0, 1, 0, 0, 0, 1},
      {1, 0, std::numeric_limits<double>::infinity(), 0, 1, 0, 0, 0, 1},
      {-1, 0, 320, 0, 1, 0, 0, 0, 1},
      // Near (142, 132), where the figure is, nothing moves; right of x = 242 is beyond the horizon:
      // x' = 142 + (x - 142) / w, y' = 132 + (y - 132) / w, w = 1 - (x - 142) / 100.
      {-0.42, 0, 201.64, -1.32, 1, 187.44, -0.01, 0, 2.42},
      {0, 0, 0, 0, 0, 0, 0, 0, 0},
      {1, 0, 0, 0, 1, 0, 0, 0, 1},  // this one is a camera that stands
  };
  Line regions("motionregions"), alone("motionregions"), tracks("motiontrack confirm-time=0");
  World world;
  world.start = 120;
  world.speed = 2;
  guint id = 0;
  for (int k = 0; k < 12; ++k) {
    GstBuffer* in = scene::grey_buffer(world, k);
    CerberusCameraMotion motion;
    cerberus_camera_motion_init(&motion);
    cerberus_camera_motion_set_matrix(&motion, nonsense[__i__]);
    motion.from = k > 0 ? (k - 1) * scene::kStep : GST_CLOCK_TIME_NONE;
    motion.scene_age = k + 1;
    cerberus_buffer_set_camera_motion(in, &motion);
    GstBuffer* out = regions.through(in);
    const auto* threshold = records::threshold_facts_of(out);
    const bool stands = __i__ == G_N_ELEMENTS(nonsense) - 1;
    fail_unless_equals_int(threshold->result.ready, stands && k >= 2);
    if (!stands) fail_unless_equals_int(Regions(out).size(), 0);
    gst_buffer_unref(out);
    // And regions that were found all the same: with no way from frame to frame there is no identity.
    out = alone.through(scene::grey_buffer(world, k));
    cerberus_buffer_set_camera_motion(out, &motion);
    out = tracks.through(out);
    if (k >= 2) {
      const Regions found(out);
      fail_unless(found.size() > 0);
      fail_unless(id == 0 || (found[0].id == id) == stands, "frame %d: %u after %u", k, found[0].id, id);
      id = found[0].id;
    }
    gst_buffer_unref(out);
  }
}
GST_END_TEST

// The record of a frame of another size does not apply to this one: an element in between cropped the picture in
// place.
GST_START_TEST(the_record_of_a_frame_of_another_size_is_not_read) {
  Line line("motionregions ! identity"), alone("motionregions ! identity");
  const World world;
  for (int k = 0; k < 12; ++k) {
    GstBuffer* in = scene::grey_buffer(world, k);
    records::on(in, {384, 240})->luma.write() =
        records::picture<guint8>({320, 200}, [](int, int) { return 0; });
    assert_same_regions(line.through(in), alone.through(scene::grey_buffer(world, k)), k == 11);
  }
}
GST_END_TEST

GST_START_TEST(the_warning_of_an_unusable_buffer_comes_again_with_new_caps) {
  Line line(std::string(kElements[__i__]) + " ! identity");
  for (int stream = 1; stream <= 2; ++stream) {
    for (int k = 0; k < 3; ++k) gst_buffer_unref(line.through(sized(0, k * scene::kStep)));
    fail_unless_equals_int(line.messages(GST_MESSAGE_WARNING).size(), 1);
    line.push_caps(scene::caps("GRAY8", scene::kWidth, scene::kHeight, ",framerate=50/1"));
  }
}
GST_END_TEST

// Upstream tries refused caps again with every frame.
GST_START_TEST(video_without_a_size_is_one_error) {
  constexpr const char* kLines[] = {"cameramotion",  "motiondetect", "motionview",
                                    "motionoverlay", "motionjson",   "pantiltsink"};
  outputs::Harness harness = outputs::harness(kLines[__i__]);
  outputs::Bus bus(harness.get());
  for (int start = 0; start < 2; ++start) {
    gst_harness_set_src_caps_str(harness.get(), "video/x-raw,format=GRAY8,framerate=30/1");
    for (int k = 0; k < 3; ++k)
      fail_unless_equals_int(gst_harness_push(harness.get(), sized(100, k * scene::kStep)),
                             GST_FLOW_NOT_NEGOTIATED);
    fail_unless_equals_int(bus.count(GST_MESSAGE_ERROR), 1);
    gst_element_set_state(harness.get()->element, GST_STATE_READY);
    gst_element_set_state(harness.get()->element, GST_STATE_PLAYING);
  }
}
GST_END_TEST

// Distances and body proportions would be wrong without any sign of it.
GST_START_TEST(pixels_that_are_not_square_are_warned_of_once) {
  const std::pair<const char*, bool> kShapes[] = {
      {"1/1", false}, {"12/11", false}, {"10/11", false}, {"1/2", true}, {"64/45", true}};
  const World world;
  for (const auto& [shape, warned] : kShapes) {
    Line line("motiondetect ! identity",
              scene::caps("GRAY8", scene::kWidth, scene::kHeight) + ",pixel-aspect-ratio=" + shape);
    line.run(world, 0, 3);
    line.push_caps(
        scene::caps("GRAY8", scene::kWidth, scene::kHeight, ",framerate=50/1,pixel-aspect-ratio=") + shape);
    line.run(world, 3, 5);
    const auto warnings = line.messages(GST_MESSAGE_WARNING);
    fail_unless_equals_int(warnings.size(), warned);
    if (warned) fail_unless(warnings[0].find("videoscale") != std::string::npos, "%s", warnings[0].c_str());
  }
}
GST_END_TEST

GST_START_TEST(absurd_property_values_are_refused_or_harmless) {
  GstElement* element = gst_element_factory_make(kElements[__i__], nullptr);
  guint count = 0;
  GParamSpec** specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(element), &count);
  for (guint i = 0; i < count; ++i) {
    if (!(specs[i]->flags & G_PARAM_WRITABLE) || G_TYPE_FUNDAMENTAL(specs[i]->value_type) == G_TYPE_OBJECT)
      continue;
    if (specs[i]->value_type == G_TYPE_STRING) continue;
    for (const double absurd : {-1e30, -1.0, 0.0, 1e-30, 1e30}) {
      GValue from = G_VALUE_INIT, to = G_VALUE_INIT;
      g_value_init(&from, G_TYPE_DOUBLE);
      g_value_set_double(&from, absurd);
      g_value_init(&to, specs[i]->value_type);
      if (g_value_transform(&from, &to)) {
        g_param_value_validate(specs[i], &to);  // the nearest value that the property takes: its extremes
        g_object_set_property(G_OBJECT(element), specs[i]->name, &to);
      }
      g_value_unset(&to);
    }
  }
  g_free(specs);
  // With every number at its upper end the element still runs.
  GstHarness* harness = gst_harness_new_with_element(element, "sink", "src");
  gst_harness_set_src_caps_str(harness, scene::caps("GRAY8", scene::kWidth, scene::kHeight).c_str());
  const World world;
  for (int k = 0; k < 8; ++k) {
    fail_unless_equals_int(gst_harness_push(harness, scene::grey_buffer(world, k)), GST_FLOW_OK);
    gst_buffer_unref(gst_harness_pull(harness));
  }
  gst_harness_teardown(harness);
  gst_object_unref(element);
}
GST_END_TEST

GST_START_TEST(zones_that_cannot_be_read_are_a_clear_error) {
  // The last one is quoted in part: 59 letters, and half of an e with an accent.
  for (const char* text :
       {"include 0,0 1,0", "includ 0,0 1,0 1,1", "include 0,0 1,0 x,1", "include 0,0 1,0 1,2", "0.1",
        "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\xc3\xa9 0,0 1,0 1,1"}) {
    GstElement* element = gst_element_factory_make("motiondetect", nullptr);
    GstBus* bus = gst_bus_new();
    gst_element_set_bus(element, bus);
    g_object_set(element, "zones", text, nullptr);
    fail_unless_equals_int(gst_element_set_state(element, GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
    GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
    fail_unless(message != nullptr, "%s gave no error", text);
    GError* error = nullptr;
    gst_message_parse_error(message, &error, nullptr);
    fail_unless(strstr(error->message, "zones") != nullptr, "%s", error->message);
    fail_unless(g_utf8_validate(error->message, -1, nullptr), "%s", error->message);
    fail_unless(g_error_matches(error, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_SETTINGS));
    g_error_free(error);
    gst_message_unref(message);
    gst_element_set_state(element, GST_STATE_NULL);
    gst_element_set_bus(element, nullptr);
    gst_object_unref(bus);
    gst_object_unref(element);
  }
}
GST_END_TEST

// Settings that contradict each other or exclude everything: one warning names the property, and the frames pass.
GST_START_TEST(settings_that_can_find_nothing_are_warned_of) {
  const char* const kSettings[][2] = {
      {"minimum-width=100 maximum-width=10", "minimum-width is larger than maximum-width"},
      {"minimum-height=100 maximum-height=10", "minimum-height is larger than maximum-height"},
      {"minimum-width=321", "minimum-width is larger than the picture"},
      {"minimum-height=241", "minimum-height is larger than the picture"},
      {"minimum-area=76801", "minimum-area is larger than the picture"},
      {"analysis-width=160 minimum-area=19201", "minimum-area is larger than the picture"},
      {"horizontal-fov=60 minimum-width-metres=2",
       "minimum-width-metres is larger than maximum-width-metres"},
      {"horizontal-fov=60 minimum-height-metres=2 maximum-height-metres=1", "maximum-height-metres"},
      {"minimum-speed=100 maximum-speed=10",
       "minimum-speed is larger than maximum-speed: only who was as fast once"},
      {"horizontal-fov=60 minimum-speed-metres=5", "minimum-speed-metres is larger"},
      {"confirm-time=18446744073709551615", "confirm-time"},
      {"zones=\"include 0,0 0,0 0,0\"", "zones"},
      {"zones=\"exclude 0,0 1,0 1,1 0,1\"", "zones"},
      {"analysis-width=1", "analysis-width=1 is too small"},
      // and what is none of that
      {"minimum-width=10 maximum-width=10 minimum-height=240", nullptr},
      {"minimum-width-metres=2", nullptr},  // does not count without horizontal-fov
      {"minimum-area=76800", nullptr},
      {"analysis-width=160 minimum-area=19200", nullptr},
      {"minimum-speed=10", nullptr},
      {"zones=\"include 0,0 0.01,0 0.01,0.01 0,0.01\"", nullptr},
      {"coast-time=18446744073709551615 hold-stopped=18446744073709551615", nullptr},
      {"analysis-width=48", nullptr},
  };
  const char* expected = kSettings[__i__][1];
  Line line("motiondetect name=d " + std::string(kSettings[__i__][0]) + " ! identity");
  const World world;
  line.run(world, 0, 5);
  const auto warnings = line.messages(GST_MESSAGE_WARNING);
  fail_unless_equals_int(warnings.size(), expected != nullptr);
  if (expected) fail_unless(warnings[0].find(expected) != std::string::npos, "%s", warnings[0].c_str());
  line.restart();  // another element may be listening now
  line.run(world, 0, 5);
  fail_unless_equals_int(line.messages(GST_MESSAGE_WARNING).size(), expected != nullptr);
}
GST_END_TEST

GST_START_TEST(a_setting_made_while_playing_is_warned_of_and_no_other_one_repeats_it) {
  GstElement* element = gst_element_factory_make("motionregions", nullptr);
  g_object_set(element, "minimum-width", 50.0, nullptr);
  GstHarness* harness = gst_harness_new_with_element(element, "sink", "src");
  GstBus* bus = gst_bus_new();
  gst_element_set_bus(element, bus);
  gst_harness_set_src_caps_str(harness, scene::caps("GRAY8", scene::kWidth, scene::kHeight).c_str());
  const World world;
  int warned = 0;
  for (int k = 0; k < 12; ++k) {
    if (k == 2 || k == 8) g_object_set(element, "maximum-width", 10.0, nullptr);
    if (k == 4) g_object_set(element, "closing", 3, nullptr);
    if (k == 6) g_object_set(element, "maximum-width", 100.0, nullptr);
    if (k == 9) g_object_set(element, "zones", "garden", nullptr);
    if (k == 10) g_object_set(element, "closing", 2, nullptr);
    fail_unless_equals_int(gst_harness_push(harness, scene::grey_buffer(world, k)), GST_FLOW_OK);
    gst_buffer_unref(gst_harness_pull(harness));
    while (GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING)) {
      ++warned;
      gst_message_unref(message);
    }
    fail_unless_equals_int(warned, k < 2 ? 0 : k < 8 ? 1 : k < 9 ? 2 : 3);
  }
  gst_element_set_bus(element, nullptr);
  gst_harness_teardown(harness);
  gst_object_unref(element);
  gst_object_unref(bus);
}
GST_END_TEST

// Smaller than anything can be seen in: the least that can counts.
GST_START_TEST(an_analysis_width_of_one_still_sees) {
  Line line("motiondetect analysis-width=1 ! identity");
  World world = scene::entering();
  int found = 0;
  line.run(world, 0, 90, [&](int, GstBuffer* out) { found += Regions(out).size() > 0; });
  fail_unless(found > 40, "found in %d frames", found);
}
GST_END_TEST

Suite* bad_input_suite() {
  Suite* suite = suite_create("bad input");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_loop_test(tests, empty_and_truncated_buffers_pass_with_one_warning_and_detection_goes_on, 0,
                      kElementCount);
  tcase_add_test(tests, a_stride_far_above_the_width_changes_nothing);
  tcase_add_test(tests, a_video_meta_larger_than_the_caps_changes_nothing);
  tcase_add_test(tests, a_video_meta_that_does_not_fit_is_an_unusable_buffer);
  tcase_add_test(tests, missing_timestamps_are_no_obstacle);
  tcase_add_loop_test(tests, timestamps_out_of_order_do_not_stop_the_detection, 0, 2 * kStampCount);
  tcase_add_loop_test(tests, motion_ends_after_hold_time_whatever_the_timestamps_say, 0, 2 * kStampCount);
  tcase_add_loop_test(tests, lost_pictures_end_no_scene, 0, 4);
  tcase_add_loop_test(tests, metas_of_other_elements_do_no_harm, 0, kElementCount);
  tcase_add_loop_test(tests, a_camera_motion_that_none_can_be_is_not_believed, 0, 6);
  tcase_add_test(tests, the_record_of_a_frame_of_another_size_is_not_read);
  tcase_add_loop_test(tests, the_warning_of_an_unusable_buffer_comes_again_with_new_caps, 0, kElementCount);
  tcase_add_loop_test(tests, video_without_a_size_is_one_error, 0, 6);
  tcase_add_test(tests, pixels_that_are_not_square_are_warned_of_once);
  tcase_add_loop_test(tests, absurd_property_values_are_refused_or_harmless, 0, kElementCount);
  tcase_add_test(tests, zones_that_cannot_be_read_are_a_clear_error);
  tcase_add_loop_test(tests, settings_that_can_find_nothing_are_warned_of, 0, 22);
  tcase_add_test(tests, a_setting_made_while_playing_is_warned_of_and_no_other_one_repeats_it);
  tcase_add_test(tests, an_analysis_width_of_one_still_sees);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(bad_input);
