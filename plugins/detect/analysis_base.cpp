// SPDX-License-Identifier: LGPL-2.1-or-later
#include "analysis_base.hpp"

#include <cerberus/cerberus.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <string>

#include "damage_mark.hpp"
#include "shared/camera_mount.hpp"
#include "shared/camera_path.hpp"
#include "shared/clock_times.hpp"
#include "shared/complaint.hpp"
#include "shared/person_looks.hpp"
#include "shared/properties.hpp"
#include "shared/record.hpp"
#include "shared/settings_query.hpp"
#include "shared/single_fields.hpp"
#include "shared/video.hpp"
#include "vision/clocked_times.h"
#include "vision/frame_history.h"
#include "vision/scene_breaks.h"

GST_DEBUG_CATEGORY_STATIC(cerberus_analysis_debug);
#define GST_CAT_DEFAULT cerberus_analysis_debug

namespace cerberus::plugin {
namespace {

constexpr int kLeastAnalysisWidth = 48;  // of less, people are a pixel or none

struct Settings {
  int analysis_width = vision::DetectorOptions{}.analysis_width;
};

const Property<Settings> kProperties[] = {
    property("analysis-width", &Settings::analysis_width, 0, vision::kMaximumAnalysisSide,
             "Width in pixels of the small picture that is analysed, where none comes from upstream: larger "
             "sees smaller "
             "objects and costs more; frames that are not wider are analysed as they are, 1 to 47 counts as "
             "48; 0 = always the frame's own width; larger than 3840 x 2160 pixels it never becomes"),
};

}  // namespace

struct AnalysisPrivate {
  Adjustable<Settings> settings;
  // From here on: streaming thread, and state changes while it does not run.
  Analyser* analyser = nullptr;
  GstVideoInfo info{};
  bool have_info = false;
  guint wanted = 0;              // of the record, downstream
  std::atomic<bool> ask = true;  // those downstream what they want; set by any thread
  std::optional<bool> live;      // upstream; empty until the source has answered
  vision::FrameHistory history;
  guint64 number = 0;  // analysed frames
  vision::CameraFollower camera;
  vision::SceneBreaks breaks;
  int steps_back = 0;       // frames older than the one before
  Complaint complaint;      // about the caps
  Complaint pixels;         // about their shape
  bool warned = false;      // about an unusable buffer, once a stream
  bool complained = false;  // about breaks, likewise
};

namespace {

AnalysisPrivate& priv_of(gpointer instance) {
  return *static_cast<CerberusAnalysis*>(instance)->priv;
}

GstBaseTransformClass* parent_class();

// Queries at the first frame after caps or RECONFIGURE: elements downstream have received the caps, up to the first queue.
void ask_downstream(GstBaseTransform* trans, AnalysisPrivate& priv) {
  const bool ask = priv.ask.exchange(false);
  if (ask) priv.wanted = ask_for_record(GST_BASE_TRANSFORM_SRC_PAD(trans));
  if (ask || !priv.live) priv.live = is_live(GST_BASE_TRANSFORM_SINK_PAD(trans));
}

// No element upstream has analysed this frame.
bool is_first_stage(GstBuffer* buffer, vision::Size frame) {
  return !cerberus_buffer_peek_camera_motion(buffer) && !cerberus_buffer_regions_known(buffer) &&
         !record_of(buffer, frame);
}

// Once a stream. Twice is nothing: a file that is played in a loop, a clock that is set.
void complain_of_times(GstBaseTransform* trans, AnalysisPrivate& priv, bool backwards) {
  constexpr int kMany = 3;
  if (!backwards || ++priv.steps_back != kMany) return;
  CERBERUS_ELEMENT_WARNING(
      trans, STREAM, FAILED,
      ("Timestamps run backwards, so that speeds and times are guessed: let the source stamp the frames "
       "(`do-timestamp=true`), or put the parser of the format (`h264parse`) in front of its decoder."),
      ("a buffer that is a little older than the one before it is taken to follow at the usual distance, a "
       "much older one begins a new scene"));
}

// A frame, and what is wrong with its place in the stream.
struct Begun {
  Frame frame;
  bool cut = false;        // the frame itself is marked as not continuing the stream
  bool broken = false;     // this stage, and none before, must begin anew although the picture shows no cut
  bool backwards = false;  // so do the timestamps; likewise
};

Frame frame_of(GstBaseTransform* trans, AnalysisPrivate& priv, GstBuffer* buffer) {
  Frame frame;
  frame.buffer = buffer;
  frame.info = &priv.info;
  frame.size = {GST_VIDEO_INFO_WIDTH(&priv.info), GST_VIDEO_INFO_HEIGHT(&priv.info)};
  frame.running_time = running_time_of(trans->segment, buffer);
  frame.live = priv.live.value_or(false);
  frame.wanted = priv.wanted;
  return frame;
}

double nominal_distance(const GstVideoInfo& info) {
  const int n = GST_VIDEO_INFO_FPS_N(&info), d = GST_VIDEO_INFO_FPS_D(&info);
  return n > 0 ? static_cast<double>(d) / n : 0;
}

// The clock of a live pipeline says that the frame's time is right.
bool is_confirmed(GstBaseTransform* trans, const AnalysisPrivate& priv, const Frame& frame) {
  const auto time = known_time(frame.running_time);
  return frame.live && time && vision::clock_confirms(*time, priv.history.previous(), clock_now(trans));
}

GstFlowReturn repeat_frame(GstBaseTransform* trans, AnalysisPrivate& priv, GstBuffer* buffer,
                           bool damaged = false) {
  Frame frame = frame_of(trans, priv, buffer);
  const auto time = known_time(frame.running_time);
  const double nominal = nominal_distance(priv.info);
  // As in begin_frame(): a mark where frames are missing ends no scene, and where the camera is measured upstream, the
  // element that measures it decides.
  const bool goes_on = priv.analyser->measures_camera() ? priv.history.misses_frames(time, nominal)
                                                        : path_point(buffer).has_value();
  if (GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DISCONT) && !goes_on) priv.history.drop();
  const auto repeated = priv.history.repeat(time, nominal, damaged, is_confirmed(trans, priv, frame));
  if (!repeated) return GST_FLOW_OK;  // of nothing
  frame.running_time = clock_time(repeated->time);
  frame.fresh = false;
  frame.seconds = repeated->seconds;
  priv.analyser->repeat(frame);
  return GST_FLOW_OK;
}

Begun begin_frame(GstBaseTransform* trans, AnalysisPrivate& priv, GstBuffer* buffer) {
  using vision::CameraFollower;
  using Link = CameraFollower::Link;
  Begun begun;
  Frame& frame = begun.frame = frame_of(trans, priv, buffer);
  const bool measures = priv.analyser->measures_camera();
  const CameraFollower::Step camera = priv.camera.next(measures ? std::nullopt : path_point(buffer),
                                                       clock_time(priv.history.previous()), frame.size);

  const double nominal = nominal_distance(priv.info);
  const auto time = known_time(frame.running_time);
  // A mark of DISCONT may be a cut or dropped frames. The element that
  // measures the camera detects a cut among dropped frames, and publishes it.
  const bool marked = GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DISCONT) && !camera.connected &&
                      !(measures && priv.history.misses_frames(time, nominal));
  if (marked) priv.history.drop();
  const vision::FrameHistory::Step step =
      priv.history.next(time, nominal, GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DISCONT),
                        is_confirmed(trans, priv, frame));
  frame.running_time = clock_time(step.time);
  frame.fresh = step.fresh || camera.link == Link::cut || camera.link == Link::lost;
  frame.number = ++priv.number;
  frame.read_pose();
  if (!frame.fresh) {
    frame.seconds = step.seconds;
    frame.repeatable = step.repeatable;
    frame.previous = clock_time(step.previous);
    frame.motion = camera.motion;
  }
  const bool first = is_first_stage(buffer, frame.size);
  begun.cut = marked && camera.link != Link::lost;
  begun.broken = camera.link == Link::lost || (first && (marked || step.broken));
  begun.backwards = first && step.backwards;
  return begun;
}

// Warns of scenes that end before a track can be confirmed.
void complain_of_breaks(GstBaseTransform* trans, AnalysisPrivate& priv, const Begun& begun) {
  const bool many = priv.breaks.add(begun.frame.fresh, begun.broken, begun.frame.seconds);
  if (!many || priv.complained) return;
  priv.complained = true;
  CERBERUS_ELEMENT_WARNING(
      trans, STREAM, FAILED,
      ("The stream is broken so often that nobody can be confirmed: drop frames in front of "
       "`cameramotion`, by `videorate drop-only=true` or a leaky queue, or behind `motiontrack`."),
      ("the buffers are marked DISCONT, their times lie far apart, or their camera motion starts from frames "
       "that never came"));
}

void check_settings(GstBaseTransform* trans, AnalysisPrivate& priv) {
  const std::optional<Settings> changed = priv.settings.changes();
  if (!changed || changed->analysis_width == 0 || changed->analysis_width >= kLeastAnalysisWidth) return;
  CERBERUS_ELEMENT_WARNING(
      trans, RESOURCE, SETTINGS,
      ("analysis-width=%d is too small to see anything: %d counts instead. Set that, or more.",
       changed->analysis_width, kLeastAnalysisWidth),
      (nullptr));
}

GstFlowReturn transform_ip(GstBaseTransform* trans, GstBuffer* buffer) {
  AnalysisPrivate& priv = priv_of(trans);
  return guarded(trans, GST_FLOW_ERROR, [&] {
    ask_downstream(trans, priv);
    const bool damaged = is_damaged(buffer);
    if (damaged) GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_GAP | GST_BUFFER_FLAG_CORRUPTED);
    if (GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_GAP))
      return repeat_frame(trans, priv, buffer, damaged);
    check_settings(trans, priv);
    const vision::FrameHistory history = priv.history;
    const vision::CameraFollower camera = priv.camera;
    Begun begun = begin_frame(trans, priv, buffer);
    const Analyser::Outcome outcome = priv.analyser->analyse(begun.frame);
    if (outcome == Analyser::Outcome::analysed) {
      complain_of_breaks(trans, priv, begun);
      complain_of_times(trans, priv, begun.backwards);
      return GST_FLOW_OK;
    }

    // The next frame is compared with the last picture.
    priv.history = history;
    priv.camera = camera;
    --priv.number;
    if (outcome == Analyser::Outcome::repeats) {
      GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_GAP);
      return repeat_frame(trans, priv, buffer);
    }

    // The buffer has no valid picture: the frame is passed on unchanged, marked by a flag.
    if (begun.cut)
      priv.history.drop();
    else
      priv.history.lose();
    const bool told = GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_CORRUPTED) || priv.warned;
    GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_CORRUPTED);
    if (!told) {
      priv.warned = true;
      CERBERUS_ELEMENT_WARNING(
          trans, STREAM, DECODE,
          ("A buffer does not hold the picture that its caps promise; it is passed on, not analysed."),
          ("%" G_GSIZE_FORMAT " bytes at %" GST_TIME_FORMAT " for %d x %d %s need %" G_GSIZE_FORMAT,
           gst_buffer_get_size(buffer), GST_TIME_ARGS(GST_BUFFER_PTS(buffer)),
           GST_VIDEO_INFO_WIDTH(&priv.info), GST_VIDEO_INFO_HEIGHT(&priv.info),
           GST_VIDEO_INFO_NAME(&priv.info), GST_VIDEO_INFO_SIZE(&priv.info)));
    }
    return GST_FLOW_OK;
  });
}

void accept(AnalysisPrivate& priv, const GstVideoInfo& info) {
  if (!priv.have_info || !gst_video_info_is_equal(&priv.info, &info)) {
    priv.history.drop();
    priv.analyser->new_caps();
  }
  priv.info = info;
  priv.have_info = true;
  priv.warned = false;
  priv.complained = false;
  priv.ask = true;
}

// What is wrong with these caps, for the user; empty for nothing.
std::string what_is_wrong(const GstCaps* caps, GstVideoInfo* info) {
  if (!gst_video_info_from_caps(info, caps)) return kCapsIncomplete;
  if (GST_VIDEO_INFO_IS_INTERLACED(info))
    return "Interlaced video cannot be analysed: put the element `deinterlace` in front.";
  return {};
}

// Pixels count as squares everywhere: in boxes, in a person's proportions and in angles.
void complain_of_pixels(GstBaseTransform* trans, AnalysisPrivate& priv) {
  constexpr double kLittle = 1.12;
  const int n = GST_VIDEO_INFO_PAR_N(&priv.info), d = GST_VIDEO_INFO_PAR_D(&priv.info);
  const bool square = n < kLittle * d && d < kLittle * n;
  const std::string wrong =
      square ? ""
             : "The pixels are not square (" + std::to_string(n) + " to " + std::to_string(d) +
                   "), but count as if they were: people may be cut in two or joined, and "
                   "distances are wrong. Put `videoscale ! "
                   "video/x-raw,pixel-aspect-ratio=1/1` in front.";
  if (priv.pixels.is_new(wrong)) CERBERUS_ELEMENT_WARNING(trans, STREAM, FORMAT, (wrong), (nullptr));
}

GstCaps* transform_caps(GstBaseTransform*, GstPadDirection direction, GstCaps* caps, GstCaps* filter) {
  GstCaps* others = across_single_fields(direction, gst_caps_ref(caps));
  if (!filter) return others;
  GstCaps* common = gst_caps_intersect_full(filter, others, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(others);
  return common;
}

gboolean set_caps(GstBaseTransform* trans, GstCaps* incaps, GstCaps*) {
  AnalysisPrivate& priv = priv_of(trans);
  GstVideoInfo info;
  return guarded(trans, FALSE, [&]() -> gboolean {
    const std::string wrong = what_is_wrong(incaps, &info);
    if (priv.complaint.is_new(wrong))
      CERBERUS_ELEMENT_ERROR(trans, CORE, NEGOTIATION, (wrong), ("%" GST_PTR_FORMAT, incaps));
    if (!wrong.empty()) return FALSE;
    accept(priv, info);
    if (priv.analyser->measures_camera()) complain_of_pixels(trans, priv);
    return TRUE;
  });
}

gboolean query(GstBaseTransform* trans, GstPadDirection direction, GstQuery* query) {
  if (direction == GST_PAD_SINK) {
    const auto ends = [&] { return is_record_query(query) && priv_of(trans).analyser->answer(query); };
    if (guarded(trans, false, ends)) return FALSE;  // not for the other branches of a tee
    if (is_looks_query(query) && priv_of(trans).analyser->take_looks()) {
      accept_looks_query(query);
      return TRUE;
    }
  }
  return parent_class()->query(trans, direction, query);
}

gboolean src_event(GstBaseTransform* trans, GstEvent* event) {
  // Sent, among others, when an element is linked downstream.
  if (GST_EVENT_TYPE(event) == GST_EVENT_RECONFIGURE) priv_of(trans).ask = true;
  guarded(trans, [&] { priv_of(trans).analyser->upstream_event(event); });
  return parent_class()->src_event(trans, event);
}

gboolean sink_event(GstBaseTransform* trans, GstEvent* event) {
  AnalysisPrivate& priv = priv_of(trans);
  switch (GST_EVENT_TYPE(event)) {
    case GST_EVENT_FLUSH_START:
      guarded(trans, [&] { priv.analyser->flush(true); });
      break;
    case GST_EVENT_FLUSH_STOP:
      guarded(trans, [&] { priv.analyser->flush(false); });
      [[fallthrough]];
    case GST_EVENT_SEGMENT:
    case GST_EVENT_STREAM_START:
      priv.history.drop();
      break;
    case GST_EVENT_EOS:
      guarded(trans, [&] { priv.analyser->end_of_stream(); });
      break;
    default:
      break;
  }
  return parent_class()->sink_event(trans, event);
}

gboolean start(GstBaseTransform* trans) {
  AnalysisPrivate& priv = priv_of(trans);
  return guarded(trans, FALSE, [&]() -> gboolean {
    priv.history.drop();
    priv.have_info = false;
    priv.warned = false;
    priv.breaks = {};
    priv.steps_back = 0;
    priv.complained = false;
    priv.camera.forget();
    priv.complaint.forget();
    priv.pixels.forget();
    priv.settings.refresh();
    return priv.analyser->start();
  });
}

gboolean stop(GstBaseTransform* trans) {
  guarded(trans, [&] { priv_of(trans).analyser->stop(); });
  return TRUE;
}

GstStateChangeReturn change_state(GstElement* element, GstStateChange change) {
  if (change == GST_STATE_CHANGE_PAUSED_TO_PLAYING || change == GST_STATE_CHANGE_PLAYING_TO_PAUSED)
    guarded(element, [&] { priv_of(element).analyser->play(change == GST_STATE_CHANGE_PAUSED_TO_PLAYING); });
  return GST_ELEMENT_CLASS(parent_class())->change_state(element, change);
}

std::string settings_fault(GstElement* element) {
  return priv_of(element).analyser->settings_fault();
}

void class_init(CerberusAnalysisClass* klass) {
  GST_DEBUG_CATEGORY_INIT(cerberus_analysis_debug, "cerberusanalysis", 0,
                          "what all analysing elements share");
  install_properties<CerberusAnalysis, kProperties>(G_OBJECT_CLASS(klass));

  static GstStaticPadTemplate sink = GST_STATIC_PAD_TEMPLATE(
      "sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(ANALYSED_VIDEO_AND_SINGLE_FIELDS_CAPS));
  static GstStaticPadTemplate src =
      GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(ANALYSED_VIDEO_CAPS));
  gst_element_class_add_static_pad_template(GST_ELEMENT_CLASS(klass), &sink);
  gst_element_class_add_static_pad_template(GST_ELEMENT_CLASS(klass), &src);

  GST_ELEMENT_CLASS(klass)->change_state = change_state;
  GST_ELEMENT_CLASS(klass)->query = settings_query<parent_class, settings_fault>;

  GstBaseTransformClass* trans = GST_BASE_TRANSFORM_CLASS(klass);
  trans->start = start;
  trans->stop = stop;
  trans->transform_caps = transform_caps;
  trans->set_caps = set_caps;
  trans->query = query;
  trans->sink_event = sink_event;
  trans->src_event = src_event;
  trans->transform_ip = transform_ip;
}

void init(CerberusAnalysis* self) {
  auto* trans = GST_BASE_TRANSFORM(self);
  gst_base_transform_set_in_place(trans, TRUE);
  // Not passthrough: that is what makes the buffer writable for metas (its memory stays shared).
  gst_base_transform_set_passthrough(trans, FALSE);
  gst_base_transform_set_gap_aware(trans, TRUE);
  // A detector that skips late frames sees a gap instead of motion.
  gst_base_transform_set_qos_enabled(trans, FALSE);
}

struct Traits {
  using Self = CerberusAnalysis;
  using Class = CerberusAnalysisClass;
  using Object = AnalysisPrivate;
  static const char* name() { return "CerberusAnalysis"; }
  static GType parent() { return GST_TYPE_BASE_TRANSFORM; }
  static void init(Self* self) { plugin::init(self); }
  static void class_init(Class* klass) { plugin::class_init(klass); }
  static void interfaces(GType) {}
};

GstBaseTransformClass* parent_class() {
  return static_cast<GstBaseTransformClass*>(detail::TypeBuilder<Traits>::parent_class);
}

}  // namespace

GType cerberus_analysis_get_type() {
  return detail::TypeBuilder<Traits>::get();
}

void cerberus_analysis_init_with(CerberusAnalysis* self, Analyser* analyser) {
  self->priv->analyser = analyser;
}

void cerberus_analysis_answer_anew(CerberusAnalysis* self) {
  gst_base_transform_reconfigure_sink(GST_BASE_TRANSFORM(self));
}

int cerberus_analysis_width(const CerberusAnalysis* self) {
  const int width = self->priv->settings.snapshot().analysis_width;
  return width == 0 ? 0 : std::max(width, kLeastAnalysisWidth);
}

}  // namespace cerberus::plugin
