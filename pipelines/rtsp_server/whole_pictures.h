// SPDX-License-Identifier: LGPL-2.1-or-later
// Sends the packets of a picture as one list. A client receives from the list on that is sent after its PLAY: it begins with
// a whole picture, where a payloader pushes each slice by itself.
#pragma once

#include <gst/gst.h>

namespace cerberus::rtsp {

// Of any payloader: the marker bit, the next time stamp or the end of the stream ends a picture; a flush drops it.
void send_whole_pictures(GstElement* payloader);

}  // namespace cerberus::rtsp
