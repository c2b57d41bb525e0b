// SPDX-License-Identifier: LGPL-2.1-or-later
// A camera that is carried round a kitchen without people (real video; skipped with a message where it is missing): ghosts of
// parallax are not published, and one message says so.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string>

#include <cerberus/cerberus.h>
#include <gst/video/video.h>

#include "support.h"
#include "support/data.h"

namespace {

struct Seen {
  std::set<guint> identities;
  int messages = 0;
};

void count_tracks(GstElement*, GstBuffer* buffer, GstPad*, Seen* seen) {
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(buffer);
  for (guint i = 0; regions && i < regions->len; ++i)
    seen->identities.insert(static_cast<CerberusRegion*>(g_ptr_array_index(regions, i))->id);
}

// The calm of a frame, and of one that repeats it.
struct Calm {
  double least = 1, last = 1;
  int repeats = 0, changed = 0;
};

void compare_calm(GstElement*, GstBuffer* buffer, GstPad*, Calm* calm) {
  const CerberusCameraMotion* motion = cerberus_buffer_peek_camera_motion(buffer);
  fail_unless(motion != nullptr);
  if (GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_GAP)) {
    ++calm->repeats;
    calm->changed += motion->calm != calm->last;
  }
  calm->last = motion->calm;
  calm->least = std::min(calm->least, motion->calm);
}

// The detector of `identity name=detector` finds somebody twice a second.
void find_person(GstElement*, GstBuffer* buffer, gpointer) {
  if (GST_BUFFER_PTS(buffer) / (GST_SECOND / 30) % 15 == 0)
    gst_buffer_add_video_region_of_interest_meta(buffer, "person", 100, 40, 60, 150);
}

// Plays the sequence through the elements and calls `look` for each frame that comes out. Returns how many info messages
// have the word `named`.
template <typename Result>
int play(const std::filesystem::path& frames, const std::string& elements, const char* named,
         void (*look)(GstElement*, GstBuffer*, GstPad*, Result*), Result& result) {
  const std::string launch = "multifilesrc location=\"" + (frames / "%05d.jpg").string() +
                             "\" caps=image/jpeg,framerate=30/1 ! jpegdec ! " + elements +
                             " ! fakesink name=sink signal-handoffs=true";
  GError* error = nullptr;
  GstElement* pipeline = gst_parse_launch(launch.c_str(), &error);
  fail_unless(pipeline && !error, "%s", error ? error->message : "");
  GstElement* sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  if (g_autoptr(GstElement) detector = gst_bin_get_by_name(GST_BIN(pipeline), "detector"); detector)
    g_signal_connect(detector, "handoff", G_CALLBACK(find_person), nullptr);
  int messages = 0;
  g_signal_connect(sink, "handoff", G_CALLBACK(look), &result);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  GstBus* bus = gst_element_get_bus(pipeline);
  for (bool runs = true; runs;) {
    GstMessage* message = gst_bus_timed_pop_filtered(
        bus, 100 * GST_SECOND,
        static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR | GST_MESSAGE_INFO));
    fail_unless(message && GST_MESSAGE_TYPE(message) != GST_MESSAGE_ERROR, "%s", launch.c_str());
    runs = GST_MESSAGE_TYPE(message) != GST_MESSAGE_EOS;
    if (runs) {
      GError* info = nullptr;
      gst_message_parse_info(message, &info, nullptr);
      messages += std::string(info->message).find(named) != std::string::npos;
      g_error_free(info);
    }
    gst_message_unref(message);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(bus);
  gst_object_unref(sink);
  gst_object_unref(pipeline);
  return messages;
}

Seen run(const std::filesystem::path& frames, const std::string& elements, const char* named) {
  Seen seen;
  seen.messages = play(frames, elements, named, count_tracks, seen);
  return seen;
}

std::filesystem::path frames() {
  const auto data = cerberus::tests::data_folder();
  return data ? *data / "nogt_kitchen_b/frames" : std::filesystem::path();
}

GST_START_TEST(ghosts_of_parallax_are_left_out_and_one_message_says_why) {
  const Seen seen = run(frames(), "motiondetect", "personverify");
  fail_unless(seen.identities.size() <= 4, "%zu identities", seen.identities.size());
  fail_unless_equals_int(seen.messages, 1);
  const Seen chain =
      run(frames(), "cameramotion ! threeframediff ! fuzzythreshold ! motionregions ! motiontrack",
          "personverify");
  fail_unless(chain.identities == seen.identities);
  fail_unless_equals_int(chain.messages, 1);
}
GST_END_TEST

GST_START_TEST(an_element_that_judges_tracks_gets_them_all_without_a_message) {
  if (g_autoptr(GstElementFactory) verify = gst_element_factory_find("personverify"); !verify) return;
  const Seen seen = run(frames(), "motiondetect ! personverify require=person", "personverify");
  fail_unless_equals_int(seen.messages, 0);
}
GST_END_TEST

GST_START_TEST(boxes_of_another_detector_spare_the_message) {
  const Seen seen =
      run(frames(), "identity name=detector signal-handoffs=true ! motiondetect", "personverify");
  fail_unless_equals_int(seen.messages, 0);
}
GST_END_TEST

GST_START_TEST(a_repeated_frame_is_as_calm_as_the_one_that_it_repeats) {
  for (const char* elements :
       {"motiondetect", "cameramotion ! threeframediff ! fuzzythreshold ! motionregions ! motiontrack"}) {
    Calm calm;
    play(frames(), std::string("videorate ! video/x-raw,framerate=60/1 ! ") + elements, "none", compare_calm,
         calm);
    fail_unless(calm.least < 0.8 && calm.repeats > 100, "%g, %d", calm.least, calm.repeats);
    fail_unless_equals_int(calm.changed, 0);
  }
}
GST_END_TEST

Suite* carried_camera_suite() {
  Suite* suite = suite_create("carried_camera");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 100);
  tcase_add_test(tests, ghosts_of_parallax_are_left_out_and_one_message_says_why);
  tcase_add_test(tests, a_repeated_frame_is_as_calm_as_the_one_that_it_repeats);
  tcase_add_test(tests, boxes_of_another_detector_spare_the_message);
  tcase_add_test(tests, an_element_that_judges_tracks_gets_them_all_without_a_message);
  return suite;
}

}  // namespace

int main(int argc, char** argv) {
  if (!std::filesystem::exists(frames())) {
    std::printf("skipped: %s\n", cerberus::tests::kNoData);
    return cerberus::tests::kSkipped;
  }
  gst_check_init(&argc, &argv);
  return gst_check_run_suite(carried_camera_suite(), "carried_camera", __FILE__);
}
