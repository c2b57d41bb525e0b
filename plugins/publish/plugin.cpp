// SPDX-License-Identifier: LGPL-2.1-or-later
// The loadable module that publishes results in the formats of others.
#include <gst/gst.h>

GST_ELEMENT_REGISTER_DECLARE(onvifmeta)
GST_ELEMENT_REGISTER_DECLARE(rtponvifmetapay)

static gboolean plugin_init(GstPlugin* plugin) {
  return GST_ELEMENT_REGISTER(onvifmeta, plugin) && GST_ELEMENT_REGISTER(rtponvifmetapay, plugin);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, cerberuspublish,
                  "Publishes what was found as ONVIF metadata, and as RTP", plugin_init, PLUGIN_VERSION,
                  "LGPL", PACKAGE, "Unknown package origin")
