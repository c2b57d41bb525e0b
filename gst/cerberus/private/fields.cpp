// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cerberus/private/fields.hpp"

#include <cerberus/pir.h>

#include <algorithm>
#include <cstring>

#include "cerberus/private/text.hpp"

namespace cerberus {

namespace {

constexpr guint8 kInvalid = 2;

template <typename T>
T get(const void* value, const Field& field) {
  T result;
  std::memcpy(&result, static_cast<const std::byte*>(value) + field.offset, sizeof result);
  return result;
}
template <typename T>
bool put(void* value, const Field& field, T result) {
  std::memcpy(static_cast<std::byte*>(value) + field.offset, &result, sizeof result);
  return true;
}

// As g_type_class_ref(), once: an enumeration's class is never unloaded then.
GEnumClass* enum_class(GType type) {
  gpointer klass = g_type_class_peek(type);
  return static_cast<GEnumClass*>(klass ? klass : g_type_class_ref(type));
}

const GEnumValue* enum_value(GType type, int value) {
  return g_enum_get_value(enum_class(type), value);
}

void write(GstStructure* to, const Field& f, const void* value) {
  switch (f.type) {
    case Field::Type::known:
      if (!std::isfinite(get<gdouble>(value, f))) return;
      [[fallthrough]];
    case Field::Type::number:
    case Field::Type::angle:
      return gst_structure_set(to, f.name, G_TYPE_DOUBLE, get<gdouble>(value, f), nullptr);
    case Field::Type::time:
      return gst_structure_set(to, f.name, G_TYPE_UINT64, get<guint64>(value, f), nullptr);
    case Field::Type::integer:
      return gst_structure_set(to, f.name, G_TYPE_INT, get<gint>(value, f), nullptr);
    case Field::Type::count:
      return gst_structure_set(to, f.name, G_TYPE_UINT, get<guint>(value, f), nullptr);
    case Field::Type::flag:
      return gst_structure_set(to, f.name, G_TYPE_BOOLEAN, get<gboolean>(value, f) != FALSE, nullptr);
    case Field::Type::choice:
      return gst_structure_set(to, f.name, f.choices(), get<gint>(value, f), nullptr);
    case Field::Type::nick:
      return gst_structure_set(to, f.name, G_TYPE_STRING, nick_of(f.choices(), get<gint>(value, f)), nullptr);
    case Field::Type::word:
      const gchar* word = get<const gchar*>(value, f);
      gst_structure_set(to, f.name, G_TYPE_STRING, printable(word ? word : "").c_str(), nullptr);
  }
}

bool read(const GstStructure* from, const Field& f, void* value) {
  const auto take = [&](auto get, auto read, auto accept) {
    return get(from, f.name, &read) && accept(read) && put(value, f, read);
  };
  const auto any = [](auto) { return true; };
  switch (f.type) {
    case Field::Type::known:
    case Field::Type::number:
      return take(gst_structure_get_double, gdouble{}, any);
    case Field::Type::angle:  // NaN is refused, too
      return take(gst_structure_get_double, gdouble{},
                  [](gdouble n) { return std::fabs(n) <= kMostDegrees; });
    case Field::Type::time:
      return take(gst_structure_get_uint64, guint64{}, any);
    case Field::Type::integer:
      return take(gst_structure_get_int, gint{}, any);
    case Field::Type::count:
      return take(gst_structure_get_uint, guint{}, any);
    case Field::Type::flag:
      return take(gst_structure_get_boolean, gboolean{}, any);
    case Field::Type::choice: {
      gint choice = 0;
      return gst_structure_get_enum(from, f.name, f.choices(), &choice) && enum_value(f.choices(), choice) &&
             put(value, f, choice);
    }
    case Field::Type::nick: {
      const gchar* nick = gst_structure_get_string(from, f.name);
      const GEnumValue* found = nick ? g_enum_get_value_by_nick(enum_class(f.choices()), nick) : nullptr;
      return found && put(value, f, found->value);
    }
    case Field::Type::word:
      const gchar* word = gst_structure_get_string(from, f.name);
      return word && put(value, f, g_intern_string(word));
  }
  return false;
}

// set(item, i) fills the items of an array, which are of `type`.
template <typename Set>
void set_array(GstStructure* to, const char* field, guint count, GType type, Set set) {
  GValue array = G_VALUE_INIT, item = G_VALUE_INIT;
  gst_value_array_init(&array, count);
  g_value_init(&item, type);
  for (guint i = 0; i < count; ++i) {
    set(&item, i);
    gst_value_array_append_value(&array, &item);
  }
  gst_structure_take_value(to, field, &array);
}

}  // namespace

void write_fields(GstStructure* to, std::span<const Field> fields, const void* value) {
  for (const Field& field : fields) write(to, field, value);
}

bool read_fields(const GstStructure* from, std::span<const Field> fields, void* value) {
  return std::ranges::all_of(fields, [&](const Field& field) { return read(from, field, value); });
}

void read_known_fields(const GstStructure* from, std::span<const Field> fields, void* value) {
  for (const Field& field : fields) read(from, field, value);
}

bool is_one_of(GType type, const void* enumeration) {
  int number = 0;
  std::memcpy(&number, enumeration, sizeof number);
  return enum_value(type, number);
}

const gchar* nick_of(GType type, int value) {
  const GEnumValue* found = enum_value(type, value);
  g_return_val_if_fail(found, "");
  return found->value_nick;
}

void set_numbers(GstStructure* to, const char* field, guint count, const gdouble* numbers) {
  set_array(to, field, count, G_TYPE_DOUBLE,
            [&](GValue* item, guint i) { g_value_set_double(item, numbers[i]); });
}

void write_sensors(GstStructure* to, guint n, const guint8* sensors, const gdouble* bearings) {
  set_array(to, "sensors", n, G_TYPE_INT, [&](GValue* item, guint i) { g_value_set_int(item, sensors[i]); });
  set_numbers(to, "bearings", n, bearings);
}

bool read_sensors(const GstStructure* from, guint& n, guint8* sensors, gdouble* bearings) {
  const GValue* readings = gst_structure_get_value(from, "sensors");
  const GValue* angles = gst_structure_get_value(from, "bearings");
  if (!readings || !GST_VALUE_HOLDS_ARRAY(readings) || !angles || !GST_VALUE_HOLDS_ARRAY(angles))
    return false;
  n = gst_value_array_get_size(readings);
  if (n > CERBERUS_PIR_MAX_SENSORS || gst_value_array_get_size(angles) != n) return false;
  for (guint i = 0; i < n; ++i) {
    const GValue* reading = gst_value_array_get_value(readings, i);
    const GValue* angle = gst_value_array_get_value(angles, i);
    if (!G_VALUE_HOLDS_INT(reading) || !G_VALUE_HOLDS_DOUBLE(angle)) return false;
    const int number = g_value_get_int(reading);
    sensors[i] = number == 0 || number == 1 ? static_cast<guint8>(number) : kInvalid;
    bearings[i] = g_value_get_double(angle);
    if (!std::isfinite(bearings[i])) return false;
  }
  return true;
}

void tidy_sensors(guint& n, guint8* sensors, gdouble* bearings) {
  n = std::min<guint>(n, CERBERUS_PIR_MAX_SENSORS);
  for (guint i = 0; i < n; ++i) {
    sensors[i] = std::min(sensors[i], kInvalid);
    if (!std::isfinite(bearings[i])) bearings[i] = 0;
  }
}

}  // namespace cerberus
