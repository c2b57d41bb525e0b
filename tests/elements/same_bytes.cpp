// SPDX-License-Identifier: LGPL-2.1-or-later
// motiondetect and the five elements that it stands for give the same bytes over a real sequence, which the
// environment's CERBERUS_SEQUENCE selects: `vtest` or `tennis`. Where it is missing the test is skipped with a
// message.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "support.h"
#include "support/data.h"

namespace {

constexpr char kChain[] = "cameramotion ! threeframediff ! fuzzythreshold ! motionregions ! motiontrack";

// Everything a launch line writes into a file descriptor's place: its SHA-1, or nothing when it fails.
std::string digest(const std::string& launch) {
  GError* error = nullptr;
  GstElement* pipeline =
      gst_parse_launch((launch + " ! fakesink name=sink signal-handoffs=true").c_str(), &error);
  fail_unless(pipeline && !error, "%s", error ? error->message : "");
  GstElement* sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  GChecksum* sum = g_checksum_new(G_CHECKSUM_SHA1);
  g_signal_connect(sink, "handoff", G_CALLBACK(+[](GstElement*, GstBuffer* buffer, GstPad*, GChecksum* to) {
                     GstMapInfo map;
                     fail_unless(gst_buffer_map(buffer, &map, GST_MAP_READ));
                     g_checksum_update(to, map.data, map.size);
                     gst_buffer_unmap(buffer, &map);
                   }),
                   sum);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  GstBus* bus = gst_element_get_bus(pipeline);
  GstMessage* message = gst_bus_timed_pop_filtered(
      bus, 100 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  fail_unless(message && GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS, "%s", launch.c_str());
  gst_message_unref(message);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  std::string text = g_checksum_get_string(sum);
  g_checksum_free(sum);
  gst_object_unref(bus);
  gst_object_unref(sink);
  gst_object_unref(pipeline);
  return text;
}

// What decodes the sequence, or nothing where it is missing.
std::string sequence(const std::string& name) {
  if (name == "vtest") return cerberus::tests::vtest_source().value_or("");
  const auto data = cerberus::tests::data_folder();
  if (!data || !std::filesystem::exists(*data / "davis_tennis/frames/00000.jpg")) return {};
  return "multifilesrc location=\"" + (*data / "davis_tennis/frames/%05d.jpg").string() +
         "\" caps=image/jpeg,framerate=24/1 ! jpegdec";
}

std::string asked_for() {
  const char* name = std::getenv("CERBERUS_SEQUENCE");
  return name ? name : "vtest";
}

GST_START_TEST(the_bin_and_the_chain_give_the_same_bytes) {
  static const char* const outputs[] = {"motionjson", "motionview stage=mask"};
  const std::string source = sequence(asked_for()), output = std::string(" ! ") + outputs[__i__];
  const std::string bin = digest(source + " ! motiondetect" + output);
  const std::string chain = digest(source + " ! " + kChain + output);
  ck_assert_str_eq(bin.c_str(), chain.c_str());
  // A digest that could not differ would prove nothing.
  const std::string other = digest(source + " ! motiondetect preset=paper" + output);
  fail_unless(other != bin);
}
GST_END_TEST

Suite* same_bytes_suite() {
  Suite* suite = suite_create("same bytes");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 300);
  tcase_add_loop_test(tests, the_bin_and_the_chain_give_the_same_bytes, 0, 2);
  return suite;
}

}  // namespace

int main(int argc, char** argv) {
  if (sequence(asked_for()).empty()) {
    std::printf("skipped: %s\n",
                asked_for() == "vtest" ? cerberus::tests::kNoVtest : cerberus::tests::kNoData);
    return 77;
  }
  gst_check_init(&argc, &argv);
  return gst_check_run_suite(same_bytes_suite(), "same_bytes", __FILE__);
}
