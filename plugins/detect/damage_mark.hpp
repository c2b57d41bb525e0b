// SPDX-License-Identifier: LGPL-2.1-or-later
// The mark of frames that decode to damaged pictures: a custom meta without tags, which decoders copy from the encoded
// frame to its picture, and converters from picture to picture.
#pragma once

#include <gst/gst.h>

namespace cerberus::plugin {

inline const char* damage_mark() {
  static const GstMetaInfo* const info = [] {
    const char* tags[] = {nullptr};
    return gst_meta_register_custom("CerberusDamagedPicture", tags, nullptr, nullptr, nullptr);
  }();
  return info ? "CerberusDamagedPicture" : nullptr;
}

inline void mark_damaged(GstBuffer* buffer) {
  if (const char* name = damage_mark()) gst_buffer_add_custom_meta(buffer, name);
}

inline bool is_damaged(GstBuffer* buffer) {
  const char* const name = damage_mark();
  return name && gst_buffer_get_custom_meta(buffer, name);
}

}  // namespace cerberus::plugin
