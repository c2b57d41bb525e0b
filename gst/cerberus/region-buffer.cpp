// SPDX-License-Identifier: LGPL-2.1-or-later
// Regions on buffers: our own record of each, and beside it what other elements and tools read.
#include <cerberus/region.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "cerberus/private/analytics.hpp"
#include "cerberus/private/fields.hpp"
#include "cerberus/private/meta.hpp"

namespace {

using cerberus::analytics::kMotion;
using cerberus::analytics::kPerson;
using cerberus::analytics::Pixels;

// The whole pixels nearest to a region's edges, cut at the frame's left and top (the meta holds no negative
// numbers and the frame's size is not known here); at least one pixel.
Pixels whole_pixels(const CerberusRegion& region) {
  const auto interval = [](double start, double length, guint& at, guint& n) {
    const double first = std::max(std::round(start), 0.0);
    at = static_cast<guint>(first);
    n = static_cast<guint>(std::max(std::round(start + length), first + 1) - first);
  };
  Pixels p;
  interval(region.x, region.width, p.x, p.width);
  interval(region.y, region.height, p.y, p.height);
  return p;
}

bool is_sane(const CerberusRegion& region) {
  constexpr double kFar = 1 << 24;  // no picture is that large, and whole numbers are exact up to here
  return std::ranges::all_of(std::initializer_list{region.x, region.y, region.width, region.height},
                             [](double n) { return std::abs(n) < kFar; }) &&
         region.width >= 0 && region.height >= 0 &&
         cerberus::is_one_of(CERBERUS_TYPE_REGION_KIND, &region.kind) &&
         cerberus::is_one_of(CERBERUS_TYPE_REGION_STATE, &region.state);
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
                   const cerberus::Rescaling& sizes) {
  const Pixels old = whole_pixels(before), now = whole_pixels(after);
  const auto is_scaled = [](guint n, guint old_n, gint from, gint to) {
    const gint64 difference = gint64{n} - gint64{old_n} * to / from;
    return difference >= -1 && difference <= 1;
  };
  const auto [from, to] = sizes;
  gpointer state = nullptr;
  while (GstMeta* meta =
             gst_buffer_iterate_meta_filtered(buffer, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)) {
    auto* roi = reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta);
    if (roi->roi_type != g_quark_from_static_string(type_of(before)) ||
        roi->id != static_cast<gint>(before.id) || !is_scaled(roi->x, old.x, from.width, to.width) ||
        !is_scaled(roi->w, old.width, from.width, to.width) ||
        !is_scaled(roi->y, old.y, from.height, to.height) ||
        !is_scaled(roi->h, old.height, from.height, to.height))
      continue;
    roi->x = now.x;
    roi->y = now.y;
    roi->w = now.width;
    roi->h = now.height;
    drop_params(roi);
    return add_params(roi, after);
  }
}

gboolean meta_transform(GstBuffer* to, GstMeta* meta, GstBuffer*, GQuark type, gpointer data) {
  const auto sizes = cerberus::rescaling(type, data);
  if (!sizes) return FALSE;
  const auto* own = reinterpret_cast<RegionMeta*>(meta);
  CerberusRegion region = own->region;
  const auto scale = [](double& n, int from, int by) { n *= static_cast<double>(by) / from; };
  for (double* n : {&region.x, &region.width, &region.vx}) scale(*n, sizes->from.width, sizes->to.width);
  for (double* n : {&region.y, &region.height, &region.vy}) scale(*n, sizes->from.height, sizes->to.height);
  record(to, region, own->analytics);
  if (!GST_META_TRANSFORM_IS_COPY(type)) update_scaled(to, own->region, region, *sizes);
  return TRUE;
}

// Across processes: a region is attached as a detector does, with all that others read.
struct RegionPacking {
  static GstClockTime frame_time(const GstMeta*) { return GST_CLOCK_TIME_NONE; }  // it has no point in time
  static void exchange(auto& archive, CerberusRegion& r) {
    archive(r.id, r.tracked, r.person, r.kind, r.x, r.y, r.width, r.height, r.confidence, r.vx, r.vy, r.age,
            r.state, r.bearing, r.distance, r.motion);
  }
  static void pack(const GstMeta* meta, cerberus::publish::Packer& to) {
    CerberusRegion region = reinterpret_cast<const RegionMeta*>(meta)->region;
    exchange(to, region);
  }
  static GstMeta* unpack(GstBuffer* buffer, cerberus::publish::Unpacker& from) {
    CerberusRegion region{};
    exchange(from, region);
    return from.complete() && cerberus_buffer_add_region(buffer, &region)
               ? gst_buffer_get_meta(buffer, region_meta_info()->api)
               : nullptr;
  }
};

const GstMetaInfo* region_meta_info() {
  static const GstMetaInfo* const info = cerberus::register_meta<RegionMeta, RegionPacking>(
      cerberus::register_meta_api("CerberusRegionMetaAPI", GST_META_TAG_VIDEO_STR,
                                  GST_META_TAG_VIDEO_SIZE_STR),
      "CerberusRegionMeta", [](GstMeta*, gpointer, GstBuffer*) -> gboolean { return TRUE; }, nullptr,
      meta_transform);
  return info;
}

// Marks that a detector has analysed the picture, also where it found nothing. It goes where a region's record goes, so
// that the two are lost together; without it there are no regions.
constexpr struct Known {
} kKnown;
void init(Known*) {}
void exchange(auto&, Known&) {}
const GstMetaInfo* known_meta_info();
using KnownMeta = cerberus::ValueMeta<Known, init, known_meta_info, true>;

const GstMetaInfo* known_meta_info() {
  static const GstMetaInfo* const info = KnownMeta::register_as(
      cerberus::register_meta_api("CerberusRegionsKnownMetaAPI", GST_META_TAG_VIDEO_STR,
                                  GST_META_TAG_VIDEO_SIZE_STR),
      "CerberusRegionsKnownMeta",
      [](GstBuffer* to, GstMeta*, GstBuffer* from, GQuark type, gpointer data) -> gboolean {
        return cerberus::rescaling(type, data) && KnownMeta::set(to, KnownMeta::peek(from));
      });
  return info;
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

  if (!cerberus_buffer_regions_known(buffer)) cerberus_buffer_remove_regions(buffer);  // of another picture
  const Pixels p = whole_pixels(*region);
  const guint analytics =
      cerberus::analytics::add(buffer, *region, type_of(*region), p, count_analytics(buffer));
  GstVideoRegionOfInterestMeta* meta =
      gst_buffer_add_video_region_of_interest_meta(buffer, type_of(*region), p.x, p.y, p.width, p.height);
  meta->id = static_cast<gint>(region->id);
  add_params(meta, *region);
  record(buffer, *region, analytics);
  KnownMeta::set(buffer, &kKnown);
  return TRUE;
}

gboolean cerberus_buffer_set_regions(GstBuffer* buffer, GPtrArray* regions) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), FALSE);
  if (!gst_buffer_is_writable(buffer)) return FALSE;
  cerberus_buffer_remove_regions(buffer);
  if (!regions) return TRUE;
  KnownMeta::set(buffer, &kKnown);
  gboolean all = TRUE;
  for (guint i = 0; i < regions->len; ++i)
    all &=
        cerberus_buffer_add_region(buffer, static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i)));
  return all;
}

gboolean cerberus_buffer_regions_known(GstBuffer* buffer) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), FALSE);
  return KnownMeta::peek(buffer) != nullptr;
}

GPtrArray* cerberus_buffer_get_regions(GstBuffer* buffer) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), nullptr);
  GPtrArray* regions = g_ptr_array_new_with_free_func(reinterpret_cast<GDestroyNotify>(cerberus_region_free));
  gpointer state = nullptr;
  if (!cerberus_buffer_regions_known(buffer)) return regions;
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
