// SPDX-License-Identifier: LGPL-2.1-or-later
// The loadable module that verifies tracks with OpenCV: no other one uses it.
#include <cerberus/version.h>
#include <gst/gst.h>

GST_ELEMENT_REGISTER_DECLARE(personverify)

static gboolean plugin_init(GstPlugin* plugin) {
  cerberus_init();
  return GST_ELEMENT_REGISTER(personverify, plugin);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, cerberusverify, "Verifies that tracks are people",
                  plugin_init, PLUGIN_VERSION, "LGPL", PACKAGE, "Unknown package origin")
