// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-motionview
 * @title: motionview
 * @short_description: shows what one stage made
 * @see_also: motiondetect, motionoverlay, motionjson
 *
 * Replaces the picture by one stage's result, for looking and for tests. The size, frame rate and time stamps stay; the
 * stage's small picture is enlarged without smoothing, so that every pixel seen is one that was computed.
 *
 * - `stage=luma`: the picture that is analysed (made here if no stage upstream did).
 * - `stage=difference`, `previous-difference`: the registered differences D(k), D(k-1), times `gain`.
 * - `stage=mask`: 0 or 255, the moving area; behind `motionregions` the cleaned one that regions are made from.
 * - `stage=labels`: one colour a connected part of the mask: what regions are made from.
 * - `stage=burnt-in`: the analysed picture, with the outlines of what is left out because the camera has written it
 *   (`burnt-in` of `fuzzythreshold` and `motiondetect`).
 * - `stage=histogram`: how the threshold was chosen, after the paper's figures 2 and 3: histogram of the difference,
 *   memberships, indices of fuzziness (with the options of `fuzzythreshold`), the threshold that was used.
 *
 * Pads: `sink` takes raw video in every format that the stages read; `src` gives GRAY8 (or BGRx) for the grey
 * stages, BGRx for labels, burnt-in and histogram. Regions, threshold and camera motion stay on the buffers, so that
 * motionoverlay and motionjson work behind it. With it in the pipeline the stages leave their record on the buffers.
 * Where a picture is missing there the output is black; one warning message names the cause.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 filesrc location=vtest.avi ! decodebin ! motiondetect ! motionview stage=mask ! \
 *     videoconvert ! autovideosink
 * gst-launch-1.0 filesrc location=vtest.avi ! decodebin ! threeframediff ! fuzzythreshold ! \
 *     motionview stage=histogram ! videoconvert ! autovideosink
 * gst-launch-1.0 filesrc location=vtest.avi ! decodebin ! motiondetect ! motionview stage=difference gain=4 ! \
 *     motionoverlay ! videoconvert ! autovideosink
 * ]|
 *
 * Since: 0.1
 */

#include <cerberus/cerberus.h>
#include <gst/base/gstbasetransform.h>
#include <gst/video/gstvideometa.h>
#include <gst/video/gstvideopool.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cstring>

#include "cerberus/private/element.hpp"
#include "overlay/plane_view.h"
#include "overlay/threshold_figure.h"
#include "shared/complaint.hpp"
#include "shared/properties.hpp"
#include "shared/record.hpp"
#include "shared/single_fields.hpp"
#include "shared/video.hpp"
#include "vision/detector.h"

namespace {

using cerberus::plugin::Adjustable;
using cerberus::plugin::Complaint;
using cerberus::plugin::Property;
using cerberus::plugin::property;
namespace overlay = cerberus::overlay;
namespace vision = cerberus::vision;

GST_DEBUG_CATEGORY_STATIC(motionview_debug);
#define GST_CAT_DEFAULT motionview_debug

// Cairo's 24-bit pixels: x in the high byte of a word.
#if G_BYTE_ORDER == G_LITTLE_ENDIAN
#define COLOR_FORMAT "BGRx"
#else
#define COLOR_FORMAT "xRGB"
#endif

GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS,
                                                             GST_STATIC_CAPS(VIDEO_AND_SINGLE_FIELDS_CAPS));
GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE(
    "src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(GST_VIDEO_CAPS_MAKE("{ GRAY8, " COLOR_FORMAT " }")));

enum Stage {
  STAGE_LUMA,
  STAGE_DIFFERENCE,
  STAGE_PREVIOUS_DIFFERENCE,
  STAGE_MASK,
  STAGE_LABELS,
  STAGE_HISTOGRAM,
  STAGE_BURNT_IN
};

GType stage_type() {
  static const GEnumValue values[] = {
      {STAGE_LUMA, "The picture that is analysed", "luma"},
      {STAGE_DIFFERENCE, "Registered difference to the previous frame", "difference"},
      {STAGE_PREVIOUS_DIFFERENCE, "Registered difference of the two frames before", "previous-difference"},
      {STAGE_MASK, "Moving area, as regions are made from it", "mask"},
      {STAGE_LABELS, "Connected parts of the mask, a colour each", "labels"},
      {STAGE_HISTOGRAM, "How the threshold was chosen", "histogram"},
      {STAGE_BURNT_IN, "Where the camera writes into its pictures", "burnt-in"},
      {0, nullptr, nullptr}};
  static const GType type = g_enum_register_static("CerberusMotionViewStage", values);
  return type;
}

struct Settings {
  int stage = STAGE_MASK;
  double gain = 1;
};

const Property<Settings> kProperties[] = {
    property("stage", &Settings::stage, stage_type, "The stage whose result is shown"),
    property(
        "gain", &Settings::gain, 0, 255,
        "Factor of the grey levels shown for the two differences: 1 shows them as they are, 4 makes small "
        "ones visible, 0 shows black"),
};

struct State {  // streaming thread only
  GstVideoInfo in, out;
  guint warned = 0;     // one bit a stage
  Complaint complaint;  // about the caps
  vision::Record last;  // of the last frame
  vision::LumaStretch stretch;
  vision::LumaScaler scaler;
  vision::Image<std::uint8_t> luma;
  overlay::Enlarger enlarger;
};

struct Private {
  Adjustable<Settings> settings;
  State state;
};

CERBERUS_DEFINE_TYPE(CerberusMotionView, cerberus_motion_view, GstBaseTransform, GST_TYPE_BASE_TRANSFORM,
                     Private)

bool is_colour(int stage) {
  return stage >= STAGE_LABELS;
}

// The picture of the record that a grey stage shows; an empty view where it is not there.
vision::GrayView picture_of(const vision::Analysis& record, int stage) {
  const auto view = [](const vision::GrayPicture& picture) {
    return picture ? vision::GrayView(picture->view()) : vision::GrayView{};
  };
  switch (stage) {
    case STAGE_LUMA:
    case STAGE_BURNT_IN:
      return view(*record.luma);
    case STAGE_DIFFERENCE:
      return view(record.differences->current);
    case STAGE_PREVIOUS_DIFFERENCE:
      return view(record.differences->previous);
    default:
      return record.mask();
  }
}

const char* stage_nick(int stage) {
  auto* type = static_cast<GEnumClass*>(g_type_class_peek(stage_type()));
  const GEnumValue* value = type ? g_enum_get_value(type, stage) : nullptr;
  return value ? value->value_nick : "?";
}

void warn_once(GstBaseTransform* transform, State& state, int stage, const char* why) {
  if (state.warned & (1u << stage)) return;
  state.warned |= 1u << stage;
  CERBERUS_ELEMENT_WARNING(
      transform, STREAM, FAILED,
      ("There is nothing to show for stage=%s: the picture is black.", stage_nick(stage)), ("%s", why));
}

overlay::Canvas canvas_of(GstVideoFrame* frame) {
  return {static_cast<std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(frame, 0)),
          GST_VIDEO_FRAME_PLANE_STRIDE(frame, 0), GST_VIDEO_FRAME_WIDTH(frame), GST_VIDEO_FRAME_HEIGHT(frame),
          GST_VIDEO_FRAME_FORMAT(frame) == GST_VIDEO_FORMAT_GRAY8};
}

bool show_histogram(const vision::Analysis& record, const overlay::Canvas& canvas) {
  if (!record.differences) return false;
  const vision::FuzzyThresholdOptions options =
      record.foreground ? record.foreground->chosen_with : vision::FuzzyThresholdOptions{};
  overlay::ThresholdFigure figure;
  figure.histogram = &record.differences->histogram;
  figure.fuzzy_threshold = vision::fuzzy_threshold(*figure.histogram, options, &figure.curves);
  if (record.foreground && record.foreground->result.ready) {
    figure.threshold = std::min(record.foreground->result.threshold, 255);
    figure.noise = record.foreground->result.sigma;
  }
  return overlay::draw_threshold_figure(figure, canvas);
}

// The analysis picture, made here as cameramotion makes it.
bool show_own_luma(State& state, GstBuffer* in, const overlay::Canvas& canvas) {
  cerberus::VideoFrame frame(state.in, in, GST_MAP_READ);
  if (!frame) return false;
  const vision::LumaSource source = cerberus::luma_source(*frame.get());
  state.luma.resize(
      vision::analysis_size({source.width, source.height}, vision::DetectorOptions{}.analysis_width));
  state.scaler.scale(state.stretch.stretched(source), state.luma.view());
  state.enlarger.show(state.luma.view(), 1, canvas);
  return true;
}

// False where there is nothing to show.
bool show(State& state, const Settings& settings, GstBuffer* in, const overlay::Canvas& canvas) {
  const int stage = settings.stage;
  vision::Record record =
      cerberus::plugin::record_of(in, {GST_VIDEO_INFO_WIDTH(&state.in), GST_VIDEO_INFO_HEIGHT(&state.in)});
  // A repeated picture has none of its own.
  if (!record && GST_BUFFER_FLAG_IS_SET(in, GST_BUFFER_FLAG_GAP)) record = state.last;
  if (record &&
      record->frame != vision::Size{GST_VIDEO_INFO_WIDTH(&state.in), GST_VIDEO_INFO_HEIGHT(&state.in)})
    record = {};
  state.last = record;
  if (!record) return stage == STAGE_LUMA && show_own_luma(state, in, canvas);
  if (stage == STAGE_HISTOGRAM) return show_histogram(*record, canvas);
  if (stage == STAGE_LABELS) {
    if (!record->regions || !record->regions->labels) return false;
    state.enlarger.show_labels(record->regions->labels->view(), canvas);
    return true;
  }
  const vision::GrayView picture = picture_of(*record, stage);
  if (picture.empty()) return false;
  if (stage == STAGE_BURNT_IN) {
    if (!record->foreground || !record->foreground->burnt_in) return false;
    state.enlarger.show_boxes(picture, record->foreground->burnt_in->boxes(), canvas);
    return true;
  }
  const bool difference = stage == STAGE_DIFFERENCE || stage == STAGE_PREVIOUS_DIFFERENCE;
  state.enlarger.show(picture, difference ? settings.gain : 1, canvas);
  return true;
}

gboolean cerberus_motion_view_start(GstBaseTransform* transform) {
  State& state = cerberus_motion_view_self(transform)->priv->state;
  state.complaint.forget();
  return TRUE;
}

gboolean cerberus_motion_view_stop(GstBaseTransform* transform) {
  cerberus_motion_view_self(transform)->priv->state.last = {};
  return TRUE;
}

// Frames that follow these events repeat no picture from before them.
gboolean cerberus_motion_view_sink_event(GstBaseTransform* transform, GstEvent* event) {
  if (GST_EVENT_TYPE(event) == GST_EVENT_FLUSH_STOP || GST_EVENT_TYPE(event) == GST_EVENT_SEGMENT)
    cerberus_motion_view_self(transform)->priv->state.last = {};
  return cerberus_motion_view_parent_class()->sink_event(transform, event);
}

GstCaps* cerberus_motion_view_transform_caps(GstBaseTransform* transform, GstPadDirection direction,
                                             GstCaps* caps, GstCaps* filter) {
  const bool colour = is_colour(cerberus_motion_view_self(transform)->priv->settings.snapshot().stage);
  GstCaps* formats = direction == GST_PAD_SRC ? gst_static_pad_template_get_caps(&sink_template)
                     : colour                 ? gst_caps_from_string(GST_VIDEO_CAPS_MAKE(COLOR_FORMAT))
                                              : gst_static_pad_template_get_caps(&src_template);
  // Whatever describes the frame, not its pixels.
  GstCaps* sizes = cerberus::plugin::without_single_fields(gst_caps_copy(caps));
  for (guint i = 0; i < gst_caps_get_size(sizes); ++i)
    gst_structure_remove_fields(gst_caps_get_structure(sizes, i), "format", "colorimetry", "chroma-site",
                                "interlace-mode", "field-order", nullptr);
  GstCaps* result = gst_caps_intersect_full(formats, sizes, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(formats);
  gst_caps_unref(sizes);
  if (direction == GST_PAD_SRC) result = cerberus::plugin::with_single_fields(result);
  if (!filter) return result;
  GstCaps* common = gst_caps_intersect_full(filter, result, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(result);
  return common;
}

gboolean cerberus_motion_view_set_caps(GstBaseTransform* transform, GstCaps* in, GstCaps* out) {
  return cerberus::guarded(transform, FALSE, [&]() -> gboolean {
    State& state = cerberus_motion_view_self(transform)->priv->state;
    std::string wrong;
    if (!gst_video_info_from_caps(&state.in, in) || !gst_video_info_from_caps(&state.out, out))
      wrong = cerberus::kCapsIncomplete;
    else if (GST_VIDEO_INFO_IS_INTERLACED(&state.in))
      wrong = "Interlaced video cannot be shown: put the element `deinterlace` in front of the stages.";
    if (state.complaint.is_new(wrong))
      CERBERUS_ELEMENT_ERROR(transform, CORE, NEGOTIATION, (wrong),
                             ("from %" GST_PTR_FORMAT " to %" GST_PTR_FORMAT, in, out));
    if (!wrong.empty()) return FALSE;
    state.warned = 0;
    state.last = {};
    return TRUE;
  });
}

gboolean cerberus_motion_view_get_unit_size(GstBaseTransform*, GstCaps* caps, gsize* size) {
  GstVideoInfo info;
  if (!gst_video_info_from_caps(&info, caps)) return FALSE;
  *size = GST_VIDEO_INFO_SIZE(&info);
  return TRUE;
}

// The frame ends here and is only read: any stride will do.
gboolean cerberus_motion_view_propose_allocation(GstBaseTransform*, GstQuery*, GstQuery* query) {
  gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
  return TRUE;
}

// A pool of our own where downstream has none: a large picture is not allocated anew for every frame.
gboolean cerberus_motion_view_decide_allocation(GstBaseTransform* transform, GstQuery* query) {
  GstCaps* caps = nullptr;
  gst_query_parse_allocation(query, &caps, nullptr);
  GstVideoInfo info;
  if (gst_query_get_n_allocation_pools(query) == 0 && caps && gst_video_info_from_caps(&info, caps)) {
    GstBufferPool* pool = gst_video_buffer_pool_new();
    GstStructure* config = gst_buffer_pool_get_config(pool);
    gst_buffer_pool_config_set_params(config, caps, static_cast<guint>(GST_VIDEO_INFO_SIZE(&info)), 0, 0);
    if (gst_buffer_pool_set_config(pool, config))
      gst_query_add_allocation_pool(query, pool, static_cast<guint>(GST_VIDEO_INFO_SIZE(&info)), 0, 0);
    gst_object_unref(pool);
  }
  return cerberus_motion_view_parent_class()->decide_allocation(transform, query);
}

// Everything that is true of the new picture as well (it has the frame's size); not what describes the old memory, nor
// which part of that memory the frame was.
gboolean cerberus_motion_view_transform_meta(GstBaseTransform*, GstBuffer*, GstMeta* meta, GstBuffer*) {
  return meta->info->api != GST_VIDEO_CROP_META_API_TYPE &&
         !gst_meta_api_type_has_tag(meta->info->api, g_quark_from_static_string(GST_META_TAG_MEMORY_STR));
}

gboolean cerberus_motion_view_query(GstBaseTransform* transform, GstPadDirection direction, GstQuery* query) {
  if (direction == GST_PAD_SINK && cerberus::plugin::is_record_query(query)) {
    cerberus::plugin::add_wanted(query, cerberus::plugin::kRecordForReaders);
    return FALSE;  // the record ends here, but another branch of a tee may want it too
  }
  return cerberus_motion_view_parent_class()->query(transform, direction, query);
}

GstFlowReturn cerberus_motion_view_transform(GstBaseTransform* transform, GstBuffer* in, GstBuffer* out) {
  return cerberus::guarded(transform, GST_FLOW_ERROR, [&]() -> GstFlowReturn {
    Private& self = *cerberus_motion_view_self(transform)->priv;
    State& state = self.state;
    const Settings settings = self.settings.snapshot();
    cerberus::VideoFrame frame(state.out, out, GST_MAP_WRITE);
    if (!frame) {
      CERBERUS_ELEMENT_ERROR(transform, RESOURCE, WRITE, ("The picture cannot be written."),
                             ("%" GST_PTR_FORMAT, out));
      return GST_FLOW_ERROR;
    }
    const overlay::Canvas canvas = canvas_of(frame.get());
    const GstMapInfo& map = frame.get()->map[0];
    canvas.clear_padding(static_cast<std::size_t>(map.data + map.size - canvas.data));
    // A stage changed just now: this frame still has the old format.
    const bool fits = !is_colour(settings.stage) || !canvas.gray;
    if (fits && show(state, settings, in, canvas)) return GST_FLOW_OK;
    canvas.fill_black();
    if (fits)
      warn_once(transform, state, settings.stage,
                settings.stage == STAGE_LUMA ? "the buffer does not hold the picture that its caps promise"
                                             : "no stage upstream made it, keep-planes=never took it off, or "
                                               "a converter or encoder in between lost it");
    return GST_FLOW_OK;
  });
}

void cerberus_motion_view_set_property(GObject* object, guint id, const GValue* value, GParamSpec*) {
  cerberus_motion_view_self(object)->priv->settings.set(kProperties, id, value);
  gst_base_transform_reconfigure_src(GST_BASE_TRANSFORM(object));  // another stage may need another format
}

void cerberus_motion_view_get_property(GObject* object, guint id, GValue* value, GParamSpec*) {
  cerberus_motion_view_self(object)->priv->settings.get(kProperties, id, value);
}

void cerberus_motion_view_init(CerberusMotionView* self) {
  gst_video_info_init(&self->priv->state.in);
  gst_video_info_init(&self->priv->state.out);
  gst_base_transform_set_passthrough(GST_BASE_TRANSFORM(self), FALSE);
  gst_base_transform_set_qos_enabled(GST_BASE_TRANSFORM(self), FALSE);
}

void cerberus_motion_view_class_init(CerberusMotionViewClass* klass) {
  GObjectClass* object = G_OBJECT_CLASS(klass);
  object->set_property = cerberus_motion_view_set_property;
  object->get_property = cerberus_motion_view_get_property;
  Adjustable<Settings>::install(object, kProperties);

  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  gst_element_class_set_static_metadata(element, "Motion view", "Filter/Analyzer/Video",
                                        "Replaces the picture by what one stage of motion detection made",
                                        "The Cerberus developers");
  gst_element_class_add_static_pad_template(element, &sink_template);
  gst_element_class_add_static_pad_template(element, &src_template);

  GstBaseTransformClass* transform = GST_BASE_TRANSFORM_CLASS(klass);
  transform->start = cerberus_motion_view_start;
  transform->stop = cerberus_motion_view_stop;
  transform->sink_event = cerberus_motion_view_sink_event;
  transform->transform_caps = cerberus_motion_view_transform_caps;
  transform->set_caps = cerberus_motion_view_set_caps;
  transform->get_unit_size = cerberus_motion_view_get_unit_size;
  transform->propose_allocation = cerberus_motion_view_propose_allocation;
  transform->decide_allocation = cerberus_motion_view_decide_allocation;
  transform->transform_meta = cerberus_motion_view_transform_meta;
  transform->query = cerberus_motion_view_query;
  transform->transform = cerberus_motion_view_transform;
}

}  // namespace

CERBERUS_REGISTER_ELEMENT(motionview, GST_RANK_NONE, cerberus_motion_view, motionview_debug,
                          "a stage's result as picture")
