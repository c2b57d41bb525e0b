// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record.hpp"

#include <gst/video/video.h>

#include <new>
#include <utility>

#include "shared_meta.hpp"

namespace cerberus::plugin {
namespace {

constexpr char kQuery[] = "cerberus-record", kWanted[] = "wanted";

struct RecordMeta {
  GstMeta meta;
  vision::Record record;
};
struct FactsMeta {
  GstMeta meta;
  ThresholdFacts facts;
};

vision::Record& record_in(GstMeta* meta) {
  return reinterpret_cast<RecordMeta*>(meta)->record;
}

const GstMetaInfo* record_info() {
  static const GstMetaInfo* const info = register_shared_meta<RecordMeta>(
      "CerberusRecordMetaAPI", "CerberusRecordMeta",
      [](GstMeta* meta, gpointer, GstBuffer*) -> gboolean {
        ::new (&record_in(meta)) vision::Record();
        return TRUE;
      },
      [](GstMeta* meta, GstBuffer*) { record_in(meta).~Shared(); },
      // Another reference, and only where the whole frame is copied: a part of it is another picture.
      [](GstBuffer* to, GstMeta* meta, GstBuffer*, GQuark type, gpointer data) -> gboolean {
        if (!GST_META_TRANSFORM_IS_COPY(type) || static_cast<GstMetaTransformCopy*>(data)->region)
          return FALSE;
        set_record(to, record_in(meta));
        return TRUE;
      },
      GST_META_TAG_VIDEO_STR, GST_META_TAG_MEMORY_STR);
  return info;
}

const GstMetaInfo* facts_info() {
  static const GstMetaInfo* const info = register_shared_meta<FactsMeta>(
      "CerberusThresholdMetaAPI", "CerberusThresholdMeta",
      [](GstMeta* meta, gpointer, GstBuffer*) -> gboolean {
        reinterpret_cast<FactsMeta*>(meta)->facts = {};
        return TRUE;
      },
      nullptr,
      [](GstBuffer* to, GstMeta* meta, GstBuffer*, GQuark, gpointer) -> gboolean {
        set_threshold_facts(to, reinterpret_cast<FactsMeta*>(meta)->facts);
        return TRUE;
      },
      GST_META_TAG_VIDEO_STR);
  return info;
}

}  // namespace

vision::Record record_of(GstBuffer* buffer) {
  GstMeta* meta = gst_buffer_get_meta(buffer, record_info()->api);
  return meta ? record_in(meta) : vision::Record();
}

vision::Record record_of(GstBuffer* buffer, vision::Size frame) {
  vision::Record record = record_of(buffer);
  return record && record->frame == frame ? record : vision::Record();
}

void set_record(GstBuffer* buffer, vision::Record record) {
  GstMeta* meta = gst_buffer_get_meta(buffer, record_info()->api);
  if (!record) {
    if (meta) gst_buffer_remove_meta(buffer, meta);
    return;
  }
  if (!meta) meta = gst_buffer_add_meta(buffer, record_info(), nullptr);
  if (meta) record_in(meta) = std::move(record);
}

const ThresholdFacts* threshold_facts_of(GstBuffer* buffer) {
  GstMeta* meta = gst_buffer_get_meta(buffer, facts_info()->api);
  return meta ? &reinterpret_cast<FactsMeta*>(meta)->facts : nullptr;
}

void set_threshold_facts(GstBuffer* buffer, const ThresholdFacts& facts) {
  GstMeta* meta = gst_buffer_get_meta(buffer, facts_info()->api);
  if (!meta) meta = gst_buffer_add_meta(buffer, facts_info(), nullptr);
  if (meta) reinterpret_cast<FactsMeta*>(meta)->facts = facts;
}

guint ask_for_record(GstPad* srcpad) {
  g_autoptr(GstQuery) query =
      gst_query_new_custom(GST_QUERY_CUSTOM, gst_structure_new(kQuery, kWanted, G_TYPE_UINT, 0, nullptr));
  guint wanted = 0;
  gst_pad_peer_query(srcpad, query);
  gst_structure_get_uint(gst_query_get_structure(query), kWanted, &wanted);
  return wanted;
}

bool is_record_query(GstQuery* query) {
  const GstStructure* structure = gst_query_get_structure(query);
  return GST_QUERY_TYPE(query) == GST_QUERY_CUSTOM && structure && gst_structure_has_name(structure, kQuery);
}

void add_wanted(GstQuery* query, guint wanted) {
  guint before = 0;
  gst_structure_get_uint(gst_query_get_structure(query), kWanted, &before);
  gst_structure_set(gst_query_writable_structure(query), kWanted, G_TYPE_UINT, before | wanted, nullptr);
}

}  // namespace cerberus::plugin
