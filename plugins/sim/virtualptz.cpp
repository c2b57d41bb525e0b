// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-virtualptz
 * @title: virtualptz
 * @short_description: a pan-tilt camera made of a wide picture
 * @see_also: pantiltsink, motiondetect, pirfusion
 *
 * Gives the part of a wide picture that a camera on a pan-tilt head would see: a window that moves with the head's
 * pose, resampled with sub-pixel precision. With a `pantiltsink driver=simulated` downstream a fixed 4K camera becomes
 * a pan-tilt camera without a motor, and the whole loop can be closed on recorded footage.
 *
 * A head that publishes what its zoom sees (`pantiltsink driver=simulated` with a `zoom-table` and `keep-size`) zooms
 * the window, as far as the wide picture reaches: `horizontal-fov` is then what the widest zoom sees.
 *
 * The head publishes its pose by the upstream event `cerberus-pose`; another head's (`head`) is ignored, all are
 * forwarded. Each frame carries the pose meta with which it was made, and the base's yaw rate from upstream, 0 without
 * one. The wide picture counts as a pinhole camera's that looks straight ahead and sees `wide-fov`; the window
 * sees `horizontal-fov`, or, for 0, as many pixels as it has. Its size is `width` x `height`, or
 * what downstream takes. It ends at the picture's edges: `pan-min`, `pan-max`, `tilt-min`, `tilt-max` are its
 * limits once the video's size is known, and `window-fov` its angle: `pantiltsink` needs both. A head that
 * points beyond them causes one warning.
 *
 * In a pipeline that is not live, each frame but the first waits until the head's way is known up to its running time
 * (`lockstep`), so that every run gives the same, whatever queues there are; where frames are missing a GAP event is
 * sent downstream. So it is after half the `lockstep-timeout`, at most half a second, without a pose, in case a frame
 * was lost on its way to the head (a leaky queue).
 * When no pose comes for `lockstep-timeout` the element gives up with an error. The first frame (also after a flush)
 * shows the head's last position, `start-pan` and `start-tilt` at
 * the start. In a live pipeline nothing waits: the newest pose counts.
 *
 * With `inset` each frame carries a small picture of the whole scene, with the window's place in it, as a
 * GstVideoOverlayComposition for the upper right corner: `motionoverlay` draws it, and so do most sinks that draw with
 * a graphics card. The frame's own pixels stay as they are for motion detection.
 *
 * Pads: raw progressive video in system memory, in and out in the same format. Regions and overlays that lie on the
 * wide picture are dropped: stages that look for motion belong behind the window.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 pattern=ball ! video/x-raw,width=640,height=480 ! \
 *     virtualptz width=320 height=240 ! motiondetect ! pantiltsink driver=simulated horizontal-fov=32.2 \
 *     pan-min=-16 pan-max=16 tilt-min=-12 tilt-max=12
 * gst-launch-1.0 videotestsrc ! video/x-raw,width=640,height=480 ! virtualptz lockstep=off inset=true ! \
 *     motiondetect ! motionoverlay ! videoconvert ! autovideosink
 * gst-launch-1.0 videotestsrc num-buffers=60 ! virtualptz lockstep=off start-pan=-10 width=160 height=120 ! fakesink
 * ]|
 *
 * Since: 0.1
 */
// This file only connects with GStreamer: lib/motion/pose_feed.h decides when a pose is known, lib/motion/frame_times.h
// when frames are taken; window_view.hpp draws.
#include <cerberus/cerberus.h>
#include <gst/base/gstbasetransform.h>
#include <gst/video/video-overlay-composition.h>
#include <gst/video/video.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

#include "cerberus/private/element.hpp"
#include "head_wait.hpp"
#include "motion/frame_times.h"
#include "motion/pose_feed.h"
#include "shared/complaint.hpp"
#include "shared/poses.hpp"
#include "shared/single_fields.hpp"
#include "shared/times.hpp"
#include "shared/video.hpp"
#include "text/numbers.h"
#include "window_caps.hpp"
#include "window_settings.hpp"
#include "window_view.hpp"

GST_DEBUG_CATEGORY_STATIC(virtualptz_debug);
#define GST_CAT_DEFAULT virtualptz_debug

namespace cerberus::plugin {
namespace {

using motion::Time;
using sensing::degrees;
using sensing::radians;

#define WINDOW_CAPS GST_VIDEO_CAPS_MAKE("{ " CERBERUS_VIDEO_FORMATS_8_BIT " }")
GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE(
    "sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(WINDOW_CAPS "; " SINGLE_FIELDS_CAPS));
GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(WINDOW_CAPS));

struct State {  // streaming thread, and state changes while it does not run
  WindowView view;
  motion::FrameTimes times;
  WindowSettings settings;
  std::optional<bool> live;  // nothing: not asked yet
  Complaint complaint;       // about the caps
  bool warned = false;       // about an unusable buffer, once a stream
  bool beyond = false;       // about a head that looks where no window is, once a start
};

struct Private {
  Adjustable<WindowSettings> settings;
  State state;
  motion::PoseFeed feed;
  std::atomic<double> pan_reach = 0, tilt_reach = 0, window_fov = 0;  // degrees
};

CERBERUS_DEFINE_TYPE(CerberusVirtualPtz, cerberus_virtual_ptz, GstBaseTransform, GST_TYPE_BASE_TRANSFORM,
                     Private)

// ---- caps

GstCaps* transform_caps(GstBaseTransform* trans, GstPadDirection direction, GstCaps* caps, GstCaps* filter) {
  GstCaps* others = across_single_fields(
      direction, window_caps(caps, direction, cerberus_virtual_ptz_self(trans)->priv->settings.snapshot()));
  if (filter) {
    GstCaps* common = gst_caps_intersect_full(filter, others, GST_CAPS_INTERSECT_FIRST);
    gst_caps_unref(others);
    others = common;
  }
  return others;
}

GstCaps* fixate_caps(GstBaseTransform* trans, GstPadDirection direction, GstCaps* caps, GstCaps* others) {
  if (direction == GST_PAD_SINK) others = near_half(caps, others);
  return cerberus_virtual_ptz_parent_class()->fixate_caps(trans, direction, caps, others);
}

gboolean get_unit_size(GstBaseTransform*, GstCaps* caps, gsize* size) {
  GstVideoInfo info;
  if (!gst_video_info_from_caps(&info, caps)) return FALSE;
  *size = GST_VIDEO_INFO_SIZE(&info);
  return TRUE;
}

// Whatever a buffer holds: make_frame() looks at it.
gboolean transform_size(GstBaseTransform* trans, GstPadDirection, GstCaps*, gsize, GstCaps* others,
                        gsize* size) {
  return get_unit_size(trans, others, size);
}

void publish_reach(GstBaseTransform* trans, Private& self) {
  const auto& geometry = self.state.view.geometry();
  self.pan_reach = degrees(geometry.pan_reach());
  self.tilt_reach = degrees(geometry.tilt_reach());
  self.window_fov = degrees(geometry.fov());
  for (const char* name : {"pan-min", "pan-max", "tilt-min", "tilt-max", "window-fov"})
    g_object_notify(G_OBJECT(trans), name);
}

gboolean set_caps(GstBaseTransform* trans, GstCaps* in, GstCaps* out) {
  return guarded(trans, FALSE, [&]() -> gboolean {
    Private& self = *cerberus_virtual_ptz_self(trans)->priv;
    State& state = self.state;
    std::string wrong;
    state.settings = self.settings.snapshot();
    GstVideoInfo picture, window;
    if (!gst_video_info_from_caps(&picture, in) || !gst_video_info_from_caps(&window, out))
      wrong = kCapsIncomplete;
    else if (GST_VIDEO_INFO_IS_INTERLACED(&picture))
      wrong = "A window cannot move over interlaced video: put the element `deinterlace` in front.";
    else
      wrong = state.view.begin(picture, window, state.settings);
    if (state.complaint.is_new(wrong))
      CERBERUS_ELEMENT_ERROR(trans, CORE, NEGOTIATION, (wrong),
                             ("%" GST_PTR_FORMAT " to %" GST_PTR_FORMAT, in, out));
    if (!wrong.empty()) return FALSE;
    state.warned = false;
    publish_reach(trans, self);
    return TRUE;
  });
}

// Angles that changed while running: those that do not fit are not taken.
void apply_settings(GstBaseTransform* trans, Private& self) {
  const auto changed = self.settings.changes();
  if (!changed) return;
  State& state = self.state;
  const bool moved = changed->wide_fov != state.settings.wide_fov ||
                     changed->horizontal_fov != state.settings.horizontal_fov;
  state.settings = *changed;
  if (!moved) return;
  if (const std::string wrong = state.view.set_angles(*changed); wrong.empty())
    publish_reach(trans, self);
  else
    CERBERUS_ELEMENT_WARNING(trans, RESOURCE, SETTINGS, ("%s The old angles stay.", wrong.c_str()),
                             (nullptr));
}

// Any stride will do.
gboolean propose_allocation(GstBaseTransform* trans, GstQuery* decide, GstQuery* query) {
  gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
  return cerberus_virtual_ptz_parent_class()->propose_allocation(trans, decide, query);
}

// What lies in pixels of the wide picture, or crops it, has no place in the window.
gboolean transform_meta(GstBaseTransform*, GstBuffer*, GstMeta* meta, GstBuffer*) {
  // Without tags:
  if (meta->info->api == GST_VIDEO_OVERLAY_COMPOSITION_META_API_TYPE ||
      meta->info->api == GST_VIDEO_CROP_META_API_TYPE)
    return FALSE;
  const gchar* const* tags = gst_meta_api_type_get_tags(meta->info->api);
  if (!tags) return meta->info->api != CERBERUS_POSE_META_API_TYPE;
  for (; *tags; ++tags)
    if (!g_str_equal(*tags, GST_META_TAG_VIDEO_STR)) return FALSE;
  return meta->info->api != CERBERUS_POSE_META_API_TYPE;
}

// ---- a frame

bool wants_lockstep(GstBaseTransform* trans, State& state) {
  if (state.settings.lockstep != LOCKSTEP_AUTO) return state.settings.lockstep == LOCKSTEP_ON;
  if (!state.live) state.live = is_live(GST_BASE_TRANSFORM_SINK_PAD(trans)).value_or(false);
  return !*state.live;
}

void attach_pose(const State& state, motion::Pose pose, const vision::WindowGeometry::Place& place,
                 GstBuffer* out) {
  pose.pan.position = place.pan;
  pose.tilt.position = place.tilt;
  if (pose.field_of_view > 0) pose.field_of_view = state.view.geometry().fov();
  CerberusPose meta = to_c(pose);
  if (!state.settings.head.empty()) meta.head = g_intern_string(state.settings.head.c_str());
  cerberus_buffer_set_pose(out, &meta);
}

// Attaches a base rate of 0, unless an element upstream has attached one: the wide camera stands. Without it, the small
// difference between the window's motion and a head's turn (see lib/vision/geometry/window.h) would appear as a turn of
// the base.
void attach_base(GstBuffer* in, GstBuffer* out) {
  CerberusBase base;
  cerberus_base_init(&base);
  base.source = CERBERUS_BASE_REPORTED;
  if (const CerberusBase* known = cerberus_buffer_peek_base(in)) base = *known;
  cerberus_buffer_set_base(out, &base);
}

// A step, play and noise are no reason to speak.
constexpr double kBeyond = 1;  // degrees

void warn_of_limits(GstBaseTransform* trans, Private& self, const motion::Pose& pose) {
  const double pan = degrees(pose.pan.position), tilt = degrees(pose.tilt.position);
  if (self.state.beyond ||
      !(std::abs(pan) > self.pan_reach + kBeyond || std::abs(tilt) > self.tilt_reach + kBeyond))
    return;
  self.state.beyond = true;
  const auto angle = [](double degrees) { return text::significant(degrees, 4).string(); };
  const std::string far = angle(self.pan_reach), high = angle(self.tilt_reach);
  CERBERUS_ELEMENT_WARNING(
      trans, RESOURCE, SETTINGS,
      ("The head looks at pan %s, tilt %s, and the window ends at pan -%s and %s, tilt -%s and %s: set the "
       "limits of pantiltsink (pan-min, pan-max, tilt-min, tilt-max) and of pirfusion (pan-min, pan-max) so.",
       angle(pan).c_str(), angle(tilt).c_str(), far.c_str(), far.c_str(), high.c_str(), high.c_str()),
      ("head \"%s\"", self.state.settings.head.c_str()));
}

GstFlowReturn make_frame(GstBaseTransform* trans, GstBuffer* in, GstBuffer* out) {
  Private& self = *cerberus_virtual_ptz_self(trans)->priv;
  State& state = self.state;
  apply_settings(trans, self);
  const GstClockTime running = running_time_of(trans->segment, in);
  const Time time =
      state.times.taken(GST_CLOCK_TIME_IS_VALID(running) ? std::optional(time_of(running)) : std::nullopt);
  if (wants_lockstep(trans, state))
    if (const GstFlowReturn flow =
            wait_for_head({GST_ELEMENT(trans), GST_BASE_TRANSFORM_SRC_PAD(trans), trans->segment, self.feed,
                           state.times, state.settings.head, state.settings.lockstep_timeout},
                          GST_BUFFER_PTS(in), time);
        flow != GST_FLOW_OK)
      return flow;
  state.times.add(time, running_length(GST_BUFFER_DURATION(in), state.view.picture(), trans->segment));
  const motion::Pose pose = self.feed.at(time);
  state.view.look_through(pose.field_of_view);
  const auto place = state.view.geometry().at(pose.pan.position, pose.tilt.position);
  GST_LOG_OBJECT(trans, "%" GST_TIME_FORMAT ": pan %.3f tilt %.3f, window at %.2f %.2f%s",
                 GST_TIME_ARGS(clock_time(time)), degrees(place.pan), degrees(place.tilt), place.left,
                 place.top, place.limited ? ", at the edge" : "");
  warn_of_limits(trans, self, pose);
  attach_pose(state, pose, place, out);
  attach_base(in, out);
  if (state.view.draw(in, place, state.settings.inset, out)) return GST_FLOW_OK;

  // The buffer has no valid picture: the output is black and marked by a flag.
  const bool reported = GST_BUFFER_FLAG_IS_SET(in, GST_BUFFER_FLAG_CORRUPTED) || state.warned;
  gst_buffer_memset(out, 0, 0, gst_buffer_get_size(out));
  GST_BUFFER_FLAG_SET(out, GST_BUFFER_FLAG_CORRUPTED);
  if (!reported) {
    state.warned = true;
    CERBERUS_ELEMENT_WARNING(trans, STREAM, DECODE,
                             ("A buffer does not hold the picture that its caps promise."),
                             ("%" G_GSIZE_FORMAT " bytes, not %" G_GSIZE_FORMAT, gst_buffer_get_size(in),
                              GST_VIDEO_INFO_SIZE(&state.view.picture())));
  }
  return GST_FLOW_OK;
}

GstFlowReturn transform(GstBaseTransform* trans, GstBuffer* in, GstBuffer* out) {
  return guarded(trans, GST_FLOW_ERROR, [&] { return make_frame(trans, in, out); });
}

// ---- events and states

gboolean src_event(GstBaseTransform* trans, GstEvent* event) {
  g_autoptr(CerberusPose) pose = cerberus_event_parse_pose(event);
  if (pose) {
    Private& self = *cerberus_virtual_ptz_self(trans)->priv;
    const std::string head = self.settings.snapshot().head;
    if (head.empty() || head == pose->head) self.feed.add(from_c(*pose));
  }
  return cerberus_virtual_ptz_parent_class()->src_event(trans, event);
}

gboolean sink_event(GstBaseTransform* trans, GstEvent* event) {
  Private& self = *cerberus_virtual_ptz_self(trans)->priv;
  if (GST_EVENT_TYPE(event) == GST_EVENT_FLUSH_START) self.feed.interrupt(true);
  if (GST_EVENT_TYPE(event) == GST_EVENT_FLUSH_STOP) {
    // Before the event goes on: poses that are published after it are of the new time.
    self.feed.forget();
    self.feed.interrupt(false);
    self.state.times.forget();
  }
  return cerberus_virtual_ptz_parent_class()->sink_event(trans, event);
}

GstStateChangeReturn change_state(GstElement* element, GstStateChange change) {
  Private& self = *cerberus_virtual_ptz_self(element)->priv;
  switch (change) {
    case GST_STATE_CHANGE_READY_TO_PAUSED: {
      const WindowSettings s = self.settings.snapshot();
      self.settings.refresh();
      self.state.live.reset();
      self.state.times.forget();
      self.state.complaint.forget();
      self.state.beyond = false;
      self.state.settings = s;
      motion::Pose start;
      start.pan.position = radians(s.start_pan);
      start.tilt.position = radians(s.start_tilt);
      self.feed.begin(start);
      self.feed.interrupt(false);
      break;
    }
    case GST_STATE_CHANGE_PAUSED_TO_PLAYING:
    case GST_STATE_CHANGE_PLAYING_TO_PAUSED:
      self.feed.play(change == GST_STATE_CHANGE_PAUSED_TO_PLAYING);
      break;
    case GST_STATE_CHANGE_PAUSED_TO_READY:
      self.feed.interrupt(true);
      break;
    default:
      break;
  }
  return GST_ELEMENT_CLASS(cerberus_virtual_ptz_parent_class())->change_state(element, change);
}

void set_property(GObject* object, guint id, const GValue* value, GParamSpec* spec) {
  cerberus_virtual_ptz_self(object)->priv->settings.set(window_properties(), id, value);
  const std::string_view name = spec->name;
  if (name == "width" || name == "height") gst_base_transform_reconfigure_src(GST_BASE_TRANSFORM(object));
}

// What can only be read: degrees, 0 before the first frame.
struct Reach {
  const char* name;
  double low, high;
  const char* blurb;
  std::atomic<double> Private::* value;
};
constexpr guint kFirstReach = 100;  // beyond the ids of window_properties()
constexpr Reach kReaches[] = {
    {"pan-min", -90, 0, "How far to the left the window reaches, degrees; 0 before the first frame",
     &Private::pan_reach},
    {"pan-max", 0, 90, "How far to the right the window reaches, degrees; 0 before the first frame",
     &Private::pan_reach},
    {"tilt-min", -90, 0, "How far down the window reaches, degrees; 0 before the first frame",
     &Private::tilt_reach},
    {"tilt-max", 0, 90, "How far up the window reaches, degrees; 0 before the first frame",
     &Private::tilt_reach},
    {"window-fov", 0, 180,
     "Angle that the window shows over its width, degrees: the horizontal-fov of those behind; 0 before "
     "the first frame",
     &Private::window_fov}};

void get_property(GObject* object, guint id, GValue* value, GParamSpec*) {
  Private& self = *cerberus_virtual_ptz_self(object)->priv;
  if (id < kFirstReach) return self.settings.get(window_properties(), id, value);
  const Reach& reach = kReaches[id - kFirstReach];
  const double degrees = self.*reach.value;
  g_value_set_double(value, reach.high > 0 ? degrees : -degrees);
}

void cerberus_virtual_ptz_init(CerberusVirtualPtz*) {}

void cerberus_virtual_ptz_class_init(CerberusVirtualPtzClass* klass) {
  GObjectClass* object = G_OBJECT_CLASS(klass);
  object->set_property = set_property;
  object->get_property = get_property;
  Adjustable<WindowSettings>::install(object, window_properties());
  for (guint i = 0; i < std::size(kReaches); ++i)
    g_object_class_install_property(
        object, kFirstReach + i,
        g_param_spec_double(kReaches[i].name, nullptr, kReaches[i].blurb, kReaches[i].low, kReaches[i].high,
                            0, GParamFlags(G_PARAM_READABLE | G_PARAM_STATIC_STRINGS)));

  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  element->change_state = change_state;
  gst_element_class_set_static_metadata(element, "Virtual pan-tilt camera", "Filter/Effect/Video",
                                        "Shows the part of a wide picture at which a pan-tilt head looks",
                                        "The Cerberus developers");
  gst_element_class_add_static_pad_template(element, &sink_template);
  gst_element_class_add_static_pad_template(element, &src_template);

  GstBaseTransformClass* trans = GST_BASE_TRANSFORM_CLASS(klass);
  trans->transform_caps = transform_caps;
  trans->fixate_caps = fixate_caps;
  trans->get_unit_size = get_unit_size;
  trans->transform_size = transform_size;
  trans->set_caps = set_caps;
  trans->propose_allocation = propose_allocation;
  trans->transform_meta = transform_meta;
  trans->transform = transform;
  trans->src_event = src_event;
  trans->sink_event = sink_event;
}

}  // namespace
}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(virtualptz, GST_RANK_NONE, cerberus::plugin::cerberus_virtual_ptz, virtualptz_debug,
                          "a window over a wide picture")
