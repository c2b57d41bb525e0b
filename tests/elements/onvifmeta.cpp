// SPDX-License-Identifier: LGPL-2.1-or-later
// What frames carry as ONVIF documents, and documents as RTP packets. Packets are read after RFC 3550, by hand.
#include <string>

#include "outputs.h"

using namespace outputs;

namespace {

const std::string kCaps = caps_string("I420", 64, 48);

std::string text_of(GstBuffer* buffer) {
  const auto all = bytes(buffer);
  return {all.begin(), all.end()};
}

// Not live: a document of a live stream carries the clock's time.
Harness started(const char* line) {
  Harness h = harness(line);
  gst_harness_set_live(h.get(), FALSE);
  gst_harness_set_src_caps_str(h.get(), kCaps.c_str());
  return h;
}

std::string document_of(GstHarness* h, GstBuffer* in) {
  fail_unless_equals_int(gst_harness_push(h, in), GST_FLOW_OK);
  GstBuffer* out = gst_harness_pull(h);
  const std::string text = text_of(out);
  gst_buffer_unref(out);
  return text;
}

bool holds(const std::string& text, const char* what) {
  return text.find(what) != std::string::npos;
}

GstBuffer* frame_with_everything() {
  GstBuffer* buffer = frame(info_of(kCaps), 3);
  CerberusRegion walker = region(4, 16, 12, 32, 24);
  walker.kind = CERBERUS_REGION_KIND_PERSON_LIKE;
  walker.confidence = 0.5;
  add(buffer, walker);
  CerberusRegion person = region(5, 0, 0, 8, 9);
  person.person = TRUE;
  person.state = CERBERUS_REGION_STOPPED;
  add(buffer, person);
  CerberusPose pose;
  cerberus_pose_init(&pose);
  pose.pan = -12.5, pose.tilt = 3;
  cerberus_buffer_set_pose(buffer, &pose);
  CerberusFusion fusion;
  cerberus_fusion_init(&fusion);
  fusion.n_sensors = 3;
  fusion.sensors[1] = 1, fusion.sensors[2] = 2;
  cerberus_buffer_set_fusion(buffer, &fusion);
  return buffer;
}

}  // namespace

GST_START_TEST(what_a_frame_carries_is_in_its_document) {
  Harness h = started("onvifmeta horizontal-fov=60");
  const std::string text = document_of(h.get(), frame_with_everything());
  for (const char* part :
       {"<tt:Frame UtcTime=\"1970-01-01T00:00:00.120000Z\">", "<tt:PanTilt x=\"-12.5\" y=\"3\" ", ">IDLE<",
        "<tt:FieldOfView hfov=\"60\" ", "<tt:Object ObjectId=\"4\">",
        "<tt:BoundingBox left=\"-0.5\" top=\"0.5\" right=\"0.5\" bottom=\"-0.5\"/>",
        "<tt:Type Likelihood=\"0.5\">person-like</tt:Type>", "<tt:Object ObjectId=\"5\">", ">Human</tt:Type>",
        "<tt:Idle/>", "SensorID=\"pir_0\"><tt:Type>PIR</tt:Type><tt:Value>0<",
        "SensorID=\"pir_1\"><tt:Type>PIR</tt:Type><tt:Value>1<"})
    fail_unless(holds(text, part), "%s is not in %s", part, text.c_str());
  fail_if(holds(text, "pir_2"));
}
GST_END_TEST

GST_START_TEST(the_zoom_of_the_head_beats_the_property) {
  Harness h = started("onvifmeta horizontal-fov=60");
  GstBuffer* buffer = frame(info_of(kCaps));
  CerberusPose pose;
  cerberus_pose_init(&pose);
  pose.field_of_view = 10;
  cerberus_buffer_set_pose(buffer, &pose);
  fail_unless(holds(document_of(h.get(), buffer), "hfov=\"10\""));
  fail_if(holds(document_of(h.get(), frame(info_of(kCaps))), "hfov"));
}
GST_END_TEST

GST_START_TEST(nothing_found_is_a_frame_and_no_detector_is_none) {
  Harness h = started("onvifmeta");
  fail_if(holds(document_of(h.get(), frame(info_of(kCaps))), "Frame"));
  GstBuffer* buffer = frame(info_of(kCaps));
  g_autoptr(GPtrArray) none = g_ptr_array_new();
  fail_unless(cerberus_buffer_set_regions(buffer, none));
  fail_unless(holds(document_of(h.get(), buffer), "></tt:Frame>"));
}
GST_END_TEST

// RFC 3550: 12 bytes of header, version 2, the marker in the second byte's top bit, time stamp in bytes 4 to 7.
GST_START_TEST(a_document_is_cut_into_packets_and_the_last_one_is_marked) {
  Harness meta = started("onvifmeta");
  Harness h = harness("rtponvifmetapay mtu=200 timestamp-offset=1000 seqnum-offset=7");
  gst_harness_set_src_caps_str(h.get(), "application/x-onvif-metadata");
  for (int n = 0; n < 2; ++n) {
    fail_unless_equals_int(gst_harness_push(meta.get(), frame_with_everything()), GST_FLOW_OK);
    GstBuffer* document = gst_harness_pull(meta.get());
    GST_BUFFER_PTS(document) = n * GST_SECOND;
    const std::string text = text_of(document);
    fail_unless_equals_int(gst_harness_push(h.get(), document), GST_FLOW_OK);
    const guint packets = gst_harness_buffers_in_queue(h.get());
    fail_unless_equals_int(packets, (text.size() + 187) / 188);
    std::string joined;
    for (guint i = 0; i < packets; ++i) {
      GstBuffer* packet = gst_harness_pull(h.get());
      const auto data = bytes(packet);
      fail_unless(data.size() > 12 && data.size() <= 200);
      fail_unless_equals_int(data[0], 0x80);
      fail_unless_equals_int(data[1] >> 7, i + 1 == packets);
      const guint stamp = GST_READ_UINT32_BE(data.data() + 4);
      fail_unless_equals_int(stamp, 1000 + 90000u * n);
      joined.append(data.begin() + 12, data.end());
      gst_buffer_unref(packet);
    }
    expect(joined, text);
  }
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(h.get()->sinkpad);
  const GstStructure* structure = gst_caps_get_structure(caps, 0);
  fail_unless_equals_string(gst_structure_get_string(structure, "media"), "application");
  fail_unless_equals_string(gst_structure_get_string(structure, "encoding-name"), "VND.ONVIF.METADATA");
}
GST_END_TEST

static Suite* onvifmeta_suite() {
  watch_library_log();
  Suite* suite = suite_create("onvifmeta");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, what_a_frame_carries_is_in_its_document);
  tcase_add_test(tests, the_zoom_of_the_head_beats_the_property);
  tcase_add_test(tests, nothing_found_is_a_frame_and_no_detector_is_none);
  tcase_add_test(tests, a_document_is_cut_into_packets_and_the_last_one_is_marked);
  return suite;
}

GST_CHECK_MAIN(onvifmeta)
