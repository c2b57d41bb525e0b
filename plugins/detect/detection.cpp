// SPDX-License-Identifier: LGPL-2.1-or-later
#include "detection.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

#include "cerberus/private/messages.hpp"
#include "shared/clock_times.hpp"
#include "shared/region_conversion.hpp"
#include "shared/video.hpp"
#include "vision/persons/body_boxes.h"
#include "vision/persons/detector_use.h"

GST_DEBUG_CATEGORY_STATIC(detection_debug);
#define GST_CAT_DEFAULT detection_debug

namespace cerberus::plugin {

using vision::Stage;

namespace {

// What is seen for so long is no motion.
constexpr GstClockTime kLongestConfirmTime = 3600 * GST_SECOND;

// With the flags of the record's query: the elements downstream are not asked.
constexpr guint kNothingFurther = 1u << 31;

// The upstream event of the element that learns what is burnt in, for the one that measures the camera. Its boxes are
// in pixels of an analysed picture of `width` x `height`.
constexpr char kBurntIn[] = "cerberus-burnt-in";

// Frames in a row without an orientation before a warning: a head reports its first pose within a second.
constexpr int kUnplaced = 50;
// Seconds without looks or boxes after which nothing looks any more. Chosen: several times as long as any detector pauses.
constexpr double kLongestWait = 30;
constexpr char kNoPlaces[] =
    "Polygons of the world in the property zones hide nothing: they need horizontal-fov and the head's pose, "
    "as pantiltsink and virtualptz report it, on each frame.";

vision::LumaSource source_of(vision::GrayView picture) {
  return {.data = picture.data, .width = picture.width, .height = picture.height, .stride = picture.stride};
}

bool same_box(const vision::Box& a, const vision::Box& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace

bool Detection::start() {
  GST_DEBUG_CATEGORY_INIT(detection_debug, "cerberusdetection", 0, "the stages of detection");
  State& state = state_.emplace();
  carrier_.forget();
  looks_promised_ = false;
  {
    const std::lock_guard lock(burnt_in_lock_);
    burnt_in_ = {};
  }
  watch_.begin(GST_ELEMENT(base));
  refresh();
  // Zones that cannot be read stop the start; a typo while playing keeps the zones that were there.
  state.zones = snapshot().zones;
  const std::string wrong = read_zones(state.zones);
  if (!wrong.empty())
    CERBERUS_ELEMENT_ERROR(base, RESOURCE, SETTINGS, (wrong), ("the property zones cannot be used"));
  return wrong.empty();
}

void Detection::stop() {
  end_of_stream();
  state_.reset();
}

void Detection::end_of_stream() {
  watch_.end();
}

void Detection::upstream_event(GstEvent* event) {
  if (!measures_camera()) return;
  carrier_.hear(event, snapshot().head);
  const GstStructure* structure = gst_event_get_structure(event);
  if (!structure || !gst_structure_has_name(structure, kBurntIn)) return;
  g_autoptr(GBytes) bytes = nullptr;
  vision::Size size;
  gst_structure_get(structure, "boxes", G_TYPE_BYTES, &bytes, "width", G_TYPE_INT, &size.width, "height",
                    G_TYPE_INT, &size.height, nullptr);
  const std::lock_guard lock(burnt_in_lock_);
  burnt_in_size_ = size;
  burnt_in_.count = std::min(bytes ? g_bytes_get_size(bytes) / sizeof(vision::Box) : 0, burnt_in_.box.size());
  if (burnt_in_.count)
    std::memcpy(burnt_in_.box.data(), g_bytes_get_data(bytes, nullptr),
                burnt_in_.count * sizeof(vision::Box));
}

// What this element wants of records from upstream.
guint Detection::wants(const DetectSettings& s) const {
  if (measures_camera()) return kNothingFurther;  // it makes its own
  if (has(Stage::foreground))
    return s.area == static_cast<int>(vision::Area::all) ? 0u : guint{kRecordForReaders};
  if (has(Stage::tracks)) return kRecordForTracks;
  if (!has(Stage::regions) || s.keep_planes == KEEP_PLANES_AUTO) return 0;
  return kNothingFurther | (s.keep_planes == KEEP_PLANES_ALWAYS ? guint{kRecordForReaders} : 0u);
}

// From any thread.
bool Detection::answer(GstQuery* query) {
  const guint wanted = answer_.give(wants(snapshot()));
  add_wanted(query, wanted & ~kNothingFurther);
  return wanted & kNothingFurther;
}

// Returns what is wrong with them; then those that were there stay.
std::string Detection::read_zones(const std::string& text) {
  std::string wrong = state_->detector.zones().parse(text);
  if (!wrong.empty()) return wrong;
  const auto zones = std::make_shared<vision::Zones>();
  zones->parse(text);
  state_->zones_read = zones->everywhere() ? nullptr : zones;
  return wrong;
}

void Detection::apply(const DetectSettings& settings) {
  State& state = *state_;
  state.settings = settings;
  state.options = detector_options(settings, cerberus_analysis_width(base));
  if (!has(Stage::regions)) state.options.size = {};  // the limits of another element
  state.judge = true;
  if (answer_.outdated_by(wants(settings))) cerberus_analysis_answer_anew(base);
  if (settings.zones != state.zones) {
    state.zones = settings.zones;
    if (const std::string wrong = read_zones(state.zones); !wrong.empty())
      CERBERUS_ELEMENT_WARNING(base, RESOURCE, SETTINGS, (wrong), ("the zones that were there stay"));
  }
  if (has(Stage::camera)) carrier_.begin_comparison();
  if (has(Stage::tracks)) state.no_tracks.tell(GST_ELEMENT(base), why_no_tracks());
}

// A record that this element may write. None: the buffer does not hold the picture that its caps promise.
vision::Record Detection::obtain(const Frame& frame, bool regions_known) {
  vision::Detector& detector = state_->detector;
  vision::Record record;
  if (!measures_camera()) record = record_of(frame.buffer, frame.size);
  set_record(frame.buffer, {});
  if (record) return record.is_sole() && !record->has(last_) ? record : detector.copy(*record, last_);
  if (regions_known) return detector.blank(frame.size);
  const VideoFrame mapped(*frame.info, frame.buffer, GST_MAP_READ);
  return mapped ? detector.begin(luma_source(*mapped.get()), frame.fresh) : record;
}

Analyser::Outcome Detection::analyse(Frame& frame) {
  State& state = *state_;
  const auto changed = changes();
  if (changed) apply(*changed);
  if (const int width = cerberus_analysis_width(base); changed || width != state.options.analysis_width) {
    state.options.analysis_width = width;
    state.detector.set_options(state.options);
  }
  const bool known =
      !has(Stage::regions) && has(Stage::tracks) && cerberus_buffer_regions_known(frame.buffer);
  const bool first = measures_camera() || !record_of(frame.buffer, frame.size);
  const vision::Record record = obtain(frame, known);
  if (!record) return Outcome::unusable;
  if (first && !known && state.detector.repeats(*record, frame, frame.repeatable)) return Outcome::repeats;

  bool keep = true;
  frame.everything = (frame.wanted & kRecordForReaders) != 0;
  state.boxes_taken = false;
  read_looks(frame, step_of(frame));
  if (has(Stage::regions)) {
    const int how = state.settings.keep_planes;
    frame.everything = how == KEEP_PLANES_ALWAYS || (how == KEEP_PLANES_AUTO && frame.everything);
    keep = frame.everything || (last_ == Stage::regions && (frame.wanted & kRecordForTracks));
  }
  vision::BurntInBoxes burnt_in;
  if (has(Stage::camera)) {
    {
      const std::lock_guard lock(burnt_in_lock_);
      if (burnt_in_size_ == (*record->luma)->size()) burnt_in = burnt_in_;
    }
    frame.burnt_in = burnt_in.boxes();
    measure_camera(*record, frame);
  }
  if (!known) state.detector.complete(*record, frame, last_);
  publish_threshold(frame.buffer, *record);
  if (last_ == Stage::regions) publish_regions(frame.buffer, *record);
  if (has(Stage::regions)) judge_regions(frame.size, record->mask().size());
  if (has(Stage::tracks)) {
    if (known) read_regions(frame.buffer);
    state.detector.track(*record, frame, known ? state.found : record->regions->regions);
    state.calm = record->camera ? std::optional(record->camera->calm) : std::nullopt;
    publish_calm(frame.buffer);
    publish_tracks(frame, *record);
    complain_of_scene(frame.seconds);
    keep = record->regions && record->regions->labels;  // made only for readers downstream
  }
  state.repeated = 0;
  state.shown = frame.running_time;
  if (keep) set_record(frame.buffer, record);
  return Outcome::analysed;
}

// The stages learn nothing from a repeated picture: the next new one is compared with the last.
void Detection::repeat(Frame& frame) {
  State& state = *state_;
  if (has(Stage::camera) && state.motion.scene_age > 0) {
    CerberusCameraMotion motion = state.motion;  // at the end of the same path, which it does not extend
    const vision::Transform none;
    std::copy(none.m.begin(), none.m.end(), std::begin(motion.matrix));
    motion.from = state.shown;
    motion.still = TRUE;
    motion.scene_age = std::max(motion.scene_age, 2u);
    cerberus_buffer_set_camera_motion(frame.buffer, &motion);
  }
  if (has(Stage::camera)) carrier_.repeat(frame);
  state.shown = frame.running_time;
  if (state.facts) set_threshold_facts(frame.buffer, *state.facts);
  if (last_ < Stage::regions) return;
  const double step = std::max(frame.seconds - state.repeated, 0.0);
  state.repeated = frame.seconds;
  std::erase_if(state.moving, [&](const CerberusRegion& region) {
    return !vision::outlasts(static_cast<vision::TrackState>(region.state), frame.seconds,
                             state.options.tracks);
  });
  if (has(Stage::tracks)) {
    publish_calm(frame.buffer);
    for (CerberusRegion& region : state.moving) region.age += clock_time(step);
    if (state.judged) read_looks(frame, step);  // there is a picture that persons are followed in
  }
  publish(frame, {}, step);
}

// The camera's motion is on the frame already; how calm the scene is the tracker alone knows.
void Detection::publish_calm(GstBuffer* buffer) const {
  const CerberusCameraMotion* attached = cerberus_buffer_peek_camera_motion(buffer);
  if (!attached || !state_->calm) return;
  CerberusCameraMotion motion = *attached;
  motion.calm = *state_->calm;
  cerberus_buffer_set_camera_motion(buffer, &motion);
}

// Once a stream, and only after tracks have been withheld for a second: shorter gaps are hardly seen.
void Detection::complain_of_scene(double seconds) {
  constexpr double kLong = 1;
  State& state = *state_;
  if (!state.detector.withholds_tracks() || state.withheld > kLong) return;
  state.withheld += seconds;
  if (state.withheld <= kLong) return;
  CERBERUS_ELEMENT_INFO(
      base, STREAM, FAILED,
      ("Much of the scene moves in ways that a turn of the camera does not explain: the "
       "picture blurs or shakes, or "
       "the camera drives past what is near. Only what clearly moves by itself is found "
       "there. To find people there, put `personverify`, or another person detector, in front."),
      ("tracks without more motion inside than around them are left out"));
}

void Detection::watch(const Frame& frame, double step) {
  State& state = *state_;
  state.stamps.mark(GST_BASE_TRANSFORM_SINK_PAD(base), frame.buffer, frame.running_time,
                    state.settings.camera_name);
  watch_.frame(state.published, state.stamps.at(frame.running_time), time_of(clock_time(step)),
               time_of(state.settings.hold_time), frame.live);
}

void Detection::measure_camera(vision::Analysis& record, Frame& frame) {
  State& state = *state_;
  const auto prior =
      carrier_.look(GST_ELEMENT(base), frame, state.settings.head, state.options.field_of_view);
  Frame seen = frame;  // the head goes on through a cut of the picture
  state.detector.measure_camera(record, frame, prior);

  const vision::CameraMotionResult& result = *record.camera;
  CerberusCameraMotion motion;
  cerberus_camera_motion_init(&motion);
  std::copy(result.transform.m.begin(), result.transform.m.end(), std::begin(motion.matrix));
  motion.from = result.scene_age > 1 ? frame.previous : GST_CLOCK_TIME_NONE;
  motion.confidence = result.confidence;
  motion.residual = result.residual;
  motion.still = result.still;
  motion.scene_age = static_cast<guint>(std::max(result.scene_age, 1));
  vision::CameraPathPoint point = path_point(motion);
  state.path.extend(point, frame.size);
  std::copy(point.path.m.begin(), point.path.m.end(), std::begin(motion.path));
  motion.path_id = point.path_id;
  state.motion = motion;
  cerberus_buffer_set_camera_motion(frame.buffer, &motion);
  GST_LOG_OBJECT(base, "scene age %u, still %d, confidence %.2f, shift %.2f %.2f", motion.scene_age,
                 motion.still, motion.confidence, motion.matrix[2], motion.matrix[5]);
  carrier_.compare(GST_ELEMENT(base), seen, state.options.field_of_view, result.transform,
                   result.scene_age > 1 ? result.confidence : 0);
}

void Detection::publish_threshold(GstBuffer* buffer, const vision::Analysis& record) {
  if (!record.foreground || last_ < Stage::foreground) return;
  ThresholdFacts facts{record.foreground->result, record.foreground->chosen_with};
  facts.gain = record.differences->result.gain;
  facts.offset = record.differences->result.offset;
  set_threshold_facts(buffer, facts);
  state_->facts = facts;
  if (has(Stage::foreground)) publish_burnt_in(record);
}

void Detection::publish_burnt_in(const vision::Analysis& record) {
  const vision::BurntInBoxes found = record.foreground->burnt_in.value_or(vision::BurntInBoxes{});
  const vision::Size size = (*record.luma)->size();
  if (const std::string text = new_boxes(found, size, record.frame); !text.empty())
    CERBERUS_ELEMENT_INFO(
        base, STREAM, DECODE,
        ("The camera writes into its pictures; left out: %s (frame pixels, width x height + left + top).",
         text.c_str()),
        ("burnt-in=false turns this off"));
  if (has(Stage::camera)) return;
  auto& sent = state_->sent_burnt_in;
  const auto boxes = found.boxes();
  if (sent && std::ranges::equal(boxes, *sent, same_box)) return;
  sent.emplace(boxes.begin(), boxes.end());
  g_autoptr(GBytes) bytes = g_bytes_new(boxes.data(), boxes.size_bytes());
  gst_pad_push_event(
      GST_BASE_TRANSFORM_SINK_PAD(base),
      gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM,
                           gst_structure_new(kBurntIn, "boxes", G_TYPE_BYTES, bytes, "width", G_TYPE_INT,
                                             size.width, "height", G_TYPE_INT, size.height, nullptr)));
}

void Detection::attach_published(GstBuffer* buffer) {
  g_autoptr(GPtrArray) regions = array_of(state_->published);
  cerberus_buffer_set_regions(buffer, regions);
}

void Detection::publish_regions(GstBuffer* buffer, const vision::Analysis& record) {
  state_->moving.clear();
  for (const vision::Region& region : record.regions->regions) {
    const auto number = static_cast<guint>(state_->moving.size());
    state_->moving.push_back(region_of(region));
    state_->moving.back().id = number;
  }
  state_->published = state_->moving;
  set_frame_zones(buffer, {state_->zones_read, state_->options.field_of_view});
  attach_published(buffer);
}

// The tracks of what moves are for an element downstream that judges them, or are judged here, where a person detector
// looks on.
void Detection::read_looks(Frame& frame, double step) {
  State& state = *state_;
  const bool judged_downstream = (frame.wanted & kAllTracks) != 0;
  frame.persons = judged_downstream;
  state.judges = false;
  if (judged_downstream || !has(Stage::tracks)) return;
  const PersonLooks* looks = person_looks_of(frame.buffer);
  complain_of_lost_looks(looks_promised_ && !looks);
  state.since_looks += step;
  if (looks) {
    state.looks = *looks;
    state.has_looks = true;
    state.since_looks = 0;
  } else {
    read_boxes(frame, step);
  }
  if (state.since_looks > kLongestWait) forget_looks();
  state.judges = frame.persons = state.has_looks;
}

// What has been seen is of another stream, or too long ago: what moves is published as if nothing had ever looked.
void Detection::forget_looks() {
  State& state = *state_;
  state.has_looks = false;
  state.look_times.reset();
  state.since_looks = 0;
}

void Detection::flush(bool begins) {
  watch_.flush(begins);
  if (!begins && state_) forget_looks();
}

void Detection::new_caps() {
  if (state_) forget_looks();
}

bool Detection::take_looks() {
  if (!has(Stage::tracks)) return false;
  looks_promised_ = true;
  return true;
}

// Once a stream.
void Detection::complain_of_lost_looks(bool lost) {
  State& state = *state_;
  if (state.frames_unlooked > kUnplaced) return;
  state.frames_unlooked = lost ? state.frames_unlooked + 1 : 0;
  if (state.frames_unlooked <= kUnplaced) return;
  CERBERUS_ELEMENT_WARNING(base, STREAM, FAILED,
                           ("What personverify in front sees does not arrive here: an element in between "
                            "crops the picture or makes frames of its own. "
                            "Only what moves is found, and require=person does not count. Crop in front of "
                            "personverify, or put personverify "
                            "behind this element."),
                           (nullptr));
}

// Once a stream: a detector of many classes has found a person by then, or another kind of objects is there.
void Detection::complain_of_labels(bool person) {
  constexpr int kMany = 10;  // frames with boxes
  State& state = *state_;
  if (person) state.strange_boxes = kMany;
  if (state.strange_boxes == kMany || ++state.strange_boxes < kMany) return;
  std::string persons;
  for (const char* label : kPersonLabels) persons += (persons.empty() ? "" : ", ") + std::string(label);
  CERBERUS_ELEMENT_INFO(base, STREAM, FAILED,
                        ("Another element finds objects labelled \"%s\", which are no persons here and do "
                         "not count. If they are persons, name "
                         "them so in that element's list of labels: %s.",
                         state.boxes.front().label, persons.c_str()),
                        (nullptr));
}

// Boxes of persons that other elements have found are the result of a look at this frame. A copy of a frame, as videorate makes
// it, has the same boxes once more.
void Detection::read_boxes(const Frame& frame, double step) {
  State& state = *state_;
  if (frame.fresh) state.look_times.reset();  // how long the break was says nothing of the detector
  state.looks.begins = state.looks.ends = 0;
  state.looks.bodies.clear();
  state.looks.encloses = vision::kNetworkUse.encloses;
  state.looks.of_this_frame = false;
  if (state.boxes_taken) return state.look_times.pass(step);
  read_foreign_boxes(frame.buffer, frame.size, state.boxes);
  for (const ForeignBox& found : state.boxes)
    if (found.person)
      state.looks.bodies.push_back(
          {found.box,
           vision::evidence_score(found.confidence, vision::kNetworkUse.threshold, vision::kNetworkUse)});
  state.looks.of_this_frame = state.look_times.is_look(step, !state.looks.bodies.empty());
  state.has_looks = state.has_looks || state.looks.of_this_frame;
  if (!state.boxes.empty()) {
    state.boxes_taken = true;
    state.since_looks = 0;
    complain_of_labels(!state.looks.bodies.empty());
  }
  vision::hits_to_bodies(state.looks.bodies, {});
}

// Seconds since the last frame, repeated or not; 0: it follows none.
double Detection::step_of(const Frame& frame) const {
  return frame.seconds > 0 ? std::max(frame.seconds - state_->repeated, 1e-9) : 0;
}

void Detection::publish_tracks(const Frame& frame, const vision::Analysis& record) {
  State& state = *state_;
  state.moving.clear();
  for (const vision::Track& track : *record.tracks) state.moving.push_back(tracked(track));
  const double step = step_of(frame);
  if (record.luma) return publish(frame, source_of((*record.luma)->view()), step);
  if (!state.judges) return publish(frame, {}, step);
  const VideoFrame mapped(*frame.info, frame.buffer, GST_MAP_READ);
  if (frame.fresh) state.stretch.reset();
  publish(frame, mapped ? state.stretch.stretched(luma_source(*mapped.get())) : vision::LumaSource{}, step);
}

// luma: the picture, without data: that of the frame before. step: seconds since the frame before.
void Detection::publish(const Frame& frame, const vision::LumaSource& luma, double step) {
  State& state = *state_;
  if (has(Stage::regions)) set_frame_zones(frame.buffer, {state.zones_read, state.options.field_of_view});
  if (state.judges) {
    EvidenceInput seen;
    seen.size = frame.size, seen.luma = luma, seen.seconds = step;
    seen.fresh = frame.fresh, seen.motion = frame.motion;
    if (const auto* camera = cerberus_buffer_peek_camera_motion(frame.buffer)) seen.calm = camera->calm;
    seen.zones = {frame.buffer, frame.running_time, frame.size};
    // The detector looks for the first time, amid a scene: what has been published goes on, with its identities.
    if (!state.judged && !frame.fresh) {
      state.evidence.end_looks();
      state.evidence.update(seen, state.moving, {}, false);
      seen.seconds = 0;
      seen.motion = {};
    }
    state.published = state.evidence.update(seen, state.moving, state.looks, state.looks.persons_only);
  } else {
    state.published = state.moving;
    if (has(Stage::tracks)) state.evidence.publish_alone(state.published);
  }
  state.judged = state.judges;
  attach_published(frame.buffer);
  if (has(Stage::tracks)) watch(frame, step);
}

void Detection::read_regions(GstBuffer* buffer) {
  state_->found.clear();
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(buffer);
  for (guint i = 0; i < regions->len; ++i) {
    const auto* region = static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i));
    vision::Region& r = state_->found.emplace_back();
    r.box = {region->x, region->y, region->width, region->height};
    r.confidence = region->confidence;
    r.kind = static_cast<vision::RegionKind>(region->kind);
  }
}

std::string Detection::why_no_regions(vision::Size frame, vision::Size mask) {
  if (state_->nowhere)
    return "The property zones leaves no part of the picture: nothing can be found. Make what it includes "
           "larger, or what it excludes smaller.";
  const vision::SizeLimits& limits = state_->options.size;
  std::string why = contradiction("width", limits.width, frame.width);
  if (why.empty()) why = contradiction("height", limits.height, frame.height);
  if (why.empty())
    why = contradiction("area", {state_->settings.minimum_area, 0}, 1.0 * mask.width * mask.height);
  if (state_->settings.horizontal_fov <= 0) return why;
  if (why.empty()) why = contradiction("width-metres", limits.metres_wide);
  if (why.empty()) why = contradiction("height-metres", limits.metres_high);
  return why;
}

void Detection::judge_regions(vision::Size frame, vision::Size mask) {
  State& state = *state_;
  state.unplaced = state.detector.zones_unplaced() ? std::min(state.unplaced + 1, kUnplaced + 1) : 0;
  if (state.unplaced == kUnplaced) state.no_places.tell(GST_ELEMENT(base), kNoPlaces);
  const bool nowhere = state.detector.zones().nowhere();
  if (!state.judge && frame == state.frame && mask == state.mask && nowhere == state.nowhere) return;
  state.judge = false;
  state.frame = frame;
  state.mask = mask;
  state.nowhere = nowhere;
  state.no_regions.tell(GST_ELEMENT(base), why_no_regions(frame, mask));
}

std::string Detection::why_no_tracks() const {
  const DetectSettings& s = state_->settings;
  if (s.confirm_time > kLongestConfirmTime)
    return "confirm-time is longer than an hour: nothing can be found. Make it shorter.";
  // The lower limit is for the highest speed ever, the upper one for the speed now.
  constexpr char kResult[] = "only who was as fast once and is slower now is found";
  std::string why = contradiction("speed", state_->options.speed.pixels, 0, kResult);
  if (why.empty() && s.horizontal_fov > 0)
    why = contradiction("speed-metres", state_->options.speed.metres, 0, kResult);
  return why;
}

}  // namespace cerberus::plugin
