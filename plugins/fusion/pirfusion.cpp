// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-pirfusion
 *
 * Decides, frame by frame, where a pan-tilt head should look: from the confirmed tracks on the frame and from the PIR
 * sensors around it. The decision (#CerberusFusion: rule, action, target, sensors, pan angle, limits) is attached to
 * the buffer, which goes through otherwise untouched and in the thread it came in; at every change it is posted as an
 * element message `cerberus-fusion` too.
 *
 * Pads: `sink` and `src` take video, raw or encoded; caps, allocation and latency are theirs alone. Each `pir_%u` takes
 * PIR readings (`application/x-pir`, what the sensors cover is read from the caps; several pads are counted on in the
 * order of their numbers, 16 sensors at most; `pirsrc ! fusion.` makes the next one). A pad that has no caps yet, and a number that is left out (`pir_1` without `pir_0`),
 * counts as one sensor whose readings are invalid: the others keep their numbers, and rules keep their meaning.
 * `format=level` (volts) is compared with `level-threshold` and filtered as `pirsrc` does by default; let `pirsrc` do
 * that where it is the source: it has the module's warm-up and hold.
 *
 * - Live: a frame never waits. The newest reading counts that is there when the frame comes, even one that is younger
 *   than the frame: a camera's frames are old when they arrive, and a sensor shall not wait for that. Nor does it wait
 *   for the next frame: a change of a live source's sensor is decided at once, as if the last frame
 *   came again (if that was in the last second), and sent downstream as the event `cerberus-fusion`, which
 *   `pantiltsink` executes while frames come. Such events of another `pirfusion` upstream end here. Without a reading
 *   the sensors are invalid. So are those of a pad without data for `lost-after`, or ended so long ago: a warning
 *   names it.
 * - Not live: a frame waits until readings, GAP events or EOS of every linked PIR pad cover its running time, so that
 *   every run gives the same. A pad without data for `max-wait` causes a warning, is invalid, and is not waited for until
 *   data comes. Video and PIR need a thread each (a `queue`) where one element makes both.
 * - A single video time stamp more than 10 s ahead or 1 s back is taken for a mistake, unless a DISCONT, a segment or a
 *   gap lies before it, or it is newer and the clock of a live pipeline has reached it: the frame counts as if it followed
 *   at the usual distance. The third such frame in a row is believed.
 * - A PIR source that is not live keeps its last reading when it ends (EOS). One that is live (also a recording with
 *   `is-live`) beside a live video keeps it for `lost-after`.
 *
 * A sensor that begins to detect, counts, and covers a part of the picture (bearing and field of view from the PIR caps, pan,
 * `horizontal-fov` or the zoom's) has `personverify` upstream look at once. In a stream that is not live there must be no queue
 * in between.
 *
 * The pan angle of a frame comes from the pose on the buffer, else from the head's `cerberus-pose` events passing
 * upstream, evaluated at the frame's running time. In a stream that is not live, events that come through a queue
 * behind this element are ignored, with a warning: each run would use them for other frames. Between two frames it is that of the newest such event, evaluated at
 * the time of the decision; where none came for a time after a frame that carried a pose, it is still the frame's.
 * Until the first pose it is unknown, and no turn is decided.
 *
 * A sensor whose reading the robot's own motion may cause is doubtful and does not count: one that begins to detect while
 * standing things pass its field faster than 5 degrees a second, or .3 s after, until it has rested or the robot has
 * stood for 3 s. What it detected before the motion counts for 3 s more. The rate of turning comes
 * from a `cerberus-base` event or, where none came within a second, from `cameramotion` (#CerberusBase on the
 * buffer), and is then sent to the PIR pads by that event; that the robot drives comes from such events alone. While
 * `rules=complete` finds nothing else to do, the head looks into the sectors of doubtful sensors that the camera has not
 * seen for 4 s (rule `doubt`): those sensors are blind. Both events, and seeks, are passed on to the video and to the PIR
 * pads; where a video can begin at key frames only, accurate seeks keep a recording of sensors in step with it.
 *
 * `rules=paper` is the paper's table and no more: `camera-hold`, `hold-stopped`, `return-delay` and `hysteresis` do not count.
 * A table of your own is described in the manual (rules); one that leaves a case open, contradicts itself or has a rule that
 * never applies is refused and the case named. A warning names what of it lies beyond `pan-min` and `pan-max`, and rules for
 * another number of sensors than the PIR pads have; another one, poses that come from another head than `head` only.
 *
 * A track that the application chooses (`follow` of a #pantiltsink of this `head` downstream) goes before every rule from
 * the next frame on, as rule 0 named `chosen`; while it is on no frame no other track is the target, for 5 s.
 *
 * ## Example
 * |[
 * gst-launch-1.0 -m videotestsrc num-buffers=60 pattern=ball ! motiondetect ! pirfusion ! fakesink
 * gst-launch-1.0 -m videotestsrc num-buffers=60 pattern=ball ! motiondetect ! pirfusion name=fusion rules=paper ! \
 *     fakesink pirsrc driver=scripted script="0,0,0,0; 1,0,1,0" ! fusion.
 * ]|
 *
 * Since: 0.1
 */
// The rules are the paper's II.D, the state machine is lib/fusion. The shape is textoverlay's: a GstAggregator waits
// where it must not. What the pads share is in Inputs, what happens at a PIR pad in pir_pad.cpp; here is the
// video's path.
#include <cerberus/cerberus.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "cerberus/private/element.hpp"
#include "cerberus/private/follow_query.hpp"
#include "fusion/decisions.h"
#include "fusion/rule_check.h"
#include "fusion/rule_file.h"
#include "fusion/settings_check.h"
#include "inputs.hpp"
#include "motion/head_limits.h"
#include "pir_pad.hpp"
#include "sensing/pir_model.h"
#include "settings.hpp"
#include "shared/onset.hpp"
#include "shared/pose_thread.hpp"
#include "shared/settings_query.hpp"
#include "shared/stamps.hpp"
#include "shared/tracks.hpp"
#include "text/numbers.h"
#include "translation.hpp"
#include "vision/clocked_times.h"

GST_DEBUG_CATEGORY_STATIC(pirfusion_debug);
#define GST_CAT_DEFAULT pirfusion_debug

namespace cerberus::plugin {
namespace {

// Not any caps: then `pirsrc ! fusion.` in front of the video would take the video's pad.
#define VIDEO_CAPS                                                                          \
  "video/x-raw(ANY); video/x-bayer; video/x-h264; video/x-h265; video/x-vp8; video/x-vp9; " \
  "video/x-av1; video/mpeg; image/jpeg; image/png"
GstStaticPadTemplate sink_template =
    GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(VIDEO_CAPS));
GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(VIDEO_CAPS));
GstStaticPadTemplate pir_template =
    GST_STATIC_PAD_TEMPLATE("pir_%u", GST_PAD_SINK, GST_PAD_REQUEST, GST_STATIC_CAPS(CERBERUS_PIR_CAPS));

struct State {  // video thread only
  GstSegment segment;
  std::optional<bool> live;  // nothing: not known
  Time time{};               // of the last frame
  vision::ClockedTimes times;
  double base_sent = 0;  // to the PIR pads, degrees a second
  Time base_sent_at{};
  int rules_sensors = 0;  // of which the rules speak; 0: any number
  fusion::SettingsCheck misfits;

  State() { gst_segment_init(&segment, GST_FORMAT_UNDEFINED); }
};

struct Private {
  GstPad* sink = nullptr;
  GstPad* src = nullptr;
  Adjustable<Settings> settings;
  std::unique_ptr<State> state = std::make_unique<State>();
  Stamps stamps;
  Inputs inputs;
  fusion::Decisions decisions{inputs};
  PoseThread pose_thread;

  std::mutex lock;
  std::shared_ptr<const fusion::RuleTable> table;  // of rules-file
};

CERBERUS_DEFINE_TYPE(CerberusPirFusion, cerberus_pir_fusion, GstElement, GST_TYPE_ELEMENT, Private)

struct BufferDeleter {
  void operator()(GstBuffer* buffer) const { gst_buffer_unref(buffer); }
};
using Buffer = std::unique_ptr<GstBuffer, BufferDeleter>;

// Takes over the rules of a file (empty: none of the user's own); false
// with the reason when they cannot be used. The old ones stay then.
bool load_rules(CerberusPirFusion* self, const std::string& path, std::string& error) {
  std::shared_ptr<const fusion::RuleTable> table;
  if (!path.empty()) {
    fusion::RuleFile file = fusion::load_rules(path);
    if (!file.table) {
      error = std::move(file.error);
      return false;
    }
    table = std::make_shared<const fusion::RuleTable>(std::move(*file.table));
    const sensing::Interval limits = fuser_options(self->priv->settings.snapshot(), true).limits;
    for (const std::string& text : fusion::out_of_reach(*table, limits))
      CERBERUS_ELEMENT_WARNING(self, RESOURCE, SETTINGS, (path + ": " + text + "."), (nullptr));
  }
  {
    const std::lock_guard guard(self->priv->lock);
    self->priv->table = std::move(table);
  }
  self->priv->settings.refresh();
  return true;
}

void apply_settings(CerberusPirFusion* self) {
  const auto changed = self->priv->settings.changes();
  if (!changed) return;
  const Settings& s = *changed;
  std::shared_ptr<const fusion::RuleTable> table;
  {
    const std::lock_guard guard(self->priv->lock);
    table = self->priv->table;
  }
  fusion::Decisions& decisions = self->priv->decisions;
  fusion::FuserOptions options = fuser_options(s, table != nullptr);
  if (!limits_fault(s).empty())
    options.limits = decisions.limits();  // set_property() is about to set them back
  const bool by_table = options.rules == fusion::RuleSet::table;
  self->priv->state->rules_sensors = !by_table ? 0 : table ? table->sensors : fusion::paper_rules().sensors;
  decisions.configure(options, table ? *table : fusion::paper_rules());
}

// Until when readings count for a frame of `time`. Live, until now: a frame comes an exposure, a transfer and the whole
// analysis after its time, and 60 ms are all that may pass from a sensor's edge to the motors. But a recording of
// sensors may be ahead of the video, and is not believed before its time.
Time sensor_time_of(CerberusPirFusion* self, Time time, bool live) {
  return live ? std::max(time, clock_now(self).value_or(time)) : time;
}

void warn_of(CerberusPirFusion* self, const std::vector<fusion::SilentSource>& silent, guint64 patience) {
  const std::string seconds = text::significant(static_cast<double>(patience) / GST_SECOND, 3).string();
  for (const fusion::SilentSource& pad : silent) {
    const char* what = pad.ended ? "The PIR readings have ended at" : "No PIR reading comes to";
    CERBERUS_ELEMENT_WARNING(
        self, RESOURCE, READ,
        ("%s pad %s, for %s s now: its sensors are invalid, and no frame waits for them.", what,
         pad.name.c_str(), seconds.c_str()),
        ("frame at running time %" GST_TIME_FORMAT, GST_TIME_ARGS(clock_time(self->priv->state->time))));
  }
}

void publish_changes(CerberusPirFusion* self) {
  self->priv->decisions.publish_changes([self](Time time, const fusion::Decisions::Outcome& outcome) {
    const CerberusFusion fusion = as_fusion(outcome);
    const CerberusStamp stamp = self->priv->stamps.at(clock_time(time));
    gst_element_post_message(GST_ELEMENT(self),
                             cerberus_message_new_fusion(GST_OBJECT(self), &stamp, &fusion));
  });
}

// Somebody whom a sensor has begun to detect may be in the picture: a person detector upstream looks at once.
void tell_of_onset(CerberusPirFusion* self, const fusion::Decisions::Outcome& outcome) {
  if (outcome.decision.onset_in_view) gst_pad_push_event(self->priv->sink, new_onset_event());
}

// A sensor has spoken, in its source's thread. What follows from that goes to the head past all queues: a camera of 10
// frames a second leaves it no time to wait for the next one.
void decide_between_frames(CerberusPirFusion* self) {
  const auto now = clock_now(self);
  if (!now) return;
  Private& priv = *self->priv;
  const std::string head = priv.settings.snapshot().head;
  const auto outcome =
      priv.decisions.between(*now, [&](Time sensor_time, Time frame_time, SensorSnapshot& snapshot) {
        priv.inputs.listen(sensor_time, frame_time, head, snapshot);
      });
  if (!outcome) return;
  tell_of_onset(self, *outcome);
  CerberusFusion fusion = as_fusion(*outcome);
  cerberus_fusion_set_head(&fusion, head.c_str());
  gst_pad_push_event(priv.src, cerberus_event_new_fusion(&fusion));
  publish_changes(self);
}

void warn_of_misfits(CerberusPirFusion* self, const Settings& s, const SensorSnapshot& moment) {
  State& state = *self->priv->state;
  const std::string rules = s.rules_file.empty() ? "rules=paper" : s.rules_file;
  for (const std::string& text : {state.misfits.sensors(rules, state.rules_sensors, moment),
                                  state.misfits.head(s.head, state.time, moment)})
    if (!text.empty()) CERBERUS_ELEMENT_WARNING(self, RESOURCE, SETTINGS, (text), (nullptr));
}

void push_to_pirs(CerberusPirFusion* self, GstEvent* event) {
  for (GstPad* pir : self->priv->inputs.pads()) {
    gst_pad_push_event(pir, gst_event_ref(event));
    gst_object_unref(pir);
  }
}

// Sends the base's rate to the sensors' sources, which receive no frames: when it has changed enough to matter, and
// before it expires there. Without events the sources assume that the base stands.
void pass_base_on(CerberusPirFusion* self, Time time, const SensorSnapshot& moment) {
  constexpr double kMatters = 1;  // degrees a second
  const auto doubtful = [](double rate) { return std::abs(sensing::radians(rate)) > sensing::kDoubtfulTurn; };
  State& state = *self->priv->state;
  const double sent = state.base_sent;
  const double rate = std::isfinite(moment.base_degrees) ? moment.base_degrees : 0;
  if (moment.base_received) return;
  const bool same =
      rate == sent || (rate != 0 && std::abs(rate - sent) < kMatters && doubtful(rate) == doubtful(sent));
  const Time since = time - state.base_sent_at;
  const bool fresh = since >= Time::zero() && since < sensing::kBaseLifetime / 2;
  if (same && (fresh || rate == 0)) return;
  state.base_sent = rate;
  state.base_sent_at = time;
  CerberusBase base;
  cerberus_base_init(&base);
  base.yaw_rate = rate;
  base.valid_from = clock_time(time);
  g_autoptr(GstEvent) event = cerberus_event_new_base(&base);
  push_to_pirs(self, event);
}

// When a frame was taken. A frame without a time is as late as the one before.
Time time_of_frame(CerberusPirFusion* self, GstBuffer* buffer) {
  State& state = *self->priv->state;
  const auto time = running_time(state.segment, GST_BUFFER_PTS(buffer));
  if (!time) return state.time;
  const auto length = known_time(GST_BUFFER_DURATION(buffer));
  return state.times.next({.time = *time,
                           .nominal = length ? motion::seconds(*length) : 0,
                           .marked = GST_BUFFER_IS_DISCONT(buffer) != FALSE,
                           .last = state.time,
                           .now = state.live != false ? clock_now(self) : std::nullopt});
}

GstFlowReturn video_chain(GstPad* pad, GstObject* parent, GstBuffer* taken) {
  auto* self = cerberus_pir_fusion_self(parent);
  return guarded(self, GST_FLOW_ERROR, [&] {
    Buffer buffer(taken);
    Private& priv = *self->priv;
    State& state = *priv.state;
    apply_settings(self);
    const Settings settings = priv.settings.snapshot();
    if (!state.live) state.live = is_live(pad);
    state.time = time_of_frame(self, buffer.get());

    std::vector<fusion::SilentSource> silent;
    const bool waits = state.live == false;
    const Time max_wait = settings.max_wait == GST_CLOCK_TIME_NONE ? Time::max() : time_of(settings.max_wait);
    if (!priv.inputs.frame_came(state.time, waits ? max_wait : Time::zero(), silent))
      return GST_FLOW_FLUSHING;
    const Time sensor_time = sensor_time_of(self, state.time, state.live == true);
    if (!waits && settings.lost_after > 0)
      priv.inputs.give_up_silent(sensor_time, time_of(settings.lost_after), silent);
    warn_of(self, silent, waits ? settings.max_wait : settings.lost_after);
    const CerberusPose* carried = cerberus_buffer_peek_pose(buffer.get());
    const bool by_event = !(carried && is_named(*carried, settings.head)) &&
                          (state.live == true || priv.pose_thread.poses_count(GST_ELEMENT(self)));
    const auto outcome = priv.decisions.frame(
        state.time, sensor_time, state.live == true, [&](Time until, std::vector<fusion::Track>& tracks) {
          read_tracks(buffer.get(), tracks);
          return priv.inputs.at(state.time, until, settings.head, by_event, buffer.get());
        });
    const CerberusFusion fusion = as_fusion(outcome);
    tell_of_onset(self, outcome);
    pass_base_on(self, state.time, outcome.snapshot);
    warn_of_misfits(self, settings, outcome.snapshot);
    buffer.reset(gst_buffer_make_writable(buffer.release()));
    cerberus_buffer_set_fusion(buffer.get(), &fusion);
    priv.stamps.mark(pad, buffer.get(), clock_time(state.time), settings.camera_name);
    publish_changes(self);
    return gst_pad_push(priv.src, buffer.release());
  });
}

gboolean video_event(GstPad* pad, GstObject* parent, GstEvent* event) {
  Private& priv = *cerberus_pir_fusion_self(parent)->priv;
  State& state = *priv.state;
  switch (GST_EVENT_TYPE(event)) {
    case GST_EVENT_STREAM_START:
      state.live.reset();
      priv.stamps.reset();
      priv.inputs.begin_video();
      break;
    case GST_EVENT_SEGMENT: {
      // Another piece of the material is another scene. (What comes again after a new link is the same.)
      const GstSegment* segment;
      gst_event_parse_segment(event, &segment);
      if (state.segment.format != GST_FORMAT_UNDEFINED && !gst_segment_is_equal(segment, &state.segment))
        priv.decisions.begin_anew();
      gst_segment_copy_into(segment, &state.segment);
      state.times.mark();
      state.live.reset();
      break;
    }
    case GST_EVENT_FLUSH_START:
      priv.inputs.set_flushing(true);
      priv.decisions.end();  // a decision that is in progress does not become the last one
      break;
    case GST_EVENT_FLUSH_STOP:
      priv.decisions.begin_anew();
      state.time = Time::zero();
      state.times.forget();
      gst_segment_init(&state.segment, GST_FORMAT_UNDEFINED);
      priv.inputs.begin_video();
      priv.inputs.set_flushing(false);
      break;
    case GST_EVENT_GAP:
      state.times.mark();
      break;
    case GST_EVENT_EOS:
      priv.inputs.end_video();
      priv.decisions.end();
      break;
    case GST_EVENT_CUSTOM_DOWNSTREAM_OOB:
      // Of another one upstream, whose decisions on frames are replaced here.
      if (!gst_event_has_name(event, CERBERUS_EVENT_FUSION)) break;
      gst_event_unref(event);
      return TRUE;
    default:
      break;
  }
  return gst_pad_event_default(pad, parent, event);
}

// The pads that stand for each other: caps, events and queries go between sink and src, and no PIR pad is asked.
GstIterator* internal_links(GstPad* pad, GstObject* parent) {
  const Private& priv = *cerberus_pir_fusion_self(parent)->priv;
  GValue other = G_VALUE_INIT;
  g_value_init(&other, GST_TYPE_PAD);
  g_value_set_object(&other, pad == priv.sink ? priv.src : priv.sink);
  GstIterator* iterator = gst_iterator_new_single(GST_TYPE_PAD, &other);
  g_value_unset(&other);
  return iterator;
}

void listen(Private& priv, GstEvent* event) {
  g_autoptr(CerberusPose) pose = cerberus_event_parse_pose(event);
  const std::string head = priv.settings.snapshot().head;
  if (pose && is_named(*pose, head)) {
    priv.pose_thread.on_pose(pose->head);
    priv.inputs.add_pose(*pose);
  } else if (pose)
    priv.inputs.add_other_head(*pose);
  else if (g_autoptr(CerberusBase) base = cerberus_event_parse_base(event))
    priv.inputs.add_base(base->yaw_rate, base->speed, time_of(base->valid_from));
}

gboolean src_event(GstPad* pad, GstObject* parent, GstEvent* event) {
  auto* self = cerberus_pir_fusion_self(parent);
  const GstEventType type = GST_EVENT_TYPE(event);
  auto& inputs = self->priv->inputs;
  if (type == GST_EVENT_SEEK) inputs.begin_seek();
  guarded(self, [&] {
    if (type == GST_EVENT_CUSTOM_UPSTREAM) listen(*self->priv, event);
    // First to the PIR pads: after a flushing seek no frame must meet readings of the time before.
    if (type == GST_EVENT_CUSTOM_UPSTREAM || type == GST_EVENT_SEEK) push_to_pirs(self, event);
  });
  const gboolean handled = gst_pad_event_default(pad, parent, event);
  if (type == GST_EVENT_SEEK) inputs.end_seek();
  return handled;
}

// Of the head downstream; one of another name finds its pirfusion, if any, on its own way up.
gboolean src_query(GstPad* pad, GstObject* parent, GstQuery* query) {
  auto* self = cerberus_pir_fusion_self(parent);
  std::string_view head;
  guint track = 0;
  if (!parse_follow_query(query, head, track)) return gst_pad_query_default(pad, parent, query);
  return guarded(self, FALSE, [&]() -> gboolean {
    const std::string own = self->priv->settings.snapshot().head;
    if (!own.empty() && own != head) return FALSE;
    self->priv->decisions.choose(track);
    return TRUE;
  });
}

GstPad* request_new_pad(GstElement* element, GstPadTemplate* pad_template, const gchar* name,
                        const GstCaps*) {
  return guarded(element, nullptr, [&]() -> GstPad* {
    GstPad* pad = cerberus_pir_fusion_self(element)->priv->inputs.add_pad(name, pad_template);
    if (!pad) {
      GST_WARNING_OBJECT(element, "no pad %s: it is there, or its sensors would be the 17th and more",
                         name ? name : "pir_%u");
      return nullptr;
    }
    gst_element_add_pad(element, pad);
    if (GST_STATE(element) >= GST_STATE_PAUSED || GST_STATE_TARGET(element) >= GST_STATE_PAUSED)
      gst_pad_set_active(pad, TRUE);
    return pad;
  });
}

void release_pad(GstElement* element, GstPad* pad) {
  cerberus_pir_fusion_self(element)->priv->inputs.drop_pad(pad);
  gst_pad_set_active(pad, FALSE);
  gst_element_remove_pad(element, pad);
}

bool check_settings(CerberusPirFusion* self) {
  const Settings settings = self->priv->settings.snapshot();
  std::string fault = limits_fault(settings);
  if (fault.empty() && load_rules(self, settings.rules_file, fault)) return true;
  CERBERUS_ELEMENT_ERROR(self, RESOURCE, SETTINGS, (fault), (nullptr));
  return false;
}

std::string settings_fault(GstElement* element) {
  const Settings settings = cerberus_pir_fusion_self(element)->priv->settings.snapshot();
  if (std::string fault = limits_fault(settings); !fault.empty()) return fault;
  return settings.rules_file.empty() ? "" : fusion::load_rules(settings.rules_file).error;
}

void forget_everything(Private& priv) {
  priv.state = std::make_unique<State>();
  priv.settings.refresh();
  priv.decisions.forget();
  priv.inputs.forget();
  priv.pose_thread.forget();
}

// A sink pad that is switched off lets go of the frame that waits in its chain function, and no frame is the last one
// any more: the sensors' threads may still run.
gboolean activate(GstPad*, GstObject* parent, GstPadMode mode, gboolean active) {
  if (mode != GST_PAD_MODE_PUSH) return FALSE;
  Private& priv = *cerberus_pir_fusion_self(parent)->priv;
  priv.inputs.set_flushing(!active);
  if (!active) priv.decisions.end();
  return TRUE;
}

GstStateChangeReturn change_state(GstElement* element, GstStateChange transition) {
  auto* self = cerberus_pir_fusion_self(element);
  if (transition == GST_STATE_CHANGE_NULL_TO_READY &&
      !guarded(self, false, [&] { return check_settings(self); }))
    return GST_STATE_CHANGE_FAILURE;
  const GstStateChangeReturn result = cerberus_pir_fusion_parent_class()->change_state(element, transition);
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY) guarded(self, [&] { forget_everything(*self->priv); });
  return result;
}

void set_property(GObject* object, guint id, const GValue* value, GParamSpec* spec) {
  auto* self = cerberus_pir_fusion_self(object);
  guarded(self, [&] {
    if (g_str_equal(spec->name, "rules-file") && GST_STATE(self) >= GST_STATE_READY) {
      const gchar* path = g_value_get_string(value);
      std::string error;
      if (!load_rules(self, path ? path : "",
                      error)) {  // and the property keeps its value: that is what runs
        CERBERUS_ELEMENT_WARNING(self, RESOURCE, SETTINGS, (error), ("the rules of before stay"));
        return;
      }
    }
    auto& settings = self->priv->settings;
    const Settings before = settings.snapshot();
    settings.set(kProperties, id, value);
    const std::string fault = limits_fault(settings.snapshot());
    if (fault.empty() || GST_STATE(self) < GST_STATE_READY)
      return;  // before READY they are an error of the start
    settings.adjust([&](Settings& s) {
      s.pan_minimum = before.pan_minimum;
      s.pan_maximum = before.pan_maximum;
    });
    CERBERUS_ELEMENT_WARNING(self, RESOURCE, SETTINGS, (fault + " The old limits stay."), (nullptr));
  });
}

void get_property(GObject* object, guint id, GValue* value, GParamSpec*) {
  cerberus_pir_fusion_self(object)->priv->settings.get(kProperties, id, value);
}

void cerberus_pir_fusion_init(CerberusPirFusion* self) {
  Private& priv = *self->priv;
  priv.sink = gst_pad_new_from_static_template(&sink_template, "sink");
  priv.src = gst_pad_new_from_static_template(&src_template, "src");
  priv.inputs.on_reading = [self] { decide_between_frames(self); };
  gst_pad_set_chain_function(priv.sink, video_chain);
  gst_pad_set_event_function(priv.sink, video_event);
  gst_pad_set_activatemode_function(priv.sink, activate);
  gst_pad_set_event_function(priv.src, src_event);
  gst_pad_set_query_function(priv.src, src_query);
  for (GstPad* pad : {priv.sink, priv.src}) {
    gst_pad_set_iterate_internal_links_function(pad, internal_links);
    GST_PAD_SET_PROXY_CAPS(pad);
    gst_element_add_pad(GST_ELEMENT(self), pad);
  }
  GST_PAD_SET_PROXY_ALLOCATION(priv.sink);
}

void cerberus_pir_fusion_class_init(CerberusPirFusionClass* klass) {
  GObjectClass* object = G_OBJECT_CLASS(klass);
  object->set_property = set_property;
  object->get_property = get_property;
  Adjustable<Settings>::install(object, kProperties);
  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  element->request_new_pad = request_new_pad;
  element->release_pad = release_pad;
  element->change_state = change_state;
  element->query = settings_query<cerberus_pir_fusion_parent_class, settings_fault>;
  // The PIR pads first: a link without a pad's name (`queue ! fusion.`) takes the first template that fits.
  for (GstStaticPadTemplate* each : {&pir_template, &sink_template, &src_template})
    gst_element_class_add_static_pad_template(element, each);
  gst_element_class_set_static_metadata(element, "PIR fusion", "Filter/Analyzer/Video",
                                        "Decides from camera and PIR sensors where a head should look",
                                        "The Cerberus developers");
}

}  // namespace
}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(pirfusion, GST_RANK_NONE, cerberus::plugin::cerberus_pir_fusion, pirfusion_debug,
                          "sensor fusion")
