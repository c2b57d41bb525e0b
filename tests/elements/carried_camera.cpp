// SPDX-License-Identifier: LGPL-2.1-or-later
// A camera that is carried round a kitchen without people (real video; skipped with a message where it is missing): ghosts of
// parallax are not published, and one message says so.
#include <cstdio>
#include <filesystem>
#include <set>
#include <string>

#include <cerberus/cerberus.h>

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

// What the elements find on the sequence; `named`: a word of the messages that count.
Seen run(const std::filesystem::path& frames, const std::string& elements, const char* named) {
  const std::string launch = "multifilesrc location=\"" + (frames / "%05d.jpg").string() +
                             "\" caps=image/jpeg,framerate=30/1 ! jpegdec ! " + elements +
                             " ! fakesink name=sink signal-handoffs=true";
  GError* error = nullptr;
  GstElement* pipeline = gst_parse_launch(launch.c_str(), &error);
  fail_unless(pipeline && !error, "%s", error ? error->message : "");
  GstElement* sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  Seen seen;
  g_signal_connect(sink, "handoff", G_CALLBACK(count_tracks), &seen);
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
      seen.messages += std::string(info->message).find(named) != std::string::npos;
      g_error_free(info);
    }
    gst_message_unref(message);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(bus);
  gst_object_unref(sink);
  gst_object_unref(pipeline);
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

Suite* carried_camera_suite() {
  Suite* suite = suite_create("carried_camera");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 100);
  tcase_add_test(tests, ghosts_of_parallax_are_left_out_and_one_message_says_why);
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
