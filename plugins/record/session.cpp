// SPDX-License-Identifier: LGPL-2.1-or-later
#include "session.hpp"

#include <algorithm>
#include <utility>

#include "shared/clock_times.hpp"

namespace cerberus::plugin {

namespace {

// A start waits for the disk as long as a stop does, within these limits. At least: chosen, several times what opening a
// large index takes. At most: it goes on anyway, and an application starts its pipelines in its main loop; derived from
// cerberusd, whose cameras are stalled after 15 s and whose watchdog takes 30 s. Guarded by the tests of a disk that does
// not answer at the start.
constexpr std::chrono::nanoseconds kShortestStart = std::chrono::seconds(2);
constexpr std::chrono::nanoseconds kLongestStart = std::chrono::seconds(5);

// How long a stop waits for the disk. An unlimited `stop-timeout` is a day.
std::chrono::nanoseconds longest_wait(const RecorderSettings& settings) {
  return time_of(std::min<guint64>(settings.stop_timeout, 24 * 3600 * GST_SECOND));
}

// A stream that is not live waits while more bytes than this wait for the disk.
constexpr guint64 kPatience = 16 << 20;
// Where times fall back by more than this the stream has begun anew. Derived: above every reordering of frames.
constexpr record::Time kBroken = record::Parameters{}.most_reordering;

// The buffer as a unit, with running times. False where it has none.
bool read_unit(const Input& input, GstBuffer* buffer, record::Unit& unit) {
  const auto running = [&](GstClockTime time) -> std::optional<record::Time> {
    if (!GST_CLOCK_TIME_IS_VALID(time) || input.segment.format != GST_FORMAT_TIME) return std::nullopt;
    guint64 result = 0;
    const int sign = gst_segment_to_running_time_full(&input.segment, GST_FORMAT_TIME, time, &result);
    if (sign == 0) return std::nullopt;
    return sign * time_of(result);
  };
  const auto presented = running(GST_BUFFER_PTS(buffer)), decoded = running(GST_BUFFER_DTS(buffer));
  if (!presented && !decoded) return false;
  unit.presentation = presented ? *presented : *decoded;
  unit.decode = decoded ? *decoded : *presented;
  unit.bytes = gst_buffer_get_size(buffer);
  unit.format = input.format;
  unit.keyframe = !GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DELTA_UNIT);
  unit.payload = record::Payload(gst_buffer_ref(buffer),
                                 [](void* payload) { gst_buffer_unref(static_cast<GstBuffer*>(payload)); });
  return true;
}

void forget_stream(Input& input) {
  input.eos = false;
  input.decode.reset();
  input.filler.reset();
  gst_segment_init(&input.segment, GST_FORMAT_UNDEFINED);
}

}  // namespace

Input& Session::add_input(GstPad* pad, int track) {
  auto input = std::make_unique<Input>();
  input->pad = pad;
  input->track = track;
  forget_stream(*input);
  const std::lock_guard guard(lock_);
  inputs_.push_back(std::move(input));
  return *inputs_.back();
}

void Session::remove_input(GstPad* pad) {
  const std::lock_guard guard(lock_);
  const auto found = std::ranges::find(inputs_, pad, [](const auto& input) { return input->pad; });
  if (found == inputs_.end()) return;
  if ((*found)->track == kAnalysisTrack)
    recorder_.end_analysis();
  else
    recorder_.set_audio_format((*found)->track, -1);
  inputs_.erase(found);
}

int Session::next_audio_track() {
  const std::lock_guard guard(lock_);
  return tracks_++;
}

// Also once the analysis has ended: the metadata that the encoded video carries is the same.
bool Session::has_analysis() const {
  for (const auto& input : inputs_)
    if (input->track == kAnalysisTrack && gst_pad_is_linked(input->pad)) return true;
  return false;
}

// The settings that may change while the element runs. Under the lock. Returns what is wrong with them, to be posted
// without it.
std::string Session::apply_settings() {
  const auto changed = settings_.changes();
  if (!changed) return {};
  recorder_.configure(event_settings(*changed));
  triggers_.track = changed->trigger_track;
  triggers_.fusion = changed->trigger_fusion;
  triggers_.pir = changed->trigger_pir;
  camera_name_ = changed->camera_name;
  field_of_view_ = changed->field_of_view;
  wanted_ = {changed->json_lines, changed->picture};
  files_.configure(file_settings(*changed));
  writer_.set_limits(archive_settings(*changed).limits);
  if (changed->trigger_zones == zones_) return {};
  zones_ = changed->trigger_zones;
  const std::string fault = triggers_.zones.parse(zones_);
  return fault.empty() ? fault : "trigger-" + fault + "; the zones of before stay";
}

// Under the lock.
void Session::apply(const Trigger& trigger, record::Time time) {
  using Kind = Trigger::Kind;
  if (trigger.kind == Kind::hold)
    recorder_.start(time, trigger.reason, record::Holder::motion);
  else if (trigger.kind == Kind::release)
    recorder_.stop(time, record::Holder::motion);
  else if (trigger.kind == Kind::moment || recorder_.active())
    recorder_.trigger(time, trigger.reason);
}

std::string Session::begin(Writer::Report report, Writer::Warn warn) {
  const RecorderSettings settings = settings_.snapshot();
  live_.reset();
  warn_ = warn;
  std::string fault = writer_.start(archive_settings(settings), report, warn,
                                    std::clamp(longest_wait(settings), kShortestStart, kLongestStart));
  const std::lock_guard guard(lock_);
  settings_.refresh();
  apply_settings();
  triggers_.camera.reset();
  unplaced_reported_ = false;
  for (const auto& input : inputs_) {
    input->notes.reset();
    input->stamps.reset();
    input->untimed_reported = false;
  }
  if (has_analysis()) recorder_.expect_analysis();
  return fault;
}

// Also without EOS the files are complete: Ctrl-C of gst-launch.
void Session::end() {
  {
    const std::lock_guard guard(lock_);
    recorder_.end_analysis();
    recorder_.finish();
    recorder_.reset();
    files_.journal().reset();
    for (auto& input : inputs_) forget_stream(*input);
  }
  writer_.stop(longest_wait(settings_.snapshot()));
  warn_ = nullptr;
  const std::lock_guard guard(lock_);
  files_.forget();
}

bool Session::set_caps(Input& input, GstCaps* caps) {
  const std::lock_guard guard(lock_);
  gint frames = 0, seconds = 0;
  const bool has_rate =
      gst_structure_get_fraction(gst_caps_get_structure(caps, 0), "framerate", &frames, &seconds) &&
      frames > 0 && seconds > 0;
  input.filler.set_distance(has_rate ? std::optional(record::Time(static_cast<gint64>(
                                           gst_util_uint64_scale_int(GST_SECOND, seconds, frames))))
                                     : std::nullopt);
  if (input.track <= 0) {
    input.notes.set_caps(caps);
    if (input.track == kAnalysisTrack || !has_analysis()) triggers_.frame = input.notes.size();
    if (input.track == kAnalysisTrack) return true;
    if (input.notes.size().width <= 0) return false;
  }
  input.format = files_.format_of(caps);
  if (input.track > 0) recorder_.set_audio_format(input.track, input.format);
  return true;
}

void Session::set_segment(Input& input, GstEvent* event) {
  const std::lock_guard guard(lock_);
  gst_event_copy_segment(event, &input.segment);
}

void Session::begin_stream(Input& input) {
  const std::lock_guard guard(lock_);
  input.eos = false;
}

// The video's times begin anew. Under the lock.
void Session::restart() {
  recorder_.reset();
  files_.journal().reset();
}

void Session::flush(Input& input) {
  const std::lock_guard guard(lock_);
  forget_stream(input);
  if (input.track == 0) restart();
}

void Session::gap(Input& input, GstEvent* event) {
  if (input.track != kAnalysisTrack) return;
  GstClockTime time = GST_CLOCK_TIME_NONE;
  gst_event_parse_gap(event, &time, nullptr);
  const std::lock_guard guard(lock_);
  const GstClockTime running = gst_segment_to_running_time(&input.segment, GST_FORMAT_TIME, time);
  if (!GST_CLOCK_TIME_IS_VALID(running)) return;
  recorder_.analysed(time_of(running));
  advance_journal();
}

void Session::add_note(Input& input, GstBuffer* buffer, const CerberusStamp& stamp, record::Time time) {
  if (auto note = input.notes.note(buffer, stamp, time, files_.journal(), wanted_))
    files_.journal().add(std::move(*note));
}

void Session::advance_journal() {
  files_.journal().advance(recorder_.reached(), recorder_.oldest());
}

// The trigger on a frame, whose tracks stand where the camera looks at that time. Under the lock.
std::optional<Trigger> Session::trigger_at(GstBuffer* buffer, record::Time time) {
  if (triggers_.zones.need_orientation())
    triggers_.camera =
        camera_of(buffer, clock_time(std::max(time, record::Time::zero())), triggers_.frame, field_of_view_);
  return trigger_of(buffer, triggers_);
}

// Once, when an object was seen and zones of the world have no place. Under the lock.
std::string Session::unplaced_fault() {
  if (unplaced_reported_ || triggers_.camera || !triggers_.zones.need_orientation() || !recorder_.active())
    return {};
  unplaced_reported_ = true;
  return "Polygons of the world in trigger-zones hide nothing: they need horizontal-fov and the head's pose "
         "on "
         "each frame.";
}

bool Session::add_video(Input& input, GstBuffer* buffer) {
  record::Unit unit;
  if (!read_unit(input, buffer, unit)) return false;
  files_.set_patient(!live_.value_or(true));
  if (input.decode && unit.decode < *input.decode - kBroken) {
    GST_WARNING_OBJECT(input.pad, "times fall back: the stream begins anew");
    restart();
  } else if (input.decode) {
    unit.decode = std::max(unit.decode, *input.decode);
  }
  input.decode = unit.decode;
  const record::Time time = unit.presentation;
  const CerberusStamp stamp = files_.stamps().frame(
      input.pad, buffer, clock_time(std::max(time, record::Time::zero())), camera_name_);
  recorder_.push_video(std::move(unit));
  if (!has_analysis()) {
    add_note(input, buffer, stamp, time);
    if (const auto trigger = trigger_at(buffer, time)) apply(*trigger, time);
  }
  advance_journal();
  return true;
}

bool Session::add_audio(Input& input, GstBuffer* buffer) {
  record::Unit unit;
  if (!read_unit(input, buffer, unit)) return false;
  unit.keyframe = true;
  recorder_.push_audio(input.track, std::move(unit));
  return true;
}

bool Session::add_analysis(Input& input, GstBuffer* buffer) {
  if (input.segment.format != GST_FORMAT_TIME) return false;
  const GstClockTime time = running_time_of(input.segment, buffer);
  if (!GST_CLOCK_TIME_IS_VALID(time)) return true;  // outside of the segment: it is not shown
  const CerberusStamp stamp = input.stamps.frame(input.pad, buffer, time, camera_name_);
  add_note(input, buffer, stamp, time_of(time));
  if (const auto trigger = trigger_at(buffer, time_of(time))) apply(*trigger, time_of(time));
  recorder_.analysed(time_of(time));
  advance_journal();
  return true;
}

// The buffer, with a time: itself, a copy that has one, or nullptr where nothing tells it. Under the lock.
GstBuffer* Session::timed(Input& input, GstBuffer* buffer, bool& hopeless) {
  record::TimeFiller::Times times{known_time(GST_BUFFER_PTS(buffer)), known_time(GST_BUFFER_DTS(buffer)),
                                  known_time(GST_BUFFER_DURATION(buffer))};
  if (input.track == kAnalysisTrack) times.decode.reset();  // raw pictures are matched by when they are shown
  using Result = record::TimeFiller::Result;
  const Result result = input.filler.fill(times);
  if (result == Result::timed) return gst_buffer_ref(buffer);
  hopeless = result == Result::hopeless;
  if (result != Result::placed) return nullptr;
  GstBuffer* copy = gst_buffer_copy(buffer);
  GST_BUFFER_PTS(copy) = clock_time(times.presentation ? times.presentation : times.decode);
  GST_BUFFER_DTS(copy) = clock_time(times.decode);
  return copy;
}

bool Session::add(Input& input, GstBuffer* buffer) {
  if (input.track == 0 && !live_) live_ = is_live(input.pad);
  std::string fault, untimed;
  const bool added = [&] {
    const std::lock_guard guard(lock_);
    bool hopeless = false;
    const std::unique_ptr<GstBuffer, void (*)(GstBuffer*)> with_time(
        timed(input, buffer, hopeless), [](GstBuffer* one) { gst_buffer_unref(one); });
    if (with_time.get() != buffer && !std::exchange(input.untimed_reported, true))
      untimed = "Buffers without a time stamp come on the pad \"" + std::string(GST_PAD_NAME(input.pad)) +
                "\": each one takes the place after the one before, or is left out where nothing tells it.";
    if (!with_time) return !hopeless;
    if (input.track > 0) return add_audio(input, with_time.get());
    fault = apply_settings();
    const bool done =
        input.track == 0 ? add_video(input, with_time.get()) : add_analysis(input, with_time.get());
    if (fault.empty()) fault = unplaced_fault();
    return done;
  }();
  for (const std::string& text : {untimed, fault})
    if (!text.empty() && added) warn_(text);
  if (input.track == 0) writer_.look_for_answer();
  return added;
}

bool Session::lacks_times(const Input& input) {
  const std::lock_guard guard(lock_);
  return input.filler.lacks_times();
}

void Session::wait_for_disk(GstPad* pad) {
  if (!live_.value_or(true)) writer_.wait_below(kPatience, [pad] { return !GST_PAD_IS_FLUSHING(pad); });
}

// What the analysis has yet to report may need frames of before: the end is that of all pads.
bool Session::end_of_stream(Input& input) {
  const std::lock_guard guard(lock_);
  input.eos = true;
  if (input.track == kAnalysisTrack) recorder_.end_analysis();
  for (const auto& each : inputs_)
    if (!each->eos && gst_pad_is_linked(each->pad)) return false;
  recorder_.finish();
  files_.journal().reset();
  return true;
}

void Session::start_event(const char* reason) {
  const std::lock_guard guard(lock_);
  recorder_.start(recorder_.newest(), reason ? reason : "application");
}

void Session::stop_event() {
  const std::lock_guard guard(lock_);
  recorder_.stop(recorder_.newest());
}

void Session::handle(GstMessage* message) {
  const std::lock_guard guard(lock_);
  GstClockTime time = GST_CLOCK_TIME_NONE;
  if (const auto trigger = trigger_of(message, triggers_, time))
    apply(*trigger, GST_CLOCK_TIME_IS_VALID(time) ? time_of(time) : recorder_.newest());
}

void Session::handle(GstEvent* event) {
  const std::lock_guard guard(lock_);
  if (const auto trigger = trigger_of(event, triggers_)) apply(*trigger, recorder_.newest());
}

void Session::file_failed(std::uint32_t file, bool empty) {
  const std::lock_guard guard(lock_);
  files_.drop(file);
  recorder_.file_failed(file, empty);
}

}  // namespace cerberus::plugin
