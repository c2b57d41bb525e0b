// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/query.h>

#include "private/query.hpp"

namespace {
constexpr char kWanted[] = "wanted";
}

GstQuery* cerberus_query_new_planes(void) {
  return gst_query_new_custom(
      GST_QUERY_CUSTOM, gst_structure_new(CERBERUS_QUERY_PLANES, kWanted, G_TYPE_BOOLEAN, FALSE, nullptr));
}

gboolean cerberus_query_is_planes(GstQuery* query) {
  g_return_val_if_fail(GST_IS_QUERY(query), FALSE);
  return cerberus::is_custom_query(query, CERBERUS_QUERY_PLANES);
}

gboolean cerberus_query_set_planes_wanted(GstQuery* query, gboolean wanted) {
  if (!cerberus_query_is_planes(query)) return FALSE;
  gst_structure_set(gst_query_writable_structure(query), kWanted, G_TYPE_BOOLEAN, wanted != FALSE, nullptr);
  return TRUE;
}

gboolean cerberus_query_parse_planes(GstQuery* query, gboolean* wanted) {
  gboolean value = FALSE;
  if (!cerberus_query_is_planes(query) ||
      !gst_structure_get_boolean(gst_query_get_structure(query), kWanted, &value))
    return FALSE;
  if (wanted) *wanted = value;
  return TRUE;
}

gboolean cerberus_pad_peer_wants_planes(GstPad* pad) {
  g_return_val_if_fail(GST_IS_PAD(pad), FALSE);
  g_return_val_if_fail(GST_PAD_IS_SRC(pad), FALSE);
  g_autoptr(GstQuery) query = cerberus_query_new_planes();
  gboolean wanted = FALSE;
  return gst_pad_peer_query(pad, query) && cerberus_query_parse_planes(query, &wanted) && wanted;
}
