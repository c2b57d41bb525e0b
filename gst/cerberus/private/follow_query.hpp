// SPDX-License-Identifier: LGPL-2.1-or-later
// pantiltsink asks upstream whether a pirfusion of its head takes the choice of a track over: then the decision on each
// frame says what is followed, for all who read it (an overlay, a page, a broker). A query, because its answer says
// whether the choice is taken, which that of an event does not.
#pragma once

#include <gst/gst.h>

#include <string_view>

namespace cerberus {

inline constexpr const char* kFollowQuery = "cerberus-follow";

// track: 0 ends the choice. False: no element upstream takes it.
inline bool ask_to_follow(GstPad* sink, const char* head, guint track) {
  g_autoptr(GstQuery) query = gst_query_new_custom(
      GST_QUERY_CUSTOM, gst_structure_new(kFollowQuery, "head", G_TYPE_STRING, head ? head : "", "track",
                                          G_TYPE_UINT, track, nullptr));
  return gst_pad_peer_query(sink, query);
}

// Whether the query is one of these; then `head` (valid as long as the query) and `track` are set.
inline bool parse_follow_query(GstQuery* query, std::string_view& head, guint& track) {
  const GstStructure* asked =
      GST_QUERY_TYPE(query) == GST_QUERY_CUSTOM ? gst_query_get_structure(query) : nullptr;
  if (!asked || !gst_structure_has_name(asked, kFollowQuery)) return false;
  const gchar* name = gst_structure_get_string(asked, "head");
  head = name ? name : "";
  return gst_structure_get_uint(asked, "track", &track);
}

}  // namespace cerberus
