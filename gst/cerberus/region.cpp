// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/region.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "private/analytics.hpp"

namespace {

constexpr char kMotion[] = "motion";
constexpr char kPerson[] = "person";
constexpr char kDetection[] = "detection";
constexpr char kObjectId[] = "object_id";
constexpr char kOurs[] = "cerberus-object";
constexpr char kAnalytics[] =
    "analytics";  // in the params only: how many analytics entries stand for the region

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

constexpr CerberusRegion kEmpty = {
    .id = 0,
    .tracked = FALSE,
    .person = FALSE,
    .x = 0,
    .y = 0,
    .width = 0,
    .height = 0,
    .confidence = 0,
    .vx = 0,
    .vy = 0,
    .age = 0,
    .state = CERBERUS_REGION_SEEN,
    .bearing = kUnknown,
    .distance = kUnknown,
    ._cerberus_reserved = {},
};

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

struct Field {
  const char* name;
  double CerberusRegion::* member;
};
constexpr Field kNumbers[] = {
    {"x", &CerberusRegion::x},
    {"y", &CerberusRegion::y},
    {"width", &CerberusRegion::width},
    {"height", &CerberusRegion::height},
    {"confidence", &CerberusRegion::confidence},
    {"vx", &CerberusRegion::vx},
    {"vy", &CerberusRegion::vy},
    {"bearing", &CerberusRegion::bearing},
    {"distance", &CerberusRegion::distance},
};

// False where the structure is not a `cerberus-object`. A stranger may have written it: types and enums are
// checked.
bool read(const GstStructure* structure, CerberusRegion& region) {
  if (!gst_structure_has_name(structure, kOurs)) return false;
  region = kEmpty;
  gst_structure_get(structure, "id", G_TYPE_UINT, &region.id, nullptr);
  gst_structure_get_boolean(structure, "tracked", &region.tracked);
  gst_structure_get_boolean(structure, "person", &region.person);
  gst_structure_get_clock_time(structure, "age", &region.age);
  for (const Field& field : kNumbers)
    gst_structure_get_double(structure, field.name, &(region.*field.member));
  const gchar* state = gst_structure_get_string(structure, "state");
  for (const auto s : {CERBERUS_REGION_SEEN, CERBERUS_REGION_COASTED, CERBERUS_REGION_STOPPED})
    if (g_strcmp0(state, cerberus_region_state_to_string(s)) == 0) region.state = s;
  return true;
}

// How far an edge moved when the picture was scaled. The far edge is taken: rounding weighs least there.
double scale_of(guint start, guint length, guint old_start, guint old_length) {
  return (static_cast<double>(start) + length) / (static_cast<double>(old_start) + old_length);
}

// The meta is what scaling elements keep right; the exact position in our params is used while both agree.
void follow(const GstVideoRegionOfInterestMeta& meta, CerberusRegion& region) {
  if (is_sane(region)) {
    const Pixels was = whole_pixels(region);
    if (was.x == meta.x && was.y == meta.y && was.width == meta.w && was.height == meta.h) return;
    region.vx *= scale_of(meta.x, meta.w, was.x, was.width);
    region.vy *= scale_of(meta.y, meta.h, was.y, was.height);
  }
  region.x = meta.x;
  region.y = meta.y;
  region.width = meta.w;
  region.height = meta.h;
}

const GstStructure* our_param(GstVideoRegionOfInterestMeta* meta) {
  return gst_video_region_of_interest_meta_get_param(meta, kOurs);
}

// How many entries of an analytics meta stand for our regions.
guint count_analytics(GstBuffer* buffer) {
  guint total = 0;
  gpointer state = nullptr;
  while (GstMeta* meta =
             gst_buffer_iterate_meta_filtered(buffer, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)) {
    guint count = 0;
    const GstStructure* ours = our_param(reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta));
    if (ours && gst_structure_get_uint(ours, kAnalytics, &count)) total += count;
  }
  return total;
}

}  // namespace

G_DEFINE_BOXED_TYPE(CerberusRegion, cerberus_region, cerberus_region_copy, cerberus_region_free)

GType cerberus_region_state_get_type(void) {
  static const GType type = [] {
    static const GEnumValue values[] = {
        {CERBERUS_REGION_SEEN, "CERBERUS_REGION_SEEN", "seen"},
        {CERBERUS_REGION_COASTED, "CERBERUS_REGION_COASTED", "coasted"},
        {CERBERUS_REGION_STOPPED, "CERBERUS_REGION_STOPPED", "stopped"},
        {0, nullptr, nullptr},
    };
    return g_enum_register_static("CerberusRegionState", values);
  }();
  return type;
}

void cerberus_region_init(CerberusRegion* region) {
  g_return_if_fail(region);
  *region = kEmpty;
}

CerberusRegion* cerberus_region_new(void) {
  return cerberus_region_copy(&kEmpty);
}

CerberusRegion* cerberus_region_copy(const CerberusRegion* region) {
  return static_cast<CerberusRegion*>(g_memdup2(region, sizeof *region));
}

void cerberus_region_free(CerberusRegion* region) {
  g_free(region);
}

const gchar* cerberus_region_state_to_string(CerberusRegionState state) {
  switch (state) {
    case CERBERUS_REGION_COASTED:
      return "coasted";
    case CERBERUS_REGION_STOPPED:
      return "stopped";
    case CERBERUS_REGION_SEEN:
      break;
  }
  return "seen";
}

GstStructure* cerberus_region_to_structure(const CerberusRegion* region) {
  g_return_val_if_fail(region, nullptr);
  GstStructure* structure = gst_structure_new(
      kOurs, "id", G_TYPE_UINT, region->id, "tracked", G_TYPE_BOOLEAN, region->tracked != FALSE, "person",
      G_TYPE_BOOLEAN, region->person != FALSE, "age", GST_TYPE_CLOCK_TIME, region->age, "state",
      G_TYPE_STRING, cerberus_region_state_to_string(region->state), nullptr);
  for (const Field& field : kNumbers) {
    const double value = region->*field.member;
    if (std::isfinite(value)) gst_structure_set(structure, field.name, G_TYPE_DOUBLE, value, nullptr);
  }
  return structure;
}

CerberusRegion* cerberus_region_from_structure(const GstStructure* structure) {
  g_return_val_if_fail(structure, nullptr);
  CerberusRegion region;
  return read(structure, region) ? cerberus_region_copy(&region) : nullptr;
}

gboolean cerberus_buffer_add_region(GstBuffer* buffer, const CerberusRegion* region) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), FALSE);
  g_return_val_if_fail(region, FALSE);
  if (!gst_buffer_is_writable(buffer) || !is_sane(*region)) return FALSE;

  const char* type = region->person ? kPerson : kMotion;
  const Pixels p = whole_pixels(*region);
  const guint analytics = cerberus::analytics::add(buffer,
                                                   {type, p.x, p.y, p.width, p.height, region->confidence,
                                                    region->tracked != FALSE, region->id, region->age},
                                                   count_analytics(buffer));

  GstVideoRegionOfInterestMeta* meta =
      gst_buffer_add_video_region_of_interest_meta(buffer, type, p.x, p.y, p.width, p.height);
  meta->id = static_cast<gint>(region->id);
  gst_video_region_of_interest_meta_add_param(
      meta, gst_structure_new(kDetection, "confidence", G_TYPE_DOUBLE, region->confidence, nullptr));
  if (region->tracked) {
    gst_video_region_of_interest_meta_add_param(
        meta, gst_structure_new(kObjectId, "id", G_TYPE_INT, static_cast<gint>(region->id), nullptr));
  }
  GstStructure* ours = cerberus_region_to_structure(region);
  if (analytics) gst_structure_set(ours, kAnalytics, G_TYPE_UINT, analytics, nullptr);
  gst_video_region_of_interest_meta_add_param(meta, ours);
  return TRUE;
}

GPtrArray* cerberus_buffer_get_regions(GstBuffer* buffer) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), nullptr);
  GPtrArray* regions = g_ptr_array_new_with_free_func(reinterpret_cast<GDestroyNotify>(cerberus_region_free));
  gpointer state = nullptr;
  while (GstMeta* meta =
             gst_buffer_iterate_meta_filtered(buffer, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)) {
    auto* roi = reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta);
    CerberusRegion region;
    const GstStructure* ours = our_param(roi);
    if (!ours || !read(ours, region)) continue;
    follow(*roi, region);
    g_ptr_array_add(regions, cerberus_region_copy(&region));
  }
  return regions;
}

void cerberus_buffer_remove_regions(GstBuffer* buffer) {
  g_return_if_fail(GST_IS_BUFFER(buffer));
  g_return_if_fail(gst_buffer_is_writable(buffer));
  cerberus::analytics::remove(buffer, count_analytics(buffer));
  gst_buffer_foreach_meta(
      buffer,
      [](GstBuffer*, GstMeta** meta, gpointer) -> gboolean {
        if ((*meta)->info->api == GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE &&
            our_param(reinterpret_cast<GstVideoRegionOfInterestMeta*>(*meta)))
          *meta = nullptr;
        return TRUE;
      },
      nullptr);
}
