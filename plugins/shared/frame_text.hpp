// SPDX-License-Identifier: LGPL-2.1-or-later
// What elements share that turn each video frame into one text: a line of JSON, an ONVIF document.
#pragma once

#include <gst/base/gstbasetransform.h>
#include <gst/video/video.h>

#include <string>
#include <string_view>
#include <utility>

#include "cerberus/private/element.hpp"
#include "clock_times.hpp"
#include "complaint.hpp"
#include "stamps.hpp"

namespace cerberus::plugin {

struct TextStream {  // streaming thread only
  int width = 0, height = 0;
  guint64 frame = 0;
  Stamps stamps;
  Complaint complaint;  // about the caps
};

// The functions of a GstBaseTransform from video of any kind to texts. kSelf(transform)->priv has a TextStream
// `stream`, a function camera_name(), and write(buffer, stamp), which returns the text of a frame, valid until the
// next call.
template <auto kSelf>
class FrameText {
 public:
  static void init(GstBaseTransform* transform) {
    gst_base_transform_set_passthrough(transform, FALSE);
    gst_base_transform_set_qos_enabled(transform, FALSE);  // one text a buffer, however late
  }
  static void install(GstBaseTransformClass* klass) {
    klass->start = start;
    klass->transform_caps = transform_caps;
    klass->set_caps = set_caps;
    klass->propose_allocation = propose_allocation;
    klass->generate_output = generate_output;
  }

 private:
  static gboolean start(GstBaseTransform* transform) {
    TextStream& stream = kSelf(transform)->priv->stream;
    stream.frame = 0;
    stream.width = stream.height = 0;
    stream.complaint.forget();
    stream.stamps.reset();
    return TRUE;
  }

  static GstCaps* transform_caps(GstBaseTransform* transform, GstPadDirection direction, GstCaps*,
                                 GstCaps* filter) {
    GstCaps* caps =
        gst_pad_get_pad_template_caps(direction == GST_PAD_SINK ? GST_BASE_TRANSFORM_SRC_PAD(transform)
                                                                : GST_BASE_TRANSFORM_SINK_PAD(transform));
    if (!filter) return caps;
    GstCaps* common = gst_caps_intersect_full(filter, caps, GST_CAPS_INTERSECT_FIRST);
    gst_caps_unref(caps);
    return common;
  }

  static gboolean set_caps(GstBaseTransform* transform, GstCaps* in, GstCaps*) {
    // By hand: GstVideoInfo does not know the formats of every memory.
    TextStream& stream = kSelf(transform)->priv->stream;
    const GstStructure* structure = gst_caps_get_structure(in, 0);
    const bool known = gst_structure_get_int(structure, "width", &stream.width) &&
                       gst_structure_get_int(structure, "height", &stream.height);
    return guarded(transform, FALSE, [&]() -> gboolean {
      const std::string wrong = known ? "" : "The video has no size.";
      if (stream.complaint.is_new(wrong))
        CERBERUS_ELEMENT_ERROR(transform, CORE, NEGOTIATION, (wrong), ("caps %" GST_PTR_FORMAT, in));
      return known;
    });
  }

  // The frame ends here and is only looked at: any stride will do.
  static gboolean propose_allocation(GstBaseTransform*, GstQuery*, GstQuery* query) {
    gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
    return TRUE;
  }

  static GstFlowReturn generate_output(GstBaseTransform* transform, GstBuffer** out) {
    *out = nullptr;
    GstBuffer* in = std::exchange(transform->queued_buf, nullptr);
    if (!in) return GST_FLOW_OK;  // asked again after each text
    const GstFlowReturn flow = guarded(transform, GST_FLOW_ERROR, [&] {
      auto& priv = *kSelf(transform)->priv;
      TextStream& stream = priv.stream;
      const CerberusStamp stamp =
          stream.stamps.frame(GST_BASE_TRANSFORM_SINK_PAD(transform), in,
                              running_time_of(transform->segment, in), priv.camera_name());
      const std::string_view text = priv.write(in, stamp);
      *out = gst_buffer_new_memdup(text.data(), text.size());
      gst_buffer_copy_into(*out, in, GST_BUFFER_COPY_TIMESTAMPS, 0, -1);
      GST_BUFFER_OFFSET(*out) = stream.frame;
      GST_BUFFER_OFFSET_END(*out) = ++stream.frame;
      return GST_FLOW_OK;
    });
    gst_buffer_unref(in);
    return flow;
  }
};

}  // namespace cerberus::plugin
