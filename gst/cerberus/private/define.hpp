// SPDX-License-Identifier: LGPL-2.1-or-later
// Defines what <cerberus/api.h> and the headers declare for each structure, so that all have one shape:
// boxed type, enumeration, meta (cerberus_buffer_set/get/peek_X), message and event (_new_X, _is_X, _parse_X).
#pragma once

#include <cerberus/pose.h>
#include <cerberus/stamp.h>

#include "cerberus/private/fields.hpp"
#include "cerberus/private/meta.hpp"

namespace cerberus {

// The structure of a message with its stamp (may be nullptr).
GstStructure* stamped(const char* name, const CerberusStamp* stamp);

// Never NULL: an application may have left the name out, and then it is the head that is there.
inline const gchar* head_of(const CerberusPose& pose) {
  return pose.head ? pose.head : g_intern_static_string("head");
}

// What needs no hook.
template <typename Value>
void zero(Value&) {}
template <typename Value>
bool is_any(const Value&) {
  return true;
}

inline bool is_message(GstMessage* message, const char* name) {
  return GST_MESSAGE_TYPE(message) == GST_MESSAGE_ELEMENT && gst_message_has_name(message, name);
}
inline bool has_running_time(const GstStructure* structure) {
  return gst_structure_has_field_typed(structure, "running-time", G_TYPE_UINT64);
}

}  // namespace cerberus

#define CERBERUS_DEFINE_ENUM(Type, prefix, ...)                                              \
  GType prefix##_get_type(void) {                                                            \
    static const GEnumValue values[] = {__VA_ARGS__, {0, nullptr, nullptr}};                 \
    static const GType type = g_enum_register_static(g_intern_static_string(#Type), values); \
    return type;                                                                             \
  }                                                                                          \
  const gchar* prefix##_get_nick(Type value) {                                               \
    return cerberus::nick_of(prefix##_get_type(), static_cast<int>(value));                  \
  }

// `defaults`: void(Type&), of a zeroed one. `own`: void(Type&), replaces what a bitwise copy shares by copies of its
// own. `release`: void(Type&), frees them.
#define CERBERUS_DEFINE_OWNING_BOXED(Type, prefix, defaults, own, release) \
  G_DEFINE_BOXED_TYPE(Type, prefix, prefix##_copy, prefix##_free)          \
  void prefix##_init(Type* value) {                                        \
    g_return_if_fail(value);                                               \
    *value = {};                                                           \
    defaults(*value);                                                      \
  }                                                                        \
  Type* prefix##_new(void) {                                               \
    Type* value = g_new(Type, 1);                                          \
    prefix##_init(value);                                                  \
    return value;                                                          \
  }                                                                        \
  Type* prefix##_copy(const Type* value) {                                 \
    auto* copy = static_cast<Type*>(g_memdup2(value, sizeof *value));      \
    if (copy) own(*copy);                                                  \
    return copy;                                                           \
  }                                                                        \
  void prefix##_free(Type* value) {                                        \
    if (value) release(*value);                                            \
    g_free(value);                                                         \
  }

#define CERBERUS_DEFINE_BOXED(Type, prefix, defaults) \
  CERBERUS_DEFINE_OWNING_BOXED(Type, prefix, defaults, cerberus::zero, cerberus::zero)

// A fact on a buffer. `sane`: Type(Type), makes what an application attaches safe to read. `transform`: nullptr for a
// fact about the moment. Then the tags. Its fields: see ValueMeta.
#define CERBERUS_DEFINE_META(Type, name, sane, transform, ...)                                         \
  namespace {                                                                                          \
  const GstMetaInfo* name##_meta_info();                                                               \
  using Type##Carried = cerberus::ValueMeta<Type, cerberus_##name##_init, name##_meta_info,            \
                                            !std::is_null_pointer_v<decltype(transform)>>;             \
  const GstMetaInfo* name##_meta_info() {                                                              \
    static const GstMetaInfo* const info =                                                             \
        Type##Carried::register_as(cerberus_##name##_meta_api_get_type(), #Type "Meta", transform);    \
    return info;                                                                                       \
  }                                                                                                    \
  }                                                                                                    \
  GType cerberus_##name##_meta_api_get_type(void) {                                                    \
    static const GType type = cerberus::register_meta_api(#Type "MetaAPI" __VA_OPT__(, ) __VA_ARGS__); \
    return type;                                                                                       \
  }                                                                                                    \
  gboolean cerberus_buffer_set_##name(GstBuffer* buffer, const Type* value) {                          \
    g_return_val_if_fail(GST_IS_BUFFER(buffer), FALSE);                                                \
    if (!value) return Type##Carried::set(buffer, nullptr);                                            \
    const Type carried = sane(*value);                                                                 \
    return Type##Carried::set(buffer, &carried);                                                       \
  }                                                                                                    \
  const Type* cerberus_buffer_peek_##name(GstBuffer* buffer) {                                         \
    g_return_val_if_fail(GST_IS_BUFFER(buffer), nullptr);                                              \
    return Type##Carried::peek(buffer);                                                                \
  }                                                                                                    \
  Type* cerberus_buffer_get_##name(GstBuffer* buffer) {                                                \
    return cerberus_##name##_copy(cerberus_buffer_peek_##name(buffer));                                \
  }

// Messages and events are written by write(GstStructure*, const Type&) and read by bool read(const GstStructure*,
// Type&) into one with the defaults.
#define CERBERUS_DEFINE_MESSAGE(Type, name, NAME)                                                          \
  GstMessage* cerberus_message_new_##name(GstObject* src, const CerberusStamp* stamp, const Type* value) { \
    g_return_val_if_fail(!src || GST_IS_OBJECT(src), nullptr);                                             \
    g_return_val_if_fail(value, nullptr);                                                                  \
    GstStructure* structure = cerberus::stamped(NAME, stamp);                                              \
    write(structure, *value);                                                                              \
    return gst_message_new_element(src, structure);                                                        \
  }                                                                                                        \
  gboolean cerberus_message_is_##name(GstMessage* message) {                                               \
    g_return_val_if_fail(GST_IS_MESSAGE(message), FALSE);                                                  \
    return cerberus::is_message(message, NAME);                                                            \
  }                                                                                                        \
  Type* cerberus_message_parse_##name(GstMessage* message) {                                               \
    if (!cerberus_message_is_##name(message)) return nullptr;                                              \
    const GstStructure* structure = gst_message_get_structure(message);                                    \
    if (!cerberus::has_running_time(structure)) return nullptr;                                            \
    Type* parsed = cerberus_##name##_new();                                                                \
    if (read(structure, *parsed)) return parsed;                                                           \
    cerberus_##name##_free(parsed);                                                                        \
    return nullptr;                                                                                        \
  }

// `is_complete`: bool(const Type&), what an event must say beyond its fields.
#define CERBERUS_DEFINE_EVENT(Type, name, NAME, EVENT_TYPE, is_complete)                      \
  GstEvent* cerberus_event_new_##name(const Type* value) {                                    \
    g_return_val_if_fail(value&& is_complete(*value), nullptr);                               \
    GstStructure* structure = gst_structure_new_empty(NAME);                                  \
    write(structure, *value);                                                                 \
    return gst_event_new_custom(EVENT_TYPE, structure);                                       \
  }                                                                                           \
  gboolean cerberus_event_is_##name(GstEvent* event) {                                        \
    g_return_val_if_fail(GST_IS_EVENT(event), FALSE);                                         \
    return GST_EVENT_TYPE(event) == EVENT_TYPE && gst_event_has_name(event, NAME);            \
  }                                                                                           \
  Type* cerberus_event_parse_##name(GstEvent* event) {                                        \
    if (!cerberus_event_is_##name(event)) return nullptr;                                     \
    Type* parsed = cerberus_##name##_new();                                                   \
    if (read(gst_event_get_structure(event), *parsed) && is_complete(*parsed)) return parsed; \
    cerberus_##name##_free(parsed);                                                           \
    return nullptr;                                                                           \
  }
