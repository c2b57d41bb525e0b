// SPDX-License-Identifier: LGPL-2.1-or-later
// The loadable module of detection.
#include <cerberus/version.h>
#include <gst/gst.h>

GST_ELEMENT_REGISTER_DECLARE(cameramotion)
GST_ELEMENT_REGISTER_DECLARE(threeframediff)
GST_ELEMENT_REGISTER_DECLARE(fuzzythreshold)
GST_ELEMENT_REGISTER_DECLARE(motionregions)
GST_ELEMENT_REGISTER_DECLARE(motiontrack)
GST_ELEMENT_REGISTER_DECLARE(motiondetect)
GST_ELEMENT_REGISTER_DECLARE(streamdamage)

static gboolean plugin_init(GstPlugin* plugin) {
  cerberus_init();
  return GST_ELEMENT_REGISTER(cameramotion, plugin) && GST_ELEMENT_REGISTER(threeframediff, plugin) &&
         GST_ELEMENT_REGISTER(fuzzythreshold, plugin) && GST_ELEMENT_REGISTER(motionregions, plugin) &&
         GST_ELEMENT_REGISTER(motiontrack, plugin) && GST_ELEMENT_REGISTER(motiondetect, plugin) &&
         GST_ELEMENT_REGISTER(streamdamage, plugin);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, cerberusdetect,
                  "Finds moving people in video from a camera that may turn itself", plugin_init,
                  PLUGIN_VERSION, "LGPL", PACKAGE, "Unknown package origin")
