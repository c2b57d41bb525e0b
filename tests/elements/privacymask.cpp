// SPDX-License-Identifier: LGPL-2.1-or-later
// What must not be seen is not, in frames of a window that turns; and what happens where that cannot be ensured.
//
// CERBERUS_FRAMES=1000: so many encoded frames instead of a few.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <string>

#include "recorder_rig.h"

#include "records.h"

#include "outputs.h"

using namespace outputs;

namespace {

constexpr int kWide = 640, kHigh = 480, kWindow = 320, kWindowHigh = 240;
// A place of 120 x 100 pixels of the wide picture, white before grey.
constexpr int kLeft = 380, kTop = 150, kPlaceWidth = 120, kPlaceHeight = 100;
constexpr double kFocal = 554.256;  // 320 / tan(60 / 2 degrees)
constexpr guint8 kWall = 100, kWhite = 255, kHalf = 150;

double degrees_of(double ratio) {
  return std::atan(ratio) * 180 / M_PI;
}

// The corner's direction from a camera that looks straight ahead: pan by its column, tilt by the ray's elevation.
std::string corner(int x, int y) {
  const double right = (x - kWide / 2) / kFocal, up = (kHigh / 2 - y) / kFocal;
  return std::to_string(degrees_of(right)) + "," + std::to_string(degrees_of(up / std::hypot(right, 1))) +
         " ";
}

std::string masks() {
  const int right = kLeft + kPlaceWidth, bottom = kTop + kPlaceHeight;
  return "masks=\"world " + corner(kLeft, kTop) + corner(right, kTop) + corner(right, bottom) +
         corner(kLeft, bottom) + "\"";
}

GstBuffer* panorama(const char* format = "GRAY8") {
  const GstVideoInfo info = info_of(caps_string(format, kWide, kHigh));
  GstBuffer* buffer = frame(info, 0, kWall);
  const std::vector<guint8> row(kPlaceWidth, kWhite);
  for (int y = kTop; y < kTop + kPlaceHeight; ++y)
    gst_buffer_fill(buffer, static_cast<gsize>(y) * kWide + kLeft, row.data(), row.size());
  return buffer;
}

// A window of 30 degrees into the panorama, turned from frame to frame by the pose that it receives.
Harness window(const std::string& behind) {
  const std::string line =
      "virtualptz lockstep=off wide-fov=60 horizontal-fov=32.2 width=320 height=240" + behind;
  Harness h(gst_harness_new_parse(line.c_str()));
  gst_harness_set_src_caps_str(h.get(), caps_string("GRAY8", kWide, kHigh).c_str());
  return h;
}

GstBuffer* through(GstHarness* h, GstBuffer* wide, const CerberusPose& pose, GstClockTime time) {
  gst_harness_push_upstream_event(h, cerberus_event_new_pose(&pose));
  GstBuffer* in = gst_buffer_copy(wide);
  GST_BUFFER_PTS(in) = time;
  fail_unless_equals_int(gst_harness_push(h, in), GST_FLOW_OK);
  return gst_harness_pull(h);
}

int count(GstBuffer* buffer, guint8 from, guint8 to) {
  int n = 0;
  for (const guint8 value : bytes(buffer)) n += value >= from && value <= to;
  return n;
}

// It swings by 14 degrees to each side and 5 up and down; exactly as said.
CerberusPose swing(int n, GstClockTime time) {
  CerberusPose pose;
  cerberus_pose_init(&pose);
  const double t = n * 0.04;
  pose.pan = 14 * std::sin(0.7 * t), pose.pan_speed = 14 * 0.7 * std::cos(0.7 * t);
  pose.tilt = 5 * std::sin(1.3 * t), pose.tilt_speed = 5 * 1.3 * std::cos(1.3 * t);
  pose.valid_from = time;
  pose.source = CERBERUS_POSE_MEASURED;
  pose.moving = TRUE;
  return pose;
}

constexpr char kCaps[] = "video/x-raw,format=GRAY8,width=320,height=240,framerate=25/1";

Harness mask(const std::string& properties) {
  Harness h = harness(("privacymask " + properties).c_str());
  gst_harness_set_src_caps_str(h.get(), kCaps);
  return h;
}

// Pictures that arrive at a fakesink, and their bright pixels.
struct Seen {
  Seen(GstElement* pipeline, const char* sink) {
    g_autoptr(GstElement) element = gst_bin_get_by_name(GST_BIN(pipeline), sink);
    g_object_set(element, "signal-handoffs", TRUE, "sync", FALSE, nullptr);
    g_signal_connect(element, "handoff", G_CALLBACK(+[](GstElement*, GstBuffer* buffer, GstPad*, Seen* self) {
                       ++self->frames;
                       self->bright += count(buffer, kHalf, 255);
                     }),
                     this);
  }
  std::atomic<int> frames = 0, bright = 0;
};

GstElement* parsed(const std::string& line) {
  g_autoptr(GError) error = nullptr;
  GstElement* pipeline = gst_parse_launch(line.c_str(), &error);
  fail_unless(pipeline && !error, "%s", error ? error->message : "");
  return pipeline;
}

void run_to_its_end(GstElement* pipeline) {
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
      bus, GST_CLOCK_TIME_NONE, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  fail_unless_equals_int(GST_MESSAGE_TYPE(message), GST_MESSAGE_EOS);
  gst_element_set_state(pipeline, GST_STATE_NULL);
}

constexpr char kGrey[] = " ! videoconvert ! video/x-raw,format=GRAY8 ! fakesink name=end";

// The pictures of a file.
void assert_dark(const std::string& file, const char* decoder, int frames) {
  g_autoptr(GstElement) pipeline = parsed("filesrc location=\"" + file + "\" ! " + decoder + kGrey);
  const Seen seen(pipeline, "end");
  run_to_its_end(pipeline);
  fail_unless_equals_int(seen.frames, frames);
  fail_unless(seen.bright == 0, "%s shows %d pixels", file.c_str(), seen.bright.load());
}

// The next pose reaches the window in front of each frame.
GstPadProbeReturn turn(GstPad*, GstPadProbeInfo* info, gpointer window) {
  const GstClockTime time = GST_BUFFER_PTS(GST_PAD_PROBE_INFO_BUFFER(info));
  const CerberusPose pose = swing(static_cast<int>(time / (40 * GST_MSECOND)), time);
  g_autoptr(GstPad) source = gst_element_get_static_pad(GST_ELEMENT(window), "src");
  gst_pad_send_event(source, cerberus_event_new_pose(&pose));
  return GST_PAD_PROBE_OK;
}

GstPadProbeReturn count_bright(GstPad*, GstPadProbeInfo* info, gpointer sum) {
  g_autoptr(GstBuffer) luma = gst_buffer_copy_region(GST_PAD_PROBE_INFO_BUFFER(info), GST_BUFFER_COPY_MEMORY,
                                                     0, kWindow * kWindowHigh);
  *static_cast<int*>(sum) += count(luma, kHalf, 255);
  return GST_PAD_PROBE_OK;
}

void add_probe(GstElement* element, const char* name, GstPadProbeCallback probe, gpointer data) {
  g_autoptr(GstPad) pad = gst_element_get_static_pad(element, name);
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, probe, data, nullptr);
}

}  // namespace

GST_START_TEST(no_pixel_of_the_place_is_seen_in_a_thousand_frames_and_little_else_is_hidden) {
  Harness open = window(" ! identity"), masked = window(" ! privacymask horizontal-fov=32.2 " + masks());
  GstBuffer* wide = panorama();
  double place = 0, hidden = 0;
  for (int n = 0; n < 1000; ++n) {
    const GstClockTime time = n * 40 * GST_MSECOND;
    const CerberusPose pose = swing(n, time);
    GstBuffer *seen = through(open.get(), wide, pose, time), *out = through(masked.get(), wide, pose, time);
    fail_unless(count(out, kHalf, 255) == 0, "frame %d shows %d pixels", n, count(out, kHalf, 255));
    const int shown = count(seen, kHalf, 255);
    if (shown == kPlaceWidth * kPlaceHeight || shown > 10000) {
      place += shown;
      hidden += count(out, 0, kWall - 20);
    }
    gst_buffer_unref(seen);
    gst_buffer_unref(out);
  }
  gst_buffer_unref(wide);
  fail_unless(place > 100 * 10000.0, "the place is in few frames");
  g_print("%.2f times the place is hidden\n", hidden / place);
  fail_unless(hidden <= 1.5 * place, "%.2f times the place is hidden", hidden / place);
}
GST_END_TEST

// Behind H.264 and the recorder's file, behind JPEG, and in the picture beside the file.
GST_START_TEST(no_encoded_frame_or_picture_shows_the_place) {
  for (const char* needed : {"x264enc", "avdec_h264", "jpegenc"}) {
    g_autoptr(GstElementFactory) factory = gst_element_factory_find(needed);
    if (!factory) return g_print("skipped: %s is missing\n", needed);
  }
  const char* wanted = getenv("CERBERUS_FRAMES");
  const int frames = wanted ? std::max(1, atoi(wanted)) : 40;
  const recorder_rig::Folder folder;
  const std::string queue = " t. ! queue max-size-buffers=0 max-size-bytes=0 max-size-time=0 ! ";
  g_autoptr(GstElement) pipeline =
      parsed("eventrecorder name=recorder trigger-track=false file-name=place retention-free=0 location=" +
             folder.path() + " appsrc name=scene format=time caps=" + caps_string("I420", kWide, kHigh) +
             " ! virtualptz name=window lockstep=off wide-fov=60 horizontal-fov=32.2 width=320 height=240 ! "
             "privacymask horizontal-fov=32.2 " +
             masks() + " ! tee name=t" + queue +
             "x264enc tune=zerolatency speed-preset=ultrafast threads=1 ! h264parse ! recorder.video" +
             queue + "motiondetect ! recorder.analysis" + queue + "jpegenc ! jpegdec" + kGrey);
  g_autoptr(GstElement) window = gst_bin_get_by_name(GST_BIN(pipeline), "window");
  g_autoptr(GstElement) scene = gst_bin_get_by_name(GST_BIN(pipeline), "scene");
  g_autoptr(GstElement) recorder = gst_bin_get_by_name(GST_BIN(pipeline), "recorder");
  int uncovered = 0;
  add_probe(window, "sink", turn, window);
  add_probe(window, "src", count_bright, &uncovered);
  const Seen jpeg(pipeline, "end");
  gst_element_set_state(pipeline, GST_STATE_PAUSED);
  g_signal_emit_by_name(recorder, "start-event", "test");
  g_autoptr(GstBuffer) wide = panorama("I420");
  for (int n = 0; n < frames; ++n) {
    g_autoptr(GstBuffer) buffer = gst_buffer_copy(wide);
    GST_BUFFER_PTS(buffer) = n * 40 * GST_MSECOND;
    GstFlowReturn flow = GST_FLOW_OK;
    g_signal_emit_by_name(scene, "push-buffer", buffer, &flow);
    fail_unless_equals_int(flow, GST_FLOW_OK);
  }
  GstFlowReturn flow = GST_FLOW_OK;
  g_signal_emit_by_name(scene, "end-of-stream", &flow);
  run_to_its_end(pipeline);
  fail_unless(uncovered > 2000 * frames, "the place is in few frames: %d pixels", uncovered);
  fail_unless_equals_int(jpeg.frames, frames);
  fail_unless(jpeg.bright == 0, "the JPEGs show %d pixels", jpeg.bright.load());
  assert_dark(folder.path() + "/place.mp4", "qtdemux ! h264parse ! avdec_h264 max-threads=1", frames);
  assert_dark(folder.path() + "/place.jpg", "jpegdec", 1);
  g_print("%d encoded frames, as many JPEGs and the recording's: none shows the place\n", frames);
}
GST_END_TEST

// A pose that has expired holds for less and less.
GST_START_TEST(a_pose_of_the_past_hides_more_and_one_that_is_missing_all) {
  Harness h = mask("horizontal-fov=30 masks=\"world -3,3 3,3 3,-3 -3,-3\"");
  Bus bus(h.get());
  const GstVideoInfo info = info_of(kCaps);
  int before = 0;
  for (const int late : {0, 10, 20, 500}) {  // milliseconds
    GstBuffer* in = frame(info, 100);
    CerberusPose pose;
    cerberus_pose_init(&pose);
    pose.source = CERBERUS_POSE_MEASURED;
    pose.valid_until = GST_BUFFER_PTS(in) - late * GST_MSECOND;
    cerberus_buffer_set_pose(in, &pose);
    gst_harness_push(h.get(), in);
    GstBuffer* out = gst_harness_pull(h.get());
    const int hidden = count(out, 0, kWall - 20);
    fail_unless(hidden > before, "%d ms late: %d after %d", late, hidden, before);
    before = hidden;
    gst_buffer_unref(out);
  }
  fail_unless_equals_int(before, kWindow * kWindowHigh);
  fail_unless_equals_int(bus.count(GST_MESSAGE_WARNING), 0);

  gst_harness_push(h.get(), frame(info, 101));
  gst_harness_push(h.get(), frame(info, 102));
  for (int n = 0; n < 2; ++n) {
    GstBuffer* out = gst_harness_pull(h.get());
    fail_unless_equals_int(count(out, 0, kWall - 20), kWindow * kWindowHigh);
    gst_buffer_unref(out);
  }
  std::string text;
  fail_unless_equals_int(bus.count(GST_MESSAGE_WARNING, &text), 1);
  fail_unless(text.find("need the head's pose on each frame") != std::string::npos, "%s", text.c_str());
}
GST_END_TEST

// The property is for a lens that does not zoom.
GST_START_TEST(a_zoom_of_which_nothing_is_known_hides_all) {
  Harness h = mask("horizontal-fov=30 masks=\"world -3,3 3,3 3,-3 -3,-3\"");
  Bus bus(h.get());
  for (const double seen : {0.0, -1.0, 30.0}) {
    GstBuffer* in = frame(info_of(kCaps), 100);
    CerberusPose pose;
    cerberus_pose_init(&pose);
    pose.source = CERBERUS_POSE_MEASURED;
    pose.field_of_view = seen;
    cerberus_buffer_set_pose(in, &pose);
    gst_harness_push(h.get(), in);
    GstBuffer* out = gst_harness_pull(h.get());
    const bool all = count(out, 0, kWall - 20) == kWindow * kWindowHigh;
    fail_unless(all == (seen < 0), "%g degrees", seen);
    gst_buffer_unref(out);
  }
  std::string text;
  fail_unless_equals_int(bus.count(GST_MESSAGE_WARNING, &text), 1);
  fail_unless(text.find("zoom-table") != std::string::npos, "%s", text.c_str());
}
GST_END_TEST

// The left half; in squares there is one grey, but not the cover's.
GST_START_TEST(a_part_of_the_picture_is_covered_or_shown_in_squares) {
  for (const bool squares : {false, true}) {
    Harness h = mask(std::string("masks=\"0,0 0.5,0 0.5,1 0,1\" mode=") + (squares ? "pixelate" : "fill"));
    GstBuffer* in = frame(info_of(kCaps));
    gst_buffer_memset(in, 0, 250, 3);
    gst_harness_push(h.get(), in);
    GstBuffer* out = gst_harness_pull(h.get());
    fail_unless_equals_int(count(out, 200, 255), 0);
    const int dark = count(out, 0, kWall - 20);
    // A block more where the polygon's edge touches it.
    fail_unless_equals_int(dark, squares ? 0 : (kWindow / 2 + 8) * kWindowHigh);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

// The inset shows the whole scene, the record the picture as it was.
GST_START_TEST(nothing_else_on_the_frame_shows_the_scene) {
  Harness h = harness(("virtualptz lockstep=off inset=true wide-fov=60 horizontal-fov=32.2 width=320 "
                       "height=240 ! motiondetect "
                       "keep-planes=always ! privacymask horizontal-fov=32.2 " +
                       masks())
                          .c_str());
  gst_harness_set_src_caps_str(h.get(), caps_string("GRAY8", kWide, kHigh).c_str());
  GstBuffer* wide = panorama();
  for (int n = 0; n < 4; ++n) {
    GstBuffer* out = through(h.get(), wide, swing(0, n * 40 * GST_MSECOND), n * 40 * GST_MSECOND);
    fail_unless(gst_buffer_get_video_overlay_composition_meta(out) == nullptr);
    fail_if(cerberus::plugin::record_of(out));
    fail_unless_equals_int(count(out, kHalf, 255), 0);
    gst_buffer_unref(out);
  }
  gst_buffer_unref(wide);
}
GST_END_TEST

GST_START_TEST(pixels_that_are_not_square_hide_all) {
  Harness h = harness("privacymask horizontal-fov=30 masks=\"world -3,3 3,3 3,-3 -3,-3\"");
  Bus bus(h.get());
  const std::string caps = std::string(kCaps) + ",pixel-aspect-ratio=12/11";
  gst_harness_set_src_caps_str(h.get(), caps.c_str());
  GstBuffer* in = frame(info_of(caps));
  const CerberusPose pose = swing(0, 0);
  cerberus_buffer_set_pose(in, &pose);
  gst_harness_push(h.get(), in);
  GstBuffer* out = gst_harness_pull(h.get());
  fail_unless_equals_int(count(out, 0, kWall - 20), kWindow * kWindowHigh);
  gst_buffer_unref(out);
  fail_unless_equals_int(bus.count(GST_MESSAGE_WARNING), 1);
}
GST_END_TEST

GST_START_TEST(masks_that_cannot_be_read_let_nothing_pass) {
  Harness h(gst_harness_new("privacymask"));
  Bus bus(h.get());
  gst_harness_set_src_caps_str(h.get(), kCaps);
  g_object_set(h.get()->element, "masks", "0,0 1,0", nullptr);
  fail_unless_equals_int(gst_harness_push(h.get(), frame(info_of(kCaps))), GST_FLOW_ERROR);
  std::string text;
  fail_unless_equals_int(bus.count(GST_MESSAGE_ERROR, &text), 1);
  fail_unless(text.find("masks: \"0,0 1,0\" has 2 corners") == 0, "%s", text.c_str());
}
GST_END_TEST

GST_START_TEST(a_frame_that_cannot_be_covered_is_left_out) {
  Harness h = mask("masks=\"0,0 1,0 1,1 0,1\"");
  Bus bus(h.get());
  gst_harness_push(h.get(), gst_buffer_new_allocate(nullptr, 100, nullptr));
  fail_unless_equals_int(gst_harness_buffers_in_queue(h.get()), 0);
  fail_unless_equals_int(bus.count(GST_MESSAGE_WARNING), 1);
}
GST_END_TEST

static Suite* privacymask_suite() {
  watch_library_log();
  Suite* suite = suite_create("privacymask");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, getenv("CERBERUS_FRAMES") ? 300 : 60);
  tcase_add_test(tests, no_pixel_of_the_place_is_seen_in_a_thousand_frames_and_little_else_is_hidden);
  tcase_add_test(tests, no_encoded_frame_or_picture_shows_the_place);
  tcase_add_test(tests, a_pose_of_the_past_hides_more_and_one_that_is_missing_all);
  tcase_add_test(tests, a_zoom_of_which_nothing_is_known_hides_all);
  tcase_add_test(tests, a_part_of_the_picture_is_covered_or_shown_in_squares);
  tcase_add_test(tests, nothing_else_on_the_frame_shows_the_scene);
  tcase_add_test(tests, pixels_that_are_not_square_hide_all);
  tcase_add_test(tests, masks_that_cannot_be_read_let_nothing_pass);
  tcase_add_test(tests, a_frame_that_cannot_be_covered_is_left_out);
  return suite;
}

GST_CHECK_MAIN(privacymask)
