// SPDX-License-Identifier: LGPL-2.1-or-later
// What the metas that carry one plain C structure share. A meta without a transform function vanishes from
// every copied buffer, so registering one without is not possible here.
#pragma once

#include <gst/gst.h>

namespace cerberus {

using MetaTransform = gboolean (*)(GstBuffer* to, GstMeta* meta, GstBuffer* from, GQuark type, gpointer data);

template <typename Meta>
const GstMetaInfo* register_meta(GType api, const char* name, GstMetaInitFunction init,
                                 GstMetaFreeFunction free, MetaTransform transform) {
  return gst_meta_register(api, name, sizeof(Meta), init, free, transform);
}

// The buffer's meta of `info`, or a new one where there is none: at most one a buffer.
template <typename Meta>
Meta* ensure_meta(GstBuffer* buffer, const GstMetaInfo* info) {
  GstMeta* meta = gst_buffer_get_meta(buffer, info->api);
  if (!meta) meta = gst_buffer_add_meta(buffer, info, nullptr);
  return reinterpret_cast<Meta*>(meta);
}

inline void remove_meta(GstBuffer* buffer, GType api) {
  if (GstMeta* meta = gst_buffer_get_meta(buffer, api)) gst_buffer_remove_meta(buffer, meta);
}

}  // namespace cerberus
