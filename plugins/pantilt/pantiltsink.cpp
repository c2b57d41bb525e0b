// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-pantiltsink
 * @title: pantiltsink
 * @short_description: turns a pan-tilt head towards what the camera and the sensors found
 * @see_also: pirfusion, virtualptz, motiontrack
 *
 * Reads from each video frame what the head is to do, and drives
 * the head through a driver. The pixels are not looked at.
 *
 * What to do comes from the fusion meta (`pirfusion`): track, turn left or right, search a sector, return to zero,
 * hold. Without it the head follows the tracked regions (`motiontrack`, `motiondetect`): the one it follows already,
 * else the nearest, largest or newest (`target`); when nobody was there for `return-delay` it returns to zero.
 *
 * A pixel becomes an angle through the lens (`horizontal-fov`), with the pose that the head had when the frame was
 * taken: the pose meta of the frame if it is this head's, else the element's own memory. The head follows
 * proportionally (`gain`) and rests within a dead band that has two thresholds. It never passes `pan-min`, `pan-max`,
 * `tilt-min`, `tilt-max`, which must include 0. Tilt holds unless a target is tracked or the head returns to zero.
 * Limits, `max-speed` and `max-acceleration` that change while it plays go to the head at once: who is beyond a new
 * limit returns to it, in PAUSED when that ends. Limits that cannot be are a warning, and the old ones stay.
 *
 * Live, what `pirfusion` decides between two frames because a sensor changed its mind (the event `cerberus-fusion`, in
 * the name of this head or of any) is obeyed at once as if the last frame had said so: in the same states and within
 * the same limits, and only while frames come that carry its decisions. A target is followed with frames alone.
 *
 * The newest frame counts: one whose running time is not newer than the last one's is dropped. The element never waits
 * for the clock and asks nobody upstream to hurry.
 *
 * Each pose of the head goes upstream as the event `cerberus-pose`. In a live pipeline, or with a real head, it is sent
 * at every change of plan and at 50 Hz while the head moves, 5 Hz while it rests, and when no frame comes for
 * `watchdog-timeout` the head stops. That is the work of a thread; where the system gives none, an error says so, and
 * PLAYING or the frames of a live stream are refused rather than let a head move unwatched. In a pipeline that is not
 * live a simulated head's time is the running time of the frames, never a clock: each frame is answered with the poses
 * until its running time plus `latency` (or until the next frame, if that is later), so that a source upstream can keep
 * in step with it and two runs give the same.
 *
 * In PAUSED, at the end of the stream, on a flush and when the element stops the head brakes and stays. An order by
 * hand goes on after PAUSED, but not after the end of the stream, nor when frames came and stay away for
 * `watchdog-timeout`: then the head stands until another order or `auto`. At the end of the stream `move-to`,
 * `move-by`, `home` and `follow` are refused until a flush begins it anew; where no frames come, an order is obeyed.
 * Driver calls are made on a thread of their own; a driver that blocks delays no change of state by more than 100 ms. A
 * driver that cannot be opened is an error, however late it says so, and in PAUSED too; one that fails later is a
 * warning and the state `fault`, until it answers again: the video goes on.
 *
 * Element messages: `cerberus-pantilt` with `state` (`stopped`, `tracking`, `turning`, `searching`, `zeroing`,
 * `holding`, `manual`, `limited`, `fault`) and `reason` at every change of either.
 *
 * Action signals override the decisions until `auto` gives them back: `move-to` and `move-by` (pan, tilt in degrees;
 * false if the head is not there, the stream is over, or a number is none), `stop`, `home`, `auto`.
 *
 * `follow` (the identity of a track, as its region has it; false if the head is not there or the stream is over)
 * chooses whom to follow: that track from the next frame on, whatever fusion or `target` would choose. While it is on
 * no frame the head turns to nobody else that the camera sees; after 5 s, also if it never came, a warning names it and
 * the usual choice goes on. `auto` takes the choice back, and so does each of the other signals: the last one counts.
 *
 * Drivers: `simulated` (speed, acceleration, latency, step size, backlash and noise are properties) and `scripted` (for
 * tests: what `script` says). One head has one name (`head`) and in a process one sink.
 *
 * No change of state waits for its first frame (`async=false`). A pipeline with `decodebin` in which all sinks are such
 * may not end with its file: GStreamer can lose the end of the stream there (with `fakesink async=false`, too). Another
 * sink beside it cures that: `tee name=t ! queue ! pantiltsink t. ! queue ! fakesink`.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 -m videotestsrc num-buffers=60 pattern=ball ! motiondetect ! pantiltsink driver=simulated
 * ]|
 *
 * Since: 0.1
 */
// The paper's II.D turns and tracks but does not say how; the law is lib/control/law.h, the heads are lib/drivers/.
// This file only connects them with GStreamer: station.cpp holds what is decided and said.
#include <cerberus/cerberus.h>
#include <gst/base/gstbasesink.h>
#include <gst/video/video.h>

#include <string>
#include <utility>

#include "cerberus/private/element.hpp"
#include "head_session.hpp"
#include "shared/complaint.hpp"

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
  bool known = false;       // info
  Complaint complaint;      // about the caps
  bool live_known = false;  // whether upstream is live was asked
};

struct Private {
  HeadSession conductor;
  State state;
};

CERBERUS_DEFINE_TYPE(CerberusPanTiltSink, cerberus_pan_tilt_sink, GstBaseSink, GST_TYPE_BASE_SINK, Private)

gboolean cerberus_pan_tilt_sink_unlock(GstBaseSink* sink) {
  cerberus_pan_tilt_sink_self(sink)->priv->conductor.station.interrupt(true);
  return TRUE;
}

gboolean cerberus_pan_tilt_sink_unlock_stop(GstBaseSink* sink) {
  cerberus_pan_tilt_sink_self(sink)->priv->conductor.station.interrupt(false);
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

// Live or not decides what drives the head's time. Asked when the stream begins: then everybody upstream knows.
void ask_whether_live(Private& self) {
  if (std::exchange(self.state.live_known, true)) return;
  HeadSession& conductor = self.conductor;
  conductor.set_live(is_live(GST_BASE_SINK_PAD(conductor.sink)).value_or(false));
}

// A driver is waited for with the base class's preroll lock held, which a change of state needs: each one interrupts,
// then has the lock while whoever was interrupted waits here, and goes on where it was when told to.
template <typename Ask>
GstFlowReturn persist(HeadSession& conductor, Ask ask) {
  for (;;) {
    DeferredNotifications out = conductor.outbox();
    const HeadController::Answer answer = ask(out);
    conductor.tell(out);
    if (answer != HeadController::Answer::interrupted) return GST_FLOW_OK;
    const GstFlowReturn flow = gst_base_sink_wait_preroll(conductor.sink);
    if (flow != GST_FLOW_OK) return flow;
  }
}

// When a frame was taken, in running time. Without a time stamp: now, or one frame after the last.
std::optional<Time> running_time(const HeadSession& conductor, GstClockTime pts, std::optional<Time> newest,
                                 Time length) {
  const GstSegment& segment = conductor.sink->segment;
  if (segment.format != GST_FORMAT_TIME || !GST_CLOCK_TIME_IS_VALID(pts)) {
    if (conductor.clock_driven) return conductor.now();
    return newest ? *newest + length : Time::zero();
  }
  const GstClockTime running = gst_segment_to_running_time(&segment, GST_FORMAT_TIME, pts);
  if (!GST_CLOCK_TIME_IS_VALID(running)) return std::nullopt;
  return time_of(running);
}

GstFlowReturn look(Private& self, GstBuffer* buffer, GstClockTime pts, GstClockTime duration) {
  HeadSession& conductor = self.conductor;
  // In PAUSED nothing is done; the base class would let a gap through, and a frame that comes just then.
  while (!conductor.playing)
    if (const GstFlowReturn flow = gst_base_sink_wait_preroll(conductor.sink); flow != GST_FLOW_OK)
      return flow;
  ask_whether_live(self);
  if (!conductor.watched) return GST_FLOW_ERROR;  // which was said
  const GstVideoInfo& info = self.state.info;
  const Time length = running_length(duration, info, conductor.sink->segment);
  const auto newest = conductor.station.newest();
  const auto taken = running_time(conductor, pts, newest, length);
  if (!taken || (newest && *taken <= *newest)) {
    GST_DEBUG_OBJECT(conductor.sink, "dropped: %" GST_TIME_FORMAT " is not newer than the last",
                     GST_TIME_ARGS(pts));
    return GST_FLOW_OK;
  }
  HeadController::Frame frame{
      .buffer = buffer,
      .running = *taken,
      .length = length,
      .now = conductor.now().value_or(*taken),
      .lens = vision::Lens(radians(conductor.field_of_view), {info.width, info.height}),
      .capture = std::nullopt};
  const CerberusPose* pose = buffer ? cerberus_buffer_peek_pose(buffer) : nullptr;
  if (pose && g_strcmp0(pose->head, conductor.head) == 0) {
    motion::Pose& capture = frame.capture.emplace();
    capture.pan.position = radians(pose->pan);
    capture.tilt.position = radians(pose->tilt);
  }
  return persist(conductor, [&](DeferredNotifications& out) { return conductor.station.frame(frame, out); });
}

GstFlowReturn cerberus_pan_tilt_sink_render(GstBaseSink* sink, GstBuffer* buffer) {
  return guarded(sink, GST_FLOW_ERROR, [&] {
    Private& self = *cerberus_pan_tilt_sink_self(sink)->priv;
    return look(self, buffer, GST_BUFFER_PTS(buffer), GST_BUFFER_DURATION(buffer));
  });
}

gboolean cerberus_pan_tilt_sink_event(GstBaseSink* sink, GstEvent* event) {
  Private& self = *cerberus_pan_tilt_sink_self(sink)->priv;
  HeadSession& conductor = self.conductor;
  const GstEventType type = GST_EVENT_TYPE(event);
  GstClockTime from = GST_CLOCK_TIME_NONE, length = GST_CLOCK_TIME_NONE;
  if (type == GST_EVENT_GAP) gst_event_parse_gap(event, &from, &length);
  if (type == GST_EVENT_EOS) guarded(sink, [&] { conductor.end(); });
  if (type == GST_EVENT_CUSTOM_DOWNSTREAM_OOB) guarded(sink, [&] { conductor.heed(event); });
  if (type == GST_EVENT_FLUSH_START) guarded(sink, [&] { conductor.halt("flushed"); });
  const gboolean done = cerberus_pan_tilt_sink_parent_class()->event(sink, event);
  guarded(sink, [&] {
    if (type == GST_EVENT_FLUSH_STOP) {
      conductor.station.forget();
      if (conductor.playing && conductor.watched) conductor.resume();
    }
    if (type == GST_EVENT_GAP && done) look(self, nullptr, from, length);
    if (type != GST_EVENT_SEGMENT || !done) return;
    ask_whether_live(self);
    const Time begin = running_time(conductor, sink->segment.start, {}, {}).value_or(Time::zero());
    persist(conductor, [&](DeferredNotifications& out) { return conductor.station.announce(begin, out); });
  });
  return done;
}

// The base class interrupts who waits with its lock held before each change of state but this one. `playing` changes
// under the lock too: a frame that comes in the middle waits until the change is through. The head obeys nobody before
// the base class plays and there is a thread that watches over it, which begins when all is said.
GstStateChangeReturn play(HeadSession& conductor) {
  GstElement* element = GST_ELEMENT(conductor.sink);
  GstElementClass* base = GST_ELEMENT_CLASS(cerberus_pan_tilt_sink_parent_class());
  conductor.station.interrupt(true);
  GstStateChangeReturn done = base->change_state(element, GST_STATE_CHANGE_PAUSED_TO_PLAYING);
  std::unique_lock changing(conductor.changing);
  const bool unwatched =
      done != GST_STATE_CHANGE_FAILURE && !guarded(element, false, [&] { return conductor.run(); });
  if (unwatched) {
    changing.unlock();
    conductor.pause();
    base->change_state(element, GST_STATE_CHANGE_PLAYING_TO_PAUSED);
    done = GST_STATE_CHANGE_FAILURE;
  }
  DeferredNotifications out = conductor.outbox();
  GST_BASE_SINK_PREROLL_LOCK(element);
  conductor.station.interrupt(false);
  if (done != GST_STATE_CHANGE_FAILURE) {
    // A segment that came meanwhile may have asked for a thread, and got none.
    if (conductor.watched) guarded(element, [&] { conductor.station.resume(conductor.now(), out); });
    conductor.playing = true;
  }
  GST_BASE_SINK_PREROLL_SIGNAL(element);
  GST_BASE_SINK_PREROLL_UNLOCK(element);
  if (changing) changing.unlock();
  guarded(element, [&] {
    conductor.tell(out);
    if (unwatched) conductor.halt_unwatched();  // last: whoever is told may change the state again
  });
  return done;
}

// The head is not opened in GstBaseSink::start: that one adds an error message of its own.
bool open(Private& self) {
  self.state = {};
  return guarded(self.conductor.sink, false, [&] { return self.conductor.open(); });
}

GstStateChangeReturn cerberus_pan_tilt_sink_change_state(GstElement* element, GstStateChange change) {
  Private& self = *cerberus_pan_tilt_sink_self(element)->priv;
  HeadSession& conductor = self.conductor;
  if (change == GST_STATE_CHANGE_PAUSED_TO_PLAYING) return play(conductor);
  if (change == GST_STATE_CHANGE_READY_TO_PAUSED && !open(self)) return GST_STATE_CHANGE_FAILURE;
  if (change == GST_STATE_CHANGE_PLAYING_TO_PAUSED)
    guarded(element, [&] {
      conductor.pause();
      conductor.halt("paused");
    });
  const GstStateChangeReturn done =
      GST_ELEMENT_CLASS(cerberus_pan_tilt_sink_parent_class())->change_state(element, change);
  const bool failed = change == GST_STATE_CHANGE_READY_TO_PAUSED && done == GST_STATE_CHANGE_FAILURE;
  if (change == GST_STATE_CHANGE_PAUSED_TO_READY || failed) guarded(element, [&] { conductor.close(); });
  return done;
}

// Action signals: the application's own hand.
template <typename Act>
gboolean by_hand(CerberusPanTiltSink* sink, Act act) {
  return sink->priv->conductor.by_hand(act);
}
gboolean move_to(CerberusPanTiltSink* sink, gdouble pan, gdouble tilt) {
  return by_hand(sink, [=](HeadController& station, std::optional<Time> at, DeferredNotifications& out) {
    return station.move(radians(pan), radians(tilt), false, at, out);
  });
}
gboolean move_by(CerberusPanTiltSink* sink, gdouble pan, gdouble tilt) {
  return by_hand(sink, [=](HeadController& station, std::optional<Time> at, DeferredNotifications& out) {
    return station.move(radians(pan), radians(tilt), true, at, out);
  });
}
gboolean stay(CerberusPanTiltSink* sink) {
  return by_hand(sink, [](HeadController& station, auto at, DeferredNotifications& out) {
    return station.stay(at, out);
  });
}
gboolean home(CerberusPanTiltSink* sink) {
  return move_to(sink, 0, 0);
}
gboolean automatic(CerberusPanTiltSink* sink) {
  return by_hand(sink, [](HeadController& station, auto at, DeferredNotifications& out) {
    return station.automatic(at, out);
  });
}

gboolean follow(CerberusPanTiltSink* sink, guint id) {
  return by_hand(sink, [=](HeadController& station, auto at, DeferredNotifications& out) {
    return station.follow(id, at, out);
  });
}

void set_property(GObject* object, guint id, const GValue* value, GParamSpec*) {
  HeadSession& conductor = cerberus_pan_tilt_sink_self(object)->priv->conductor;
  conductor.settings.set(head_properties(), id, value);
  guarded(conductor.sink, [&] { conductor.configure(); });
}

void get_property(GObject* object, guint id, GValue* value, GParamSpec*) {
  cerberus_pan_tilt_sink_self(object)->priv->conductor.settings.get(head_properties(), id, value);
}

void cerberus_pan_tilt_sink_init(CerberusPanTiltSink* self) {
  GstBaseSink* sink = GST_BASE_SINK(self);
  self->priv->conductor.sink = sink;
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

void cerberus_pan_tilt_sink_class_init(CerberusPanTiltSinkClass* klass) {
  GObjectClass* object = G_OBJECT_CLASS(klass);
  object->set_property = set_property;
  object->get_property = get_property;
  Adjustable<HeadSettings>::install(object, head_properties());
  add_signal(object, "move-to", G_CALLBACK(move_to), 2);
  add_signal(object, "move-by", G_CALLBACK(move_by), 2);
  add_signal(object, "stop", G_CALLBACK(stay));
  add_signal(object, "home", G_CALLBACK(home));
  add_signal(object, "auto", G_CALLBACK(automatic));
  add_signal(object, "follow", G_CALLBACK(follow), 1, G_TYPE_UINT);

  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  element->change_state = cerberus_pan_tilt_sink_change_state;
  gst_element_class_set_static_metadata(element, "Pan-tilt head", "Sink/Video/Device",
                                        "Turns a pan-tilt head towards what camera and sensors found",
                                        "The Cerberus developers");
  gst_element_class_add_static_pad_template(element, &sink_template);

  GstBaseSinkClass* sink = GST_BASE_SINK_CLASS(klass);
  sink->unlock = cerberus_pan_tilt_sink_unlock;
  sink->unlock_stop = cerberus_pan_tilt_sink_unlock_stop;
  sink->set_caps = cerberus_pan_tilt_sink_set_caps;
  sink->propose_allocation = cerberus_pan_tilt_sink_propose_allocation;
  sink->event = cerberus_pan_tilt_sink_event;
  sink->render = cerberus_pan_tilt_sink_render;
}

}  // namespace
}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(pantiltsink, GST_RANK_NONE, cerberus::plugin::cerberus_pan_tilt_sink,
                          pantiltsink_debug, "pan-tilt head")
