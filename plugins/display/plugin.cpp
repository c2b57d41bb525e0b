// SPDX-License-Identifier: LGPL-2.1-or-later
// The loadable module that shows what was found.
#include <cerberus/version.h>
#include <gst/gst.h>

GST_ELEMENT_REGISTER_DECLARE(motionjson)
GST_ELEMENT_REGISTER_DECLARE(motionoverlay)
GST_ELEMENT_REGISTER_DECLARE(motionview)
GST_ELEMENT_REGISTER_DECLARE(privacymask)

static gboolean plugin_init(GstPlugin* plugin) {
  cerberus_init();
  return GST_ELEMENT_REGISTER(motionjson, plugin) && GST_ELEMENT_REGISTER(motionoverlay, plugin) &&
         GST_ELEMENT_REGISTER(motionview, plugin) && GST_ELEMENT_REGISTER(privacymask, plugin);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, cerberusdisplay,
                  "Shows what the detection found: drawings, stage views and JSON lines", plugin_init,
                  PLUGIN_VERSION, "LGPL", PACKAGE, "Unknown package origin")
