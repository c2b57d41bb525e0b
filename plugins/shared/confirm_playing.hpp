// SPDX-License-Identifier: LGPL-2.1-or-later
// So that the end of a stream is not lost in the bins around a sink.
#pragma once

#include <gst/gst.h>

namespace cerberus::plugin {

// GstBin forwards the end of the stream only if PLAYING was the last state that it posted. Where an element completes
// READY to PAUSED in a streaming thread (decodebin), that thread posts PAUSED; the application, which reads it at once,
// sets PLAYING before the thread notes that PAUSED was posted; and the end is never forwarded (seen with GStreamer 1.22
// and 1.26). Sinks of GstBaseSink with async=true escape by their preroll lock. Others, whose own PAUSED may be long
// complete when a decoder of another branch is the last, call this before they post the end: the bins around them that
// play, and are on the way to no other state, post PLAYING once more. A change of state at the same time does no harm: a
// bin that does not play forwards no end, and posts its next state itself.
inline void confirm_playing(GstElement* element) {
  g_autoptr(GstObject) bin = gst_object_get_parent(GST_OBJECT(element));
  if (!bin || !GST_IS_BIN(bin)) return;
  confirm_playing(GST_ELEMENT(bin));
  GST_OBJECT_LOCK(bin);
  const bool plays =
      GST_STATE(bin) == GST_STATE_PLAYING &&
      (GST_STATE_PENDING(bin) == GST_STATE_VOID_PENDING || GST_STATE_PENDING(bin) == GST_STATE_PLAYING);
  GST_OBJECT_UNLOCK(bin);
  if (plays)
    gst_element_post_message(
        GST_ELEMENT(bin),
        gst_message_new_state_changed(bin, GST_STATE_PLAYING, GST_STATE_PLAYING, GST_STATE_VOID_PENDING));
}

}  // namespace cerberus::plugin
