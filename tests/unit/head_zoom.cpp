// SPDX-License-Identifier: LGPL-2.1-or-later
// keep-size from frames to the orders of the zoom: a simulated head, whose commands are recorded, before a person of a sixth
// of the picture's height at its widest, 60 degrees.
#include "control/head_controller.h"

#include <check.h>

#include <cmath>
#include <vector>

#include "support/forwarding_head.h"
#include "support/suite.h"

using namespace cerberus;
using namespace cerberus::control;
using namespace std::chrono_literals;
using drivers::HeadCommand;
using drivers::HeadRunner;
using motion::Pose;
using motion::Time;
using sensing::degrees;
using sensing::radians;

namespace {

constexpr vision::Size kPicture{640, 360};

class RecordedHead : public tests::ForwardingHead {
 public:
  struct Record {
    std::vector<HeadCommand> commands;
    bool emergency = false;
  };
  explicit RecordedHead(std::shared_ptr<Record> record) : record_(std::move(record)) {}
  std::string command(const HeadCommand& command) override {
    record_->commands.push_back(command);
    return ForwardingHead::command(command);
  }
  bool emergency() override { return record_->emergency; }

 private:
  std::shared_ptr<Record> record_;
};

struct Rig {
  std::shared_ptr<RecordedHead::Record> record = std::make_shared<RecordedHead::Record>();
  NotificationQueue queue;
  std::atomic<const char*> name = "head";
  DeferredNotifications out{queue, name};
  HeadController controller;
  Time now{};
  double view = radians(60);  // of the pose that was published last

  explicit Rig(bool keeps = true, const char* table = "0 60; 1 6") {
    drivers::HeadSetup setup;
    ck_assert(setup.zoom_table.parse(table).empty());
    setup.moves_zoom = keeps;
    auto runner = std::make_unique<HeadRunner>(std::make_unique<RecordedHead>(record), nullptr);
    runner->open(setup, 10s);
    controller.open(std::move(runner), setup);
    controller.set_clock_driven(true);
    controller.set_options({}, {}, 500ms);
    controller.resume(now, out);
  }
  struct Person {
    double sixth = 1;  // of the height that it has at the widest
    bool there = true;
    fusion::TrackState state = fusion::TrackState::seen;
  };
  // Frames for so long. Returns the number of orders of the zoom.
  int run(Time length, const Person& person) {
    const std::size_t before = record->commands.size();
    for (const Time end = now + length; now < end; now += 40ms) {
      tick();
      const double height = person.sixth * kPicture.height / 6. * std::tan(radians(30)) / std::tan(view / 2);
      const fusion::Track track{.id = 4,
                                .x = 300,
                                .y = (kPicture.height - height) / 2,
                                .width = 40,
                                .height = height,
                                .age = 2s,
                                .state = person.state};
      HeadController::Frame frame;
      frame.seen = Observation{std::span(&track, person.there ? 1 : 0), {}};
      frame.running = frame.now = now;
      frame.length = 40ms;
      frame.lens = vision::Lens(view, kPicture);
      frame.picture = kPicture;
      controller.frame(frame, out);
    }
    return orders_since(before);
  }
  int wait(Time length) {
    const std::size_t before = record->commands.size();
    for (const Time end = now + length; now < end; now += 20ms) tick();
    return orders_since(before);
  }
  void tick() {
    controller.tick(now, out);
    out.send([&](const char*, const Pose& pose) { view = pose.field_of_view; },
             [](const char*, const Notice&) {});
  }
  int orders_since(std::size_t before) const {
    int orders = 0;
    for (std::size_t k = before; k < record->commands.size(); ++k)
      orders += record->commands[k].zoom.has_value();
    return orders;
  }
};

}  // namespace

START_TEST(a_person_of_a_sixth_is_brought_to_a_third) {
  Rig rig;
  ck_assert_int_gt(rig.run(20s, {}), 10);
  // Twice as large: tan 30 / 2 = .2887, 16.1 degrees to each side, within a factor of 1.05.
  ck_assert_double_ge(rig.view, radians(2 * 15.3));
  ck_assert_double_le(rig.view, radians(2 * 17));
}
END_TEST

START_TEST(off_by_default_and_without_a_table_the_zoom_is_left_alone) {
  ck_assert(!drivers::HeadSetup{}.moves_zoom);
  ck_assert_int_eq(Rig(false).run(5s, {}), 0);
  Rig none(true, "");
  none.view = radians(60);
  const std::size_t before = none.record->commands.size();
  fusion::Track track{.id = 4, .x = 300, .y = 150, .width = 40, .height = 60, .age = 2s};
  for (Time now{}; now < 5s; now += 40ms) {
    HeadController::Frame frame;
    frame.seen = Observation{std::span(&track, 1), {}};
    frame.running = frame.now = now;
    frame.lens = vision::Lens(radians(60), kPicture);
    frame.picture = kPicture;
    none.controller.frame(frame, none.out);
  }
  ck_assert_int_eq(none.orders_since(before), 0);
}
END_TEST

START_TEST(a_person_that_is_lost_or_only_predicted_moves_no_zoom) {
  Rig rig;
  ck_assert_int_gt(rig.run(3s, {}), 3);
  ck_assert_int_eq(rig.run(3s, {.there = false}), 0);
  ck_assert_int_gt(rig.run(3s, {}), 3);
  ck_assert_int_eq(rig.run(3s, {.state = fusion::TrackState::coasted}), 0);
}
END_TEST

START_TEST(an_order_by_hand_the_emergency_stop_and_a_halt_end_it) {
  Rig rig;
  ck_assert_int_gt(rig.run(2s, {}), 2);
  rig.controller.stop(rig.now, rig.out);
  ck_assert_int_eq(rig.run(2s, {}), 0);
  rig.controller.automatic(rig.now, rig.out);
  ck_assert_int_gt(rig.run(2s, {}), 2);
  rig.record->emergency = true;
  rig.wait(40ms);
  ck_assert_int_eq(rig.run(2s, {}), 0);
  rig.record->emergency = false;
  rig.wait(40ms);
  ck_assert_int_eq(rig.run(1s, {}), 0);  // it waits for an order
  rig.controller.automatic(rig.now, rig.out);
  ck_assert_int_gt(rig.run(2s, {}), 2);
  rig.controller.halt("paused", rig.now, 1s, rig.out);
  ck_assert_int_eq(rig.run(2s, {}), 0);
}
END_TEST

START_TEST(without_frames_no_zoom_moves) {
  Rig rig;
  ck_assert_int_gt(rig.run(2s, {}), 2);
  ck_assert_int_eq(rig.wait(3s), 0);  // the watchdog stops the head after half a second
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "head_zoom",
      {a_person_of_a_sixth_is_brought_to_a_third, off_by_default_and_without_a_table_the_zoom_is_left_alone,
       a_person_that_is_lost_or_only_predicted_moves_no_zoom,
       an_order_by_hand_the_emergency_stop_and_a_halt_end_it, without_frames_no_zoom_moves});
}
