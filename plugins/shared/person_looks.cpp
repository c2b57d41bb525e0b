// SPDX-License-Identifier: LGPL-2.1-or-later
#include "person_looks.hpp"

#include "shared_meta.hpp"

namespace cerberus::plugin {
namespace {

constexpr char kQuery[] = "cerberus-looks", kTaken[] = "taken";

struct LooksKind {
  using Value = PersonLooks;
  static constexpr char kApi[] = "CerberusPersonLooksMetaAPI", kName[] = "CerberusPersonLooksMeta";

  static void rescale(PersonLooks& looks, const Rescaling& sizes) {
    const double across = static_cast<double>(sizes.to.width) / sizes.from.width;
    const double down = static_cast<double>(sizes.to.height) / sizes.from.height;
    for (vision::PersonDetection& body : looks.bodies)
      body.box = {body.box.x * across, body.box.y * down, body.box.width * across, body.box.height * down};
  }
};

}  // namespace

const PersonLooks* person_looks_of(GstBuffer* buffer) {
  return PictureMeta<LooksKind>::find(buffer);
}

void set_person_looks(GstBuffer* buffer, const PersonLooks& looks) {
  PictureMeta<LooksKind>::set(buffer, looks);
}

bool tracker_takes_looks(GstPad* srcpad) {
  g_autoptr(GstQuery) query = gst_query_new_custom(
      GST_QUERY_CUSTOM, gst_structure_new(kQuery, kTaken, G_TYPE_BOOLEAN, FALSE, nullptr));
  gboolean taken = FALSE;
  gst_pad_peer_query(srcpad, query);
  gst_structure_get_boolean(gst_query_get_structure(query), kTaken, &taken);
  return taken;
}

bool is_looks_query(GstQuery* query) {
  const GstStructure* structure = gst_query_get_structure(query);
  return GST_QUERY_TYPE(query) == GST_QUERY_CUSTOM && structure && gst_structure_has_name(structure, kQuery);
}

void accept_looks_query(GstQuery* query) {
  gst_structure_set(gst_query_writable_structure(query), kTaken, G_TYPE_BOOLEAN, TRUE, nullptr);
}

}  // namespace cerberus::plugin
