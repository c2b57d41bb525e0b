// SPDX-License-Identifier: LGPL-2.1-or-later
// Private metas that several loadable modules of a process read and write.
#pragma once

#include <gst/gst.h>
#include <gst/video/video.h>

#include <new>

#include "cerberus/private/meta.hpp"

namespace cerberus::plugin {

// Each of the modules has a copy of the calling source file: the one that comes first registers, under the lock of an
// object that all of them share.
template <typename Meta, typename... Tags>
const GstMetaInfo* register_shared_meta(const char* api, const char* name, GstMetaInitFunction init,
                                        GstMetaFreeFunction free, MetaTransform transform, Tags... tags) {
  GstRegistry* shared = gst_registry_get();
  GST_OBJECT_LOCK(shared);
  const GstMetaInfo* info = gst_meta_get_info(name);
  if (!info) info = register_meta<Meta>(register_meta_api(api, tags...), name, init, free, transform);
  GST_OBJECT_UNLOCK(shared);
  return info;
}

// A private meta of one picture, at most one a buffer: it follows the picture through copying, converting and scaling, and is
// lost where that is cropped. Kind names what it carries: the type Value, kApi, kName, and
// void rescale(Value&, const Rescaling&), which brings it to another size.
template <typename Kind>
class PictureMeta {
 public:
  using Value = typename Kind::Value;

  // nullptr: there is none. It lives as long as the buffer's meta.
  static const Value* find(GstBuffer* buffer) {
    GstMeta* meta = gst_buffer_get_meta(buffer, info()->api);
    return meta && of(meta).crop == crop_of(buffer) ? &of(meta).value : nullptr;
  }
  // Removes what is there, if any. `buffer` is writable.
  static void remove(GstBuffer* buffer) {
    if (GstMeta* old = gst_buffer_get_meta(buffer, info()->api)) gst_buffer_remove_meta(buffer, old);
  }
  // Attaches it in place of what is there. `buffer` is writable.
  static void set(GstBuffer* buffer, const Value& value) {
    remove(buffer);
    GstMeta* meta = gst_buffer_add_meta(buffer, info(), nullptr);
    if (!meta) return;
    of(meta).crop = crop_of(buffer);
    of(meta).value = value;
  }

 private:
  struct Meta {
    GstMeta meta;
    Crop crop;  // of the buffer when it was attached
    Value value;
  };
  static Meta& of(GstMeta* meta) { return *reinterpret_cast<Meta*>(meta); }

  static gboolean init(GstMeta* meta, gpointer, GstBuffer*) {
    ::new (&of(meta).value) Value();
    return TRUE;
  }
  static void free(GstMeta* meta, GstBuffer*) { of(meta).value.~Value(); }
  static gboolean transform(GstBuffer* to, GstMeta* meta, GstBuffer*, GQuark type, gpointer data) {
    const auto sizes = rescaling(type, data);
    if (!sizes) return FALSE;
    Value value = of(meta).value;
    Kind::rescale(value, *sizes);
    set(to, value);
    return TRUE;
  }
  static const GstMetaInfo* info() {
    static const GstMetaInfo* const registered = register_shared_meta<Meta>(
        Kind::kApi, Kind::kName, init, free, transform, GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_SIZE_STR);
    return registered;
  }
};

}  // namespace cerberus::plugin
