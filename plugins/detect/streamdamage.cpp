// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-streamdamage
 * @title: streamdamage
 * @short_description: Marks the frames that decode to damaged pictures
 * @see_also: motiondetect
 *
 * Put it between the depayloader and the decoder of a stream that may lose packets. After a loss (`rtph264depay` and
 * its relatives mark it by DISCONT) every frame up to the next keyframe decodes to a damaged picture, because it is
 * predicted from damaged ones; decoders conceal what is missing and report nothing. This element attaches a meta to
 * these frames, which the decoder copies to their pictures. `motiondetect` and its stages treat such a picture as a
 * repetition of the last whole one: they publish the last result, set the flags GAP and CORRUPTED, and learn nothing
 * from it.
 *
 * Nothing is found while the picture is damaged, and tracks that are published meanwhile are old. Use it with short
 * distances between keyframes (a second or less) or with `request-keyframe=true` of the depayloader, where the sender
 * answers; where much is lost, `request-keyframe=true` alone finds more: docs/manual/recorders.md has figures. Where
 * no keyframe comes for 25 seconds, as with intra refresh, no picture counts as damaged. The stream itself is passed
 * on unchanged, to recorders, too.
 *
 * Pads: one sink, one src, encoded video whose buffers are whole frames (`alignment=au`).
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 pattern=ball ! \
 *     videoconvertscale ! video/x-raw,format=I420,width=[2,8192,2],height=[2,8192,2] ! \
 *     x264enc tune=zerolatency ! rtph264pay ! \
 *     rtph264depay request-keyframe=true ! streamdamage ! avdec_h264 ! motiondetect ! fakesink
 * ]|
 *
 * Since: 0.1
 */
#include <gst/base/gstbasetransform.h>

#include "cerberus/private/element.hpp"
#include "damage_mark.hpp"
#include "vision/stream_damage.h"

namespace {

GST_DEBUG_CATEGORY_STATIC(streamdamage_debug);
#define GST_CAT_DEFAULT streamdamage_debug

using cerberus::vision::StreamDamage;

// Not video/mpeg: its depayloaders do not mark the frames that are no keyframes.
#define ENCODED_VIDEO "video/x-h264; video/x-h265; video/x-vp8; video/x-vp9; video/x-av1; image/jpeg"

GstStaticPadTemplate sink_template =
    GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(ENCODED_VIDEO));
GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(ENCODED_VIDEO));

struct Private {
  StreamDamage damage;  // streaming thread
};

CERBERUS_DEFINE_TYPE(CerberusStreamDamage, cerberus_stream_damage, GstBaseTransform, GST_TYPE_BASE_TRANSFORM,
                     Private)

GstFlowReturn cerberus_stream_damage_transform_ip(GstBaseTransform* trans, GstBuffer* buffer) {
  StreamDamage::Unit unit;
  unit.after_loss = GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DISCONT);
  unit.keyframe = !GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DELTA_UNIT);
  const GstClockTime time = GST_BUFFER_DTS_OR_PTS(buffer);
  if (GST_CLOCK_TIME_IS_VALID(time))
    unit.time = StreamDamage::Time(static_cast<StreamDamage::Time::rep>(time));
  if (cerberus_stream_damage_self(trans)->priv->damage.add(unit)) cerberus::plugin::mark_damaged(buffer);
  return GST_FLOW_OK;
}

gboolean cerberus_stream_damage_sink_event(GstBaseTransform* trans, GstEvent* event) {
  const GstEventType type = GST_EVENT_TYPE(event);
  if (type == GST_EVENT_FLUSH_STOP || type == GST_EVENT_SEGMENT || type == GST_EVENT_STREAM_START)
    cerberus_stream_damage_self(trans)->priv->damage.begin();
  return cerberus_stream_damage_parent_class()->sink_event(trans, event);
}

void cerberus_stream_damage_init(CerberusStreamDamage* self) {
  // Not passthrough: the base class makes buffers writable for the meta then; their memory stays shared.
  gst_base_transform_set_in_place(GST_BASE_TRANSFORM(self), TRUE);
  gst_base_transform_set_passthrough(GST_BASE_TRANSFORM(self), FALSE);
  gst_base_transform_set_gap_aware(GST_BASE_TRANSFORM(self), TRUE);
}

void cerberus_stream_damage_class_init(CerberusStreamDamageClass* klass) {
  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  gst_element_class_set_static_metadata(element, "Stream damage", "Filter/Video",
                                        "Marks the frames that decode to damaged pictures after lost packets",
                                        "The Cerberus developers");
  gst_element_class_add_static_pad_template(element, &sink_template);
  gst_element_class_add_static_pad_template(element, &src_template);
  GstBaseTransformClass* trans = GST_BASE_TRANSFORM_CLASS(klass);
  trans->transform_ip = cerberus_stream_damage_transform_ip;
  trans->sink_event = cerberus_stream_damage_sink_event;
}

}  // namespace

CERBERUS_REGISTER_ELEMENT(streamdamage, GST_RANK_NONE, cerberus_stream_damage, streamdamage_debug,
                          "marks of damaged pictures")
