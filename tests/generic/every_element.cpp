// SPDX-License-Identifier: LGPL-2.1-or-later
// What must hold for each element of the project's plugins: the list comes from the registry, so that a new element is
// tested from its first day on.

#include <gst/check/gstcheck.h>
#include <gst/gst.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace {

std::vector<std::string> elements() {
  const char* folder = g_getenv("CERBERUS_PLUGINS");
  fail_unless(folder != nullptr, "CERBERUS_PLUGINS must name the build's plugins folder");
  std::vector<std::string> names;
  GList* features = gst_registry_get_feature_list(gst_registry_get(), GST_TYPE_ELEMENT_FACTORY);
  for (GList* entry = features; entry; entry = entry->next) {
    GstPlugin* plugin = gst_plugin_feature_get_plugin(GST_PLUGIN_FEATURE(entry->data));
    const char* file = plugin ? gst_plugin_get_filename(plugin) : nullptr;
    if (file && g_str_has_prefix(file, folder)) names.push_back(GST_OBJECT_NAME(entry->data));
    gst_clear_object(&plugin);
  }
  gst_plugin_feature_list_free(features);
  fail_if(names.empty(), "no element of the project in %s", folder);
  return names;
}

GstElement* make(const std::string& name) {
  GstElement* element = gst_element_factory_make(name.c_str(), nullptr);
  fail_unless(element != nullptr, "%s cannot be made", name.c_str());
  return element;
}

bool is_own(GType type) {
  return g_str_has_prefix(g_type_name(type), "Cerberus");
}

void for_each_property(GstElement* element, const std::function<void(GParamSpec*)>& visit) {
  guint count = 0;
  GParamSpec** specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(element), &count);
  for (guint k = 0; k < count; ++k)
    if (is_own(specs[k]->owner_type)) visit(specs[k]);
  g_free(specs);
}

// The values worth a try: the ends of the range and the default; every value of an enumeration; odd strings.
std::vector<GValue> values_of(GParamSpec* spec) {
  std::vector<GValue> values;
  auto add = [&](auto set, auto value) {
    GValue item = G_VALUE_INIT;
    g_value_init(&item, spec->value_type);
    set(&item, value);
    values.push_back(item);
  };
  if (G_IS_PARAM_SPEC_BOOLEAN(spec)) {
    for (gboolean value : {gboolean{FALSE}, gboolean{TRUE}}) add(g_value_set_boolean, value);
  } else if (G_IS_PARAM_SPEC_INT(spec)) {
    for (gint value : {G_PARAM_SPEC_INT(spec)->minimum, G_PARAM_SPEC_INT(spec)->maximum})
      add(g_value_set_int, value);
  } else if (G_IS_PARAM_SPEC_UINT(spec)) {
    for (guint value : {G_PARAM_SPEC_UINT(spec)->minimum, G_PARAM_SPEC_UINT(spec)->maximum})
      add(g_value_set_uint, value);
  } else if (G_IS_PARAM_SPEC_INT64(spec)) {
    for (gint64 value : {G_PARAM_SPEC_INT64(spec)->minimum, G_PARAM_SPEC_INT64(spec)->maximum})
      add(g_value_set_int64, value);
  } else if (G_IS_PARAM_SPEC_UINT64(spec)) {
    for (guint64 value : {G_PARAM_SPEC_UINT64(spec)->minimum, G_PARAM_SPEC_UINT64(spec)->maximum})
      add(g_value_set_uint64, value);
  } else if (G_IS_PARAM_SPEC_DOUBLE(spec)) {
    for (gdouble value : {G_PARAM_SPEC_DOUBLE(spec)->minimum, G_PARAM_SPEC_DOUBLE(spec)->maximum})
      add(g_value_set_double, value);
  } else if (G_IS_PARAM_SPEC_FLOAT(spec)) {
    for (gfloat value : {G_PARAM_SPEC_FLOAT(spec)->minimum, G_PARAM_SPEC_FLOAT(spec)->maximum})
      add(g_value_set_float, value);
  } else if (G_IS_PARAM_SPEC_ENUM(spec)) {
    GEnumClass* type = G_PARAM_SPEC_ENUM(spec)->enum_class;
    for (guint k = 0; k < type->n_values; ++k) add(g_value_set_enum, type->values[k].value);
  } else if (G_IS_PARAM_SPEC_STRING(spec)) {
    for (const char* value : {"", "nonsense", "0,0;1"}) add(g_value_set_string, value);
  }
  GValue standard = G_VALUE_INIT;
  g_value_init(&standard, spec->value_type);
  g_param_value_set_default(spec, &standard);
  values.push_back(standard);
  return values;
}

std::string as_text(const GValue& value) {
  gchar* text = g_strdup_value_contents(&value);
  std::string result = text;
  g_free(text);
  return result;
}

GST_START_TEST(an_element_says_what_it_is) {
  for (const auto& name : elements()) {
    GstElementFactory* factory = gst_element_factory_find(name.c_str());
    for (const char* key : {GST_ELEMENT_METADATA_LONGNAME, GST_ELEMENT_METADATA_KLASS,
                            GST_ELEMENT_METADATA_DESCRIPTION, GST_ELEMENT_METADATA_AUTHOR}) {
      const gchar* text = gst_element_factory_get_metadata(factory, key);
      fail_unless(text && *text, "%s has no %s", name.c_str(), key);
    }
    gst_object_unref(factory);
    GstElement* element = make(name);
    for_each_property(element, [&](GParamSpec* spec) {
      const gchar* blurb = g_param_spec_get_blurb(spec);
      fail_unless(blurb && std::string(blurb).size() > 10, "%s::%s does not say what it does", name.c_str(),
                  spec->name);
    });
    gst_object_unref(element);
  }
}
GST_END_TEST

GST_START_TEST(an_element_goes_through_every_state_and_back) {
  for (const auto& name : elements()) {
    GstElement* element = make(name);
    const GstState path[] = {GST_STATE_READY,  GST_STATE_PAUSED,  GST_STATE_PLAYING, GST_STATE_PAUSED,
                             GST_STATE_READY,  GST_STATE_PAUSED,  GST_STATE_READY,   GST_STATE_NULL,
                             GST_STATE_PAUSED, GST_STATE_PLAYING, GST_STATE_NULL,    GST_STATE_READY,
                             GST_STATE_NULL,   GST_STATE_PLAYING, GST_STATE_NULL};
    for (int round = 0; round < 3; ++round)
      for (GstState state : path)
        fail_if(gst_element_set_state(element, state) == GST_STATE_CHANGE_FAILURE, "%s does not reach %s",
                name.c_str(), gst_element_state_get_name(state));
    // The clock's thread lets go of a timer that was taken back when it next wakes.
    for (int i = 0; i < 500 && GST_OBJECT_REFCOUNT_VALUE(element) > 1; ++i) g_usleep(10000);
    ASSERT_OBJECT_REFCOUNT(element, name.c_str(), 1);
    gst_object_unref(element);
  }
}
GST_END_TEST

GST_START_TEST(a_property_gives_back_what_it_was_given) {
  for (const auto& name : elements()) {
    GstElement* element = make(name);
    for_each_property(element, [&](GParamSpec* spec) {
      if (!(spec->flags & G_PARAM_WRITABLE) || !(spec->flags & G_PARAM_READABLE) ||
          (spec->flags & G_PARAM_CONSTRUCT_ONLY))
        return;
      // Strings may be refused where they make no sense; values inside a declared range may not.
      const bool may_refuse = G_IS_PARAM_SPEC_STRING(spec);
      for (GValue& value : values_of(spec)) {
        g_object_set_property(G_OBJECT(element), spec->name, &value);
        GValue back = G_VALUE_INIT;
        g_value_init(&back, spec->value_type);
        g_object_get_property(G_OBJECT(element), spec->name, &back);
        if (!may_refuse)
          fail_unless(g_param_values_cmp(spec, &value, &back) == 0, "%s::%s was set to %s and says %s",
                      name.c_str(), spec->name, as_text(value).c_str(), as_text(back).c_str());
        g_value_unset(&back);
        g_value_unset(&value);
      }
    });
    gst_object_unref(element);
  }
}
GST_END_TEST

GST_START_TEST(a_new_element_has_the_defaults_that_it_declares) {
  for (const auto& name : elements()) {
    GstElement* element = make(name);
    for_each_property(element, [&](GParamSpec* spec) {
      if (!(spec->flags & G_PARAM_WRITABLE) || !(spec->flags & G_PARAM_READABLE) ||
          G_IS_PARAM_SPEC_BOXED(spec) || G_IS_PARAM_SPEC_OBJECT(spec))
        return;
      GValue value = G_VALUE_INIT;
      g_value_init(&value, spec->value_type);
      g_object_get_property(G_OBJECT(element), spec->name, &value);
      fail_unless(g_param_value_defaults(spec, &value),
                  "%s::%s is %s in a new element, not its declared default", name.c_str(), spec->name,
                  as_text(value).c_str());
      g_value_unset(&value);
    });
    gst_object_unref(element);
  }
}
GST_END_TEST

// A running pipeline ends with the stream's end or with an error; anything else is a hang.
void run_to_the_end(const std::string& name, GstElement* pipeline, const std::string& what) {
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  GstBus* bus = gst_element_get_bus(pipeline);
  GstMessage* message = gst_bus_timed_pop_filtered(
      bus, 100 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  fail_unless(message != nullptr, "%s hangs with %s", name.c_str(), what.c_str());
  gst_message_unref(message);
  gst_object_unref(bus);
  gst_element_set_state(pipeline, GST_STATE_NULL);
}

GstElement* pipeline_with(const std::string& name) {
  const std::string line =
      "videotestsrc num-buffers=6 pattern=ball ! video/x-raw,format=I420,width=64,height=48 ! " + name +
      " name=tested ! fakesink";
  GstElement* pipeline = gst_parse_launch(line.c_str(), nullptr);
  GstElement* tested = gst_bin_get_by_name(GST_BIN(pipeline), "tested");
  // There is no head here: an element that would wait for one does not, or not for long.
  if (g_object_class_find_property(G_OBJECT_GET_CLASS(tested), "lockstep")) {
    gst_util_set_object_arg(G_OBJECT(tested), "lockstep", "off");
    g_object_set(tested, "lockstep-timeout", 10 * GST_MSECOND, nullptr);
  }
  gst_object_unref(tested);
  return pipeline;
}

GST_START_TEST(no_value_within_its_range_crashes_or_hangs_an_element) {
  for (const auto& name : elements()) {
    GstElement* probe = make(name);
    std::vector<GParamSpec*> specs;
    for_each_property(probe, [&](GParamSpec* spec) {
      if (spec->flags & G_PARAM_WRITABLE) specs.push_back(spec);
    });
    const bool filters = gst_element_class_get_pad_template(GST_ELEMENT_GET_CLASS(probe), "sink") &&
                         gst_element_class_get_pad_template(GST_ELEMENT_GET_CLASS(probe), "src");
    gst_object_unref(probe);
    if (!filters) continue;
    for (GParamSpec* spec : specs) {
      for (GValue& value : values_of(spec)) {
        GstElement* pipeline = pipeline_with(name);
        GstElement* tested = gst_bin_get_by_name(GST_BIN(pipeline), "tested");
        if (!(spec->flags & G_PARAM_CONSTRUCT_ONLY))
          g_object_set_property(G_OBJECT(tested), spec->name, &value);
        run_to_the_end(name, pipeline, std::string(spec->name) + "=" + as_text(value));
        gst_object_unref(tested);
        gst_object_unref(pipeline);
        g_value_unset(&value);
      }
    }
  }
}
GST_END_TEST

GST_START_TEST(an_element_runs_again_after_it_was_stopped) {
  for (const auto& name : elements()) {
    GstElement* probe = make(name);
    const bool filters = gst_element_class_get_pad_template(GST_ELEMENT_GET_CLASS(probe), "sink") &&
                         gst_element_class_get_pad_template(GST_ELEMENT_GET_CLASS(probe), "src");
    gst_object_unref(probe);
    if (!filters) continue;
    GstElement* pipeline = pipeline_with(name);
    for (int round = 0; round < 3; ++round) run_to_the_end(name, pipeline, "its defaults");
    gst_object_unref(pipeline);
  }
}
GST_END_TEST

Suite* every_element_suite() {
  Suite* suite = suite_create("every element");
  TCase* tests = tcase_create("every element");
  tcase_set_timeout(tests, 120);
  tcase_add_test(tests, an_element_says_what_it_is);
  tcase_add_test(tests, an_element_goes_through_every_state_and_back);
  tcase_add_test(tests, a_property_gives_back_what_it_was_given);
  tcase_add_test(tests, a_new_element_has_the_defaults_that_it_declares);
  tcase_add_test(tests, no_value_within_its_range_crashes_or_hangs_an_element);
  tcase_add_test(tests, an_element_runs_again_after_it_was_stopped);
  suite_add_tcase(suite, tests);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(every_element)
