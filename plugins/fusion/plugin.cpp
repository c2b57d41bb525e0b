// SPDX-License-Identifier: LGPL-2.1-or-later
// The loadable module of sensor fusion.
#include <cerberus/version.h>
#include <gst/gst.h>

GST_ELEMENT_REGISTER_DECLARE(pirfusion)

static gboolean plugin_init(GstPlugin* plugin) {
  cerberus_init();
  return GST_ELEMENT_REGISTER(pirfusion, plugin);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, cerberusfusion,
                  "Decides from camera and PIR sensors where a head should look", plugin_init, PLUGIN_VERSION,
                  "LGPL", PACKAGE, "https://cerberus.invalid/")
