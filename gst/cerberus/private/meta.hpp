// SPDX-License-Identifier: LGPL-2.1-or-later
// What the metas share. A meta without a transform function vanishes from every copied buffer, so registering one
// without is not possible here.
#pragma once

#include <gst/gst.h>

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

// A meta that carries one plain C structure, at most one a buffer. kValue: the member of the meta that it is; kInit
// sets its empty value; kInfo: the meta's info, which comes from register_as().
template <auto kValue, auto kInit, const GstMetaInfo* (*kInfo)()>
class ValueMeta;

template <typename Meta, typename Value, Value Meta::* kValue, void (*kInit)(Value*),
          const GstMetaInfo* (*kInfo)()>
class ValueMeta<kValue, kInit, kInfo> {
 public:
  // Without a transform function: true of the moment, whatever is done to the picture.
  static const GstMetaInfo* register_as(GType api, const char* name, MetaTransform transform = carry_over) {
    return register_meta<Meta>(api, name, init, nullptr, transform);
  }
  static Value& value_of(GstMeta* meta) { return reinterpret_cast<Meta*>(meta)->*kValue; }

  // nullptr: there is none.
  static Meta* find(GstBuffer* buffer) {
    return reinterpret_cast<Meta*>(gst_buffer_get_meta(buffer, kInfo()->api));
  }
  static const Value* peek(GstBuffer* buffer) {
    Meta* meta = find(buffer);
    return meta ? &(meta->*kValue) : nullptr;
  }
  // `buffer` is writable.
  static Meta* put(GstBuffer* buffer, const Value& value) {
    Meta* meta = find(buffer);
    if (!meta) meta = reinterpret_cast<Meta*>(gst_buffer_add_meta(buffer, kInfo(), nullptr));
    if (meta) meta->*kValue = value;
    return meta;
  }
  // The form for bindings; nullptr removes. False: it cannot be done.
  static gboolean set(GstBuffer* buffer, const Value* value) {
    if (!gst_buffer_is_writable(buffer)) return FALSE;
    if (value) return put(buffer, *value) != nullptr;
    if (Meta* meta = find(buffer)) gst_buffer_remove_meta(buffer, reinterpret_cast<GstMeta*>(meta));
    return TRUE;
  }

 private:
  static gboolean init(GstMeta* meta, gpointer, GstBuffer*) {
    kInit(&value_of(meta));
    return TRUE;
  }
  static gboolean carry_over(GstBuffer* to, GstMeta* meta, GstBuffer*, GQuark, gpointer) {
    return put(to, value_of(meta)) != nullptr;
  }
};

}  // namespace cerberus
