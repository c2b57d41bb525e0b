// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rtsp_server/whole_pictures.h"

#include <cstring>
#include <utility>

namespace cerberus::rtsp {
namespace {

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
    if (header.marker) flow = send(pad, picture);
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

}  // namespace

void send_whole_pictures(GstElement* payloader) {
  g_autoptr(GstPad) pad = gst_element_get_static_pad(payloader, "src");
  gst_pad_add_probe(pad,
                    static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER | GST_PAD_PROBE_TYPE_BUFFER_LIST),
                    collect, new Picture, [](gpointer picture) { delete static_cast<Picture*>(picture); });
}

}  // namespace cerberus::rtsp
