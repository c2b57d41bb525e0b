// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-rtponvifmetapay
 * @title: rtponvifmetapay
 * @short_description: RTP packets of ONVIF metadata
 * @see_also: onvifmeta
 *
 * Sends ONVIF metadata as RTP (ONVIF Streaming Specification, 5.1.2.1.1): media `application`, encoding
 * `VND.ONVIF.METADATA`, clock rate 90000. A document may be cut at any byte; the last packet of each has the marker bit,
 * and all have the document's time stamp. A receiver that lost a packet discards what it has up to the next marker.
 *
 * Pads: `sink` takes `application/x-onvif-metadata`, a document a buffer; `src` gives RTP. Put it on a mount of an RTSP
 * server as `pay1`, beside the video's `pay0`.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 pattern=ball ! motiondetect ! onvifmeta ! rtponvifmetapay ! fakesink
 * ]|
 *
 * Since: 0.1
 */
#include <gst/rtp/rtp.h>

#include <algorithm>

#include "cerberus/private/element.hpp"
#include "onvif_caps.hpp"

namespace {

GST_DEBUG_CATEGORY_STATIC(rtponvifmetapay_debug);
#define GST_CAT_DEFAULT rtponvifmetapay_debug

constexpr char kEncoding[] = "VND.ONVIF.METADATA";
constexpr guint kClockRate = 90000;

GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS,
                                                             GST_STATIC_CAPS(cerberus::plugin::kOnvifCaps));
GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE(
    "src", GST_PAD_SRC, GST_PAD_ALWAYS,
    GST_STATIC_CAPS(
        "application/x-rtp, media=(string)application, payload=(int)[96, 127], clock-rate=(int)90000, "
        "encoding-name=(string)VND.ONVIF.METADATA"));

struct Private {};

CERBERUS_DEFINE_TYPE(CerberusRtpOnvifMetaPay, cerberus_rtp_onvif_meta_pay, GstRTPBasePayload,
                     GST_TYPE_RTP_BASE_PAYLOAD, Private)

gboolean cerberus_rtp_onvif_meta_pay_set_caps(GstRTPBasePayload* payload, GstCaps*) {
  gst_rtp_base_payload_set_options(payload, "application", TRUE, kEncoding, kClockRate);
  return gst_rtp_base_payload_set_outcaps(payload, nullptr);
}

GstFlowReturn cerberus_rtp_onvif_meta_pay_handle_buffer(GstRTPBasePayload* payload, GstBuffer* document) {
  const GstFlowReturn flow = cerberus::guarded(payload, GST_FLOW_ERROR, [&] {
    const gsize size = gst_buffer_get_size(document);
    const gsize room = gst_rtp_buffer_calc_payload_len(GST_RTP_BASE_PAYLOAD_MTU(payload), 0, 0);
    if (room == 0) {
      CERBERUS_ELEMENT_ERROR(payload, RESOURCE, SETTINGS, ("mtu is too small for RTP: make it larger."),
                             (nullptr));
      return GST_FLOW_ERROR;
    }
    GstBufferList* packets = gst_buffer_list_new();
    for (gsize at = 0; at < size; at += room) {
      const gsize length = std::min(room, size - at);
      GstBuffer* packet = gst_rtp_base_payload_allocate_output_buffer(payload, 0, 0, 0);
      GstRTPBuffer rtp = GST_RTP_BUFFER_INIT;
      gst_rtp_buffer_map(packet, GST_MAP_WRITE, &rtp);
      gst_rtp_buffer_set_marker(&rtp, at + length == size);
      gst_rtp_buffer_unmap(&rtp);
      if (at + length == size) GST_BUFFER_FLAG_SET(packet, GST_BUFFER_FLAG_MARKER);
      gst_buffer_copy_into(packet, document, GST_BUFFER_COPY_TIMESTAMPS, 0, -1);
      GST_BUFFER_OFFSET(packet) = GST_BUFFER_OFFSET_NONE;  // the base class takes it for clock ticks
      packet =
          gst_buffer_append(packet, gst_buffer_copy_region(document, GST_BUFFER_COPY_MEMORY, at, length));
      gst_buffer_list_add(packets, packet);
    }
    return gst_rtp_base_payload_push_list(payload, packets);
  });
  gst_buffer_unref(document);
  return flow;
}

void cerberus_rtp_onvif_meta_pay_init(CerberusRtpOnvifMetaPay*) {}

void cerberus_rtp_onvif_meta_pay_class_init(CerberusRtpOnvifMetaPayClass* klass) {
  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  gst_element_class_set_static_metadata(element, "RTP ONVIF metadata payloader",
                                        "Codec/Payloader/Network/RTP", "Sends ONVIF metadata in RTP packets",
                                        "The Cerberus developers");
  gst_element_class_add_static_pad_template(element, &sink_template);
  gst_element_class_add_static_pad_template(element, &src_template);

  GstRTPBasePayloadClass* payload = GST_RTP_BASE_PAYLOAD_CLASS(klass);
  payload->set_caps = cerberus_rtp_onvif_meta_pay_set_caps;
  payload->handle_buffer = cerberus_rtp_onvif_meta_pay_handle_buffer;
}

}  // namespace

CERBERUS_REGISTER_ELEMENT(rtponvifmetapay, GST_RANK_NONE, cerberus_rtp_onvif_meta_pay, rtponvifmetapay_debug,
                          "RTP payloader of ONVIF metadata")
