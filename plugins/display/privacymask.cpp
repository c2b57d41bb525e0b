// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-privacymask
 * @title: privacymask
 * @short_description: hides places of the world, and parts of the picture
 * @see_also: motionoverlay, pantiltsink, virtualptz
 *
 * Covers what must not be recorded or shown: put it before every encoder. `masks` holds polygons, parted by `;`:
 *
 * - `0,0 0.3,0 0.3,0.2 0,0.2` in fractions of the picture, x to the right and y downwards: a part of the picture, wherever
 *   the camera looks;
 * - `world -12,4 -5,4 -5,-6 -12,-6` in degrees of pan (to the right) and tilt (up): a place, which moves through the picture
 *   as the camera turns. It needs `horizontal-fov` (or a head that reports its zoom) and the pose of the head on each
 *   frame, as `virtualptz` and `cameramotion` attach it.
 *
 * A block of 8x8 pixels is covered as soon as one of its pixels may lie within a polygon. Polygons of the world are widened
 * by `margin`, by what the head turns within 20 ms, by 1.5 degrees where the pose is reckoned from commands and not
 * measured, and by 360 degrees for each second beyond the time for which the pose holds. Where there is no pose, or
 * no field of view, or the head has a zoom of which nothing is known (whatever `horizontal-fov` says), or pixels are not square, the whole picture is covered, and a warning says why. A frame that cannot be
 * written is dropped. What else shows the scene is taken off the frame: drawings that are attached and not blended (such as
 * the inset of `virtualptz` and boxes of `motionoverlay`, which therefore stands behind), and the detector's own pictures.
 *
 * Pads: one sink, one src, raw video in system memory, in every format that the stages read; works in place.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 ! privacymask masks="0,0 0.3,0 0.3,0.2 0,0.2" mode=pixelate ! \
 *     videoconvert ! fakesink
 * gst-launch-1.0 videotestsrc num-buffers=60 ! virtualptz lockstep=off wide-fov=60 horizontal-fov=30 ! \
 *     privacymask masks="world -4,3 4,3 4,-3 -4,-3" horizontal-fov=30 ! fakesink
 * ]|
 *
 * Since: 0.1
 */
#include <cerberus/cerberus.h>
#include <gst/base/gstbasetransform.h>
#include <gst/video/video-overlay-composition.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "cerberus/private/element.hpp"
#include "composition.hpp"
#include "overlay/privacy/privacy_zones.h"
#include "shared/camera_mount.hpp"
#include "shared/clock_times.hpp"
#include "shared/complaint.hpp"
#include "shared/properties.hpp"
#include "shared/record.hpp"
#include "shared/video.hpp"

namespace {

using cerberus::plugin::property;
using cerberus::sensing::radians;
namespace overlay = cerberus::overlay;

GST_DEBUG_CATEGORY_STATIC(privacymask_debug);
#define GST_CAT_DEFAULT privacymask_debug

GstStaticPadTemplate sink_template =
    GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(CERBERUS_VIDEO_CAPS));
GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(CERBERUS_VIDEO_CAPS));

// Seconds by which a frame's time may be wrong. Derived: half a frame at 25 a second.
constexpr double kTiming = 0.02;
// Degrees by which a pose that is not measured may be wrong. Derived: to so much the picture corrects a velocity head
// without feedback (unit test head_contract).
constexpr double kReckoned = 1.5;
// Degrees a second that a head may turn where nothing is known of it. Chosen: faster than heads that carry cameras.
constexpr double kFastest = 360;
// Squares over the picture's height. Chosen: a face at 2 metres in 720p is one or two of them.
constexpr int kSquares = 18;
constexpr double kMostMargin = 90;
constexpr overlay::Color kCover{0.1, 0.1, 0.1};

enum { MODE_FILL, MODE_PIXELATE };

struct Settings {
  std::string masks;
  int mode = MODE_FILL;
  double field_of_view = 0, margin = 0.5;
};

GType mode_type() {
  static const GEnumValue kValues[] = {{MODE_FILL, "Cover it with one dark colour", "fill"},
                                       {MODE_PIXELATE, "Show large squares of its mean colours", "pixelate"},
                                       {0, nullptr, nullptr}};
  static const GType type = g_enum_register_static("CerberusPrivacyMaskMode", kValues);
  return type;
}

const cerberus::plugin::Property<Settings> kProperties[] = {
    property(
        "masks", &Settings::masks,
        "What is covered: polygons of corners x,y in fractions of the picture, or, after the word world, "
        "pan,tilt in degrees, parted by ;"),
    property("mode", &Settings::mode, mode_type, "How it is covered"),
    property(
        "horizontal-fov", &Settings::field_of_view, 0, cerberus::plugin::kMaximumFieldOfView,
        "Angle in degrees that the lens sees over the frame's whole width, for polygons of the world; 0 = "
        "unknown"),
    property("margin", &Settings::margin, 0, kMostMargin,
             "Degrees by which polygons of the world are widened, for what is not exact about lens, mounting "
             "and pose"),
};

struct State {  // streaming thread only
  GstVideoInfo info;
  overlay::PrivacyZones zones;
  overlay::BlockMask mask;
  std::string masks;                               // as last read
  cerberus::plugin::Complaint caps, blind, frame;  // what is wrong with them
};

struct Private {
  cerberus::plugin::Adjustable<Settings> settings;
  State state;
};

CERBERUS_DEFINE_TYPE(CerberusPrivacyMask, cerberus_privacy_mask, GstBaseTransform, GST_TYPE_BASE_TRANSFORM,
                     Private)

// Reads changed masks. What cannot be read hides nothing, so it is an error.
bool read_masks(GstBaseTransform* transform, State& state, const std::string& masks) {
  if (masks == state.masks) return true;
  const std::string wrong = state.zones.parse(masks);
  if (wrong.empty())
    state.masks = masks;
  else
    CERBERUS_ELEMENT_ERROR(transform, RESOURCE, SETTINGS, (wrong), ("the property masks cannot be used"));
  return wrong.empty();
}

gboolean cerberus_privacy_mask_start(GstBaseTransform* transform) {
  return cerberus::guarded(transform, FALSE, [&]() -> gboolean {
    Private& priv = *cerberus_privacy_mask_self(transform)->priv;
    for (auto* complaint : {&priv.state.caps, &priv.state.blind, &priv.state.frame}) complaint->forget();
    return read_masks(transform, priv.state, priv.settings.snapshot().masks);
  });
}

gboolean cerberus_privacy_mask_set_caps(GstBaseTransform* transform, GstCaps* in, GstCaps*) {
  State& state = cerberus_privacy_mask_self(transform)->priv->state;
  return cerberus::guarded(transform, FALSE, [&]() -> gboolean {
    const bool known = gst_video_info_from_caps(&state.info, in);
    const std::string wrong = known ? "" : cerberus::kCapsIncomplete;
    if (state.caps.is_new(wrong))
      CERBERUS_ELEMENT_ERROR(transform, CORE, NEGOTIATION, (wrong), ("caps %" GST_PTR_FORMAT, in));
    return known;
  });
}

// Seconds from one time to another; 0 where one of them is not known.
double signed_seconds(GstClockTime from, GstClockTime to) {
  if (!GST_CLOCK_TIME_IS_VALID(from) || !GST_CLOCK_TIME_IS_VALID(to)) return 0;
  return double(GST_CLOCK_DIFF(from, to)) / GST_SECOND;
}

// Seconds by which the frame's time lies outside the span for which the pose holds.
double overtime(const CerberusPose& pose, GstClockTime time) {
  return std::max({0.0, signed_seconds(pose.valid_until, time), signed_seconds(time, pose.valid_from)});
}

overlay::PrivacyZones::View view_of(GstBuffer* buffer, GstClockTime time, const Settings& settings) {
  overlay::PrivacyZones::View view;
  view.field_of_view = radians(settings.field_of_view);
  const CerberusPose* pose = cerberus_buffer_peek_pose(buffer);
  if (!pose || (pose->moving && !GST_CLOCK_TIME_IS_VALID(time))) return view;
  if (const double reported = cerberus::plugin::field_of_view_of(*pose); reported != 0)
    view.field_of_view = reported;  // NaN: a zoom of which nothing is known, whatever horizontal-fov says
  const auto look = cerberus::plugin::look_of(*pose, time);
  if (!look) return view;
  view.posed = true;
  view.pan = look->pan, view.tilt = look->tilt;
  const double since = std::max(0.0, signed_seconds(pose->valid_from, time));
  const double speed = std::hypot(std::abs(pose->pan_speed) + std::abs(pose->pan_acceleration) * since,
                                  std::abs(pose->tilt_speed) + std::abs(pose->tilt_acceleration) * since);
  view.margin =
      radians(settings.margin + kTiming * speed + (pose->source == CERBERUS_POSE_MEASURED ? 0 : kReckoned) +
              kFastest * overtime(*pose, time));
  return view;
}

std::string why_blind(const State& state, const overlay::PrivacyZones::View& view) {
  if (!state.zones.need_pose()) return {};
  if (GST_VIDEO_INFO_PAR_N(&state.info) != GST_VIDEO_INFO_PAR_D(&state.info))
    return "The whole picture is covered: masks of the world need square pixels. Put videoscale and "
           "pixel-aspect-ratio=1/1 in front.";
  if (view.posed && view.field_of_view > 0) return {};
  if (!(view.field_of_view > 0))
    return "The whole picture is covered: masks of the world need the lens's field of view. Set "
           "horizontal-fov and, for a head with a zoom, zoom-table or lock-zoom of pantiltsink.";
  return "The whole picture is covered: masks of the world need the head's pose on each frame. Put "
         "privacymask "
         "behind cameramotion, motiondetect or virtualptz, with a pantiltsink in the pipeline.";
}

// What rides on the buffer and shows the scene without a mask.
void remove_other_pictures(GstBuffer* buffer) {
  while (GstMeta* meta = gst_buffer_get_meta(buffer, GST_VIDEO_OVERLAY_COMPOSITION_META_API_TYPE))
    if (!gst_buffer_remove_meta(buffer, meta)) break;
  cerberus::plugin::set_record(buffer, {});
}

GstFlowReturn cerberus_privacy_mask_transform_ip(GstBaseTransform* transform, GstBuffer* buffer) {
  return cerberus::guarded(transform, GST_FLOW_ERROR, [&]() -> GstFlowReturn {
    Private& priv = *cerberus_privacy_mask_self(transform)->priv;
    State& state = priv.state;
    const Settings settings = priv.settings.snapshot();
    if (!read_masks(transform, state, settings.masks)) return GST_FLOW_ERROR;
    if (state.zones.empty()) return GST_FLOW_OK;
    remove_other_pictures(buffer);
    auto view = view_of(buffer, cerberus::plugin::running_time_of(transform->segment, buffer), settings);
    const std::string why = why_blind(state, view);
    if (!why.empty()) view.posed = false;
    if (state.blind.is_new(why)) CERBERUS_ELEMENT_WARNING(transform, STREAM, FAILED, (why), (nullptr));
    state.zones.cover({GST_VIDEO_INFO_WIDTH(&state.info), GST_VIDEO_INFO_HEIGHT(&state.info)}, view,
                      state.mask);
    if (!state.mask.any()) return GST_FLOW_OK;
    // Mapping for writing copies memory that others (a tee's other branch) hold too.
    cerberus::VideoFrame frame(state.info, buffer, GST_MAP_READWRITE);
    const std::string wrong = frame ? "" : "A frame cannot be covered and is left out.";
    if (state.frame.is_new(wrong))
      CERBERUS_ELEMENT_WARNING(transform, STREAM, FAILED, (wrong), ("%" GST_PTR_FORMAT, buffer));
    if (!frame) return GST_BASE_TRANSFORM_FLOW_DROPPED;
    const cerberus::plugin::FrameComponents components(frame.get());
    if (settings.mode == MODE_PIXELATE)
      overlay::pixelate(state.mask, kSquares, components.all());
    else
      overlay::fill(state.mask, kCover, components.all());
    return GST_FLOW_OK;
  });
}

void cerberus_privacy_mask_init(CerberusPrivacyMask* self) {
  gst_video_info_init(&self->priv->state.info);
  gst_base_transform_set_in_place(GST_BASE_TRANSFORM(self), TRUE);
  gst_base_transform_set_passthrough(GST_BASE_TRANSFORM(self), FALSE);
}

void cerberus_privacy_mask_class_init(CerberusPrivacyMaskClass* klass) {
  cerberus::plugin::install_properties<CerberusPrivacyMask, kProperties>(G_OBJECT_CLASS(klass));
  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  gst_element_class_set_static_metadata(element, "Privacy mask", "Filter/Effect/Video",
                                        "Covers places of the world, and parts of the picture",
                                        "The Cerberus developers");
  gst_element_class_add_static_pad_template(element, &sink_template);
  gst_element_class_add_static_pad_template(element, &src_template);

  GstBaseTransformClass* transform = GST_BASE_TRANSFORM_CLASS(klass);
  transform->start = cerberus_privacy_mask_start;
  transform->set_caps = cerberus_privacy_mask_set_caps;
  transform->transform_ip = cerberus_privacy_mask_transform_ip;
}

}  // namespace

CERBERUS_REGISTER_ELEMENT(privacymask, GST_RANK_NONE, cerberus_privacy_mask, privacymask_debug,
                          "masks of what must not be seen")
