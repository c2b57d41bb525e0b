// SPDX-License-Identifier: LGPL-2.1-or-later
// What the metas share. A meta without a transform function vanishes from every copied buffer, so registering one
// without is not possible here.
#pragma once

#include <gst/video/video.h>

#include <array>
#include <optional>

#include "cerberus/private/compat.hpp"
#include "vision/image/image.h"

namespace cerberus {

using MetaTransform = gboolean (*)(GstBuffer* to, GstMeta* meta, GstBuffer* from, GQuark type, gpointer data);

// `Packing`: see register_meta_info(); void: the meta stays in this process.
template <typename Meta, typename Packing = void>
const GstMetaInfo* register_meta(GType api, const char* name, GstMetaInitFunction init,
                                 GstMetaFreeFunction free, MetaTransform transform) {
  return register_meta_info<Packing>(api, name, sizeof(Meta), init, free, transform);
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

// The part of the memory that is the picture, where a crop in place (`videocrop` before a sink that crops) has written
// it on the buffer. No transform function is called then.
using Crop = std::array<guint, 4>;  // x, y, width, height
inline Crop crop_of(GstBuffer* buffer) {
  const GstVideoCropMeta* crop = gst_buffer_get_video_crop_meta(buffer);
  return crop ? Crop{crop->x, crop->y, crop->width, crop->height} : Crop{};
}

// A meta that carries one plain C structure, at most one a buffer. kInit sets its empty value; kInfo: the meta's
// info, which comes from register_as(). kInPixels: true of one picture only, so that a later crop in place removes it.
// Its fields are named by `template <typename Archive> void exchange(Archive&, Value&)` beside the structure.
template <typename Value, void (*kInit)(Value*), const GstMetaInfo* (*kInfo)(), bool kInPixels>
class ValueMeta {
  struct Meta {
    GstMeta meta;
    Value value;
    Crop crop;  // of the buffer when it was attached
    GstClockTime
        frame_time;  // of the buffer then: its timestamp, the running time of a segment that begins at 0
  };

 public:
  // Without a transform function: true of the moment, whatever is done to the picture.
  static const GstMetaInfo* register_as(GType api, const char* name, MetaTransform transform) {
    return register_meta<Meta, ValueMeta>(api, name, init, nullptr, transform ? transform : carry_over);
  }
  static Value& value_of(GstMeta* meta) { return reinterpret_cast<Meta*>(meta)->value; }

  // nullptr: there is none.
  static const Value* peek(GstBuffer* buffer) {
    GstMeta* meta = gst_buffer_get_meta(buffer, kInfo()->api);
    if (!meta || (kInPixels && reinterpret_cast<Meta*>(meta)->crop != crop_of(buffer))) return nullptr;
    return &value_of(meta);
  }
  // nullptr removes. False: it cannot be done.
  static gboolean set(GstBuffer* buffer, const Value* value) {
    if (!gst_buffer_is_writable(buffer)) return FALSE;
    GstMeta* meta = gst_buffer_get_meta(buffer, kInfo()->api);
    if (!value) return !meta || gst_buffer_remove_meta(buffer, meta);
    if (meta && kInPixels && reinterpret_cast<Meta*>(meta)->crop != crop_of(buffer)) {
      const Value copy = *value;  // a copy of the buffer takes its metas in turn: the crop's is to come first
      return gst_buffer_remove_meta(buffer, meta) && set(buffer, &copy);
    }
    if (!meta && !(meta = gst_buffer_add_meta(buffer, kInfo(), nullptr))) return FALSE;
    value_of(meta) = *value;
    reinterpret_cast<Meta*>(meta)->crop = crop_of(buffer);
    reinterpret_cast<Meta*>(meta)->frame_time = GST_BUFFER_PTS(buffer);
    return TRUE;
  }

  // Across processes.
  static GstClockTime frame_time(const GstMeta* meta) {
    return reinterpret_cast<const Meta*>(meta)->frame_time;
  }
  static void pack(const GstMeta* meta, publish::Packer& to) {
    Value value = reinterpret_cast<const Meta*>(meta)->value;
    exchange(to, value);
  }
  static GstMeta* unpack(GstBuffer* buffer, publish::Unpacker& from) {
    Value value;
    kInit(&value);
    exchange(from, value);
    return from.complete() && set(buffer, &value) ? gst_buffer_get_meta(buffer, kInfo()->api) : nullptr;
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
