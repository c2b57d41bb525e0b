// SPDX-License-Identifier: LGPL-2.1-or-later
// A source whose camera a head turns asks downstream whether there is one: a pantiltsink of that name answers.
#pragma once

#include <gst/gst.h>

#include <string_view>

namespace cerberus {

inline constexpr const char* kHeadQuery = "cerberus-head";

// An empty name is any head's.
inline bool has_head_downstream(GstPad* src, const char* head) {
  g_autoptr(GstQuery) query = gst_query_new_custom(
      GST_QUERY_CUSTOM, gst_structure_new(kHeadQuery, "head", G_TYPE_STRING, head, nullptr));
  return gst_pad_peer_query(src, query);
}

// Whether the query asks for this head.
inline bool asks_for_head(GstQuery* query, std::string_view head) {
  const GstStructure* asked =
      GST_QUERY_TYPE(query) == GST_QUERY_CUSTOM ? gst_query_get_structure(query) : nullptr;
  if (!asked || !gst_structure_has_name(asked, kHeadQuery)) return false;
  const gchar* name = gst_structure_get_string(asked, "head");
  return !name || !*name || head == name;
}

}  // namespace cerberus
