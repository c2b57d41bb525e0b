// SPDX-License-Identifier: LGPL-2.1-or-later
// Every question about GStreamer's version is asked here and nowhere else (1.22 of Debian 12 to 1.26 of
// Debian 13).
#pragma once

#include <gst/gst.h>

#include <type_traits>
#include <utility>

#include "publish/packing.h"

// HAVE_ANALYTICS comes from the build when plugins-bad's analytics library is there.
#if defined(HAVE_ANALYTICS) && GST_CHECK_VERSION(1, 24, 0)
#define CERBERUS_ANALYTICS 1
#else
#define CERBERUS_ANALYTICS 0
#endif

namespace cerberus {

// Registers a meta. Where `Packing` is not void and GStreamer can send metas to another process (1.24), it packs and
// unpacks them:
//   static void pack(const GstMeta* meta, publish::Packer& to), made with frame_time(meta);
//   static GstMeta* unpack(GstBuffer* buffer, publish::Unpacker& from), nullptr: `from` is not complete, or refused.
template <typename Packing>
const GstMetaInfo* register_meta_info(GType api, const char* name, gsize size, GstMetaInitFunction init,
                                      GstMetaFreeFunction free, GstMetaTransformFunction transform) {
#if GST_CHECK_VERSION(1, 24, 0)
  GstMetaInfo* info = gst_meta_info_new(api, name, size);
  info->init_func = init;
  info->free_func = free;
  info->transform_func = transform;
  if constexpr (!std::is_void_v<Packing>) {
    info->serialize_func = [](const GstMeta* meta, GstByteArrayInterface* to, guint8* version) -> gboolean {
      std::array<std::byte, publish::kMostPacked> room;
      publish::Packer packer(room, Packing::frame_time(meta));
      Packing::pack(meta, packer);
      *version = publish::kPackedVersion;
      return packer.complete() &&
             gst_byte_array_interface_append_data(to, reinterpret_cast<const guint8*>(packer.bytes().data()),
                                                  packer.bytes().size());
    };
    info->deserialize_func = [](const GstMetaInfo*, GstBuffer* buffer, const guint8* data, gsize bytes,
                                guint8 version) {
      publish::Unpacker from(std::as_bytes(std::span(data, bytes)), version, GST_BUFFER_PTS(buffer),
                             g_intern_string);
      return Packing::unpack(buffer, from);
    };
  }
  return gst_meta_info_register(info);
#else
  if constexpr (!std::is_void_v<Packing>) {  // compiled all the same
    constexpr auto kUnused = std::pair(&Packing::pack, &Packing::unpack);
    static_cast<void>(kUnused);
  }
  return gst_meta_register(api, name, size, init, free, transform);
#endif
}

}  // namespace cerberus
