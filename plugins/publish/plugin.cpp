// SPDX-License-Identifier: LGPL-2.1-or-later
// The loadable module that publishes results in the formats of others.
#include <cerberus/version.h>
#include <gst/gst.h>

#if HAVE_MQTT
GST_ELEMENT_REGISTER_DECLARE(mqttpublish)
#endif
GST_ELEMENT_REGISTER_DECLARE(onvifmeta)
GST_ELEMENT_REGISTER_DECLARE(rtponvifmetapay)

static gboolean plugin_init(GstPlugin* plugin) {
  cerberus_init();
#if HAVE_MQTT
  if (!GST_ELEMENT_REGISTER(mqttpublish, plugin)) return FALSE;
#endif
  return GST_ELEMENT_REGISTER(onvifmeta, plugin) && GST_ELEMENT_REGISTER(rtponvifmetapay, plugin);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, cerberuspublish,
                  "Publishes what was found as ONVIF metadata, as RTP, and by MQTT", plugin_init,
                  PLUGIN_VERSION, "LGPL", PACKAGE, "Unknown package origin")
