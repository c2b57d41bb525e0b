// SPDX-License-Identifier: LGPL-2.1-or-later
// What the recorder puts beside a file, its index and retention, and a disk that is slow or takes nothing.
#include <sys/stat.h>

#include <algorithm>
#include <condition_variable>
#include <fstream>
#include <memory>
#include <mutex>
#include <utility>

#include "blocked_folder.h"
#include "recorder_rig.h"

using namespace recorder_rig;

namespace {

constexpr char kRaw[] = "video/x-raw, format=GRAY8, width=320, height=240, framerate=25/1";

// An even picture whose grey level is its number + 50, with a square of this size in its middle; 0: nothing.
GstBuffer* picture(guint32 number, int object) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 320 * 240, nullptr);
  gst_buffer_memset(buffer, 0, static_cast<guint8>(number + 50), 320 * 240);
  GST_BUFFER_PTS(buffer) = number * kFrame;
  g_autoptr(GPtrArray) none = g_ptr_array_new();
  cerberus_buffer_set_regions(buffer, none);
  if (!object) return buffer;
  g_autoptr(CerberusRegion) region = cerberus_region_new();
  region->id = 7;
  region->tracked = TRUE;
  region->x = (320 - object) / 2.0;
  region->y = (240 - object) / 2.0;
  region->width = region->height = object;
  fail_unless(cerberus_buffer_add_region(buffer, region));
  return buffer;
}

// The numbers of the frames whose lines are in a file, by their times: in the file, and of the stream.
struct Lines {
  std::vector<guint32> in_file, in_stream;
};
Lines read_lines(const std::string& path) {
  Lines lines;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    guint64 time = 0, pts = 0;
    fail_unless_equals_int(
        sscanf(line.c_str(), "{\"file-time\":%" G_GUINT64_FORMAT ",\"pts\":%" G_GUINT64_FORMAT, &time, &pts),
        2);
    fail_unless(line.ends_with("]}"), "%s", line.c_str());
    lines.in_file.push_back(static_cast<guint32>(time / kFrame));
    lines.in_stream.push_back(static_cast<guint32>(pts / kFrame));
  }
  return lines;
}

// The grey level in the middle of a JPEG.
int level_of(const std::string& path) {
  const std::string line = "filesrc location=\"" + path +
                           "\" ! jpegdec ! videoconvert ! video/x-raw,format=GRAY8 ! fakesink name=end "
                           "signal-handoffs=true sync=false";
  GstElement* pipeline = gst_parse_launch(line.c_str(), nullptr);
  g_autoptr(GstElement) end = gst_bin_get_by_name(GST_BIN(pipeline), "end");
  int level = -1;
  g_signal_connect(end, "handoff", G_CALLBACK(+[](GstElement*, GstBuffer* buffer, GstPad*, int* to) {
                     guint8 byte = 0;
                     gst_buffer_extract(buffer, gst_buffer_get_size(buffer) / 2, &byte, 1);
                     *to = byte;
                   }),
                   &level);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
      bus, 10 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  fail_unless(message && GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS, "%s is no JPEG", path.c_str());
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
  return level;
}

bool has_index(const Rig& rig) {  // a build without SQLite has none
  return std::filesystem::exists(rig.folder.path() + "/recordings.sqlite");
}

}  // namespace

GST_START_TEST(each_frame_of_a_file_has_its_line_however_late_the_analysis_is) {
  const guint32 lag = __i__ == 0 ? 0 : 100;
  Rig rig;
  g_object_set(rig.element, "longest-file", 2 * GST_SECOND, nullptr);
  rig.analysis = std::make_unique<Stream>(rig.element, "analysis", kRaw);
  rig.start();
  for (guint32 k = 0; k < 300; ++k) {
    if (k < 200) rig.play_to(k);
    if (k >= lag && k - lag < 200)
      rig.analysis->push(picture(k - lag, k - lag >= 80 && k - lag <= 140 ? 20 : 0));
  }
  rig.finish();
  std::vector<guint32> all;
  for (const std::string& file : rig.folder.files()) {
    const auto frames = numbers_of(read_back(file));
    const Lines lines = read_lines(std::filesystem::path(file).replace_extension(".jsonl"));
    fail_unless(lines.in_stream == frames);
    fail_unless(lines.in_file == range(0, static_cast<guint32>(frames.size()) - 1));
    all.insert(all.end(), frames.begin(), frames.end());
  }
  std::sort(all.begin(), all.end());
  fail_unless(all == range(50, 150));  // 80 - 25 = 55: the GOP of 50; 140 + 10
  fail_unless_equals_int(rig.folder.files().size(), 3);
}
GST_END_TEST

GST_START_TEST(metadata_on_the_encoded_video_has_lines_in_the_order_of_time) {
  Rig rig;
  rig.start();
  const guint32 order[] = {0, 3, 1, 2};  // as an encoder with B-frames gives them
  for (guint32 k = 0; k < 100; ++k) {
    const guint32 shown = k / 4 * 4 + order[k % 4];
    GstBuffer* buffer = unit(shown, (shown + 2) * kFrame, k % 20 == 0, k * kFrame);
    g_autoptr(GPtrArray) none = g_ptr_array_new();
    cerberus_buffer_set_regions(buffer, none);
    rig.video->push(buffer);
    if (k == 50) rig.start_event();
  }
  rig.finish();
  const Lines lines = read_lines(rig.folder.path() + "/1.jsonl");
  fail_unless(lines.in_stream == range(22, 101));
}
GST_END_TEST

GST_START_TEST(video_without_metadata_has_nothing_beside_it) {
  Rig rig;
  rig.start();
  rig.play_to(50);
  rig.start_event();
  rig.play_to(60);
  rig.finish();
  fail_unless_equals_int(rig.folder.files({".mp4"}).size(), 1);
  fail_unless_equals_int(rig.folder.files({".jsonl", ".jpg"}).size(), 0);
}
GST_END_TEST

GST_START_TEST(lines_and_picture_are_not_written_where_they_are_not_wanted) {
  Rig rig;
  g_object_set(rig.element, "json-lines", FALSE, "picture", FALSE, nullptr);
  rig.analysis = std::make_unique<Stream>(rig.element, "analysis", kRaw);
  rig.start();
  for (guint32 k = 0; k < 100; ++k) {
    rig.play_to(k);
    rig.analysis->push(picture(k, 20));
  }
  rig.finish();
  fail_unless_equals_int(rig.folder.files({".mp4"}).size(), 1);
  fail_unless_equals_int(rig.folder.files({".jsonl", ".jpg"}).size(), 0);
}
GST_END_TEST

GST_START_TEST(the_picture_is_the_frame_with_the_largest_object) {
  const guint32 lead =
      __i__ == 0 ? 0 : 50;  // so many frames the analysis is ahead: an encoder holds the video back
  Rig rig;
  rig.analysis = std::make_unique<Stream>(rig.element, "analysis", kRaw);
  rig.start();
  rig.play_to(0);  // PAUSED is reached with the first encoded frame
  for (guint32 k = 0; k < 200; ++k) {
    const int distance = k > 93 ? static_cast<int>(k) - 93 : 93 - static_cast<int>(k);
    rig.analysis->push(picture(k, k >= 80 && k <= 120 ? 200 - 5 * distance : 0));
    if (k >= lead) rig.play_to(k - lead);
  }
  rig.finish();
  const auto pictures = rig.folder.files({".jpg"});
  fail_unless_equals_int(pictures.size(), 1);
  const int level = level_of(pictures[0]);
  // A picture replaces one that is less than 10 % worse: an object of 181 to 200.
  fail_unless(level >= 93 - 4 + 50 && level <= 93 + 4 + 50, "%d", level);
  struct stat about{};
  for (const auto& file : rig.folder.files({".jpg", ".jsonl", ".mp4", ".sqlite"})) {
    fail_unless(stat(file.c_str(), &about) == 0);
    fail_unless_equals_int(about.st_mode & 0777 & ~0640, 0);
  }
}
GST_END_TEST

GST_START_TEST(an_event_without_an_object_shows_its_beginning) {
  Rig rig;
  rig.analysis = std::make_unique<Stream>(rig.element, "analysis", kRaw);
  rig.start();
  for (guint32 k = 0; k < 100; ++k) {
    rig.play_to(k);
    rig.analysis->push(picture(k, 0));
    if (k == 60) rig.start_event();
  }
  rig.finish();
  fail_unless_equals_int(level_of(rig.folder.path() + "/1.jpg"),
                         61 + 50);  // the first frame after the trigger
}
GST_END_TEST

// Luma of video is 16 to 235, that of a JPEG 0 to 255. What videoconvert of GStreamer 1.22 calculates is up to 3 too low.
GST_START_TEST(a_picture_is_as_black_and_as_white_as_the_video) {
  for (const auto& [luma, level] : {std::pair{16, 0}, {126, 128}, {235, 255}}) {
    Rig rig;
    rig.analysis = std::make_unique<Stream>(
        rig.element, "analysis", "video/x-raw, format=I420, width=320, height=240, framerate=25/1");
    rig.start();
    for (guint32 k = 0; k < 60; ++k) {
      rig.play_to(k);
      GstBuffer* frame = picture(k, 0);
      GstBuffer* chroma = gst_buffer_new_allocate(nullptr, 320 * 240 / 2, nullptr);
      gst_buffer_memset(frame, 0, static_cast<guint8>(luma), 320 * 240);
      gst_buffer_memset(chroma, 0, 128, 320 * 240 / 2);
      rig.analysis->push(gst_buffer_append(frame, chroma));
      if (k == 30) rig.start_event();
    }
    rig.finish();
    const int found = level_of(rig.folder.path() + "/1.jpg");
    fail_unless(std::abs(found - level) <= 3, "luma %d is %d", luma, found);
  }
}
GST_END_TEST

GST_START_TEST(a_jpeg_stream_needs_no_analysis_for_its_picture) {
  Rig rig(1, "image/jpeg, width=320, height=240, framerate=25/1");
  rig.start();
  rig.play_to(50);
  rig.start_event();
  rig.play_to(60);
  rig.finish();
  std::ifstream file(rig.folder.path() + "/1.jpg", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  fail_unless_equals_int(bytes.size(), 64);
  fail_unless_equals_int(bytes[63], 51);  // the frame after the trigger, as it came
  fail_unless_equals_int(rig.folder.files({".jsonl"}).size(), 0);
}
GST_END_TEST

GST_START_TEST(the_message_of_the_end_names_what_is_beside_the_file) {
  Rig rig;
  rig.analysis = std::make_unique<Stream>(rig.element, "analysis", kRaw);
  rig.start();
  for (guint32 k = 0; k < 150; ++k) {
    rig.play_to(k);
    rig.analysis->push(picture(k, k >= 60 && k < 70 ? 20 : 0));
  }
  g_autoptr(GstStructure) ended = rig.wait_for_file("ended");
  fail_unless(gst_structure_get_string(ended, "lines") == rig.folder.path() + "/1.jsonl");
  fail_unless(gst_structure_get_string(ended, "picture") == rig.folder.path() + "/1.jpg");
  fail_unless(read_lines(rig.folder.path() + "/1.jsonl").in_stream == range(30, 79));
}
GST_END_TEST

GST_START_TEST(only_tracks_in_the_zone_trigger) {
  Rig rig;
  rig.analysis = std::make_unique<Stream>(rig.element, "analysis", kRaw);
  // The lower edge of the object is at .6 of the height with 48 pixels, at .55 with 24.
  g_object_set(rig.element, "trigger-zones", "include 0,0.58 1,0.58 1,1 0,1", nullptr);
  rig.start();
  for (guint32 k = 0; k < 180; ++k) {
    rig.play_to(k);
    rig.analysis->push(picture(k, k < 100 ? 24 : k < 110 ? 48 : 0));
  }
  rig.finish();
  fail_unless(numbers_of(read_back(rig.folder.path() + "/1.mp4")) == range(70, 119));
}
GST_END_TEST

GST_START_TEST(zones_that_cannot_be_read_are_an_error_at_the_start_and_a_warning_later) {
  Rig rig;
  g_object_set(rig.element, "trigger-zones", "include 0,0 1,0", nullptr);
  fail_unless_equals_int(gst_element_set_state(rig.element, GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
  g_object_set(rig.element, "trigger-zones", "include 0,0 1,0 1,1", nullptr);
  rig.start();
  g_object_set(rig.element, "trigger-zones", "nonsense", nullptr);
  rig.play_to(1);
  g_autoptr(GstMessage) message = rig.take(GST_MESSAGE_WARNING);
  g_autoptr(GError) error = nullptr;
  gst_message_parse_warning(message, &error, nullptr);
  fail_unless(strstr(error->message, "nonsense"), "%s", error->message);
}
GST_END_TEST

// Each event has 41 frames of 40 kB, 1.6 MB.
GST_START_TEST(retention_deletes_the_oldest_recordings_but_those_that_are_kept) {
  Rig rig;
  g_object_set(rig.element, "retention-size", 4, nullptr);
  rig.frame_size = 40000;
  rig.start();
  if (!has_index(rig)) return;
  const auto event = [&](guint32 first) {
    rig.play_to(first + 60);
    rig.start_event();  // the pre-roll begins at the GOP of first + 30
    rig.stop_event();
    rig.play_to(first + 130);
    g_autoptr(GstStructure) ended = rig.wait_for_file("ended");
  };
  event(0);
  g_signal_emit_by_name(rig.element, "keep-recording", (rig.folder.path() + "/1.mp4").c_str(), TRUE);
  event(150);
  event(300);  // 4.9 MB
  g_autoptr(GstStructure) deleted = rig.wait_for_file("deleted");
  fail_unless(gst_structure_get_string(deleted, "location") == rig.folder.path() + "/2.mp4");
  rig.finish();
  const std::vector<std::string> expected = {rig.folder.path() + "/1.mp4", rig.folder.path() + "/3.mp4"};
  fail_unless(rig.folder.files() == expected);
}
GST_END_TEST

namespace {

// Stops the writer's thread in its report of a file that began, as a disk does that does not answer.
struct StuckDisk {
  std::mutex lock;
  std::condition_variable changed;
  bool stuck = true, reached = false, left = false, gone = false;

  static GstBusSyncReply handle(GstBus*, GstMessage* message, gpointer self) {
    auto& disk = *static_cast<StuckDisk*>(self);
    const GstStructure* facts = gst_message_get_structure(message);
    if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_ELEMENT ||
        !gst_structure_has_name(facts, "cerberus-recording"))
      return GST_BUS_PASS;
    std::unique_lock guard(disk.lock);
    if (std::exchange(disk.reached, true)) return GST_BUS_PASS;  // of the thread that stops the recorder
    disk.changed.notify_all();
    disk.changed.wait(guard, [&] { return !disk.stuck; });
    disk.left = true;
    disk.changed.notify_all();
    return GST_BUS_PASS;
  }
  // With data of the recorder, which is freed after all that it holds: a weak reference would be told before.
  void watch(GstElement* recorder) {
    g_object_set_data_full(G_OBJECT(recorder), "stuck-disk", this, note_gone);
  }
  static void note_gone(gpointer self) {
    auto& disk = *static_cast<StuckDisk*>(self);
    const std::lock_guard guard(disk.lock);
    disk.gone = true;
    disk.changed.notify_all();
  }
  void wait() {
    std::unique_lock guard(lock);
    changed.wait(guard, [&] { return reached; });
  }
  void release() {
    {
      const std::lock_guard guard(lock);
      stuck = false;
    }
    changed.notify_all();
  }
};

}  // namespace

GST_START_TEST(a_disk_that_does_not_answer_costs_the_event_and_never_stops_the_stream) {
  Rig rig;
  StuckDisk disk;
  gst_bus_set_sync_handler(rig.bus, StuckDisk::handle, &disk, nullptr);
  rig.frame_size = 1 << 20;
  rig.start();
  rig.play_to(20);
  rig.start_event();
  disk.wait();
  rig.play_to(100);  // 80 MiB, of which 64 may wait: these calls return although nothing is written
  disk.release();
  g_autoptr(GstMessage) warning = rig.take(GST_MESSAGE_WARNING);
  g_autoptr(GError) error = nullptr;
  gst_message_parse_warning(warning, &error, nullptr);
  fail_unless(strstr(error->message, "too slow"), "%s", error->message);
  g_autoptr(GstStructure) failed = rig.wait_for_file("failed");
  rig.frame_size = 64;
  rig.play_to(260);  // the next file is tried after 5 s
  rig.finish();
  const auto later = numbers_of(read_back(rig.folder.path() + "/1-2.mp4"));
  fail_unless(!later.empty() && later == range(later.front(), 260));
}
GST_END_TEST

GST_START_TEST(a_stop_does_not_wait_for_a_disk_that_does_not_answer_and_reports_what_is_lost) {
  StuckDisk disk;
  {
    Rig rig;
    gst_bus_set_sync_handler(rig.bus, StuckDisk::handle, &disk, nullptr);
    disk.watch(rig.element);
    rig.start();
    g_object_set(rig.element, "stop-timeout", 50 * GST_MSECOND, nullptr);
    rig.play_to(20);
    rig.start_event();
    disk.wait();
    rig.play_to(40);
    rig.stop();  // returns although the writer's thread hangs
    g_autoptr(GstMessage) warning = rig.take(GST_MESSAGE_WARNING);
    g_autoptr(GError) error = nullptr;
    gst_message_parse_warning(warning, &error, nullptr);
    fail_unless(strstr(error->message, (rig.folder.path() + "/1.mp4").c_str()), "%s", error->message);
    g_autoptr(GstStructure) failed = rig.wait_for_file("failed");
    fail_unless(gst_structure_get_string(failed, "location") == rig.folder.path() + "/1.mp4");
    g_object_set(rig.element, "stop-timeout", 20 * GST_SECOND, nullptr);
    rig.start();  // the folder is on another disk now
    rig.next = 0;
    rig.play_to(20);
    rig.start_event();
    rig.play_to(40);
    rig.finish();
    fail_unless(numbers_of(read_back(rig.folder.path() + "/2.mp4")) == range(0, 40));
  }
  fail_unless(!disk.gone);  // the thread holds the recorder
  disk.release();
  std::unique_lock guard(disk.lock);
  disk.changed.wait(guard, [&] { return disk.left && disk.gone; });
}
GST_END_TEST

GST_START_TEST(the_picture_of_an_event_that_ended_counts_among_the_bytes_that_wait_for_the_disk) {
  StuckDisk disk;
  {
    Rig rig;
    rig.analysis = std::make_unique<Stream>(rig.element, "analysis", kRaw);
    gst_bus_set_sync_handler(rig.bus, StuckDisk::handle, &disk, nullptr);
    disk.watch(rig.element);
    g_object_set(rig.element, "stop-timeout", guint64{0}, "json-lines", FALSE, nullptr);
    rig.start();
    for (guint32 k = 0; k < 120; ++k) {  // the event ends at frame 60
      rig.play_to(k);
      rig.analysis->push(picture(k, k < 50 ? 48 : 0));
    }
    disk.wait();
    rig.stop();
    g_autoptr(GstMessage) warning = rig.take(GST_MESSAGE_WARNING);
    g_autofree gchar* detail = nullptr;
    gst_message_parse_warning(warning, nullptr, &detail);
    const char* last = strrchr(detail, '\n');
    const long bytes = atol(last ? last + 1 : detail);
    fail_unless(bytes >= 320 * 240 && bytes < 320 * 240 + 120 * 64, "%s", detail);
  }
  disk.release();
  std::unique_lock guard(disk.lock);
  disk.changed.wait(guard, [&] { return disk.left && disk.gone; });
}
GST_END_TEST

GST_START_TEST(a_disk_that_does_not_answer_at_the_start_holds_nothing_up_and_costs_no_frame) {
  Rig rig;
  g_object_set(rig.element, "stop-timeout", guint64{0}, nullptr);
  blocked_folder.block(rig.folder.path());
  rig.start();
  g_autoptr(GstMessage) warning = rig.take(GST_MESSAGE_WARNING);
  g_autoptr(GError) error = nullptr;
  gst_message_parse_warning(warning, &error, nullptr);
  fail_unless(strstr(error->message, (rig.folder.path() + "\" does not answer").c_str()), "%s",
              error->message);
  rig.play_to(20);
  rig.start_event();
  rig.play_to(40);
  fail_unless(rig.folder.files().empty());
  blocked_folder.release();
  g_object_set(rig.element, "stop-timeout", 60 * GST_SECOND, nullptr);
  rig.finish();
  fail_unless(numbers_of(read_back(rig.folder.path() + "/1.mp4")) == range(0, 40));
}
GST_END_TEST

GST_START_TEST(a_start_and_a_stop_return_though_the_disk_never_answers) {
  StuckDisk disk;
  {
    Rig rig;
    g_object_set(rig.element, "stop-timeout", GST_CLOCK_TIME_NONE, nullptr);  // a start waits 5 s at most
    disk.watch(rig.element);
    blocked_folder.block(rig.folder.path());
    rig.start();
    rig.play_to(20);
    rig.start_event();
    rig.play_to(40);
    g_object_set(rig.element, "stop-timeout", guint64{0}, nullptr);
    rig.stop();
    g_autoptr(GstStructure) failed = rig.wait_for_file("failed");
  }
  fail_unless(!disk.gone);  // the thread holds the recorder
  blocked_folder.release();
  std::unique_lock guard(disk.lock);
  disk.changed.wait(guard, [&] { return disk.gone; });
}
GST_END_TEST

GST_START_TEST(a_pre_roll_larger_than_what_may_wait_for_the_disk_is_recorded) {
  Rig rig;
  g_object_set(rig.element, "pre-roll", 4 * GST_SECOND, nullptr);
  rig.frame_size = 640 << 10;
  rig.start();
  rig.play_to(119);
  rig.start_event();  // 110 frames of 640 KiB at once: 69 MiB
  rig.frame_size = 64;
  rig.play_to(125);
  rig.finish();
  fail_unless(numbers_of(read_back(rig.folder.path() + "/1.mp4")) == range(10, 125));
}
GST_END_TEST

// No process can make a file there; root only notices when it tries.
GST_START_TEST(a_folder_that_takes_no_files_is_named_and_stops_no_stream) {
  Rig rig;
  g_object_set(rig.element, "location", "/proc/self", nullptr);
  const bool starts = gst_element_set_state(rig.element, GST_STATE_PLAYING) != GST_STATE_CHANGE_FAILURE;
  if (starts) {
    rig.video->begin();
    rig.play_to(60);
    rig.start_event();
    rig.play_to(120);
  }
  while (true) {  // the index is complained of first
    g_autoptr(GstMessage) message =
        rig.take(static_cast<GstMessageType>(starts ? GST_MESSAGE_WARNING : GST_MESSAGE_ERROR));
    fail_unless(message != nullptr);
    g_autoptr(GError) error = nullptr;
    if (starts)
      gst_message_parse_warning(message, &error, nullptr);
    else
      gst_message_parse_error(message, &error, nullptr);
    fail_unless(strstr(error->message, "/proc/self") || strstr(error->message, "SQLite"), "%s",
                error->message);
    if (!starts || strstr(error->message, "/proc/self/1.mp4")) break;
  }
}
GST_END_TEST

static Suite* eventrecorder_archive_suite() {
  watch_library_log();
  Suite* suite = suite_create("eventrecorder archive");
  TCase* tests = tcase_create("archive");
  tcase_add_loop_test(tests, each_frame_of_a_file_has_its_line_however_late_the_analysis_is, 0, 2);
  tcase_add_test(tests, metadata_on_the_encoded_video_has_lines_in_the_order_of_time);
  tcase_add_test(tests, video_without_metadata_has_nothing_beside_it);
  tcase_add_test(tests, lines_and_picture_are_not_written_where_they_are_not_wanted);
  tcase_add_loop_test(tests, the_picture_is_the_frame_with_the_largest_object, 0, 2);
  tcase_add_test(tests, an_event_without_an_object_shows_its_beginning);
  tcase_add_test(tests, a_picture_is_as_black_and_as_white_as_the_video);
  tcase_add_test(tests, a_jpeg_stream_needs_no_analysis_for_its_picture);
  tcase_add_test(tests, the_message_of_the_end_names_what_is_beside_the_file);
  tcase_add_test(tests, only_tracks_in_the_zone_trigger);
  tcase_add_test(tests, zones_that_cannot_be_read_are_an_error_at_the_start_and_a_warning_later);
  tcase_add_test(tests, retention_deletes_the_oldest_recordings_but_those_that_are_kept);
  tcase_add_test(tests, a_disk_that_does_not_answer_costs_the_event_and_never_stops_the_stream);
  tcase_add_test(tests, a_stop_does_not_wait_for_a_disk_that_does_not_answer_and_reports_what_is_lost);
  tcase_add_test(tests, the_picture_of_an_event_that_ended_counts_among_the_bytes_that_wait_for_the_disk);
  tcase_add_test(tests, a_disk_that_does_not_answer_at_the_start_holds_nothing_up_and_costs_no_frame);
  tcase_add_test(tests, a_start_and_a_stop_return_though_the_disk_never_answers);
  tcase_add_test(tests, a_pre_roll_larger_than_what_may_wait_for_the_disk_is_recorded);
  tcase_add_test(tests, a_folder_that_takes_no_files_is_named_and_stops_no_stream);
  suite_add_tcase(suite, tests);
  return suite;
}

GST_CHECK_MAIN(eventrecorder_archive)
