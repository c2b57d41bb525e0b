// SPDX-License-Identifier: LGPL-2.1-or-later
// A query to an element: what of its settings keeps it from starting? An element answers by the functions that its start
// calls, and opens no device. cerberusd asks before it takes a configuration.
//
//   std::string settings_fault(GstElement* element);  // for a user, with the names of properties; empty: nothing
//   GST_ELEMENT_CLASS(klass)->query = settings_query<cerberus_thing_parent_class, settings_fault>;
#pragma once

#include <gst/gst.h>

#include <string>

#include "cerberus/private/element.hpp"

namespace cerberus {

inline constexpr const char* kSettingsQuery = "cerberus-settings-fault";

template <auto parent_class, std::string (*settings_fault)(GstElement*)>
gboolean settings_query(GstElement* element, GstQuery* query) {
  const GstStructure* asked =
      GST_QUERY_TYPE(query) == GST_QUERY_CUSTOM ? gst_query_get_structure(query) : nullptr;
  if (asked && gst_structure_has_name(asked, kSettingsQuery))
    return guarded(element, TRUE, [&]() -> gboolean {
      // What is left where the element fails as it looks.
      gst_structure_set(gst_query_writable_structure(query), "fault", G_TYPE_STRING,
                        "These settings cannot be used.", nullptr);
      gst_structure_set(gst_query_writable_structure(query), "fault", G_TYPE_STRING,
                        settings_fault(element).c_str(), nullptr);
      return TRUE;
    });
  const auto next = GST_ELEMENT_CLASS(parent_class())->query;
  return next ? next(element, query) : FALSE;
}

// Asks an element; one that does not know the query has nothing to object.
inline std::string ask_for_settings_fault(GstElement* element) {
  g_autoptr(GstQuery) query = gst_query_new_custom(GST_QUERY_CUSTOM, gst_structure_new_empty(kSettingsQuery));
  if (!gst_element_query(element, query)) return {};
  const gchar* fault = gst_structure_get_string(gst_query_get_structure(query), "fault");
  return fault ? fault : "";
}

}  // namespace cerberus
