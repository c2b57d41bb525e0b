// SPDX-License-Identifier: LGPL-2.1-or-later
#include "foreign_boxes.hpp"

#include <cerberus/region.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "cerberus/private/compat.hpp"

#if CERBERUS_ANALYTICS
#include <gst/analytics/analytics.h>
#endif

namespace cerberus::plugin {
namespace {

bool is_person_label(const char* label) {
  return label && std::ranges::any_of(kPersonLabels,
                                      [&](const char* each) { return g_ascii_strcasecmp(label, each) == 0; });
}

// The part of a box inside the frame. nullopt: there is none.
std::optional<vision::Box> inside(double x, double y, double width, double height, vision::Size frame) {
  const double left = std::max(x, 0.0), top = std::max(y, 0.0);
  const double right = std::min(x + width, static_cast<double>(frame.width));
  const double bottom = std::min(y + height, static_cast<double>(frame.height));
  if (!(right - left >= 1) || !(bottom - top >= 1)) return std::nullopt;
  return vision::Box{left, top, right - left, bottom - top};
}

void add(double x, double y, double width, double height, vision::Size frame, const char* label,
         double confidence, std::vector<ForeignBox>& boxes) {
  if (boxes.size() == kMostForeignBoxes) return;
  const auto box = inside(x, y, width, height, frame);
  if (box && confidence >= 0)
    boxes.push_back({*box, std::min(confidence, 1.0), is_person_label(label), label ? label : ""});
}

// As DL Streamer gives it, and this library: a param `detection` with the number `confidence`. 1 where there is none; NaN where
// it is no number.
double confidence_of(GstVideoRegionOfInterestMeta* roi) {
  const GstStructure* detection = gst_video_region_of_interest_meta_get_param(roi, "detection");
  const GValue* value = detection ? gst_structure_get_value(detection, "confidence") : nullptr;
  if (!value) return 1;
  GValue number = G_VALUE_INIT;
  g_value_init(&number, G_TYPE_DOUBLE);
  const bool known = g_value_transform(value, &number);
  const double confidence = known ? g_value_get_double(&number) : std::numeric_limits<double>::quiet_NaN();
  g_value_unset(&number);
  return confidence;
}

// Elements that compute in signed pixels write boxes beyond the left or top edge as numbers near 2^32.
double signed_pixels(guint pixels) {
  return static_cast<gint>(pixels);
}

void read_regions_of_interest(GstBuffer* buffer, vision::Size frame, std::vector<ForeignBox>& boxes) {
  gpointer state = nullptr;
  while (GstMeta* meta =
             gst_buffer_iterate_meta_filtered(buffer, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)) {
    auto* roi = reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta);
    if (gst_video_region_of_interest_meta_get_param(roi, CERBERUS_REGION_STRUCTURE)) continue;  // ours
    add(signed_pixels(roi->x), signed_pixels(roi->y), signed_pixels(roi->w), signed_pixels(roi->h), frame,
        g_quark_to_string(roi->roi_type), confidence_of(roi), boxes);
  }
}

#if CERBERUS_ANALYTICS

// Whether the detection is what our own region is for others: see gst/cerberus/private/analytics.hpp.
bool is_of_region(const CerberusRegion& region, int x, int y, int width, int height) {
  const auto close = [](double a, double b) { return std::abs(a - b) <= 1; };
  return close(std::max(region.x, 0.0), x) && close(std::max(region.y, 0.0), y) &&
         close(region.x + region.width, x + width) && close(region.y + region.height, y + height);
}

void read_detections(GstBuffer* buffer, vision::Size frame, std::vector<ForeignBox>& boxes) {
  GstAnalyticsRelationMeta* meta = gst_buffer_get_analytics_relation_meta(buffer);
  if (!meta) return;
  g_autoptr(GPtrArray) ours = cerberus_buffer_get_regions(buffer);
  gpointer state = nullptr;
  GstAnalyticsODMtd detection;
  while (gst_analytics_relation_meta_iterate(meta, &state, gst_analytics_od_mtd_get_mtd_type(), &detection)) {
    gint x = 0, y = 0, width = 0, height = 0;
    gfloat confidence = 0;
    if (!gst_analytics_od_mtd_get_location(&detection, &x, &y, &width, &height, &confidence)) continue;
    const bool own = std::any_of(ours->pdata, ours->pdata + ours->len, [&](gpointer region) {
      return is_of_region(*static_cast<const CerberusRegion*>(region), x, y, width, height);
    });
    if (!own)
      add(x, y, width, height, frame, g_quark_to_string(gst_analytics_od_mtd_get_obj_type(&detection)),
          confidence, boxes);
  }
}

#else

void read_detections(GstBuffer*, vision::Size, std::vector<ForeignBox>&) {}

#endif

}  // namespace

void read_foreign_boxes(GstBuffer* buffer, vision::Size frame, std::vector<ForeignBox>& boxes) {
  boxes.clear();
  read_regions_of_interest(buffer, frame, boxes);
  read_detections(buffer, frame, boxes);
}

}  // namespace cerberus::plugin
