// SPDX-License-Identifier: LGPL-2.1-or-later
#include "element_properties.h"

namespace cerberus::robot {

bool set_property(GstElement* element, const Assignment& assignment, std::string& error) {
  const char* name = assignment.property.c_str();
  GParamSpec* spec = g_object_class_find_property(G_OBJECT_GET_CLASS(element), name);
  if (spec == nullptr) {
    error = "this build's " + assignment.element + " has no property " + assignment.property;
    return false;
  }
  if (G_PARAM_SPEC_VALUE_TYPE(spec) == G_TYPE_STRING) {
    g_object_set(element, name, assignment.value.c_str(), nullptr);
    return true;
  }
  g_auto(GValue) value = G_VALUE_INIT;
  g_value_init(&value, G_PARAM_SPEC_VALUE_TYPE(spec));
  // Validation changes what is out of the property's range.
  if (!gst_value_deserialize_with_pspec(&value, assignment.value.c_str(), spec) ||
      g_param_value_validate(spec, &value)) {
    g_auto(GValue) usual = G_VALUE_INIT;
    g_value_init(&usual, G_PARAM_SPEC_VALUE_TYPE(spec));
    g_param_value_set_default(spec, &usual);
    g_autofree gchar* text = gst_value_serialize(&usual);
    error = "the element does not take this value (by default it is " + std::string(text ? text : "unset") +
            "; " + g_param_spec_get_blurb(spec) + ")";
    return false;
  }
  g_object_set_property(G_OBJECT(element), name, &value);
  return true;
}

}  // namespace cerberus::robot
