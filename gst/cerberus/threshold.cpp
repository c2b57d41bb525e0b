// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/threshold.h>
#include <gst/video/video.h>

#include "private/meta.hpp"

namespace {

gboolean meta_init(GstMeta* meta, gpointer, GstBuffer*) {
  reinterpret_cast<CerberusThresholdMeta*>(meta)->threshold = {};
  return TRUE;
}

// True of the moment, whatever is done to the picture.
gboolean meta_transform(GstBuffer* to, GstMeta* meta, GstBuffer*, GQuark, gpointer) {
  const CerberusThreshold& threshold = reinterpret_cast<CerberusThresholdMeta*>(meta)->threshold;
  return cerberus_buffer_add_threshold_meta(to, &threshold) != nullptr;
}

}  // namespace

G_DEFINE_BOXED_TYPE(CerberusThreshold, cerberus_threshold, cerberus_threshold_copy, cerberus_threshold_free)

GType cerberus_threshold_meta_api_get_type(void) {
  static const GType type = [] {
    const gchar* tags[] = {GST_META_TAG_VIDEO_STR, nullptr};
    return gst_meta_api_type_register("CerberusThresholdMetaAPI", tags);
  }();
  return type;
}

const GstMetaInfo* cerberus_threshold_meta_get_info(void) {
  static const GstMetaInfo* const info = cerberus::register_meta<CerberusThresholdMeta>(
      CERBERUS_THRESHOLD_META_API_TYPE, "CerberusThresholdMeta", meta_init, nullptr, meta_transform);
  return info;
}

CerberusThreshold* cerberus_threshold_new(void) {
  return g_new0(CerberusThreshold, 1);
}

CerberusThreshold* cerberus_threshold_copy(const CerberusThreshold* threshold) {
  return static_cast<CerberusThreshold*>(g_memdup2(threshold, sizeof *threshold));
}

void cerberus_threshold_free(CerberusThreshold* threshold) {
  g_free(threshold);
}

CerberusThresholdMeta* cerberus_buffer_add_threshold_meta(GstBuffer* buffer,
                                                          const CerberusThreshold* threshold) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), nullptr);
  g_return_val_if_fail(gst_buffer_is_writable(buffer), nullptr);
  g_return_val_if_fail(threshold, nullptr);
  auto* meta = cerberus::ensure_meta<CerberusThresholdMeta>(buffer, CERBERUS_THRESHOLD_META_INFO);
  meta->threshold = *threshold;
  return meta;
}

gboolean cerberus_buffer_set_threshold(GstBuffer* buffer, const CerberusThreshold* threshold) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), FALSE);
  if (!gst_buffer_is_writable(buffer)) return FALSE;
  if (threshold) return cerberus_buffer_add_threshold_meta(buffer, threshold) != nullptr;
  cerberus::remove_meta(buffer, CERBERUS_THRESHOLD_META_API_TYPE);
  return TRUE;
}

const CerberusThresholdMeta* cerberus_buffer_get_threshold_meta(GstBuffer* buffer) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), nullptr);
  return reinterpret_cast<CerberusThresholdMeta*>(
      gst_buffer_get_meta(buffer, CERBERUS_THRESHOLD_META_API_TYPE));
}

CerberusThreshold* cerberus_buffer_get_threshold(GstBuffer* buffer) {
  const CerberusThresholdMeta* meta = cerberus_buffer_get_threshold_meta(buffer);
  return meta ? cerberus_threshold_copy(&meta->threshold) : nullptr;
}
