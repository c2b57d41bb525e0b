// SPDX-License-Identifier: LGPL-2.1-or-later
// The loadable module of heads, real and virtual.
#include <gst/gst.h>

GST_ELEMENT_REGISTER_DECLARE(pantiltsink)
GST_ELEMENT_REGISTER_DECLARE(virtualptz)

static gboolean plugin_init(GstPlugin* plugin) {
  const gboolean sink = GST_ELEMENT_REGISTER(pantiltsink, plugin);
  return GST_ELEMENT_REGISTER(virtualptz, plugin) && sink;
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, cerberuspantilt,
                  "Turns pan-tilt heads, real and virtual, towards people", plugin_init, PLUGIN_VERSION,
                  "LGPL", PACKAGE, "https://cerberus.invalid/")
