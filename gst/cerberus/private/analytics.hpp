// SPDX-License-Identifier: LGPL-2.1-or-later
// Regions as GstAnalyticsRelationMeta (GStreamer 1.24): one object detection each, related to a tracking
// entry where the region is tracked. Nothing happens where GStreamer has none.
//
// Entries cannot be taken out of a relation meta again, so ours come out only as a whole: `ours` is the
// number of entries that our regions on the buffer stand for, and a meta that holds more also has entries of
// other elements.
#pragma once

#include <cerberus/region.h>

#include "compat.hpp"

#if CERBERUS_ANALYTICS
#include <gst/analytics/analytics.h>
#endif

namespace cerberus::analytics {

// What a region is called in GStreamer's metas.
inline constexpr char kMotion[] = "motion";
inline constexpr char kPerson[] = "person";

struct Pixels {
  guint x, y, width, height;
};

#if CERBERUS_ANALYTICS

// Returns how many entries were added. To a meta that also has entries of other elements only tracked regions are
// added: regions that a tracker is going to replace could not be removed.
inline guint add(GstBuffer* buffer, const CerberusRegion& region, const char* kind, const Pixels& p,
                 guint ours) {
  GstAnalyticsRelationMeta* meta = gst_buffer_get_analytics_relation_meta(buffer);
  if (!meta) meta = gst_buffer_add_analytics_relation_meta(buffer);
  if (!region.tracked && gst_analytics_relation_get_length(meta) != ours) return 0;

  GstAnalyticsODMtd detection;
  if (!gst_analytics_relation_meta_add_od_mtd(meta, g_quark_from_string(kind), static_cast<gint>(p.x),
                                              static_cast<gint>(p.y), static_cast<gint>(p.width),
                                              static_cast<gint>(p.height),
                                              static_cast<gfloat>(region.confidence), &detection))
    return 0;
  if (!region.tracked) return 1;

  const GstClockTime now = GST_BUFFER_PTS(buffer);
  const GstClockTime first = GST_CLOCK_TIME_IS_VALID(now) && now >= region.age ? now - region.age : 0;
  GstAnalyticsTrackingMtd track;
  if (!gst_analytics_relation_meta_add_tracking_mtd(meta, region.id, first, &track)) return 1;
  if (GST_CLOCK_TIME_IS_VALID(now)) gst_analytics_tracking_mtd_update_last_seen(&track, now);
  gst_analytics_relation_meta_set_relation(meta, GST_ANALYTICS_REL_TYPE_RELATE_TO, detection.id, track.id);
  return 2;
}

// Returns whether `meta` holds only detections of our types. A meta may have been lost (scaling, 1.24) and another
// added.
inline bool looks_like_ours(GstAnalyticsRelationMeta* meta) {
  gpointer state = nullptr;
  GstAnalyticsODMtd detection;
  while (gst_analytics_relation_meta_iterate(meta, &state, gst_analytics_od_mtd_get_mtd_type(), &detection)) {
    const GQuark type = gst_analytics_od_mtd_get_obj_type(&detection);
    if (type != g_quark_from_static_string(kMotion) && type != g_quark_from_static_string(kPerson))
      return false;
  }
  return true;
}

inline void remove(GstBuffer* buffer, guint ours) {
  GstAnalyticsRelationMeta* meta = gst_buffer_get_analytics_relation_meta(buffer);
  if (meta && ours > 0 && gst_analytics_relation_get_length(meta) == ours && looks_like_ours(meta))
    gst_buffer_remove_meta(buffer, reinterpret_cast<GstMeta*>(meta));
}

#else

inline guint add(GstBuffer*, const CerberusRegion&, const char*, const Pixels&, guint) {
  return 0;
}
inline void remove(GstBuffer*, guint) {}

#endif

}  // namespace cerberus::analytics
