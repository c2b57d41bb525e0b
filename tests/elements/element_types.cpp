// SPDX-License-Identifier: LGPL-2.1-or-later
// The macro that makes a C++ object a GObject type, and the guard that keeps exceptions out of C.
#include <gst/base/gstbasetransform.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

#include <initializer_list>
#include <stdexcept>
#include <string>
#include <vector>

#include "cerberus/private/element.hpp"
#include "support.h"

GST_DEBUG_CATEGORY_STATIC(category);

namespace {

int alive = 0;

enum class Throws { nothing, exception, no_memory, number };

struct Private {
  Private() { ++alive; }
  ~Private() { --alive; }
  std::string name = "a name that is too long to be kept inside the string object";  // ASan sees it leak
  std::vector<int> numbers = {1, 2, 3};
  Throws throws = Throws::nothing;
};

GstStaticPadTemplate sink_template =
    GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS_ANY);
GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS_ANY);

CERBERUS_DEFINE_TYPE(CerberusTestThrower, cerberus_test_thrower, GstBaseTransform, GST_TYPE_BASE_TRANSFORM,
                     Private)

void fail_as_set(Throws what) {
  switch (what) {
    case Throws::nothing:
      return;
    case Throws::exception:
      throw std::runtime_error("the lens fell off");
    case Throws::no_memory:
      throw std::bad_alloc();
    case Throws::number:
      throw 42;
  }
}

GstFlowReturn transform_ip(GstBaseTransform* base, GstBuffer*) {
  auto* self = cerberus_test_thrower_self(base);
  return cerberus::guarded(self, GST_FLOW_ERROR, [&] {
    fail_as_set(self->priv->throws);
    return GST_FLOW_OK;
  });
}

gboolean stop(GstBaseTransform* base) {
  auto* self = cerberus_test_thrower_self(base);
  cerberus::guarded(self, [&] { fail_as_set(self->priv->throws); });
  return TRUE;
}

void cerberus_test_thrower_init(CerberusTestThrower* self) {
  fail_unless_equals_int(self->priv->numbers.size(), 3);  // constructed before init
  gst_base_transform_set_in_place(GST_BASE_TRANSFORM(self), TRUE);
}

void cerberus_test_thrower_class_init(CerberusTestThrowerClass* klass) {
  auto* element = GST_ELEMENT_CLASS(klass);
  gst_element_class_add_static_pad_template(element, &sink_template);
  gst_element_class_add_static_pad_template(element, &src_template);
  gst_element_class_set_static_metadata(element, "Thrower", "Test", "Throws as set", "The Cerberus authors");
  GST_BASE_TRANSFORM_CLASS(klass)->transform_ip = transform_ip;
  GST_BASE_TRANSFORM_CLASS(klass)->stop = stop;
}

// A second type in the same file, with an interface, derived from nothing but GstElement.
struct Empty {};
CERBERUS_DEFINE_TYPE(CerberusTestPlain, cerberus_test_plain, GstElement, GST_TYPE_ELEMENT, Empty, {
  static const GInterfaceInfo info = {nullptr, nullptr, nullptr};
  g_type_add_interface_static(type, GST_TYPE_PRESET, &info);
})
void cerberus_test_plain_init(CerberusTestPlain*) {}
void cerberus_test_plain_class_init(CerberusTestPlainClass* klass) {
  gst_element_class_set_static_metadata(GST_ELEMENT_CLASS(klass), "Plain", "Test", "Nothing",
                                        "The Cerberus authors");
}

}  // namespace

CERBERUS_REGISTER_ELEMENT(testthrower, GST_RANK_NONE, cerberus_test_thrower, category, "throws as set")

namespace {

struct Outcome {
  GstFlowReturn flow;
  int errors;
  std::string text;
  GQuark domain;
  int code;
};

Outcome push_one(Throws what) {
  Outcome outcome{GST_FLOW_OK, 0, "", 0, 0};
  auto* element = static_cast<GstElement*>(g_object_new(cerberus_test_thrower_get_type(), nullptr));
  g_autoptr(GstBus) bus = gst_bus_new();
  gst_element_set_bus(element, bus);
  GstHarness* h = gst_harness_new_with_element(element, "sink", "src");
  gst_harness_set_src_caps_str(h, "test/x-bytes");
  cerberus_test_thrower_self(element)->priv->throws = what;
  outcome.flow = gst_harness_push(h, gst_buffer_new());
  cerberus_test_thrower_self(element)->priv->throws = Throws::nothing;
  while (GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR)) {
    g_autoptr(GError) error = nullptr;
    gst_message_parse_error(message, &error, nullptr);
    ++outcome.errors;
    outcome.text = error->message;
    outcome.domain = error->domain;
    outcome.code = error->code;
    gst_message_unref(message);
  }
  gst_harness_teardown(h);
  gst_element_set_bus(element, nullptr);
  gst_object_unref(element);
  return outcome;
}

}  // namespace

START_TEST(the_private_object_lives_as_long_as_the_element) {
  fail_unless_equals_int(alive, 0);
  auto* one = static_cast<GstElement*>(g_object_new(cerberus_test_thrower_get_type(), nullptr));
  auto* two = static_cast<GstElement*>(g_object_new(cerberus_test_thrower_get_type(), nullptr));
  fail_unless_equals_int(alive, 2);
  fail_if(cerberus_test_thrower_self(one)->priv == cerberus_test_thrower_self(two)->priv);
  cerberus_test_thrower_self(one)->priv->numbers.push_back(4);
  fail_unless_equals_int(cerberus_test_thrower_self(two)->priv->numbers.size(), 3);
  gst_object_unref(one);
  fail_unless_equals_int(alive, 1);
  gst_object_unref(two);
  fail_unless_equals_int(alive, 0);
}
END_TEST

START_TEST(the_parents_finalizer_runs_too) {
  auto* element = static_cast<GstElement*>(g_object_new(cerberus_test_thrower_get_type(), nullptr));
  bool finalized = false;  // GObject clears an object's data in its own finalizer
  g_object_set_data_full(G_OBJECT(element), "flag", &finalized,
                         [](gpointer flag) { *static_cast<bool*>(flag) = true; });
  gst_object_unref(element);
  fail_unless(finalized);
}
END_TEST

START_TEST(the_type_has_its_name_parent_and_interfaces) {
  fail_unless_equals_string(g_type_name(cerberus_test_thrower_get_type()), "CerberusTestThrower");
  fail_unless(g_type_parent(cerberus_test_thrower_get_type()) == GST_TYPE_BASE_TRANSFORM);
  fail_unless(g_type_is_a(cerberus_test_plain_get_type(), GST_TYPE_PRESET));
  fail_if(g_type_is_a(cerberus_test_thrower_get_type(), GST_TYPE_PRESET));
  auto* element = static_cast<GstElement*>(g_object_new(cerberus_test_plain_get_type(), nullptr));
  fail_unless(G_OBJECT_TYPE(element) == cerberus_test_plain_get_type());
  fail_unless_equals_string(G_OBJECT_CLASS_NAME(cerberus_test_plain_parent_class()), "GstElement");
  gst_object_unref(element);
}
END_TEST

START_TEST(a_registered_element_can_be_made) {
  fail_unless(gst_element_register_testthrower(nullptr));
  GstElement* element = gst_element_factory_make("testthrower", nullptr);
  fail_unless(element);
  gst_object_unref(element);
}
END_TEST

START_TEST(without_an_exception_the_result_passes) {
  const Outcome outcome = push_one(Throws::nothing);
  fail_unless_equals_int(outcome.flow, GST_FLOW_OK);
  fail_unless_equals_int(outcome.errors, 0);
}
END_TEST

START_TEST(an_exception_becomes_one_error_message) {
  const Outcome outcome = push_one(Throws::exception);
  fail_unless_equals_int(outcome.flow, GST_FLOW_ERROR);
  fail_unless_equals_int(outcome.errors, 1);
  fail_unless(outcome.domain == GST_LIBRARY_ERROR && outcome.code == GST_LIBRARY_ERROR_FAILED);
  fail_unless(outcome.text.find("the lens fell off") != std::string::npos);
}
END_TEST

START_TEST(no_memory_is_reported_as_such) {
  const Outcome outcome = push_one(Throws::no_memory);
  fail_unless_equals_int(outcome.flow, GST_FLOW_ERROR);
  fail_unless_equals_int(outcome.errors, 1);
  fail_unless(outcome.domain == GST_RESOURCE_ERROR && outcome.code == GST_RESOURCE_ERROR_NO_SPACE_LEFT);
}
END_TEST

START_TEST(anything_thrown_is_caught) {
  const Outcome outcome = push_one(Throws::number);
  fail_unless_equals_int(outcome.flow, GST_FLOW_ERROR);
  fail_unless_equals_int(outcome.errors, 1);
}
END_TEST

START_TEST(a_guard_without_a_result_returns_normally) {
  auto* element = static_cast<GstElement*>(g_object_new(cerberus_test_thrower_get_type(), nullptr));
  cerberus_test_thrower_self(element)->priv->throws = Throws::exception;
  fail_unless(stop(GST_BASE_TRANSFORM(element)));
  gst_object_unref(element);
}
END_TEST

static Suite* element_types_suite(void) {
  watch_library_log();
  Suite* s = suite_create("element_types");
  TCase* tc = tcase_create("types");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, the_private_object_lives_as_long_as_the_element);
  tcase_add_test(tc, the_parents_finalizer_runs_too);
  tcase_add_test(tc, the_type_has_its_name_parent_and_interfaces);
  tcase_add_test(tc, a_registered_element_can_be_made);
  tc = tcase_create("guard");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, without_an_exception_the_result_passes);
  tcase_add_test(tc, an_exception_becomes_one_error_message);
  tcase_add_test(tc, no_memory_is_reported_as_such);
  tcase_add_test(tc, anything_thrown_is_caught);
  tcase_add_test(tc, a_guard_without_a_result_returns_normally);
  return s;
}

GST_CHECK_MAIN(element_types)
