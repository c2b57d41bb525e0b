// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/threshold.h>
#include <gst/video/video.h>

#include "private/meta.hpp"

namespace {

void init(CerberusThreshold* threshold) {
  *threshold = {};
}

using Carried =
    cerberus::ValueMeta<&CerberusThresholdMeta::threshold, init, cerberus_threshold_meta_get_info>;

}  // namespace

G_DEFINE_BOXED_TYPE(CerberusThreshold, cerberus_threshold, cerberus_threshold_copy, cerberus_threshold_free)

GType cerberus_threshold_meta_api_get_type(void) {
  static const GType type = cerberus::register_meta_api("CerberusThresholdMetaAPI", GST_META_TAG_VIDEO_STR);
  return type;
}

const GstMetaInfo* cerberus_threshold_meta_get_info(void) {
  static const GstMetaInfo* const info =
      Carried::register_as(CERBERUS_THRESHOLD_META_API_TYPE, "CerberusThresholdMeta");
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
  return Carried::put(buffer, *threshold);
}

gboolean cerberus_buffer_set_threshold(GstBuffer* buffer, const CerberusThreshold* threshold) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), FALSE);
  return Carried::set(buffer, threshold);
}

const CerberusThresholdMeta* cerberus_buffer_get_threshold_meta(GstBuffer* buffer) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), nullptr);
  return Carried::find(buffer);
}

CerberusThreshold* cerberus_buffer_get_threshold(GstBuffer* buffer) {
  const CerberusThresholdMeta* meta = cerberus_buffer_get_threshold_meta(buffer);
  return meta ? cerberus_threshold_copy(&meta->threshold) : nullptr;
}
