// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/base.h>

#include <cmath>
#include <limits>

#include "cerberus/private/define.hpp"

namespace {

using Type = cerberus::Field::Type;
constexpr cerberus::Field kTurn[] = {{"yaw-rate", Type::angle, offsetof(CerberusBase, yaw_rate)}};
constexpr cerberus::Field kDrive[] = {{"speed", Type::known, offsetof(CerberusBase, speed)}};
constexpr cerberus::Field kTime[] = {{"running-time", Type::time, offsetof(CerberusBase, valid_from)}};
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

void unknown(CerberusBase& base) {
  base.valid_from = GST_CLOCK_TIME_NONE;
  base.speed = kUnknown;
}

CerberusBase sane(CerberusBase base) {
  if (!cerberus::is_one_of(CERBERUS_TYPE_BASE_SOURCE, &base.source)) base.source = CERBERUS_BASE_ESTIMATED;
  return base;
}

void write(GstStructure* to, const CerberusBase& base) {
  if (std::isfinite(base.yaw_rate)) cerberus::write_fields(to, kTurn, &base);
  cerberus::write_fields(to, kDrive, &base);
  cerberus::write_fields(to, kTime, &base);
}

bool read(const GstStructure* from, CerberusBase& base) {
  base.source = CERBERUS_BASE_REPORTED;
  base.yaw_rate = base.speed = kUnknown;
  const bool turns = cerberus::read_fields(from, kTurn, &base);
  const bool drives = cerberus::read_fields(from, kDrive, &base) && std::isfinite(base.speed);
  if (!turns) base.yaw_rate = kUnknown;
  if (!drives) base.speed = kUnknown;
  return (turns || drives) && cerberus::read_fields(from, kTime, &base) &&
         GST_CLOCK_TIME_IS_VALID(base.valid_from);
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
