// SPDX-License-Identifier: LGPL-2.1-or-later
// A device that waits in its calls. It waits for the test, so nothing here depends on a clock.
#include "drivers/head/threaded_device.h"

#include <poll.h>

#include <condition_variable>
#include <mutex>
#include <vector>

#include "drivers/helper/head_server.h"
#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::motion::AxisCommand;
using cerberus::motion::kNever;
using cerberus::motion::Limits;
using cerberus::tests::assert_text;
using Kind = AxisCommand::Kind;

namespace {

constexpr auto kLong = 60s;  // for what takes no time

// What the device did, and how long it waits: as long as the test holds it. Outlives the device.
struct Diary {
  std::mutex lock;
  std::condition_variable changed;
  std::vector<std::string> calls;
  std::string holds;  // the call in which it waits
  bool waits = false, gone = false;
  std::string wrong, fault;
  std::optional<PoseLine> pose;
  std::optional<SpeedsLine> speeds;

  void note(const std::string& call) {
    std::unique_lock guard(lock);
    calls.push_back(call);
    if (holds != call) return;
    waits = true;
    changed.notify_all();
    changed.wait(guard, [&] { return holds != call; });
    waits = false;
  }
  void hold(const std::string& call) {
    const std::lock_guard guard(lock);
    holds = call;
    changed.notify_all();
  }
  void let_go() { hold(""); }
  void until_it_waits() {
    std::unique_lock guard(lock);
    ck_assert(changed.wait_for(guard, kLong, [&] { return waits; }));
  }
  void until_it_is_gone() {
    std::unique_lock guard(lock);
    ck_assert(changed.wait_for(guard, kLong, [&] { return gone; }));
  }
  // The calls but for tick.
  std::string take() {
    const std::lock_guard guard(lock);
    std::string all;
    for (const std::string& call : std::exchange(calls, {}))
      if (call != "tick") all += (all.empty() ? "" : ", ") + call;
    return all;
  }
};

class Slow final : public HeadDevice {
 public:
  explicit Slow(std::shared_ptr<Diary> diary) : diary_(std::move(diary)) {}
  ~Slow() override {
    const std::lock_guard guard(diary_->lock);
    diary_->gone = true;
    diary_->changed.notify_all();
  }
  std::string check() const override { return "what it says"; }
  std::string open(const HeadSetup&, Time) override {
    diary_->note("open");
    return diary_->wrong;
  }
  HeadAbilities abilities() const override { return {.velocity = true, .rate = 20}; }
  void move(const AxisCommand& pan, const AxisCommand&, Time) override {
    diary_->note("move " + std::to_string(std::lround(cerberus::sensing::degrees(pan.value))));
  }
  void limit(const Limits&, Time) override { diary_->note("limit"); }
  void stop(Time) noexcept override { diary_->note("stop"); }
  void leave(Time) noexcept override { diary_->note("leave"); }
  void release(Time) noexcept override { diary_->note("release"); }
  void home(Time) override { diary_->note("home"); }
  void zoom(double position, Time) override {
    diary_->note("zoom " + std::to_string(std::lround(100 * position)));
  }
  bool stopping() const override { return false; }
  void watch(std::vector<pollfd>&) const override {}
  Time tick(Time now) override {
    diary_->note("tick");
    return now + 50ms;
  }
  std::optional<PoseLine> take_pose(Time) override { return std::exchange(diary_->pose, std::nullopt); }
  std::optional<SpeedsLine> take_speeds(Time) override { return std::exchange(diary_->speeds, std::nullopt); }
  std::string fault() const override { return diary_->fault; }

 private:
  std::shared_ptr<Diary> diary_;
};

// A helper of such a device.
struct Rig {
  std::shared_ptr<Diary> diary = std::make_shared<Diary>();
  ThreadedDevice device;
  std::vector<std::string> lines;
  HeadServer server{device, [this](const std::string& line) { lines.push_back(line); }};

  explicit Rig(Patience patience = kLong)
      : device(std::make_unique<Slow>(diary), "the camera /dev/video9", patience) {}
  void open() {
    server.obey("cerberus-head 1 timeout 10 limits -90 90 -30 30 speed 60 60 acceleration 90 90 start 0 0",
                1s);
    ck_assert_uint_eq(lines.size(), 1);
    diary->take();
  }
  void hold(const std::string& call, const std::string& line, Time now) {
    diary->hold(call);
    server.obey(line, now);
    diary->until_it_waits();
    diary->take();
  }
  // Serves as the loop does until the device has nothing left to do.
  void settle(Time now) {
    std::vector<pollfd> fds;
    device.watch(fds);
    do {
      server.serve(now);
      if (!device.idle()) ck_assert_int_eq(::poll(fds.data(), fds.size(), 60'000), 1);
    } while (!device.idle());
    server.serve(now);
  }
  bool says(const std::string& line) const {
    return std::find(lines.begin(), lines.end(), line) != lines.end();
  }
};

}  // namespace

START_TEST(a_device_that_waits_keeps_no_answer_to_alive_waiting) {
  Rig rig;
  assert_text(rig.device.check(), "what it says");
  rig.open();
  assert_text(rig.lines[0], "ready 1 velocity alive rate 20");
  rig.hold("move 30", "move at 30 hold", 1s);
  for (Time now = 1s; now < 2s; now += 100ms) {
    rig.lines.clear();
    rig.server.obey("alive", now);
    rig.server.serve(now);
    assert_text(rig.lines.at(0), "alive");
    ck_assert_uint_eq(rig.lines.size(), 1);  // a second of waiting is no fault
  }
  rig.diary->let_go();
  rig.settle(2s);
  ck_assert(!rig.says("recovered"));
}
END_TEST

START_TEST(of_the_commands_that_wait_the_stop_is_the_first_and_the_newest_move_the_last) {
  Rig rig;
  rig.open();
  rig.hold("move 30", "move at 30 hold", 1s);
  for (const char* line :
       {"move at 1 hold", "home", "limits -80 80 -20 20", "stop", "home", "move at 2 hold", "move at 3 hold"})
    rig.server.obey(line, 1s);
  rig.diary->let_go();
  rig.settle(1s);
  assert_text(rig.diary->take(), "limit, stop, move 3");
  // A stop cancels what waits before it, and the strongest one counts.
  rig.hold("move 30", "move at 30 hold", 1s);
  rig.server.obey("move at 4 hold", 1s);
  rig.device.stop(1s);
  rig.device.release(1s);
  rig.device.leave(1s);
  ck_assert(rig.device.stopping());
  rig.diary->let_go();
  rig.settle(1s);
  ck_assert(!rig.device.stopping());
  assert_text(rig.diary->take(), "release");
  rig.hold("move 30", "move at 30 hold", 1s);
  rig.server.obey("move at 5 hold", 1s);
  rig.server.obey("home", 1s);
  rig.diary->let_go();
  rig.settle(1s);
  assert_text(rig.diary->take(), "home");
  rig.hold("move 30", "move at 30 hold", 1s);
  for (const char* line : {"zoom 0.25", "stop", "zoom 0.5", "zoom 0.75", "move at 6 hold"})
    rig.server.obey(line, 1s);
  rig.diary->let_go();
  rig.settle(1s);
  assert_text(rig.diary->take(), "stop, move 6, zoom 75");
  rig.hold("move 30", "move at 30 hold", 1s);
  for (const char* line : {"zoom 0.25", "stop"}) rig.server.obey(line, 1s);
  rig.diary->let_go();
  rig.settle(1s);
  assert_text(rig.diary->take(), "stop");
}
END_TEST

START_TEST(a_device_that_hangs_is_a_fault_that_names_it_until_it_has_stopped) {
  Rig rig;
  rig.open();
  rig.hold("move 30", "move at 30 hold", 1s);
  ck_assert(rig.server.serve(2s) <= 3s);
  ck_assert_uint_eq(rig.lines.size(), 1);
  rig.server.serve(3s);
  assert_text(rig.lines.back(),
              "fault the camera /dev/video9 does not answer: check its cable, and what else uses it");
  rig.server.obey("stop", 3s);
  rig.diary->hold("stop");  // it returns from the move, and waits again
  rig.diary->until_it_waits();
  rig.server.serve(3100ms);
  ck_assert(!rig.says("recovered"));
  rig.diary->let_go();
  rig.settle(3200ms);
  assert_text(rig.lines.back(), "recovered");
  // A fault of its own is passed on.
  rig.diary->fault = "its fault";
  rig.settle(3300ms);
  assert_text(rig.lines.back(), "fault its fault");
}
END_TEST

START_TEST(a_device_that_does_not_open_is_named) {
  Rig rig(0s);
  rig.diary->hold("open");
  rig.open();
  assert_text(rig.lines[0],
              "fault the camera /dev/video9 does not answer: check its cable, and what else uses it");
  ck_assert(rig.server.failed());
  rig.diary->let_go();
  Rig refused;
  refused.diary->wrong = "it is no camera";
  refused.open();
  assert_text(refused.lines[0], "fault it is no camera");
}
END_TEST

START_TEST(what_the_device_reports_is_passed_on_once_with_its_age) {
  Rig rig;
  rig.open();
  rig.diary->pose = PoseLine{{cerberus::sensing::radians(7), 0, 0}, {}, 0};
  rig.diary->speeds = SpeedsLine{{cerberus::sensing::radians(20), 0}, .25};
  rig.lines.clear();
  // The device is served at 2 s, and what it reported is taken half a second later.
  std::vector<pollfd> fds;
  rig.device.watch(fds);
  ck_assert(rig.device.tick(2s) > 2s);
  ck_assert_int_eq(::poll(fds.data(), fds.size(), 60'000), 1);
  rig.settle(2500ms);
  ck_assert(rig.says("pose 7 0 0 0 0") && rig.says("speeds 20 0 0.75"));
  ck_assert_uint_eq(rig.lines.size(), 2);
}
END_TEST

START_TEST(a_device_that_never_returns_is_left_to_its_thread) {
  std::shared_ptr<Diary> diary;
  {
    Rig rig;
    diary = rig.diary;
    rig.open();
    rig.hold("move 30", "move at 30 hold", 1s);
    ck_assert(rig.server.finish(2s) != kNever);
    ck_assert(rig.server.finish(2s + Time(kStopPatience)) == kNever);
  }
  ck_assert(!diary->gone);
  diary->let_go();
  diary->until_it_is_gone();
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "threaded_device",
      {a_device_that_waits_keeps_no_answer_to_alive_waiting,
       of_the_commands_that_wait_the_stop_is_the_first_and_the_newest_move_the_last,
       a_device_that_hangs_is_a_fault_that_names_it_until_it_has_stopped,
       a_device_that_does_not_open_is_named, what_the_device_reports_is_passed_on_once_with_its_age,
       a_device_that_never_returns_is_left_to_its_thread});
}
