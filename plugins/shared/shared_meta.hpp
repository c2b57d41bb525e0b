// SPDX-License-Identifier: LGPL-2.1-or-later
// Private metas that several loadable modules of a process read and write.
#pragma once

#include <gst/gst.h>

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

}  // namespace cerberus::plugin
