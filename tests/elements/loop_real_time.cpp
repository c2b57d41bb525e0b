// SPDX-License-Identifier: LGPL-2.1-or-later
// From the edge of a PIR sensor to the first command of the motors at most 60 ms pass in a live pipeline. Nothing
// waits (loop_promise.cpp); what remains is processing time, and it is measured here, in real time. On a machine that
// is late itself the test is skipped with a message.
#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

// gst-check's macros bite standard headers: last.
#include "head_rig.h"
#include "loop.h"

namespace {

constexpr GstClockTime kPromise = 60 * GST_MSECOND;

struct Command {
  GstClockTime time;
  int way;
};

// A command to the head, with the running time at which it was given.
class Listener {
 public:
  Listener(const head_rig::Pipe& record, GstElement* pipeline)
      : thread_([this, &record, pipeline] {
          for (std::string line = record.line(); !line.empty(); line = record.line())
            commands_.push_back({gst_element_get_current_running_time(pipeline), head_rig::way_of(line)});
        }) {}
  // The writer is closed.
  const std::vector<Command>& commands() {
    if (thread_.joinable()) thread_.join();
    return commands_;
  }
  ~Listener() { commands(); }

 private:
  std::vector<Command> commands_;
  std::thread thread_;
};

constexpr int kEdges = 50;

GstClockTime edge(int k) {
  return (300 + 113 * static_cast<GstClockTime>(k)) * GST_MSECOND;
}

// A thread that does nothing but wake up at each edge: its lateness is that of the machine.
class Witness {
 public:
  explicit Witness(GstElement* pipeline) : thread_([this, pipeline] { run(pipeline); }) {}
  // When the pipeline has ended: whether the machine itself kept half the promise, nine times in ten.
  bool saw_a_prompt_machine() {
    stop();
    return prompt_ >= kEdges * 9 / 10;
  }
  ~Witness() { stop(); }
  Witness(const Witness&) = delete;

 private:
  void run(GstElement* pipeline) {
    for (int k = 0; k < kEdges && !over_; ++k) {
      GstClockTime now = 0;
      while (!over_ && (now = gst_element_get_current_running_time(pipeline)) < edge(k))
        std::this_thread::sleep_for(std::chrono::nanoseconds(edge(k) - now));
      prompt_ += now <= edge(k) + kPromise / 2;
    }
  }
  void stop() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
  }

  std::atomic<bool> over_ = false;
  int prompt_ = 0;
  std::thread thread_;
};

struct Round {
  std::vector<double> took;  // of the edges that were obeyed before the next one came: milliseconds, sorted
  bool counts = false;       // the machine had time for them
};

Round reactions() {
  const auto way = [](int k) { return k % 2 ? 1 : -1; };
  std::string script = "0,0,0,0";
  for (int k = 0; k < kEdges; ++k)
    script += "; " + std::to_string(edge(k) / 1e9) + (way(k) < 0 ? ",0,1,0" : ",0,0,1") + "; " +
              std::to_string(edge(k) / 1e9 + 0.06) + ",0,0,0";
  const std::string name = head_rig::new_head();
  head_rig::Pipe record;
  std::vector<Command> commands;
  Round round;
  {
    // The head reaches neither sensor's sector: it is always on the way there, or at the stop before it. The picture
    // moves as before a turning camera, which costs most; it contains no person.
    loop::Pipeline pipeline(
        "videotestsrc is-live=true num-buffers=62 pattern=pinwheel horizontal-speed=2 ! "
        "video/x-raw,format=GRAY8,width=160,height=120,framerate=10/1 ! motiondetect ! "
        "pirfusion name=fusion head=" +
        name + " pan-min=-10 pan-max=10 ! pantiltsink pan-min=-10 pan-max=10 " +
        head_rig::scripted("record " + record.writer(), name) +
        " pirsrc driver=scripted is-live=true script=\"" + script + "\" ! fusion.pir_0");
    Listener listener(record, pipeline.element());
    pipeline.play();
    Witness witness(pipeline.element());
    pipeline.wait_for_end();
    round.counts = witness.saw_a_prompt_machine();
    pipeline.stop();
    record.close_writer();
    commands = listener.commands();
  }

  for (int k = 0; k < kEdges; ++k) {
    const auto first = std::ranges::find_if(
        commands, [&](const Command& c) { return c.time >= edge(k) && c.way == way(k); });
    if (first != commands.end() && first->time < edge(k + 1))
      round.took.push_back(static_cast<double>(first->time - edge(k)) / GST_MSECOND);
  }
  std::ranges::sort(round.took);
  return round;
}

// No round was judged. A test runs in a process of its own: its result reaches main() through shared memory.
std::atomic<bool>& judged_nothing() {
  static void* const place =
      mmap(nullptr, sizeof(std::atomic<bool>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  g_assert(place != MAP_FAILED);
  return *static_cast<std::atomic<bool>*>(place);
}

// A machine with other work may be late with any of them, and for a while with many: one good round of several is
// enough. At 10 frames a second four of ten edges would be late if they waited for a frame: seven of ten in time prove
// that they do not. Rounds in which the machine itself was late are not judged.
GST_START_TEST(sixty_milliseconds_from_an_edge_to_the_motors) {
  bool kept = false;
  int rounds = 0;
  for (int k = 0; k < 5 && !kept; ++k) {
    const auto [took, counts] = reactions();
    rounds += counts;
    g_print("%zu of %d edges obeyed%s", took.size(), kEdges,
            counts ? "" : " by a machine that is late itself");
    if (!took.empty())
      g_print(": best %.1f, median %.1f, worst %.1f ms", took.front(), took[took.size() / 2], took.back());
    g_print("\n");
    kept = took.size() >= kEdges * 4 / 5 && took[took.size() * 7 / 10] <= kPromise / 1e6;
  }
  judged_nothing() = !kept && rounds == 0;
  fail_unless(kept || judged_nothing(), "in none of the rounds above most edges were obeyed in time");
}
GST_END_TEST

Suite* loop_real_time_suite() {
  Suite* suite = suite_create("loop_real_time");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 90);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_test(tests, sixty_milliseconds_from_an_edge_to_the_motors);
  return suite;
}

}  // namespace

int main(int argc, char** argv) {
  judged_nothing() = false;
  gst_check_init(&argc, &argv);
  const int failed = gst_check_run_suite(loop_real_time_suite(), "loop_real_time", __FILE__);
  if (failed || !judged_nothing()) return failed;
  std::printf("skipped: in no round had this machine time to wake up on time, so nothing was judged\n");
  return 77;
}
