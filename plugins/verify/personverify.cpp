// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-personverify
 * @title: personverify
 * @short_description: follows people by what moves and by a people detector
 * @see_also: motiondetect, pirfusion, pantiltsink
 *
 * A curtain, a clock and a car move, too, and before a camera that shakes or drives everything does. This element shows the
 * whole frame to a detector for people, on a thread of its own and `rate` times a second of running time, and follows with two
 * witnesses: what moves, as `motiondetect` tracks it, and what the detector sees. It publishes tracks of its own in place of
 * those of `motiondetect`:
 *
 * - each track has one sum of evidence. A look of the detector adds to it by its score, or takes from it where it does not
 *   show the track; motion inside the box and motion tracks add, rest in a calm scene takes away. What has not moved
 *   needs higher scores;
 * - before a camera that stands a motion track is published as it is once it has gone a quarter of its
 *   height, or a look has shown it: then also with the type `person` and a confidence. Before one that moves it is
 *   published once a look has shown it, or once it has moved by itself for a third of a second. There a network's box goes
 *   before its own where the two differ by more than half, and a window where its own is a small part of it. Where the scene
 *   is not calm (the picture shakes or blurs, or near things pass) motion tracks do not count;
 * - where a PIR sensor that covers a part of the picture begins to detect, as `pirfusion` downstream says, the detector looks
 *   at once: beyond `rate` and `cpu`, once a second at most. With one look a second people in doorways are found in .3 s instead of
 *   .7;
 * - a person whom no motion track shows is followed by the picture from look to look;
 * - a motion track is a person once a look has shown it, and only moves again once looks that should see it, as they have
 *   seen it smaller, have missed it often enough: five of one that was seen once, at the threshold. The confidence
 *   of a person is this evidence of looks, 0 to 1;
 * - a person whom no motion track shows counts where `zones` of `motiondetect` or `motionregions` let the middle of the box
 *   count, unless the picture is cropped between that element and the one that follows;
 * - a motion track that holds several people is replaced by one region for each of them;
 * - identities count from 1 in the order in which tracks are published, and none is given twice: they are not those of the
 *   motion tracks, which `motiondetect` in front has in its messages;
 * - `require=person` leaves out what no look has shown: `pirfusion` and `pantiltsink` behind then follow persons only.
 *
 * It stands behind `motiondetect` or in front of it, with nearly the same result. Behind, the tracker upstream passes on to this
 * element what it would doubt by itself: see `motiontrack`. In front of `motiondetect` or `motiontrack` it only looks: what it
 * has seen goes along with the frames, and the tracker downstream follows by both witnesses and publishes, also in its
 * messages. Where the tracker is in one branch of a `tee`, the others get no regions. What it has seen goes through whatever
 * copies, converts or scales the picture, and is lost where it is cropped: the tracker warns of that.
 *
 * People are found by OpenCV's default people detector (histograms of oriented gradients, trained on INRIA's data) or with
 * `detector=daimler` by its Daimler detector, both in a picture of 480 lines: upright ones who are at least a fifth, or a
 * sixth, of it high. A look costs 45 to 150 ms of one core; live the detector works `cpu` of the time at most, and looks
 * less often where that does not suffice. It does not see people who sit or lie, or only their upper half.
 *
 * `model` names a network instead: an ONNX file whose input has a fixed size (1 x 3 x height x width), or the weights of a
 * darknet model (`.weights`) with its configuration (`.cfg`) beside it or named by `config`. It sees colours, where the frames
 * have any. Outputs of YOLO 5 to 8, 10 and 11, YOLOX, SSD and NanoDet are read, of N boxes and C classes (also
 * transposed, and without the batch):
 *
 * - YOLO 5, 6 and 7: 1 x N x (5 + C), YOLO 8 and 11: 1 x (4 + C) x N, YOLOX with or without `--decode_in_inference`;
 * - end to end (YOLO 10): 1 x N x 6, corners, score and class;
 * - SSD: 1 x 1 x N x 7, or 1 x N x 4 (corners) and 1 x N x C;
 * - NanoDet: scores (N x C) and distances (N x 32) for cells of 8, 16 and 32 pixels, or of 8 to 64; NanoDet-Plus:
 *   1 x N x (C + 32);
 * - darknet: every `[yolo]` layer (YOLO 3 and 4, Yolo-Fastest). Its input takes the frame's aspect, and up to twice the pixels
 *   where it is smaller than 448x448.
 *
 * The shape, the number of boxes for that input and the numbers themselves tell them apart; where they do not, the
 * number of classes does, which `labels` names. Outputs that are none of these, mostly boxes without a size, and scores beyond
 * 0 to 1 are an error that says so, at the start, or where the network first finds something. Which layers can be run
 * depends on OpenCV: that of Debian 12 (4.6) is older than YOLO 8, whose one step that it cannot do is rewritten while the
 * file is read; a model that cannot be run is an error at the start.
 *
 * A network gets (level - mean) * scale of levels from 0 to 255, red, green and blue. By default these are numbers from 0 to
 * 1. YOLOX gets 0 to 255, and NanoDet levels about the mean of the pictures that it is trained with (103.53,116.28,123.675,
 * times 0.017429,0.017507,0.017125), both in the order blue, green, red. A network that was trained otherwise needs the
 * properties `mean` and `scale`: one number, or three for its planes in their order.
 *
 * No model comes with Cerberus. `pipelines/setup person` fetches yolo-fastest-1.1_body on request, 1.2 MB that find people
 * at a third of the cost of the detectors above: `model=yolo-fastest-1.1_body.weights`. A name without a folder is also
 * looked for in `cerberus/models` below the user's and the system's folders of data (`~/.local/share`,
 * `/usr/local/share`). Each model has its licence: YOLO 5, 8, 10 and 11 are AGPL-3.0 (Ultralytics also sells others), YOLO 7
 * is GPL-3.0, YOLOX and NanoDet are Apache-2.0, darknet's own and Yolo-Fastest are free for any use, SSD of torchvision is
 * BSD-3-Clause; the data that they were trained with has terms of its own.
 *
 * Live, a result counts from the first frame after it is there, and no frame waits. In a pipeline that is not live it
 * counts from the first frame that is at least 40 ms of running time later than the frame that was looked at, and that
 * frame waits for it: two runs give the same bytes.
 *
 * Pads: one sink, one src, raw video in system memory, in every format that the stages read; works in place, on the
 * regions of `motiondetect`, or, without a tracker in the line, on #GstVideoRegionOfInterestMeta of other elements. Those stay
 * on the buffer (with `require=person` they are removed), and the persons among them are attached as regions of their
 * own.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 ! motiondetect ! personverify ! motionjson ! fdsink
 * gst-launch-1.0 filesrc location=vtest.avi ! decodebin ! personverify require=person ! motiondetect ! motionoverlay ! \
 *     videoconvert ! autovideosink
 * ]|
 *
 * Since: 0.1
 */
// Method: N. Dalal and B. Triggs, "Histograms of oriented gradients for human detection", CVPR 2005, for the detector;
// what is made of its boxes is in lib/vision/tracking/evidence. Quality: docs/quality.md.
#include <cerberus/cerberus.h>
#include <gst/base/gstbasetransform.h>
#include <gst/video/video.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cerberus/private/element.hpp"
#include "detector_use.hpp"
#include "model_path.hpp"
#include "shared/camera_path.hpp"
#include "shared/clock_times.hpp"
#include "shared/complaint.hpp"
#include "shared/evidence_regions.hpp"
#include "shared/foreign_boxes.hpp"
#include "shared/onset.hpp"
#include "shared/person_looks.hpp"
#include "shared/properties.hpp"
#include "shared/record.hpp"
#include "shared/region_conversion.hpp"
#include "shared/settings_query.hpp"
#include "shared/video.hpp"
#include "vision/clocked_times.h"
#include "vision/frame_history.h"
#include "vision/image/luma/luma_stretch.h"
#include "vision/persons/look_worker.h"

namespace {

using cerberus::plugin::property;
namespace vision = cerberus::vision;

GST_DEBUG_CATEGORY_STATIC(personverify_debug);
#define GST_CAT_DEFAULT personverify_debug

GstStaticPadTemplate sink_template =
    GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(CERBERUS_VIDEO_CAPS));
GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(CERBERUS_VIDEO_CAPS));

// Running time after which a result counts where the pipeline is not live: a slow processor is waited for. swept: 40
// and 100 ms, before persons had tracks of their own.
constexpr GstClockTime kDelay = 40 * GST_MSECOND;
// Between looks that onsets ask for. Derived: modules hold an onset for two seconds and more, so one chatters where they come faster.
constexpr GstClockTime kExtraLooksApart = GST_SECOND;
// Looks a second. Derived: a slow processor takes 100 ms for one.
constexpr double kMostRate = 10;
// Seconds between frames of a stream without times.
constexpr double kUsualStep = 0.04;
// A longer gap, in seconds, begins anew.
constexpr double kLongestGap = 2;
enum { REQUIRE_NONE, REQUIRE_PERSON };

GType require_type() {
  static const GEnumValue kValues[] = {{REQUIRE_NONE, "Publish every region", "none"},
                                       {REQUIRE_PERSON, "Publish persons only", "person"},
                                       {0, nullptr, nullptr}};
  static const GType type = g_enum_register_static("CerberusPersonVerifyRequire", kValues);
  return type;
}

enum { DETECTOR_HOG, DETECTOR_DAIMLER };

GType detector_type() {
  static const GEnumValue kValues[] = {
      {DETECTOR_HOG, "OpenCV's default people detector", "hog"},
      {DETECTOR_DAIMLER, "OpenCV's Daimler detector: more of small people, more that is none", "daimler"},
      {0, nullptr, nullptr}};
  static const GType type = g_enum_register_static("CerberusPersonVerifyDetector", kValues);
  return type;
}

struct Settings {
  double rate = 4, cpu = 0.25, threshold = 0, phase = 0;
  std::string model, config, labels, mean, scale;
  int require = REQUIRE_NONE, detector = DETECTOR_HOG;
};

const cerberus::plugin::Property<Settings> kProperties[] = {
    property("rate", &Settings::rate, 0.1, kMostRate,
             "Looks of the detector a second of running time, at most where the source is live"),
    property(
        "cpu", &Settings::cpu, 0.01, 1,
        "Where the source is live: share of the time for which the detector works, at most, whatever cores "
        "OpenCV uses meanwhile; a slow one looks less often than `rate`"),
    property("require", &Settings::require, require_type, "What is published"),
    property("threshold", &Settings::threshold, 0, 10,
             "Score from which on a hit is a person: lower finds more people and more things that are none; "
             "0 = 0.5 of hog, 1.5 of the Daimler detector, 0.55 of a model")
        .read_at_start(),
    property("detector", &Settings::detector, detector_type,
             "Which detector finds people where the property model names none")
        .read_at_start(),
    property(
        "model", &Settings::model,
        "File of a network that detects objects, run by OpenCV: ONNX (YOLO, SSD or NanoDet) or darknet's "
        ".weights; empty: none")
        .read_at_start(),
    property("config", &Settings::config,
             "Darknet's .cfg of a model that is .weights; empty: the one beside it, of the same name")
        .read_at_start(),
    property("labels", &Settings::labels,
             "File with the names of the model's classes, one a line, of which one is person; empty: person "
             "is the first class")
        .read_at_start(),
    property("mean", &Settings::mean,
             "Level (0 to 255) that is subtracted before the model sees it: one number, or three for its "
             "planes in their order (103.53,116.28,123.675); empty: 0, or what NanoDet takes")
        .read_at_start(),
    property("scale", &Settings::scale,
             "By which the difference is then multiplied, likewise; empty: 1/255 (0.00392), 1 of YOLOX, or "
             "what NanoDet takes")
        .read_at_start(),
    property("phase", &Settings::phase, 0, 1,
             "Share of the time between two looks by which the first one is put off: several cameras on one "
             "processor look "
             "in turn")
        .read_at_start(),
};

struct State {  // streaming thread only
  GstVideoInfo info;
  vision::LumaStretch stretch;
  vision::CameraFollower camera;
  GstClockTime running = GST_CLOCK_TIME_NONE;  // of the last frame
  vision::LookWorker worker;
  cerberus::plugin::PersonLooks looks;        // of this frame; a result stays until the next one is there
  guint number = 0;                           // of the last look
  GstClockTime looked = GST_CLOCK_TIME_NONE;  // time of the frame of the look in progress
  bool abandoned = false;                     // the worker's look is of another scene
  std::optional<bool> live;
  bool tracks = true;  // itself: no tracker downstream takes the looks
  vision::FrameHistory history{vision::FrameHistory::Parameters{.gap_seconds = kLongestGap}};
  GstClockTime last = GST_CLOCK_TIME_NONE, next_look = GST_CLOCK_TIME_NONE;
  bool asked = false;                        // by an onset, for a look at once
  GstClockTime extra = GST_CLOCK_TIME_NONE;  // the last look that was asked for
  cerberus::plugin::EvidenceRegions evidence;
  std::vector<CerberusRegion> before;               // regions of the frame
  bool foreign = false;                             // they are other elements'
  std::vector<cerberus::plugin::ForeignBox> boxes;  // likewise
  vision::DetectorUse use;                          // of the detector in the worker
  double threshold = 0;
  cerberus::plugin::Complaint caps, frame;
};

struct Private {
  cerberus::plugin::Adjustable<Settings> settings;
  std::atomic<bool> ask = true;  // downstream for a tracker; set by any thread
  cerberus::plugin::OnsetFlag onset;
  State state;
};

CERBERUS_DEFINE_TYPE(CerberusPersonVerify, cerberus_person_verify, GstBaseTransform, GST_TYPE_BASE_TRANSFORM,
                     Private)

// The result of a look in progress is of another scene. Live the next look begins once it is there; else at this frame.
void drop_look(State& state) {
  if (GST_CLOCK_TIME_IS_VALID(std::exchange(state.looked, GST_CLOCK_TIME_NONE))) {
    state.abandoned = state.live.value_or(true);
    if (!state.abandoned) state.worker.wait();
  }
  state.looks = {};
}

// Whether the worker has no look in progress.
bool is_idle(State& state) {
  if (GST_CLOCK_TIME_IS_VALID(state.looked) || (state.abandoned && !state.worker.is_done())) return false;
  if (std::exchange(state.abandoned, false)) state.worker.wait();
  return true;
}

void forget(State& state) {
  drop_look(state);
  state.evidence.reset();
  state.camera.forget();
  state.stretch.reset();
  state.last = state.next_look = state.extra = GST_CLOCK_TIME_NONE;
  state.asked = false;
}

// The next frame follows no other.
void begin_anew(State& state) {
  state.history.drop();
  forget(state);
}

// At the start, or by the first picture that shows it.
void refuse_model(GstBaseTransform* transform, const std::string& why) {
  CERBERUS_ELEMENT_ERROR(transform, RESOURCE, SETTINGS, (why), ("the property model cannot be used"));
}

cerberus::plugin::DetectorKind kind_of(const Settings& settings) {
  using Kind = cerberus::plugin::DetectorKind;
  if (!settings.model.empty()) return Kind::model;
  return settings.detector == DETECTOR_HOG ? Kind::hog : Kind::daimler;
}

double threshold_of(const Settings& settings) {
  return settings.threshold > 0 ? settings.threshold : cerberus::plugin::use_of(kind_of(settings)).threshold;
}

// nullptr: `wrong` says why.
auto make_detector(const Settings& settings, std::string& wrong) {
  return cerberus::plugin::make_whole_frame_detector(kind_of(settings),
                                                     {.model = cerberus::plugin::model_path(settings.model),
                                                      .config = settings.config,
                                                      .labels = settings.labels,
                                                      .mean = settings.mean,
                                                      .scale = settings.scale},
                                                     wrong, cerberus::plugin::kWholeFrameLines,
                                                     threshold_of(settings));
}

std::string settings_fault(GstElement* element) {
  std::string wrong;
  make_detector(cerberus_person_verify_self(element)->priv->settings.snapshot(), wrong);
  return wrong;
}

gboolean cerberus_person_verify_start(GstBaseTransform* transform) {
  return cerberus::guarded(transform, FALSE, [&]() -> gboolean {
    Private& priv = *cerberus_person_verify_self(transform)->priv;
    State& state = priv.state;
    state.caps.forget(), state.frame.forget();
    state.live.reset();
    const Settings settings = priv.settings.snapshot();
    state.use = cerberus::plugin::use_of(kind_of(settings));
    state.threshold = threshold_of(settings);
    std::string wrong;
    auto detector = make_detector(settings, wrong);
    if (!detector) {
      refuse_model(transform, wrong);
      return FALSE;
    }
    state.worker.start(std::move(detector));
    begin_anew(state);
    return TRUE;
  });
}

gboolean cerberus_person_verify_stop(GstBaseTransform* transform) {
  return cerberus::guarded(transform, FALSE, [&]() -> gboolean {
    State& state = cerberus_person_verify_self(transform)->priv->state;
    state.worker.stop();
    state.looked = GST_CLOCK_TIME_NONE;
    state.abandoned = false;
    return TRUE;
  });
}

gboolean cerberus_person_verify_set_caps(GstBaseTransform* transform, GstCaps* in, GstCaps*) {
  State& state = cerberus_person_verify_self(transform)->priv->state;
  return cerberus::guarded(transform, FALSE, [&]() -> gboolean {
    const bool known = gst_video_info_from_caps(&state.info, in);
    const std::string wrong = known ? "" : cerberus::kCapsIncomplete;
    if (state.caps.is_new(wrong))
      CERBERUS_ELEMENT_ERROR(transform, CORE, NEGOTIATION, (wrong), ("caps %" GST_PTR_FORMAT, in));
    if (!known) return FALSE;
    begin_anew(state);
    cerberus_person_verify_self(transform)->priv->ask = true;
    return TRUE;
  });
}

gboolean cerberus_person_verify_sink_event(GstBaseTransform* transform, GstEvent* event) {
  if (GST_EVENT_TYPE(event) == GST_EVENT_FLUSH_STOP)
    cerberus::guarded(transform, [&] { begin_anew(cerberus_person_verify_self(transform)->priv->state); });
  return GST_BASE_TRANSFORM_CLASS(cerberus_person_verify_parent_class())->sink_event(transform, event);
}

// What other elements have found.
void read_foreign(State& state, GstBuffer* buffer) {
  cerberus::plugin::read_foreign_boxes(
      buffer, {GST_VIDEO_INFO_WIDTH(&state.info), GST_VIDEO_INFO_HEIGHT(&state.info)}, state.boxes);
  for (const cerberus::plugin::ForeignBox& found : state.boxes) {
    CerberusRegion region;
    cerberus_region_init(&region);
    region.x = found.box.x, region.y = found.box.y;
    region.width = found.box.width, region.height = found.box.height;
    state.before.push_back(region);
  }
}

void read_regions(State& state, GstBuffer* buffer) {
  state.before.clear();
  state.foreign = !cerberus_buffer_regions_known(buffer);
  if (state.foreign) return read_foreign(state, buffer);
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(buffer);
  for (guint i = 0; i < regions->len; ++i)
    state.before.push_back(*static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i)));
}

void attach(State& state, GstBuffer* buffer, std::vector<CerberusRegion>& found, bool persons_only) {
  if (state.foreign && persons_only)
    while (GstMeta* meta = gst_buffer_get_meta(buffer, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE))
      if (!gst_buffer_remove_meta(buffer, meta)) break;
  if (state.foreign && found.empty()) return;
  if (state.foreign)
    for (CerberusRegion& region : found) region.motion = FALSE;
  g_autoptr(GPtrArray) array = cerberus::plugin::array_of(found);
  cerberus_buffer_set_regions(buffer, array);
}

// A look that is due ends: live where its result is there, else it is waited for. Returns why the detector cannot be
// used; nullopt: it can.
std::optional<std::string> end_look(State& state, GstClockTime now) {
  if (!GST_CLOCK_TIME_IS_VALID(state.looked)) return std::nullopt;
  if (state.live.value_or(true) ? !state.worker.is_done() : now < state.looked + kDelay) return std::nullopt;
  const GstClockTime looked = std::exchange(state.looked, GST_CLOCK_TIME_NONE);
  const std::vector<vision::PersonDetection>& found = state.worker.wait();
  if (const auto& refusal = state.worker.refusal()) return refusal;
  state.looks.ends = state.number;
  state.looks.encloses = state.use.encloses;
  state.looks.bodies.clear();
  for (const vision::PersonDetection& body : found) {
    GST_LOG("%" GST_TIME_FORMAT ": %.0f,%.0f %.0fx%.0f, score %.2f", GST_TIME_ARGS(looked), body.box.x,
            body.box.y, body.box.width, body.box.height, body.score);
    state.looks.bodies.push_back({body.box, vision::evidence_score(body.score, state.threshold, state.use)});
  }
  return std::nullopt;
}

// The next look, where one is due or asked for, at the mapped frame. One that is asked for comes on top of the others.
void begin_look(State& state, const vision::PictureSource& source, vision::Size size, GstClockTime now,
                const Settings& settings) {
  auto period = static_cast<GstClockTime>(GST_SECOND / settings.rate);
  if (!GST_CLOCK_TIME_IS_VALID(state.next_look))
    state.next_look = now + static_cast<GstClockTime>(settings.phase * static_cast<double>(period));
  const bool due = now >= state.next_look;
  if (GST_CLOCK_TIME_IS_VALID(state.extra) && now - state.extra < kExtraLooksApart) state.asked = false;
  if ((!due && !state.asked) || !is_idle(state)) return;
  state.asked = false;
  const auto taken = static_cast<double>(state.worker.duration().count());  // by the last one
  state.worker.picture().take(source, 0, 0, size, state.worker.sees_colours());
  state.worker.begin();
  state.looked = now;
  if (++state.number == 0) state.number = 1;
  state.looks.begins = state.number;
  if (!due) {
    state.extra = now;
    return;
  }
  if (state.live.value_or(true)) period = std::max(period, static_cast<GstClockTime>(taken / settings.cpu));
  // On the beat, unless a look took longer than that.
  state.next_look = (now - state.next_look > period / 2 ? now : state.next_look) + period;
}

// At the first frame after caps or RECONFIGURE: elements downstream have received the caps, up to the first queue.
void ask(GstBaseTransform* transform, Private& priv) {
  State& state = priv.state;
  if (!state.live) state.live = cerberus::plugin::is_live(GST_BASE_TRANSFORM_SINK_PAD(transform));
  if (!priv.ask.exchange(false)) return;
  const bool tracks = !cerberus::plugin::tracker_takes_looks(GST_BASE_TRANSFORM_SRC_PAD(transform));
  if (std::exchange(state.tracks, tracks) != tracks) forget(state);
}

GstFlowReturn cerberus_person_verify_transform_ip(GstBaseTransform* transform, GstBuffer* buffer) {
  return cerberus::guarded(transform, GST_FLOW_ERROR, [&]() -> GstFlowReturn {
    Private& priv = *cerberus_person_verify_self(transform)->priv;
    State& state = priv.state;
    const Settings settings = priv.settings.snapshot();
    ask(transform, priv);
    cerberus::VideoFrame frame(state.info, buffer, GST_MAP_READ);
    const std::string wrong = frame ? "" : "A frame cannot be read: its tracks are not verified.";
    if (state.frame.is_new(wrong))
      CERBERUS_ELEMENT_WARNING(transform, STREAM, FAILED, (wrong), ("%" GST_PTR_FORMAT, buffer));
    if (!frame) return GST_FLOW_OK;

    const GstClockTime stamp = cerberus::plugin::running_time_of(transform->segment, buffer);
    const auto time = cerberus::plugin::known_time(stamp);
    const bool confirmed =
        state.live == true && time &&
        vision::clock_confirms(*time, state.history.previous(), cerberus::plugin::clock_now(transform));
    const vision::FrameHistory::Step step = state.history.next(time, kUsualStep, false, confirmed);
    if (step.fresh) forget(state);
    const vision::Size size{GST_VIDEO_INFO_WIDTH(&state.info), GST_VIDEO_INFO_HEIGHT(&state.info)};
    using Link = vision::CameraFollower::Link;
    const vision::CameraFollower::Step camera =
        state.camera.next(cerberus::plugin::path_point(buffer), std::exchange(state.running, stamp), size);
    const bool cut = !step.fresh && (camera.link == Link::cut || camera.link == Link::lost);
    if (cut) drop_look(state);
    const double seconds = step.seconds > 0 ? step.seconds : kUsualStep;
    GstClockTime now = cerberus::plugin::clock_time(step.time);
    const bool known = GST_CLOCK_TIME_IS_VALID(now), before = GST_CLOCK_TIME_IS_VALID(state.last);
    if (before && (!known || now <= state.last)) now = state.last + cerberus::plugin::clock_time(seconds);
    if (!before && !known) now = 0;
    state.last = now;

    vision::PictureSource source = cerberus::picture_source(*frame.get());
    source.luma = state.stretch.stretched(source.luma);
    state.looks.begins = 0;
    state.looks.persons_only = settings.require == REQUIRE_PERSON;
    if (const auto refusal = end_look(state, now)) {
      refuse_model(transform, *refusal);
      return GST_FLOW_ERROR;
    }
    state.asked = priv.onset.take(state.live.value_or(true)) || state.asked;
    begin_look(state, source, size, now, settings);
    if (!state.tracks) {
      cerberus::plugin::set_person_looks(buffer, state.looks);
      return GST_FLOW_OK;
    }
    cerberus::plugin::EvidenceInput seen;
    seen.size = size;
    seen.luma = source.luma;
    seen.seconds = seconds;
    seen.fresh = step.fresh || cut;
    seen.motion = camera.motion;  // still where nothing upstream measures it
    if (const CerberusCameraMotion* measured = cerberus_buffer_peek_camera_motion(buffer))
      seen.calm = measured->calm;
    seen.zones = {buffer, stamp, size};
    read_regions(state, buffer);
    auto& found =
        state.evidence.update(seen, state.before, state.looks, state.looks.persons_only || state.foreign);
    frame.unmap();
    attach(state, buffer, found, state.looks.persons_only);
    return GST_FLOW_OK;
  });
}

// RECONFIGURE is sent, among others, when an element is linked downstream.
gboolean cerberus_person_verify_src_event(GstBaseTransform* transform, GstEvent* event) {
  if (GST_EVENT_TYPE(event) == GST_EVENT_RECONFIGURE)
    cerberus_person_verify_self(transform)->priv->ask = true;
  cerberus_person_verify_self(transform)->priv->onset.hear(event);
  return GST_BASE_TRANSFORM_CLASS(cerberus_person_verify_parent_class())->src_event(transform, event);
}

// The tracker behind judges itself what motion alone supports.
gboolean cerberus_person_verify_query(GstBaseTransform* transform, GstPadDirection direction,
                                      GstQuery* query) {
  if (direction == GST_PAD_SINK && cerberus::plugin::is_record_query(query))
    cerberus::plugin::add_wanted(query, cerberus::plugin::kAllTracks);
  return cerberus_person_verify_parent_class()->query(transform, direction, query);
}

void cerberus_person_verify_init(CerberusPersonVerify* self) {
  gst_video_info_init(&self->priv->state.info);
  gst_base_transform_set_in_place(GST_BASE_TRANSFORM(self), TRUE);
  gst_base_transform_set_passthrough(GST_BASE_TRANSFORM(self), FALSE);
}

void cerberus_person_verify_class_init(CerberusPersonVerifyClass* klass) {
  cerberus::plugin::install_properties<CerberusPersonVerify, kProperties>(G_OBJECT_CLASS(klass));
  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  gst_element_class_set_static_metadata(element, "Person verifier", "Filter/Analyzer/Video",
                                        "Follows people by what moves and by a people detector",
                                        "The Cerberus developers");
  gst_element_class_add_static_pad_template(element, &sink_template);
  gst_element_class_add_static_pad_template(element, &src_template);
  element->query = cerberus::settings_query<cerberus_person_verify_parent_class, settings_fault>;

  GstBaseTransformClass* transform = GST_BASE_TRANSFORM_CLASS(klass);
  transform->start = cerberus_person_verify_start;
  transform->stop = cerberus_person_verify_stop;
  transform->set_caps = cerberus_person_verify_set_caps;
  transform->query = cerberus_person_verify_query;
  transform->sink_event = cerberus_person_verify_sink_event;
  transform->src_event = cerberus_person_verify_src_event;
  transform->transform_ip = cerberus_person_verify_transform_ip;
}

}  // namespace

CERBERUS_REGISTER_ELEMENT(personverify, GST_RANK_NONE, cerberus_person_verify, personverify_debug,
                          "people confirmed by a detector")
