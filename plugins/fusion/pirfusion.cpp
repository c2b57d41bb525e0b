// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-pirfusion
 *
 * Decides, frame by frame, where a pan-tilt head should look: from the confirmed tracks on the frame and from the PIR
 * sensors around it. The decision (#CerberusFusion: rule, action, target, sensors, pan angle, limits) is attached to
 * the buffer, which goes through otherwise untouched and in the thread it came in; at every change it is posted as an
 * element message `cerberus-fusion` too.
 *
 * Pads: `sink` and `src` take any caps; caps, allocation and latency are theirs alone. Each `pir_%u` takes PIR readings
 * (`application/x-pir`, what the sensors cover is read from the caps; several pads are counted on in the order of their
 * numbers, 16 sensors at most). `format=level` (volts) is refused: who measures them knows the threshold, `pirsrc`
 * has it.
 *
 * - Live: a frame never waits; the newest reading not later than the frame counts. Without one the sensors are invalid.
 * - Not live: a frame waits until readings, GAP events or EOS of every linked PIR pad cover its running time, so that
 *   every run gives the same. A pad that is silent for `max-wait` is warned of, is invalid, and is not waited for until
 *   it speaks. Video and PIR need a thread each (a `queue`) where one element makes both.
 * - A pad that ended (EOS) keeps its last reading.
 *
 * The pan angle comes from the pose on the buffer, else from the head's `cerberus-pose` events passing upstream,
 * evaluated at the frame's running time; until a head has told, it is not known, and no turn is ordered. Readings that
 * come while a `cerberus-base` event says that the robot turns faster than 5 degrees a second are doubtful and do not
 * count. Both events, and seeks, are passed on to the video and to the PIR pads.
 *
 * `rules=paper` is the paper's table and no more: it knows no `return-delay` and no `hysteresis`. A table of your own is
 * described in the manual (rules); one that leaves a case open or contradicts itself is refused and the case named.
 *
 * ## Example
 * |[
 * gst-launch-1.0 -m videotestsrc num-buffers=60 pattern=ball ! motiondetect ! pirfusion ! fakesink
 * gst-launch-1.0 videotestsrc num-buffers=60 pattern=ball ! motiondetect ! pirfusion name=fusion ! fakesink \
 *     fakesrc num-buffers=1 sizetype=fixed sizemax=3 filltype=zero format=time do-timestamp=true ! \
 *     "application/x-pir,format=presence,sensors=3,bearings=<0.0,-120.0,120.0>,field-of-view=120.0" ! fusion.pir_0
 * ]|
 *
 * Since: 0.1
 */
// The rules are the paper's II.D, the state machine is lib/fusion. The shape is textoverlay's: a GstAggregator waits
// where it must not (DESIGN.md). Locks: one, `Private::lock`, for what the pads share; nothing is pushed, queried or
// posted while it is held, and no GStreamer object's lock is taken under it.
#include <cerberus/cerberus.h>

#include <algorithm>
#include <condition_variable>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "cerberus/private/element.hpp"
#include "fusion/fuser.h"
#include "fusion/rule_file.h"
#include "pir_pad.hpp"
#include "properties.hpp"

GST_DEBUG_CATEGORY_STATIC(pirfusion_debug);
#define GST_CAT_DEFAULT pirfusion_debug

namespace cerberus::plugin {
namespace {

// A PIR source that is not live waits when it is so far ahead of the video: a file is not read into memory as a whole.
constexpr Time kAhead = std::chrono::seconds(10);
constexpr fusion::FuserOptions kDefaults{};

GstStaticPadTemplate sink_template =
    GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS_ANY);
GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS_ANY);
GstStaticPadTemplate pir_template =
    GST_STATIC_PAD_TEMPLATE("pir_%u", GST_PAD_SINK, GST_PAD_REQUEST, GST_STATIC_CAPS(CERBERUS_PIR_CAPS));

enum Rules { RULES_COMPLETE, RULES_PAPER };

GType rules_type() {
  static const GEnumValue values[] = {
      {RULES_COMPLETE, "Computed from the sensors' bearings, the lens and the head's limits", "complete"},
      {RULES_PAPER, "The seven rules of the paper, literally, for three sensors", "paper"},
      {0, nullptr, nullptr}};
  static const GType type = g_enum_register_static("CerberusFusionRules", values);
  return type;
}

GType target_type() {
  using fusion::TargetChoice;
  static const GEnumValue values[] = {
      {static_cast<int>(TargetChoice::nearest), "The nearest (without distances: feet lowest in the picture)",
       "nearest"},
      {static_cast<int>(TargetChoice::largest), "The largest in the picture", "largest"},
      {static_cast<int>(TargetChoice::newest), "The one that came last", "newest"},
      {0, nullptr, nullptr}};
  static const GType type = g_enum_register_static("CerberusFusionTarget", values);
  return type;
}

constexpr guint64 nanoseconds(Time time) {
  return static_cast<guint64>(time.count());
}
constexpr Time duration(guint64 nanoseconds) {
  return Time(static_cast<Time::rep>(std::min<guint64>(nanoseconds, std::numeric_limits<Time::rep>::max())));
}

struct Settings {
  int rules = RULES_COMPLETE;
  std::string rules_file;
  int target = static_cast<int>(kDefaults.choice);
  guint64 return_delay = nanoseconds(kDefaults.return_delay);
  guint64 hold_stopped = nanoseconds(kDefaults.hold_stopped);
  guint64 camera_hold = nanoseconds(kDefaults.camera_hold);
  double hysteresis = 2;
  double horizontal_fov = 60;
  double pan_minimum = -170, pan_maximum = 170;
  guint64 max_wait = 5 * GST_SECOND;
  std::string head = "head";
};

const Property<Settings> kProperties[] = {
    property("rules", &Settings::rules, rules_type, "The rule set; rules-file goes before it"),
    property(
        "rules-file", &Settings::rules_file,
        "Path of a rule table of your own (TOML); empty = none. A table with a gap or a contradiction is "
        "refused; given while the element runs, the old rules stay"),
    property("target", &Settings::target, target_type,
             "Whom to follow when nobody is followed yet; whoever is followed stays the target"),
    property(
        "return-delay", &Settings::return_delay,
        "Nanoseconds without any detection after which the head returns to zero; 0 = at once. rules=paper "
        "has none"),
    property(
        "hold-stopped", &Settings::hold_stopped,
        "Nanoseconds for which a followed person who stopped moving is watched at least; 0 = not at all"),
    property(
        "camera-hold", &Settings::camera_hold,
        "Nanoseconds for which the camera counts as having found somebody after the last track; 0 = only "
        "while there is one"),
    property("hysteresis", &Settings::hysteresis, 0, 90,
             "Degrees by which pan must leave a sector or a band of angles before it counts as outside; 0 = "
             "edges are sharp. rules=paper has none"),
    property(
        "horizontal-fov", &Settings::horizontal_fov, 0, 179,
        "Angle in degrees that the lens sees over the frame's whole width: searches stop half of it before "
        "a sector's edge; 0 = not known, searches go to the edge"),
    property("pan-min", &Settings::pan_minimum, -3600, 3600, "Leftmost pan angle of the head in degrees"),
    property("pan-max", &Settings::pan_maximum, -3600, 3600, "Rightmost pan angle of the head in degrees"),
    property(
        "max-wait", &Settings::max_wait,
        "Nanoseconds of real time that a frame of a stream that is not live waits for a PIR pad, which is "
        "then warned of and not waited for until it speaks; 0 = never wait"),
    property("head", &Settings::head, "Name of the head whose pose counts; empty = any"),
};

// What is known of a frame before the fuser is asked.
struct Moment {
  std::array<std::uint8_t, sensing::kMaxSensors> sensors{};
  std::array<double, sensing::kMaxSensors> bearings{}, fields_of_view{};
  std::size_t count = 0;
  double pan_degrees = fusion::kUnknown, base_degrees = fusion::kUnknown;
};

struct State {  // video thread only
  fusion::Fuser fuser;
  GstSegment segment;
  std::optional<bool> live;  // nothing: not asked yet
  Time time{};               // of the last frame
  std::vector<fusion::Track> tracks;
  std::string rule_name;  // what interned_name belongs to
  const gchar* interned_name = nullptr;

  State() { gst_segment_init(&segment, GST_FORMAT_UNDEFINED); }
};

struct Private {
  GstPad* sink = nullptr;
  GstPad* src = nullptr;
  Adjustable<Settings> settings;
  std::unique_ptr<State> state = std::make_unique<State>();

  std::mutex lock;
  std::condition_variable news;  // of anything below
  std::vector<GstPad*> pir;      // by number; the element owns them
  Timeline<CerberusPose> poses;
  Timeline<double> base;  // yaw rate, degrees a second
  Time video{};           // newest frame that came
  bool flushing = true;   // also while the sink pad is not active
  bool video_ended = false;
  std::shared_ptr<const fusion::RuleTable> table;  // of rules-file
};

CERBERUS_DEFINE_TYPE(CerberusPirFusion, cerberus_pir_fusion, GstElement, GST_TYPE_ELEMENT, Private)

struct BufferDeleter {
  void operator()(GstBuffer* buffer) const { gst_buffer_unref(buffer); }
};
using Buffer = std::unique_ptr<GstBuffer, BufferDeleter>;

// ---- rules and options

// Reads rules-file; false with the reason when its table cannot be used. The old one stays then.
bool load_rules(CerberusPirFusion* self, std::string& error) {
  const Settings settings = self->priv->settings.snapshot();
  std::shared_ptr<const fusion::RuleTable> table;
  if (!settings.rules_file.empty()) {
    fusion::RuleFile file = fusion::load_rules(settings.rules_file);
    if (!file.table) {
      error = std::move(file.error);
      return false;
    }
    table = std::make_shared<const fusion::RuleTable>(std::move(*file.table));
  }
  {
    const std::lock_guard guard(self->priv->lock);
    self->priv->table = std::move(table);
  }
  self->priv->settings.refresh();
  return true;
}

std::string limits_fault(const Settings& settings) {
  if (settings.pan_minimum <= settings.pan_maximum) return {};
  return "pan-min (" + std::to_string(settings.pan_minimum) + ") is above pan-max (" +
         std::to_string(settings.pan_maximum) + ").";
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
  fusion::Fuser& fuser = self->priv->state->fuser;
  fusion::FuserOptions options;
  const bool paper = !table && s.rules == RULES_PAPER;
  if (paper) options = fusion::paper_options();
  options.rules = paper || table ? fusion::RuleSet::table : fusion::RuleSet::complete;
  options.choice = static_cast<fusion::TargetChoice>(s.target);
  options.camera_hold = duration(s.camera_hold);
  options.hold_stopped = duration(s.hold_stopped);
  if (!paper) {
    options.return_delay = duration(s.return_delay);
    options.hysteresis = sensing::radians(s.hysteresis);
  }
  options.lens = sensing::radians(s.horizontal_fov);
  options.limits = {sensing::radians(s.pan_minimum), sensing::radians(s.pan_maximum)};
  if (const std::string fault = limits_fault(s); !fault.empty()) {
    options.limits = fuser.options().limits;
    GST_ELEMENT_WARNING(self, RESOURCE, SETTINGS, ("%s The old limits stay.", fault.c_str()), (nullptr));
  }
  if (paper || table) fuser.set_table(table ? *table : fusion::paper_rules());
  fuser.set_options(options);
}

// ---- a frame

// Waits until every linked PIR pad covers `time`; false when the video is flushed meanwhile. Names of pads that kept
// silent for max-wait are added to `silent`. The lock is held, and let go while waiting.
bool wait_for_sensors(Private& priv, std::unique_lock<std::mutex>& guard, Time time, guint64 max_wait,
                      std::vector<std::string>& silent) {
  const auto begin = std::chrono::steady_clock::now();
  const auto missing = [&](GstPad* pad) {
    const PirPad& pir = pir_pad(pad);
    return pir.linked && !pir.given_up && !pir.history.covers(time);
  };
  const auto ready = [&] { return priv.flushing || std::ranges::none_of(priv.pir, missing); };
  if (max_wait == GST_CLOCK_TIME_NONE) {
    priv.news.wait(guard, ready);
  } else if (max_wait > 0 &&
             !priv.news.wait_until(
                 guard, begin + std::min<Time>(duration(max_wait), std::chrono::hours(24 * 365)), ready)) {
    for (GstPad* pad : priv.pir)
      if (missing(pad)) {
        pir_pad(pad).given_up = true;
        silent.emplace_back(GST_PAD_NAME(pad));
      }
  }
  return !priv.flushing;
}

// The lock is held.
void read_sensors(Private& priv, Time time, Moment& moment) {
  for (GstPad* pad : priv.pir) {
    PirPad& pir = pir_pad(pad);
    Reading reading = pir.history.at(time);
    pir.history.forget_before(time);
    if (!reading.array) continue;
    if (!pir.linked || pir.given_up) reading.values.fill(2);
    for (std::size_t i = 0; i < static_cast<std::size_t>(reading.array->count); ++i) {
      if (moment.count == moment.sensors.size()) return;
      moment.sensors[moment.count] = reading.values[i];
      moment.bearings[moment.count] = reading.array->bearings[i];
      moment.fields_of_view[moment.count++] = reading.array->field_of_view;
    }
  }
}

bool is_our_head(const Settings& settings, const gchar* head) {
  return settings.head.empty() || settings.head == head;
}

// Where the head looked then: what the buffer carries goes before what was heard. The lock is held.
void read_pose(Private& priv, const Settings& settings, GstBuffer* buffer, Time time, Moment& moment) {
  const CerberusPose* pose = cerberus_buffer_peek_pose(buffer);
  if (!pose || !is_our_head(settings, pose->head)) {
    pose = priv.poses.at(time);
    if (!pose) pose = priv.poses.first();
    if (pose && !is_our_head(settings, pose->head)) pose = nullptr;
  }
  if (pose) cerberus_pose_evaluate(pose, nanoseconds(time), &moment.pan_degrees, nullptr);
  if (const double* rate = priv.base.at(time)) moment.base_degrees = *rate;
  priv.poses.forget_before(time);
  priv.base.forget_before(time);
}

void read_tracks(GstBuffer* buffer, std::vector<fusion::Track>& tracks) {
  tracks.clear();
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(buffer);
  for (guint i = 0; i < regions->len; ++i) {
    const auto& region = *static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i));
    if (!region.tracked || region.id == 0) continue;
    tracks.push_back({.id = region.id,
                      .x = region.x,
                      .y = region.y,
                      .width = region.width,
                      .height = region.height,
                      .bearing = sensing::radians(region.bearing),
                      .distance = region.distance,
                      .age = duration(region.age),
                      .state = region.state == CERBERUS_REGION_STOPPED   ? fusion::TrackState::stopped
                               : region.state == CERBERUS_REGION_COASTED ? fusion::TrackState::coasted
                                                                         : fusion::TrackState::seen});
  }
}

constexpr bool same(fusion::Action ours, CerberusFusionAction theirs) {
  return static_cast<int>(ours) == static_cast<int>(theirs);
}
static_assert(same(fusion::Action::track, CERBERUS_FUSION_TRACK) &&
              same(fusion::Action::turn_left, CERBERUS_FUSION_TURN_LEFT) &&
              same(fusion::Action::turn_right, CERBERUS_FUSION_TURN_RIGHT) &&
              same(fusion::Action::search, CERBERUS_FUSION_SEARCH) &&
              same(fusion::Action::zero, CERBERUS_FUSION_ZERO) &&
              same(fusion::Action::hold, CERBERUS_FUSION_HOLD));

CerberusFusion as_fusion(State& state, const fusion::Decision& decision, const Moment& moment) {
  CerberusFusion fusion;
  cerberus_fusion_init(&fusion);
  if (!decision.rule_name.empty()) {
    if (!state.interned_name || state.rule_name != decision.rule_name) {
      state.rule_name = decision.rule_name;
      state.interned_name = g_intern_string(state.rule_name.c_str());
    }
    fusion.rule_name = state.interned_name;
  }
  fusion.rule = decision.rule;
  fusion.action = static_cast<CerberusFusionAction>(decision.action);
  fusion.target = decision.target;
  fusion.pan = moment.pan_degrees;
  fusion.sector_from = sensing::degrees(decision.sector.from);
  fusion.sector_to = sensing::degrees(decision.sector.to);
  fusion.limited = decision.limited;
  fusion.camera_found = decision.camera_found;
  fusion.n_sensors = static_cast<guint>(moment.count);
  std::copy_n(moment.sensors.begin(), moment.count, std::begin(fusion.sensors));
  fusion.doubtful = decision.doubtful;
  return fusion;
}

// Tells what was decided: on the buffer, and by message when it is something else.
GstFlowReturn decide_and_push(CerberusPirFusion* self, Buffer buffer, Time time, const Moment& moment) {
  State& state = *self->priv->state;
  if (moment.count > 0) {
    sensing::Geometry geometry;
    geometry.set(std::span(moment.bearings).first(moment.count),
                 std::span(moment.fields_of_view).first(moment.count));
    state.fuser.set_geometry(geometry);
  }
  read_tracks(buffer.get(), state.tracks);
  const fusion::Decision& decision =
      state.fuser.update({.time = time,
                          .tracks = state.tracks,
                          .sensors = std::span(moment.sensors).first(moment.count),
                          .pan = sensing::radians(moment.pan_degrees),
                          .base_yaw_rate = sensing::radians(moment.base_degrees)});
  const CerberusFusion fusion = as_fusion(state, decision, moment);
  buffer.reset(gst_buffer_make_writable(buffer.release()));
  cerberus_buffer_set_fusion(buffer.get(), &fusion);
  if (decision.changed)
    gst_element_post_message(GST_ELEMENT(self),
                             cerberus_message_new_fusion(GST_OBJECT(self), nanoseconds(time), &fusion));
  return gst_pad_push(self->priv->src, buffer.release());
}

GstFlowReturn video_chain(GstPad* pad, GstObject* parent, GstBuffer* taken) {
  auto* self = cerberus_pir_fusion_self(parent);
  return guarded(self, GST_FLOW_ERROR, [&] {
    Buffer buffer(taken);
    Private& priv = *self->priv;
    State& state = *priv.state;
    apply_settings(self);
    const Settings settings = priv.settings.snapshot();
    // A frame without a time is as late as the one before.
    state.time = running_time(state.segment, GST_BUFFER_PTS(buffer.get())).value_or(state.time);
    if (!state.live) state.live = is_live(pad);

    Moment moment;
    std::vector<std::string> silent;
    {
      std::unique_lock guard(priv.lock);
      priv.video = state.time;
      priv.news.notify_all();
      if (!*state.live && !wait_for_sensors(priv, guard, state.time, settings.max_wait, silent))
        return GST_FLOW_FLUSHING;
      read_sensors(priv, state.time, moment);
      read_pose(priv, settings, buffer.get(), state.time, moment);
    }
    for (const std::string& name : silent)
      GST_ELEMENT_WARNING(
          self, RESOURCE, READ,
          ("No reading of the PIR sensors came at pad %s for %.3g s; it is not waited for any more.",
           name.c_str(), static_cast<double>(settings.max_wait) / GST_SECOND),
          ("frame at running time %" GST_TIME_FORMAT, GST_TIME_ARGS(nanoseconds(state.time))));
    return decide_and_push(self, std::move(buffer), state.time, moment);
  });
}

// ---- the video's events

void set_flushing(Private& priv, bool& flag, bool flushing) {
  const std::lock_guard guard(priv.lock);
  flag = flushing;
  priv.news.notify_all();
}

void begin_video(Private& priv) {
  const std::lock_guard guard(priv.lock);
  priv.video_ended = false;
  priv.video = Time::zero();
}

gboolean video_event(GstPad* pad, GstObject* parent, GstEvent* event) {
  Private& priv = *cerberus_pir_fusion_self(parent)->priv;
  State& state = *priv.state;
  switch (GST_EVENT_TYPE(event)) {
    case GST_EVENT_STREAM_START:
      state.live.reset();
      set_flushing(priv, priv.video_ended, false);
      break;
    case GST_EVENT_SEGMENT: {
      // Another piece of the material is another scene. (What comes again after a new link is the same.)
      const GstSegment* segment;
      gst_event_parse_segment(event, &segment);
      if (state.segment.format != GST_FORMAT_UNDEFINED && !gst_segment_is_equal(segment, &state.segment))
        state.fuser.reset();
      gst_segment_copy_into(segment, &state.segment);
      state.live.reset();
      break;
    }
    case GST_EVENT_FLUSH_START:
      set_flushing(priv, priv.flushing, true);
      break;
    case GST_EVENT_FLUSH_STOP:
      state.fuser.reset();
      state.time = Time::zero();
      gst_segment_init(&state.segment, GST_FORMAT_UNDEFINED);
      begin_video(priv);
      set_flushing(priv, priv.flushing, false);
      break;
    case GST_EVENT_EOS:
      set_flushing(priv, priv.video_ended, true);
      break;
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

GstIterator* no_internal_links(GstPad*, GstObject*) {
  return nullptr;
}

// ---- events from downstream

void listen(Private& priv, GstEvent* event) {
  g_autoptr(CerberusPose) pose = cerberus_event_parse_pose(event);
  double rate = 0;
  GstClockTime from = 0;
  if (pose && is_our_head(priv.settings.snapshot(), pose->head)) {
    const std::lock_guard guard(priv.lock);
    if (priv.poses.last() && priv.poses.last()->value.head != pose->head) priv.poses.clear();
    priv.poses.insert(duration(pose->valid_from), *pose);
  } else if (cerberus_event_parse_base(event, &rate, &from)) {
    const std::lock_guard guard(priv.lock);
    priv.base.insert(duration(from), rate);
  }
}

// The PIR pads, with a reference each.
std::vector<GstPad*> pir_pads(Private& priv) {
  const std::lock_guard guard(priv.lock);
  std::vector<GstPad*> pads = priv.pir;
  for (GstPad* pad : pads) gst_object_ref(pad);
  return pads;
}

gboolean src_event(GstPad* pad, GstObject* parent, GstEvent* event) {
  auto* self = cerberus_pir_fusion_self(parent);
  guarded(self, [&] {
    const GstEventType type = GST_EVENT_TYPE(event);
    if (type == GST_EVENT_CUSTOM_UPSTREAM) listen(*self->priv, event);
    // First to the PIR pads: after a flushing seek no frame must meet readings of the time before.
    if (type == GST_EVENT_CUSTOM_UPSTREAM || type == GST_EVENT_SEEK)
      for (GstPad* pir : pir_pads(*self->priv)) {
        gst_pad_push_event(pir, gst_event_ref(event));
        gst_object_unref(pir);
      }
  });
  return gst_pad_event_default(pad, parent, event);
}

// ---- the PIR pads

// Takes over what the caps say; else the reason why they cannot be fused.
std::string take_caps(Private& priv, PirPad& pir, const GstCaps* caps) {
  CerberusPirInfo info;
  g_autoptr(GError) error = nullptr;
  if (!cerberus_pir_info_from_caps(&info, caps, &error)) return error->message;
  if (info.format == CERBERUS_PIR_LEVEL)
    return "PIR readings in volts (format=level) cannot be fused: let the source compare them with a "
           "threshold "
           "(format=presence).";
  const auto count = static_cast<int>(info.sensors);
  const std::lock_guard guard(priv.lock);
  int others = -pir.sensors;
  for (GstPad* each : priv.pir) others += pir_pad(each).sensors;
  if (others + count > sensing::kMaxSensors)
    return std::to_string(count) + " PIR sensors are too many besides the other pads' " +
           std::to_string(others) + ": " + std::to_string(sensing::kMaxSensors) + " in all can be fused.";
  pir.sensors = count;
  pir.history.set_array(sensor_array(info));
  pir.info = info;
  return {};
}

// What cannot be used comes again with the next buffer: said once.
void refuse(CerberusPirFusion* self, GstPad* pad, const std::string& fault) {
  if (std::exchange(pir_pad(pad).refused, true)) return;
  GST_ELEMENT_ERROR(self, CORE, NEGOTIATION, ("Pad %s: %s", GST_PAD_NAME(pad), fault.c_str()), (nullptr));
}

bool pir_caps(CerberusPirFusion* self, GstPad* pad, const GstCaps* caps) {
  PirPad& pir = pir_pad(pad);
  const std::string fault = take_caps(*self->priv, pir, caps);
  if (fault.empty()) {
    pir.refused = false;
    return true;
  }
  pir.info.sensors = 0;
  refuse(self, pad, fault);
  return false;
}

// Something was heard. The lock is held.
void spoke(Private& priv, PirPad& pir) {
  pir.given_up = false;
  priv.news.notify_all();
}

void pir_gap(Private& priv, PirPad& pir, GstEvent* event) {
  GstClockTime begin, length;
  gst_event_parse_gap(event, &begin, &length);
  const auto from = running_time(pir.segment, begin);
  if (!from) return;
  const std::lock_guard guard(priv.lock);
  const bool has_length = GST_CLOCK_TIME_IS_VALID(length) && length > 0;
  pir.history.cover(*from + (has_length ? std::min(duration(length), Time::max() / 4) : Time(1)));
  spoke(priv, pir);
}

bool pir_segment(CerberusPirFusion* self, GstPad* pad, GstEvent* event) {
  const GstSegment* segment;
  gst_event_parse_segment(event, &segment);
  if (segment->format != GST_FORMAT_TIME) {
    refuse(self, pad, "PIR readings need times, and their stream has none.");
    return false;
  }
  gst_segment_copy_into(segment, &pir_pad(pad).segment);
  pir_pad(pad).live.reset();
  return true;
}

// Nothing of it ever reaches the source pad.
bool hear(CerberusPirFusion* self, GstPad* pad, GstEvent* event) {
  Private& priv = *self->priv;
  PirPad& pir = pir_pad(pad);
  switch (GST_EVENT_TYPE(event)) {
    case GST_EVENT_STREAM_START:
      pir.refused = false;
      break;
    case GST_EVENT_CAPS: {
      GstCaps* caps;
      gst_event_parse_caps(event, &caps);
      return pir_caps(self, pad, caps);
    }
    case GST_EVENT_SEGMENT:
      return pir_segment(self, pad, event);
    case GST_EVENT_GAP:
      pir_gap(priv, pir, event);
      break;
    case GST_EVENT_FLUSH_START:
      set_flushing(priv, pir.flushing, true);
      break;
    case GST_EVENT_FLUSH_STOP: {
      const std::lock_guard guard(priv.lock);
      pir.history.clear();
      gst_segment_init(&pir.segment, GST_FORMAT_UNDEFINED);
      pir.flushing = false;
      break;
    }
    case GST_EVENT_SEGMENT_DONE:
    case GST_EVENT_EOS: {
      const std::lock_guard guard(priv.lock);
      pir.history.end();
      spoke(priv, pir);
      break;
    }
    default:
      break;
  }
  return true;
}

gboolean pir_event(GstPad* pad, GstObject* parent, GstEvent* event) {
  auto* self = cerberus_pir_fusion_self(parent);
  const bool good = guarded(self, false, [&] { return hear(self, pad, event); });
  gst_event_unref(event);
  return good;
}

GstFlowReturn take_reading(CerberusPirFusion* self, GstPad* pad, GstBuffer* buffer) {
  Private& priv = *self->priv;
  PirPad& pir = pir_pad(pad);
  if (pir.info.sensors == 0) return GST_FLOW_NOT_NEGOTIATED;
  std::array<std::uint8_t, sensing::kMaxSensors> values;
  values.fill(2);
  const gsize wanted = cerberus_pir_info_buffer_size(&pir.info);
  if (gst_buffer_get_size(buffer) == wanted) {
    gst_buffer_extract(buffer, 0, values.data(), wanted);
  } else if (!std::exchange(pir.complained, true)) {
    GST_ELEMENT_WARNING(self, STREAM, FORMAT,
                        ("Pad %s: a PIR reading of %" G_GSIZE_FORMAT " bytes for %u sensors is invalid.",
                         GST_PAD_NAME(pad), gst_buffer_get_size(buffer), pir.info.sensors),
                        (nullptr));
  }
  if (!pir.live) pir.live = is_live(pad);
  const auto time = running_time(pir.segment, GST_BUFFER_PTS(buffer));
  std::unique_lock guard(priv.lock);
  const Time when = time.value_or(pir.history.newest());
  if (!*pir.live)
    priv.news.wait(guard, [&] { return pir.flushing || priv.video_ended || when - priv.video < kAhead; });
  if (pir.flushing) return GST_FLOW_FLUSHING;
  if (priv.video_ended && !*pir.live) return GST_FLOW_EOS;
  pir.history.append(when, std::span(values).first(pir.info.sensors));
  spoke(priv, pir);
  return GST_FLOW_OK;
}

GstFlowReturn pir_chain(GstPad* pad, GstObject* parent, GstBuffer* buffer) {
  auto* self = cerberus_pir_fusion_self(parent);
  const GstFlowReturn flow = guarded(self, GST_FLOW_ERROR, [&] { return take_reading(self, pad, buffer); });
  gst_buffer_unref(buffer);
  return flow;
}

// Linking calls come with the pad's lock held: nothing but our own flag here.
void set_linked(GstPad* pad, GstObject* parent, bool linked) {
  if (!parent) return;
  set_flushing(*cerberus_pir_fusion_self(parent)->priv, pir_pad(pad).linked, linked);
}
GstPadLinkReturn pir_link(GstPad* pad, GstObject* parent, GstPad*) {
  set_linked(pad, parent, true);
  return GST_PAD_LINK_OK;
}
void pir_unlink(GstPad* pad, GstObject* parent) {
  set_linked(pad, parent, false);
}

// A sink pad that is switched off lets go of whoever waits in its chain function.
gboolean activate(GstPad* pad, GstObject* parent, GstPadMode mode, gboolean active) {
  if (mode != GST_PAD_MODE_PUSH) return FALSE;
  Private& priv = *cerberus_pir_fusion_self(parent)->priv;
  set_flushing(priv, pad == priv.sink ? priv.flushing : pir_pad(pad).flushing, !active);
  return TRUE;
}

// ---- request and release

// The number in a name that was asked for, or the next free one; nothing when it is taken. The lock is held.
std::optional<guint> free_index(const Private& priv, const gchar* name) {
  const auto taken = [&](guint index) {
    return std::ranges::any_of(priv.pir, [&](GstPad* pad) { return pir_pad(pad).index == index; });
  };
  guint64 index = 0;
  if (name && g_str_has_prefix(name, "pir_") &&
      g_ascii_string_to_unsigned(name + 4, 10, 0, G_MAXUINT, &index, nullptr))
    return taken(static_cast<guint>(index)) ? std::nullopt : std::optional(static_cast<guint>(index));
  guint next = 0;
  while (taken(next)) ++next;
  return next;
}

GstPad* request_new_pad(GstElement* element, GstPadTemplate* pad_template, const gchar* name,
                        const GstCaps*) {
  Private& priv = *cerberus_pir_fusion_self(element)->priv;
  return guarded(element, nullptr, [&]() -> GstPad* {
    GstPad* pad = nullptr;
    {
      const std::lock_guard guard(priv.lock);
      const auto index = free_index(priv, name);
      if (!index) return nullptr;
      pad = pir_pad_new(("pir_" + std::to_string(*index)).c_str(), pad_template);
      pir_pad(pad).index = *index;
      const auto after =
          std::ranges::find_if(priv.pir, [&](GstPad* each) { return pir_pad(each).index > *index; });
      priv.pir.insert(after, pad);
    }
    gst_pad_set_chain_function(pad, pir_chain);
    gst_pad_set_event_function(pad, pir_event);
    gst_pad_set_link_function(pad, pir_link);
    gst_pad_set_unlink_function(pad, pir_unlink);
    gst_pad_set_activatemode_function(pad, activate);
    gst_pad_set_iterate_internal_links_function(pad, no_internal_links);
    gst_element_add_pad(element, pad);
    if (GST_STATE(element) >= GST_STATE_PAUSED || GST_STATE_TARGET(element) >= GST_STATE_PAUSED)
      gst_pad_set_active(pad, TRUE);
    return pad;
  });
}

void release_pad(GstElement* element, GstPad* pad) {
  Private& priv = *cerberus_pir_fusion_self(element)->priv;
  {
    const std::lock_guard guard(priv.lock);
    std::erase(priv.pir, pad);
    priv.news.notify_all();
  }
  gst_pad_set_active(pad, FALSE);
  gst_element_remove_pad(element, pad);
}

// ---- states

bool check_settings(CerberusPirFusion* self) {
  std::string fault = limits_fault(self->priv->settings.snapshot());
  if (fault.empty() && load_rules(self, fault)) return true;
  GST_ELEMENT_ERROR(self, RESOURCE, SETTINGS, ("%s", fault.c_str()), (nullptr));
  return false;
}

void forget_everything(Private& priv) {
  priv.state = std::make_unique<State>();
  priv.settings.refresh();
  const std::lock_guard guard(priv.lock);
  for (GstPad* pad : priv.pir) pir_pad(pad).reset();
  priv.poses.clear();
  priv.base.clear();
  priv.video = Time::zero();
  priv.video_ended = false;
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

// ---- properties

void set_property(GObject* object, guint id, const GValue* value, GParamSpec* spec) {
  auto* self = cerberus_pir_fusion_self(object);
  guarded(self, [&] {
    self->priv->settings.set(kProperties, id, value);
    if (!g_str_equal(spec->name, "rules-file") || GST_STATE(self) < GST_STATE_READY) return;
    std::string error;
    if (!load_rules(self, error))
      GST_ELEMENT_WARNING(self, RESOURCE, SETTINGS, ("%s", error.c_str()), ("the rules of before stay"));
  });
}

void get_property(GObject* object, guint id, GValue* value, GParamSpec*) {
  cerberus_pir_fusion_self(object)->priv->settings.get(kProperties, id, value);
}

void cerberus_pir_fusion_init(CerberusPirFusion* self) {
  Private& priv = *self->priv;
  priv.sink = gst_pad_new_from_static_template(&sink_template, "sink");
  priv.src = gst_pad_new_from_static_template(&src_template, "src");
  gst_pad_set_chain_function(priv.sink, video_chain);
  gst_pad_set_event_function(priv.sink, video_event);
  gst_pad_set_activatemode_function(priv.sink, activate);
  gst_pad_set_event_function(priv.src, src_event);
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
  for (GstStaticPadTemplate* each : {&sink_template, &src_template, &pir_template})
    gst_element_class_add_static_pad_template(element, each);
  gst_element_class_set_static_metadata(element, "PIR fusion", "Filter/Analyzer/Video",
                                        "Decides from camera and PIR sensors where a head should look",
                                        "The Cerberus developers");
}

}  // namespace
}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(pirfusion, GST_RANK_NONE, cerberus::plugin::cerberus_pir_fusion, pirfusion_debug,
                          "sensor fusion")
