// SPDX-License-Identifier: LGPL-2.1-or-later
#include "screen.h"

#include <gst/app/app.h>

#include <cstdio>
#include <string>

using namespace std::string_literals;

namespace cerberus::demo {

namespace {

GstPadProbeReturn on_frame(GstPad* pad, GstPadProbeInfo* info, gpointer input) {
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(pad);
  g_autoptr(GstSample) sample = gst_sample_new(GST_PAD_PROBE_INFO_BUFFER(info), caps, nullptr, nullptr);
  gst_app_src_push_sample(GST_APP_SRC(input), sample);  // what it answers is the window's own affair
  return GST_PAD_PROBE_OK;
}

}  // namespace

Screen::~Screen() {
  if (pipeline_) gst_element_set_state(pipeline_, GST_STATE_NULL);
  gst_clear_object(&pipeline_);
}

// The sinks are tried by hand: autovideosink also tries those for DirectFB, which can crash where there is none.
bool Screen::open() {
  const bool wayland = g_getenv("WAYLAND_DISPLAY"), x11 = g_getenv("DISPLAY");
  if (!wayland && !x11) return false;
  for (const char* name : {"waylandsink", "xvimagesink", "ximagesink"}) {
    if (!(name == "waylandsink"s ? wayland : x11)) continue;
    g_autoptr(GstElementFactory) factory = gst_element_factory_find(name);
    if (!factory) continue;
    const std::string line =
        "appsrc name=in format=time max-buffers=2 max-bytes=0 leaky-type=downstream ! videoconvert ! "s +
        name + " sync=false";
    pipeline_ = gst_parse_launch(line.c_str(), nullptr);
    if (pipeline_ && gst_element_set_state(pipeline_, GST_STATE_READY) != GST_STATE_CHANGE_FAILURE) {
      gst_element_set_state(pipeline_, GST_STATE_PLAYING);
      return true;
    }
    if (pipeline_) gst_element_set_state(pipeline_, GST_STATE_NULL);
    gst_clear_object(&pipeline_);
  }
  std::fprintf(stderr, "demo: no window: the display cannot be opened\n");
  return false;
}

void Screen::show(GstPad* pad) {
  if (!open()) return;
  GstElement* input = gst_bin_get_by_name(GST_BIN(pipeline_), "in");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, on_frame, input, gst_object_unref);
}

}  // namespace cerberus::demo
