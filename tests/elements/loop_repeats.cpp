// SPDX-License-Identifier: LGPL-2.1-or-later
// The closed loop gives the same JSON lines, byte by byte, however its work is spread over threads and whatever the
// load of the machine. The video shows a person who walks before a wall or, with CERBERUS_SEQUENCE=vtest in the
// environment, is vtest.avi; where that is missing the test is skipped with a message.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "support/data.h"
// gst-check's macros bite standard headers: last.
#include "loop.h"

namespace {

enum Way : unsigned { kPlain = 0, kQueues = 1, kBusy = 2 };

bool on_vtest() {
  return std::getenv("CERBERUS_SEQUENCE") != nullptr;
}

// The whole loop. `link` stands between any two elements.
std::string loop_line(const std::string& link, int seed) {
  const std::string video = on_vtest() ? *cerberus::tests::vtest_source() + " ! " : loop::film(70);
  const std::string view = on_vtest() ? "wide-fov=60 horizontal-fov=27.05 width=320 height=240"
                                      : "wide-fov=60 horizontal-fov=32.2 width=160 height=120";
  return video + "virtualptz " + view + link + "motiondetect" + link +
         "pirfusion name=fusion horizontal-fov=30 pan-min=-16 pan-max=16" + link +
         "tee name=t pirsrc driver=scripted bearings=0,-20,20 field-of-view=20 "
         "script=\"0,0,0,0; 0.2,0,1,0; 0.9,0,0,0; 1.3,0,0,1; 2,1,0,1; 2.2,0,0,0; 60,0,0,0\"" +
         link +
         "fusion.pir_0 "
         // First the sink that waits for a frame before it plays: without queues it is the other's thread.
         "t." +
         link + "motionjson" + link +
         "fakesink name=lines "
         // The noise is that of the head's position feedback: it depends on the seed.
         "t." +
         link +
         "pantiltsink driver=simulated noise=0.05 step-size=0.02 backlash=0.1 seed=" + std::to_string(seed) +
         " horizontal-fov=30 pan-min=-16 pan-max=16 tilt-min=-12 tilt-max=12";
}

// Threads that do nothing, as fast as they can, as long as they live.
class Load {
 public:
  explicit Load(int threads) {
    for (int k = 0; k < threads; ++k)
      threads_.emplace_back([this] {
        while (!quit_) {
        }
      });
  }
  ~Load() {
    quit_ = true;
    for (std::thread& each : threads_) each.join();
  }
  Load(const Load&) = delete;

 private:
  std::atomic<bool> quit_ = false;
  std::vector<std::thread> threads_;
};

std::string lines_of(unsigned way, int seed = 7) {
  const Load load(way & kBusy ? 2 : 0);
  loop::Pipeline pipeline(loop_line(way & kQueues ? " ! queue ! " : " ! ", seed));
  std::string lines;
  auto append = [&](GstBuffer* buffer) {
    GstMapInfo map;
    fail_unless(gst_buffer_map(buffer, &map, GST_MAP_READ));
    lines.append(reinterpret_cast<const char*>(map.data), map.size);
    gst_buffer_unmap(buffer, &map);
  };
  pipeline.watch("lines", append);
  pipeline.play();
  pipeline.wait_for_end();
  pipeline.stop();
  return lines;
}

// The first line in which two runs differ, for debugging.
std::string difference(const std::string& a, const std::string& b) {
  const auto at =
      static_cast<std::size_t>(std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first - a.begin());
  const auto line = [at](const std::string& text) {
    const std::size_t begin = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
    return text.substr(begin, text.find('\n', begin) - begin);
  };
  return line(a) + "\n" + line(b);
}

const std::string& reference() {
  static const std::string lines = lines_of(kPlain);
  return lines;
}

GST_START_TEST(every_run_gives_the_same_lines) {
  const std::string again = lines_of(static_cast<unsigned>(__i__));
  fail_unless(again == reference(), "way %d:\n%s", __i__, difference(reference(), again).c_str());
}
GST_END_TEST

// The comparison needs something that could differ: the head turns, tracks a person, uses the sensors, and its noise
// has an effect.
GST_START_TEST(the_lines_come_from_a_closed_loop) {
  for (const char* part :
       {"\"track\"", "\"turn-left\"", "\"moving\":true", "\"pir\":[0,1,0]", "\"pir\":[1,0,1]"})
    fail_unless(reference().find(part) != std::string::npos, "no %s in\n%s", part, reference().c_str());
  fail_if(lines_of(kPlain, 8) == reference());
}
GST_END_TEST

Suite* loop_repeats_suite() {
  Suite* suite = suite_create("loop_repeats");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  // A whole video costs more: only what differs most.
  tcase_add_loop_test(tests, every_run_gives_the_same_lines, on_vtest() ? kQueues | kBusy : kPlain,
                      (kQueues | kBusy) + 1);
  if (!on_vtest()) tcase_add_test(tests, the_lines_come_from_a_closed_loop);
  return suite;
}

}  // namespace

int main(int argc, char** argv) {
  if (on_vtest() && !cerberus::tests::vtest_source()) {
    std::printf("skipped: %s\n", cerberus::tests::kNoVtest);
    return 77;
  }
  gst_check_init(&argc, &argv);
  return gst_check_run_suite(loop_repeats_suite(), "loop_repeats", __FILE__);
}
