// SPDX-License-Identifier: LGPL-2.1-or-later
// Custom queries, told apart by the names of their structures.
#pragma once

#include <gst/gst.h>

namespace cerberus {

inline bool is_custom_query(GstQuery* query, const char* name) {
  const GstStructure* told = gst_query_get_structure(query);
  return GST_QUERY_TYPE(query) == GST_QUERY_CUSTOM && told && gst_structure_has_name(told, name);
}

}  // namespace cerberus
