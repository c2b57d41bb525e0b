// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/base.h>

#include "cerberus/private/define.hpp"

namespace {

using Type = cerberus::Field::Type;
constexpr cerberus::Field kFields[] = {
    {"yaw-rate", Type::angle, offsetof(CerberusBase, yaw_rate)},
    {"running-time", Type::time, offsetof(CerberusBase, valid_from)},
};

void unknown(CerberusBase& base) {
  base.valid_from = GST_CLOCK_TIME_NONE;
}

CerberusBase sane(CerberusBase base) {
  if (!cerberus::is_one_of(CERBERUS_TYPE_BASE_SOURCE, &base.source)) base.source = CERBERUS_BASE_ESTIMATED;
  return base;
}

void write(GstStructure* to, const CerberusBase& base) {
  cerberus::write_fields(to, kFields, &base);
}

bool read(const GstStructure* from, CerberusBase& base) {
  base.source = CERBERUS_BASE_REPORTED;
  return cerberus::read_fields(from, kFields, &base) && GST_CLOCK_TIME_IS_VALID(base.valid_from);
}

}  // namespace

template <typename Archive>
static void exchange(Archive& archive, CerberusBase& base) {
  archive(base.yaw_rate, base.source, cerberus::publish::Moment{base.valid_from});
  base = sane(base);
}

CERBERUS_DEFINE_BOXED(CerberusBase, cerberus_base, unknown)
CERBERUS_DEFINE_ENUM(CerberusBaseSource, cerberus_base_source,
                     {CERBERUS_BASE_ESTIMATED, "CERBERUS_BASE_ESTIMATED", "estimated"},
                     {CERBERUS_BASE_REPORTED, "CERBERUS_BASE_REPORTED", "reported"})
CERBERUS_DEFINE_META(CerberusBase, base, sane, nullptr)
CERBERUS_DEFINE_EVENT(CerberusBase, base, CERBERUS_EVENT_BASE, GST_EVENT_CUSTOM_UPSTREAM, cerberus::is_any)
