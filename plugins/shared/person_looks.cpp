// SPDX-License-Identifier: LGPL-2.1-or-later
#include "person_looks.hpp"

#include <gst/video/video.h>

#include <new>

#include "shared_meta.hpp"

namespace cerberus::plugin {
namespace {

constexpr char kQuery[] = "cerberus-looks", kTaken[] = "taken";

struct LooksMeta {
  GstMeta meta;
  Crop crop;  // of the buffer when they were attached
  PersonLooks looks;
};

LooksMeta& looks_in(GstMeta* meta) {
  return *reinterpret_cast<LooksMeta*>(meta);
}

gboolean transform_looks(GstBuffer* to, GstMeta* meta, GstBuffer*, GQuark type, gpointer data) {
  const auto sizes = rescaling(type, data);
  if (!sizes) return FALSE;
  PersonLooks looks = looks_in(meta).looks;
  const double across = static_cast<double>(sizes->to.width) / sizes->from.width;
  const double down = static_cast<double>(sizes->to.height) / sizes->from.height;
  for (vision::PersonDetection& body : looks.bodies)
    body.box = {body.box.x * across, body.box.y * down, body.box.width * across, body.box.height * down};
  set_person_looks(to, looks);
  return TRUE;
}

const GstMetaInfo* looks_info() {
  static const GstMetaInfo* const info = register_shared_meta<LooksMeta>(
      "CerberusPersonLooksMetaAPI", "CerberusPersonLooksMeta",
      [](GstMeta* meta, gpointer, GstBuffer*) -> gboolean {
        ::new (&looks_in(meta).looks) PersonLooks();
        return TRUE;
      },
      [](GstMeta* meta, GstBuffer*) { looks_in(meta).looks.~PersonLooks(); }, transform_looks,
      GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_SIZE_STR);
  return info;
}

}  // namespace

const PersonLooks* person_looks_of(GstBuffer* buffer) {
  GstMeta* meta = gst_buffer_get_meta(buffer, looks_info()->api);
  return meta && looks_in(meta).crop == crop_of(buffer) ? &looks_in(meta).looks : nullptr;
}

void set_person_looks(GstBuffer* buffer, const PersonLooks& looks) {
  if (GstMeta* old = gst_buffer_get_meta(buffer, looks_info()->api)) gst_buffer_remove_meta(buffer, old);
  GstMeta* meta = gst_buffer_add_meta(buffer, looks_info(), nullptr);
  if (!meta) return;
  looks_in(meta).crop = crop_of(buffer);
  looks_in(meta).looks = looks;
}

bool tracker_takes_looks(GstPad* srcpad) {
  g_autoptr(GstQuery) query = gst_query_new_custom(
      GST_QUERY_CUSTOM, gst_structure_new(kQuery, kTaken, G_TYPE_BOOLEAN, FALSE, nullptr));
  gboolean taken = FALSE;
  gst_pad_peer_query(srcpad, query);
  gst_structure_get_boolean(gst_query_get_structure(query), kTaken, &taken);
  return taken;
}

bool is_looks_query(GstQuery* query) {
  const GstStructure* structure = gst_query_get_structure(query);
  return GST_QUERY_TYPE(query) == GST_QUERY_CUSTOM && structure && gst_structure_has_name(structure, kQuery);
}

void accept_looks_query(GstQuery* query) {
  gst_structure_set(gst_query_writable_structure(query), kTaken, G_TYPE_BOOLEAN, TRUE, nullptr);
}

}  // namespace cerberus::plugin
