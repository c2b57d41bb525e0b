// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-eventrecorder
 * @title: eventrecorder
 * @short_description: writes the camera's own encoded video into a file for each event
 * @see_also: motiondetect, pirfusion, motionjson
 *
 * Records encoded video, as it came from the camera or the encoder, into one file for each event: with `pre-roll` before
 * the trigger and `post-roll` after the last one. Nothing is decoded or encoded. What the events are, the elements of
 * detection and fusion upstream decide, or the application.
 *
 * Pads:
 * - `video`: H.264, H.265 (whole access units, as `h264parse` and `h265parse` give them) or JPEG.
 * - `audio_%u` (on request): AAC, MP3, AC-3, Opus, A-law or µ-law. Without one the files have no sound.
 * - `analysis` (on request): raw frames that carry what was found, of the same camera: the same picture, a smaller one
 *   or another stream of it. Only metadata is read. A frame is matched with the video by running time, so either may
 *   come later than the other: up to 10 s the analysis, which makes the ring that much longer. Without this pad the
 *   metadata that `video` itself carries through an encoder counts.
 *
 * A file begins with a keyframe: the last one that is at least `pre-roll` before the trigger, so with the whole GOP that
 * reaches across that moment. Where the pre-roll of a trigger would reach into the event before, both are one event, as
 * they are where the trigger comes within `join` of that event's end. An event longer than `longest-file` goes on in
 * another file from a keyframe on. From first to last file each frame is in exactly one.
 *
 * What triggers: an object with a track that moves (`trigger-track`; one that stands keeps an event going, but begins
 * none), a fusion action other than `zero` and `hold` (`trigger-fusion`), a PIR sensor (`trigger-pir`), and what the
 * application emits, any time and in any thread:
 * - action signal `start-event` (reason): an event begins, and lasts until
 * - action signal `stop-event`;
 * - action signal `handle-message` (message): the application hands on a message of the bus: `cerberus-motion`
 *   begins and ends an event, `cerberus-track`, `cerberus-fusion` and `cerberus-pir` count as the properties say.
 *
 * Files: MP4 in fragments of half a second (H.264, H.265), which play after a crash as far as they were written and become
 * a plain MP4 at their end, or Matroska (JPEG always; A-law and µ-law). They are made with mode 0640 in `location`, a
 * folder that must exist, under a name by `file-name`: conversions of strftime (local time of the first frame), {camera},
 * {event}, {part}; folders in it are made. Nothing is overwritten: a second file of a name becomes `name~1`.
 *
 * Writing has a thread of its own. A live stream never waits for the disk: where more than 64 MiB wait, the file is given
 * up and a warning posted. A stream that is not live waits. Where a file cannot be written (disk full, folder gone)
 * a warning names it, the stream goes on, and every 5 s another file is tried, from the frames that no file has yet. If
 * `location` is missing or not writable at the start, the element does not start.
 *
 * Posts element messages `cerberus-recording` with `state` (string: `started`, `ended`, `failed`), `event`, `part` (uint),
 * `location` (string: the file), `reason` (string: the trigger), `camera-name` (string), `running-time` (uint64: of the
 * first frame), `trigger` (uint64: running time), `utc` (uint64, where it is known: of the first frame), and at the end
 * `duration` and `size` (uint64: ns, bytes) and `last` (boolean: the event's last file).
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 eventrecorder name=recorder location=. \
 *     videotestsrc num-buffers=60 pattern=ball ! motiondetect ! tee name=t \
 *     t. ! queue ! videoconvert ! x264enc tune=zerolatency key-int-max=25 ! h264parse ! recorder.video \
 *     t. ! queue ! recorder.analysis
 * gst-launch-1.0 filesrc location=vtest.avi ! decodebin ! videoconvert ! motiondetect ! x264enc tune=zerolatency ! \
 *     h264parse ! eventrecorder location=. pre-roll=2000000000
 * ]|
 *
 * Since: 0.1
 */

#include <cerberus/cerberus.h>
#include <gst/video/video.h>

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstring>

#include "cerberus/private/element.hpp"
#include "files.hpp"
#include "record/file_names.h"
#include "shared/clock_times.hpp"
#include "shared/properties.hpp"
#include "triggers.hpp"

namespace {

GST_DEBUG_CATEGORY_STATIC(eventrecorder_debug);
#define GST_CAT_DEFAULT eventrecorder_debug

namespace plugin = cerberus::plugin;
namespace record = cerberus::record;

#define AUDIO_CAPS                                                                                    \
  "audio/mpeg, mpegversion = 4, stream-format = raw; audio/mpeg, mpegversion = 1, layer = [ 1, 3 ]; " \
  "audio/x-ac3;"                                                                                      \
  " audio/x-opus; audio/x-alaw; audio/x-mulaw"

GstStaticPadTemplate video_template = GST_STATIC_PAD_TEMPLATE(
    "video", GST_PAD_SINK, GST_PAD_ALWAYS,
    GST_STATIC_CAPS("video/x-h264, stream-format = { avc, avc3 }, alignment = au; "
                    "video/x-h265, stream-format = { hvc1, hev1 }, alignment = au; image/jpeg"));
GstStaticPadTemplate audio_template =
    GST_STATIC_PAD_TEMPLATE("audio_%u", GST_PAD_SINK, GST_PAD_REQUEST, GST_STATIC_CAPS(AUDIO_CAPS));
GstStaticPadTemplate analysis_template =
    GST_STATIC_PAD_TEMPLATE("analysis", GST_PAD_SINK, GST_PAD_REQUEST, GST_STATIC_CAPS("video/x-raw(ANY)"));

// A stream that is not live waits while more bytes than this wait for the disk.
constexpr guint64 kPatience = 16 << 20;
// Where times fall back by more than this the stream has begun anew. Derived: above every reordering of frames.
constexpr record::Time kBroken = std::chrono::seconds(1);

enum Container { CONTAINER_AUTO, CONTAINER_MP4, CONTAINER_MATROSKA };

GType container_type() {
  static const GEnumValue values[] = {
      {CONTAINER_AUTO, "MP4 where it takes every track, else Matroska", "auto"},
      {CONTAINER_MP4, "MP4 (Matroska for JPEG)", "mp4"},
      {CONTAINER_MATROSKA, "Matroska", "matroska"},
      {0, nullptr, nullptr}};
  static const GType type = g_enum_register_static("CerberusRecordContainer", values);
  return type;
}

struct Settings {
  std::string location = ".";
  std::string file_name = "%Y-%m-%d/%H-%M-%S_{camera}_{event}";
  std::string camera_name;
  guint64 pre_roll = 5 * GST_SECOND, post_roll = 5 * GST_SECOND, join = 2 * GST_SECOND,
          longest_file = 600 * GST_SECOND;
  int container = CONTAINER_AUTO;
  int most_memory = 256;
  bool trigger_track = true, trigger_fusion = false, trigger_pir = false;
};

const plugin::Property<Settings> kProperties[] = {
    plugin::property("location", &Settings::location,
                     "Folder of the recordings; it must exist and be writable")
        .read_at_start(),
    plugin::property("file-name", &Settings::file_name,
                     "Names of the files below `location`, without the ending: conversions of strftime, "
                     "{camera}, {event}, "
                     "{part}; slashes make folders")
        .read_at_start(),
    plugin::property("camera-name", &Settings::camera_name, plugin::kCameraNameBlurb),
    plugin::property(
        "pre-roll", &Settings::pre_roll,
        "Nanoseconds before the first trigger that are recorded at least; the whole GOP in addition"),
    plugin::property("post-roll", &Settings::post_roll,
                     "Nanoseconds that are recorded after the last trigger"),
    plugin::property("join", &Settings::join,
                     "A trigger that comes so many nanoseconds after the end of an event continues it"),
    plugin::property(
        "longest-file", &Settings::longest_file,
        "Nanoseconds after which a long event goes on in another file, at a keyframe; 0 = never"),
    plugin::property("container", &Settings::container, container_type, "Container of the files"),
    plugin::property("most-memory", &Settings::most_memory, 1, 1 << 16,
                     "MiB of encoded video and audio that the ring of the pre-roll may hold"),
    plugin::property("trigger-track", &Settings::trigger_track,
                     "An object with a track that moves begins an event and keeps it going"),
    plugin::property("trigger-fusion", &Settings::trigger_fusion,
                     "A fusion action other than `zero` and `hold` begins an event and keeps it going"),
    plugin::property("trigger-pir", &Settings::trigger_pir,
                     "A PIR sensor that detects motion begins an event and keeps it going"),
};

constexpr int kAnalysis = -1;

struct Input {
  GstPad* pad = nullptr;  // of the element
  int track = kAnalysis;  // 0: video; from 1: audio
  GstSegment segment;
  std::shared_ptr<GstCaps> caps;
  int format = -1;
  std::optional<record::Time> decode;  // of the newest unit
  bool eos = false;
};

struct Private {
  plugin::Adjustable<Settings> settings;

  std::mutex lock;  // of all that follows, but the writer
  plugin::Writer writer;
  plugin::Files files{writer};
  record::EventRecorder recorder{files};
  std::vector<std::unique_ptr<Input>> inputs;  // video first
  int tracks = 1;
  plugin::TriggerSettings triggers;
  std::string camera_name;
  std::optional<bool> live;
  std::atomic<bool> awaits_data = false;  // the change to PAUSED ends with the first data
  std::recursive_mutex prerolled;         // held while PAUSED is reported
  std::mutex playing_lock;                // of `playing`
  std::condition_variable playing_changed;
  bool playing = false;
};

CERBERUS_DEFINE_TYPE(CerberusEventRecorder, cerberus_event_recorder, GstElement, GST_TYPE_ELEMENT, Private)

Input& input_of(GstPad* pad) {
  return *static_cast<Input*>(gst_pad_get_element_private(pad));
}

// The settings that may change while the element runs. Under the lock.
void apply_settings(Private& priv) {
  const auto changed = priv.settings.changes();
  if (!changed) return;
  record::EventRecorder::Settings to;
  to.pre_roll = plugin::time_of(changed->pre_roll);
  to.cycle.post_roll = plugin::time_of(changed->post_roll);
  to.cycle.join = plugin::time_of(changed->join);
  to.longest_file = plugin::time_of(changed->longest_file);
  to.most_bytes = static_cast<std::size_t>(changed->most_memory) << 20;
  priv.recorder.configure(to);
  priv.triggers = {changed->trigger_track, changed->trigger_fusion, changed->trigger_pir};
  priv.camera_name = changed->camera_name;
  priv.files.configure({changed->location, changed->file_name, changed->camera_name,
                        changed->container != CONTAINER_MATROSKA, changed->container != CONTAINER_MP4});
}

// Under the lock.
void apply(Private& priv, const plugin::Trigger& trigger, record::Time time) {
  using Kind = plugin::Trigger::Kind;
  if (trigger.kind == Kind::hold)
    priv.recorder.start(time, trigger.reason);
  else if (trigger.kind == Kind::release)
    priv.recorder.stop(time);
  else if (trigger.kind == Kind::moment || priv.recorder.active())
    priv.recorder.trigger(time, trigger.reason);
}

// In the writer's thread.
void post_report(CerberusEventRecorder* self, const plugin::FileReport& report) {
  using State = plugin::FileReport::State;
  const record::FileStart& start = report.spec->start;
  if (report.state == State::failed) {
    CERBERUS_ELEMENT_WARNING(
        self, RESOURCE, WRITE,
        ("Cannot write a recording: %s%s%s%s", report.path.empty() ? "" : "\"", report.path.c_str(),
         report.path.empty() ? "" : "\": ", report.fault.text.c_str()),
        (report.fault.detail));
    const std::lock_guard guard(self->priv->lock);
    self->priv->recorder.file_failed(start.file, report.bytes == 0);
  }
  static constexpr const char* kStates[] = {"started", "ended", "failed"};
  const auto at = [](record::Time time) { return plugin::clock_time(std::max(time, record::Time::zero())); };
  GstStructure* facts =
      gst_structure_new("cerberus-recording", "state", G_TYPE_STRING, kStates[static_cast<int>(report.state)],
                        "event", G_TYPE_UINT, start.event, "part", G_TYPE_UINT, start.part, "location",
                        G_TYPE_STRING, report.path.c_str(), "reason", G_TYPE_STRING, start.reason.c_str(),
                        "camera-name", G_TYPE_STRING, report.spec->camera.c_str(), "running-time",
                        G_TYPE_UINT64, at(start.begin), "trigger", G_TYPE_UINT64, at(start.trigger), nullptr);
  if (GST_CLOCK_TIME_IS_VALID(report.spec->utc))
    gst_structure_set(facts, "utc", G_TYPE_UINT64, report.spec->utc, nullptr);
  if (report.state == State::ended)
    gst_structure_set(facts, "duration", G_TYPE_UINT64, at(report.end.end - start.begin), "size",
                      G_TYPE_UINT64, report.bytes, "last", G_TYPE_BOOLEAN,
                      static_cast<gboolean>(report.end.last), nullptr);
  gst_element_post_message(GST_ELEMENT(self), gst_message_new_element(GST_OBJECT(self), facts));
}

// The buffer as a unit, with running times. False where it has none.
bool read_unit(Input& input, GstBuffer* buffer, record::Unit& unit) {
  const auto running = [&](GstClockTime time) -> std::optional<record::Time> {
    if (!GST_CLOCK_TIME_IS_VALID(time) || input.segment.format != GST_FORMAT_TIME) return std::nullopt;
    guint64 result = 0;
    const int sign = gst_segment_to_running_time_full(&input.segment, GST_FORMAT_TIME, time, &result);
    if (sign == 0) return std::nullopt;
    return sign * plugin::time_of(result);
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

bool has_analysis(const Private& priv) {
  for (const auto& input : priv.inputs)
    if (input->track == kAnalysis && !input->eos && gst_pad_is_linked(input->pad)) return true;
  return false;
}

GstFlowReturn no_times(CerberusEventRecorder* self, GstPad* pad) {
  CERBERUS_ELEMENT_ERROR(
      self, STREAM, FORMAT,
      ("The stream on the pad \"%s\" has no time stamps, which a recording needs.", GST_PAD_NAME(pad)),
      ("put a parser in front (h264parse, h265parse, jpegparse)"));
  return GST_FLOW_ERROR;
}

// Under the lock.
bool add_video(Private& priv, GstPad* pad, GstBuffer* buffer) {
  Input& input = input_of(pad);
  record::Unit unit;
  if (!read_unit(input, buffer, unit)) return false;
  apply_settings(priv);
  priv.files.set_patient(!priv.live.value_or(true));
  if (input.decode && unit.decode < *input.decode - kBroken) {
    GST_WARNING_OBJECT(pad, "times fall back: the stream begins anew");
    priv.recorder.reset();
  } else if (input.decode) {
    unit.decode = std::max(unit.decode, *input.decode);
  }
  input.decode = unit.decode;
  const record::Time time = unit.presentation;
  priv.files.stamps().frame(pad, buffer, plugin::clock_time(std::max(time, record::Time::zero())),
                            priv.camera_name);
  priv.recorder.push_video(std::move(unit));
  if (!has_analysis(priv))
    if (const auto trigger = plugin::trigger_of(buffer, priv.triggers)) apply(priv, *trigger, time);
  return true;
}

GstFlowReturn take_video(CerberusEventRecorder* self, GstPad* pad, GstBuffer* buffer) {
  Private& priv = *self->priv;
  if (!priv.live) priv.live = plugin::is_live(pad);
  {
    std::unique_lock guard(priv.lock);
    if (!add_video(priv, pad, buffer)) {
      guard.unlock();
      return no_times(self, pad);
    }
  }
  if (!priv.live.value_or(true)) priv.writer.wait_below(kPatience, [&] { return !GST_PAD_IS_FLUSHING(pad); });
  return GST_FLOW_OK;
}

GstFlowReturn take_audio(CerberusEventRecorder* self, GstPad* pad, GstBuffer* buffer) {
  Private& priv = *self->priv;
  Input& input = input_of(pad);
  record::Unit unit;
  const bool known = [&] {
    const std::lock_guard guard(priv.lock);
    if (!read_unit(input, buffer, unit)) return false;
    unit.keyframe = true;
    priv.recorder.push_audio(input.track, std::move(unit));
    return true;
  }();
  return known ? GST_FLOW_OK : no_times(self, pad);
}

GstFlowReturn take_analysis(CerberusEventRecorder* self, GstPad* pad, GstBuffer* buffer) {
  Private& priv = *self->priv;
  const GstClockTime time = plugin::running_time_of(input_of(pad).segment, buffer);
  if (!GST_CLOCK_TIME_IS_VALID(time)) return no_times(self, pad);
  const std::lock_guard guard(priv.lock);
  apply_settings(priv);
  if (const auto trigger = plugin::trigger_of(buffer, priv.triggers))
    apply(priv, *trigger, plugin::time_of(time));
  priv.recorder.analysed(plugin::time_of(time));
  return GST_FLOW_OK;
}

// As other sinks, the element reaches PAUSED with the first frame, and takes no more before PLAYING. `prerolled` is held
// while that is reported, and taken on the way to PLAYING: a bin may otherwise forget that it plays, and never post EOS
// (the thread that reports PAUSED goes on after the application has set PLAYING; seen on 1.22 on a busy machine).
void has_data(CerberusEventRecorder* self) {
  if (!self->priv->awaits_data.exchange(false)) return;
  // In another thread: this one may have to end before a change of state down can.
  gst_element_call_async(
      GST_ELEMENT(self),
      [](GstElement* element, gpointer) {
        const std::lock_guard guard(cerberus_event_recorder_self(element)->priv->prerolled);
        GST_STATE_LOCK(element);
        const bool waiting = GST_STATE_RETURN(element) == GST_STATE_CHANGE_ASYNC &&
                             GST_STATE_NEXT(element) == GST_STATE_PAUSED;
        if (waiting) gst_element_continue_state(element, GST_STATE_CHANGE_SUCCESS);
        GST_STATE_UNLOCK(element);
        if (waiting)
          gst_element_post_message(element,
                                   gst_message_new_async_done(GST_OBJECT(element), GST_CLOCK_TIME_NONE));
      },
      nullptr, nullptr);
}

void set_playing(Private& priv, bool playing) {
  {
    const std::lock_guard guard(priv.playing_lock);
    priv.playing = playing;
  }
  priv.playing_changed.notify_all();
}

// False: the pad is flushing, or stops.
bool wait_until_playing(Private& priv, GstPad* pad) {
  using namespace std::chrono_literals;
  std::unique_lock guard(priv.playing_lock);
  while (!priv.playing && !GST_PAD_IS_FLUSHING(pad)) priv.playing_changed.wait_for(guard, 20ms);
  return !GST_PAD_IS_FLUSHING(pad);
}

GstFlowReturn cerberus_event_recorder_chain(GstPad* pad, GstObject* parent, GstBuffer* buffer) {
  auto* self = cerberus_event_recorder_self(parent);
  const GstFlowReturn flow = cerberus::guarded(self, GST_FLOW_ERROR, [&] {
    const int track = input_of(pad).track;
    if (track == 0) has_data(self);
    if (!wait_until_playing(*self->priv, pad)) return GST_FLOW_FLUSHING;
    if (track == kAnalysis) return take_analysis(self, pad, buffer);
    return track == 0 ? take_video(self, pad, buffer) : take_audio(self, pad, buffer);
  });
  gst_buffer_unref(buffer);
  return flow;
}

bool take_caps(CerberusEventRecorder* self, GstPad* pad, GstCaps* caps) {
  Private& priv = *self->priv;
  Input& input = input_of(pad);
  if (input.track == kAnalysis) return true;
  int width = 0;
  if (input.track == 0 && !gst_structure_get_int(gst_caps_get_structure(caps, 0), "width", &width)) {
    CERBERUS_ELEMENT_ERROR(
        self, CORE, NEGOTIATION, ("The encoded video's caps have no size."),
        ("put a parser in front (h264parse, h265parse, jpegparse); caps %" GST_PTR_FORMAT, caps));
    return false;
  }
  const std::lock_guard guard(priv.lock);
  input.format = priv.files.format_of(caps);
  if (input.track > 0) priv.recorder.set_audio_format(input.track, input.format);
  return true;
}

// The stream ends when all linked pads have: what the analysis has yet to report may need frames of before.
void take_eos(CerberusEventRecorder* self, GstPad* pad, GstEvent* event) {
  Private& priv = *self->priv;
  has_data(self);
  {
    const std::lock_guard guard(priv.lock);
    input_of(pad).eos = true;
    if (input_of(pad).track == kAnalysis) priv.recorder.end_analysis();
    for (const auto& input : priv.inputs)
      if (!input->eos && gst_pad_is_linked(input->pad)) return;
    priv.recorder.finish();
  }
  const guint32 number = gst_event_get_seqnum(event);
  priv.writer.when_done([self, number] {
    GstMessage* message = gst_message_new_eos(GST_OBJECT(self));
    gst_message_set_seqnum(message, number);
    gst_element_post_message(GST_ELEMENT(self), message);
  });
}

void take_segment(Private& priv, GstPad* pad, GstEvent* event) {
  const std::lock_guard guard(priv.lock);
  gst_event_copy_segment(event, &input_of(pad).segment);
}

void flush(Private& priv, GstPad* pad) {
  const std::lock_guard guard(priv.lock);
  Input& input = input_of(pad);
  input.eos = false;
  input.decode.reset();
  gst_segment_init(&input.segment, GST_FORMAT_UNDEFINED);
  if (input.track == 0) priv.recorder.reset();
}

void take_gap(Private& priv, GstPad* pad, GstEvent* event) {
  if (input_of(pad).track != kAnalysis) return;
  GstClockTime time = GST_CLOCK_TIME_NONE;
  gst_event_parse_gap(event, &time, nullptr);
  const std::lock_guard guard(priv.lock);
  const GstClockTime running = gst_segment_to_running_time(&input_of(pad).segment, GST_FORMAT_TIME, time);
  if (GST_CLOCK_TIME_IS_VALID(running)) priv.recorder.analysed(plugin::time_of(running));
}

gboolean cerberus_event_recorder_event(GstPad* pad, GstObject* parent, GstEvent* event) {
  auto* self = cerberus_event_recorder_self(parent);
  Private& priv = *self->priv;
  const gboolean done = cerberus::guarded(self, FALSE, [&]() -> gboolean {
    switch (GST_EVENT_TYPE(event)) {
      case GST_EVENT_CAPS: {
        GstCaps* caps = nullptr;
        gst_event_parse_caps(event, &caps);
        return take_caps(self, pad, caps);
      }
      case GST_EVENT_SEGMENT:
        take_segment(priv, pad, event);
        return TRUE;
      case GST_EVENT_EOS:
        take_eos(self, pad, event);
        return TRUE;
      case GST_EVENT_FLUSH_STOP:
        flush(priv, pad);
        return TRUE;
      case GST_EVENT_GAP:
        take_gap(priv, pad, event);
        return TRUE;
      case GST_EVENT_STREAM_START: {
        const std::lock_guard guard(priv.lock);
        input_of(pad).eos = false;
        return TRUE;
      }
      case GST_EVENT_CUSTOM_DOWNSTREAM_OOB: {
        const std::lock_guard guard(priv.lock);
        if (const auto trigger = plugin::trigger_of(event, priv.triggers))
          apply(priv, *trigger, priv.recorder.newest());
        return TRUE;
      }
      default:
        return TRUE;  // the element is the stream's end
    }
  });
  gst_event_unref(event);
  return done;
}

// Raw frames end here unread: every stride will do.
gboolean cerberus_event_recorder_query(GstPad* pad, GstObject* parent, GstQuery* query) {
  if (GST_QUERY_TYPE(query) == GST_QUERY_ALLOCATION && input_of(pad).track == kAnalysis) {
    gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
    return TRUE;
  }
  return gst_pad_query_default(pad, parent, query);
}

GstPad* add_pad(CerberusEventRecorder* self, GstPadTemplate* of, const char* name, int track) {
  GstPad* pad = gst_pad_new_from_template(of, name);
  auto input = std::make_unique<Input>();
  input->pad = pad;
  input->track = track;
  gst_segment_init(&input->segment, GST_FORMAT_UNDEFINED);
  gst_pad_set_element_private(pad, input.get());
  gst_pad_set_chain_function(pad, cerberus_event_recorder_chain);
  gst_pad_set_event_function(pad, cerberus_event_recorder_event);
  gst_pad_set_query_function(pad, cerberus_event_recorder_query);
  {
    const std::lock_guard guard(self->priv->lock);
    self->priv->inputs.push_back(std::move(input));
  }
  gst_element_add_pad(GST_ELEMENT(self), pad);
  return pad;
}

GstPad* cerberus_event_recorder_request_new_pad(GstElement* element, GstPadTemplate* of, const gchar* name,
                                                const GstCaps*) {
  auto* self = cerberus_event_recorder_self(element);
  Private& priv = *self->priv;
  return cerberus::guarded(self, nullptr, [&]() -> GstPad* {
    if (g_strcmp0(GST_PAD_TEMPLATE_NAME_TEMPLATE(of), "analysis") == 0) {
      g_autoptr(GstPad) present = gst_element_get_static_pad(element, "analysis");
      return present ? nullptr : add_pad(self, of, "analysis", kAnalysis);
    }
    int track;
    {
      const std::lock_guard guard(priv.lock);
      track = priv.tracks++;
    }
    g_autofree gchar* own = name && *name ? g_strdup(name) : g_strdup_printf("audio_%d", track - 1);
    return add_pad(self, of, own, track);
  });
}

void cerberus_event_recorder_release_pad(GstElement* element, GstPad* pad) {
  Private& priv = *cerberus_event_recorder_self(element)->priv;
  gst_pad_set_active(pad, FALSE);
  {
    const std::lock_guard guard(priv.lock);
    if (input_of(pad).track == kAnalysis)
      priv.recorder.end_analysis();
    else
      priv.recorder.set_audio_format(input_of(pad).track, -1);
    std::erase_if(priv.inputs, [pad](const auto& input) { return input->pad == pad; });
  }
  gst_element_remove_pad(element, pad);
}

// Whether recordings can be made at all: said at the start, and not at the first event.
bool check_settings(CerberusEventRecorder* self) {
  const Settings settings = self->priv->settings.snapshot();
  const std::string fault = record::name_pattern_fault(settings.file_name);
  if (!fault.empty()) {
    CERBERUS_ELEMENT_ERROR(
        self, RESOURCE, SETTINGS,
        ("The pattern \"%s\" of \"file-name\" is refused: %s.", settings.file_name.c_str(), fault.c_str()),
        (nullptr));
    return false;
  }
  struct stat about{};
  int error = stat(settings.location.c_str(), &about) != 0 ? errno : S_ISDIR(about.st_mode) ? 0 : ENOTDIR;
  if (!error && access(settings.location.c_str(), W_OK | X_OK) != 0) error = errno;
  if (error) {
    CERBERUS_ELEMENT_ERROR(self, RESOURCE, OPEN_WRITE,
                           ("The folder \"%s\" takes no recordings: %s. Make it, or set \"location\".",
                            settings.location.c_str(), std::strerror(error)),
                           (nullptr));
    return false;
  }
  for (const char* name : {"mp4mux", "matroskamux", "filesink", "appsrc"}) {
    g_autoptr(GstElementFactory) factory = gst_element_factory_find(name);
    if (factory) continue;
    CERBERUS_ELEMENT_ERROR(
        self, CORE, MISSING_PLUGIN,
        ("GStreamer's element \"%s\" is missing; Debian has it in gstreamer1.0-plugins-good "
         "or -base.",
         name),
        (nullptr));
    return false;
  }
  return true;
}

void begin(CerberusEventRecorder* self) {
  Private& priv = *self->priv;
  priv.live.reset();
  priv.writer.start([self](const plugin::FileReport& report) {
    cerberus::guarded(self, [&] { post_report(self, report); });
  });
  const std::lock_guard guard(priv.lock);
  priv.settings.refresh();
  apply_settings(priv);
  if (has_analysis(priv)) priv.recorder.expect_analysis();
}

// Also without EOS the files are complete: Ctrl-C of gst-launch.
void end(CerberusEventRecorder* self) {
  Private& priv = *self->priv;
  {
    const std::lock_guard guard(priv.lock);
    priv.recorder.end_analysis();
    priv.recorder.finish();
    priv.recorder.reset();
    for (auto& input : priv.inputs) {
      input->eos = false;
      input->decode.reset();
      gst_segment_init(&input->segment, GST_FORMAT_UNDEFINED);
    }
  }
  priv.writer.stop();
  const std::lock_guard guard(priv.lock);
  priv.files.forget();
}

GstStateChangeReturn cerberus_event_recorder_change_state(GstElement* element, GstStateChange transition) {
  auto* self = cerberus_event_recorder_self(element);
  return cerberus::guarded(self, GST_STATE_CHANGE_FAILURE, [&] {
    const bool up = transition == GST_STATE_CHANGE_READY_TO_PAUSED;
    if (up) {
      if (!check_settings(self)) return GST_STATE_CHANGE_FAILURE;
      begin(self);
      self->priv->awaits_data = true;
      gst_element_post_message(element, gst_message_new_async_start(GST_OBJECT(self)));
    }
    if (transition == GST_STATE_CHANGE_PAUSED_TO_PLAYING) {
      const std::lock_guard guard(self->priv->prerolled);
      set_playing(*self->priv, true);
    }
    if (transition == GST_STATE_CHANGE_PLAYING_TO_PAUSED) set_playing(*self->priv, false);
    auto result =
        GST_ELEMENT_CLASS(cerberus_event_recorder_parent_class())->change_state(element, transition);
    if (up && result == GST_STATE_CHANGE_SUCCESS) result = GST_STATE_CHANGE_ASYNC;
    if (up && result == GST_STATE_CHANGE_FAILURE) end(self);
    if (transition == GST_STATE_CHANGE_PAUSED_TO_READY) {
      if (self->priv->awaits_data.exchange(false))
        gst_element_post_message(element, gst_message_new_async_done(GST_OBJECT(self), GST_CLOCK_TIME_NONE));
      end(self);
    }
    return result;
  });
}

void cerberus_event_recorder_start_event(CerberusEventRecorder* self, const gchar* reason) {
  const std::lock_guard guard(self->priv->lock);
  self->priv->recorder.start(self->priv->recorder.newest(), reason ? reason : "application");
}

void cerberus_event_recorder_stop_event(CerberusEventRecorder* self) {
  const std::lock_guard guard(self->priv->lock);
  self->priv->recorder.stop(self->priv->recorder.newest());
}

void cerberus_event_recorder_handle_message(CerberusEventRecorder* self, GstMessage* message) {
  Private& priv = *self->priv;
  const std::lock_guard guard(priv.lock);
  GstClockTime time = GST_CLOCK_TIME_NONE;
  if (const auto trigger = plugin::trigger_of(message, priv.triggers, time))
    apply(priv, *trigger, GST_CLOCK_TIME_IS_VALID(time) ? plugin::time_of(time) : priv.recorder.newest());
}

void cerberus_event_recorder_init(CerberusEventRecorder* self) {
  GST_OBJECT_FLAG_SET(self, GST_ELEMENT_FLAG_SINK);
  g_autoptr(GstPadTemplate) video = gst_static_pad_template_get(&video_template);
  add_pad(self, video, "video", 0);
}

void cerberus_event_recorder_class_init(CerberusEventRecorderClass* klass) {
  plugin::install_properties<CerberusEventRecorder, kProperties>(G_OBJECT_CLASS(klass));
  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  gst_element_class_set_static_metadata(
      element, "Event recorder", "Sink/File/Video",
      "Writes encoded video around events into files, with pre-roll and without decoding it",
      "The Cerberus developers");
  for (auto* pad : {&video_template, &audio_template, &analysis_template})
    gst_element_class_add_static_pad_template(element, pad);
  element->request_new_pad = cerberus_event_recorder_request_new_pad;
  element->release_pad = cerberus_event_recorder_release_pad;
  element->change_state = cerberus_event_recorder_change_state;

  const auto action = [&](const char* name, GCallback handler, std::initializer_list<GType> parameters) {
    g_signal_new_class_handler(name, G_TYPE_FROM_CLASS(klass),
                               GSignalFlags(G_SIGNAL_RUN_LAST | G_SIGNAL_ACTION), handler, nullptr, nullptr,
                               nullptr, G_TYPE_NONE, static_cast<guint>(parameters.size()),
                               parameters.size() ? *parameters.begin() : G_TYPE_NONE);
  };
  action("start-event", G_CALLBACK(cerberus_event_recorder_start_event), {G_TYPE_STRING});
  action("stop-event", G_CALLBACK(cerberus_event_recorder_stop_event), {});
  action("handle-message", G_CALLBACK(cerberus_event_recorder_handle_message), {GST_TYPE_MESSAGE});
}

}  // namespace

CERBERUS_REGISTER_ELEMENT(eventrecorder, GST_RANK_NONE, cerberus_event_recorder, eventrecorder_debug,
                          "records encoded video around events")
