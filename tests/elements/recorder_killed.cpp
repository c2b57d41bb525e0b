// SPDX-License-Identifier: LGPL-2.1-or-later
// A recorder is killed (kill -9) at random moments: every recording whose end was reported is whole and in the index,
// every other one plays as far as it was written, and the next start puts the index right.
//
// CERBERUS_KILLS=100: so many moments instead of a few, and as many of recorders that are fed in real time, whose open file
// then has all but its last second. (How much of a second is on the disk depends on a machine's other work.)
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <random>
#include <set>

#include "record/archive/index.h"
#include "recorder_rig.h"

using namespace recorder_rig;
namespace record = cerberus::record;

extern char** environ;

namespace {

constexpr int kUsualKills = 8;
constexpr char kInto[] = "CERBERUS_RECORD_INTO";  // the folder, for the program that is to be killed
constexpr char kLive[] = "CERBERUS_RECORD_LIVE";  // it is fed in real time after its first recording
constexpr char kPushed[] = "-";                   // in place of a file's name: the last frame that was pushed
constexpr char kRecorded[] = "CERBERUS_RECORDED", kRecordedIn[] = "CERBERUS_RECORDED_IN";
constexpr int kReports = 9;  // its file descriptor

}  // namespace

// Records one event after the other, and reports each file whose end was reported, with its first and last frame, until
// the process is killed.
GST_START_TEST(records_until_killed) {
  const char* folder = getenv(kInto);
  FILE* reports = fdopen(kReports, "w");
  Rig rig;
  std::filesystem::remove_all(rig.folder.path());  // nothing else would
  g_object_set(rig.element, "location", folder, "file-name", "{camera}_{event}", "camera-name",
               std::to_string(getpid()).c_str(), nullptr);
  rig.analysis =
      std::make_unique<Stream>(rig.element, "analysis", "video/x-raw, format=GRAY8, width=320, height=240");
  rig.frame_size = 2000;
  rig.start();
  const auto play_to = [&](guint32 last) {
    while (rig.next <= last) {
      const guint32 number = rig.next;
      rig.play_to(number);
      GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 320 * 240, nullptr);
      gst_buffer_memset(buffer, 0, 100, 320 * 240);
      GST_BUFFER_PTS(buffer) = number * kFrame;
      rig.analysis->push(buffer);
    }
  };
  for (guint32 first = 0;; first += 200) {
    play_to(first + 60);
    rig.start_event();  // the pre-roll begins at the GOP of first + 30
    while (first && getenv(kLive)) {
      play_to(rig.next);
      fprintf(reports, "%u %u %s\n", first + 30, rig.next - 1, kPushed);
      fflush(reports);
      g_usleep(kFrame / GST_USECOND);
    }
    play_to(first + 100);
    rig.stop_event();
    play_to(first + 199);
    g_autoptr(GstStructure) ended = rig.wait_for_file("ended");
    fprintf(reports, "%u %u %s\n", first + 30, first + 110, gst_structure_get_string(ended, "location"));
    fflush(reports);
  }
}
GST_END_TEST

namespace {

struct Acknowledged {
  guint32 first, last;
  std::string file;
};

// Runs the recorder for so many milliseconds after its first recording, kills it, and returns what it acknowledged; last
// of all what was pushed of an event that is fed in real time.
std::vector<Acknowledged> run_and_kill(const std::string& folder, int milliseconds, bool live) {
  int ends[2];
  fail_unless(pipe(ends) == 0);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], kReports);
  posix_spawn_file_actions_addclose(&actions, ends[0]);
  char program[] = "/proc/self/exe";
  char* arguments[] = {program, nullptr};
  const std::string into = std::string(kInto) + '=' + folder;
  std::vector<char*> environment;
  for (char** each = environ; *each; ++each)
    if (!g_str_has_prefix(*each, "CK_FORK=")) environment.push_back(*each);
  for (const std::string& text :
       {into, std::string("CK_FORK=no"), live ? std::string(kLive) + "=1" : std::string("_=")})
    environment.push_back(strdup(text.c_str()));
  environment.push_back(nullptr);
  pid_t child = 0;
  fail_unless_equals_int(posix_spawn(&child, program, &actions, nullptr, arguments, environment.data()), 0);
  for (std::size_t k = environment.size() - 4; k + 1 < environment.size(); ++k) free(environment[k]);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  FILE* output = fdopen(ends[0], "r");
  std::vector<Acknowledged> all;
  char file[1000];
  Acknowledged next;
  bool killed = false;
  while (fscanf(output, "%u %u %999s", &next.first, &next.last, file) == 3) {
    next.file = file;
    if (all.empty() || all.back().file != kPushed) all.emplace_back();
    all.back() = next;
    if (killed) continue;
    g_usleep(static_cast<gulong>(milliseconds) * 1000);
    kill(child, SIGKILL);
    killed = true;  // what was reported before is still in the pipe
  }
  fclose(output);
  int status = 0;
  waitpid(child, &status, 0);
  fail_unless(killed && WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  if (!all.empty() && all.back().file == kPushed)
    all.back().file += folder + '/' + std::to_string(child) + "_2.mp4";
  return all;
}

std::vector<record::Recording> rows_of(const std::string& folder) {
  record::Index index;
  bool damaged = false;
  const std::string fault = index.open(folder + "/recordings.sqlite", damaged);  // checks its integrity
  fail_unless(fault.empty(), "%s", fault.c_str());
  std::vector<record::Recording> rows;
  fail_unless(index.read(rows).empty());
  return rows;
}

void check_acknowledged(const std::vector<Acknowledged>& all, const std::string& folder) {
  const auto rows = rows_of(folder);
  for (const Acknowledged& each : all) {
    fail_unless(numbers_of(read_back(each.file)) == range(each.first, each.last), "%s", each.file.c_str());
    const std::string name = std::filesystem::path(each.file).filename();
    const auto row = std::ranges::find(rows, name, &record::Recording::file);
    fail_unless(row != rows.end() && !row->open, "%s has no closed row", name.c_str());
    const std::string base = each.file.substr(0, each.file.rfind('.'));
    guint64 bytes = 0;
    for (const char* ending : {".mp4", ".jsonl", ".jpg"}) bytes += std::filesystem::file_size(base + ending);
    fail_unless_equals_uint64(row->bytes, bytes);
  }
}

// Whether the recorder was killed in the moment in which mp4mux completes the file, so that the next start repairs it.
bool is_being_completed(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  return bytes.find("moov") == std::string::npos && bytes.find("hoov") != std::string::npos;
}

// What was not acknowledged: whole frames from a keyframe on, without a hole.
void check_open(const std::vector<Acknowledged>& all, const std::string& folder, bool restarted) {
  const auto rows = rows_of(folder);
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string file = entry.path();
    if (entry.path().extension() != ".mp4" || entry.file_size() == 0) continue;
    if (!restarted && entry.file_size() < 41 * 2000) continue;  // perhaps before its first fragment
    const auto row = std::ranges::find(rows, entry.path().filename().string(), &record::Recording::file);
    if (restarted && row != rows.end() && row->broken) continue;
    if (std::ranges::count(all, file, &Acknowledged::file)) continue;
    if (!restarted && is_being_completed(file)) continue;
    const auto frames = read_back(file);
    fail_unless(!frames.empty() && frames[0].keyframe, "%s", file.c_str());
    const guint32 first = frames[0].number;
    fail_unless(numbers_of(frames) == range(first, first + static_cast<guint32>(frames.size()) - 1), "%s",
                file.c_str());
  }
}

// How many of its frames a file lacks that was written in real time and is open: the frames of the last second at most.
int check_last_second(const Acknowledged& pushed) {
  const std::string file = pushed.file.substr(strlen(kPushed));
  std::error_code none;
  const auto size = std::filesystem::file_size(file, none);
  const auto frames = none || size < 41 * 2000 ? std::vector<Frame>() : read_back(file);
  // The event began 30 frames behind its pre-roll.
  const guint32 last = frames.empty() ? pushed.first + 30 : frames.back().number;
  fail_unless(frames.empty() || numbers_of(frames) == range(pushed.first, last), "%s", file.c_str());
  fail_unless(last + 25 >= pushed.last, "%s ends with frame %u of %u", file.c_str(), last, pushed.last);
  return static_cast<int>(pushed.last - std::min(last, pushed.last));
}

// The next start closes every row, and each file that holds anything has one.
void check_restart(const std::string& folder) {
  {
    Rig rig;
    g_object_set(rig.element, "location", folder.c_str(), nullptr);
    fail_if(gst_element_set_state(rig.element, GST_STATE_PAUSED) == GST_STATE_CHANGE_FAILURE);
  }
  const auto rows = rows_of(folder);
  for (const auto& row : rows) {
    fail_if(row.open, "%s is still open", row.file.c_str());
    fail_unless(std::filesystem::exists(folder + '/' + row.file));
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".mp4" || entry.file_size() == 0) continue;
    const std::string name = entry.path().filename();
    fail_unless(std::ranges::count(rows, name, &record::Recording::file) == 1, "%s has no row", name.c_str());
  }
}

}  // namespace

namespace {

std::string content_of(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {(std::istreambuf_iterator<char>(stream)), {}};
}

// A recording of 71 frames: as it is on the disk while it is written, and complete.
std::array<std::string, 2> bytes_of_recording(bool mp4) {
  Rig rig;
  if (!mp4) gst_util_set_object_arg(G_OBJECT(rig.element), "container", "matroska");
  rig.frame_size = 500;
  rig.start();
  rig.play_to(40);
  rig.start_event();
  g_autoptr(GstStructure) started = rig.wait_for_file("started");
  const std::string file = gst_structure_get_string(started, "location");
  rig.play_to(80);
  std::string open;
  for (std::string last = "-"; open.size() < 60 * 500 || open != last; g_usleep(50 * 1000)) {
    last = open;
    open = content_of(file);
  }
  rig.finish();
  return {open, content_of(file)};
}

// Lengths at which something begins or ends, and some between.
std::set<std::size_t> cuts_of(const std::string& bytes, bool mp4) {
  std::set<std::size_t> cuts;
  for (std::size_t k = 1; k < 80; k += 3) cuts.insert(k);
  for (std::size_t k = 80; k < bytes.size(); k += bytes.size() / 30) cuts.insert(k);
  std::size_t boxes = 0;
  for (std::size_t at = 0; mp4 && at + 8 <= bytes.size() && boxes < 12; ++boxes) {
    std::size_t size = 0;
    for (std::size_t k = 0; k < 4; ++k) size = size << 8 | static_cast<unsigned char>(bytes[at + k]);
    for (const std::size_t beside : {at + 1, at + 4, at + 8, at + 9, at + size - 1, at + size})
      if (beside < bytes.size()) cuts.insert(beside);
    if (size < 8) break;
    at += size;
  }
  return cuts;
}

}  // namespace

// Of an open row: what is offered plays, and what plays is offered.
GST_START_TEST(a_file_that_was_cut_off_anywhere_plays_or_is_marked_as_broken) {
  const bool mp4 = __i__ == 0;
  const std::string ending = mp4 ? ".mp4" : ".mkv";
  Folder folder;
  record::Index index;
  bool damaged = false;
  fail_unless(index.open(folder.path() + "/recordings.sqlite", damaged).empty());
  int number = 0;
  for (const std::string& bytes : bytes_of_recording(mp4))
    for (const std::size_t cut : cuts_of(bytes, mp4)) {
      record::Recording row;
      row.file = std::to_string(++number) + '_' + std::to_string(cut) + ending;
      std::ofstream(folder.path() + '/' + row.file, std::ios::binary) << bytes.substr(0, cut);
      bool taken = false;
      fail_unless(index.add(row, taken).empty());
    }
  index.close();
  check_restart(folder.path());
  int broken = 0, sound = 0;
  for (const auto& row : rows_of(folder.path())) {
    std::vector<Frame> frames;
    try_to_read(folder.path() + '/' + row.file, frames);  // what follows the last whole frame may be an error
    fail_unless(row.broken == frames.empty(), "%s: %d frames, broken %d", row.file.c_str(),
                static_cast<int>(frames.size()), row.broken);
    for (std::size_t k = 0; k < frames.size(); ++k)
      fail_unless(frames[k].number == frames[0].number + k, "%s", row.file.c_str());
    ++(row.broken ? broken : sound);
  }
  fail_unless(broken > 10 && sound > 10, "%d broken, %d sound", broken, sound);
}
GST_END_TEST

GST_START_TEST(a_killed_recorder_loses_nothing_that_it_acknowledged) {
  const char* wanted = getenv("CERBERUS_KILLS");
  const int kills = wanted ? 2 * std::max(1, atoi(wanted)) : kUsualKills;
  std::mt19937 random(std::random_device{}());
  Folder folder;
  std::vector<Acknowledged> all;
  int most_lacking = 0;
  for (int k = 0; k < kills; ++k) {
    const bool live = wanted && k % 2;
    auto more = run_and_kill(folder.path(), static_cast<int>(random() % (live ? 3000 : 100)), live);
    if (more.back().file.starts_with(kPushed)) {
      most_lacking = std::max(most_lacking, check_last_second(more.back()));
      more.pop_back();
    }
    all.insert(all.end(), more.begin(), more.end());
    check_acknowledged(more, folder.path());
    check_open(all, folder.path(), false);
    if (k % 4 == 3) check_restart(folder.path());
  }
  check_restart(folder.path());
  check_open(all, folder.path(), true);
  check_acknowledged(all, folder.path());
  g_print("%d kills: %d recordings were acknowledged, all of them whole", kills,
          static_cast<int>(all.size()));
  if (wanted) g_print("; open ones lack the last %d frames at most", most_lacking);
  g_print("\n");
}
GST_END_TEST

// After power cuts, for tests/hardware/power_cut.py: of what was acknowledged each line has first frame, last frame,
// file.
GST_START_TEST(what_was_acknowledged_before_a_power_cut_is_whole) {
  std::vector<Acknowledged> all;
  std::ifstream reports(getenv(kRecorded));
  Acknowledged next;
  while (reports >> next.first >> next.last >> next.file) all.push_back(next);
  fail_unless(!all.empty());
  const std::string folder = getenv(kRecordedIn);
  check_acknowledged(all, folder);
  check_restart(folder);
  check_acknowledged(all, folder);
}
GST_END_TEST

static Suite* recorder_killed_suite() {
  Suite* suite = suite_create("recorder killed");
  TCase* tests = tcase_create("killed");
  tcase_set_timeout(tests, getenv("CERBERUS_KILLS") ? 1000 : 60);
  if (getenv(kInto))
    tcase_add_test(tests, records_until_killed);
  else if (getenv(kRecorded))
    tcase_add_test(tests, what_was_acknowledged_before_a_power_cut_is_whole);
  else
    tcase_add_test(tests, a_killed_recorder_loses_nothing_that_it_acknowledged);
  if (!getenv(kInto) && !getenv(kRecorded))
    tcase_add_loop_test(tests, a_file_that_was_cut_off_anywhere_plays_or_is_marked_as_broken, 0, 2);
  suite_add_tcase(suite, tests);
  return suite;
}

GST_CHECK_MAIN(recorder_killed)
