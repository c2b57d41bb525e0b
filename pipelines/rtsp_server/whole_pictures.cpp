// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rtsp_server/whole_pictures.h"

#include <cstring>
#include <utility>

namespace cerberus::rtsp {
namespace {

// derived: 23 MB of packets of 1400 bytes, more than a picture has. Guard: tests/elements/rtsp.cpp.
constexpr guint kMostPackets = 16384;

struct Picture {
  GstBufferList* packets = nullptr;  // so far
  guint32 stamp = 0;                 // of those, as it is sent
  bool sends = false;

  ~Picture() { gst_clear_buffer_list(&packets); }
};

// RFC 3550, 5.1: the marker is the first bit of the second byte, the stamp the second word.
struct Header {
  bool marker = false;
  guint32 stamp = 0;
};

Header header_of(GstBuffer* packet) {
  guint8 bytes[8] = {};
  gst_buffer_extract(packet, 0, bytes, sizeof bytes);
  Header header{(bytes[1] & 0x80) != 0};
  std::memcpy(&header.stamp, bytes + 4, sizeof header.stamp);
  return header;
}

GstFlowReturn send(GstPad* pad, Picture& picture) {
  if (!picture.packets) return GST_FLOW_OK;
  picture.sends = true;
  const GstFlowReturn flow = gst_pad_push_list(pad, std::exchange(picture.packets, nullptr));
  picture.sends = false;
  return flow;
}

GstPadProbeReturn collect(GstPad* pad, GstPadProbeInfo* info, gpointer data) {
  Picture& picture = *static_cast<Picture*>(data);
  if (picture.sends) return GST_PAD_PROBE_OK;
  GstFlowReturn flow = GST_FLOW_OK;
  const auto add = [&](GstBuffer* packet) {
    const Header header = header_of(packet);
    if (header.stamp != picture.stamp) flow = send(pad, picture);  // whose last packet had no marker
    if (!picture.packets) picture.packets = gst_buffer_list_new();
    picture.stamp = header.stamp;
    gst_buffer_list_add(picture.packets, gst_buffer_ref(packet));
    if (header.marker || gst_buffer_list_length(picture.packets) >= kMostPackets) flow = send(pad, picture);
  };
  if ((GST_PAD_PROBE_INFO_TYPE(info) & GST_PAD_PROBE_TYPE_BUFFER_LIST) != 0) {
    GstBufferList* list = gst_pad_probe_info_get_buffer_list(info);
    for (guint k = 0; k < gst_buffer_list_length(list); ++k) add(gst_buffer_list_get(list, k));
    gst_buffer_list_unref(list);
  } else {
    GstBuffer* packet = gst_pad_probe_info_get_buffer(info);
    add(packet);
    gst_buffer_unref(packet);
  }
  GST_PAD_PROBE_INFO_FLOW_RETURN(info) = flow;
  return GST_PAD_PROBE_HANDLED;
}

// Sends to the next pad, since this one has the event already: after the end of the stream it pushes nothing more, and before
// a packet it pushes its new caps.
void send_before_event(GstPad* pad, Picture& picture) {
  if (!picture.packets) return;
  g_autoptr(GstPad) next = gst_pad_get_peer(pad);
  if (next)
    gst_pad_chain_list(next, std::exchange(picture.packets, nullptr));
  else
    gst_clear_buffer_list(&picture.packets);
}

// The packets so far go before caps, a segment or the stream's end: no other packet of their picture follows.
GstPadProbeReturn end_picture(GstPad* pad, GstPadProbeInfo* info, gpointer data) {
  Picture& picture = *static_cast<Picture*>(data);
  switch (GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info))) {
    case GST_EVENT_CAPS:
    case GST_EVENT_SEGMENT:
    case GST_EVENT_EOS:
      send_before_event(pad, picture);
      break;
    case GST_EVENT_FLUSH_STOP:
      gst_clear_buffer_list(&picture.packets);
      break;
    default:
      break;
  }
  return GST_PAD_PROBE_OK;
}

GstPadProbeReturn on_data(GstPad* pad, GstPadProbeInfo* info, gpointer data) {
  const bool event = (GST_PAD_PROBE_INFO_TYPE(info) &
                      (GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM | GST_PAD_PROBE_TYPE_EVENT_FLUSH)) != 0;
  return event ? end_picture(pad, info, data) : collect(pad, info, data);
}

}  // namespace

void send_whole_pictures(GstElement* payloader) {
  g_autoptr(GstPad) pad = gst_element_get_static_pad(payloader, "src");
  gst_pad_add_probe(
      pad, static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_DATA_DOWNSTREAM | GST_PAD_PROBE_TYPE_EVENT_FLUSH),
      on_data, new Picture, [](gpointer picture) { delete static_cast<Picture*>(picture); });
}

}  // namespace cerberus::rtsp
