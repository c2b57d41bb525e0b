// SPDX-License-Identifier: LGPL-2.1-or-later
// The loadable module of simulated cameras and robots.
#include <cerberus/cerberus.h>

GST_ELEMENT_REGISTER_DECLARE(patrolsimsrc)
GST_ELEMENT_REGISTER_DECLARE(virtualptz)

static gboolean plugin_init(GstPlugin* plugin) {
  cerberus_init();
  return GST_ELEMENT_REGISTER(patrolsimsrc, plugin) && GST_ELEMENT_REGISTER(virtualptz, plugin);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, cerberussim, "Simulated cameras and robots",
                  plugin_init, PLUGIN_VERSION, "LGPL", PACKAGE, "Unknown package origin")
