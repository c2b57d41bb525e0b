// SPDX-License-Identifier: LGPL-2.1-or-later
// The bin of all stages: presets, properties, messages.
#include <map>
#include <string>
#include <vector>

#include "scene.h"
#include "support.h"

namespace {

using scene::Line;
using scene::Regions;
using scene::World;

// nullptr: there is none.
GstMessage* next_motion(GstBus* bus) {
  GstMessage* message = nullptr;
  while ((message = gst_bus_pop_filtered(bus, GST_MESSAGE_ELEMENT)) && !cerberus_message_is_motion(message))
    gst_message_unref(message);
  return message;
}

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
  GstMessage* message = next_motion(line.bus);
  g_autoptr(CerberusMotion) begin = cerberus_message_parse_motion(message);
  fail_unless(begin && begin->state == CERBERUS_MOTION_STARTED);
  fail_unless_equals_uint64(running_time_of(message), from * scene::kStep);
  fail_unless_equals_int(begin->regions->len, 1);
  const guint id = static_cast<CerberusRegion*>(g_ptr_array_index(begin->regions, 0))->id;
  gst_message_unref(message);
  message = next_motion(line.bus);
  g_autoptr(CerberusMotion) end = cerberus_message_parse_motion(message);
  fail_unless(end && end->state == CERBERUS_MOTION_ENDED);
  fail_unless_equals_uint64(running_time_of(message), (until + 10) * scene::kStep);
  // the same identity, where it was last seen
  fail_unless_equals_int(end->regions->len, 1);
  const auto* gone = static_cast<CerberusRegion*>(g_ptr_array_index(end->regions, 0));
  fail_unless_equals_int(gone->id, id);
  fail_unless(scene::overlaps_figure(*gone, world, until));
  gst_message_unref(message);
  fail_unless(next_motion(line.bus) == nullptr);
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

GST_START_TEST(a_property_that_was_set_wins_over_the_preset_in_any_order) {
  gint weighting = -1, area = -1, order = 0;
  gboolean memory = TRUE, floor = TRUE;
  GstElement* first = gst_element_factory_make("motiondetect", nullptr);
  gst_util_set_object_arg(G_OBJECT(first), "weighting", "linear");
  gst_util_set_object_arg(G_OBJECT(first), "preset", "paper");
  g_object_get(first, "weighting", &weighting, "area", &area, "memory", &memory, "noise-floor", &floor,
               "order", &order, nullptr);
  fail_unless_equals_int(weighting, 0);
  fail_unless_equals_int(area, 0);
  fail_if(memory || floor);
  gst_util_set_object_arg(G_OBJECT(first), "preset", "default");
  g_object_get(first, "weighting", &weighting, "area", &area, "memory", &memory, nullptr);
  fail_unless_equals_int(weighting, 0);
  fail_unless_equals_int(area, 2);
  fail_unless(memory);

  GstElement* last = gst_element_factory_make("motiondetect", nullptr);
  gst_util_set_object_arg(G_OBJECT(last), "preset", "paper");
  g_object_get(last, "weighting", &weighting, nullptr);
  fail_unless_equals_int(weighting, 1);
  gst_util_set_object_arg(G_OBJECT(last), "weighting", "linear");
  g_object_get(last, "weighting", &weighting, "area", &area, nullptr);
  fail_unless_equals_int(weighting, 0);
  fail_unless_equals_int(area, 0);
  gst_object_unref(first);
  gst_object_unref(last);
}
GST_END_TEST

// A thread that sets a property while another one changes the preset again and again.
GST_START_TEST(a_property_that_another_thread_sets_meanwhile_wins_over_the_preset) {
  for (int round = 0; round < 20; ++round) {
    GstElement* detect = gst_element_factory_make("motiondetect", nullptr);
    const auto set_presets = [](gpointer on) -> gpointer {
      for (int k = 0; k < 200; ++k)
        gst_util_set_object_arg(G_OBJECT(on), "preset", k % 2 ? "default" : "paper");  // both set order=1
      return nullptr;
    };
    GThread* thread = g_thread_new("application", set_presets, detect);
    g_object_set(detect, "order", 3, nullptr);
    g_thread_join(thread);
    gint order = 0;
    g_object_get(detect, "order", &order, nullptr);
    fail_unless_equals_int(order, 3);
    gst_object_unref(detect);
  }
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

GST_START_TEST(every_preset_works_and_properties_read_back) {
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
  gdouble fov = 0, height = 0;
  gint closing = 0;
  g_object_get(detect, "horizontal-fov", &fov, "mounting-height", &height, "closing", &closing, nullptr);
  fail_unless(fov == 61.5 && height == 2.5 && closing == 7);
  gst_object_unref(detect);
}
GST_END_TEST

// One mask a frame, row by row.
using Mask = std::vector<guint8>;
std::vector<Mask> masks_of(const std::string& launch) {
  std::vector<Mask> masks;
  Line line(launch + " ! identity");
  line.run(World{}, 0, 30, [&](int, GstBuffer* out) {
    const cerberus::vision::Record record = records::record_of(out);
    const cerberus::vision::GrayView view = record->mask();
    Mask& mask = masks.emplace_back();
    for (int y = 0; y < view.height; ++y) mask.insert(mask.end(), view.row(y), view.row(y) + view.width);
  });
  return masks;
}

// With the defaults beside it, which include the memory of the scene: that has no leading part.
GST_START_TEST(area_chooses_among_the_sets_of_the_differences) {
  const std::string detect = "motiondetect keep-planes=always";
  const auto all = masks_of(detect), leading = masks_of(detect + " area=leading"),
             common = masks_of(detect + " area=common");
  fail_unless(leading != all && common != all && leading != common);
  fail_unless(leading == masks_of(detect + " area=leading memory=false"));
  fail_unless(common == masks_of(detect + " area=common memory=false"));
  // As fuzzythreshold forms them, before anything is cleaned: D(k) is both, and nothing is in both.
  const std::string sets = "fuzzythreshold noise-floor=false weighting=linear extremes=subset";
  const auto d = masks_of(sets + " memory=false"), m = masks_of(sets + " area=leading"),
             before = masks_of(sets + " area=common");
  long wrong = 0, new_pixels = 0,
       old_pixels = 0;  // counted: an assertion for each pixel costs more than the detection
  for (std::size_t k = 0; k < d.size(); ++k)
    for (std::size_t i = 0; i < d[k].size(); ++i) {
      wrong += d[k][i] != (m[k][i] | before[k][i]) || (m[k][i] & before[k][i]) != 0;
      new_pixels += m[k][i] != 0;
      old_pixels += before[k][i] != 0;
    }
  fail_unless_equals_int(wrong, 0);
  fail_unless(new_pixels > 0 && old_pixels > 0);
}
GST_END_TEST

// Every property of every stage is a property of motiondetect, with the same default. Where stages share a property
// and each documents its own use of it, motiondetect has the text of one of them.
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

Suite* detect_bin_suite() {
  Suite* suite = suite_create("detect_bin");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 300);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_test(tests, motion_starts_once_and_ends_after_hold_time);
  tcase_add_test(tests, motion_ends_with_the_stream_and_with_the_element_but_once);
  tcase_add_test(tests, an_empty_scene_posts_nothing);
  tcase_add_test(tests, a_property_that_was_set_wins_over_the_preset_in_any_order);
  tcase_add_test(tests, a_property_that_another_thread_sets_meanwhile_wins_over_the_preset);
  tcase_add_test(tests, the_human_gate_is_off_in_preset_traffic);
  tcase_add_test(tests, every_preset_works_and_properties_read_back);
  tcase_add_test(tests, area_chooses_among_the_sets_of_the_differences);
  tcase_add_test(tests, the_bin_has_every_property_of_its_stages);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(detect_bin);
