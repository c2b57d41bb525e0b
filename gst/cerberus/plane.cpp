// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/plane.h>
#include <gst/video/video.h>

#include <utility>

#include "private/meta.hpp"

namespace {

gboolean meta_init(GstMeta* meta, gpointer, GstBuffer*) {
  auto* plane = reinterpret_cast<CerberusPlaneMeta*>(meta);
  plane->kind = CERBERUS_PLANE_LUMA;
  plane->buffer = nullptr;
  plane->width = plane->height = plane->stride = 0;
  return TRUE;
}

void drop(CerberusPlaneMeta* plane) {
  if (GstBuffer* buffer = std::exchange(plane->buffer, nullptr)) gst_buffer_unref(buffer);
}

void meta_free(GstMeta* meta, GstBuffer*) {
  drop(reinterpret_cast<CerberusPlaneMeta*>(meta));
}

// A reference to the same samples, and only where the whole frame is copied: a part of it is another picture.
gboolean meta_transform(GstBuffer* to, GstMeta* meta, GstBuffer*, GQuark type, gpointer data) {
  if (!GST_META_TRANSFORM_IS_COPY(type) || static_cast<GstMetaTransformCopy*>(data)->region) return FALSE;
  const auto* plane = reinterpret_cast<CerberusPlaneMeta*>(meta);
  return cerberus_buffer_add_plane_meta(to, plane->kind, gst_buffer_ref(plane->buffer), plane->width,
                                        plane->height, plane->stride) != nullptr;
}

bool is_sane(GstBuffer* plane, gint sample_size, gint width, gint height, gint stride) {
  if (sample_size == 0 || width <= 0 || height <= 0) return false;
  const gint64 row = gint64{width} * sample_size;
  return stride >= row && stride % sample_size == 0 &&
         gint64{stride} * (height - 1) + row <= static_cast<gint64>(gst_buffer_get_size(plane));
}

}  // namespace

GType cerberus_plane_kind_get_type(void) {
  static const GType type = [] {
    static const GEnumValue values[] = {
        {CERBERUS_PLANE_LUMA, "CERBERUS_PLANE_LUMA", "luma"},
        {CERBERUS_PLANE_DIFFERENCE, "CERBERUS_PLANE_DIFFERENCE", "difference"},
        {CERBERUS_PLANE_PREVIOUS_DIFFERENCE, "CERBERUS_PLANE_PREVIOUS_DIFFERENCE", "previous-difference"},
        {CERBERUS_PLANE_HISTOGRAM, "CERBERUS_PLANE_HISTOGRAM", "histogram"},
        {CERBERUS_PLANE_MASK, "CERBERUS_PLANE_MASK", "mask"},
        {CERBERUS_PLANE_LABELS, "CERBERUS_PLANE_LABELS", "labels"},
        {0, nullptr, nullptr},
    };
    return g_enum_register_static("CerberusPlaneKind", values);
  }();
  return type;
}

GType cerberus_plane_meta_api_get_type(void) {
  static const GType type =
      cerberus::register_meta_api("CerberusPlaneMetaAPI", GST_META_TAG_VIDEO_STR, GST_META_TAG_MEMORY_STR);
  return type;
}

const GstMetaInfo* cerberus_plane_meta_get_info(void) {
  static const GstMetaInfo* const info = cerberus::register_meta<CerberusPlaneMeta>(
      CERBERUS_PLANE_META_API_TYPE, "CerberusPlaneMeta", meta_init, meta_free, meta_transform);
  return info;
}

gint cerberus_plane_kind_sample_size(CerberusPlaneKind kind) {
  switch (kind) {
    case CERBERUS_PLANE_LUMA:
    case CERBERUS_PLANE_DIFFERENCE:
    case CERBERUS_PLANE_PREVIOUS_DIFFERENCE:
    case CERBERUS_PLANE_MASK:
      return 1;
    case CERBERUS_PLANE_LABELS:
      return 2;
    case CERBERUS_PLANE_HISTOGRAM:
      return 4;
  }
  return 0;
}

CerberusPlaneMeta* cerberus_buffer_add_plane_meta(GstBuffer* buffer, CerberusPlaneKind kind, GstBuffer* plane,
                                                  gint width, gint height, gint stride) {
  g_return_val_if_fail(GST_IS_BUFFER(plane), nullptr);
  g_autoptr(GstBuffer) owned = plane;
  g_return_val_if_fail(GST_IS_BUFFER(buffer), nullptr);
  g_return_val_if_fail(gst_buffer_is_writable(buffer), nullptr);
  g_return_val_if_fail(is_sane(plane, cerberus_plane_kind_sample_size(kind), width, height, stride), nullptr);

  CerberusPlaneMeta* meta = cerberus_buffer_get_plane_meta(buffer, kind);
  if (!meta)
    meta =
        reinterpret_cast<CerberusPlaneMeta*>(gst_buffer_add_meta(buffer, CERBERUS_PLANE_META_INFO, nullptr));
  drop(meta);
  meta->kind = kind;
  meta->buffer = std::exchange(owned, nullptr);
  meta->width = width;
  meta->height = height;
  meta->stride = stride;
  return meta;
}

CerberusPlaneMeta* cerberus_buffer_get_plane_meta(GstBuffer* buffer, CerberusPlaneKind kind) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), nullptr);
  gpointer state = nullptr;
  while (GstMeta* meta = gst_buffer_iterate_meta_filtered(buffer, &state, CERBERUS_PLANE_META_API_TYPE)) {
    auto* plane = reinterpret_cast<CerberusPlaneMeta*>(meta);
    if (plane->kind == kind) return plane;
  }
  return nullptr;
}

GstBuffer* cerberus_buffer_get_plane(GstBuffer* buffer, CerberusPlaneKind kind, gint* width, gint* height,
                                     gint* stride) {
  const CerberusPlaneMeta* meta = cerberus_buffer_get_plane_meta(buffer, kind);
  if (width) *width = meta ? meta->width : 0;
  if (height) *height = meta ? meta->height : 0;
  if (stride) *stride = meta ? meta->stride : 0;
  return meta ? gst_buffer_ref(meta->buffer) : nullptr;
}

void cerberus_buffer_remove_plane_metas(GstBuffer* buffer) {
  g_return_if_fail(GST_IS_BUFFER(buffer));
  g_return_if_fail(gst_buffer_is_writable(buffer));
  while (GstMeta* meta = gst_buffer_get_meta(buffer, CERBERUS_PLANE_META_API_TYPE))
    gst_buffer_remove_meta(buffer, meta);
}
