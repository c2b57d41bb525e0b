// SPDX-License-Identifier: LGPL-2.1-or-later
// The loadable module of PIR sensors.
#include <cerberus/cerberus.h>

GST_ELEMENT_REGISTER_DECLARE(pirsrc)

static gboolean plugin_init(GstPlugin* plugin) {
  cerberus_init();
  return GST_ELEMENT_REGISTER(pirsrc, plugin);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, cerberuspir, "Reads passive infrared sensors",
                  plugin_init, PLUGIN_VERSION, "LGPL", PACKAGE, "Unknown package origin")
