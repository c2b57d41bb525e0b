// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-pantiltsink
 * @title: pantiltsink
 * @short_description: turns a pan-tilt head towards what the camera and the sensors found
 * @see_also: pirfusion, virtualptz, motiontrack
 *
 * Reads from each video frame what the head is to do, and drives
 * the head through a driver. The pixels are not read.
 *
 * What to do comes from the fusion meta (`pirfusion`): track, turn left or right, search a sector, return to zero,
 * hold. Without it the head follows the tracked regions (`motiontrack`, `motiondetect`): the one it follows already,
 * else the nearest, largest or newest (`target`); without a track for `return-delay` it returns to zero.
 *
 * A pixel becomes an angle through the lens (`horizontal-fov`), with the pose that the head had when the frame was
 * taken: the pose meta of the frame if it is this head's, else the element's own memory. The head goes with its target:
 * the target's place and speed are estimated where it moves, in the world, and predicted to the time at which a command
 * takes effect. `response` says how closely. Before a target that stands the head rests. It turns to a known direction at
 * `max-speed`, and searches and returns to zero at `turn-speed`; a search begins where the target left. It never passes
 * `pan-min`, `pan-max`, `tilt-min`, `tilt-max`, which must include 0. Tilt holds unless a target is tracked or the head
 * returns to zero.
 * Limits, `max-speed` and `max-acceleration` that change while it plays apply at once: a head beyond a new
 * limit returns to it (in PAUSED: when that ends). Invalid limits cause a warning, and the old ones stay in force.
 *
 * Live, a decision that `pirfusion` makes between two frames because a sensor changed (the event `cerberus-fusion`, in
 * the name of this head or of any) is executed at once as if the last frame carried it: in the same states and within
 * the same limits, and only while frames with decisions come. A target is followed with frames alone.
 *
 * A head that reports its zoom (`visca`, `pelco-d`, `onvif`, `v4l2`, `external`) sees what `zoom-table` says, which counts in place
 * of `horizontal-fov` and is part of its poses (`field-of-view`); `lock-zoom` keeps the zoom instead. With neither a
 * warning says that every angle depends on it. With `keep-size` the zoom of such a head (also of a `simulated` one, which
 * has a zoom where it has a table) slowly keeps a followed person at a third of the picture's height: twice as near within
 * five seconds, only while the person is seen, no nearer while it is off the middle, and never by an order by hand, during
 * an emergency stop or after the watchdog's stop.
 *
 * The newest frame counts: one whose running time is not newer than the last one's is dropped. A single time stamp more
 * than 10 s ahead is taken for a mistake, unless the clock of a live pipeline has reached it: the frame counts as if it
 * followed at the usual distance. Where the times have gone back, the third frame begins anew; in a live pipeline only if
 * the clock has not reached the time from which they went back. The element never waits for the clock and sends no QoS
 * events upstream.
 *
 * Each pose of the head goes upstream as the event `cerberus-pose`. In a live pipeline, or with a real head, it is sent
 * at every change of plan and at 50 Hz while the head moves, 5 Hz while it rests, and when no frame comes for
 * `watchdog-timeout` the head stops. This needs a thread; if the system provides none, the element posts an error and
 * refuses PLAYING or the frames of a live stream, so that no head moves without its watchdog. In a pipeline that is not
 * live a simulated head's time is the running time of the frames, never a clock: each frame is answered with the poses
 * until its running time plus `latency` (or until the next frame, if that is later), so that a source upstream can keep
 * in step with it and two runs give the same.
 * Listeners upstream use those poses only where no queue lies between (see `cameramotion`, `pirfusion`).
 *
 * In PAUSED, at the end of the stream, on a flush and when the element stops the head brakes and stays. A manual
 * command continues after PAUSED, but not after the end of the stream, nor when frames came and stay away for
 * `watchdog-timeout`: then the head stands until the next command or `auto`. At the end of the stream `move-to`,
 * `move-by`, `home` and `follow` are refused until a flush; before the first frame a manual command is executed.
 * The bins around the element may post PLAYING once more before the end of the stream.
 * Driver calls are made on a thread of their own; a driver that blocks delays no change of state by more than 100 ms. A
 * driver that cannot be opened is an error, however late that is found, and in PAUSED too; one that fails later is a
 * warning and the state `fault`, until it answers again: the video goes on.
 *
 * Element messages: `cerberus-pantilt` with `state` (`stopped`, `tracking`, `turning`, `searching`, `zeroing`,
 * `holding`, `manual`, `limited`, `fault`, `homing`), `reason` and `waits-for-order` (boolean: only the next signal that
 * moves the head, or `auto`, ends its rest) at every change of one of them.
 *
 * A person who crosses behind the head leaves the limits on one side and comes back on the other. The head waits at the
 * limit while the person is in the picture from there; where the person leaves it, the head turns all the way round if
 * it meets the person on the other side within 8 s and no later than here (state `turning`). With `base-turn` it asks the
 * body below it to turn instead, from 20 degrees before the limit on until 45 degrees of room are left: the element message
 * `cerberus-base-request` with `yaw-rate` (double, degrees a second, positive to the right) and `head`, ten times a second,
 * and one of 0 at the end. It ends when the person is not seen, with an order by hand, an emergency stop, a fault, the
 * watchdog's stop and in PAUSED; the application has to stop the body when none has come for 500 ms.
 *
 * The pose of a real head that reports none is reckoned from its commands and corrected by the camera motion on the
 * frames (`motiondetect`, `cameramotion`); a head that has lost its reference looks for it (`homing`). One whose reports
 * contradict its commands for a second is stopped, with a warning and the state `fault`, and stands until `auto` or the
 * next signal that moves it. A helper process that hangs is killed and started again, which stops the head.
 *
 * Action signals override the decisions until `auto` gives them back: `move-to` and `move-by` (pan, tilt in degrees;
 * false if the head is not there, the stream is over, or a number is none), `turn` (degrees a second; a stop after 500 ms
 * unless it is repeated), `stop`, `home`, `auto`. With `manual-timeout`, for orders that come from afar, a move that is
 * not repeated becomes a stop as well. `stop` holds until the next order or `auto`. A move or turn that is in force when
 * the head begins to fail, or that it does not obey during a fault, ends: the reason of the state `fault` says so, and
 * the head that works again stands until the next signal or `auto`.
 *
 * One controller at a time has the head: the emergency stop of its driver (state `stopped`), then the signals, then the
 * decisions. Pressed, it switches the motors off and every signal but `stop` is refused; released, the head stays until
 * the next signal.
 *
 * `follow` (the identity of a track, as its region has it; false if the head is not there or the stream is over)
 * chooses the track to follow from the next frame on, whatever fusion or `target` would choose. While it is on
 * no frame the head follows no other track; after 5 s, also if it never came, a warning names it and
 * the usual choice continues. A `pirfusion` upstream of the same head takes the choice over: its decisions say
 * `chosen`, and the head follows from the frame on that carries the first of them. `auto` ends the choice, and so does
 * each of the other signals: the last one counts.
 *
 * A gyro of the kernel's IIO on the body that carries the head (`base-gyro`) measures how fast that turns: the rate goes
 * upstream as the event `cerberus-base`. Its bias is learnt while the robot stands, by the picture or by a `cerberus-base`
 * of rate 0 that the application sends to this element; until then, and while the application reports rates, none is sent.
 *
 * Drivers: `simulated` (speed, acceleration, latency, step size, backlash and noise are properties), `scripted` (for
 * tests: follows `script`), `external` (a program that `command` names) and those of real heads: `visca`,
 * `pelco-d`, `onvif`, `v4l2` (a camera at `device`), `stepper-gpio` and `servo-pwm` (motors on the GPIO or PWM chip
 * `device`). All but the first two run in a helper process, which stops the head when this one dies, hangs or is silent
 * for `helper-timeout`.
 * One head has one name (`head`) and in a process one sink; a real one is driven by one program of a machine.
 *
 * No change of state waits for its first frame (`async=false`).
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 -m videotestsrc num-buffers=60 pattern=ball ! motiondetect ! pantiltsink driver=simulated
 * ]|
 *
 * Since: 0.1
 */
// The paper's II.D turns and tracks but does not say how; the law is lib/control/law.h, the heads are lib/drivers/,
// and lib/control/head_controller.h decides. This file only connects them with GStreamer.
#include <cerberus/cerberus.h>
#include <gst/base/gstbasesink.h>
#include <gst/video/video.h>

#include <cmath>
#include <string>
#include <utility>

#include "cerberus/private/element.hpp"
#include "cerberus/private/follow_query.hpp"
#include "cerberus/private/head_query.hpp"
#include "control/frame_order.h"
#include "head_session.hpp"
#include "shared/camera_mount.hpp"
#include "shared/camera_path.hpp"
#include "shared/complaint.hpp"
#include "shared/confirm_playing.hpp"
#include "shared/settings_query.hpp"
#include "shared/times.hpp"
#include "shared/tracks.hpp"

GST_DEBUG_CATEGORY_STATIC(pantiltsink_debug);
#define GST_CAT_DEFAULT pantiltsink_debug

namespace cerberus::plugin {
namespace {

using motion::Time;
using sensing::radians;

GstStaticPadTemplate sink_template =
    GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS("video/x-raw(ANY)"));

struct State {  // streaming thread only
  GstVideoInfo info;
  bool known = false;                 // info
  Complaint complaint;                // about the caps
  std::vector<fusion::Track> tracks;  // on the frame
  vision::CameraFollower camera;      // since the last frame
  control::FrameOrder order;
  std::optional<Time> taken;  // running time of the last frame that repeats none
  bool began_late = false;    // the stream, after the sink was set to PLAYING
  bool live_known = false;    // whether upstream is live
};

struct Private {
  HeadSession session;
  State state;
};

CERBERUS_DEFINE_TYPE(CerberusPanTiltSink, cerberus_pan_tilt_sink, GstBaseSink, GST_TYPE_BASE_SINK, Private)

gboolean cerberus_pan_tilt_sink_unlock(GstBaseSink* sink) {
  cerberus_pan_tilt_sink_self(sink)->priv->session.controller.interrupt(true);
  return TRUE;
}

gboolean cerberus_pan_tilt_sink_unlock_stop(GstBaseSink* sink) {
  cerberus_pan_tilt_sink_self(sink)->priv->session.controller.interrupt(false);
  return TRUE;
}

gboolean cerberus_pan_tilt_sink_set_caps(GstBaseSink* sink, GstCaps* caps) {
  State& state = cerberus_pan_tilt_sink_self(sink)->priv->state;
  // By hand: GstVideoInfo does not know the formats of every memory.
  const GstStructure* structure = gst_caps_get_structure(caps, 0);
  gst_video_info_init(&state.info);
  state.known = gst_structure_get_int(structure, "width", &state.info.width) &&
                gst_structure_get_int(structure, "height", &state.info.height);
  gst_structure_get_fraction(structure, "framerate", &state.info.fps_n, &state.info.fps_d);
  return guarded(sink, FALSE, [&]() -> gboolean {
    const std::string wrong = state.known ? "" : "The video has no size.";
    if (state.complaint.is_new(wrong))
      CERBERUS_ELEMENT_ERROR(sink, CORE, NEGOTIATION, (wrong), ("caps %" GST_PTR_FORMAT, caps));
    return state.known;
  });
}

// The frame ends here and its pixels are not looked at: any stride will do.
gboolean cerberus_pan_tilt_sink_propose_allocation(GstBaseSink*, GstQuery* query) {
  gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
  return TRUE;
}

gboolean cerberus_pan_tilt_sink_query(GstBaseSink* sink, GstQuery* query) {
  const char* head = cerberus_pan_tilt_sink_self(sink)->priv->session.head.load();
  if (asks_for_head(query, head ? head : "")) return TRUE;
  return GST_BASE_SINK_CLASS(cerberus_pan_tilt_sink_parent_class())->query(sink, query);
}

// Whether the stream is live decides what drives the head's time; known upstream when the stream begins, mostly. Without
// an answer it is taken for not live, and asked again with the next frame.
void ask_whether_live(Private& self) {
  if (self.state.live_known) return;
  HeadSession& session = self.session;
  const auto live = is_live(GST_BASE_SINK_PAD(session.sink));
  self.state.live_known = live.has_value();
  if (live) session.set_live(*live);
}

// The driver's answer is awaited with the base class's preroll lock held, which a change of state needs: a change of
// state interrupts the wait, takes the lock while this thread waits in wait_preroll(), and then the call is repeated.
template <typename Ask>
GstFlowReturn persist(HeadSession& session, Ask ask) {
  for (;;) {
    HeadSession::Reports out = session.reports();
    const control::HeadController::Answer answer = ask(out);
    session.send(out);
    if (answer != control::HeadController::Answer::interrupted) return GST_FLOW_OK;
    const GstFlowReturn flow = gst_base_sink_wait_preroll(session.sink);
    if (flow != GST_FLOW_OK) return flow;
  }
}

// When a frame was taken, in running time. Without a time stamp: now, or one frame after the last.
std::optional<Time> running_time(const HeadSession& session, GstClockTime pts, std::optional<Time> newest,
                                 Time length) {
  const GstSegment& segment = session.sink->segment;
  if (segment.format != GST_FORMAT_TIME || !GST_CLOCK_TIME_IS_VALID(pts)) {
    if (session.clock_driven) return session.now();
    return newest ? *newest + length : Time::zero();
  }
  const GstClockTime running = gst_segment_to_running_time(&segment, GST_FORMAT_TIME, pts);
  if (!GST_CLOCK_TIME_IS_VALID(running)) return std::nullopt;
  return time_of(running);
}

// The motion of the picture since the last frame here.
std::optional<control::PictureMotion> motion_of(State& state, GstBuffer* buffer, Time taken) {
  const CerberusCameraMotion* motion = cerberus_buffer_peek_camera_motion(buffer);
  const vision::Size size{state.info.width, state.info.height};
  const auto step = state.camera.next(path_point(buffer), clock_time(state.taken), size);
  if (!motion || step.link != vision::CameraFollower::Link::follows || !state.taken) return std::nullopt;
  const CerberusBase* base = cerberus_buffer_peek_base(buffer);
  const bool reported = base && base->source == CERBERUS_BASE_REPORTED && std::isfinite(base->yaw_rate);
  const double base_yaw = reported ? radians(base->yaw_rate) * motion::seconds(taken - *state.taken) : 0;
  return control::PictureMotion{step.motion.transform, motion->confidence, size, base_yaw, reported};
}

// The next frame follows no other.
void begin_anew(Private& self) {
  self.session.controller.forget();
  self.state.taken.reset();
}

GstFlowReturn on_frame(Private& self, GstBuffer* buffer, GstClockTime pts, GstClockTime duration) {
  HeadSession& session = self.session;
  // In PAUSED nothing is done; the base class would let a gap through, and a frame that comes just then.
  while (!session.playing)
    if (const GstFlowReturn flow = gst_base_sink_wait_preroll(session.sink); flow != GST_FLOW_OK) return flow;
  ask_whether_live(self);
  if (!session.watched) return GST_FLOW_ERROR;  // an error message was posted before
  const GstVideoInfo& info = self.state.info;
  const Time length = running_length(duration, info, session.sink->segment);
  const auto newest = session.controller.newest();
  const auto time = running_time(session, pts, newest, length);
  control::FrameOrder::Step step;
  if (time && buffer)
    step = self.state.order.next({.time = *time,
                                  .nominal = motion::seconds(length),
                                  .marked = GST_BUFFER_IS_DISCONT(buffer) != FALSE,
                                  .last = newest,
                                  .now = session.clock_driven ? session.now() : std::nullopt});
  else if (time)
    step = self.state.order.gap(*time, newest);
  const std::optional<Time> taken = step.taken;
  if (!taken) {
    GST_DEBUG_OBJECT(session.sink, "dropped: %" GST_TIME_FORMAT " is not newer than the last",
                     GST_TIME_ARGS(pts));
    return GST_FLOW_OK;
  }
  if (step.anew) begin_anew(self);
  control::HeadController::Frame frame{
      .seen = std::nullopt,
      .running = *taken,
      .length = length,
      .now = session.now().value_or(*taken),
      .lens = vision::Lens(session.controller.field_of_view(*taken, radians(session.field_of_view)),
                           {info.width, info.height}),
      .picture = {info.width, info.height},
      .capture = std::nullopt,
      .motion = std::nullopt,
      .repeats = std::nullopt};
  if (buffer) {
    session.stamps.frame(GST_BASE_SINK_PAD(session.sink), buffer, clock_time(*taken), session.camera_name);
    if (!GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_GAP)) {
      frame.motion = motion_of(self.state, buffer, *taken);
      const CerberusPose* pose = cerberus_buffer_peek_pose(buffer);
      const auto look = look_of(buffer, clock_time(*taken)).value_or(motion::PanTilt{});
      session.gyro.frame(*taken, frame.motion, frame.lens, look, !pose || !pose->moving);
      self.state.taken = taken;
    } else {
      frame.repeats = std::min(self.state.taken, taken);
    }
    read_tracks(buffer, self.state.tracks);
    const CerberusFusion* fusion = cerberus_buffer_peek_fusion(buffer);
    frame.seen.emplace(self.state.tracks, fusion ? std::optional(from_c(*fusion)) : std::nullopt);
  }
  const CerberusPose* pose = buffer ? cerberus_buffer_peek_pose(buffer) : nullptr;
  if (pose && g_strcmp0(pose->head, session.head) == 0) {
    motion::Pose& capture = frame.capture.emplace();
    capture.pan.position = radians(pose->pan);
    capture.tilt.position = radians(pose->tilt);
  }
  return persist(session, [&](HeadSession::Reports& out) { return session.controller.frame(frame, out); });
}

GstFlowReturn cerberus_pan_tilt_sink_render(GstBaseSink* sink, GstBuffer* buffer) {
  return guarded(sink, GST_FLOW_ERROR, [&] {
    Private& self = *cerberus_pan_tilt_sink_self(sink)->priv;
    return on_frame(self, buffer, GST_BUFFER_PTS(buffer), GST_BUFFER_DURATION(buffer));
  });
}

// What pirfusion upstream does for the head, it ends with the choice.
void end_choice(CerberusPanTiltSink* sink) {
  HeadSession& session = sink->priv->session;
  if (session.chosen.exchange(false)) ask_to_follow(GST_BASE_SINK_PAD(session.sink), session.head.load(), 0);
}

gboolean cerberus_pan_tilt_sink_event(GstBaseSink* sink, GstEvent* event) {
  Private& self = *cerberus_pan_tilt_sink_self(sink)->priv;
  HeadSession& session = self.session;
  const GstEventType type = GST_EVENT_TYPE(event);
  GstClockTime from = GST_CLOCK_TIME_NONE, length = GST_CLOCK_TIME_NONE;
  if (type == GST_EVENT_GAP) gst_event_parse_gap(event, &from, &length);
  if (type == GST_EVENT_STREAM_START) self.state.began_late = session.playing;
  if (type == GST_EVENT_EOS) {
    guarded(sink, [&] {
      session.end();
      end_choice(cerberus_pan_tilt_sink_self(sink));
    });
    if (self.state.began_late && !is_live(GST_BASE_SINK_PAD(sink)).value_or(false))
      confirm_playing(GST_ELEMENT(sink));
  }
  if (type == GST_EVENT_CUSTOM_DOWNSTREAM_OOB) guarded(sink, [&] { session.on_decision(event); });
  if (type == GST_EVENT_FLUSH_START) guarded(sink, [&] { session.halt("flushed"); });
  const gboolean done = cerberus_pan_tilt_sink_parent_class()->event(sink, event);
  guarded(sink, [&] {
    if (type == GST_EVENT_FLUSH_STOP) {
      begin_anew(self);
      self.state.order.forget();
      if (session.playing && session.watched) session.resume();
    }
    if (type == GST_EVENT_GAP && done) on_frame(self, nullptr, from, length);
    if (type != GST_EVENT_SEGMENT || !done) return;
    self.state.order.mark();
    ask_whether_live(self);
    const Time begin = running_time(session, sink->segment.start, {}, {}).value_or(Time::zero());
    const auto announce = [&](HeadSession::Reports& out) { return session.controller.announce(begin, out); };
    if (self.state.live_known && !session.clock_driven) {
      persist(session, announce);
      return;
    }
    // GstBaseSrc sends a segment with a lock held that a change of state of a live source needs: nothing may wait for
    // that here. Where a change of state interrupts the driver's answer nothing is published; the ticker does it once the
    // head plays.
    HeadSession::Reports out = session.reports();
    announce(out);
    session.send(out);
  });
  return done;
}

// The base class interrupts waiting threads, with its lock held, before each change of state but this one. `playing`
// changes under the lock too: a frame that arrives meanwhile waits until the change is complete. The head executes no
// command before the base class plays and a thread runs its watchdog, which starts after all notifications were sent.
GstStateChangeReturn play(HeadSession& session) {
  GstElement* element = GST_ELEMENT(session.sink);
  GstElementClass* base = GST_ELEMENT_CLASS(cerberus_pan_tilt_sink_parent_class());
  session.controller.interrupt(true);
  GstStateChangeReturn done = base->change_state(element, GST_STATE_CHANGE_PAUSED_TO_PLAYING);
  std::unique_lock changing(session.changing);
  const bool unwatched =
      done != GST_STATE_CHANGE_FAILURE && !guarded(element, false, [&] { return session.run(); });
  if (unwatched) {
    changing.unlock();
    session.pause();
    base->change_state(element, GST_STATE_CHANGE_PLAYING_TO_PAUSED);
    done = GST_STATE_CHANGE_FAILURE;
  }
  HeadSession::Reports out = session.reports();
  GST_BASE_SINK_PREROLL_LOCK(element);
  session.controller.interrupt(false);
  if (done != GST_STATE_CHANGE_FAILURE) {
    // A segment that came meanwhile may have asked for a thread, and got none.
    if (session.watched) guarded(element, [&] { session.controller.resume(session.now(), out); });
    session.playing = true;
  }
  GST_BASE_SINK_PREROLL_SIGNAL(element);
  GST_BASE_SINK_PREROLL_UNLOCK(element);
  if (changing) changing.unlock();
  guarded(element, [&] {
    session.send(out);
    if (unwatched) session.halt_unwatched();  // last: a receiver of the message may change the state again
  });
  return done;
}

// The head is not opened in GstBaseSink::start: that one adds an error message of its own.
bool open(Private& self) {
  self.state = {};
  return guarded(self.session.sink, false, [&] { return self.session.open(); });
}

GstStateChangeReturn cerberus_pan_tilt_sink_change_state(GstElement* element, GstStateChange change) {
  Private& self = *cerberus_pan_tilt_sink_self(element)->priv;
  HeadSession& session = self.session;
  if (change == GST_STATE_CHANGE_PAUSED_TO_PLAYING) return play(session);
  if (change == GST_STATE_CHANGE_READY_TO_PAUSED && !open(self)) return GST_STATE_CHANGE_FAILURE;
  if (change == GST_STATE_CHANGE_PLAYING_TO_PAUSED)
    guarded(element, [&] {
      session.pause();
      session.halt("paused");
    });
  const GstStateChangeReturn done =
      GST_ELEMENT_CLASS(cerberus_pan_tilt_sink_parent_class())->change_state(element, change);
  const bool failed = change == GST_STATE_CHANGE_READY_TO_PAUSED && done == GST_STATE_CHANGE_FAILURE;
  if (change == GST_STATE_CHANGE_PAUSED_TO_READY || failed) guarded(element, [&] { session.close(); });
  return done;
}

gboolean cerberus_pan_tilt_sink_send_event(GstElement* element, GstEvent* event) {
  HeadSession& session = cerberus_pan_tilt_sink_self(element)->priv->session;
  if (g_autoptr(CerberusBase) base = cerberus_event_parse_base(event); base && std::isfinite(base->yaw_rate))
    guarded(element, [&] { session.gyro.robot(time_of(base->valid_from), radians(base->yaw_rate)); });
  return GST_ELEMENT_CLASS(cerberus_pan_tilt_sink_parent_class())->send_event(element, event);
}

// Action signals: act(controller, now, reports) for the application.
template <typename Act>
gboolean manual(CerberusPanTiltSink* sink, Act act) {
  HeadSession& session = sink->priv->session;
  return guarded(sink, FALSE, [&]() -> gboolean { return session.with_reports(act); });
}
// Any signal but `follow`: the last one counts.
template <typename Act>
gboolean instead_of_a_choice(CerberusPanTiltSink* sink, Act act) {
  const gboolean done = manual(sink, act);
  if (done) guarded(sink, [&] { end_choice(sink); });
  return done;
}

template <bool relative>
gboolean move(CerberusPanTiltSink* sink, gdouble pan, gdouble tilt) {
  return instead_of_a_choice(sink, [=](auto& head, auto now, auto& out) {
    return head.move(radians(pan), radians(tilt), relative, now, out);
  });
}
gboolean turn(CerberusPanTiltSink* sink, gdouble pan, gdouble tilt) {
  return instead_of_a_choice(sink, [=](auto& head, auto now, auto& out) {
    return head.turn(radians(pan), radians(tilt), now, out);
  });
}
gboolean home(CerberusPanTiltSink* sink) {
  return move<false>(sink, 0, 0);
}
gboolean stay(CerberusPanTiltSink* sink) {
  return instead_of_a_choice(sink, [](auto& head, auto now, auto& out) { return head.stop(now, out); });
}
gboolean automatic(CerberusPanTiltSink* sink) {
  return instead_of_a_choice(sink, [](auto& head, auto now, auto& out) { return head.automatic(now, out); });
}
gboolean follow(CerberusPanTiltSink* sink, guint id) {
  if (id == 0) return FALSE;  // no track has it: the choice before stays
  HeadSession& session = sink->priv->session;
  const bool decided = guarded(
      sink, false, [&] { return ask_to_follow(GST_BASE_SINK_PAD(session.sink), session.head.load(), id); });
  // An element that holds an earlier choice and does not answer now receives the end of the choice as well.
  if (decided) session.chosen = true;
  const gboolean done =
      manual(sink, [=](auto& head, auto now, auto& out) { return head.follow(id, now, out, decided); });
  if (!done) guarded(sink, [&] { end_choice(sink); });
  return done;
}

void set_property(GObject* object, guint id, const GValue* value, GParamSpec*) {
  HeadSession& session = cerberus_pan_tilt_sink_self(object)->priv->session;
  session.settings.set(head_properties(), id, value);
  session.settings.adjust(hide_passwords);
  guarded(session.sink, [&] { session.configure(); });
}

void get_property(GObject* object, guint id, GValue* value, GParamSpec*) {
  cerberus_pan_tilt_sink_self(object)->priv->session.settings.get(head_properties(), id, value);
}

void cerberus_pan_tilt_sink_init(CerberusPanTiltSink* self) {
  GstBaseSink* sink = GST_BASE_SINK(self);
  self->priv->session.sink = sink;
  gst_base_sink_set_sync(sink, FALSE);
  gst_base_sink_set_async_enabled(sink, FALSE);
  gst_base_sink_set_qos_enabled(sink, FALSE);
}

// With `count` arguments of a type, two at most.
void add_signal(GObjectClass* klass, const char* name, GCallback handler, guint count = 0,
                GType type = G_TYPE_DOUBLE) {
  g_signal_new_class_handler(name, G_TYPE_FROM_CLASS(klass),
                             static_cast<GSignalFlags>(G_SIGNAL_RUN_LAST | G_SIGNAL_ACTION), handler, nullptr,
                             nullptr, nullptr, G_TYPE_BOOLEAN, count, type, type);
}

std::string settings_fault(GstElement* element) {
  return cerberus_pan_tilt_sink_self(element)->priv->session.settings_fault();
}

void cerberus_pan_tilt_sink_class_init(CerberusPanTiltSinkClass* klass) {
  GObjectClass* object = G_OBJECT_CLASS(klass);
  object->set_property = set_property;
  object->get_property = get_property;
  Adjustable<HeadSettings>::install(object, head_properties());
  add_signal(object, "move-to", G_CALLBACK(move<false>), 2);
  add_signal(object, "move-by", G_CALLBACK(move<true>), 2);
  add_signal(object, "turn", G_CALLBACK(turn), 2);
  add_signal(object, "stop", G_CALLBACK(stay));
  add_signal(object, "home", G_CALLBACK(home));
  add_signal(object, "auto", G_CALLBACK(automatic));
  add_signal(object, "follow", G_CALLBACK(follow), 1, G_TYPE_UINT);

  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  element->change_state = cerberus_pan_tilt_sink_change_state;
  element->query = settings_query<cerberus_pan_tilt_sink_parent_class, settings_fault>;
  element->send_event = cerberus_pan_tilt_sink_send_event;
  gst_element_class_set_static_metadata(element, "Pan-tilt head", "Sink/Video/Device",
                                        "Turns a pan-tilt head towards what camera and sensors found",
                                        "The Cerberus developers");
  gst_element_class_add_static_pad_template(element, &sink_template);

  GstBaseSinkClass* sink = GST_BASE_SINK_CLASS(klass);
  sink->unlock = cerberus_pan_tilt_sink_unlock;
  sink->unlock_stop = cerberus_pan_tilt_sink_unlock_stop;
  sink->set_caps = cerberus_pan_tilt_sink_set_caps;
  sink->propose_allocation = cerberus_pan_tilt_sink_propose_allocation;
  sink->query = cerberus_pan_tilt_sink_query;
  sink->event = cerberus_pan_tilt_sink_event;
  sink->render = cerberus_pan_tilt_sink_render;
}

}  // namespace
}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(pantiltsink, GST_RANK_NONE, cerberus::plugin::cerberus_pan_tilt_sink,
                          pantiltsink_debug, "pan-tilt head")
