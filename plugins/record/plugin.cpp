// SPDX-License-Identifier: LGPL-2.1-or-later
// The loadable module of recorders.
#include <cerberus/version.h>
#include <gst/gst.h>

GST_ELEMENT_REGISTER_DECLARE(eventrecorder)

static gboolean plugin_init(GstPlugin* plugin) {
  cerberus_init();
  return GST_ELEMENT_REGISTER(eventrecorder, plugin);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, cerberusrecord,
                  "Records encoded video and audio around events", plugin_init, PLUGIN_VERSION, "LGPL",
                  PACKAGE, "Unknown package origin")
