// SPDX-License-Identifier: LGPL-2.1-or-later
// One table for each public structure: its fields by name, type and place. Messages and events are written and read by
// it.
#pragma once

#include <gst/gst.h>

#include <cmath>
#include <cstddef>
#include <span>

namespace cerberus {

struct Field {
  enum class Type {
    number,   // gdouble, any value
    known,    // gdouble, written where it is finite
    angle,    // gdouble in degrees (or their derivatives): finite, up to kMostDegrees
    time,     // GstClockTime, as uint64
    integer,  // gint
    count,    // guint
    flag,     // gboolean
    choice,   // an enumeration, as such
    nick,     // an enumeration, as its nick
    word,     // interned string; NULL is written as an empty one
  };
  const char* name;
  Type type;
  std::size_t offset;
  GType (*choices)() = nullptr;
};

// No head turns further (many turns of cable) or faster: larger numbers are refused.
constexpr double kMostDegrees = 1e6;

// `value`: a structure that `fields` describes.
void write_fields(GstStructure* to, std::span<const Field> fields, const void* value);
// False where a field is missing, of another type or out of its range; `value` is undefined then.
bool read_fields(const GstStructure* from, std::span<const Field> fields, void* value);

// Those that are missing or of another type keep what `value` holds.
void read_known_fields(const GstStructure* from, std::span<const Field> fields, void* value);

// Whether `enumeration`, an enum in which an application may have left any number, is a value of `type`.
bool is_one_of(GType type, const void* enumeration);
const gchar* nick_of(GType type, int value);

// The array fields `sensors` and `bearings` of CerberusPir and CerberusFusion, of which at most `n` are read.
void write_sensors(GstStructure* to, guint n, const guint8* sensors, const gdouble* bearings);
bool read_sensors(const GstStructure* from, guint& n, guint8* sensors, gdouble* bearings);
// Makes them sane: at most as many as there is room for, readings up to 2 (invalid), finite bearings.
void tidy_sensors(guint& n, guint8* sensors, gdouble* bearings);

// An array of `count` doubles as a field.
void set_numbers(GstStructure* to, const char* field, guint count, const gdouble* numbers);

}  // namespace cerberus
