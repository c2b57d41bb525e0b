// SPDX-License-Identifier: LGPL-2.1-or-later
// The recorder's files: which frames, at which times, in which container.
//
// CERBERUS_EVENTS=200: so many random events instead of a few.
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <random>

#include "recorder_rig.h"

using namespace recorder_rig;

namespace {

// Times in a file are in its track's scale, which may be rounded to a millisecond (Matroska).
bool near(GstClockTime a, GstClockTime b) {
  return GST_CLOCK_DIFF(a, b) <= gint64{GST_MSECOND} && GST_CLOCK_DIFF(b, a) <= gint64{GST_MSECOND};
}

// The running time with which each file begins, by the messages that it has started.
struct Begins {
  explicit Begins(GstBus* of_files) : bus(of_files) {
    gst_bus_set_sync_handler(
        bus,
        [](GstBus*, GstMessage* message, gpointer self) {
          static_cast<Begins*>(self)->note(gst_message_get_structure(message));
          return GST_BUS_PASS;
        },
        this, nullptr);
  }
  ~Begins() { gst_bus_set_sync_handler(bus, nullptr, nullptr, nullptr); }
  Begins(const Begins&) = delete;
  Begins& operator=(const Begins&) = delete;
  void note(const GstStructure* facts) {
    guint64 begin = 0;
    if (!facts || g_strcmp0(gst_structure_get_string(facts, "state"), "started") != 0) return;
    gst_structure_get_uint64(facts, "running-time", &begin);
    const std::lock_guard guard(lock);
    of[gst_structure_get_string(facts, "location")] = begin;
  }
  GstBus* bus;
  std::mutex lock;
  std::map<std::string, GstClockTime> of;
};

constexpr GstClockTime kHours = 1000 * 3600 * GST_SECOND;  // x264enc's stamps begin here
constexpr int kUsualEvents = 8, kEventsOfARecorder = 2;
constexpr guint32 kInput = 700;  // frames

// Two random events of one recorder, from `seed`.
struct RandomEvents {
  struct Event {
    guint32 start, stop;  // the frames that are pushed last before each
  };

  explicit RandomEvents(unsigned seed) : random(seed) {
    gop = seed == 0 ? 1 : seed == 1 ? 250 : draw(1, 250);
    // Shown 0 3 1 2 | 4 7 5 6, with closed GOPs.
    if ((b_frames = gop >= 4 && draw(0, 2) == 0)) gop -= gop % 4;
    audio = draw(0, 1);
    matroska = draw(0, 3) == 0;
    pre_roll = draw(0, 3000), post_roll = draw(0, 2000), join = draw(0, 1000);
    longest = draw(0, 1) * draw(1, 5);
    guint32 from = 0;
    for (Event& event : events) {
      event.start = from + static_cast<guint32>(draw(0, 250));
      event.stop = event.start + static_cast<guint32>(draw(0, 80));
      from = event.stop + 1;
    }
  }
  int draw(int from, int to) { return std::uniform_int_distribution<>(from, to)(random); }
  // The picture that is the kth in the order of decoding, and when the kth is decoded.
  guint32 shown(guint32 k) const {
    constexpr guint32 kOrder[] = {0, 3, 1, 2};
    return b_frames ? k / 4 * 4 + kOrder[k % 4] : k;
  }
  // In running time: below zero for the first ones of a stream with B-frames.
  gint64 decoded(guint32 k) const { return (gint64{k} - (b_frames ? 2 : 0)) * gint64{kFrame}; }
  bool is_keyframe(guint32 k) const { return k % static_cast<guint32>(gop) == 0; }
  // Whether the pre-roll or the post-roll of an event reaches to the frame.
  bool wants(guint32 frame) const {
    const auto time = static_cast<gint64>(frame * kFrame), ms = gint64{GST_MSECOND};
    return std::ranges::any_of(events, [&](const Event& event) {
      return time >= decoded(event.start) - pre_roll * ms && time <= decoded(event.stop) + post_roll * ms;
    });
  }

  std::mt19937 random;
  int gop, pre_roll, post_roll, join, longest;
  bool b_frames, audio, matroska;
  Event events[kEventsOfARecorder];
};

void play(Rig& rig, const RandomEvents& what) {
  rig.start();
  for (guint32 k = 0; k < kInput; ++k) {
    rig.video->push(unit(what.shown(k), kHours + what.shown(k) * kFrame, what.is_keyframe(k),
                         static_cast<GstClockTime>(gint64{kHours} + what.decoded(k))));
    if (rig.audio) rig.audio->push(unit(k, k * kFrame + 7 * GST_MSECOND, true));
    for (const auto& event : what.events) {
      if (k == event.start) rig.start_event();
      if (k == event.stop) rig.stop_event();
    }
  }
  rig.finish();
}

// The end of the stream reaches the application. Frees the pipeline.
void assert_ends(GstElement* pipeline) {
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  g_autoptr(GstMessage) end = gst_bus_timed_pop_filtered(
      bus, 10 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
  fail_unless(end && GST_MESSAGE_TYPE(end) == GST_MESSAGE_EOS);
}

}  // namespace

GST_START_TEST(an_event_becomes_one_file_with_its_pre_roll_and_post_roll) {
  Rig rig;
  rig.start();
  rig.play_to(57);
  rig.start_event();  // 57 - 25 = 32: the GOP of 30
  rig.play_to(80);
  rig.stop_event();  // and 10 frames
  rig.play_to(200);
  rig.finish();
  const auto files = rig.folder.files();
  fail_unless_equals_int(files.size(), 1);
  fail_unless(files[0] == rig.folder.path() + "/1.mp4");
  const auto frames = read_back(files[0]);
  fail_unless(numbers_of(frames) == range(30, 90));
  for (const Frame& frame : frames) {
    fail_unless(near(frame.pts, (frame.number - 30) * kFrame));
    fail_unless(frame.keyframe == (frame.number % 10 == 0));
  }
}
GST_END_TEST

GST_START_TEST(messages_say_what_became_of_a_file) {
  Rig rig;
  g_object_set(rig.element, "camera-name", "yard", nullptr);
  rig.start();
  rig.play_to(57);
  rig.start_event();
  g_autoptr(GstStructure) started = rig.wait_for_file("started");
  rig.play_to(60);
  rig.stop_event();
  rig.play_to(200);
  g_autoptr(GstStructure) ended = rig.wait_for_file("ended");
  for (const GstStructure* facts : {started, ended}) {
    guint event = 0, part = 0;
    guint64 begin = 0, trigger = 0;
    fail_unless(gst_structure_get(facts, "event", G_TYPE_UINT, &event, "part", G_TYPE_UINT, &part,
                                  "running-time", G_TYPE_UINT64, &begin, "trigger", G_TYPE_UINT64, &trigger,
                                  nullptr));
    fail_unless_equals_int(event, 1);
    fail_unless_equals_int(part, 1);
    fail_unless_equals_uint64(begin, 30 * kFrame);
    fail_unless_equals_uint64(trigger, 57 * kFrame);
    fail_unless_equals_string(gst_structure_get_string(facts, "reason"), "test");
    fail_unless_equals_string(gst_structure_get_string(facts, "camera-name"), "yard");
    fail_unless(gst_structure_get_string(facts, "location") == rig.folder.path() + "/1.mp4");
  }
  guint64 duration = 0, size = 0;
  gboolean last = FALSE;
  fail_unless(gst_structure_get(ended, "duration", G_TYPE_UINT64, &duration, "size", G_TYPE_UINT64, &size,
                                "last", G_TYPE_BOOLEAN, &last, nullptr));
  fail_unless_equals_uint64(duration, 40 * kFrame);
  fail_unless_equals_uint64(size, std::filesystem::file_size(rig.folder.path() + "/1.mp4"));
  fail_unless(last);
}
GST_END_TEST

GST_START_TEST(files_are_readable_by_owner_and_group_only) {
  Rig rig;
  rig.start();
  rig.play_to(30);
  rig.start_event();
  rig.finish();
  struct stat about{};
  fail_unless(stat((rig.folder.path() + "/1.mp4").c_str(), &about) == 0);
  fail_unless_equals_int(about.st_mode & 0777 & ~0640, 0);
}
GST_END_TEST

GST_START_TEST(the_pre_roll_is_on_disk_before_another_frame_comes) {
  Rig rig;
  rig.start();
  rig.play_to(100);
  rig.start_event();
  g_autoptr(GstStructure) started = rig.wait_for_file("started");
  const std::string file = gst_structure_get_string(started, "location");
  // 25 frames and more of 64 bytes: the fragment of the first .4 s.
  while (std::filesystem::file_size(file) < 12 * 64) g_usleep(1000);
  fail_unless(rig.folder.files().size() == 1);
}
GST_END_TEST

GST_START_TEST(a_file_that_is_never_closed_plays_up_to_its_last_second) {
  Rig rig(250);
  rig.start();
  rig.play_to(100);
  rig.start_event();
  g_autoptr(GstStructure) started = rig.wait_for_file("started");
  const std::string file = gst_structure_get_string(started, "location");
  rig.play_to(300);
  // As kill -9 leaves it: what is on disk, once the writer rests.
  for (auto size = std::filesystem::file_size(file), last = size - size; size != last || size < 275 * 64;) {
    last = size;
    g_usleep(50 * 1000);
    size = std::filesystem::file_size(file);
  }
  const std::string copy = rig.folder.path() + "/killed.mp4";
  std::filesystem::copy_file(file, copy);
  const auto frames = read_back(copy);
  fail_unless(frames.size() >= 301 - 25, "%d frames", static_cast<int>(frames.size()));
  fail_unless(numbers_of(frames) == range(0, static_cast<guint32>(frames.size()) - 1));
}
GST_END_TEST

// What kill -9 leaves .2 s after the event began.
GST_START_TEST(a_file_plays_from_its_fifth_frame_on_whatever_happens) {
  Rig rig;
  g_object_set(rig.element, "pre-roll", guint64{0}, nullptr);
  rig.start();
  rig.play_to(20);
  rig.start_event();
  rig.play_to(24);
  g_autoptr(GstStructure) started = rig.wait_for_file("started");
  const std::string file = gst_structure_get_string(started, "location");
  std::vector<Frame> frames;
  for (int k = 0; k < 1000 && frames.empty(); ++k) {
    g_usleep(10 * 1000);
    try_to_read(file, frames);
  }
  fail_unless(numbers_of(frames) == range(20, 20 + static_cast<guint32>(frames.size()) - 1) &&
              frames.size() >= 2);
}
GST_END_TEST

// A first fragment of one frame is one that players drop. A keyframe every 8 frames.
GST_START_TEST(a_file_of_two_frames_a_second_plays_from_its_first_frame_on_whatever_happens) {
  std::string caps = recorder_rig::kH264;
  caps.replace(caps.find("25/1"), 4, "2/1");
  Rig rig(8, caps.c_str());
  g_object_set(rig.element, "pre-roll", guint64{0}, nullptr);
  rig.start();
  const auto play = [&](guint32 from, guint32 to) {
    for (guint32 k = from; k <= to; ++k) {
      GstBuffer* frame = unit(k, k * GST_SECOND / 2, k % 8 == 0, k * GST_SECOND / 2);
      GST_BUFFER_DURATION(frame) = GST_SECOND / 2;
      fail_unless_equals_int(rig.video->push(frame), GST_FLOW_OK);
    }
  };
  play(0, 8);
  rig.start_event();
  play(9, 14);
  g_autoptr(GstStructure) started = rig.wait_for_file("started");
  const std::string file = gst_structure_get_string(started, "location");
  std::vector<Frame> frames;
  for (int k = 0; k < 500 && frames.empty(); ++k) {
    g_usleep(10 * 1000);
    try_to_read(file, frames);
  }
  fail_unless(frames.size() >= 2 && frames[0].number == 8, "%zu frames from %u", frames.size(),
              frames.empty() ? 0 : frames[0].number);
  fail_unless(numbers_of(frames) == range(8, 8 + static_cast<guint32>(frames.size()) - 1));
}
GST_END_TEST

GST_START_TEST(stopping_without_end_of_stream_completes_the_file) {
  Rig rig;
  rig.start();
  rig.play_to(30);
  rig.start_event();
  rig.play_to(60);
  rig.stop();
  fail_unless(numbers_of(read_back(rig.folder.path() + "/1.mp4")) == range(0, 60));
}
GST_END_TEST

// A bin takes PAUSED for its last state where the thread of a decoder that posted it goes on after the application has set
// PLAYING; here it is told so.
GST_START_TEST(the_end_reaches_the_application_of_a_bin_that_has_forgotten_that_it_plays) {
  const Folder folder;
  const std::string line =
      "appsrc name=src format=time caps=video/x-raw,format=GRAY8,width=64,height=48,framerate=25/1 ! "
      "jpegenc ! eventrecorder location=" +
      folder.path();
  GstElement* pipeline = gst_parse_launch(line.c_str(), nullptr);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  g_autoptr(GstElement) source = gst_bin_get_by_name(GST_BIN(pipeline), "src");
  g_autoptr(GstBuffer) buffer = gst_buffer_new_allocate(nullptr, 64 * 48, nullptr);
  gst_buffer_memset(buffer, 0, 0, 64 * 48);
  GST_BUFFER_PTS(buffer) = 0;
  GstFlowReturn flow = GST_FLOW_ERROR;
  g_signal_emit_by_name(source, "push-buffer", buffer, &flow);
  fail_unless_equals_int(flow, GST_FLOW_OK);
  fail_unless_equals_int(gst_element_get_state(pipeline, nullptr, nullptr, 10 * GST_SECOND),
                         GST_STATE_CHANGE_SUCCESS);
  GST_STATE_LOCK(pipeline);  // until a thread that continued its change of state has posted it
  GST_STATE_UNLOCK(pipeline);
  gst_element_post_message(pipeline, gst_message_new_state_changed(GST_OBJECT(pipeline), GST_STATE_READY,
                                                                   GST_STATE_PAUSED, GST_STATE_VOID_PENDING));
  g_signal_emit_by_name(source, "end-of-stream", &flow);
  assert_ends(pipeline);
}
GST_END_TEST

// A bin forgets in PAUSED which of its elements have ended.
GST_START_TEST(the_end_is_posted_again_after_a_pause) {
  const Folder folder;
  const std::string line =
      "videotestsrc num-buffers=3 ! video/x-raw,width=64,height=48 ! jpegenc ! eventrecorder location=" +
      folder.path() + " appsrc name=other format=time ! fakesink async=false";
  GstElement* pipeline = gst_parse_launch(line.c_str(), nullptr);
  g_object_set(pipeline, "message-forward", TRUE, nullptr);  // also the end of one element
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  for (bool ended = false; !ended;) {
    g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(bus, 10 * GST_SECOND, GST_MESSAGE_ELEMENT);
    fail_unless(message != nullptr);
    g_autoptr(GstMessage) forwarded = nullptr;
    ended = gst_message_has_name(message, "GstBinForwarded") &&
            gst_structure_get(gst_message_get_structure(message), "message", GST_TYPE_MESSAGE, &forwarded,
                              nullptr) &&
            GST_MESSAGE_TYPE(forwarded) == GST_MESSAGE_EOS;
  }
  for (const GstState state : {GST_STATE_PAUSED, GST_STATE_PLAYING}) {
    gst_element_set_state(pipeline, state);
    fail_unless_equals_int(gst_element_get_state(pipeline, nullptr, nullptr, 10 * GST_SECOND),
                           GST_STATE_CHANGE_SUCCESS);
  }
  g_autoptr(GstElement) other = gst_bin_get_by_name(GST_BIN(pipeline), "other");
  GstFlowReturn flow = GST_FLOW_ERROR;
  g_signal_emit_by_name(other, "end-of-stream", &flow);
  assert_ends(pipeline);
}
GST_END_TEST

GST_START_TEST(the_element_records_again_after_it_was_stopped) {
  Rig rig;
  for (int round = 0; round < 2; ++round) {
    rig.next = 0;
    rig.start();
    rig.play_to(30);
    rig.start_event();
    rig.play_to(60);
    rig.finish();
    rig.stop();
  }
  const auto files = rig.folder.files();
  fail_unless_equals_int(files.size(), 2);
  for (const auto& file : files) fail_unless(numbers_of(read_back(file)) == range(0, 60));
}
GST_END_TEST

// x264enc's decoding times lie before its segment.
GST_START_TEST(stamps_that_begin_at_1000_hours_and_b_frames_become_times_from_zero) {
  Rig rig;
  rig.video.reset();
  rig.video = std::make_unique<Stream>(rig.element, "video", kH264, kHours);
  rig.start();
  // Shown 0 3 1 2 | 4 7 5 6: decoded two frames before a keyframe is shown.
  const guint32 order[] = {0, 3, 1, 2};
  for (guint32 k = 0; k < 100; ++k) {
    const guint32 shown = k / 4 * 4 + order[k % 4];
    rig.video->push(unit(shown, kHours + shown * kFrame, k % 20 == 0, kHours + k * kFrame - 2 * kFrame));
    if (k == 60) rig.start_event();  // at the decoding time of 58, so from 33: the GOP of 20
  }
  rig.finish();
  const auto frames = read_back(rig.folder.path() + "/1.mp4");
  fail_unless_equals_int(frames.size(), 80);
  const GstClockTime first = frames[0].pts;
  fail_unless(first <= 3 * kFrame, "the file begins at %" GST_TIME_FORMAT, GST_TIME_ARGS(first));
  for (guint32 k = 0; k < 80; ++k) {
    const guint32 shown = 20 + k / 4 * 4 + order[k % 4];
    fail_unless_equals_int(frames[k].number, shown);
    fail_unless(near(frames[k].pts, first + (shown - 20) * kFrame), "frame %u is at %" GST_TIME_FORMAT, shown,
                GST_TIME_ARGS(frames[k].pts));
  }
}
GST_END_TEST

GST_START_TEST(jpeg_is_recorded_into_matroska) {
  Rig rig(1, "image/jpeg, width=320, height=240, framerate=25/1");
  g_object_set(rig.element, "container", 1, nullptr);  // mp4
  rig.start();
  rig.play_to(50);
  rig.start_event();
  rig.play_to(60);
  rig.finish();
  const auto frames = read_back(rig.folder.path() + "/1.mkv");
  fail_unless(numbers_of(frames) == range(25, 60));
  for (const Frame& frame : frames) fail_unless(near(frame.pts, (frame.number - 25) * kFrame));
}
GST_END_TEST

GST_START_TEST(h264_is_recorded_into_matroska_on_request) {
  Rig rig;
  gst_util_set_object_arg(G_OBJECT(rig.element), "container", "matroska");
  rig.start();
  rig.play_to(50);
  rig.start_event();
  rig.play_to(60);
  rig.finish();
  fail_unless(numbers_of(read_back(rig.folder.path() + "/1.mkv")) == range(20, 60));
}
GST_END_TEST

GST_START_TEST(sound_is_recorded_with_the_video_of_its_time) {
  Rig rig;
  rig.audio = std::make_unique<Stream>(rig.element, "audio_0", kAac);
  rig.start();
  for (guint32 k = 0; k <= 120; ++k) {  // a packet a frame, half a frame later
    rig.play_to(k);
    rig.audio->push(unit(k, k * kFrame + kFrame / 2, true));
    if (k == 57) rig.start_event();
  }
  rig.finish();
  const std::string file = rig.folder.path() + "/1.mp4";
  fail_unless(numbers_of(read_back(file)) == range(30, 120));
  const auto packets = read_back(file, "audio_0");
  fail_unless(numbers_of(packets) == range(30, 120));
  for (const Frame& packet : packets)
    fail_unless(near(packet.pts, (packet.number - 30) * kFrame + kFrame / 2),
                "packet %u is at %" GST_TIME_FORMAT, packet.number, GST_TIME_ARGS(packet.pts));
}
GST_END_TEST

GST_START_TEST(sound_that_falls_silent_does_not_hold_the_video_up) {
  Rig rig;
  rig.audio = std::make_unique<Stream>(rig.element, "audio_0", kAac);
  rig.start();
  rig.play_to(30);
  rig.start_event();
  rig.audio->push(unit(30, 30 * kFrame, true));
  g_autoptr(GstStructure) started = rig.wait_for_file("started");
  const std::string file = gst_structure_get_string(started, "location");
  rig.play_to(300);
  while (std::filesystem::file_size(file) < 250 * 64) g_usleep(1000);  // while the audio's stream goes on
  rig.finish();
  fail_unless(numbers_of(read_back(file)) == range(0, 300));
}
GST_END_TEST

GST_START_TEST(an_audio_pad_whose_number_is_taken_gets_the_next_one) {
  GstElement* element = gst_element_factory_make("eventrecorder", nullptr);
  for (const char* wanted : {"audio_1", "audio_%u", "audio_%u", "audio_%u"}) {
    g_autoptr(GstPad) pad = gst_element_request_pad_simple(element, wanted);
    fail_unless(pad && g_str_has_prefix(GST_PAD_NAME(pad), "audio_"));
  }
  fail_unless_equals_int(element->numsinkpads, 5);
  gst_object_unref(element);
}
GST_END_TEST

GST_START_TEST(a_change_of_caps_in_mid_event_begins_another_file) {
  Rig rig;
  rig.start();
  rig.play_to(39);
  rig.start_event();
  rig.play_to(69);
  rig.video->set_caps(
      "video/x-h264, stream-format=avc, alignment=au, width=640, height=480, framerate=25/1, "
      "codec_data=(buffer)0142c01effe100046742c01e01000268ce");
  rig.play_to(99);
  rig.finish();
  fail_unless(numbers_of(read_back(rig.folder.path() + "/1.mp4")) == range(10, 69));
  fail_unless(numbers_of(read_back(rig.folder.path() + "/1-2.mp4")) == range(70, 99));
}
GST_END_TEST

GST_START_TEST(a_started_event_goes_on_in_another_file_behind_a_flush) {
  Rig rig;
  rig.start();
  rig.play_to(30);
  rig.start_event();
  rig.play_to(40);
  fail_unless(rig.video->send(gst_event_new_flush_start()));
  fail_unless(rig.video->send(gst_event_new_flush_stop(TRUE)));
  rig.video->push_segment();
  rig.next = 0;
  rig.play_to(20);
  rig.finish();
  fail_unless(numbers_of(read_back(rig.folder.path() + "/1.mp4")) == range(0, 40));
  fail_unless(numbers_of(read_back(rig.folder.path() + "/1-2.mp4")) == range(0, 20));
}
GST_END_TEST

// The thread that closes the file waits in its message while the flush comes.
GST_START_TEST(a_flush_cancels_an_end_that_waits_for_the_last_file) {
  struct Closing {
    std::mutex lock;
    std::condition_variable changed;
    bool reached = false, goes_on = false;
  } closing;
  Rig rig;
  gst_bus_set_sync_handler(
      rig.bus,
      [](GstBus*, GstMessage* message, gpointer data) {
        const GstStructure* facts = gst_message_get_structure(message);
        if (!facts || g_strcmp0(gst_structure_get_string(facts, "state"), "ended") != 0) return GST_BUS_PASS;
        Closing& file = *static_cast<Closing*>(data);
        std::unique_lock guard(file.lock);
        file.reached = true;
        file.changed.notify_all();
        file.changed.wait(guard, [&] { return file.goes_on; });
        return GST_BUS_PASS;
      },
      &closing, nullptr);
  rig.start();
  rig.play_to(30);
  rig.start_event();
  rig.play_to(40);
  rig.video->end();
  {
    std::unique_lock guard(closing.lock);
    fail_unless(closing.changed.wait_for(guard, std::chrono::seconds(10), [&] { return closing.reached; }));
  }
  fail_unless(rig.video->send(gst_event_new_flush_start()));
  fail_unless(rig.video->send(gst_event_new_flush_stop(TRUE)));
  {
    const std::lock_guard guard(closing.lock);
    closing.goes_on = true;
  }
  closing.changed.notify_all();
  rig.video->push_segment();
  rig.next = 0;
  rig.play_to(20);
  GstEvent* end = gst_event_new_eos();
  const guint32 number = gst_event_get_seqnum(end);
  fail_unless(rig.video->send(end));
  g_autoptr(GstMessage) ended = rig.take(GST_MESSAGE_EOS);
  fail_unless(ended != nullptr);
  fail_unless_equals_int(gst_message_get_seqnum(ended), number);
  rig.stop();
  gst_bus_set_sync_handler(rig.bus, nullptr, nullptr, nullptr);
}
GST_END_TEST

GST_START_TEST(a_started_event_goes_on_where_times_fall_back_until_it_is_stopped) {
  Rig rig;
  rig.start();
  rig.play_to(60);
  rig.start_event();
  rig.play_to(70);
  rig.next = 0;
  rig.play_to(20);
  rig.stop_event();  // and 10 frames
  rig.play_to(100);
  rig.finish();
  fail_unless(numbers_of(read_back(rig.folder.path() + "/1.mp4")) == range(30, 70));
  fail_unless(numbers_of(read_back(rig.folder.path() + "/1-2.mp4")) == range(0, 30));
}
GST_END_TEST

// Every frame once, whatever the GOP and the events, in files of at most two seconds.
GST_START_TEST(no_frame_is_lost_or_doubled_between_the_files_of_an_event) {
  const int gops[] = {1, 7, 25, 250};
  for (const bool with_audio : {false, true}) {
    Rig rig(gops[__i__]);
    g_object_set(rig.element, "longest-file", 2 * GST_SECOND, nullptr);
    if (with_audio) rig.audio = std::make_unique<Stream>(rig.element, "audio_0", kAac);
    rig.start();
    const auto play_to = [&](guint32 last) {
      for (guint32 k = rig.next; k <= last; ++k) {
        rig.play_to(k);
        if (rig.audio) rig.audio->push(unit(k, k * kFrame, true));
      }
    };
    play_to(40);
    rig.start_event();
    play_to(300);
    rig.stop_event();
    play_to(320);
    rig.start_event();
    play_to(600);
    rig.finish();
    std::vector<guint32> all;
    for (const auto& file : rig.folder.files()) {
      const auto frames = read_back(file);
      fail_unless(frames.front().keyframe);
      fail_unless(numbers_of(frames) == range(frames.front().number, frames.back().number));
      for (const auto& frame : frames) all.push_back(frame.number);
      if (with_audio) fail_unless(numbers_of(read_back(file, "audio_0")) == numbers_of(frames));
    }
    std::sort(all.begin(), all.end());
    fail_unless(all == range(all.front(), 600), "GOP %d", gops[__i__]);
    fail_unless(all.front() <= 15);
  }
}
GST_END_TEST

// Every presentation time of the input that an event reaches to is in one file, once, and no other file has it.
GST_START_TEST(no_frame_of_random_events_is_lost_or_doubled_and_each_has_its_time) {
  const char* wanted = getenv("CERBERUS_EVENTS");
  const int recorders = (wanted ? std::max(1, atoi(wanted)) : kUsualEvents) / kEventsOfARecorder;
  int files = 0, frames_seen = 0;
  for (int seed = 0; seed < std::max(1, recorders); ++seed) {
    const RandomEvents what(static_cast<unsigned>(seed));
    Rig rig(what.gop);
    rig.video.reset();
    rig.video = std::make_unique<Stream>(rig.element, "video", kH264, kHours);
    Begins begins(rig.bus);
    g_object_set(rig.element, "pre-roll", what.pre_roll * GST_MSECOND, "post-roll",
                 what.post_roll * GST_MSECOND, "join", what.join * GST_MSECOND, "longest-file",
                 what.longest * GST_SECOND, "container", what.matroska ? 2 : 1, nullptr);
    if (what.audio) rig.audio = std::make_unique<Stream>(rig.element, "audio_0", kAac);
    play(rig, what);

    std::vector<int> times(kInput), sounds(kInput);
    for (const auto& file : rig.folder.files()) {
      auto frames = read_back(file);
      fail_unless(!frames.empty() && frames[0].keyframe && begins.of.contains(file), "%s", file.c_str());
      // A track of B-frames may begin late in its file, by the time between decoding and showing its first frame.
      const GstClockTime late = what.b_frames ? frames[0].pts : 0, begin = begins.of[file];
      fail_unless(late <= 2 * kFrame + GST_MSECOND);
      for (const Frame& frame : frames) {
        fail_unless(near(begin + frame.pts, frame.number * kFrame + late),
                    "seed %d: frame %u of %s is at %" GST_TIME_FORMAT, seed, frame.number, file.c_str(),
                    GST_TIME_ARGS(begin + frame.pts));
        ++times[frame.number];
      }
      ++files;
      frames_seen += static_cast<int>(frames.size());
      if (!what.audio) continue;
      for (const Frame& packet : read_back(file, "audio_0")) {
        if (!what.b_frames)
          fail_unless(near(begin + packet.pts, packet.number * kFrame + 7 * GST_MSECOND),
                      "seed %d: packet %u", seed, packet.number);
        ++sounds[packet.number];
      }
    }
    for (guint32 k = 0; k < kInput; ++k) {
      fail_unless(times[k] <= 1 && (times[k] == 1 || !what.wants(k)), "seed %d: frame %u is in %d files",
                  seed, k, times[k]);
      fail_unless(sounds[k] <= 1, "seed %d: packet %u is in %d files", seed, k, sounds[k]);
      if (what.audio && !what.b_frames && k + 1 < kInput && times[k] && times[k + 1])
        fail_unless(sounds[k] == 1, "seed %d: packet %u is in no file", seed, k);
    }
  }
  g_print("%d random events: %d frames in %d files, each once\n", recorders * kEventsOfARecorder, frames_seen,
          files);
}
GST_END_TEST

GST_START_TEST(two_recorders_in_one_folder_overwrite_nothing) {
  Rig a, b;
  g_object_set(b.element, "location", a.folder.path().c_str(), nullptr);
  for (Rig* rig : {&a, &b}) {
    rig->start();
    rig->play_to(30);
    rig->start_event();
  }
  a.finish();
  b.finish();
  const auto files = a.folder.files();
  fail_unless_equals_int(files.size(), 2);
  for (const auto& file : files) fail_unless(numbers_of(read_back(file)) == range(0, 30));
}
GST_END_TEST

// Of frame 60 the time is missing; with it the next ones, where `__i__` is 1.
GST_START_TEST(a_buffer_without_a_time_takes_the_place_after_the_one_before) {
  const guint32 last = __i__ == 0 ? 60 : 64;
  Rig rig;
  rig.start();
  rig.play_to(50);
  rig.start_event();
  rig.play_to(59);
  for (; rig.next <= last; ++rig.next)
    fail_unless_equals_int(rig.video->push(unit(rig.next, GST_CLOCK_TIME_NONE, rig.next % 10 == 0)),
                           GST_FLOW_OK);
  rig.play_to(100);
  rig.finish();
  const auto frames = read_back(rig.folder.path() + "/1.mp4");
  fail_unless(numbers_of(frames) == range(20, 100));
  for (const Frame& frame : frames) fail_unless_equals_uint64(frame.pts, (frame.number - 20) * kFrame);
}
GST_END_TEST

GST_START_TEST(a_buffer_without_a_time_is_one_warning_and_no_error_on_every_pad) {
  Rig rig;
  rig.audio = std::make_unique<Stream>(rig.element, "audio_0", kAac);
  rig.analysis = std::make_unique<Stream>(rig.element, "analysis",
                                          "video/x-raw, format=GRAY8, width=320, height=240, framerate=25/1");
  rig.start();
  for (guint32 k = 0; k < 20; ++k) {
    rig.play_to(k);
    const bool timed = k % 5 != 3;
    for (Stream* stream : {rig.audio.get(), rig.analysis.get()}) {
      GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 320 * 240, nullptr);
      if (timed) GST_BUFFER_PTS(buffer) = k * kFrame;
      fail_unless_equals_int(stream->push(buffer), GST_FLOW_OK);
    }
  }
  int warnings = 0;
  while (GstMessage* message = gst_bus_pop_filtered(
             rig.bus, static_cast<GstMessageType>(GST_MESSAGE_WARNING | GST_MESSAGE_ERROR))) {
    fail_unless(GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING);
    g_autoptr(GError) error = nullptr;
    gst_message_parse_warning(message, &error, nullptr);
    fail_unless(strstr(error->message, "without a time stamp"), "%s", error->message);
    ++warnings;
    gst_message_unref(message);
  }
  fail_unless_equals_int(warnings, 2);
}
GST_END_TEST

// Sooner or later: at the end of a short stream, after 100 buffers of a long one.
GST_START_TEST(a_stream_in_which_no_time_ever_comes_is_an_error_with_advice_for_its_pad) {
  const bool is_raw = __i__ & 1, is_long = __i__ & 2;
  Rig rig;
  rig.analysis =
      std::make_unique<Stream>(rig.element, "analysis", "video/x-raw, format=GRAY8, width=320, height=240");
  rig.start();
  rig.play_to(5);
  Stream& stream = is_raw ? *rig.analysis : *rig.video;
  if (!is_raw) rig.video->send(gst_event_new_flush_stop(TRUE));
  if (!is_raw) rig.video->push_segment();
  GstFlowReturn flow = GST_FLOW_OK;
  for (int k = 0; k < (is_long ? 200 : 20) && flow == GST_FLOW_OK; ++k) {
    GstBuffer* buffer = unit(0, GST_CLOCK_TIME_NONE, true);
    flow = stream.push(buffer);
  }
  fail_unless_equals_int(flow, is_long ? GST_FLOW_ERROR : GST_FLOW_OK);
  if (!is_long) stream.end();
  g_autoptr(GstMessage) message = rig.take(GST_MESSAGE_ERROR);
  g_autoptr(GError) error = nullptr;
  gst_message_parse_error(message, &error, nullptr);
  fail_unless(strstr(error->message, is_raw ? "do-timestamp" : "h264parse"), "%s", error->message);
  fail_unless(is_raw == !strstr(error->message, "parser"), "%s", error->message);
}
GST_END_TEST

static Suite* eventrecorder_suite() {
  watch_library_log();
  Suite* suite = suite_create("eventrecorder");
  TCase* tests = tcase_create("files");
  tcase_add_test(tests, an_event_becomes_one_file_with_its_pre_roll_and_post_roll);
  tcase_add_test(tests, messages_say_what_became_of_a_file);
  tcase_add_test(tests, files_are_readable_by_owner_and_group_only);
  tcase_add_test(tests, the_pre_roll_is_on_disk_before_another_frame_comes);
  tcase_add_test(tests, a_file_that_is_never_closed_plays_up_to_its_last_second);
  tcase_add_test(tests, a_file_plays_from_its_fifth_frame_on_whatever_happens);
  tcase_add_test(tests, a_file_of_two_frames_a_second_plays_from_its_first_frame_on_whatever_happens);
  tcase_add_test(tests, stopping_without_end_of_stream_completes_the_file);
  tcase_add_test(tests, the_end_reaches_the_application_of_a_bin_that_has_forgotten_that_it_plays);
  tcase_add_test(tests, the_end_is_posted_again_after_a_pause);
  tcase_add_test(tests, a_flush_cancels_an_end_that_waits_for_the_last_file);
  tcase_add_test(tests, the_element_records_again_after_it_was_stopped);
  tcase_add_test(tests, stamps_that_begin_at_1000_hours_and_b_frames_become_times_from_zero);
  tcase_add_test(tests, jpeg_is_recorded_into_matroska);
  tcase_add_test(tests, h264_is_recorded_into_matroska_on_request);
  tcase_add_test(tests, sound_is_recorded_with_the_video_of_its_time);
  tcase_add_test(tests, sound_that_falls_silent_does_not_hold_the_video_up);
  tcase_add_test(tests, an_audio_pad_whose_number_is_taken_gets_the_next_one);
  tcase_add_test(tests, a_change_of_caps_in_mid_event_begins_another_file);
  tcase_add_test(tests, a_started_event_goes_on_in_another_file_behind_a_flush);
  tcase_add_test(tests, a_started_event_goes_on_where_times_fall_back_until_it_is_stopped);
  tcase_add_test(tests, two_recorders_in_one_folder_overwrite_nothing);
  tcase_add_loop_test(tests, no_frame_is_lost_or_doubled_between_the_files_of_an_event, 0, 4);
  tcase_add_loop_test(tests, a_buffer_without_a_time_takes_the_place_after_the_one_before, 0, 2);
  tcase_add_test(tests, a_buffer_without_a_time_is_one_warning_and_no_error_on_every_pad);
  tcase_add_loop_test(tests, a_stream_in_which_no_time_ever_comes_is_an_error_with_advice_for_its_pad, 0, 4);
  suite_add_tcase(suite, tests);
  TCase* random = tcase_create("random events");
  tcase_set_timeout(random, getenv("CERBERUS_EVENTS") ? 1000 : 60);
  tcase_add_test(random, no_frame_of_random_events_is_lost_or_doubled_and_each_has_its_time);
  suite_add_tcase(suite, random);
  return suite;
}

GST_CHECK_MAIN(eventrecorder)
