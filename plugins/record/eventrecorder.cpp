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
 * What triggers: an object with a track that moves (`trigger-track`, within `trigger-zones`; one that stands keeps an
 * event going, but begins none; zones in degrees of the world need `horizontal-fov` and the head's pose on the analysed
 * frames, and without them hide nothing), a fusion action other than `zero` and `hold` (`trigger-fusion`), a PIR sensor (`trigger-pir`), and what the
 * application emits, any time and in any thread:
 * - action signal `start-event` (reason): an event begins, and lasts until
 * - action signal `stop-event`;
 * - action signal `handle-message` (message): the application hands on a message of the bus: `cerberus-motion`
 *   begins and ends an event, `cerberus-track`, `cerberus-fusion` and `cerberus-pir` count as the properties say.
 *
 * An event of `start-event` goes on where the stream's times fall back (a source that begins anew, a flush), in another
 * file; any other event ends there.
 *
 * Files: MP4 in fragments of .4 s (H.264, H.265), which play after a crash as far as they were written and become
 * a plain MP4 at their end, or Matroska (JPEG always; A-law and µ-law). They are made with mode 0640 in `location`, a
 * folder that must exist, under a name by `file-name`: conversions of strftime (local time of the first frame), {camera},
 * {event}, {part}; folders in it are made. Nothing is overwritten: a second file of a name becomes `name~1`.
 *
 * Beside a file, under its name:
 * - `.jsonl` (`json-lines`): the lines of `motionjson` for its frames, with the key `file-time` in front: nanoseconds
 *   since the file's first frame. Frames without any metadata have no line.
 * - `.jpg` (`picture`): the frame of the pad `analysis`, or of a JPEG stream without that pad, in which an object is
 *   largest, sharpest and most central; without an object the first one.
 *
 * `index` is an SQLite database (WAL) with the table `recordings`, a row for each file: `file`, `lines`, `picture`
 * (names below `location`), `camera`, `event`, `part`, `begin`, `end` (nanoseconds since 1970, UTC), `reason`, `tracks`,
 * `kinds`, `rule`, `size` (bytes of all three files), `people` (the most at once), `open` (1 while it is written),
 * `broken` (1: nothing in it plays), `keep`. Other programs may read it at any time, and set `keep`; so does the action
 * signal `keep-recording` (location, keep). Rows and files are reconciled at the start. Retention deletes file, lines, picture and row together, by `retention-age`, `retention-size` and
 * `retention-free`, unless `keep` is set. Files that the index does not name are never deleted.
 *
 * The end of the stream is posted when the files are complete, and once more when a pause ends; not where a flush (a seek) came
 * meanwhile. The bins around the element may post PLAYING once more before it.
 *
 * Writing has a thread of its own. A live stream never waits for the disk: where more than 64 MiB wait, the file is given
 * up and a warning posted. A stream that is not live waits. Where a file cannot be written (disk full, folder gone)
 * a warning names it, the stream goes on, and every 5 s another file is tried, from the frames that no file has yet. If
 * `location` is missing or not writable at the start, the element does not start. Faults of lines, picture and index
 * are warnings, and recording goes on. A disk that does not answer when the element is stopped is waited for as long as
 * `stop-timeout`; files that are not complete then are reported as failed. A start waits as long, but 2 to 5 s, and goes
 * on with a warning; what is recorded waits until the disk answers.
 *
 * Posts element messages `cerberus-recording` with `state` (string: `started`, `ended`, `failed`; `deleted` by retention,
 * with `location` only), `event`, `part` (uint),
 * `location` (string: the file), `reason` (string: the trigger), `camera-name` (string), `running-time` (uint64: of the
 * first frame), `trigger` (uint64: running time), `utc` (uint64, where it is known: of the first frame), and at the end
 * `duration` and `size` (uint64: ns, bytes), `last` (boolean: the event's last file), and `lines` and `picture` (string:
 * the files beside it, where they are). A file whose end is reported is on the disk, and its row is closed.
 *
 * `state` is `fault`, with `fault` (string) alone, when recording begins to fail, and when it fails for another reason: a
 * file could not be written, the folder takes none (it is looked at every 2 s, and tried out where less than 1 MiB is
 * free), its disk has not answered for 5 s, or the index cannot be written. It is `sound` when recording works again: a
 * file was written for 2 s; or, where it was the disk that failed, none is asked for and the folder takes one on trial.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 eventrecorder name=recorder location=. \
 *     videotestsrc num-buffers=60 pattern=ball ! motiondetect ! tee name=t \
 *     t. ! queue ! videoconvertscale ! video/x-raw,format=I420,width=[2,8192,2],height=[2,8192,2] ! \
 *     x264enc tune=zerolatency key-int-max=25 ! h264parse ! recorder.video \
 *     t. ! queue ! recorder.analysis
 * gst-launch-1.0 filesrc location=vtest.avi ! decodebin ! videoconvert ! motiondetect ! \
 *     videoconvertscale ! video/x-raw,format=I420,width=[2,8192,2],height=[2,8192,2] ! \
 *     x264enc tune=zerolatency ! h264parse ! eventrecorder location=. pre-roll=2000000000
 * ]|
 *
 * Since: 0.1
 */

#include <cerberus/cerberus.h>

#include "cerberus/private/element.hpp"
#include "playing_gate.hpp"
#include "session.hpp"
#include "shared/clock_times.hpp"
#include "shared/settings_query.hpp"
#include "stream_end.hpp"

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

struct Private {
  plugin::Adjustable<plugin::RecorderSettings> settings;
  plugin::PlayingGate gate;
  plugin::StreamEnd end;
  plugin::Session session{settings};
};

CERBERUS_DEFINE_TYPE(CerberusEventRecorder, cerberus_event_recorder, GstElement, GST_TYPE_ELEMENT, Private)

plugin::Input& input_of(GstPad* pad) {
  return *static_cast<plugin::Input*>(gst_pad_get_element_private(pad));
}

void post_deleted(CerberusEventRecorder* self, const plugin::FileReport& report) {
  GstStructure* facts = gst_structure_new("cerberus-recording", "state", G_TYPE_STRING, "deleted", "location",
                                          G_TYPE_STRING, report.path.c_str(), nullptr);
  gst_element_post_message(GST_ELEMENT(self), gst_message_new_element(GST_OBJECT(self), facts));
}

void post_fault(CerberusEventRecorder* self, const std::string& fault) {
  GstStructure* facts = gst_structure_new("cerberus-recording", "state", G_TYPE_STRING,
                                          fault.empty() ? "sound" : "fault", nullptr);
  if (!fault.empty()) gst_structure_set(facts, "fault", G_TYPE_STRING, fault.c_str(), nullptr);
  gst_element_post_message(GST_ELEMENT(self), gst_message_new_element(GST_OBJECT(self), facts));
}

// In the writer's thread.
void post_report(CerberusEventRecorder* self, const plugin::FileReport& report) {
  using State = plugin::FileReport::State;
  if (report.state == State::deleted) return post_deleted(self, report);
  if (report.state == State::fault || report.state == State::sound)
    return post_fault(self, report.fault.text);
  const record::FileStart& start = report.spec->start;
  if (report.state == State::failed) {
    CERBERUS_ELEMENT_WARNING(
        self, RESOURCE, WRITE,
        ("Cannot write a recording: %s%s%s%s", report.path.empty() ? "" : "\"", report.path.c_str(),
         report.path.empty() ? "" : "\": ", report.fault.text.c_str()),
        (report.fault.detail));
    self->priv->session.file_failed(start.file, report.bytes == 0);
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
  if (!report.lines.empty()) gst_structure_set(facts, "lines", G_TYPE_STRING, report.lines.c_str(), nullptr);
  if (!report.picture.empty())
    gst_structure_set(facts, "picture", G_TYPE_STRING, report.picture.c_str(), nullptr);
  gst_element_post_message(GST_ELEMENT(self), gst_message_new_element(GST_OBJECT(self), facts));
}

GstFlowReturn no_times(CerberusEventRecorder* self, GstPad* pad) {
  const bool raw = input_of(pad).track == plugin::kAnalysisTrack;
  CERBERUS_ELEMENT_ERROR(
      self, STREAM, FORMAT,
      ("The stream on the pad \"%s\" has no time stamps, which a recording needs: %s.", GST_PAD_NAME(pad),
       raw ? "set do-timestamp of its source, or take these frames from the branch that is encoded"
           : "put a parser in front (h264parse, h265parse, jpegparse, aacparse), and a frame rate into its "
             "caps, or set "
             "do-timestamp of its source"),
      (nullptr));
  return GST_FLOW_ERROR;
}

GstFlowReturn cerberus_event_recorder_chain(GstPad* pad, GstObject* parent, GstBuffer* buffer) {
  auto* self = cerberus_event_recorder_self(parent);
  Private& priv = *self->priv;
  const GstFlowReturn flow = cerberus::guarded(self, GST_FLOW_ERROR, [&] {
    plugin::Input& input = input_of(pad);
    if (input.track == 0) priv.gate.has_data(GST_ELEMENT(self));
    if (!priv.gate.wait(pad)) return GST_FLOW_FLUSHING;
    if (!priv.session.add(input, buffer)) return no_times(self, pad);
    if (input.track == 0) priv.session.wait_for_disk(pad);
    return GST_FLOW_OK;
  });
  gst_buffer_unref(buffer);
  return flow;
}

bool take_caps(CerberusEventRecorder* self, GstPad* pad, GstEvent* event) {
  GstCaps* caps = nullptr;
  gst_event_parse_caps(event, &caps);
  if (self->priv->session.set_caps(input_of(pad), caps)) return true;
  CERBERUS_ELEMENT_ERROR(
      self, CORE, NEGOTIATION, ("The encoded video's caps have no size."),
      ("put a parser in front (h264parse, h265parse, jpegparse); caps %" GST_PTR_FORMAT, caps));
  return false;
}

void take_eos(CerberusEventRecorder* self, GstPad* pad, GstEvent* event) {
  self->priv->gate.has_data(GST_ELEMENT(self));
  if (self->priv->session.lacks_times(input_of(pad))) no_times(self, pad);
  if (!self->priv->session.end_of_stream(input_of(pad))) return;
  const plugin::StreamEnd::Pending end = self->priv->end.expect(gst_event_get_seqnum(event));
  self->priv->session.when_done([self, end] { self->priv->end.post(GST_ELEMENT(self), end); });
}

gboolean cerberus_event_recorder_event(GstPad* pad, GstObject* parent, GstEvent* event) {
  auto* self = cerberus_event_recorder_self(parent);
  plugin::Session& session = self->priv->session;
  const gboolean done = cerberus::guarded(self, FALSE, [&]() -> gboolean {
    switch (GST_EVENT_TYPE(event)) {
      case GST_EVENT_CAPS:
        return take_caps(self, pad, event);
      case GST_EVENT_SEGMENT:
        session.set_segment(input_of(pad), event);
        return TRUE;
      case GST_EVENT_EOS:
        take_eos(self, pad, event);
        return TRUE;
      case GST_EVENT_FLUSH_STOP:
        session.flush(input_of(pad));
        self->priv->end.forget();
        return TRUE;
      case GST_EVENT_GAP:
        session.gap(input_of(pad), event);
        return TRUE;
      case GST_EVENT_STREAM_START:
        session.begin_stream(input_of(pad));
        self->priv->end.forget();
        return TRUE;
      case GST_EVENT_CUSTOM_DOWNSTREAM_OOB:
        session.handle(event);
        return TRUE;
      default:
        return TRUE;  // the element is the stream's end
    }
  });
  gst_event_unref(event);
  return done;
}

// Raw frames end here and are only read: every stride will do.
gboolean cerberus_event_recorder_query(GstPad* pad, GstObject* parent, GstQuery* query) {
  if (GST_QUERY_TYPE(query) == GST_QUERY_ALLOCATION && input_of(pad).track == plugin::kAnalysisTrack) {
    gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
    return TRUE;
  }
  return gst_pad_query_default(pad, parent, query);
}

// Returns nullptr where there is a pad of that name.
GstPad* add_pad(CerberusEventRecorder* self, GstPadTemplate* of, const char* name, int track) {
  GstPad* pad = gst_pad_new_from_template(of, name);
  gst_pad_set_element_private(pad, &self->priv->session.add_input(pad, track));
  gst_pad_set_chain_function(pad, cerberus_event_recorder_chain);
  gst_pad_set_event_function(pad, cerberus_event_recorder_event);
  gst_pad_set_query_function(pad, cerberus_event_recorder_query);
  if (gst_element_add_pad(GST_ELEMENT(self), pad)) return pad;
  self->priv->session.remove_input(pad);  // by its address: the pad is gone
  return nullptr;
}

GstPad* cerberus_event_recorder_request_new_pad(GstElement* element, GstPadTemplate* of, const gchar* name,
                                                const GstCaps*) {
  auto* self = cerberus_event_recorder_self(element);
  return cerberus::guarded(self, nullptr, [&]() -> GstPad* {
    if (g_strcmp0(GST_PAD_TEMPLATE_NAME_TEMPLATE(of), "analysis") == 0) {
      g_autoptr(GstPad) present = gst_element_get_static_pad(element, "analysis");
      return present ? nullptr : add_pad(self, of, "analysis", plugin::kAnalysisTrack);
    }
    const int track = self->priv->session.next_audio_track();
    if (name && *name) return add_pad(self, of, name, track);
    for (int number = track - 1;; ++number) {  // an application may have taken one by its name
      const std::string own = "audio_" + std::to_string(number);
      g_autoptr(GstPad) taken = gst_element_get_static_pad(element, own.c_str());
      if (!taken) return add_pad(self, of, own.c_str(), track);
    }
  });
}

void cerberus_event_recorder_release_pad(GstElement* element, GstPad* pad) {
  gst_pad_set_active(pad, FALSE);
  cerberus_event_recorder_self(element)->priv->session.remove_input(pad);
  gst_element_remove_pad(element, pad);
}

// Whether recordings can be made at all is checked at the start, and not at the first event.
bool check_settings(CerberusEventRecorder* self) {
  using Kind = plugin::SettingsFault::Kind;
  const auto fault = plugin::settings_fault(self->priv->settings.snapshot());
  if (!fault) return true;
  if (fault->kind == Kind::settings)
    CERBERUS_ELEMENT_ERROR(self, RESOURCE, SETTINGS, (fault->text), (nullptr));
  else
    CERBERUS_ELEMENT_ERROR(self, CORE, MISSING_PLUGIN, (fault->text), (nullptr));
  return false;
}

std::string settings_fault(GstElement* element) {
  const auto fault = plugin::settings_fault(cerberus_event_recorder_self(element)->priv->settings.snapshot());
  return fault && fault->kind == plugin::SettingsFault::Kind::settings ? fault->text : "";
}

bool begin(CerberusEventRecorder* self) {
  // A thread that waits for a disk may outlast the element's stop, and the element's owner.
  const std::shared_ptr<CerberusEventRecorder> own(cerberus_event_recorder_self(gst_object_ref(self)),
                                                   gst_object_unref);
  const std::string fault = self->priv->session.begin(
      [own](const plugin::FileReport& report) {
        cerberus::guarded(own.get(), [&] { post_report(own.get(), report); });
      },
      [own](const std::string& text) {
        CERBERUS_ELEMENT_WARNING(own.get(), RESOURCE, WRITE, (text), (nullptr));
      });
  if (fault.empty()) return true;
  self->priv->session.end();
  CERBERUS_ELEMENT_ERROR(self, RESOURCE, OPEN_WRITE, (fault), (nullptr));
  return false;
}

GstStateChangeReturn cerberus_event_recorder_change_state(GstElement* element, GstStateChange transition) {
  auto* self = cerberus_event_recorder_self(element);
  Private& priv = *self->priv;
  return cerberus::guarded(self, GST_STATE_CHANGE_FAILURE, [&] {
    const bool up = transition == GST_STATE_CHANGE_READY_TO_PAUSED;
    if (up) {
      if (!check_settings(self) || !begin(self)) return GST_STATE_CHANGE_FAILURE;
      priv.gate.await_data(element);
    }
    if (transition == GST_STATE_CHANGE_PAUSED_TO_PLAYING) {
      priv.end.repeat(element);
      priv.gate.begin_playing();
    }
    if (transition == GST_STATE_CHANGE_PLAYING_TO_PAUSED) priv.gate.end_playing();
    auto result =
        GST_ELEMENT_CLASS(cerberus_event_recorder_parent_class())->change_state(element, transition);
    if (up && result == GST_STATE_CHANGE_SUCCESS) result = GST_STATE_CHANGE_ASYNC;
    if (up && result == GST_STATE_CHANGE_FAILURE) priv.session.end();
    if (transition == GST_STATE_CHANGE_PAUSED_TO_READY) {
      priv.end.forget();
      priv.gate.stop_awaiting(element);
      priv.session.end();
    }
    return result;
  });
}

void cerberus_event_recorder_start_event(CerberusEventRecorder* self, const gchar* reason) {
  self->priv->session.start_event(reason);
}

void cerberus_event_recorder_stop_event(CerberusEventRecorder* self) {
  self->priv->session.stop_event();
}

void cerberus_event_recorder_handle_message(CerberusEventRecorder* self, GstMessage* message) {
  self->priv->session.handle(message);
}

void cerberus_event_recorder_keep_recording(CerberusEventRecorder* self, const gchar* location,
                                            gboolean keep) {
  if (location) self->priv->session.keep(location, keep);
}

void cerberus_event_recorder_init(CerberusEventRecorder* self) {
  GST_OBJECT_FLAG_SET(self, GST_ELEMENT_FLAG_SINK);
  g_autoptr(GstPadTemplate) video = gst_static_pad_template_get(&video_template);
  add_pad(self, video, "video", 0);
}

void cerberus_event_recorder_class_init(CerberusEventRecorderClass* klass) {
  GObjectClass* object = G_OBJECT_CLASS(klass);
  object->set_property = [](GObject* of, guint id, const GValue* value, GParamSpec*) {
    cerberus_event_recorder_self(of)->priv->settings.set(plugin::recorder_properties(), id, value);
  };
  object->get_property = [](GObject* of, guint id, GValue* value, GParamSpec*) {
    cerberus_event_recorder_self(of)->priv->settings.get(plugin::recorder_properties(), id, value);
  };
  plugin::Adjustable<plugin::RecorderSettings>::install(object, plugin::recorder_properties());
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
  element->query = cerberus::settings_query<cerberus_event_recorder_parent_class, settings_fault>;

  const auto action = [&](const char* name, GCallback handler, guint parameters, GType first, GType second) {
    g_signal_new_class_handler(name, G_TYPE_FROM_CLASS(klass),
                               GSignalFlags(G_SIGNAL_RUN_LAST | G_SIGNAL_ACTION), handler, nullptr, nullptr,
                               nullptr, G_TYPE_NONE, parameters, first, second);
  };
  action("start-event", G_CALLBACK(cerberus_event_recorder_start_event), 1, G_TYPE_STRING, 0);
  action("stop-event", G_CALLBACK(cerberus_event_recorder_stop_event), 0, 0, 0);
  action("handle-message", G_CALLBACK(cerberus_event_recorder_handle_message), 1, GST_TYPE_MESSAGE, 0);
  action("keep-recording", G_CALLBACK(cerberus_event_recorder_keep_recording), 2, G_TYPE_STRING,
         G_TYPE_BOOLEAN);
}

}  // namespace

CERBERUS_REGISTER_ELEMENT(eventrecorder, GST_RANK_NONE, cerberus_event_recorder, eventrecorder_debug,
                          "records encoded video around events")
