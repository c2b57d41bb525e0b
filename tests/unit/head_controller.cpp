// SPDX-License-Identifier: LGPL-2.1-or-later
// From frames, decisions and manual commands to the commands of a driver. The driver is a simulated head whose commands
// are recorded; the lens has 90 degrees over 640x480, so that f = 320 and 320 pixels right of the middle are 45 degrees.
// Limits: 400 degrees a second squared; 40 degrees a second of pan, which takes 0.1 s and 2 degrees to reach, and as much
// to brake, and 90 of tilt.
#include "control/head_controller.h"

#include <check.h>

#include <cmath>
#include <functional>
#include <future>
#include <limits>

#include "support/forwarding_head.h"
#include "support/suite.h"
#include "support/text.h"

using namespace cerberus;
using namespace cerberus::control;
using namespace std::chrono_literals;
using drivers::HeadCommand;
using drivers::HeadRunner;
using drivers::HeadSetup;
using fusion::Action;
using motion::AxisCommand;
using motion::Pose;
using motion::Time;
using sensing::degrees;
using sensing::radians;
using tests::assert_text;
using Answer = HeadController::Answer;
using Kind = AxisCommand::Kind;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const vision::Lens kLens(radians(90), {640, 480});
// Radians by which the picture turns when it moves by one pixel.
const double kPixel = base_turn(vision::Transform::translation(-1, 0), kLens, {640, 480}, {}, {}).yaw;

struct Record {
  std::vector<HeadCommand> commands;
  std::vector<std::pair<Time, motion::Limits>> limits;
  std::vector<Time> stops;
  std::string failure;  // returned by command()
  bool emergency = false;
  bool parted = false;                         // its reports have parted from its commands
  std::string refusal;                         // returned by open()
  std::function<void()> in_command, in_state;  // called by these, if set
  int homes = 0;
  bool simulated = true;
  bool by_speeds = false, measured = false;  // of its poses
  std::vector<motion::SpeedMap> maps;        // of pan, as learnt
};

class RecordedHead : public tests::ForwardingHead {
 public:
  RecordedHead(std::shared_ptr<Record> record, bool blocks) : record_(std::move(record)), blocks_(blocks) {}
  std::string open(const HeadSetup& setup) override {
    return record_->refusal.empty() ? ForwardingHead::open(setup) : record_->refusal;
  }
  void stop(Time now) noexcept override {
    record_->stops.push_back(now);
    ForwardingHead::stop(now);
  }
  std::string command(const HeadCommand& command) override {
    if (record_->in_command) record_->in_command();
    record_->commands.push_back(command);
    return record_->failure.empty() ? ForwardingHead::command(command) : record_->failure;
  }
  std::string limit(Time now, const motion::Limits& limits) override {
    record_->limits.emplace_back(now, limits);
    return ForwardingHead::limit(now, limits);
  }
  std::string state(Time time, Pose& pose) override {
    if (record_->in_state) record_->in_state();
    std::string wrong = ForwardingHead::state(time, pose);
    pose.by_speeds = record_->by_speeds;
    pose.measured = record_->measured;
    return wrong;
  }
  void learn(const motion::SpeedMap& pan, const motion::SpeedMap&) override { record_->maps.push_back(pan); }
  bool emergency() override { return record_->emergency; }
  bool parted() override { return std::exchange(record_->parted, false); }
  std::string home(Time) override {
    ++record_->homes;
    return {};
  }
  bool simulated() const override { return record_->simulated; }
  bool blocks() const override { return blocks_; }

 private:
  std::shared_ptr<Record> record_;
  bool blocks_;
};

HeadSetup usual_setup() {
  HeadSetup setup;
  setup.limits.pan.acceleration = setup.limits.tilt.acceleration = radians(400);
  setup.limits.pan.speed = radians(40);
  return setup;
}

struct Options {
  HeadSetup setup = usual_setup();
  bool clock_driven = false;
  bool blocks = false;
  Time watchdog{};
  bool resumed = true;
  std::string refusal;
  bool simulated = true;  // its poses are exact
};

// A controller with its head, and everything that it reports.
struct Rig {
  std::shared_ptr<Record> record = std::make_shared<Record>();
  NotificationQueue queue;
  std::atomic<const char*> name = "head";
  DeferredNotifications out{queue, name};
  HeadController controller;
  std::vector<Pose> poses;
  std::vector<Status> statuses;
  std::vector<std::string> warnings;

  explicit Rig(const Options& options = {}) {
    record->refusal = options.refusal;
    record->simulated = options.simulated;
    auto runner =
        std::make_unique<HeadRunner>(std::make_unique<RecordedHead>(record, options.blocks), nullptr);
    runner->open(options.setup, 10s);
    controller.open(std::move(runner), options.setup);
    controller.set_clock_driven(options.clock_driven);
    controller.set_options({}, {.return_delay = 1s}, options.watchdog);
    if (options.resumed) controller.resume(clock(0s), out);
  }
  std::optional<Time> clock(Time now) const { return now; }

  // A frame with the decision of sensor fusion, taken and processed at `time`; 40 ms to the next one.
  static HeadController::Frame with(Time time, Action action, double angle = 0, double tilt = 0) {
    static fusion::Track track;
    track = {.id = 4, .x = 310, .y = 230, .width = 20, .height = 20, .age = 2s};
    track.x += 320 * std::tan(radians(angle));
    track.y -= 320 * std::tan(radians(tilt));
    FusionDecision decision;
    decision.made.action = action;
    decision.made.rule = 3;
    decision.made.rule_name = "left";
    decision.made.target = action == Action::track ? 4 : 0;
    decision.made.sector = {radians(-20), radians(30)};
    decision.decided = time;
    HeadController::Frame frame;
    frame.seen = Observation{{&track, 1}, decision};
    frame.running = frame.now = time;
    frame.length = 40ms;
    frame.lens = kLens;
    return frame;
  }
  static HeadController::Frame empty(Time time) {
    HeadController::Frame frame = with(time, Action::hold);
    frame.seen = Observation{};
    return frame;
  }
  static HeadController::Frame gap(Time time) {
    HeadController::Frame frame = with(time, Action::hold);
    frame.seen.reset();
    return frame;
  }
  static FusionDecision decision(Action action, Time decided) {
    FusionDecision made = *with(decided, action).seen->fusion;
    return made;
  }

  void process(const HeadController::Frame& frame) {
    ck_assert(controller.frame(frame, out) == Answer::done);
    collect();
  }
  void collect() {
    out.send([&](const char*, const Pose& pose) { poses.push_back(pose); },
             [&](const char*, const Notice& notice) {
               if (const auto* status = std::get_if<Status>(&notice)) statuses.push_back(*status);
               if (const auto* fault = std::get_if<Fault>(&notice))
                 warnings.push_back("fault: " + fault->what);
               if (const auto* refusal = std::get_if<Refusal>(&notice))
                 warnings.push_back("refusal: " + refusal->why);
               if (const auto* lost = std::get_if<Lost>(&notice))
                 warnings.push_back("lost: " + std::to_string(lost->id));
             });
  }
  // Asserts the last state that was reported.
  void assert_status(HeadState state, const char* reason) {
    collect();
    ck_assert(!statuses.empty());
    assert_text(statuses.back().reason, reason);
    ck_assert_int_eq(static_cast<int>(statuses.back().state), static_cast<int>(state));
  }
  const HeadCommand& command() const {
    ck_assert(!record->commands.empty());
    return record->commands.back();
  }
};

void assert_goes(const AxisCommand& command, double position, double speed) {
  ck_assert_int_eq(static_cast<int>(command.kind), static_cast<int>(Kind::position));
  ck_assert_double_eq_tol(degrees(command.value), position, 1e-6);
  ck_assert_double_eq_tol(degrees(command.speed), speed, 1e-6);
}

// Speed with which a head at rest sets out for a target: 40 ms of its acceleration.
constexpr double kSetsOut = 16;

void assert_turns(const AxisCommand& command, double speed) {
  ck_assert_int_eq(static_cast<int>(command.kind), static_cast<int>(Kind::velocity));
  ck_assert_double_eq_tol(degrees(command.value), speed, 1e-6);
}

bool holds(const AxisCommand& command) {
  return command.kind == Kind::hold;
}

void assert_time(Time time, Time expected) {
  ck_assert_int_eq(time.count(), expected.count());
}

Pose pointing(double pan, double tilt = 0) {
  Pose pose;
  pose.pan.position = radians(pan);
  pose.tilt.position = radians(tilt);
  return pose;
}

}  // namespace

// From target to command.

START_TEST(a_target_is_reckoned_from_the_pose_on_the_frame) {
  Rig rig;
  HeadController::Frame frame = Rig::with(0s, Action::track, 45);
  frame.capture = pointing(10);
  rig.process(frame);
  // At 10 degrees the target is 45 to the right: 55.
  assert_goes(rig.command().pan, 55, kSetsOut);
  ck_assert(holds(rig.command().tilt));
  assert_time(rig.command().time, 0s);
  rig.assert_status(HeadState::tracking, "rule 3 (left): track 4");
}
END_TEST

START_TEST(without_a_pose_on_the_frame_the_head_s_own_pose_at_that_time_counts) {
  for (const bool repeats : {false, true}) {
    Rig rig;
    HeadController::Frame first = Rig::with(0s, Action::turn_right);
    first.length = 1s;
    rig.process(first);
    assert_turns(rig.command().pan, 40);
    HeadController::Frame second = Rig::with(1s, Action::track);
    if (repeats) second.repeats = 500ms;
    rig.process(second);
    // After 1 s the head is at 2 + 0.9 x 40 = 38 degrees, the target in the middle of the picture too: nothing to do.
    // A frame that repeats the picture of 0.5 s shows a target at 2 + 0.4 x 40 = 18: the head brakes before it turns
    // round, from 40 by 40 ms of its acceleration.
    if (repeats)
      assert_goes(rig.command().pan, 38 + .3 * (40 - 16), 40 - 16);
    else
      ck_assert(holds(rig.command().pan));
  }
}
END_TEST

START_TEST(the_error_is_that_at_the_time_when_the_command_takes_effect) {
  Options options;
  options.setup.latency = 60ms;
  Rig rig(options);
  HeadController::Frame first = Rig::with(0s, Action::turn_right);
  first.length = 1s;
  rig.process(first);
  rig.process(Rig::with(1s, Action::track, 5));
  // The turn began at 0.06 s. At 1 s the head is at 2 + 0.84 x 40 = 35.6: the target is at 40.6. The command takes
  // effect at 1.06 s, but published poses, which end at 1 s, are not touched: the head is then at 38, and 2.6 degrees are
  // left. The speed approaches the one for them, 6.5 x 2.6 = 16.9, by 10 a second for 40 ms.
  assert_goes(rig.command().pan, 40.6, 40 - .04 * 10 * (40 - 6.5 * 2.6));
}
END_TEST

START_TEST(within_the_dead_band_the_head_rests) {
  Rig rig;
  LawOptions law;
  law.dead_band_start = radians(3);
  law.dead_band_stop = radians(1);
  rig.controller.set_options(law, {}, {});
  Time now{};
  const auto frames = [&](int n, double from, double to) {  // the first command that moves the head ends it
    for (int k = 0; k < n && (now == 0s || holds(rig.command().pan)); ++k, now += 40ms)
      rig.process(Rig::with(now, Action::track, from + (to - from) * k / n));
    return holds(rig.command().pan);
  };
  ck_assert(frames(25, 0.9, 0.9));
  ck_assert(frames(100, 0.9, 2.5));
  ck_assert(!frames(100, 2.5, 4.5));
}
END_TEST

START_TEST(a_turn_is_made_at_full_speed_and_search_and_return_to_zero_at_turn_speed) {
  Rig rig;
  LawOptions law;
  law.turn_speed = radians(30);
  rig.controller.set_options(law, {}, {});
  rig.process(Rig::with(0s, Action::search));
  assert_goes(rig.command().pan, -20, 30);  // the nearer edge first
  rig.assert_status(HeadState::searching, "rule 3 (left): search");
  rig.process(Rig::with(40ms, Action::turn_left));
  assert_turns(rig.command().pan, -40);
  rig.assert_status(HeadState::turning, "rule 3 (left): turn-left");
  rig.process(Rig::with(80ms, Action::zero));
  assert_goes(rig.command().pan, 0, 30);
  assert_goes(rig.command().tilt, 0, 30);
  rig.assert_status(HeadState::zeroing, "rule 3 (left): zero");
  rig.process(Rig::with(120ms, Action::hold));
  ck_assert(holds(rig.command().pan) && holds(rig.command().tilt));
  rig.assert_status(HeadState::holding, "rule 3 (left): hold");
  ck_assert_uint_eq(rig.statuses.size(), 4);
}
END_TEST

START_TEST(an_unchanged_state_is_reported_once_and_every_command_given) {
  Rig rig;
  for (int k = 0; k < 5; ++k) rig.process(Rig::with(k * 40ms, Action::turn_left));
  ck_assert_uint_eq(rig.statuses.size(), 1);
  ck_assert_uint_eq(rig.record->commands.size(), 5);
  assert_time(rig.statuses[0].time, 0s);
  assert_time(*rig.controller.newest(), 160ms);
}
END_TEST

START_TEST(without_fusion_a_track_is_followed_and_the_head_then_returns_to_zero) {
  Rig rig;
  HeadController::Frame seen = Rig::with(0s, Action::hold, 20);
  seen.seen->fusion.reset();
  rig.process(seen);
  assert_goes(rig.command().pan, 20, kSetsOut);
  rig.process(Rig::empty(990ms));  // return-delay, 1 s, is not over
  ck_assert(holds(rig.command().pan));
  rig.process(Rig::empty(5s));
  assert_goes(rig.command().pan, 0, 40);
  rig.assert_status(HeadState::zeroing, "rule 7 (zero): zero");
}
END_TEST

// Limits.

START_TEST(a_target_beyond_a_limit_is_approached_to_the_limit) {
  Options options;
  options.setup.limits.pan.from = options.setup.limits.pan.to = 0;
  options.setup.limits.pan.to = radians(30);
  Rig rig(options);
  rig.process(Rig::with(0s, Action::track, 45));
  assert_goes(rig.command().pan, 30, kSetsOut);
  rig.assert_status(HeadState::limited, "rule 3 (left): track 4");
  Rig other(options);
  other.process(Rig::with(0s, Action::turn_left));
  other.assert_status(HeadState::limited, "rule 3 (left): turn-left");
}
END_TEST

START_TEST(new_limits_reach_the_driver_at_once_and_the_law_with_the_next_frame) {
  Rig rig;
  rig.process(Rig::with(1s, Action::hold));
  motion::Limits limits = usual_setup().limits;
  assert_text(rig.controller.set_limits(limits, {}), "");
  ck_assert(rig.record->limits.empty());  // these are in force
  limits.pan.to = radians(25);
  assert_text(rig.controller.set_limits(limits, {}), "");
  ck_assert_uint_eq(rig.record->limits.size(), 1);
  assert_time(rig.record->limits[0].first, 1040ms);  // poses are published until then
  ck_assert(rig.record->limits[0].second == limits);
  rig.process(Rig::with(2s, Action::track, 45));
  assert_goes(rig.command().pan, 25, kSetsOut);
}
END_TEST

START_TEST(refused_limits_leave_the_old_ones_in_force) {
  Rig rig;
  motion::Limits limits = usual_setup().limits;
  limits.pan.from = radians(20);  // zero lies outside
  ck_assert(!rig.controller.set_limits(limits, {}).empty());
  ck_assert(rig.record->limits.empty());
  rig.process(Rig::with(0s, Action::track, -45));
  assert_goes(rig.command().pan, -45, kSetsOut);
}
END_TEST

START_TEST(limits_that_are_set_during_a_halt_apply_when_it_ends) {
  Options options;
  options.resumed = false;
  Rig rig(options);
  motion::Limits limits = usual_setup().limits;
  limits.pan.to = radians(25);
  assert_text(rig.controller.set_limits(limits, {}), "");
  ck_assert(rig.record->limits.empty());
  rig.controller.resume({}, rig.out);
  ck_assert_uint_eq(rig.record->limits.size(), 1);
  rig.controller.resume({}, rig.out);
  ck_assert_uint_eq(rig.record->limits.size(), 1);
}
END_TEST

// Priorities.

START_TEST(a_manual_command_takes_precedence_until_automatic) {
  Rig rig;
  ck_assert(rig.controller.move(radians(30), radians(-10), false, {}, rig.out));
  ck_assert(rig.record->commands.empty());  // without a clock it is given with the next frame
  rig.assert_status(HeadState::manual, "manual command: move");
  rig.process(Rig::with(0s, Action::turn_left));
  assert_goes(rig.command().pan, 30, 40);
  assert_goes(rig.command().tilt, -10, 90);
  ck_assert(rig.controller.stop({}, rig.out));
  rig.process(Rig::with(40ms, Action::turn_left));
  ck_assert(holds(rig.command().pan) && holds(rig.command().tilt));
  rig.assert_status(HeadState::manual, "manual command: stop");
  ck_assert(rig.controller.automatic({}, rig.out));
  rig.process(Rig::with(80ms, Action::turn_left));
  assert_turns(rig.command().pan, -40);
}
END_TEST

START_TEST(a_relative_move_adds_to_the_last_commanded_position) {
  Rig rig;
  ck_assert(rig.controller.move(radians(10), 0, true, {}, rig.out));
  ck_assert(rig.controller.move(radians(15), radians(5), true, {}, rig.out));
  rig.process(Rig::with(0s, Action::hold));
  assert_goes(rig.command().pan, 25, 40);
  assert_goes(rig.command().tilt, 5, 90);
  ck_assert(!rig.controller.move(kNan, 0, false, {}, rig.out));
  rig.process(Rig::with(40ms, Action::hold));
  assert_goes(rig.command().pan, 25, 40);
}
END_TEST

START_TEST(the_chosen_track_takes_precedence_over_fusion_and_ends_a_manual_command) {
  Rig rig;
  ck_assert(!rig.controller.follow(0, {}, rig.out));
  rig.controller.move(radians(30), 0, false, {}, rig.out);
  ck_assert(rig.controller.follow(4, {}, rig.out));
  rig.process(Rig::with(0s, Action::turn_left, 20));
  assert_goes(rig.command().pan, 20, kSetsOut);
  ck_assert(rig.controller.automatic({}, rig.out));
  rig.process(Rig::with(40ms, Action::turn_left, 20));
  assert_turns(rig.command().pan, -40);
}
END_TEST

START_TEST(a_chosen_track_that_is_on_no_frame_for_five_seconds_is_given_up_with_a_warning) {
  Rig rig;
  rig.controller.follow(9, {}, rig.out);
  rig.process(Rig::with(0s, Action::hold));
  rig.process(Rig::with(4900ms, Action::hold));
  ck_assert(rig.warnings.empty());
  rig.process(Rig::with(5s, Action::hold));
  ck_assert_uint_eq(rig.warnings.size(), 1);
  assert_text(rig.warnings[0], "lost: 9");
}
END_TEST

// Stop.

START_TEST(a_halted_head_brakes_and_follows_frames_again_after_resume) {
  Rig rig;
  rig.process(Rig::with(0s, Action::turn_right));
  rig.controller.halt("paused", {}, 10s, rig.out);
  ck_assert_uint_eq(rig.record->stops.size(), 1);
  assert_time(rig.record->stops[0], 40ms);  // poses are published until then
  rig.assert_status(HeadState::stopped, "paused");
  rig.controller.halt("again", {}, 10s, rig.out);
  ck_assert_uint_eq(rig.record->stops.size(), 1);
  rig.process(Rig::with(80ms, Action::turn_right));
  ck_assert(holds(rig.command().pan));
  rig.assert_status(HeadState::stopped, "paused");
  rig.controller.resume({}, rig.out);
  rig.process(Rig::with(120ms, Action::turn_right));
  assert_turns(rig.command().pan, 40);
}
END_TEST

START_TEST(a_manual_command_survives_a_halt_and_not_the_end_of_the_stream) {
  Rig rig;
  rig.controller.move(radians(30), 0, false, {}, rig.out);
  rig.controller.halt("paused", {}, 10s, rig.out);
  rig.controller.resume({}, rig.out);
  rig.process(Rig::with(0s, Action::turn_left));
  assert_goes(rig.command().pan, 30, 40);
  rig.controller.end({}, 10s, rig.out);
  rig.assert_status(HeadState::stopped, "end of the stream");
  ck_assert(!rig.controller.move(radians(10), 0, false, {}, rig.out));
  ck_assert(!rig.controller.follow(4, {}, rig.out));
  ck_assert(rig.controller.stop({}, rig.out));
  rig.controller.resume({}, rig.out);  // the end of the stream outlasts it
  rig.process(Rig::with(1s, Action::turn_left));
  ck_assert(holds(rig.command().pan));
  rig.controller.forget();
  rig.controller.resume({}, rig.out);
  rig.process(Rig::with(2s, Action::turn_left));
  ck_assert(holds(rig.command().pan));  // still the manual stop
  rig.controller.automatic({}, rig.out);
  rig.process(Rig::with(3s, Action::turn_left));
  assert_turns(rig.command().pan, -40);
}
END_TEST

START_TEST(the_end_of_the_stream_outlasts_resume_and_ends_with_a_flush) {
  Rig rig;
  rig.process(Rig::with(0s, Action::turn_left));
  rig.controller.end({}, 10s, rig.out);
  rig.controller.resume({}, rig.out);
  rig.process(Rig::with(40ms, Action::turn_left));
  ck_assert(holds(rig.command().pan));
  rig.controller.forget();
  rig.controller.resume({}, rig.out);
  rig.process(Rig::with(80ms, Action::turn_left));
  assert_turns(rig.command().pan, -40);
}
END_TEST

START_TEST(a_closed_controller_refuses_everything) {
  Rig rig;
  rig.controller.close(10s);
  ck_assert(rig.controller.frame(Rig::with(0s, Action::turn_left), rig.out) == Answer::failed);
  ck_assert(rig.controller.announce(0s, rig.out) == Answer::failed);
  ck_assert(!rig.controller.move(0, 0, false, {}, rig.out));
  ck_assert(!rig.controller.stop({}, rig.out));
  ck_assert(!rig.controller.automatic({}, rig.out));
  ck_assert(!rig.controller.follow(4, {}, rig.out));
  rig.collect();
  ck_assert(rig.statuses.empty() && rig.record->commands.empty());
}
END_TEST

// Watchdog.

START_TEST(the_watchdog_brakes_at_its_time_where_frames_stayed_away) {
  // The last frame at 40 ms, watchdog 500 ms: it expires at 540 ms. The next frame lasts 40 ms, so that no frame was
  // missing until 40 ms before it.
  for (const Time next : {580ms, 581ms}) {
    Options options;
    options.watchdog = 500ms;
    Rig rig(options);
    rig.process(Rig::with(0s, Action::turn_right));
    rig.process(Rig::with(40ms, Action::turn_right));
    rig.process(Rig::with(next, Action::turn_right));
    const bool brakes = next == 581ms;
    ck_assert_uint_eq(rig.record->commands.size(), brakes ? 4 : 3);
    if (!brakes) continue;
    ck_assert(holds(rig.record->commands[2].pan));
    assert_time(rig.record->commands[2].time, 540ms);
    assert_turns(rig.command().pan, 40);
    ck_assert_uint_eq(rig.statuses.size(), 3);
    assert_text(rig.statuses[1].reason, "no frame came for 500 ms");
    ck_assert(rig.statuses[1].state == HeadState::stopped);
    assert_time(rig.statuses[1].time, 540ms);
    // At 540 ms the head is at 2 + 0.44 x 40 = 19.6 degrees.
    ck_assert_double_eq_tol(degrees(rig.statuses[1].pose.pan.position), 19.6, 1e-6);
  }
}
END_TEST

START_TEST(gaps_do_not_feed_the_watchdog) {
  Options options;
  options.watchdog = 500ms;
  Rig rig(options);
  rig.process(Rig::with(0s, Action::turn_right));
  rig.process(Rig::gap(460ms));  // it ends at 500 ms
  ck_assert_uint_eq(rig.record->commands.size(), 1);
  rig.process(Rig::gap(461ms));
  ck_assert_uint_eq(rig.record->commands.size(), 2);
  ck_assert(holds(rig.command().pan));
  assert_time(rig.command().time, 500ms);
  rig.process(Rig::gap(2s));  // once
  ck_assert_uint_eq(rig.record->commands.size(), 2);
}
END_TEST

START_TEST(a_watchdog_of_zero_never_expires) {
  Rig rig;
  rig.process(Rig::with(0s, Action::turn_right));
  rig.process(Rig::with(100s, Action::turn_right));
  ck_assert_uint_eq(rig.record->commands.size(), 2);
}
END_TEST

START_TEST(a_manual_command_expires_with_the_watchdog) {
  Options options;
  options.watchdog = 500ms;
  Rig rig(options);
  rig.process(Rig::with(0s, Action::hold));
  rig.controller.move(radians(30), 0, false, {}, rig.out);
  rig.process(Rig::with(40ms, Action::hold));
  assert_goes(rig.command().pan, 30, 40);
  rig.process(Rig::with(2s, Action::turn_left));
  ck_assert(holds(rig.command().pan));  // the override goes on, its command does not
  ck_assert(rig.statuses.back().state == HeadState::manual);
}
END_TEST

// Driven by a clock.

START_TEST(a_clock_driven_head_is_commanded_at_once) {
  Options options;
  options.clock_driven = true;
  Rig rig(options);
  HeadController::Frame frame = Rig::with(1s, Action::turn_right);
  frame.now = 1200ms;  // it took 200 ms to arrive
  rig.process(frame);
  assert_turns(rig.command().pan, 40);
  assert_time(rig.command().time, 1200ms);
  ck_assert(rig.controller.move(radians(30), 0, false, 1300ms, rig.out));
  assert_goes(rig.command().pan, 30, 40);
  assert_time(rig.command().time, 1300ms);
  rig.process(Rig::with(1400ms, Action::turn_right));
  ck_assert_uint_eq(rig.record->commands.size(), 2);  // the manual command stays
  ck_assert(rig.controller.automatic(1500ms, rig.out));
  ck_assert(holds(rig.command().pan));
  assert_time(rig.command().time, 1500ms);
}
END_TEST

START_TEST(a_tick_publishes_the_pose_and_returns_the_time_of_the_next_one) {
  Options options;
  options.clock_driven = true;
  options.watchdog = 510ms;
  Rig rig(options);
  assert_time(rig.controller.tick(1s, rig.out), 1200ms);  // at rest: 5 a second
  rig.process(Rig::with(1100ms, Action::turn_right));
  // Speed is reached at 1.2 s; from then on 50 a second.
  assert_time(rig.controller.tick(1190ms, rig.out), 1200ms);
  assert_time(rig.controller.tick(1300ms, rig.out), 1320ms);
  rig.collect();
  ck_assert_double_eq_tol(degrees(rig.poses.back().pan.position), 2 + 0.1 * 40, 1e-6);
  ck_assert_double_eq_tol(degrees(rig.poses.back().pan.speed), 40, 1e-6);
  assert_time(rig.poses.back().from, 1300ms);
  assert_time(rig.controller.tick(1600ms, rig.out), 1610ms);  // the watchdog's time
  ck_assert_uint_eq(rig.record->commands.size(), 1);
  rig.controller.tick(1610ms, rig.out);
  ck_assert_uint_eq(rig.record->commands.size(), 2);
  ck_assert(holds(rig.command().pan));
  assert_time(rig.command().time, 1610ms);
  rig.assert_status(HeadState::stopped, "no frame came for 510 ms");
}
END_TEST

START_TEST(a_halt_of_a_clock_driven_head_publishes_its_poses_until_it_rests) {
  Options options;
  options.clock_driven = true;
  Rig rig(options);
  rig.process(Rig::with(1s, Action::turn_right));
  rig.controller.halt("paused", 2s, 10s, rig.out);
  rig.collect();
  // At 2 s it is at 2 + 0.9 x 40 = 38 degrees, 0.1 s later at rest at 40.
  ck_assert_uint_eq(rig.poses.size(), 2);
  ck_assert_double_eq_tol(degrees(rig.poses[0].pan.position), 38, 1e-6);
  ck_assert_double_eq_tol(degrees(rig.poses[0].pan.acceleration), -400, 1e-6);
  ck_assert_int_le(std::abs((rig.poses[1].from - 2100ms).count()), 1);  // rounded up to a nanosecond
  ck_assert_double_eq_tol(degrees(rig.poses[1].pan.position), 40, 1e-6);
  ck_assert(!rig.poses[1].moving() && rig.poses[1].until == motion::kNever);
}
END_TEST

START_TEST(a_manual_command_given_in_a_halt_is_executed_when_it_ends) {
  Options options;
  options.clock_driven = true;
  options.resumed = false;
  Rig rig(options);
  ck_assert(rig.controller.move(radians(30), 0, false, 1s, rig.out));
  ck_assert(rig.record->commands.empty());
  rig.controller.resume(2s, rig.out);
  assert_goes(rig.command().pan, 30, 40);
  assert_time(rig.command().time, 2s);
}
END_TEST

START_TEST(a_decision_between_frames_moves_a_clock_driven_head_while_frames_come) {
  const auto tried = [](bool clock_driven, Time decided, Time now, auto&& before) {
    Options options;
    options.clock_driven = clock_driven;
    options.watchdog = 2s;
    Rig rig(options);
    rig.process(Rig::with(1s, Action::hold));
    before(rig);
    const std::size_t commands = rig.record->commands.size();
    rig.controller.on_decision(Rig::decision(Action::turn_right, decided), now, rig.out);
    if (rig.record->commands.size() == commands) return false;
    assert_turns(rig.command().pan, 40);
    assert_time(rig.command().time, now);
    return true;
  };
  const auto nothing = [](Rig&) {};
  ck_assert(tried(true, 1100ms, 1100ms, nothing));
  ck_assert(!tried(false, 1100ms, 1100ms, nothing));
  // At most 100 ms early and 1 s late.
  ck_assert(tried(true, 1200ms, 1100ms, nothing));
  ck_assert(!tried(true, 1201ms, 1100ms, nothing));
  ck_assert(tried(true, 1100ms, 2100ms, nothing));
  ck_assert(!tried(true, 1100ms, 2101ms, nothing));
  ck_assert(!tried(true, 1100ms, 1100ms, [](Rig& rig) { rig.controller.halt("paused", 1s, 10s, rig.out); }));
  ck_assert(!tried(true, 1100ms, 1100ms, [](Rig& rig) { rig.controller.stop(1s, rig.out); }));
  ck_assert(!tried(true, 3100ms, 3100ms, [](Rig& rig) { rig.controller.tick(3s, rig.out); }));  // no frames
}
END_TEST

// Poses and time.

START_TEST(the_pose_at_the_start_is_valid_for_the_latency_and_continued_without_a_seam) {
  Options options;
  options.setup.latency = 60ms;
  options.setup.pan = radians(15);
  Rig rig(options);
  ck_assert(rig.controller.announce(1s, rig.out) == Answer::done);
  ck_assert(rig.controller.announce(1020ms, rig.out) == Answer::done);
  rig.process(Rig::with(1040ms, Action::hold));
  const Time bounds[] = {1000ms, 1060ms, 1080ms, 1100ms};
  ck_assert_uint_eq(rig.poses.size(), 3);
  for (int k = 0; k < 3; ++k) {
    assert_time(rig.poses[k].from, bounds[k]);
    assert_time(rig.poses[k].until, bounds[k + 1]);
    ck_assert_double_eq_tol(degrees(rig.poses[k].pan.position), 15, 1e-9);
  }
}
END_TEST

START_TEST(a_new_command_takes_effect_after_the_published_poses_only) {
  Rig rig;
  rig.process(Rig::with(1s, Action::turn_right));  // poses until 1.04 s
  rig.process(Rig::with(1010ms, Action::turn_left));
  assert_time(rig.command().time, 1040ms);
  for (std::size_t k = 1; k < rig.poses.size(); ++k) assert_time(rig.poses[k].from, rig.poses[k - 1].until);
}
END_TEST

START_TEST(the_head_s_time_goes_on_when_running_time_begins_anew) {
  Options options;
  options.setup.latency = 60ms;
  Rig rig(options);
  rig.process(Rig::with(10s, Action::hold));  // poses until 10.06 s
  rig.controller.forget();
  ck_assert(!rig.controller.newest());
  rig.process(Rig::with(0s, Action::turn_right));
  assert_time(rig.command().time, 10060ms);
  assert_time(rig.poses.back().from, 0s);  // reports are in running time
  assert_time(rig.poses.back().until, 60ms);
  assert_time(rig.statuses.back().time, 0s);
}
END_TEST

// Faults.

START_TEST(a_fault_is_reported_once_and_the_state_returns_after_it) {
  Rig rig;
  rig.record->failure = "no power";
  for (const Time time : {0ms, 40ms}) {
    rig.controller.frame(Rig::with(time, Action::turn_right), rig.out);
    rig.assert_status(HeadState::fault, "no power");
  }
  ck_assert_uint_eq(rig.warnings.size(), 1);
  assert_text(rig.warnings[0], "fault: no power");
  rig.record->failure.clear();
  rig.process(Rig::with(80ms, Action::turn_right));
  rig.process(Rig::with(120ms, Action::turn_right));
  rig.assert_status(HeadState::turning, "rule 3 (left): turn-right");
  rig.record->failure = "no power";
  rig.controller.frame(Rig::with(160ms, Action::turn_right), rig.out);
  rig.collect();
  ck_assert_uint_eq(rig.warnings.size(), 2);
}
END_TEST

START_TEST(a_turn_by_hand_becomes_a_stop_after_500_ms_unless_it_is_repeated) {
  Options options;
  options.clock_driven = true;
  Rig rig(options);
  ck_assert(rig.controller.turn(radians(20), 0, 1s, rig.out));
  assert_turns(rig.command().pan, 20);
  ck_assert(rig.controller.turn(radians(20), 0, 1400ms, rig.out));
  rig.controller.tick(1600ms, rig.out);
  assert_turns(rig.command().pan, 20);
  ck_assert(rig.controller.tick(1880ms, rig.out) <= 1900ms);
  rig.controller.tick(1900ms, rig.out);
  ck_assert(holds(rig.command().pan));
  rig.assert_status(HeadState::manual, "its order was not repeated");
  // Whatever comes first after the deadline, a frame or a tick, stops the head.
  rig.controller.turn(radians(20), 0, 1950ms, rig.out);
  rig.process(Rig::with(2500ms, Action::turn_right));
  ck_assert(holds(rig.command().pan) && rig.command().stop);
  // Neither does it go on after a pause.
  rig.controller.turn(radians(20), 0, 2600ms, rig.out);
  rig.controller.halt("paused", 2700ms, 10s, rig.out);
  rig.controller.resume(4s, rig.out);
  ck_assert(holds(rig.command().pan));
}
END_TEST

// A head that looks for its reference obeys no hold before it has found it; what must stop it is a stop.
START_TEST(a_stop_an_expired_order_and_the_watchdog_command_more_than_a_hold) {
  Options options;
  options.clock_driven = true;
  options.watchdog = 500ms;
  Rig rig(options);
  rig.process(Rig::with(0s, Action::hold));
  ck_assert(holds(rig.command().pan) && !rig.command().stop);  // of the control law
  rig.controller.tick(600ms, rig.out);
  ck_assert(holds(rig.command().pan) && rig.command().stop);
  assert_time(rig.command().time, 600ms);
  rig.controller.turn(radians(20), 0, 1s, rig.out);
  ck_assert(!rig.command().stop);
  rig.controller.tick(1500ms, rig.out);
  ck_assert(holds(rig.command().pan) && rig.command().stop);
  rig.controller.move(radians(20), 0, false, 2s, rig.out);
  ck_assert(!rig.command().stop);
  rig.controller.stop(2100ms, rig.out);
  ck_assert(holds(rig.command().pan) && rig.command().stop);
  assert_time(rig.command().time, 2100ms);
  rig.controller.halt("paused", 2200ms, 10s, rig.out);
  rig.controller.resume(3s, rig.out);
  ck_assert(rig.command().stop);  // it latches
  // The same where frames drive the head.
  options.clock_driven = false;
  Rig stepped(options);
  stepped.process(Rig::with(0s, Action::turn_right));
  stepped.process(Rig::with(2s, Action::turn_right));
  ck_assert_uint_eq(stepped.record->commands.size(), 3);
  ck_assert(stepped.record->commands[1].stop && !stepped.record->commands[2].stop);
  stepped.controller.stop({}, stepped.out);
  stepped.process(Rig::with(2040ms, Action::turn_right));
  ck_assert(stepped.command().stop);
}
END_TEST

START_TEST(moves_expire_only_with_a_manual_timeout) {
  Options options;
  options.clock_driven = true;
  Rig rig(options);
  rig.controller.move(radians(100), 0, false, 1s, rig.out);
  rig.controller.tick(2s, rig.out);
  assert_goes(rig.command().pan, 100, 40);
  rig.controller.set_manual_timeout(300ms);
  rig.controller.move(radians(-100), 0, false, 3s, rig.out);
  rig.controller.tick(3299ms, rig.out);
  assert_goes(rig.command().pan, -100, 40);
  rig.controller.tick(3300ms, rig.out);
  ck_assert(holds(rig.command().pan));
}
END_TEST

START_TEST(a_turn_ends_after_500_ms_whatever_the_manual_timeout) {
  Options options;
  options.clock_driven = true;
  Rig rig(options);
  rig.controller.set_manual_timeout(60s);
  rig.controller.turn(radians(5), 0, 1s, rig.out);
  rig.controller.tick(1499ms, rig.out);
  ck_assert(!holds(rig.command().pan));
  rig.controller.tick(1500ms, rig.out);
  ck_assert(holds(rig.command().pan));
}
END_TEST

START_TEST(the_emergency_stop_takes_the_head_from_everybody_until_a_new_order) {
  Options options;
  options.clock_driven = true;
  Rig rig(options);
  rig.controller.move(radians(30), 0, false, 1s, rig.out);
  rig.record->emergency = true;
  rig.controller.tick(1100ms, rig.out);
  rig.assert_status(HeadState::stopped, "the emergency stop is pressed");
  ck_assert(!rig.controller.move(radians(10), 0, false, 1200ms, rig.out));
  ck_assert(!rig.controller.turn(1, 0, 1200ms, rig.out));
  ck_assert(!rig.controller.automatic(1200ms, rig.out));
  ck_assert(!rig.controller.follow(4, 1200ms, rig.out));
  rig.record->emergency = false;
  rig.controller.tick(2s, rig.out);
  rig.assert_status(HeadState::manual, "the emergency stop was pressed: it waits for an order");
  const auto before = rig.record->commands.size();
  rig.process(Rig::with(2100ms, Action::turn_left));  // decisions do not move it
  ck_assert_uint_eq(rig.record->commands.size(), before);
  ck_assert(holds(rig.command().pan));
  ck_assert(rig.controller.automatic(2200ms, rig.out));
  rig.process(Rig::with(2300ms, Action::turn_left));
  assert_turns(rig.command().pan, -40);
}
END_TEST

START_TEST(a_manual_command_ends_with_a_fault) {
  Rig rig;
  rig.controller.move(radians(30), 0, false, {}, rig.out);
  rig.record->failure = "no power";
  rig.controller.frame(Rig::with(0s, Action::hold), rig.out);
  rig.assert_status(HeadState::fault, "no power (the manual command ended)");
  rig.record->failure.clear();
  rig.process(Rig::with(40ms, Action::turn_left));
  rig.assert_status(HeadState::manual, "the manual command ended: the head was at fault");
  ck_assert(rig.command().stop && holds(rig.command().pan));  // neither that command nor a decision moves it
  rig.controller.move(radians(20), 0, false, {}, rig.out);
  rig.process(Rig::with(80ms, Action::hold));
  rig.assert_status(HeadState::manual, "manual command: move");
  ck_assert_double_eq_tol(degrees(rig.command().pan.value), 20, 1e-9);
}
END_TEST

// The fault is known before the order is given.
START_TEST(an_order_that_is_given_during_a_fault_ends_with_it) {
  for (const bool clock_driven : {false, true})
    for (const bool turn : {false, true}) {
      Options options;
      options.clock_driven = clock_driven;
      Rig rig(options);
      Time now{};
      // A frame, and a tick where the clock drives the head.
      const auto pass = [&] {
        rig.controller.frame(Rig::with(now, Action::turn_left), rig.out);
        if (clock_driven) rig.controller.tick(now + 20ms, rig.out);
        now += 40ms;
      };
      rig.record->failure = "no power";
      pass();
      rig.assert_status(HeadState::fault, "no power");
      const auto order = [&](double angle) {
        return turn ? rig.controller.turn(radians(angle), 0, now, rig.out)
                    : rig.controller.move(radians(angle), 0, false, now, rig.out);
      };
      ck_assert(order(30));
      pass();
      rig.assert_status(HeadState::fault, "no power (the manual command ended)");
      ck_assert(order(25));  // each of them
      pass();
      rig.record->failure.clear();
      const std::size_t before = rig.record->commands.size();
      pass();
      rig.assert_status(HeadState::manual, "the manual command ended: the head was at fault");
      pass();
      rig.controller.halt("paused", now, 10s, rig.out);
      rig.controller.resume(now, rig.out);
      pass();
      ck_assert_uint_gt(rig.record->commands.size(), before);
      for (std::size_t k = before; k < rig.record->commands.size(); ++k)
        ck_assert(rig.record->commands[k].stop && holds(rig.record->commands[k].pan));
      ck_assert_uint_eq(rig.warnings.size(), 1);
      // The next one is obeyed.
      ck_assert(order(20));
      pass();
      rig.assert_status(HeadState::manual, turn ? "manual command: turn" : "manual command: move");
      ck_assert_double_eq_tol(degrees(rig.command().pan.value), 20, 1e-9);
    }
}
END_TEST

// It comes while the driver answers a tick, and is not executed when the tick takes the failure of the command before it.
START_TEST(an_order_outlives_the_failure_of_an_older_command) {
  Options options;
  options.clock_driven = options.blocks = true;
  Rig rig(options);
  rig.record->failure = "no power";
  rig.controller.frame(Rig::with(0s, Action::turn_left), rig.out);
  Time now = 20ms;
  for (; rig.statuses.empty() || rig.statuses.back().state != HeadState::fault; now += 20ms) {
    rig.controller.tick(now, rig.out);
    rig.collect();
  }
  std::promise<void> checked;
  DeferredNotifications other{rig.queue, rig.name};
  bool once = true;
  rig.record->in_state = [&, here = now] {
    if (!std::exchange(once, false)) return;
    rig.record->in_command = [&] { checked.get_future().wait(); };
    ck_assert(rig.controller.move(radians(30), 0, false, here, other));
  };
  rig.controller.frame(Rig::with(now, Action::turn_left), rig.out);
  rig.controller.tick(now, rig.out);
  rig.assert_status(HeadState::fault, "no power");
  rig.record->failure.clear();
  checked.set_value();
  for (; rig.statuses.back().state == HeadState::fault; now += 20ms) {
    rig.controller.tick(now, rig.out);
    rig.collect();
  }
  rig.assert_status(HeadState::manual, "manual command: move");
  rig.controller.close(10s);
  assert_goes(rig.command().pan, 30, 40);
}
END_TEST

// An order that was given before, or while nothing comes back, and was not taken by the driver.
START_TEST(an_order_to_a_driver_that_does_not_answer_moves_nothing_later) {
  for (const bool before : {true, false}) {
    Options options;
    options.clock_driven = options.blocks = true;
    Rig rig(options);
    std::promise<void> asked, answers;
    const std::shared_future<void> answer = answers.get_future().share();
    rig.record->in_state = [&, once = true]() mutable {
      if (std::exchange(once, false)) asked.set_value();
      answer.wait();
    };
    rig.controller.tick(0s, rig.out);
    asked.get_future().wait();
    const auto order = [&](Time now) { ck_assert(rig.controller.move(radians(30), 0, false, now, rig.out)); };
    if (before) order(10ms);
    for (Time now = 20ms; now < 1100ms; now += 300ms) rig.controller.tick(now, rig.out);
    rig.controller.tick(1100ms, rig.out);
    rig.assert_status(HeadState::fault, before ? "the head does not answer (the manual command ended)"
                                               : "the head does not answer");
    if (!before) order(1110ms);
    answers.set_value();
    for (Time now = 1120ms; rig.statuses.back().state == HeadState::fault; now += 20ms) {
      rig.controller.tick(now, rig.out);
      rig.collect();
    }
    rig.assert_status(HeadState::manual, "the manual command ended: the head was at fault");
    rig.controller.close(10s);
    for (const HeadCommand& command : rig.record->commands) ck_assert(holds(command.pan));
  }
}
END_TEST

// A head whose faults end with the next command that it obeys.
START_TEST(an_order_that_ends_the_fault_is_obeyed) {
  for (const bool clock_driven : {false, true}) {
    Options options;
    options.clock_driven = clock_driven;
    Rig rig(options);
    rig.record->failure = "no power";
    rig.controller.frame(Rig::with(0s, Action::turn_left), rig.out);
    if (clock_driven) rig.controller.tick(20ms, rig.out);
    rig.assert_status(HeadState::fault, "no power");
    rig.record->failure.clear();
    ck_assert(rig.controller.move(radians(30), 0, false, 30ms, rig.out));
    rig.assert_status(HeadState::fault, "no power");  // until it has
    for (const Time now : {40ms, 80ms}) {
      rig.controller.frame(Rig::with(now, Action::turn_left), rig.out);
      if (clock_driven) rig.controller.tick(now + 20ms, rig.out);
    }
    rig.assert_status(HeadState::manual, "manual command: move");
    assert_goes(rig.command().pan, 30, 40);
  }
}
END_TEST

// 100 degrees by hand, of which the picture shows nothing: it is dark, or nobody measures it.
START_TEST(a_reference_is_lost_only_where_the_picture_is_measured) {
  for (const bool measured : {false, true}) {
    Options options;
    options.clock_driven = true;
    options.simulated = false;
    Rig rig(options);
    for (Time now = 0ms; now < 12s; now += 40ms) {
      const double speed = now < 5s ? 20 : now < 8s ? -20 : 0;
      if (speed != 0) rig.controller.turn(radians(speed), 0, now, rig.out);
      rig.controller.tick(now, rig.out);
      auto frame = Rig::empty(now);
      if (measured) frame.motion.emplace().picture = {640, 480};
      ck_assert(rig.controller.frame(frame, rig.out) == Answer::done);
      rig.collect();
    }
    ck_assert_int_eq(rig.record->homes > 0, measured);
    ck_assert_uint_eq(rig.warnings.size(), 0);
  }
}
END_TEST

// A head that turns by three quarters of what it is commanded. Where its pose is of angles, its model is not of speeds.
START_TEST(what_the_picture_shows_of_a_head_s_speeds_is_given_to_its_driver) {
  for (const bool by_speeds : {false, true}) {
    Options options;
    options.clock_driven = true;
    options.simulated = false;
    Rig rig(options);
    rig.record->by_speeds = by_speeds;
    const auto twin = drivers::make_head("simulated");
    assert_text(twin->open(options.setup), "");
    double before = 0;
    std::size_t given = 0;
    for (int k = 0; k < 500; ++k) {
      const Time now = k * 40ms;
      const double speed = (k / 25 % 2 == 0 ? 1 : -1) * (k / 50 % 2 == 0 ? 10 : 20);
      rig.controller.turn(radians(speed), 0, now, rig.out);
      rig.controller.tick(now, rig.out);
      for (; given < rig.record->commands.size(); ++given) twin->command(rig.record->commands[given]);
      Pose pose;
      assert_text(twin->state(now, pose), "");
      auto frame = Rig::empty(now);
      const double turned = .75 * (pose.pan.position - before);
      before = pose.pan.position;
      frame.motion =
          PictureMotion{vision::Transform::translation(-turned / kPixel, 0), 1, {640, 480}, 0, true};
      ck_assert(rig.controller.frame(frame, rig.out) == Answer::done);
      rig.collect();
    }
    ck_assert_int_eq(!rig.record->maps.empty(), by_speeds);
    if (!by_speeds) continue;
    // This driver does not use it: what is learnt says so each time. The first one is right.
    const double first = degrees(rig.record->maps.front().actual(radians(15)));
    ck_assert_msg(first > .7 * 15 && first < .95 * 15, "%g", first);
  }
}
END_TEST

// A head that turns 200 ms later than it is reckoned, and reports its position at last.
START_TEST(what_is_learnt_of_the_dead_time_shifts_no_reported_pose) {
  Options options;
  options.clock_driven = true;
  options.simulated = false;
  Rig rig(options);
  const auto twin = drivers::make_head("simulated");
  assert_text(twin->open(options.setup), "");
  std::vector<double> positions(6, 0);
  std::size_t given = 0;
  Time now{};
  const auto frame = [&] {
    const double speed = (now / 1s % 2 == 0 ? 1 : -1) * (now / 2s % 2 == 0 ? 10 : 20);
    rig.controller.turn(radians(speed), 0, now, rig.out);
    rig.controller.tick(now, rig.out);
    rig.collect();
    for (; given < rig.record->commands.size(); ++given) twin->command(rig.record->commands[given]);
    Pose pose;
    assert_text(twin->state(now, pose), "");
    positions.push_back(pose.pan.position);
    auto frame = Rig::empty(now);
    const double turned = positions.end()[-6] - positions.end()[-7];
    frame.motion = PictureMotion{vision::Transform::translation(-turned / kPixel, 0), 1, {640, 480}, 0, true};
    ck_assert(rig.controller.frame(frame, rig.out) == Answer::done);
  };
  for (; now < 20s; now += 40ms) frame();
  const auto late = [&] { return rig.poses.back().from - (now - 40ms); };
  ck_assert_msg(late() >= 140ms && late() <= 260ms, "%g s", motion::seconds(late()));
  rig.record->measured = true;
  for (int k = 0; k < 3; ++k, now += 40ms) frame();
  assert_time(late(), 0ms);
  rig.record->measured = false;  // its commands are as late as before
  for (int k = 0; k < 3; ++k, now += 40ms) frame();
  ck_assert(late() >= 140ms && late() <= 260ms);
}
END_TEST

// 45 degrees a second, by the picture. Then the stream begins anew, and a person stands 20 degrees to the right.
START_TEST(a_new_stream_knows_nothing_of_the_base) {
  Options options;
  options.clock_driven = true;
  options.simulated = false;
  Rig rig(options);
  Time now{};
  for (; now < 2s; now += 40ms) {
    rig.controller.tick(now, rig.out);
    auto frame = Rig::empty(now);
    frame.motion = PictureMotion{
        vision::Transform::translation(-radians(45) * .04 / kPixel, 0), 1, {640, 480}, 0, false};
    ck_assert(rig.controller.frame(frame, rig.out) == Answer::done);
  }
  rig.controller.forget();
  ck_assert(rig.controller.frame(Rig::with(now, Action::track, 20), rig.out) == Answer::done);
  ck_assert_double_eq_tol(degrees(rig.command().pan.value), 20, .5);
}
END_TEST

START_TEST(a_head_that_cannot_be_opened_is_an_error_and_reported_once) {
  Options options;
  options.refusal = "no such port";
  Rig rig(options);
  rig.controller.on_refusal(rig.out);
  rig.controller.on_refusal(rig.out);
  rig.assert_status(HeadState::fault, "no such port");
  ck_assert_uint_eq(rig.warnings.size(), 1);
  assert_text(rig.warnings[0], "refusal: no such port");
}
END_TEST

START_TEST(an_interrupted_frame_is_passed_again) {
  Options options;
  options.blocks = true;
  Rig rig(options);
  rig.controller.interrupt(true);
  ck_assert(rig.controller.frame(Rig::with(1s, Action::turn_right), rig.out) == Answer::interrupted);
  ck_assert(!rig.controller.newest());
  rig.controller.interrupt(false);
  rig.process(Rig::with(1s, Action::turn_right));
  assert_time(*rig.controller.newest(), 1s);
  ck_assert_uint_eq(rig.record->commands.size(), 1);
  rig.controller.close(10s);
}
END_TEST

// No decision moves it on, neither of a frame nor between two.
START_TEST(after_reports_that_contradict_the_commands_only_an_order_moves_the_head) {
  Options options;
  options.clock_driven = true;
  Rig rig(options);
  rig.controller.frame(Rig::with(40ms, Action::turn_right), rig.out);
  ck_assert(rig.record->commands.back().pan.kind != Kind::hold);
  const std::size_t before = rig.record->commands.size();
  rig.record->parted = true;
  rig.controller.tick(60ms, rig.out);
  for (int k = 2; k < 10; ++k) rig.controller.frame(Rig::with(k * 40ms, Action::turn_right), rig.out);
  FusionDecision decision;
  decision.made.action = Action::turn_left;
  decision.decided = 400ms;
  rig.controller.on_decision(decision, 400ms, rig.out);
  ck_assert_uint_eq(rig.record->commands.size(), before);
  ck_assert(rig.controller.automatic(rig.clock(410ms), rig.out));
  rig.controller.frame(Rig::with(420ms, Action::turn_right), rig.out);
  ck_assert_uint_gt(rig.record->commands.size(), before);
  ck_assert(rig.record->commands.back().pan.kind != Kind::hold);
}
END_TEST

int main() {
  return tests::run_suite("head_controller",
                          {a_target_is_reckoned_from_the_pose_on_the_frame,
                           without_a_pose_on_the_frame_the_head_s_own_pose_at_that_time_counts,
                           the_error_is_that_at_the_time_when_the_command_takes_effect,
                           within_the_dead_band_the_head_rests,
                           a_turn_is_made_at_full_speed_and_search_and_return_to_zero_at_turn_speed,
                           an_unchanged_state_is_reported_once_and_every_command_given,
                           without_fusion_a_track_is_followed_and_the_head_then_returns_to_zero,
                           a_target_beyond_a_limit_is_approached_to_the_limit,
                           new_limits_reach_the_driver_at_once_and_the_law_with_the_next_frame,
                           refused_limits_leave_the_old_ones_in_force,
                           limits_that_are_set_during_a_halt_apply_when_it_ends,
                           a_manual_command_takes_precedence_until_automatic,
                           a_relative_move_adds_to_the_last_commanded_position,
                           the_chosen_track_takes_precedence_over_fusion_and_ends_a_manual_command,
                           a_chosen_track_that_is_on_no_frame_for_five_seconds_is_given_up_with_a_warning,
                           a_halted_head_brakes_and_follows_frames_again_after_resume,
                           a_manual_command_survives_a_halt_and_not_the_end_of_the_stream,
                           the_end_of_the_stream_outlasts_resume_and_ends_with_a_flush,
                           a_closed_controller_refuses_everything,
                           the_watchdog_brakes_at_its_time_where_frames_stayed_away,
                           gaps_do_not_feed_the_watchdog,
                           a_watchdog_of_zero_never_expires,
                           a_manual_command_expires_with_the_watchdog,
                           a_clock_driven_head_is_commanded_at_once,
                           a_tick_publishes_the_pose_and_returns_the_time_of_the_next_one,
                           a_halt_of_a_clock_driven_head_publishes_its_poses_until_it_rests,
                           a_manual_command_given_in_a_halt_is_executed_when_it_ends,
                           a_decision_between_frames_moves_a_clock_driven_head_while_frames_come,
                           the_pose_at_the_start_is_valid_for_the_latency_and_continued_without_a_seam,
                           a_new_command_takes_effect_after_the_published_poses_only,
                           the_head_s_time_goes_on_when_running_time_begins_anew,
                           a_fault_is_reported_once_and_the_state_returns_after_it,
                           a_turn_by_hand_becomes_a_stop_after_500_ms_unless_it_is_repeated,
                           a_stop_an_expired_order_and_the_watchdog_command_more_than_a_hold,
                           moves_expire_only_with_a_manual_timeout,
                           a_turn_ends_after_500_ms_whatever_the_manual_timeout,
                           the_emergency_stop_takes_the_head_from_everybody_until_a_new_order,
                           after_reports_that_contradict_the_commands_only_an_order_moves_the_head,
                           a_manual_command_ends_with_a_fault,
                           an_order_that_is_given_during_a_fault_ends_with_it,
                           an_order_outlives_the_failure_of_an_older_command,
                           an_order_to_a_driver_that_does_not_answer_moves_nothing_later,
                           an_order_that_ends_the_fault_is_obeyed,
                           a_reference_is_lost_only_where_the_picture_is_measured,
                           what_the_picture_shows_of_a_head_s_speeds_is_given_to_its_driver,
                           what_is_learnt_of_the_dead_time_shifts_no_reported_pose,
                           a_new_stream_knows_nothing_of_the_base,
                           a_head_that_cannot_be_opened_is_an_error_and_reported_once,
                           an_interrupted_frame_is_passed_again});
}
