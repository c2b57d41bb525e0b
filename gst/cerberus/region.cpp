// SPDX-License-Identifier: LGPL-2.1-or-later
// A region as a value: boxed, and written as a structure. On buffers: region-buffer.cpp.
#include <cerberus/region.h>

#include <cmath>

#include "cerberus/private/define.hpp"

namespace {

using Type = cerberus::Field::Type;
constexpr cerberus::Field kFields[] = {
    {"id", Type::count, offsetof(CerberusRegion, id)},
    {"tracked", Type::flag, offsetof(CerberusRegion, tracked)},
    {"person", Type::flag, offsetof(CerberusRegion, person)},
    {"motion", Type::flag, offsetof(CerberusRegion, motion)},
    {"kind", Type::nick, offsetof(CerberusRegion, kind), cerberus_region_kind_get_type},
    {"age", Type::time, offsetof(CerberusRegion, age)},
    {"state", Type::nick, offsetof(CerberusRegion, state), cerberus_region_state_get_type},
    {"x", Type::known, offsetof(CerberusRegion, x)},
    {"y", Type::known, offsetof(CerberusRegion, y)},
    {"width", Type::known, offsetof(CerberusRegion, width)},
    {"height", Type::known, offsetof(CerberusRegion, height)},
    {"confidence", Type::known, offsetof(CerberusRegion, confidence)},
    {"vx", Type::known, offsetof(CerberusRegion, vx)},
    {"vy", Type::known, offsetof(CerberusRegion, vy)},
    {"bearing", Type::known, offsetof(CerberusRegion, bearing)},
    {"distance", Type::known, offsetof(CerberusRegion, distance)},
};

// Part of the binary interface: fields take the place of the reserved ones. By hand, of structures of 64-bit systems, and of
// 32-bit ones that align numbers of 8 bytes to 8, as ARM does.
static_assert(alignof(CerberusRegion) != 8 ||
              (offsetof(CerberusRegion, motion) == 104 &&
               sizeof(CerberusRegion) == (sizeof(gpointer) == 8 ? 136 : 120)));

void moves_somewhere(CerberusRegion& region) {
  region.bearing = region.distance = NAN;
  region.motion = TRUE;
}

}  // namespace

CERBERUS_DEFINE_BOXED(CerberusRegion, cerberus_region, moves_somewhere)
CERBERUS_DEFINE_ENUM(CerberusRegionKind, cerberus_region_kind,
                     {CERBERUS_REGION_KIND_PERSON_LIKE, "CERBERUS_REGION_KIND_PERSON_LIKE", "person-like"},
                     {CERBERUS_REGION_KIND_GROUP, "CERBERUS_REGION_KIND_GROUP", "group"},
                     {CERBERUS_REGION_KIND_PART, "CERBERUS_REGION_KIND_PART", "part"},
                     {CERBERUS_REGION_KIND_THING, "CERBERUS_REGION_KIND_THING", "thing"})
CERBERUS_DEFINE_ENUM(CerberusRegionState, cerberus_region_state,
                     {CERBERUS_REGION_SEEN, "CERBERUS_REGION_SEEN", "seen"},
                     {CERBERUS_REGION_COASTED, "CERBERUS_REGION_COASTED", "coasted"},
                     {CERBERUS_REGION_STOPPED, "CERBERUS_REGION_STOPPED", "stopped"})

GstStructure* cerberus_region_to_structure(const CerberusRegion* region) {
  g_return_val_if_fail(region, nullptr);
  GstStructure* structure = gst_structure_new_empty(CERBERUS_REGION_STRUCTURE);
  cerberus::write_fields(structure, kFields, region);
  return structure;
}

CerberusRegion* cerberus_region_from_structure(const GstStructure* structure) {
  g_return_val_if_fail(structure, nullptr);
  if (!gst_structure_has_name(structure, CERBERUS_REGION_STRUCTURE)) return nullptr;
  CerberusRegion* region = cerberus_region_new();
  cerberus::read_known_fields(structure, kFields, region);
  return region;
}
