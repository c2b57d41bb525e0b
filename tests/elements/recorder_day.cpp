// SPDX-License-Identifier: LGPL-2.1-or-later
// Hours of a camera in seconds: memory stays flat and the disk within its limit.
//
// CERBERUS_HOURS=24: so many hours instead of one.
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "recorder_rig.h"

using namespace recorder_rig;

namespace {

constexpr int kUsualHours = 1;
constexpr guint32 kHour = 25 * 3600;         // frames
constexpr guint32 kBetween = 25 * 120;       // an event begins every two minutes
constexpr guint32 kEvent = 25 * 20;          // and an object moves for so long
constexpr std::uintmax_t kLimit = 2 << 20;   // bytes on the disk
constexpr std::uintmax_t kOpen = 400 << 10;  // of an event: 22 s of 300 bytes a frame and 400 a line

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kMemoryCounts = false;  // a sanitizer keeps what was freed
#else
constexpr bool kMemoryCounts = true;
#endif

// A source that is no live one: the recorder makes it wait for the disk.
gboolean answer(GstPad* pad, GstObject* parent, GstQuery* query) {
  if (GST_QUERY_TYPE(query) != GST_QUERY_LATENCY) return gst_pad_query_default(pad, parent, query);
  gst_query_set_latency(query, FALSE, 0, GST_CLOCK_TIME_NONE);
  return TRUE;
}

GstBuffer* analysed(guint32 number, bool moves) {
  GstBuffer* buffer = gst_buffer_new();
  GST_BUFFER_PTS(buffer) = number * kFrame;
  g_autoptr(GPtrArray) none = g_ptr_array_new();
  cerberus_buffer_set_regions(buffer, none);
  if (!moves) return buffer;
  g_autoptr(CerberusRegion) region = cerberus_region_new();
  region->id = number / kBetween;
  region->tracked = TRUE;
  region->width = region->height = 20;
  cerberus_buffer_add_region(buffer, region);
  return buffer;
}

std::uintmax_t bytes_in(const Folder& folder) {
  std::uintmax_t sum = 0;
  for (const auto& file : folder.files({".mp4", ".jsonl", ".jpg"})) {
    std::error_code gone;  // retention goes on meanwhile
    const std::uintmax_t size = std::filesystem::file_size(file, gone);
    if (!gone) sum += size;
  }
  return sum;
}

double mebibytes_of_memory() {
  std::ifstream file("/proc/self/statm");
  double pages = 0;
  file >> pages >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

}  // namespace

GST_START_TEST(memory_stays_flat_and_the_disk_within_its_limit) {
  const char* wanted = getenv("CERBERUS_HOURS");
  const guint32 frames = static_cast<guint32>(wanted ? std::max(1, atoi(wanted)) : kUsualHours) * kHour;
  Rig rig(50);
  g_object_set(rig.element, "retention-size", static_cast<int>(kLimit >> 20), nullptr);
  rig.analysis =
      std::make_unique<Stream>(rig.element, "analysis", "video/x-raw, format=GRAY8, width=320, height=240");
  gst_pad_set_query_function(rig.video->source(), answer);
  rig.frame_size = 200;
  rig.start();
  const bool has_index = std::filesystem::exists(rig.folder.path() + "/recordings.sqlite");
  double early = 0;
  int files = 0;
  for (guint32 k = 0; k < frames; ++k) {
    rig.play_to(k);
    rig.analysis->push(analysed(k, k % kBetween >= kBetween - kEvent));
    if (k < kBetween || k % kBetween != kBetween / 2) continue;  // the event is over
    g_autoptr(GstStructure) ended = rig.wait_for_file("ended");
    ++files;
    if (has_index)
      fail_unless(bytes_in(rig.folder) <= kLimit + kOpen, "%d kB",
                  static_cast<int>(bytes_in(rig.folder) >> 10));
    if (k == frames / 4 / kBetween * kBetween + kBetween / 2) early = mebibytes_of_memory();
  }
  const double late = mebibytes_of_memory();
  g_print("%d files, memory %.1f MiB after a quarter and %.1f MiB at the end\n", files, early, late);
  if (kMemoryCounts) fail_unless(late <= early + 4, "%.1f MiB became %.1f MiB", early, late);
  fail_unless_equals_int(files, static_cast<int>(frames / kBetween) - 1);
}
GST_END_TEST

static Suite* recorder_day_suite() {
  watch_library_log();
  Suite* suite = suite_create("recorder day");
  TCase* tests = tcase_create("day");
  tcase_set_timeout(tests, getenv("CERBERUS_HOURS") ? 3000 : 60);
  tcase_add_test(tests, memory_stays_flat_and_the_disk_within_its_limit);
  suite_add_tcase(suite, tests);
  return suite;
}

GST_CHECK_MAIN(recorder_day)
