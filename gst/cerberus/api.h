/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

/* Marks what the library exports; everything else stays inside (-fvisibility=hidden). */
#ifndef CERBERUS_API
#if defined(__GNUC__)
#define CERBERUS_API __attribute__((visibility("default"))) extern
#else
#define CERBERUS_API extern
#endif
#endif

/* What every structure of the library has. prefix_init() fills one on the stack with the defaults of prefix_new(); such
 * a one owns nothing unless its members say so. prefix_copy() returns NULL only for NULL. prefix_free() takes what
 * prefix_new(), _copy(), a cerberus_buffer_get_() or a _parse_() function returned, or NULL. All have g_autoptr(). */
#define CERBERUS_DECLARE_BOXED(Type, prefix)               \
  CERBERUS_API GType prefix##_get_type(void) G_GNUC_CONST; \
  CERBERUS_API void prefix##_init(Type* value);            \
  CERBERUS_API Type* prefix##_new(void);                   \
  CERBERUS_API Type* prefix##_copy(const Type* value);     \
  CERBERUS_API void prefix##_free(Type* value);            \
  G_DEFINE_AUTOPTR_CLEANUP_FUNC(Type, prefix##_free)

/* What every enumeration has: its type, and the words that stand for its values in messages, JSON and properties. */
#define CERBERUS_DECLARE_ENUM(Type, prefix)                \
  CERBERUS_API GType prefix##_get_type(void) G_GNUC_CONST; \
  CERBERUS_API const gchar* prefix##_get_nick(Type value);

/* A fact on a buffer: attaches a copy (NULL removes; FALSE: the buffer is not writable); returns a copy; what the buffer
 * itself holds; the API type of its meta. NULL: there is none. */
#define CERBERUS_DECLARE_META(Type, name)                                                \
  CERBERUS_API gboolean cerberus_buffer_set_##name(GstBuffer* buffer, const Type* name); \
  CERBERUS_API Type* cerberus_buffer_get_##name(GstBuffer* buffer);                      \
  CERBERUS_API const Type* cerberus_buffer_peek_##name(GstBuffer* buffer);               \
  CERBERUS_API GType cerberus_##name##_meta_api_get_type(void);

/* A message. Parsing returns a copy, NULL of another message or a malformed one. */
#define CERBERUS_DECLARE_MESSAGE(Type, name)                                                       \
  CERBERUS_API GstMessage* cerberus_message_new_##name(GstObject* src, const CerberusStamp* stamp, \
                                                       const Type* name);                          \
  CERBERUS_API gboolean cerberus_message_is_##name(GstMessage* message);                           \
  CERBERUS_API Type* cerberus_message_parse_##name(GstMessage* message);

/* An event. Parsing returns a copy, NULL of another event or a malformed one. */
#define CERBERUS_DECLARE_EVENT(Type, name)                            \
  CERBERUS_API GstEvent* cerberus_event_new_##name(const Type* name); \
  CERBERUS_API gboolean cerberus_event_is_##name(GstEvent* event);    \
  CERBERUS_API Type* cerberus_event_parse_##name(GstEvent* event);
