// SPDX-License-Identifier: LGPL-2.1-or-later
// The loadable module of heads.
#include <cerberus/version.h>
#include <gst/gst.h>

GST_ELEMENT_REGISTER_DECLARE(pantiltsink)

static gboolean plugin_init(GstPlugin* plugin) {
  cerberus_init();
  return GST_ELEMENT_REGISTER(pantiltsink, plugin);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, cerberuspantilt,
                  "Turns pan-tilt heads towards people", plugin_init, PLUGIN_VERSION, "LGPL", PACKAGE,
                  "Unknown package origin")
