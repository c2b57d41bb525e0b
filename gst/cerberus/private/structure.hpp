// SPDX-License-Identifier: LGPL-2.1-or-later
// What messages, events and caps hold.
#pragma once

#include <gst/gst.h>

namespace cerberus {

// A field that is an array of `count` values of `type`; set: of one value, as g_value_set_int().
template <typename T>
void set_array(GstStructure* structure, const char* field, GType type, void (*set)(GValue*, T), guint count,
               const auto* values) {
  GValue array = G_VALUE_INIT;
  gst_value_array_init(&array, count);
  for (guint i = 0; i < count; ++i) {
    GValue value = G_VALUE_INIT;
    g_value_init(&value, type);
    set(&value, values[i]);
    gst_value_array_append_and_take_value(&array, &value);
  }
  gst_structure_take_value(structure, field, &array);
}

// What an element message of this name says; nullptr: it is another message.
inline const GstStructure* element_structure(GstMessage* message, const char* name) {
  if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_ELEMENT || !gst_message_has_name(message, name))
    return nullptr;
  return gst_message_get_structure(message);
}

}  // namespace cerberus
