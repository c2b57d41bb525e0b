// SPDX-License-Identifier: LGPL-2.1-or-later
// A region as a value: boxed, and written as a structure. On buffers: region-buffer.cpp.
#include <cerberus/region.h>

#include <cmath>
#include <initializer_list>
#include <limits>

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

constexpr CerberusRegion kEmpty = {
    .id = 0,
    .tracked = FALSE,
    .person = FALSE,
    .kind = CERBERUS_REGION_KIND_PERSON_LIKE,
    .x = 0,
    .y = 0,
    .width = 0,
    .height = 0,
    .confidence = 0,
    .vx = 0,
    .vy = 0,
    .age = 0,
    .state = CERBERUS_REGION_SEEN,
    .bearing = kUnknown,
    .distance = kUnknown,
    ._cerberus_reserved = {},
};

struct Field {
  const char* name;
  double CerberusRegion::* member;
};
constexpr Field kNumbers[] = {
    {"x", &CerberusRegion::x},
    {"y", &CerberusRegion::y},
    {"width", &CerberusRegion::width},
    {"height", &CerberusRegion::height},
    {"confidence", &CerberusRegion::confidence},
    {"vx", &CerberusRegion::vx},
    {"vy", &CerberusRegion::vy},
    {"bearing", &CerberusRegion::bearing},
    {"distance", &CerberusRegion::distance},
};

// False where the structure is not a `cerberus-object`. A stranger may have written it: types and enums are
// checked.
bool read(const GstStructure* structure, CerberusRegion& region) {
  if (!gst_structure_has_name(structure, CERBERUS_REGION_STRUCTURE)) return false;
  region = kEmpty;
  gst_structure_get(structure, "id", G_TYPE_UINT, &region.id, nullptr);
  gst_structure_get_boolean(structure, "tracked", &region.tracked);
  gst_structure_get_boolean(structure, "person", &region.person);
  gst_structure_get_clock_time(structure, "age", &region.age);
  for (const Field& field : kNumbers)
    gst_structure_get_double(structure, field.name, &(region.*field.member));
  const gchar* kind = gst_structure_get_string(structure, "kind");
  for (const auto k : {CERBERUS_REGION_KIND_GROUP, CERBERUS_REGION_KIND_PART, CERBERUS_REGION_KIND_THING})
    if (g_strcmp0(kind, cerberus_region_kind_to_string(k)) == 0) region.kind = k;
  const gchar* state = gst_structure_get_string(structure, "state");
  for (const auto s : {CERBERUS_REGION_SEEN, CERBERUS_REGION_COASTED, CERBERUS_REGION_STOPPED})
    if (g_strcmp0(state, cerberus_region_state_to_string(s)) == 0) region.state = s;
  return true;
}

}  // namespace

G_DEFINE_BOXED_TYPE(CerberusRegion, cerberus_region, cerberus_region_copy, cerberus_region_free)

GType cerberus_region_kind_get_type(void) {
  static const GType type = [] {
    static const GEnumValue values[] = {
        {CERBERUS_REGION_KIND_PERSON_LIKE, "CERBERUS_REGION_KIND_PERSON_LIKE", "person-like"},
        {CERBERUS_REGION_KIND_GROUP, "CERBERUS_REGION_KIND_GROUP", "group"},
        {CERBERUS_REGION_KIND_PART, "CERBERUS_REGION_KIND_PART", "part"},
        {CERBERUS_REGION_KIND_THING, "CERBERUS_REGION_KIND_THING", "thing"},
        {0, nullptr, nullptr},
    };
    return g_enum_register_static("CerberusRegionKind", values);
  }();
  return type;
}

GType cerberus_region_state_get_type(void) {
  static const GType type = [] {
    static const GEnumValue values[] = {
        {CERBERUS_REGION_SEEN, "CERBERUS_REGION_SEEN", "seen"},
        {CERBERUS_REGION_COASTED, "CERBERUS_REGION_COASTED", "coasted"},
        {CERBERUS_REGION_STOPPED, "CERBERUS_REGION_STOPPED", "stopped"},
        {0, nullptr, nullptr},
    };
    return g_enum_register_static("CerberusRegionState", values);
  }();
  return type;
}

void cerberus_region_init(CerberusRegion* region) {
  g_return_if_fail(region);
  *region = kEmpty;
}

CerberusRegion* cerberus_region_new(void) {
  return cerberus_region_copy(&kEmpty);
}

CerberusRegion* cerberus_region_copy(const CerberusRegion* region) {
  return static_cast<CerberusRegion*>(g_memdup2(region, sizeof *region));
}

void cerberus_region_free(CerberusRegion* region) {
  g_free(region);
}

const gchar* cerberus_region_kind_to_string(CerberusRegionKind kind) {
  static constexpr const gchar* kNames[] = {"person-like", "group", "part", "thing"};
  return kNames[kind >= 0 && kind < G_N_ELEMENTS(kNames) ? kind : CERBERUS_REGION_KIND_PERSON_LIKE];
}

const gchar* cerberus_region_state_to_string(CerberusRegionState state) {
  switch (state) {
    case CERBERUS_REGION_COASTED:
      return "coasted";
    case CERBERUS_REGION_STOPPED:
      return "stopped";
    case CERBERUS_REGION_SEEN:
      break;
  }
  return "seen";
}

GstStructure* cerberus_region_to_structure(const CerberusRegion* region) {
  g_return_val_if_fail(region, nullptr);
  GstStructure* structure = gst_structure_new(
      CERBERUS_REGION_STRUCTURE, "id", G_TYPE_UINT, region->id, "tracked", G_TYPE_BOOLEAN,
      region->tracked != FALSE, "person", G_TYPE_BOOLEAN, region->person != FALSE, "kind", G_TYPE_STRING,
      cerberus_region_kind_to_string(region->kind), "age", GST_TYPE_CLOCK_TIME, region->age, "state",
      G_TYPE_STRING, cerberus_region_state_to_string(region->state), nullptr);
  for (const Field& field : kNumbers) {
    const double value = region->*field.member;
    if (std::isfinite(value)) gst_structure_set(structure, field.name, G_TYPE_DOUBLE, value, nullptr);
  }
  return structure;
}

CerberusRegion* cerberus_region_from_structure(const GstStructure* structure) {
  g_return_val_if_fail(structure, nullptr);
  CerberusRegion region;
  return read(structure, region) ? cerberus_region_copy(&region) : nullptr;
}
