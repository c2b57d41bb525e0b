// SPDX-License-Identifier: LGPL-2.1-or-later
// Measures a head through its camera: control/trials/calibration.h decides, this file connects it with camera and helper.
#include <cerberus/cerberus.h>
#include <gst/gst.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <mutex>
#include <vector>

#include "control/trials/calibration.h"
#include "control/trials/timeout_trial.h"
#include "drivers/head/head_calibration.h"
#include "heads/head_link.h"
#include "heads/tool.h"

namespace cerberus::heads {
namespace {

using control::AxisCalibration;
using motion::Time;
using sensing::degrees;
using sensing::radians;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

struct Turned {
  Time taken{};
  control::Turn turn{kUnknown, kUnknown};
};

class Camera {
 public:
  explicit Camera(const ToolOptions& options) : fov_(radians(options.horizontal_fov)) {
    const std::string line = options.source +
                             " ! cameramotion horizontal-fov=" + std::to_string(options.horizontal_fov) +
                             " ! fakesink name=end sync=false async=false";
    GError* error = nullptr;
    pipeline_ = gst_parse_launch(line.c_str(), &error);
    if (error) problem_ = error->message;
    g_clear_error(&error);
    if (!pipeline_ || !problem_.empty()) return;
    GstElement* end = gst_bin_get_by_name(GST_BIN(pipeline_), "end");
    GstPad* pad = gst_element_get_static_pad(end, "sink");
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, on_frame, this, nullptr);
    gst_object_unref(pad);
    gst_object_unref(end);
    gst_element_set_state(pipeline_, GST_STATE_PLAYING);
  }
  ~Camera() {
    if (!pipeline_) return;
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    gst_object_unref(pipeline_);
  }
  Camera(const Camera&) = delete;

  // The frames since the last call.
  std::vector<Turned> take() {
    const std::lock_guard guard(lock_);
    return std::exchange(frames_, {});
  }
  Time now() const { return Time(static_cast<Time::rep>(gst_element_get_current_running_time(pipeline_))); }
  // Empty: none.
  std::string problem() {
    if (!problem_.empty()) return problem_;
    GstBus* bus = gst_element_get_bus(pipeline_);
    const auto ends = static_cast<GstMessageType>(GST_MESSAGE_ERROR | GST_MESSAGE_EOS);
    GstMessage* message = gst_bus_pop_filtered(bus, ends);
    gst_object_unref(bus);
    if (!message) return {};
    problem_ = "the video ended";
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
      g_autoptr(GError) error = nullptr;
      gst_message_parse_error(message, &error, nullptr);
      problem_ = error->message;
    }
    gst_message_unref(message);
    return problem_;
  }

 private:
  static GstPadProbeReturn on_frame(GstPad* pad, GstPadProbeInfo* info, gpointer self) {
    static_cast<Camera*>(self)->add(pad, GST_PAD_PROBE_INFO_BUFFER(info));
    return GST_PAD_PROBE_OK;
  }
  void add(GstPad* pad, GstBuffer* buffer) {
    GstCaps* caps = gst_pad_get_current_caps(pad);
    GstEvent* segment_event = gst_pad_get_sticky_event(pad, GST_EVENT_SEGMENT, 0);
    GstVideoInfo video;
    const GstSegment* segment = nullptr;
    if (segment_event) gst_event_parse_segment(segment_event, &segment);
    const CerberusCameraMotion* motion = cerberus_buffer_peek_camera_motion(buffer);
    if (caps && segment && gst_video_info_from_caps(&video, caps)) {
      Turned frame;
      frame.taken = Time(static_cast<Time::rep>(
          gst_segment_to_running_time(segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer))));
      if (motion) {
        control::PictureMotion picture{{}, motion->confidence, {video.width, video.height}, 0};
        std::copy(std::begin(motion->matrix), std::end(motion->matrix), picture.transform.m.begin());
        const vision::Lens lens(fov_, picture.picture);
        const std::lock_guard guard(lock_);
        frame.turn = control::head_turn(picture, lens, look_).value_or(frame.turn);
        if (std::isfinite(frame.turn.pitch)) look_.tilt += frame.turn.pitch;
      }
      const std::lock_guard guard(lock_);
      frames_.push_back(frame);
    }
    if (caps) gst_caps_unref(caps);
    if (segment_event) gst_event_unref(segment_event);
  }

  double fov_;
  GstElement* pipeline_ = nullptr;
  std::string problem_;
  std::mutex lock_;
  std::vector<Turned> frames_;
  motion::PanTilt look_;
};

struct Session {
  const ToolOptions& options;
  Camera& camera;
  HeadLink& link;
  Keys& keys;

  // What ends the work; empty: nothing.
  std::string serve() {
    if (keys.pressed()) return "ended by a key";
    if (std::string wrong = link.serve(5); !wrong.empty()) return wrong;
    return camera.problem();
  }

  std::string measure(AxisCalibration& axis, bool is_pan) {
    std::printf("%s: about %.0f s\n", is_pan ? "pan" : "tilt", axis.seconds_left());
    std::fflush(stdout);
    for (;;) {
      const auto speed = axis.command(camera.now());
      if (!speed) break;
      link.turn(is_pan ? *speed : 0, is_pan ? 0 : *speed);
      if (std::string wrong = serve(); !wrong.empty()) return wrong;
      for (const Turned& frame : camera.take())
        axis.add(frame.taken, is_pan ? frame.turn.yaw : frame.turn.pitch);
    }
    link.stop();
    return axis.problem();
  }

  // Kills the helper while the head turns slowly, and looks whether it stops. Then a new helper stops it: at once if
  // the picture shows the head at the end of its reach, or a key is pressed. Returns what is wrong.
  std::string try_timeout(const control::TimeoutTrial& trial, double position, double reach,
                          control::TimeoutWatch::End& end, std::optional<double>& stopped) {
    using End = control::TimeoutWatch::End;
    control::TimeoutWatch watch(trial, position, reach);
    const auto ends = [&] {
      for (const Turned& frame : camera.take()) watch.add(now_seconds(), frame.turn.yaw);
      if (keys.pressed()) watch.press_key();
      return end = watch.end(now_seconds());
    };
    camera.take();
    link.turn(trial.speed, 0);
    for (const double kill = now_seconds() + trial.lead; now_seconds() < kill && ends() == End::none;) {
      std::string wrong = link.serve(5);
      if (wrong.empty()) wrong = camera.problem();
      if (!wrong.empty()) return wrong;
    }
    if (end != End::none) {
      link.stop();
      return end == End::key ? "" : "the head reached its limits before its helper could be killed";
    }
    link.kill();
    watch.kill(now_seconds());
    while (ends() == End::none) g_usleep(10000);
    if (end == End::stopped) stopped = watch.stopped_after();
    std::string wrong = start_again();
    if (wrong.empty()) link.stop();
    return wrong;
  }

  // Starts a new helper, which stops the head. Returns what is wrong.
  std::string start_again() {
    keys.clear();
    return link.start_again([this] { return keys.pressed(); });
  }
};

// What was found of an axis, and how far its runs lay apart.
void report_axis(const char* name, const AxisCalibration& axis) {
  const double degree = radians(1);
  const motion::SpeedMap speeds = axis.speeds();
  if (speeds.points().empty()) return;
  std::printf("%s dead time %.0f ms (%s), backlash %.2f degrees (%s)\n", name, axis.dead_time() * 1e3,
              axis.dead_time_runs().text(1e-3, 0).c_str(), degrees(axis.backlash()),
              axis.backlash_runs().text(degree, 2).c_str());
  for (const auto& point : speeds.points())
    std::printf("%s %5.1f is %6.2f degrees a second (%s)\n", name, degrees(point.commanded),
                degrees(point.actual), axis.speed_runs(point.commanded).text(degree, 2).c_str());
  if (const auto far = axis.far_apart(); far.commanded > 0)
    std::printf(
        "%s: the runs at %.1f degrees a second lie %.0f %% apart: something moved in the picture, it shows "
        "too "
        "little, or the head does not turn evenly; measure again\n",
        name, degrees(far.commanded), far.share * 100);
}

void report(const drivers::HeadCalibration& found, const AxisCalibration& pan, const AxisCalibration& tilt,
            control::TimeoutWatch::End trial) {
  using End = control::TimeoutWatch::End;
  report_axis("pan ", pan);
  report_axis("tilt", tilt);
  if (found.stops_alone)
    std::printf("without its helper the head stopped after %.1f s\n", *found.stops_alone);
  else if (trial == End::none)
    std::printf("whether it stops without its helper was not tried: the limits leave no room for it\n");
  else if (trial == End::key)
    std::printf("whether it stops without its helper is not known: a key ended the trial\n");
  else if (trial == End::unseen)
    std::printf("whether it stops without its helper is not known: the picture did not show it\n");
  else
    std::printf("without its helper the head goes on turning: it needs limits of its own\n");
}

}  // namespace

int calibrate_head(const ToolOptions& options) {
  const auto fail = [](const std::string& why) {
    std::fprintf(stderr, "cerberus-heads: %s\n", why.c_str());
    return 1;
  };
  if (!(options.horizontal_fov > 1 && options.horizontal_fov < 179))
    return fail("--horizontal-fov is needed: without it no pixel is an angle");
  const motion::Limits& limits = options.setup.limits;
  const auto reach = [](const motion::AxisLimits& axis) { return std::min(-axis.from, axis.to); };
  AxisCalibration pan(reach(limits.pan), limits.pan.speed), tilt(reach(limits.tilt), limits.tilt.speed);
  char text[400];
  std::snprintf(text, sizeof text,
                "The head will move for about %.0f s, at most %.0f degrees to each side and %.0f up and down "
                "from where "
                "it looks now. Nothing else may move the camera, and it needs something to see.",
                pan.seconds_left() + tilt.seconds_left() + 10, degrees(reach(limits.pan)),
                degrees(reach(limits.tilt)));
  if (!options.yes && !Keys::ask(text)) return 1;
  Camera camera(options);
  const double end = now_seconds() + 10;
  for (std::size_t seen = 0; camera.problem().empty() && seen < 2; seen += camera.take().size()) {
    if (now_seconds() > end) return fail("no video comes from --source");
    g_usleep(20000);
  }
  if (!camera.problem().empty()) return fail(camera.problem());
  HeadLink link;
  if (const std::string wrong = link.start(options.driver, options.setup); !wrong.empty()) return fail(wrong);
  if (!link.abilities().velocity) return fail("the head goes to angles only: there are no speeds to measure");
  Keys keys;
  Session session{options, camera, link, keys};
  drivers::HeadCalibration found;
  std::string wrong = session.measure(pan, true);
  if (wrong.empty() && reach(limits.tilt) > 0) wrong = session.measure(tilt, false);
  const auto trial = control::plan_timeout_trial(pan.speeds(), pan.position(), reach(limits.pan));
  auto trial_end = control::TimeoutWatch::End::none;
  if (wrong.empty() && trial)
    wrong = session.try_timeout(*trial, pan.position(), reach(limits.pan), trial_end, found.stops_alone);
  if (const std::string ended = link.finish(); wrong.empty()) wrong = ended;
  if (!wrong.empty()) return fail(wrong);
  found.driver = options.driver;
  found.device = drivers::calibrated_device(options.driver, options.setup.device, options.setup.command);
  found.pan = pan.speeds();
  found.tilt = tilt.speeds();
  if (found.pan.points().empty()) return fail("the head does not turn, or the picture does not show it");
  found.dead_time = Time(static_cast<Time::rep>(pan.dead_time() * 1e9));
  found.pan_backlash = pan.backlash();
  found.tilt_backlash = tilt.backlash();
  report(found, pan, tilt, trial_end);
  std::ofstream file(options.output, std::ios::binary);
  if (!(file << drivers::calibration_text(found)).flush()) return fail(options.output + " cannot be written");
  std::printf("written: %s (pantiltsink calibration=%s)\n", options.output.c_str(), options.output.c_str());
  return 0;
}

}  // namespace cerberus::heads
