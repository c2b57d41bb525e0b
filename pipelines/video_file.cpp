// SPDX-License-Identifier: LGPL-2.1-or-later
#include "video_file.h"

#include <gst/video/video.h>

namespace cerberus::demo {

namespace {

// A damaged file can leave decodebin waiting for ever (GStreamer 1.22 may swallow a demuxer's error).
constexpr GstClockTime kPatience = 20 * GST_SECOND;

// decodebin has found every stream. A file with sound only has nothing to link to, and would end in silence.
void on_no_more_pads(GstElement* decoder, gpointer) {
  bool linked = false;
  GstIterator* pads = gst_element_iterate_src_pads(decoder);
  GValue item = G_VALUE_INIT;
  while (gst_iterator_next(pads, &item) == GST_ITERATOR_OK) {
    linked |= gst_pad_is_linked(GST_PAD(g_value_get_object(&item)));
    g_value_reset(&item);
  }
  g_value_unset(&item);
  gst_iterator_free(pads);
  if (!linked)
    GST_ELEMENT_ERROR(decoder, STREAM, WRONG_TYPE, ("There is no picture in it, or no decoder for it."),
                      (nullptr));
}

void on_element(GstBin*, GstBin*, GstElement* element, gpointer) {
  if (g_object_class_find_property(G_OBJECT_GET_CLASS(element), "direct-rendering"))
    g_object_set(element, "direct-rendering", FALSE, nullptr);
}

std::string explain(const std::string& path, GstMessage* message) {
  if (!message) return not_a_video(path) + "no frame came out of it";
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS) return not_a_video(path) + "it has no frame";
  g_autoptr(GError) error = nullptr;
  g_autofree gchar* debug = nullptr;
  gst_message_parse_error(message, &error, &debug);
  if (g_str_equal(GST_OBJECT_NAME(GST_MESSAGE_SRC(message)), "file"))
    return "cannot read " + path + ": " + error->message;
  return not_a_video(path) + error->message;
}

GstElement* named(GstElement* bin, const char* name) {
  return gst_bin_get_by_name(GST_BIN(bin), name);
}

}  // namespace

std::string not_a_video(const std::string& path) {
  return path +
         " is not a video that can be read here (damaged, cut off, of an unknown kind, or without a "
         "picture): ";
}

void decode_with_care(GstElement* pipeline) {
  g_signal_connect(pipeline, "deep-element-added", G_CALLBACK(on_element), nullptr);
}

VideoFile look_at(const std::string& path) {
  VideoFile video;
  g_autoptr(GError) error = nullptr;
  g_autoptr(GstElement) pipeline = gst_parse_launch(
      "filesrc name=file ! decodebin name=decoder ! videoconvert ! videoflip video-direction=auto ! "
      "fakesink name=end",
      &error);
  if (error) {
    video.error = std::string("a part of GStreamer is missing: ") + error->message;
    return video;
  }
  g_autoptr(GstElement) file = named(pipeline, "file");
  g_autoptr(GstElement) decoder = named(pipeline, "decoder");
  g_autoptr(GstElement) end = named(pipeline, "end");
  decode_with_care(pipeline);
  g_object_set(file, "location", path.c_str(), nullptr);
  g_signal_connect(decoder, "no-more-pads", G_CALLBACK(on_no_more_pads), nullptr);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PAUSED);
  g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
      bus, kPatience, GstMessageType(GST_MESSAGE_ASYNC_DONE | GST_MESSAGE_ERROR | GST_MESSAGE_EOS));
  if (message && GST_MESSAGE_TYPE(message) == GST_MESSAGE_ASYNC_DONE) {
    g_autoptr(GstPad) pad = gst_element_get_static_pad(end, "sink");
    g_autoptr(GstCaps) caps = gst_pad_get_current_caps(pad);
    GstVideoInfo info;
    if (caps && gst_video_info_from_caps(&info, caps))
      video.size = {GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)};
    else
      video.error = not_a_video(path) + "it has no frame";
    gint64 length = -1;
    if (gst_element_query_duration(pipeline, GST_FORMAT_TIME, &length) && length > 0)
      video.duration = static_cast<GstClockTime>(length);
  } else {
    video.error = explain(path, message);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  return video;
}

}  // namespace cerberus::demo
