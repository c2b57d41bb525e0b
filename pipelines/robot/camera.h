// SPDX-License-Identifier: LGPL-2.1-or-later
// One camera of the robot: its pipeline, started again after failures, and its head. Everything but frames happens in the
// main loop's thread.
#pragma once

#include <gst/gst.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "robot/backoff.h"
#include "robot/pipeline_text.h"
#include "robot/settings.h"
#include "robot/source/late_frames.h"
#include "rtsp_output.h"
#include "rtsp_source.h"

namespace cerberus::robot {

class Camera {
 public:
  using Clock = std::chrono::steady_clock;

  enum class State {
    off,      // not wanted
    running,  // the pipeline plays
    parking,  // the head returns to zero before it stops, nothing is shown or recorded
    ending,   // the end of the stream is on its way to files
    closing,  // the pipeline stops, in a thread of its own
    waiting,  // it failed and is tried again later
    ended,    // a file is over
  };

  struct Parameters {
    // A network camera needs seconds until its first frame; later a healthy source is never silent for so long.
    Clock::duration stall = std::chrono::seconds(15);
    Clock::duration parking = std::chrono::seconds(5);   // longest way back to zero at 40 degrees a second
    Clock::duration ending = std::chrono::seconds(3);    // for the last fragments of files
    Clock::duration closing = std::chrono::seconds(30);  // longer: the watchdog of the service may restart it
  };

  // Called in the main loop's thread when there is a new picture.
  using OnPicture = std::function<void(Camera&)>;

  // An order that arrived by MQTT and is not for the head: arm, disarm, privacy.
  using OnOrder = std::function<void(const std::string& order)>;

  // A message of mqttpublish whose topic the webhook wants.
  using OnPublish = std::function<void(const Camera&, const std::string& topic, const std::string& payload)>;

  // The head asks the base for so many degrees a second.
  using OnBaseRequest = std::function<void(double yaw_rate)>;

  // `rtsp` outlives the camera.
  Camera(const CameraSettings& settings, SharedSettings shared, RtspOutput& rtsp, OnOrder on_order);
  ~Camera();
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  const CameraSettings& settings() const { return settings_; }
  State state() const { return state_; }
  // Why a part is waiting, or why recording fails; empty: nothing is wrong.
  std::string fault() const { return fault_.empty() ? recording_fault() : fault_; }
  double frames_a_second() const { return rate_; }

  // Runs in this mode; privacy stops the pipeline once the head is parked.
  void set_mode(Mode mode);
  // What a change of settings comes to.
  enum class Change {
    none,      // the pipeline is as before
    live,      // properties were set while it plays
    restarts,  // the pipeline is made anew
  };
  // Takes other settings of the same camera (its name stays).
  Change change(const CameraSettings& settings, SharedSettings shared);
  // Stops for good. is_stopped() tells when that is done.
  void shut_down();
  bool is_stopped() const;
  bool is_stopping() const {
    return state_ == State::parking || state_ == State::ending || state_ == State::closing;
  }
  // Once a second.
  void tick();
  // Whether frames come, or none are expected: what feeds the watchdog.
  bool is_sound() const;

  // What the head does and why (`state` and `reason` of cerberus-pantilt), and whether an event is being recorded.
  const std::string& head_state() const { return head_state_; }
  const std::string& head_reason() const { return head_reason_; }
  bool is_recording() const { return recording_ && recording_fault_.empty(); }
  // The head stands until the next order by hand, or until it is given back.
  bool waits_for_order() const { return kept_stopped_ || head_waits_; }

  void set_on_base_request(OnBaseRequest on_request) { on_base_request_ = std::move(on_request); }
  void set_on_publish(OnPublish on_publish) { on_publish_ = std::move(on_publish); }
  // How often a recording began, ended, failed or was deleted by retention.
  guint64 changes_of_recordings() const { return changes_of_recordings_; }
  // Publishes the newest recording by MQTT, or that there is none.
  void publish_event();
  // Why recordings cannot be made or listed; empty: they can.
  std::string recording_fault() const {
    return recording_fault_.empty() ? "" : "recorder: " + recording_fault_;
  }
  void set_on_picture(OnPicture on_picture) { on_picture_ = std::move(on_picture); }
  // Pictures are only drawn while somebody looks.
  void set_watched(bool watched);
  // The newest picture, JPEG, with its number; nullptr: there is none. The caller unrefs.
  GBytes* picture(guint64& number) const;
  // The line of motionjson of the newest frame, without newline.
  std::string facts() const;

  // How fast the base is to drive, metres a second straight ahead: its PIR sensors pass what stands there.
  void note_base_speed(double speed);

  // Orders for the head: an action signal of pantiltsink. False: there is no head, or it refuses.
  bool turn(double pan_speed, double tilt_speed);  // degrees a second, for 500 ms unless it is repeated
  bool order(const char* signal);                  // stop, home, auto
  bool follow(guint track);

  // Shows what one stage of the detection made (of motionview), or "picture", until nobody watches.
  void set_stage(const std::string& stage);
  const std::string& stage() const { return stage_; }
  // Sets a property while the camera runs; false: it does not, or has no such part.
  bool set_live(const char* element, const char* property, double value);
  // The value in force of a number; nullopt: the camera does not run, or has no such part.
  std::optional<double> live(const char* element, const char* property) const;
  // Milliseconds from a frame's capture until it is analysed.
  double latency() const { return static_cast<double>(latency_) / 1e6; }

 private:
  struct Newest;

  void start();
  void end();     // sends the end of the stream
  void close();   // stops the pipeline, in another thread
  void closed();  // ... done
  void fail(const std::string& part, const std::string& text);
  void diagnose(GstObject* from, const GError* error, const gchar* debug);  // of a network camera
  bool apply(const PipelineText& text, std::string& error);
  bool apply_secrets(std::string& error);
  bool change_live(const PipelineText& before, const PipelineText& after);
  void connect();
  void set_show(bool show);
  void update_draw();
  void set_triggers();
  void publish_mode();
  void publish_recording();
  void set_recording_fault(const std::string& text);
  bool publish(const char* topic, GBytes* payload, bool retain);
  void publish_picture();
  void send_asked_picture();
  void drop_frames(const char* queue, std::atomic<bool>& pass);
  void drop_late_frames();
  template <bool encoded>
  static GstPadProbeReturn drop_if_late(GstPad* pad, GstPadProbeInfo* info, gpointer camera);
  GstElement* element(const char* name) const;
  std::string part_of(GstObject* source) const;
  void on_message(GstMessage* message);
  void on_report(const GstStructure* report);
  bool emit(const char* signal);  // of the head; false: there is none, or it refuses
  void note_order(std::string_view order, bool done);

  CameraSettings settings_;
  SharedSettings shared_;
  RtspOutput& rtsp_;
  OnOrder on_order_;
  OnPicture on_picture_;
  OnPublish on_publish_;
  OnBaseRequest on_base_request_;
  Parameters parameters_;
  Mode mode_ = Mode::privacy;
  State state_ = State::off;
  bool wanted_ = false, again_ = false, final_ = false;
  bool kept_stopped_ =
      false;            // the last order was to stop: the head stands, also when its pipeline starts anew
  bool stale_ = false;  // the settings changed while the head parks: the pipeline is not of these
  Clock::time_point since_{}, last_frame_{}, last_tick_{};
  Parts parts_;
  Backoff camera_backoff_, head_backoff_, recorder_backoff_;
  std::string fault_, head_state_, head_reason_;
  bool head_waits_ = false;  // `waits-for-order` of cerberus-pantilt
  bool recording_ = false;
  guint64 changes_of_recordings_ = 0;
  std::string recording_fault_;      // of the recorder that runs, or why there is none
  std::string published_recording_;  // the last payload of the topic `recording`
  GstElement* pipeline_ = nullptr;
  GstElement *head_ = nullptr, *recorder_ = nullptr;
  RtspSource offered_, offered_record_;  // by the camera, of "uri" and of "record-uri"
  bool diagnosing_ = false;              // why the network camera failed; what follows is not said
  guint bus_watch_ = 0;
  std::atomic<guint64> frames_ = 0;
  guint64 counted_ = 0;
  double rate_ = 0;
  bool watched_ = false;
  guint64 picture_asked_after_ = 0;  // a picture newer than this one is published by MQTT; 0: none is
  std::atomic<bool> parked_ = false, draw_ = false, draw_stage_ = false, record_ = false;
  std::atomic<gint64> latency_ = 0;       // ns
  LateFrames late_;                       // streaming thread
  std::atomic<guint64> late_frames_ = 0;  // dropped and not reported yet
  std::atomic<bool> came_ = false;        // a frame, late or not, since the last tick
  std::string stage_ = "picture";
  std::shared_ptr<Newest> newest_;
};

const char* name(Camera::State state);

}  // namespace cerberus::robot
