// SPDX-License-Identifier: LGPL-2.1-or-later
// Video of single fields (`interlace-mode=alternate`), which has a caps feature of its own. No element reads it. Sink
// pads accept its caps all the same, and source pads offer the output of `deinterlace` for it: a pipeline is then
// linked, and set_caps refuses it with an error that names the remedy, instead of a bare "not negotiated". (The latter
// remains if an element downstream requires another size.)
#pragma once

#include <cerberus/caps.h>

#define SINGLE_FIELDS_CAPS \
  "video/x-raw(" GST_CAPS_FEATURE_FORMAT_INTERLACED "), interlace-mode = (string) alternate"
// The analysed caps: smaller frames cannot show a person, larger ones exceed the design. `videoscale` in front
// negotiates by itself.
#define ANALYSED_VIDEO_CAPS                                \
  "video/x-raw, format = (string) " CERBERUS_VIDEO_FORMATS \
  ", width = (int) [ 32, 8192 ], height = (int) [ 32, 8192 ]"
#define ANALYSED_VIDEO_AND_SINGLE_FIELDS_CAPS ANALYSED_VIDEO_CAPS "; " SINGLE_FIELDS_CAPS
// For the template of a sink pad that refuses them with an error message.
#define VIDEO_AND_SINGLE_FIELDS_CAPS CERBERUS_VIDEO_CAPS "; " SINGLE_FIELDS_CAPS

namespace cerberus::plugin {

// For transform_caps, from the source pad to the sink pad: `caps` with those of single fields; empty for empty `caps`.
// Takes `caps`.
inline GstCaps* with_single_fields(GstCaps* caps) {
  if (gst_caps_is_empty(caps)) return caps;
  return gst_caps_merge(caps, gst_caps_from_string(SINGLE_FIELDS_CAPS));
}

// The same from the sink pad to the source pad: `caps`, with whole pictures in place of single fields. Takes `caps`.
inline GstCaps* without_single_fields(GstCaps* caps) {
  caps = gst_caps_make_writable(caps);
  for (guint i = 0; i < gst_caps_get_size(caps); ++i) {
    GstCapsFeatures* features = gst_caps_get_features(caps, i);
    if (gst_caps_features_is_any(features) ||
        !gst_caps_features_contains(features, GST_CAPS_FEATURE_FORMAT_INTERLACED))
      continue;
    gst_caps_features_remove(features, GST_CAPS_FEATURE_FORMAT_INTERLACED);
    gst_structure_remove_fields(gst_caps_get_structure(caps, i), "interlace-mode", "field-order", nullptr);
  }
  return caps;
}

// For elements that change nothing else. Takes `caps`.
inline GstCaps* across_single_fields(GstPadDirection direction, GstCaps* caps) {
  return direction == GST_PAD_SRC ? with_single_fields(caps) : without_single_fields(caps);
}

}  // namespace cerberus::plugin
