// SPDX-License-Identifier: LGPL-2.1-or-later
// Whole pipelines around the loop, from camera and sensors to the head and back.
#pragma once

#include <string>

#include "scene.h"
#include "support.h"

namespace loop {

// The begin of a launch line: a video of a person who walks before a wall, `scene::World`, 320 x 240.
inline std::string film(int frames, const std::string& more = "", const char* rate = "25/1") {
  return "videotestsrc name=film num-buffers=" + std::to_string(frames) + " " + more +
         " ! video/x-raw,format=GRAY8,width=320,height=240,framerate=" + rate + " ! ";
}

class Pipeline {
 public:
  // `world`: what the film shows.
  explicit Pipeline(const std::string& launch, const scene::World& world = {}) : world_(world) {
    GError* error = nullptr;
    element_ = gst_parse_launch(launch.c_str(), &error);
    fail_unless(element_ && !error, "%s: %s", launch.c_str(), error ? error->message : "");
    gst_object_ref_sink(element_);
    bus_ = gst_element_get_bus(element_);
    GstElement* source = gst_bin_get_by_name(GST_BIN(element_), "film");
    if (!source) return;
    GstPad* pad = gst_element_get_static_pad(source, "src");
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, paint, &world_, nullptr);
    gst_object_unref(pad);
    gst_object_unref(source);
  }
  ~Pipeline() {
    stop();
    gst_object_unref(bus_);
    gst_object_unref(element_);
  }
  Pipeline(const Pipeline&) = delete;

  GstElement* element() const { return element_; }
  // Removes the frames for which missing(number) is true. To be called before the pipeline plays, and once.
  template <typename Missing>
  void leave_out(Missing& missing) {
    GstElement* source = gst_bin_get_by_name(GST_BIN(element_), "film");
    GstPad* pad = gst_element_get_static_pad(source, "src");
    gst_pad_add_probe(
        pad, GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad*, GstPadProbeInfo* info, gpointer function) {
          const auto number =
              static_cast<int>(GST_BUFFER_PTS(GST_PAD_PROBE_INFO_BUFFER(info)) / scene::kStep);
          return (*static_cast<Missing*>(function))(number) ? GST_PAD_PROBE_DROP : GST_PAD_PROBE_OK;
        },
        &missing, nullptr);
    gst_object_unref(pad);
    gst_object_unref(source);
  }
  // Calls see(buffer) for each one at the sink pad of the element of this name, as long as the pipeline lives.
  template <typename See>
  void watch(const char* name, See& see) {
    GstElement* element = gst_bin_get_by_name(GST_BIN(element_), name);
    GstPad* pad = gst_element_get_static_pad(element, "sink");
    gst_pad_add_probe(
        pad, GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad*, GstPadProbeInfo* info, gpointer function) {
          (*static_cast<See*>(function))(GST_PAD_PROBE_INFO_BUFFER(info));
          return GST_PAD_PROBE_OK;
        },
        &see, nullptr);
    gst_object_unref(pad);
    gst_object_unref(element);
  }
  void play() {
    fail_if(gst_element_set_state(element_, GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE, "%s",
            failure().c_str());
  }
  void stop() {
    fail_unless_equals_int(gst_element_set_state(element_, GST_STATE_NULL), GST_STATE_CHANGE_SUCCESS);
  }
  void wait_for_end() {
    const auto ends = static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
    GstMessage* message = gst_bus_timed_pop_filtered(bus_, GST_CLOCK_TIME_NONE, ends);
    const std::string error = text(message);
    gst_message_unref(message);
    fail_unless(error.empty(), "%s", error.c_str());
  }
  // Until an element message of this name has come.
  void wait_for_message(const char* name) {
    const auto wanted = static_cast<GstMessageType>(GST_MESSAGE_ELEMENT | GST_MESSAGE_ERROR);
    for (bool come = false; !come;) {
      GstMessage* message = gst_bus_timed_pop_filtered(bus_, GST_CLOCK_TIME_NONE, wanted);
      const std::string error = text(message);
      come = gst_message_has_name(message, name);
      gst_message_unref(message);
      fail_unless(error.empty(), "%s", error.c_str());
    }
  }
  // What went wrong so far; empty: nothing.
  std::string failure() {
    GstMessage* message = gst_bus_pop_filtered(bus_, GST_MESSAGE_ERROR);
    const std::string error = message ? text(message) : "";
    if (message) gst_message_unref(message);
    return error;
  }

 private:
  static std::string text(GstMessage* message) {
    if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_ERROR) return {};
    g_autoptr(GError) error = nullptr;
    gst_message_parse_error(message, &error, nullptr);
    return error->message;
  }
  // A test source's frame is replaced by one of the walk.
  static GstPadProbeReturn paint(GstPad*, GstPadProbeInfo* info, gpointer world) {
    GstBuffer* blank = GST_PAD_PROBE_INFO_BUFFER(info);
    const auto frame = static_cast<int>(GST_BUFFER_OFFSET(blank));
    GstBuffer* painted = scene::grey_buffer(*static_cast<scene::World*>(world), frame);
    gst_buffer_copy_into(painted, blank, GST_BUFFER_COPY_TIMESTAMPS, 0, -1);
    gst_buffer_unref(blank);
    GST_PAD_PROBE_INFO_DATA(info) = painted;
    return GST_PAD_PROBE_OK;
  }

  scene::World world_;
  GstElement* element_;
  GstBus* bus_;
};

}  // namespace loop
