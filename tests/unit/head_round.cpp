// SPDX-License-Identifier: LGPL-2.1-or-later
// A person who crosses behind a head of +-170 degrees, 90 a second: the controller before a simulated head, in its own time.
// The lens has 60 degrees; the person is seen within 29 of its middle.
#include "control/head_controller.h"

#include <check.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "support/forwarding_head.h"
#include "support/suite.h"

using namespace cerberus;
using namespace cerberus::control;
using namespace std::chrono_literals;
using drivers::HeadRunner;
using fusion::Action;
using motion::Pose;
using motion::Time;
using sensing::degrees;
using sensing::radians;

namespace {

constexpr vision::Size kPicture{640, 360};
class StoppableHead : public tests::ForwardingHead {
 public:
  struct State {
    bool pressed = false, parted = false;
    std::string failure;  // of every command
  };
  explicit StoppableHead(std::shared_ptr<State> state) : state_(std::move(state)) {}
  std::string command(const drivers::HeadCommand& command) override {
    return state_->failure.empty() ? ForwardingHead::command(command) : state_->failure;
  }
  bool emergency() override { return state_->pressed; }
  bool parted() override { return std::exchange(state_->parted, false); }

 private:
  std::shared_ptr<State> state_;
};

constexpr char kRound[] = "goes round to meet the track on the other side";
using Bearing = std::function<double(double)>;  // degrees at a time, seconds

struct Rig {
  NotificationQueue queue;
  std::atomic<const char*> name = "head";
  DeferredNotifications out{queue, name};
  HeadController controller;
  Time now{};
  motion::PoseHistory history;
  Status status;
  double lost = 0;    // seconds out of the picture
  double widest = 0;  // degrees of the head
  // The base, degrees: it obeys at once, for half a second.
  double yaw = 0, asked = 0;
  Time asked_at{};
  int requests = 0;
  std::shared_ptr<StoppableHead::State> state = std::make_shared<StoppableHead::State>();
  fusion::TrackState track = fusion::TrackState::seen;
  vision::Lens lens{radians(60), kPicture};

  explicit Rig(double base_turn = 0) {
    drivers::HeadSetup setup;
    setup.pan = radians(100);
    auto runner = std::make_unique<HeadRunner>(std::make_unique<StoppableHead>(state), nullptr);
    runner->open(setup, 10s);
    controller.open(std::move(runner), setup);
    controller.set_clock_driven(true);
    LawOptions law;
    law.base_turn = radians(base_turn);
    controller.set_options(law, {}, 500ms);
    controller.resume(now, out);
    tick();
  }
  double head() const { return degrees(history.at(now).pan.position); }
  void tick() {
    controller.tick(now, out);
    out.send([&](const char*, const Pose& pose) { history.add(pose); },
             [&](const char*, const Notice& notice) {
               if (const auto* said = std::get_if<Status>(&notice)) status = *said;
               const auto* request = std::get_if<BaseTurnRequest>(&notice);
               if (request == nullptr) return;
               asked = degrees(request->yaw_rate);
               asked_at = now;
               ++requests;
             });
  }
  // Time goes on without frames.
  void wait(Time length) {
    for (const Time end = now + length; now < end; now += 20ms) tick();
  }
  // missing: what fusion decides while the person is out of the picture; immediate: by a table's rule.
  void run(double until, const Bearing& bearing, Action missing = Action::hold, bool immediate = false) {
    for (; motion::seconds(now) < until; now += 20ms) {
      tick();
      if (now - asked_at < 500ms) yaw += asked * .02;
      widest = std::max(widest, std::abs(head()));
      if (now % 40ms != 0ms) continue;
      const double off = sensing::wrap(radians(bearing(motion::seconds(now)) - yaw - head()));
      const bool seen = std::abs(off) < radians(29);
      lost += seen ? 0 : .04;
      const fusion::Track track{.id = 4,
                                .x = 300 + lens.focal_length() * std::tan(seen ? off : 0),
                                .y = 130,
                                .width = 40,
                                .height = 100,
                                .age = 2s,
                                .state = this->track};
      FusionDecision decision;
      decision.made.action = seen ? Action::track : missing;
      decision.made.rule_name = "test";
      decision.made.target = seen ? 4 : 0;
      decision.made.sector = {radians(120), radians(170)};
      decision.made.immediate = immediate && !seen;
      decision.decided = now;
      HeadController::Frame frame;
      frame.seen = Observation{std::span(&track, seen ? 1 : 0), decision};
      frame.running = frame.now = now;
      frame.length = 40ms;
      frame.lens = lens;
      frame.picture = kPicture;
      controller.frame(frame, out);
    }
    tick();
  }
};

// 20 degrees a second to the right.
double crossing(double seconds) {
  return 100 + 20 * seconds;
}

}  // namespace

// Out of view at 199 degrees, after 5 s. Then (360 - 58) / 110 s, the way to full speed and dead times: 3.2 s.
START_TEST(a_person_who_crosses_behind_is_met_on_the_other_side) {
  for (const Action missing : {Action::hold, Action::search, Action::turn_right, Action::zero}) {
    Rig rig;
    rig.run(6, crossing, missing);
    ck_assert_str_eq(rig.status.reason.c_str(), kRound);
    ck_assert(rig.status.state == HeadState::turning);
    rig.run(12, crossing, missing);
    ck_assert_double_le(rig.lost, 3.4);
    ck_assert_double_ge(rig.lost, 2.6);
    ck_assert_double_eq_tol(rig.head(), 340 - 360, 3);  // it follows
    ck_assert(rig.status.state == HeadState::tracking);
  }
}
END_TEST

START_TEST(a_person_who_turns_back_behind_is_not_left) {
  Rig rig;
  rig.run(20, [](double t) { return 190 - std::abs(10 * (t - 9)); });
  ck_assert_double_eq(rig.lost, 0);
}
END_TEST

START_TEST(a_rule_that_says_hold_or_zero_ends_the_way_round_at_once) {
  for (const bool between : {false, true}) {
    for (const Action action : {Action::hold, Action::zero}) {
      Rig rig;
      rig.run(6, crossing);
      ck_assert_str_eq(rig.status.reason.c_str(), kRound);
      if (between) {
        FusionDecision decision;
        decision.made.action = action;
        decision.made.rule_name = "test";
        decision.made.immediate = true;
        decision.decided = rig.now;
        rig.controller.on_decision(decision, rig.now, rig.out);
        rig.tick();
      } else {
        rig.run(6.04, crossing, action, true);
      }
      const HeadState state = action == Action::hold ? HeadState::holding : HeadState::zeroing;
      ck_assert(rig.status.state == state);
      rig.run(7, [&](double) { return rig.head() + 180; }, action);  // for good
      ck_assert(rig.status.state == state);
    }
  }
}
END_TEST

START_TEST(an_order_by_hand_ends_the_way_round_for_good) {
  Rig rig;
  rig.run(6, crossing);
  ck_assert_str_eq(rig.status.reason.c_str(), kRound);
  rig.controller.stop(rig.now, rig.out);
  rig.run(6.5, crossing);
  const double there = rig.head();
  rig.run(7, crossing);
  ck_assert_double_eq_tol(rig.head(), there, 1e-6);
  rig.controller.automatic(rig.now, rig.out);
  rig.run(7.5, [](double) { return 90; });
  ck_assert_double_eq_tol(rig.head(), there, 1e-6);
}
END_TEST

START_TEST(without_frames_the_watchdog_stops_the_way_round) {
  Rig rig;
  rig.run(5.6, crossing);
  ck_assert_str_eq(rig.status.reason.c_str(), kRound);
  for (const Time end = rig.now + 1s; rig.now < end; rig.now += 20ms) rig.tick();
  const double there = rig.head();
  for (const Time end = rig.now + 1s; rig.now < end; rig.now += 20ms) rig.tick();
  ck_assert_double_eq_tol(rig.head(), there, 1e-6);
  ck_assert(rig.status.state == HeadState::stopped);
  rig.run(8.2, crossing);  // the turn would not be over
  ck_assert_double_eq_tol(rig.head(), there, 1e-6);
  ck_assert(rig.status.state == HeadState::holding);
}
END_TEST

START_TEST(a_fault_ends_the_way_round_for_good) {
  Rig rig;
  rig.run(5.6, crossing);
  ck_assert_str_eq(rig.status.reason.c_str(), kRound);
  rig.state->failure = "no power";
  rig.run(5.8, crossing);
  ck_assert(rig.status.state == HeadState::fault);
  rig.state->failure.clear();
  rig.run(6.4, crossing);
  const double there = rig.head();
  rig.run(8, crossing);
  ck_assert_double_eq_tol(rig.head(), there, 1e-6);
  ck_assert(rig.status.state == HeadState::holding);
}
END_TEST

// It goes at 188 degrees, .3 s before the view ends at 24 from the stop: 4.4 s. (146 + 172) / 110 s and 1.5 more.
START_TEST(a_person_who_is_not_met_is_given_up) {
  Rig rig;
  rig.run(5.2, crossing);
  ck_assert_str_eq(rig.status.reason.c_str(), kRound);
  const auto gone = [&](double) { return rig.head() + 180; };
  rig.run(8.5, gone);
  ck_assert_str_eq(rig.status.reason.c_str(), kRound);
  rig.run(11, gone);
  ck_assert(rig.status.state == HeadState::holding);
}
END_TEST

START_TEST(a_base_that_is_asked_to_turn_keeps_the_person_within_the_stops) {
  Rig rig(30);
  rig.run(30, [](double t) { return std::min(100 + 20 * t, 400.); });
  ck_assert_double_eq(rig.lost, 0);
  ck_assert_double_le(rig.widest, 169);
  ck_assert_double_ge(rig.yaw, 400 - 160);
  ck_assert_double_eq(rig.asked, 0);
  ck_assert_int_gt(rig.requests, 50);
}
END_TEST

START_TEST(by_default_the_base_is_not_asked) {
  Rig rig;
  rig.run(12, crossing);
  ck_assert_int_eq(rig.requests, 0);
}
END_TEST

// Each ends it at once, or with the next frame, and only once.
START_TEST(whatever_stops_the_head_and_the_loss_of_the_target_end_the_request) {
  const struct {
    const char* what;
    std::function<void(Rig&)> end;
  } cases[] = {
      {"lost", [](Rig& rig) { rig.run(motion::seconds(rig.now) + .04, [](double) { return 0; }); }},
      {"stop", [](Rig& rig) { rig.controller.stop(rig.now, rig.out); }},
      {"move", [](Rig& rig) { rig.controller.move(0, 0, false, rig.now, rig.out); }},
      {"turn", [](Rig& rig) { rig.controller.turn(.1, 0, rig.now, rig.out); }},
      {"emergency", [](Rig& rig) { rig.state->pressed = true, rig.wait(40ms); }},
      {"parted", [](Rig& rig) { rig.state->parted = true, rig.run(3.44, crossing); }},
      {"predicted", [](Rig& rig) { rig.track = fusion::TrackState::coasted, rig.run(3.44, crossing); }},
      {"watchdog", [](Rig& rig) { rig.wait(540ms); }},
      {"halt", [](Rig& rig) { rig.controller.halt("paused", rig.now, 1s, rig.out); }},
      {"end", [](Rig& rig) { rig.controller.end(rig.now, 1s, rig.out); }},
  };
  for (const auto& one : cases) {
    Rig rig(30);
    rig.run(3.4, crossing);
    ck_assert_double_gt(rig.asked, 10);
    one.end(rig);
    rig.tick();
    ck_assert_msg(rig.asked == 0, "%s: still asked for %g", one.what, rig.asked);
    const int requests = rig.requests;
    rig.wait(1s);
    ck_assert_msg(rig.requests == requests, "%s: asked again", one.what);
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "head_round",
      {a_person_who_crosses_behind_is_met_on_the_other_side, a_person_who_turns_back_behind_is_not_left,
       a_rule_that_says_hold_or_zero_ends_the_way_round_at_once, an_order_by_hand_ends_the_way_round_for_good,
       without_frames_the_watchdog_stops_the_way_round, a_fault_ends_the_way_round_for_good,
       a_person_who_is_not_met_is_given_up, a_base_that_is_asked_to_turn_keeps_the_person_within_the_stops,
       by_default_the_base_is_not_asked, whatever_stops_the_head_and_the_loss_of_the_target_end_the_request});
}
