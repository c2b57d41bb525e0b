// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-motionoverlay
 * @title: motionoverlay
 * @short_description: draws what moves
 * @see_also: motiondetect, motionjson, motionview
 *
 * Draws a box around everything that moves, with its identity and speed, and the way it came. The line shows
 * how its position is known: solid = seen in this frame, dashed = carried on by its velocity, dotted and two
 * bars in the label = it stands and is held. Colours belong to identities and can be distinguished with any colour
 * vision. Trails lie on the scene: while the camera turns they turn with the picture.
 *
 * Pads: raw video in and out, in every format that the stages read. Where downstream takes GstVideoOverlayComposition
 * (caps feature or allocation query, as most sinks that draw with a graphics card do) the pictures are attached and
 * the frame is not touched; otherwise they are blended into a writable copy of what they cover. A frame in
 * which nothing moves passes as it is. Other branches of a tee never see the drawing.
 *
 * Where a head and sensors are part of the system, a corner shows their state (`show-system`): pan and tilt, a light a PIR sensor
 * (red: detects, blue: does not, grey: no valid reading) in the order of their bearings from left to right, with its
 * number, counted as in `bearings` of `pirsrc`, the rule that fired (its number if it has one, and its name) and the
 * action. The track that the head follows (`pirfusion`) is marked by thick corners round the box. Compositions that
 * other elements attached to the frame (`inset` of `virtualptz` and `patrolsimsrc`) lie on top.
 *
 * With `horizontal-fov` a radar is in the lower left corner, 12 m around the robot, which looks up: in yellow what the camera
 * sees, the sensors' sectors (red: detects, pale red: detects, and is not counted because the robot's own motion may be the
 * cause; halfway to the neighbours, at most 60 degrees to both sides) and the objects in the colours of their identities, the
 * target with a white rim. Of an object without a known distance the feet's height in the picture stands for it.
 *
 * Reads the region, camera-motion, pose and fusion metas. Posts no messages. Regions without a tracker are drawn
 * in white, without identity and trail. What reaches beyond the frame is cut at its edge.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 filesrc location=vtest.avi ! decodebin ! motiondetect ! motionoverlay ! \
 *     videoconvert ! autovideosink
 * gst-launch-1.0 v4l2src ! videoconvert ! motiondetect ! motionoverlay trail-time=5000000000 crosshair=true ! \
 *     videoconvert ! autovideosink
 * gst-launch-1.0 filesrc location=vtest.avi ! decodebin ! motiondetect ! motionoverlay show-trails=false ! \
 *     videoconvertscale ! video/x-raw,format=I420,width=[2,8192,2],height=[2,8192,2] ! x264enc ! mp4mux ! \
 *     filesink location=annotated.mp4
 * ]|
 *
 * Since: 0.1
 */

#include <cerberus/cerberus.h>
#include <gst/base/gstbasetransform.h>
#include <gst/video/gstvideometa.h>
#include <gst/video/video-overlay-composition.h>
#include <gst/video/video.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <vector>

#include "cerberus/private/element.hpp"
#include "cerberus/private/text.hpp"
#include "composition.hpp"
#include "overlay/marks/radar.h"
#include "overlay/painter.h"
#include "overlay/trails.h"
#include "sensing/angles.h"
#include "shared/camera_mount.hpp"
#include "shared/camera_path.hpp"
#include "shared/clock_times.hpp"
#include "shared/complaint.hpp"
#include "shared/properties.hpp"
#include "shared/video.hpp"

namespace {

using cerberus::plugin::Adjustable;
using cerberus::plugin::Property;
using cerberus::plugin::property;
using cerberus::plugin::running_time_of;
namespace overlay = cerberus::overlay;

GST_DEBUG_CATEGORY_STATIC(motionoverlay_debug);
#define GST_CAT_DEFAULT motionoverlay_debug

#define OVERLAY_CAPS                                                                              \
  CERBERUS_VIDEO_CAPS                                                                             \
  ";" GST_VIDEO_CAPS_MAKE_WITH_FEATURES(GST_CAPS_FEATURE_MEMORY_SYSTEM_MEMORY                     \
                                        ", " GST_CAPS_FEATURE_META_GST_VIDEO_OVERLAY_COMPOSITION, \
                                        CERBERUS_VIDEO_FORMATS)

GstStaticPadTemplate sink_template =
    GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(OVERLAY_CAPS));
GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(OVERLAY_CAPS));

struct Settings {
  bool boxes = true, ids = true, speeds = true, trails = true, crosshair = false, system = true;
  guint64 trail_time = 2 * GST_SECOND;
  double line_width = 0;
  double horizontal_fov = 0;
};

constexpr double kWidestLine = 64;

const Property<Settings> kProperties[] = {
    property("show-boxes", &Settings::boxes, "Draw a box around every object"),
    property("show-ids", &Settings::ids, "Draw a label with the identity on every object"),
    property(
        "show-speeds", &Settings::speeds,
        "Add the speed in pixels a second (and the distance, where known) to the label where there is room"),
    property("show-trails", &Settings::trails,
             "Draw the way that every object came, fixed to the scene while the camera moves"),
    property("trail-time", &Settings::trail_time,
             "How far back trails reach, in nanoseconds: 0 leaves none; a trail has 1024 points at most, one "
             "a frame"),
    property("line-width", &Settings::line_width, 0, kWidestLine,
             "Width of the lines in pixels of the frame: 0 chooses one that reads well at the frame's size"),
    property("crosshair", &Settings::crosshair, "Mark the centre of the picture"),
    property("show-system", &Settings::system,
             "Show, where they are known, the head's pan and tilt, the PIR sensors as red and blue lights, "
             "and the rule and "
             "the action of the fusion"),
    property("horizontal-fov", &Settings::horizontal_fov, 0, 179,
             "Angle that the camera sees over the picture's width, degrees: a radar in the lower left corner "
             "shows it, the sensors' sectors and the objects; 0 = no radar"),
};

struct State {  // streaming thread only
  GstVideoInfo info;
  bool attach = false;                         // downstream takes compositions
  double time = 0;                             // s, of the last frame
  GstClockTime running = GST_CLOCK_TIME_NONE;  // likewise
  bool fresh = true;                           // the next frame has no predecessor
  bool warned = false;                         // a frame that cannot be written
  cerberus::plugin::Complaint complaint;       // about the caps
  cerberus::vision::CameraFollower camera;
  overlay::Trails trails;
  overlay::Painter painter;
  cerberus::plugin::Composer composer;
  std::vector<overlay::Object> objects;
  std::vector<overlay::Area> covered;
  std::vector<overlay::TrailMark> marks;
  std::vector<overlay::Patch> patches;
};

struct Private {
  Adjustable<Settings> settings;
  std::atomic<bool> undecided = true;  // whether to attach: downstream is to be asked before the next frame
  State state;
};

CERBERUS_DEFINE_TYPE(CerberusMotionOverlay, cerberus_motion_overlay, GstBaseTransform,
                     GST_TYPE_BASE_TRANSFORM, Private)

using cerberus::plugin::CompositionPtr;
using CapsPtr = std::unique_ptr<GstCaps, decltype(&gst_caps_unref)>;

bool has_composition_feature(const GstCaps* caps, guint index = 0) {
  return gst_caps_features_contains(gst_caps_get_features(caps, index),
                                    GST_CAPS_FEATURE_META_GST_VIDEO_OVERLAY_COMPOSITION);
}

// Caps of every structure twice: with the feature and without it.
GstCaps* both_ways(const GstCaps* caps) {
  GstCaps* with = gst_caps_new_empty();
  GstCaps* without = gst_caps_new_empty();
  for (guint i = 0; i < gst_caps_get_size(caps); ++i) {
    const GstStructure* structure = gst_caps_get_structure(caps, i);
    GstCapsFeatures* features = gst_caps_features_copy(gst_caps_get_features(caps, i));
    gst_caps_features_remove(features, GST_CAPS_FEATURE_META_GST_VIDEO_OVERLAY_COMPOSITION);
    gst_caps_append_structure_full(without, gst_structure_copy(structure), gst_caps_features_copy(features));
    gst_caps_features_add(features, GST_CAPS_FEATURE_META_GST_VIDEO_OVERLAY_COMPOSITION);
    gst_caps_append_structure_full(with, gst_structure_copy(structure), features);
  }
  return gst_caps_merge(with, without);
}

// Returns whether an element downstream draws compositions, by its answer to the allocation query. Caps do not suffice:
// many elements accept any caps without drawing compositions (a file sink would lose the drawing).
bool downstream_draws(GstBaseTransform* transform, GstCaps* caps) {
  GstQuery* query = gst_query_new_allocation(caps, FALSE);
  const bool draws =
      gst_pad_peer_query(transform->srcpad, query) &&
      gst_query_find_allocation_meta(query, GST_VIDEO_OVERLAY_COMPOSITION_META_API_TYPE, nullptr);
  gst_query_unref(query);
  return draws;
}

// Draws the patches into the frame, then what upstream attached (if anything): an inset, say, is a picture of its own,
// and boxes that belong to what it hides would seem to be the inset's.
bool draw_into(State& state, GstBuffer* buffer, GstVideoOverlayComposition* before) {
  // Mapping for writing copies memory that others (a tee's other branch) hold too.
  cerberus::VideoFrame frame(state.info, buffer, GST_MAP_READWRITE);
  if (!frame) return false;
  cerberus::plugin::blend(state.patches, frame.get());
  return !before || gst_video_overlay_composition_blend(before, frame.get());
}

void read_covered(State& state, const GstVideoOverlayCompositionMeta* meta) {
  state.covered.clear();
  for (guint i = 0; meta && i < gst_video_overlay_composition_n_rectangles(meta->overlay); ++i) {
    gint x = 0, y = 0;
    guint width = 0, height = 0;
    auto* rectangle = gst_video_overlay_composition_get_rectangle(meta->overlay, i);
    if (gst_video_overlay_rectangle_get_render_rectangle(rectangle, &x, &y, &width, &height))
      state.covered.push_back({x, y, static_cast<int>(width), static_cast<int>(height)});
  }
}

void forget(State& state) {
  state.trails.reset();
  state.painter.reset();
  state.composer.reset();
  state.fresh = true;
}

gboolean cerberus_motion_overlay_start(GstBaseTransform* transform) {
  State& state = cerberus_motion_overlay_self(transform)->priv->state;
  forget(state);
  state.attach = state.warned = false;
  state.complaint.forget();
  return TRUE;
}

gboolean cerberus_motion_overlay_stop(GstBaseTransform* transform) {
  forget(cerberus_motion_overlay_self(transform)->priv->state);
  return TRUE;
}

GstCaps* cerberus_motion_overlay_transform_caps(GstBaseTransform*, GstPadDirection, GstCaps* caps,
                                                GstCaps* filter) {
  GstCaps* result = both_ways(caps);
  if (!filter) return result;
  GstCaps* common = gst_caps_intersect_full(filter, result, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(result);
  return common;
}

// Only called where downstream leaves a choice.
GstCaps* cerberus_motion_overlay_fixate_caps(GstBaseTransform* transform, GstPadDirection direction,
                                             GstCaps* caps, GstCaps* others) {
  const auto first = [&](bool feature) -> CapsPtr {
    for (guint i = 0; i < gst_caps_get_size(others); ++i)
      if (has_composition_feature(others, i) == feature)
        return CapsPtr(gst_caps_fixate(gst_caps_copy_nth(others, i)), gst_caps_unref);
    return CapsPtr(nullptr, gst_caps_unref);
  };
  CapsPtr with = first(true), without = first(false);
  const bool attach =
      with && (!without || (direction == GST_PAD_SINK && downstream_draws(transform, with.get())));
  CapsPtr& chosen = attach ? with : without;
  GstCaps* result = chosen ? chosen.release() : gst_caps_copy(others);
  gst_caps_unref(others);
  GST_DEBUG_OBJECT(transform, "%" GST_PTR_FORMAT " for %" GST_PTR_FORMAT, result, caps);
  return result;
}

gboolean cerberus_motion_overlay_set_caps(GstBaseTransform* transform, GstCaps* in, GstCaps*) {
  State& state = cerberus_motion_overlay_self(transform)->priv->state;
  return cerberus::guarded(transform, FALSE, [&]() -> gboolean {
    const bool known = gst_video_info_from_caps(&state.info, in);
    const std::string wrong = known ? "" : cerberus::kCapsIncomplete;
    if (state.complaint.is_new(wrong))
      CERBERUS_ELEMENT_ERROR(transform, CORE, NEGOTIATION, (wrong), ("caps %" GST_PTR_FORMAT, in));
    if (!known) return FALSE;
    forget(state);
    cerberus_motion_overlay_self(transform)->priv->undecided = true;
    return TRUE;
  });
}

// Before the first frame, and whenever downstream changes (another sink was linked, a window was opened): the caps may
// stay the same while the drawing element changes. The base class sends no allocation query where it works in place, so
// its decide_allocation would not be called.
void decide(GstBaseTransform* transform, State& state) {
  GstCaps* caps = gst_pad_get_current_caps(transform->srcpad);
  if (!caps) return;
  state.attach = has_composition_feature(caps) || downstream_draws(transform, caps);
  GST_INFO_OBJECT(transform, "drawing is %s", state.attach ? "attached" : "blended");
  gst_caps_unref(caps);
}

gboolean cerberus_motion_overlay_src_event(GstBaseTransform* transform, GstEvent* event) {
  if (GST_EVENT_TYPE(event) == GST_EVENT_RECONFIGURE)
    cerberus_motion_overlay_self(transform)->priv->undecided = true;
  return cerberus_motion_overlay_parent_class()->src_event(transform, event);
}

gboolean cerberus_motion_overlay_sink_event(GstBaseTransform* transform, GstEvent* event) {
  switch (GST_EVENT_TYPE(event)) {
    case GST_EVENT_FLUSH_STOP:
      cerberus_motion_overlay_self(transform)->priv->undecided = true;  // queries fail while flushing
      [[fallthrough]];
    case GST_EVENT_SEGMENT:
    case GST_EVENT_STREAM_START:
      forget(cerberus_motion_overlay_self(transform)->priv->state);
      break;
    default:
      break;
  }
  return cerberus_motion_overlay_parent_class()->sink_event(transform, event);
}

// What the metas say, in the terms of the drawing.
void read_objects(State& state, GstBuffer* buffer) {
  state.objects.clear();
  state.marks.clear();
  const CerberusFusion* fusion = cerberus_buffer_peek_fusion(buffer);
  const bool follows = fusion && fusion->action == CERBERUS_FUSION_TRACK;
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(buffer);
  for (guint i = 0; i < regions->len; ++i) {
    const auto& region = *static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i));
    overlay::Object object;
    object.id = region.tracked ? region.id : 0;
    object.target = follows && object.id && object.id == fusion->target;
    object.x = region.x, object.y = region.y;
    object.width = region.width, object.height = region.height;
    object.speed = region.tracked ? std::hypot(region.vx, region.vy) : NAN;
    object.distance = region.distance;
    object.bearing = cerberus::sensing::radians(region.bearing);
    object.state = region.state == CERBERUS_REGION_STOPPED   ? overlay::ObjectState::stopped
                   : region.state == CERBERUS_REGION_COASTED ? overlay::ObjectState::coasted
                                                             : overlay::ObjectState::seen;
    state.objects.push_back(object);
    // People and cars stand on the ground: the trail is where their feet were, as long as those are in the picture.
    const bool cut = region.x < 1 || region.x + region.width > GST_VIDEO_INFO_WIDTH(&state.info) - 1 ||
                     region.y + region.height > GST_VIDEO_INFO_HEIGHT(&state.info) - 1;
    if (object.id && !cut)
      state.marks.push_back({object.id, {region.x + region.width / 2, region.y + region.height}});
  }
}

void update_trails(State& state, GstBuffer* buffer, GstClockTime running, const Settings& settings) {
  using Link = cerberus::vision::CameraFollower::Link;
  const cerberus::vision::Size frame{GST_VIDEO_INFO_WIDTH(&state.info), GST_VIDEO_INFO_HEIGHT(&state.info)};
  const auto camera =
      state.camera.next(cerberus::plugin::path_point(buffer), std::exchange(state.running, running), frame);
  if (camera.link == Link::cut || camera.link == Link::lost) state.fresh = true;
  if (GST_BUFFER_IS_DISCONT(buffer) && !camera.connected) state.fresh = true;
  const double nominal = GST_VIDEO_INFO_FPS_N(&state.info) > 0
                             ? double(GST_VIDEO_INFO_FPS_D(&state.info)) / GST_VIDEO_INFO_FPS_N(&state.info)
                             : 1 / 30.0;
  const double time =
      GST_BUFFER_PTS_IS_VALID(buffer) ? double(GST_BUFFER_PTS(buffer)) / GST_SECOND : state.time + nominal;
  if (state.fresh || time < state.time) state.trails.reset();
  state.fresh = false;
  state.time = time;
  if (settings.trails)
    state.trails.update(time, double(settings.trail_time) / GST_SECOND, camera.motion.transform, frame,
                        state.marks);
  else
    state.trails.reset();
}

// "rule 2", "sector", "rule 7 zero"; of a long name what there is room for.
std::string rule_text(const CerberusFusion& fusion) {
  constexpr glong kMost = 24;
  const std::string number = fusion.rule > 0 ? "rule " + std::to_string(fusion.rule) : std::string();
  std::string name = cerberus::printable(fusion.rule_name ? fusion.rule_name : "");
  if (name == number || name == "none") return number;
  if (g_utf8_strlen(name.c_str(), -1) > kMost) {
    name.resize(static_cast<std::size_t>(g_utf8_offset_to_pointer(name.c_str(), kMost) - name.c_str()));
    name += "...";
  }
  return number.empty() || name.empty() ? number + name : number + " " + name;
}

// Orders the sensors by bearing, from behind on the left to behind on the right.
std::vector<overlay::Light> lights_of(const CerberusFusion& fusion) {
  std::vector<overlay::Light> lights;
  for (guint i = 0; i < fusion.n_sensors; ++i) lights.push_back({static_cast<int>(i) + 1, fusion.sensors[i]});
  std::ranges::stable_sort(lights, {}, [&](const overlay::Light& light) {
    return cerberus::sensing::wrap(cerberus::sensing::radians(fusion.bearings[light.sensor - 1]));
  });
  return lights;
}

overlay::System read_system(GstBuffer* buffer, GstClockTime time) {
  overlay::System system;
  if (const auto look = cerberus::plugin::look_of(buffer, time)) {
    system.pose = true;
    system.pan = cerberus::sensing::degrees(look->pan);
    system.tilt = cerberus::sensing::degrees(look->tilt);
  }
  if (const CerberusFusion* fusion = cerberus_buffer_peek_fusion(buffer)) {
    system.decision = true;
    system.rule = rule_text(*fusion);
    system.action = cerberus_fusion_action_get_nick(fusion->action);
    system.lights = lights_of(*fusion);
  }
  return system;
}

overlay::Radar read_radar(const State& state, GstBuffer* buffer, GstClockTime time, double fov) {
  using cerberus::sensing::radians;
  overlay::Radar radar;
  radar.field_of_view = radians(fov);
  if (const auto look = cerberus::plugin::look_of(buffer, time)) radar.pan = look->pan;
  if (!std::isfinite(radar.pan)) radar.pan = 0;
  if (const CerberusFusion* fusion = cerberus_buffer_peek_fusion(buffer)) {
    for (guint i = 0; i < fusion->n_sensors; ++i)
      if (std::isfinite(fusion->bearings[i]))
        radar.sensors.push_back({cerberus::sensing::wrap(radians(fusion->bearings[i])), 0, 0,
                                 fusion->sensors[i], (fusion->doubtful >> i & 1) != 0});
    overlay::divide_round(radar.sensors);
  }
  const cerberus::vision::Lens lens(radar.field_of_view,
                                    {GST_VIDEO_INFO_WIDTH(&state.info), GST_VIDEO_INFO_HEIGHT(&state.info)});
  for (const overlay::Object& object : state.objects)
    radar.objects.push_back(overlay::radar_object(object, radar.pan, lens));
  return radar;
}

GstFlowReturn cerberus_motion_overlay_transform_ip(GstBaseTransform* transform, GstBuffer* buffer) {
  return cerberus::guarded(transform, GST_FLOW_ERROR, [&]() -> GstFlowReturn {
    Private& self = *cerberus_motion_overlay_self(transform)->priv;
    State& state = self.state;
    const Settings settings = self.settings.snapshot();
    if (self.undecided.exchange(false)) decide(transform, state);
    read_objects(state, buffer);
    const GstClockTime running = running_time_of(transform->segment, buffer);
    update_trails(state, buffer, running, settings);
    GstVideoOverlayCompositionMeta* meta = gst_buffer_get_video_overlay_composition_meta(buffer);
    read_covered(state, meta);

    overlay::Scene scene;
    scene.frame = {GST_VIDEO_INFO_WIDTH(&state.info), GST_VIDEO_INFO_HEIGHT(&state.info)};
    scene.objects = state.objects;
    scene.trails = state.trails.trails();
    scene.covered = state.covered;
    scene.time = state.time;
    scene.trail_time = double(settings.trail_time) / GST_SECOND;
    scene.line_width = settings.line_width;
    scene.boxes = settings.boxes;
    scene.ids = settings.ids;
    scene.speeds = settings.speeds;
    scene.crosshair = settings.crosshair;
    if (settings.system) scene.system = read_system(buffer, running);
    if (settings.horizontal_fov > 0)
      scene.radar = read_radar(state, buffer, running, settings.horizontal_fov);
    state.patches.clear();
    state.painter.paint(scene, state.patches);

    if (state.patches.empty() && (!meta || state.attach)) return GST_FLOW_OK;
    const CompositionPtr before(meta ? gst_video_overlay_composition_ref(meta->overlay) : nullptr);
    if (meta) gst_buffer_remove_video_overlay_composition_meta(buffer, meta);
    if (state.attach) {
      gst_buffer_add_video_overlay_composition_meta(
          buffer, state.composer.compose(state.patches, before.get()).get());
    } else if (!draw_into(state, buffer, before.get()) && !state.warned) {
      state.warned = true;
      CERBERUS_ELEMENT_WARNING(transform, STREAM, FAILED, ("A frame could not be drawn on."),
                               ("%" GST_PTR_FORMAT " is too small for %dx%d, or cannot be written", buffer,
                                scene.frame.width, scene.frame.height));
    }
    state.patches.clear();
    return GST_FLOW_OK;
  });
}

void cerberus_motion_overlay_init(CerberusMotionOverlay* self) {
  gst_video_info_init(&self->priv->state.info);
  gst_base_transform_set_in_place(GST_BASE_TRANSFORM(self), TRUE);
  gst_base_transform_set_passthrough(GST_BASE_TRANSFORM(self), FALSE);
}

void cerberus_motion_overlay_class_init(CerberusMotionOverlayClass* klass) {
  cerberus::plugin::install_properties<CerberusMotionOverlay, kProperties>(G_OBJECT_CLASS(klass));

  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  gst_element_class_set_static_metadata(element, "Motion overlay", "Filter/Effect/Video",
                                        "Draws boxes, identities, speeds and trails of what moves",
                                        "The Cerberus developers");
  gst_element_class_add_static_pad_template(element, &sink_template);
  gst_element_class_add_static_pad_template(element, &src_template);

  GstBaseTransformClass* transform = GST_BASE_TRANSFORM_CLASS(klass);
  transform->start = cerberus_motion_overlay_start;
  transform->stop = cerberus_motion_overlay_stop;
  transform->transform_caps = cerberus_motion_overlay_transform_caps;
  transform->fixate_caps = cerberus_motion_overlay_fixate_caps;
  transform->set_caps = cerberus_motion_overlay_set_caps;
  transform->src_event = cerberus_motion_overlay_src_event;
  transform->sink_event = cerberus_motion_overlay_sink_event;
  transform->transform_ip = cerberus_motion_overlay_transform_ip;
}

}  // namespace

CERBERUS_REGISTER_ELEMENT(motionoverlay, GST_RANK_NONE, cerberus_motion_overlay, motionoverlay_debug,
                          "drawing of what moves")
