// SPDX-License-Identifier: LGPL-2.1-or-later
// PIR readings in volts (format=level): pirsrc outputs them on request, pirfusion compares them with a threshold.
#include <limits>
#include <random>

#include "fusion_rig.h"

#include "../support/pir_source.h"

namespace {

using namespace rig;
using Volts = std::vector<float>;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr char kLevels[] = "application/x-pir,format=level,sensors=2,bearings=<0.0,90.0>,field-of-view=90.0";
constexpr char kTwo[] = "pirsrc name=source bearings=0,90 heartbeat=3600000000000 ";

class Source : public PirSource {
 public:
  using PirSource::PirSource;

  CerberusPirFormat format() const {
    g_autoptr(GstCaps) caps = gst_pad_get_current_caps(harness()->sinkpad);
    CerberusPirInfo info;
    fail_unless(caps && cerberus_pir_info_from_caps(&info, caps, nullptr));
    return info.format;
  }
  // The next buffer as volts, "0.500: 0.1 3.2".
  std::string volts() {
    g_autoptr(GstBuffer) buffer = take();
    float values[CERBERUS_PIR_MAX_SENSORS];
    const gsize size = gst_buffer_extract(buffer, 0, values, sizeof values);
    fail_unless_equals_int(size % sizeof(float), 0);
    gchar number[G_ASCII_DTOSTR_BUF_SIZE];
    const double time = static_cast<double>(GST_BUFFER_PTS(buffer)) / GST_SECOND;
    std::string result = std::string(g_ascii_formatd(number, sizeof number, "%.3f", time)) + ":";
    for (gsize i = 0; i < size / sizeof(float); ++i)
      result += std::string(" ") +
                (std::isnan(values[i]) ? "nan" : g_ascii_formatd(number, sizeof number, "%g", values[i]));
    return result;
  }
  std::string presence() {
    g_autoptr(GstBuffer) buffer = take();
    guint8 values[CERBERUS_PIR_MAX_SENSORS];
    return text(Bytes(values, values + gst_buffer_extract(buffer, 0, values, sizeof values)));
  }
};

GstBuffer* volts(GstClockTime time, const Volts& values) {
  GstBuffer* buffer = gst_buffer_new_memdup(values.data(), values.size() * sizeof(float));
  GST_BUFFER_PTS(buffer) = time;
  return buffer;
}

// The sensor states that pirfusion derives when two of them read `values`.
std::string after(Rig& rig, GstClockTime time, const Volts& values) {
  fail_unless_equals_int(gst_harness_push(rig.pir[0], volts(time, values)), GST_FLOW_OK);
  return text(sensors(rig.at(time)));
}

// The sensor states on each frame of a pipeline that is not live, as attached by pirfusion.
std::string fused(const std::string& script, const std::string& filter) {
  const std::string line =
      "videotestsrc num-buffers=120 ! video/x-raw,format=GRAY8,width=16,height=16,framerate=30/1 ! "
      "pirfusion name=fusion ! fakesink name=sink "
      "pirsrc bearings=0,90 script=\"" +
      script + "\" ! " + filter + "queue ! fusion.pir_0";
  g_autoptr(GstElement) pipeline = gst_parse_launch(line.c_str(), nullptr);
  fail_unless(pipeline, "%s", line.c_str());
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(sink, "sink");
  std::string readings;
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad*, GstPadProbeInfo* info, gpointer readings) {
        const CerberusFusion* fusion = cerberus_buffer_peek_fusion(GST_PAD_PROBE_INFO_BUFFER(info));
        *static_cast<std::string*>(readings) += (fusion ? text(sensors(*fusion)) : "none") + " ";
        return GST_PAD_PROBE_OK;
      },
      &readings, nullptr);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  g_autoptr(GstMessage) end = gst_bus_timed_pop_filtered(
      bus, GST_CLOCK_TIME_NONE, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  fail_unless_equals_int(GST_MESSAGE_TYPE(end), GST_MESSAGE_EOS);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  return readings;
}

}  // namespace

GST_START_TEST(a_consumer_of_volts_receives_every_sample) {
  Source source(std::string(kTwo) + "script=\"0.5,0.1V,3.2V; 1,0.1V,3.25V; 1.5,0.2V,0V; 2,-1V,0V\"",
                "application/x-pir,format=level");
  source.play();
  assert_says(source.volts(), "0.000: nan nan");
  assert_says(source.volts(), "0.500: 0.1 3.2");
  assert_says(source.volts(), "1.000: 0.1 3.25");
  assert_says(source.volts(), "1.500: 0.2 0");
  assert_says(source.volts(), "1.520: 0.2 0");  // the detection ends
  assert_says(source.volts(), "2.000: -1 0");
  fail_unless_equals_int(source.format(), CERBERUS_PIR_LEVEL);
  // The messages contain presence in any case.
  std::string readings;
  while (GstMessage* message = source.pop(GST_MESSAGE_ELEMENT)) {
    g_autoptr(CerberusPir) pir = cerberus_message_parse_pir(message);
    readings += text(Bytes(pir->sensors, pir->sensors + pir->n_sensors)) + " ";
    gst_message_unref(message);
  }
  assert_says(readings, "22 01 00 ");
}
GST_END_TEST

GST_START_TEST(a_consumer_of_both_formats_receives_presence) {
  const std::string line = std::string(kTwo) + "threshold=2 hysteresis=1 script=\"0,0V,2.4V; 1,2.5V,2.4V\"";
  for (const char* caps : {"ANY", "application/x-pir", "application/x-pir,format={level,presence}"}) {
    Source source(line, caps);
    source.play();
    assert_says(source.presence(), "00");
    assert_says(source.presence(), "10");
    fail_unless_equals_int(source.format(), CERBERUS_PIR_PRESENCE);
  }
}
GST_END_TEST

GST_START_TEST(the_format_may_change_while_it_plays) {
  Source source(
      std::string(kTwo) +
          "min-pulse=0 is-live=true script=\"0,0V,3V; 0.01,3V,3V; 0.02,1V,3V\" ! capsfilter name=filter "
          "caps=application/x-pir,format=presence caps-change-mode=delayed",
      nullptr);
  source.play();
  assert_says(source.presence(), "01");
  gst_util_set_object_arg(G_OBJECT(source.child("filter")), "caps", "application/x-pir,format=level");
  gst_harness_set_time(source.harness(), 10 * kMs);
  gst_buffer_unref(gst_harness_pull(source.harness()));  // it may have been on its way: in either format
  gst_harness_set_time(source.harness(), 20 * kMs);
  assert_says(source.volts(), "0.020: 1 3");
  fail_unless_equals_int(source.format(), CERBERUS_PIR_LEVEL);
}
GST_END_TEST

GST_START_TEST(volts_that_no_driver_measures_are_refused_with_a_reason) {
  Source source(std::string(kTwo) + "script=\"0,0,1\"", "application/x-pir,format=level");
  const std::string why = source.refusal(GST_CORE_ERROR, GST_CORE_ERROR_NEGOTIATION);
  for (const char* what : {"format=(string)level", "format=(string)presence", "driver=iio"})
    fail_unless(says(why, what));
  // And it can be put right.
  g_object_set(source.child("source"), "script", "0,0V,3V", nullptr);
  source.play();
  assert_says(source.volts(), "0.000: 0 3");
}
GST_END_TEST

GST_START_TEST(volts_are_compared_with_the_threshold_of_pirfusion) {
  {
    Rig rig;
    rig.add_pir(kLevels);
    assert_says(after(rig, 0, {1.79F, 1.81F}), "01");  // 1.65 V and half of 0.3 V
    assert_says(after(rig, 100 * kMs, {1.81F, 1.51F}), "01");
    assert_says(after(rig, 110 * kMs, {1.81F, 1.51F}), "11");  // a pulse must last for 10 ms
    assert_says(after(rig, 200 * kMs, {1.81F, 1.49F}), "11");  // a fall must be quiet for 20 ms
    assert_says(text(sensors(rig.at(210 * kMs))), "11");
    assert_says(after(rig, 300 * kMs, {1.81F, 1.49F}), "10");
    assert_says(text(sensors(rig.at(400 * kMs))), "10");
  }
  Rig rig(true, "level-threshold=-0.5 level-hysteresis=0");
  rig.add_pir(kLevels);
  assert_says(after(rig, 0, {-0.4F, -0.6F}), "10");
}
GST_END_TEST

// Between two samples a deadline passes: the frame of that moment sees it.
GST_START_TEST(what_becomes_of_a_sensor_between_samples_has_its_own_time) {
  Rig rig(false);
  rig.add_pir(kLevels, "pir_%u", false);
  for (const auto& [time, level] : {std::pair{0, 3.0F}, {100, 0.0F}, {1000, 0.0F}})
    fail_unless_equals_int(gst_harness_push(rig.pir[0], volts(time * kMs, {level, 0})), GST_FLOW_OK);
  assert_says(text(sensors(rig.at(119 * kMs))), "10");
  assert_says(text(sensors(rig.at(120 * kMs))), "00");
}
GST_END_TEST

GST_START_TEST(what_is_no_measurement_is_invalid) {
  Rig rig;
  rig.add_pir(kLevels);
  assert_says(text(sensors(rig.at(0))), "22");
  assert_says(after(rig, 40 * kMs, {3, kNaN}), "12");
  fail_unless(rig.warning().empty());
  assert_says(after(rig, 80 * kMs, {3, 3, 3}), "22");  // of another size
  const std::string warning = rig.warning();
  fail_unless(warning.find("pir_0") != std::string::npos &&
                  warning.find("12 bytes for 2 sensors") != std::string::npos,
              "%s", warning.c_str());
  assert_says(after(rig, 120 * kMs, {3, 0}), "10");
  // A flush is a new beginning.
  gst_harness_push_event(rig.pir[0], gst_event_new_flush_start());
  gst_harness_push_event(rig.pir[0], gst_event_new_flush_stop(TRUE));
  assert_says(text(sensors(rig.at(160 * kMs))), "22");
  push_segment(rig.pir[0]);
  assert_says(after(rig, 200 * kMs, {1.6F, 3}),
              "01");  // not as before: between the thresholds, it begins low
}
GST_END_TEST

GST_START_TEST(a_sensor_in_volts_that_is_stuck_is_named_and_so_is_its_recovery) {
  Rig rig;
  rig.add_pir(kLevels);
  // A frame more than 10 s after the one before would be taken for one with a wrong time.
  for (GstClockTime seconds = 0; seconds < 600; seconds += 5)
    assert_says(after(rig, seconds * GST_SECOND, {0, 3}), "01");
  assert_says(after(rig, 601 * GST_SECOND, {0, 3}), "02");
  const std::string warning = rig.warning();
  for (const char* what : {"infer2 (pad pir_0, bearing 90) is stuck on", "level-threshold"})
    fail_unless(warning.find(what) != std::string::npos, "%s", warning.c_str());
  fail_unless(rig.warning().empty(), "said once");
  after(rig, 602 * GST_SECOND, {0, 0});
  assert_says(after(rig, 603 * GST_SECOND, {0, 0}), "00");
  g_autoptr(GstMessage) info = gst_bus_pop_filtered(rig.bus, GST_MESSAGE_INFO);
  fail_unless(info, "nothing of the recovery");
  fail_unless(rig.warning().empty());
}
GST_END_TEST

// There is one model: the decision is the same in pirsrc and in pirfusion.
GST_START_TEST(volts_say_the_same_whether_pirsrc_compares_them_or_pirfusion) {
  std::mt19937 random(11);
  std::string script;
  int time = 0;
  for (int i = 0; i < 250; ++i, time += 5 + static_cast<int>(random() % 25)) {
    gchar* line = g_strdup_printf("%s%d.%03d,%u.%02uV,%u.%02uV", i ? "; " : "", time / 1000, time % 1000,
                                  unsigned(random() % 3), unsigned(random() % 100), unsigned(random() % 3),
                                  unsigned(random() % 100));
    script += line;
    g_free(line);
  }
  const std::string here = fused(script, ""), there = fused(script, "application/x-pir,format=level ! ");
  fail_unless(here == there, "presence: %s\nlevel: %s", here.c_str(), there.c_str());
  for (const char* each : {"00", "01", "10", "11"})
    fail_unless(here.find(each) != std::string::npos, "%s", each);
}
GST_END_TEST

static Suite* pir_levels_suite() {
  watch_library_log();
  Suite* s = suite_create("pir_levels");
  TCase* tc = tcase_create("pir_levels");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, a_consumer_of_volts_receives_every_sample);
  tcase_add_test(tc, a_consumer_of_both_formats_receives_presence);
  tcase_add_test(tc, the_format_may_change_while_it_plays);
  tcase_add_test(tc, volts_that_no_driver_measures_are_refused_with_a_reason);
  tcase_add_test(tc, volts_are_compared_with_the_threshold_of_pirfusion);
  tcase_add_test(tc, what_becomes_of_a_sensor_between_samples_has_its_own_time);
  tcase_add_test(tc, what_is_no_measurement_is_invalid);
  tcase_add_test(tc, a_sensor_in_volts_that_is_stuck_is_named_and_so_is_its_recovery);
  tcase_add_test(tc, volts_say_the_same_whether_pirsrc_compares_them_or_pirfusion);
  return s;
}

GST_CHECK_MAIN(pir_levels)
