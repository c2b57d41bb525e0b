// SPDX-License-Identifier: LGPL-2.1-or-later
// A pirfusion with a harness at its video pads and one at each PIR pad.
#pragma once

// Before gst-check, whose macros redefine names of the standard library.
#include <cmath>
#include <cstdint>
#include <functional>
#include <future>
#include <initializer_list>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <cerberus/cerberus.h>
#include <glib/gstdio.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <unistd.h>

#include "support.h"

namespace rig {

constexpr char kVideo[] = "video/x-raw,format=GRAY8,framerate=25/1,width=16,height=16";
constexpr char kPaper[] =
    "application/x-pir,format=presence,sensors=3,bearings=<0.0,-120.0,120.0>,field-of-view=120.0";
constexpr GstClockTime kMs = GST_MSECOND;

using Bytes = std::vector<guint8>;

inline GstBuffer* frame(GstClockTime time) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 256, nullptr);
  gst_buffer_memset(buffer, 0, 100, 256);
  GST_BUFFER_PTS(buffer) = time;
  return buffer;
}

// A frame with one track.
inline GstBuffer* frame_with(GstClockTime time, guint id, double x = 4,
                             CerberusRegionState state = CERBERUS_REGION_SEEN) {
  GstBuffer* buffer = frame(time);
  CerberusRegion region;
  cerberus_region_init(&region);
  region.id = id;
  region.tracked = id != 0;
  region.x = x;
  region.y = 4;
  region.width = region.height = 4;
  region.state = state;
  fail_unless(cerberus_buffer_add_region(buffer, &region));
  return buffer;
}

inline GstBuffer* reading(GstClockTime time, const Bytes& values) {
  GstBuffer* buffer = gst_buffer_new_memdup(values.data(), values.size());
  GST_BUFFER_PTS(buffer) = time;
  return buffer;
}

inline CerberusPose pose(double pan, GstClockTime from = 0, double speed = 0, const char* head = "head") {
  CerberusPose result;
  cerberus_pose_init(&result);
  cerberus_pose_set_head(&result, head);
  result.pan = pan;
  result.pan_speed = speed;
  result.valid_from = from;
  return result;
}

inline GstBuffer* frame_at(GstClockTime time, double pan) {
  GstBuffer* buffer = frame(time);
  const CerberusPose where = pose(pan, time);
  fail_unless(cerberus_buffer_set_pose(buffer, &where));
  return buffer;
}

inline Bytes sensors(const CerberusFusion& fusion) {
  return {fusion.sensors, fusion.sensors + fusion.n_sensors};
}

inline std::string text(const Bytes& values) {
  std::string result;
  for (const guint8 value : values) result += static_cast<char>('0' + value);
  return result;
}

// (GStreamer's macro for strings keeps a pointer into a temporary.)
inline void assert_says(const std::string& found, const char* expected) {
  fail_unless(found == expected, "\"%s\" is not \"%s\"", found.c_str(), expected);
}

struct Rig {
  GstElement* element;
  GstBus* bus = gst_bus_new();
  GstHarness* video = nullptr;
  std::vector<GstHarness*> pir;

  explicit Rig(bool live = true, const std::string& properties = "") {
    const std::string line = "pirfusion " + properties;
    element = gst_parse_launch(line.c_str(), nullptr);
    fail_unless(element != nullptr, "pirfusion cannot be made");
    gst_object_ref_sink(element);
    gst_element_set_bus(element, bus);
    video = gst_harness_new_with_element(element, "sink", "src");
    gst_harness_set_live(video, live);
    gst_harness_set_src_caps_str(video, kVideo);
  }
  ~Rig() {
    for (GstHarness* each : pir)
      if (each) gst_harness_teardown(each);
    gst_harness_teardown(video);
    gst_element_set_bus(element, nullptr);
    gst_bus_set_flushing(bus, TRUE);
    gst_object_unref(bus);
    gst_object_unref(element);
  }
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  // A PIR pad; without caps nothing was sent to it yet.
  GstHarness* add_pir(const char* caps = kPaper, const char* pad = "pir_%u", bool live = true) {
    GstHarness* h = gst_harness_new_with_element(element, pad, nullptr);
    gst_harness_set_live(h, live);
    if (caps) gst_harness_set_src_caps_str(h, caps);
    pir.push_back(h);
    return h;
  }
  void remove_pir(std::size_t index) { gst_harness_teardown(std::exchange(pir[index], nullptr)); }
  void read(GstClockTime time, const Bytes& values, std::size_t index = 0) {
    fail_unless_equals_int(gst_harness_push(pir[index], reading(time, values)), GST_FLOW_OK);
  }
  CerberusFusion decision() {
    g_autoptr(GstBuffer) out = gst_harness_pull(video);
    fail_unless(out, "no frame came out");
    const CerberusFusion* found = cerberus_buffer_peek_fusion(out);
    fail_unless(found, "nothing was decided");
    return *found;
  }
  CerberusFusion show(GstBuffer* buffer) {
    fail_unless_equals_int(gst_harness_push(video, buffer), GST_FLOW_OK);
    return decision();
  }
  CerberusFusion at(GstClockTime time) { return show(frame(time)); }

  // The next message of this kind; its text (errors, warnings), and nothing where there is none.
  std::string message(GstMessageType type) {
    GstMessage* message = gst_bus_pop_filtered(bus, type);
    if (!message) return {};
    g_autoptr(GError) error = nullptr;
    if (type == GST_MESSAGE_ERROR)
      gst_message_parse_error(message, &error, nullptr);
    else
      gst_message_parse_warning(message, &error, nullptr);
    const std::string result = error->message;
    gst_message_unref(message);
    return result;
  }
  std::string error() { return message(GST_MESSAGE_ERROR); }
  std::string warning() { return message(GST_MESSAGE_WARNING); }
  // Decisions posted as messages since the last call: "time ms:rule:action".
  std::vector<std::string> posted() {
    std::vector<std::string> result;
    while (GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ELEMENT)) {
      g_autoptr(CerberusFusion) fusion = cerberus_message_parse_fusion(message);
      fail_unless(fusion);
      result.push_back(std::to_string(running_time_of(message) / kMs) + ":" + std::to_string(fusion->rule) +
                       ":" + cerberus_fusion_action_get_nick(fusion->action));
      gst_message_unref(message);
    }
    return result;
  }
};

// Something that may wait, done in a thread of its own.
class Pushing {
 public:
  // Comes back when the buffer has reached `pad`'s chain function.
  Pushing(GstHarness* h, GstPad* pad, GstBuffer* buffer) {
    std::promise<void> arriving;
    std::future<void> arrived = arriving.get_future();
    const gulong probe = gst_pad_add_probe(
        pad, GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad*, GstPadProbeInfo*, gpointer promise) {
          static_cast<std::promise<void>*>(promise)->set_value();
          return GST_PAD_PROBE_REMOVE;
        },
        &arriving, nullptr);
    (void)probe;
    result_ = std::async(std::launch::async, [h, buffer] { return gst_harness_push(h, buffer); });
    arrived.wait();
  }
  bool waits() { return result_.wait_for(std::chrono::milliseconds(0)) != std::future_status::ready; }
  GstFlowReturn flow() { return result_.get(); }

 private:
  std::future<GstFlowReturn> result_;
};

inline GstPad* static_pad(GstElement* element, const char* name) {
  GstPad* pad = gst_element_get_static_pad(element, name);
  fail_unless(pad != nullptr, "there is no pad %s", name);
  gst_object_unref(pad);  // the element holds it
  return pad;
}

// Caps of so many sensors, each turned by `step` degrees from the one before.
inline std::string with_sensors(int count, double first, double step, double field = 60) {
  std::string bearings;
  for (int i = 0; i < count; ++i)
    bearings += (i ? "," : "") + std::string("(double)") + std::to_string(static_cast<int>(first + i * step));
  return "application/x-pir,format=presence,sensors=" + std::to_string(count) + ",bearings=<" + bearings +
         ">,field-of-view=(double)" + std::to_string(static_cast<int>(field));
}

// Events that a head or an application sends upstream.
inline void say(Rig& rig, GstEvent* event) {
  gst_harness_push_upstream_event(rig.video, event);
}
inline void say(Rig& rig, const CerberusPose& where) {
  say(rig, cerberus_event_new_pose(&where));
}

// A rule file for one test.
class RuleFile {
 public:
  explicit RuleFile(const std::string& toml) {
    const gint file = g_file_open_tmp("cerberus-XXXXXX.toml", &path_, nullptr);
    fail_unless(file >= 0);
    close(file);
    write(toml);
  }
  ~RuleFile() {
    g_unlink(path_);
    g_free(path_);
  }
  RuleFile(const RuleFile&) = delete;
  RuleFile& operator=(const RuleFile&) = delete;
  void write(const std::string& toml) {
    fail_unless(g_file_set_contents(path_, toml.data(), static_cast<gssize>(toml.size()), nullptr));
  }
  std::string path() const { return path_; }
  std::string property() const { return "rules-file=" + path(); }

 private:
  gchar* path_ = nullptr;
};

}  // namespace rig
