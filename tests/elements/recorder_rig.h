// SPDX-License-Identifier: LGPL-2.1-or-later
// An eventrecorder with streams that are made by hand: every frame and packet is its number, so that a file tells which
// ones it holds. Nothing is encoded or decoded.
#pragma once

#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "support.h"

namespace recorder_rig {

inline constexpr GstClockTime kFrame = 40 * GST_MSECOND;
inline constexpr char kH264[] =
    "video/x-h264, stream-format=avc, alignment=au, width=320, height=240, framerate=25/1, "
    "codec_data=(buffer)0142c01effe100046742c01e01000268ce";
inline constexpr char kAac[] =
    "audio/mpeg, mpegversion=4, stream-format=raw, rate=8000, channels=1, codec_data=(buffer)1588";

// A folder of its own, removed with its content.
class Folder {
 public:
  Folder() {
    char path[] = "/tmp/cerberus-recordings-XXXXXX";
    fail_unless(mkdtemp(path) != nullptr);
    path_ = path;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  const std::string& path() const { return path_; }
  // The files below it with one of these endings, sorted; those of the recordings without what is beside them.
  std::vector<std::string> files(const std::vector<std::string>& endings = {".mp4", ".mkv"}) const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path_))
      if (entry.is_regular_file() && std::ranges::count(endings, entry.path().extension().string()))
        found.push_back(entry.path().string());
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  std::string path_;
};

struct Frame {
  guint32 number;
  GstClockTime pts;  // when a player shows it
  bool keyframe;
};

// The frames of one track of a file, through a demuxer. `pad`: video_0, audio_0, ... Returns whether it reads the file to
// its end.
inline bool try_to_read(const std::string& file, std::vector<Frame>& frames,
                        const std::string& pad = "video_0") {
  const bool mp4 = file.ends_with(".mp4");
  const std::string line = "filesrc location=\"" + file + "\" ! " + (mp4 ? "qtdemux" : "matroskademux") +
                           " name=d d." + pad + " ! fakesink name=end signal-handoffs=true sync=false";
  GError* error = nullptr;
  GstElement* pipeline = gst_parse_launch(line.c_str(), &error);
  fail_unless(pipeline && !error, "%s", error ? error->message : "");
  g_autoptr(GstElement) end = gst_bin_get_by_name(GST_BIN(pipeline), "end");
  g_signal_connect(end, "handoff",
                   G_CALLBACK(+[](GstElement*, GstBuffer* buffer, GstPad* at, std::vector<Frame>* to) {
                     guint8 bytes[4] = {};
                     gst_buffer_extract(buffer, gst_buffer_get_size(buffer) - 4, bytes, 4);
                     // A gap at a track's start is an edit list, which the demuxer turns into a segment.
                     g_autoptr(GstEvent) event = gst_pad_get_sticky_event(at, GST_EVENT_SEGMENT, 0);
                     const GstSegment* segment = nullptr;
                     gst_event_parse_segment(event, &segment);
                     const GstClockTime time =
                         gst_segment_to_running_time(segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
                     to->push_back({GST_READ_UINT32_BE(bytes), time,
                                    !GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DELTA_UNIT)});
                   }),
                   &frames);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
      bus, 60 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  const bool ended = message && GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
  return ended;
}

inline std::vector<Frame> read_back(const std::string& file, const std::string& pad = "video_0") {
  std::vector<Frame> frames;
  fail_unless(try_to_read(file, frames, pad), "%s cannot be read", file.c_str());
  return frames;
}

inline std::vector<guint32> numbers_of(const std::vector<Frame>& frames) {
  std::vector<guint32> numbers;
  for (const Frame& frame : frames) numbers.push_back(frame.number);
  return numbers;
}

inline std::vector<guint32> range(guint32 from, guint32 to) {
  std::vector<guint32> numbers;
  for (guint32 k = from; k <= to; ++k) numbers.push_back(k);
  return numbers;
}

// A source pad that is linked to a pad of the recorder.
class Stream {
 public:
  Stream(GstElement* recorder, const char* pad, const char* caps, GstClockTime segment_start = 0)
      : source_(gst_pad_new(nullptr, GST_PAD_SRC)) {
    sink_ = gst_element_get_static_pad(recorder, pad);
    if (!sink_) sink_ = gst_element_request_pad_simple(recorder, pad);
    fail_unless(sink_ != nullptr);
    gst_pad_set_active(source_, TRUE);
    fail_unless(gst_pad_link(source_, sink_) == GST_PAD_LINK_OK);
    stream_id_ = std::string("stream-") + pad;
    caps_ = caps;
    start_ = segment_start;
  }
  ~Stream() {
    gst_pad_unlink(source_, sink_);
    gst_object_unref(source_);
    gst_object_unref(sink_);
  }
  Stream(const Stream&) = delete;

  // Stream start, caps, segment.
  void begin() {
    fail_unless(gst_pad_push_event(source_, gst_event_new_stream_start(stream_id_.c_str())));
    set_caps(caps_);
    push_segment();
  }
  void push_segment() {
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    segment.start = start_;
    fail_unless(gst_pad_push_event(source_, gst_event_new_segment(&segment)));
  }
  void set_caps(const char* text) {
    g_autoptr(GstCaps) caps = gst_caps_from_string(text);
    fail_unless(caps != nullptr);
    fail_unless(gst_pad_push_event(source_, gst_event_new_caps(caps)));
  }
  void end() { fail_unless(gst_pad_push_event(source_, gst_event_new_eos())); }
  bool send(GstEvent* event) { return gst_pad_push_event(source_, event); }
  GstFlowReturn push(GstBuffer* buffer) { return gst_pad_push(source_, buffer); }
  GstPad* source() { return source_; }
  GstPad* sink() { return sink_; }

 private:
  GstPad *source_, *sink_;
  std::string stream_id_;
  const char* caps_;
  GstClockTime start_;
};

// An access unit of H.264 (a length and a NAL unit) or any packet: its last bytes are its number. Without a decoding
// time it is shown in the order of decoding.
inline GstBuffer* unit(guint32 number, GstClockTime pts, bool keyframe,
                       GstClockTime dts = GST_CLOCK_TIME_NONE, gsize size = 64) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, size, nullptr);
  gst_buffer_memset(buffer, 0, 0xff, size);
  guint8 bytes[5];
  GST_WRITE_UINT32_BE(bytes, static_cast<guint32>(size - 4));
  bytes[4] = keyframe ? 0x65 : 0x41;
  gst_buffer_fill(buffer, 0, bytes, 5);
  GST_WRITE_UINT32_BE(bytes, number);
  gst_buffer_fill(buffer, size - 4, bytes, 4);
  GST_BUFFER_PTS(buffer) = pts;
  GST_BUFFER_DTS(buffer) = dts;
  GST_BUFFER_DURATION(buffer) = kFrame;
  if (!keyframe) GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_DELTA_UNIT);
  return buffer;
}

// The recorder, running, in a folder of its own, with short times: pre-roll 1 s, post-roll .4 s, join 0.
struct Rig {
  explicit Rig(int gop = 10, const char* caps = kH264) : gop(gop) {
    element = GST_ELEMENT(gst_object_ref_sink(gst_element_factory_make("eventrecorder", nullptr)));
    fail_unless(element != nullptr);
    bus = gst_bus_new();
    gst_element_set_bus(element, bus);
    g_object_set(element, "location", folder.path().c_str(), "file-name", "{event}", "pre-roll", GST_SECOND,
                 "post-roll", 400 * GST_MSECOND, "join", guint64{0}, "retention-free", 0, nullptr);
    video = std::make_unique<Stream>(element, "video", caps);
  }
  ~Rig() {
    stop();
    video.reset();
    audio.reset();
    analysis.reset();
    gst_element_set_bus(element, nullptr);
    gst_object_unref(bus);
    gst_object_unref(element);
  }

  void start() {
    fail_if(gst_element_set_state(element, GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE);
    for (Stream* stream : {video.get(), audio.get(), analysis.get()})
      if (stream) stream->begin();
  }
  void stop() { gst_element_set_state(element, GST_STATE_NULL); }
  // Frames up to `last`, 25 a second.
  void play_to(guint32 last) {
    for (; next <= last; ++next)
      fail_unless_equals_int(video->push(unit(next, next * kFrame, next % static_cast<guint32>(gop) == 0,
                                              next * kFrame, frame_size)),
                             GST_FLOW_OK);
  }
  void start_event() { g_signal_emit_by_name(element, "start-event", "test"); }
  void stop_event() { g_signal_emit_by_name(element, "stop-event"); }
  // Ends all streams and waits for the end.
  void finish() {
    for (Stream* stream : {video.get(), audio.get(), analysis.get()})
      if (stream) stream->end();
    wait_for(GST_MESSAGE_EOS);
  }
  GstMessage* take(GstMessageType type) { return gst_bus_timed_pop_filtered(bus, 60 * GST_SECOND, type); }
  void wait_for(GstMessageType type) {
    g_autoptr(GstMessage) message = take(type);
    fail_unless(message != nullptr);
  }
  // The next message about a file that has this state; its structure.
  GstStructure* wait_for_file(const char* state) {
    while (true) {
      g_autoptr(GstMessage) message = take(GST_MESSAGE_ELEMENT);
      fail_unless(message != nullptr, "no message that a file has %s", state);
      const GstStructure* facts = gst_message_get_structure(message);
      fail_unless(gst_structure_has_name(facts, "cerberus-recording"));
      if (g_strcmp0(gst_structure_get_string(facts, "state"), state) == 0) return gst_structure_copy(facts);
    }
  }

  Folder folder;
  int gop;
  guint32 next = 0;
  gsize frame_size = 64;
  GstElement* element;
  GstBus* bus;
  std::unique_ptr<Stream> video, audio, analysis;
};

// No file grows beyond so many bytes while it lives: this limit of the process stands for the end of a disk, which no
// recorder notices before. The test's own notes take less.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) {
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FileLimit() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileLimit(const FileLimit&) = delete;

 private:
  rlimit before_{};
};

// The next change of what keeps recordings from being made: its text; "sound": nothing does any more.
inline std::string next_fault(Rig& rig) {
  while (true) {
    g_autoptr(GstMessage) message = rig.take(GST_MESSAGE_ELEMENT);
    fail_unless(message != nullptr, "no fault is reported");
    const GstStructure* facts = gst_message_get_structure(message);
    const std::string state = gst_structure_get_string(facts, "state");
    if (state == "sound") return state;
    if (state == "fault") return gst_structure_get_string(facts, "fault");
  }
}

inline void fault_names(Rig& rig, const char* first, const char* second) {
  const std::string text = next_fault(rig);
  fail_unless(text.find(first) != text.npos && text.find(second) != text.npos, "%s", text.c_str());
}

}  // namespace recorder_rig
