// SPDX-License-Identifier: LGPL-2.1-or-later
// pantiltsink in a live pipeline, its helper process and an emulated VISCA camera, in real time.
#pragma once

#include <cerberus/cerberus.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include "support/visca_camera.h"

#include <gst/check/gstcheck.h>  // last: it defines fail()

namespace visca_rig {

using namespace std::chrono_literals;
using cerberus::tests::ViscaCamera;
using cerberus::tests::ViscaFaults;
using Clock = std::chrono::steady_clock;

template <typename Condition>
bool until(Condition holds) {
  for (const auto end = Clock::now() + 30s; Clock::now() < end; std::this_thread::sleep_for(5ms))
    if (holds()) return true;
  return false;
}

struct Pipeline {
  GstElement *pipeline, *head;
  std::string warned;
  std::atomic<double> pan_ = 0;

  explicit Pipeline(const std::string& device, const char* properties = "") {
    g_autoptr(GError) error = nullptr;
    const std::string line =
        "videotestsrc is-live=true ! video/x-raw,width=160,height=120,framerate=25/1 ! pantiltsink name=head "
        "driver=visca watchdog-timeout=0 device=" +
        device + " " + properties;
    pipeline = gst_parse_launch(line.c_str(), &error);
    fail_unless(pipeline && !error, "%s", error ? error->message : "");
    head = gst_bin_get_by_name(GST_BIN(pipeline), "head");
    g_autoptr(GstPad) pad = gst_element_get_static_pad(head, "sink");
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_EVENT_UPSTREAM, on_event, this, nullptr);
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
  }
  ~Pipeline() {
    stop();
    gst_object_unref(head);
    gst_object_unref(pipeline);
  }
  Pipeline(const Pipeline&) = delete;
  void stop() const { gst_element_set_state(pipeline, GST_STATE_NULL); }
  bool move_to(double pan) const {
    gboolean done = FALSE;
    g_signal_emit_by_name(head, "move-to", pan, 0.0, &done);
    return done;
  }
  // Of the last published pose, degrees.
  double pan() const { return pan_; }
  // The texts of all warnings so far.
  const std::string& warnings() {
    g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
    while (GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING)) {
      g_autoptr(GError) error = nullptr;
      gst_message_parse_warning(message, &error, nullptr);
      warned.append(error->message).append("\n");
      gst_message_unref(message);
    }
    return warned;
  }

 private:
  static GstPadProbeReturn on_event(GstPad*, GstPadProbeInfo* info, gpointer self) {
    if (CerberusPose* pose = cerberus_event_parse_pose(GST_PAD_PROBE_INFO_EVENT(info))) {
      static_cast<Pipeline*>(self)->pan_ = pose->pan;
      cerberus_pose_free(pose);
    }
    return GST_PAD_PROBE_OK;
  }
};

}  // namespace visca_rig
