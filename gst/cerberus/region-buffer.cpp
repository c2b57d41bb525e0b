// SPDX-License-Identifier: LGPL-2.1-or-later
// Regions on buffers: our own record of each, and beside it what other elements and tools read.
#include <cerberus/region.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>

#include "private/analytics.hpp"
#include "private/meta.hpp"

namespace {

using cerberus::analytics::kMotion;
using cerberus::analytics::kPerson;

// The whole pixels nearest to a region's edges, cut at the frame's left and top (the meta holds no negative
// numbers and the frame's size is not known here); at least one pixel.
struct Pixels {
  guint x, y, width, height;
};

struct Interval {
  guint start, length;
};

Interval whole_pixels(double start, double length) {
  const double first = std::max(std::round(start), 0.0);
  const double last = std::max(std::round(start + length), first + 1);
  return {static_cast<guint>(first), static_cast<guint>(last - first)};
}

Pixels whole_pixels(const CerberusRegion& region) {
  const Interval h = whole_pixels(region.x, region.width), v = whole_pixels(region.y, region.height);
  return {h.start, v.start, h.length, v.length};
}

bool is_sane(const CerberusRegion& region) {
  constexpr double kFar = 1 << 24;  // no picture is that large, and whole numbers are exact up to here
  const double numbers[] = {region.x, region.y, region.width, region.height};
  return std::all_of(std::begin(numbers), std::end(numbers), [](double n) { return std::abs(n) < kFar; }) &&
         region.width >= 0 && region.height >= 0;
}

// Our own record of a region. GStreamer's meta beside it is what others read: it holds whole pixels only, and up to
// (at least) 1.22 it loses its params where a picture is converted or scaled.
struct RegionMeta {
  GstMeta meta;
  CerberusRegion region;
  guint analytics;  // how many entries of an analytics meta stand for the region
};

const GstMetaInfo* region_meta_info();

RegionMeta* next_region(GstBuffer* buffer, gpointer& state) {
  return reinterpret_cast<RegionMeta*>(
      gst_buffer_iterate_meta_filtered(buffer, &state, region_meta_info()->api));
}

void record(GstBuffer* buffer, const CerberusRegion& region, guint analytics) {
  auto* meta = reinterpret_cast<RegionMeta*>(gst_buffer_add_meta(buffer, region_meta_info(), nullptr));
  meta->region = region;
  meta->analytics = analytics;
}

const char* type_of(const CerberusRegion& region) {
  return region.person ? kPerson : kMotion;
}

// True of a meta that stands for one of our regions.
bool is_ours(GstMeta* meta) {
  return meta->info->api == GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE &&
         gst_video_region_of_interest_meta_get_param(reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta),
                                                     CERBERUS_REGION_STRUCTURE);
}

void add_params(GstVideoRegionOfInterestMeta* meta, const CerberusRegion& region) {
  gst_video_region_of_interest_meta_add_param(
      meta, gst_structure_new("detection", "confidence", G_TYPE_DOUBLE, region.confidence, nullptr));
  if (region.tracked) {
    gst_video_region_of_interest_meta_add_param(
        meta, gst_structure_new("object_id", "id", G_TYPE_INT, static_cast<gint>(region.id), nullptr));
  }
  gst_video_region_of_interest_meta_add_param(meta, cerberus_region_to_structure(&region));
}

void drop_params(GstVideoRegionOfInterestMeta* meta) {
  for (const char* name : {"detection", "object_id", CERBERUS_REGION_STRUCTURE}) {
    GstStructure* param = gst_video_region_of_interest_meta_get_param(meta, name);
    if (!param) continue;
    meta->params = g_list_remove(meta->params, param);
    gst_structure_free(param);
  }
}

// Makes the scaled meta of a region say the same as our record: scaling takes its params away (1.22), and rounds its
// pixels down from pixels that were rounded before. It is there already: it stood before our record on the buffer, and
// metas are transformed in that order.
void update_scaled(GstBuffer* buffer, const CerberusRegion& before, const CerberusRegion& after,
                   const GstVideoMetaTransform& scale) {
  const Pixels old = whole_pixels(before);
  const auto is_scaled = [](guint n, guint old_n, gint from, gint to) {
    const gint64 difference = gint64{n} - gint64{old_n} * to / from;
    return difference >= -1 && difference <= 1;
  };
  const gint from_width = GST_VIDEO_INFO_WIDTH(scale.in_info),
             to_width = GST_VIDEO_INFO_WIDTH(scale.out_info);
  const gint from_height = GST_VIDEO_INFO_HEIGHT(scale.in_info),
             to_height = GST_VIDEO_INFO_HEIGHT(scale.out_info);
  const GQuark type = g_quark_from_static_string(type_of(before));
  gpointer state = nullptr;
  while (GstMeta* meta =
             gst_buffer_iterate_meta_filtered(buffer, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)) {
    auto* roi = reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta);
    if (roi->roi_type != type || roi->id != static_cast<gint>(before.id)) continue;
    if (!is_scaled(roi->x, old.x, from_width, to_width) ||
        !is_scaled(roi->w, old.width, from_width, to_width) ||
        !is_scaled(roi->y, old.y, from_height, to_height) ||
        !is_scaled(roi->h, old.height, from_height, to_height))
      continue;
    const Pixels p = whole_pixels(after);
    roi->x = p.x;
    roi->y = p.y;
    roi->w = p.width;
    roi->h = p.height;
    drop_params(roi);
    add_params(roi, after);
    return;
  }
}

gboolean meta_init(GstMeta* meta, gpointer, GstBuffer*) {
  cerberus_region_init(&reinterpret_cast<RegionMeta*>(meta)->region);
  reinterpret_cast<RegionMeta*>(meta)->analytics = 0;
  return TRUE;
}

// Copies and scaling keep the region; whatever else is done to a picture makes its pixels wrong.
gboolean meta_transform(GstBuffer* to, GstMeta* meta, GstBuffer*, GQuark type, gpointer data) {
  const auto* own = reinterpret_cast<RegionMeta*>(meta);
  CerberusRegion region = own->region;
  if (GST_META_TRANSFORM_IS_COPY(type)) {
    record(to, region, own->analytics);
    return TRUE;
  }
  if (!GST_VIDEO_META_TRANSFORM_IS_SCALE(type)) return FALSE;
  const auto* scale = static_cast<GstVideoMetaTransform*>(data);
  if (GST_VIDEO_INFO_WIDTH(scale->in_info) <= 0 || GST_VIDEO_INFO_HEIGHT(scale->in_info) <= 0) return FALSE;
  const double sx =
      static_cast<double>(GST_VIDEO_INFO_WIDTH(scale->out_info)) / GST_VIDEO_INFO_WIDTH(scale->in_info);
  const double sy =
      static_cast<double>(GST_VIDEO_INFO_HEIGHT(scale->out_info)) / GST_VIDEO_INFO_HEIGHT(scale->in_info);
  for (double* n : {&region.x, &region.width, &region.vx}) *n *= sx;
  for (double* n : {&region.y, &region.height, &region.vy}) *n *= sy;
  record(to, region, own->analytics);
  update_scaled(to, own->region, region, *scale);
  return TRUE;
}

const GstMetaInfo* region_meta_info() {
  static const GstMetaInfo* const info = [] {
    const GType api = cerberus::register_meta_api("CerberusRegionMetaAPI", GST_META_TAG_VIDEO_STR,
                                                  GST_META_TAG_VIDEO_SIZE_STR);
    return cerberus::register_meta<RegionMeta>(api, "CerberusRegionMeta", meta_init, nullptr, meta_transform);
  }();
  return info;
}

// Says that a detector has looked, also where it found nothing. It goes where a region's record goes, so that the two
// are lost together.
GstMeta* find_known(GstBuffer* buffer);
void record_known(GstBuffer* buffer);

gboolean known_transform(GstBuffer* to, GstMeta*, GstBuffer*, GQuark type, gpointer) {
  if (!GST_META_TRANSFORM_IS_COPY(type) && !GST_VIDEO_META_TRANSFORM_IS_SCALE(type)) return FALSE;
  record_known(to);
  return TRUE;
}

const GstMetaInfo* known_meta_info() {
  static const GstMetaInfo* const info = [] {
    const GType api = cerberus::register_meta_api("CerberusRegionsKnownMetaAPI", GST_META_TAG_VIDEO_STR,
                                                  GST_META_TAG_VIDEO_SIZE_STR);
    return cerberus::register_meta<GstMeta>(
        api, "CerberusRegionsKnownMeta", [](GstMeta*, gpointer, GstBuffer*) -> gboolean { return TRUE; },
        nullptr, known_transform);
  }();
  return info;
}

GstMeta* find_known(GstBuffer* buffer) {
  return gst_buffer_get_meta(buffer, known_meta_info()->api);
}
void record_known(GstBuffer* buffer) {
  if (!find_known(buffer)) gst_buffer_add_meta(buffer, known_meta_info(), nullptr);
}

guint count_analytics(GstBuffer* buffer) {
  guint total = 0;
  gpointer state = nullptr;
  while (const RegionMeta* meta = next_region(buffer, state)) total += meta->analytics;
  return total;
}

}  // namespace

gboolean cerberus_buffer_add_region(GstBuffer* buffer, const CerberusRegion* region) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), FALSE);
  g_return_val_if_fail(region, FALSE);
  if (!gst_buffer_is_writable(buffer) || !is_sane(*region)) return FALSE;

  const Pixels p = whole_pixels(*region);
  const guint analytics =
      cerberus::analytics::add(buffer,
                               {type_of(*region), p.x, p.y, p.width, p.height, region->confidence,
                                region->tracked != FALSE, region->id, region->age},
                               count_analytics(buffer));
  GstVideoRegionOfInterestMeta* meta =
      gst_buffer_add_video_region_of_interest_meta(buffer, type_of(*region), p.x, p.y, p.width, p.height);
  meta->id = static_cast<gint>(region->id);
  add_params(meta, *region);
  record(buffer, *region, analytics);
  record_known(buffer);
  return TRUE;
}

gboolean cerberus_buffer_set_regions(GstBuffer* buffer, GPtrArray* regions) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), FALSE);
  if (!gst_buffer_is_writable(buffer)) return FALSE;
  cerberus_buffer_remove_regions(buffer);
  if (!regions) return TRUE;
  record_known(buffer);
  gboolean all = TRUE;
  for (guint i = 0; i < regions->len; ++i)
    all &=
        cerberus_buffer_add_region(buffer, static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i)));
  return all;
}

gboolean cerberus_buffer_regions_known(GstBuffer* buffer) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), FALSE);
  return find_known(buffer) != nullptr;
}

GPtrArray* cerberus_buffer_get_regions(GstBuffer* buffer) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), nullptr);
  GPtrArray* regions = g_ptr_array_new_with_free_func(reinterpret_cast<GDestroyNotify>(cerberus_region_free));
  gpointer state = nullptr;
  while (const RegionMeta* meta = next_region(buffer, state))
    g_ptr_array_add(regions, cerberus_region_copy(&meta->region));
  return regions;
}

void cerberus_buffer_remove_regions(GstBuffer* buffer) {
  g_return_if_fail(GST_IS_BUFFER(buffer));
  g_return_if_fail(gst_buffer_is_writable(buffer));
  cerberus::analytics::remove(buffer, count_analytics(buffer));
  gst_buffer_foreach_meta(
      buffer,
      [](GstBuffer*, GstMeta** meta, gpointer) -> gboolean {
        const GType api = (*meta)->info->api;
        if (api == region_meta_info()->api || api == known_meta_info()->api || is_ours(*meta))
          *meta = nullptr;
        return TRUE;
      },
      nullptr);
}
