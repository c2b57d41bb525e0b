// SPDX-License-Identifier: LGPL-2.1-or-later
#include "encoder_choice.h"

#include <gst/gst.h>

#include "publish/streams/encoders.h"

namespace cerberus::robot {

namespace {

// The main loop waits for it when the configuration is read again, and the service's watchdog bites after 30 s. Several
// times what a device takes to begin.
constexpr GstClockTime kLongestTrial = 3 * GST_SECOND;

// A driver may be there without its device.
bool works(const publish::Encoder& encoder) {
  const std::string line =
      "videotestsrc num-buffers=5 ! video/x-raw,format=I420,width=640,height=480,framerate=25/1 ! " +
      publish::encoder_line(encoder, 50, 2000) + " ! fakesink";
  g_autoptr(GstElement) pipeline = gst_parse_launch(line.c_str(), nullptr);
  if (!pipeline) return false;
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  g_autoptr(GstMessage) end = gst_bus_timed_pop_filtered(
      bus, kLongestTrial, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  gst_element_set_state(pipeline, GST_STATE_NULL);
  return end && GST_MESSAGE_TYPE(end) == GST_MESSAGE_EOS;
}

std::string first_of_h264() {
  for (const publish::Encoder& encoder : publish::encoders()) {
    if (encoder.codec != kAnyH264) continue;
    g_autoptr(GstElementFactory) factory = gst_element_factory_find(std::string(encoder.element).c_str());
    if (!factory) continue;
    if (!encoder.hardware || works(encoder)) return std::string(encoder.element);
    g_printerr("cerberusd: %s is here and does not work: passed over\n",
               std::string(encoder.element).c_str());
  }
  return EncoderSettings{}.element;  // where it is missing, that is said when it is needed
}

}  // namespace

void choose_encoders(Settings& settings) {
  const auto choose = [](EncoderSettings& encoder) {
    if (encoder.element != kAnyH264) return;
    static const std::string found = first_of_h264();
    encoder.element = found;
  };
  for (CameraSettings& camera : settings.cameras)
    if (camera.recorder) choose(camera.recorder->encoder);
  if (settings.rtsp) choose(settings.rtsp->encoder);
}

}  // namespace cerberus::robot
