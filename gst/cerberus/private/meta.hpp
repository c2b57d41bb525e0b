// SPDX-License-Identifier: LGPL-2.1-or-later
// What the metas share. A meta without a transform function vanishes from every copied buffer, so registering one
// without is not possible here.
#pragma once

#include <gst/video/video.h>

#include <optional>

#include "vision/image/image.h"

namespace cerberus {

using MetaTransform = gboolean (*)(GstBuffer* to, GstMeta* meta, GstBuffer* from, GQuark type, gpointer data);

template <typename Meta>
const GstMetaInfo* register_meta(GType api, const char* name, GstMetaInitFunction init,
                                 GstMetaFreeFunction free, MetaTransform transform) {
  return gst_meta_register(api, name, sizeof(Meta), init, free, transform);
}

template <typename... Tags>
GType register_meta_api(const char* name, Tags... tags) {
  const gchar* all[] = {tags..., nullptr};
  return gst_meta_api_type_register(name, all);
}

// Sizes of the picture before and after what is done to it: equal for a copy. None: what is in pixels becomes wrong.
struct Rescaling {
  vision::Size from{1, 1}, to{1, 1};
};
inline std::optional<Rescaling> rescaling(GQuark type, gpointer data) {
  if (GST_META_TRANSFORM_IS_COPY(type)) return Rescaling{};
  if (!GST_VIDEO_META_TRANSFORM_IS_SCALE(type)) return std::nullopt;
  const auto size = [](const GstVideoInfo* info) {
    return vision::Size{GST_VIDEO_INFO_WIDTH(info), GST_VIDEO_INFO_HEIGHT(info)};
  };
  const auto* scale = static_cast<GstVideoMetaTransform*>(data);
  const Rescaling sizes{size(scale->in_info), size(scale->out_info)};
  if (sizes.from.area() <= 0 || sizes.to.area() <= 0) return std::nullopt;
  return sizes;
}

// A meta that carries one plain C structure, at most one a buffer. kInit sets its empty value; kInfo: the meta's
// info, which comes from register_as().
template <typename Value, void (*kInit)(Value*), const GstMetaInfo* (*kInfo)()>
class ValueMeta {
  struct Meta {
    GstMeta meta;
    Value value;
  };

 public:
  // Without a transform function: true of the moment, whatever is done to the picture.
  static const GstMetaInfo* register_as(GType api, const char* name, MetaTransform transform) {
    return register_meta<Meta>(api, name, init, nullptr, transform ? transform : carry_over);
  }
  static Value& value_of(GstMeta* meta) { return reinterpret_cast<Meta*>(meta)->value; }

  // nullptr: there is none.
  static const Value* peek(GstBuffer* buffer) {
    GstMeta* meta = gst_buffer_get_meta(buffer, kInfo()->api);
    return meta ? &value_of(meta) : nullptr;
  }
  // nullptr removes. False: it cannot be done.
  static gboolean set(GstBuffer* buffer, const Value* value) {
    if (!gst_buffer_is_writable(buffer)) return FALSE;
    GstMeta* meta = gst_buffer_get_meta(buffer, kInfo()->api);
    if (!value) return !meta || gst_buffer_remove_meta(buffer, meta);
    if (!meta) meta = gst_buffer_add_meta(buffer, kInfo(), nullptr);
    if (meta) value_of(meta) = *value;
    return meta != nullptr;
  }

 private:
  static gboolean init(GstMeta* meta, gpointer, GstBuffer*) {
    kInit(&value_of(meta));
    return TRUE;
  }
  static gboolean carry_over(GstBuffer* to, GstMeta* meta, GstBuffer*, GQuark, gpointer) {
    return set(to, &value_of(meta));
  }
};

}  // namespace cerberus
