// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/caps.h>

#include <string_view>

gboolean cerberus_video_format_is_supported(GstVideoFormat format) {
  if (format == GST_VIDEO_FORMAT_UNKNOWN) return FALSE;
  constexpr std::string_view kFormats = CERBERUS_VIDEO_FORMATS;
  const std::string_view name = gst_video_format_to_string(format);
  for (auto at = kFormats.find(name); at != kFormats.npos; at = kFormats.find(name, at + 1)) {
    const char before = kFormats[at - 1], after = kFormats[at + name.size()];
    if (before == ' ' && (after == ',' || after == ' ')) return TRUE;
  }
  return FALSE;
}
