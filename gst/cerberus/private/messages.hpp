// SPDX-License-Identifier: LGPL-2.1-or-later
// Errors, warnings and information for the application, as by GStreamer's macros of these names, which are used only
// here. Texts of users, files and drivers are made printable only here: callers quote them unchanged. A text is
// (format, arguments...), (a whole string), which may hold anything, or (nullptr).
//
//   CERBERUS_ELEMENT_WARNING(self, RESOURCE, SETTINGS, ("No driver \"%s\".", name.c_str()), (error.detail));
#pragma once

#include <gst/gst.h>

#include <cstdarg>
#include <cstddef>
#include <string>

#include "cerberus/private/text.hpp"

namespace cerberus::detail {

inline std::string words(std::nullptr_t) noexcept {
  return {};
}
inline std::string words(const std::string& whole) noexcept {
  return printable(whole);
}
G_GNUC_PRINTF(1, 2) inline std::string words(const char* format, ...) noexcept {
  va_list arguments;
  va_start(arguments, format);
  g_autofree gchar* text = gst_info_strdup_vprintf(format, arguments);  // supports GST_PTR_FORMAT
  va_end(arguments);
  return printable(text);
}

// The source of the message.
struct Origin {
  GstDebugCategory* category;
  const char* file;
  const char* function;
  int line;
};

// An empty text stands for GStreamer's own, an empty detail for none. Takes `facts`, for programs; may be nullptr.
// gst-launch-1.0 prints only the detail of an INFO message, so the text is repeated there.
inline void post(GstElement* element, GstMessageType type, GQuark domain, gint code, const std::string& text,
                 const std::string& detail, GstStructure* facts, const Origin& from) noexcept {
  const GstDebugLevel level = type == GST_MESSAGE_INFO ? GST_LEVEL_INFO : GST_LEVEL_WARNING;
  for (const std::string* said : {&text, &detail})
    if (!said->empty() && from.category && level <= gst_debug_category_get_threshold(from.category))
      gst_debug_log(from.category, level, from.file, from.function, from.line, G_OBJECT(element), "%s: %s",
                    gst_message_type_get_name(type), said->c_str());
  const auto copy = [](const std::string& said) { return said.empty() ? nullptr : g_strdup(said.c_str()); };
  const bool repeats = type == GST_MESSAGE_INFO && !text.empty();
  const std::string printed = !repeats ? detail : detail.empty() ? text : text + "\n" + detail;
  gst_element_message_full_with_details(element, type, domain, code, copy(text), copy(printed), from.file,
                                        from.function, from.line, facts);
}

}  // namespace cerberus::detail

#define CERBERUS_ELEMENT_MESSAGE(element, type, domain, code, text, debug, facts)          \
  ::cerberus::detail::post(GST_ELEMENT(element), GST_MESSAGE_##type, GST_##domain##_ERROR, \
                           GST_##domain##_ERROR_##code, ::cerberus::detail::words text,    \
                           ::cerberus::detail::words debug, facts,                         \
                           {GST_CAT_DEFAULT, __FILE__, GST_FUNCTION, __LINE__})
#define CERBERUS_ELEMENT_ERROR(element, domain, code, text, debug) \
  CERBERUS_ELEMENT_MESSAGE(element, ERROR, domain, code, text, debug, nullptr)
#define CERBERUS_ELEMENT_WARNING(element, domain, code, text, debug) \
  CERBERUS_ELEMENT_MESSAGE(element, WARNING, domain, code, text, debug, nullptr)
#define CERBERUS_ELEMENT_INFO(element, domain, code, text, debug) \
  CERBERUS_ELEMENT_MESSAGE(element, INFO, domain, code, text, debug, nullptr)
