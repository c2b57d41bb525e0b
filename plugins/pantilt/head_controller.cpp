// SPDX-License-Identifier: LGPL-2.1-or-later
#include "head_controller.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "shared/clock_times.hpp"

namespace cerberus::plugin {

namespace {

using drivers::HeadCommand;
using motion::AxisCommand;
using motion::Pose;
using std::chrono::milliseconds;

// So far ahead the head's way is asked for: a command changes it sooner than that.
constexpr motion::Time kAhead = std::chrono::seconds(1);
constexpr motion::Time kWhileMoving = milliseconds(20), kAtRest = milliseconds(200);
// A driver that answers is asked every 20 ms; one that does not, in this time, is at fault.
constexpr motion::Time kSilence = std::chrono::seconds(1);
constexpr char kSilent[] = "the head does not answer";
// When something can have been decided that is said now.
constexpr motion::Time kHaste = milliseconds(100), kStale = std::chrono::seconds(1);
constexpr auto kTickPatience = milliseconds(10);
// A loaded machine is no reason to decide otherwise than an idle one; who cannot wait interrupts.
constexpr auto kFramePatience = std::chrono::seconds(10);

const char* word(const control::Order& order) {
  using control::Doing;
  switch (order.doing) {
    case Doing::holding:
      return "holding";
    case Doing::tracking:
      return order.limited ? "limited" : "tracking";
    case Doing::turning:
      return order.limited ? "limited" : "turning";
    case Doing::searching:
      return "searching";
    case Doing::zeroing:
      return "zeroing";
  }
  return "holding";
}

}  // namespace

void HeadController::open(std::unique_ptr<drivers::HeadRunner> runner, const drivers::HeadSetup& setup) {
  const std::lock_guard guard(lock_);
  runner_ = std::move(runner);
  setup_ = setup;
  asked_ = setup.limits;
  limits_wait_ = false;
  law_.reset();
  pilot_.reset();
  pilot_.follow(0);
  history_.clear();
  watchdog_.rest();
  manual_ = faulty_ = silent_ = ended_ = false;
  halted_ = fresh_ = true;
  told_ = epoch_ = published_ = Time::zero();
  newest_.reset();
  late_since_ = motion::kNever;
  Pose start;
  start.pan.position = setup.pan;
  start.tilt.position = setup.tilt;
  history_.add(start);
  status_ = {};
}

void HeadController::hear(DeferredNotifications& out) {
  const std::lock_guard guard(lock_);
  if (!runner_) return;
  report_refusal(told_, out);
}

void HeadController::close(drivers::HeadRunner::Patience patience) {
  std::shared_ptr<drivers::HeadRunner> runner;
  {
    const std::lock_guard guard(lock_);
    runner = std::move(runner_);
  }
  if (runner) runner->set_close_patience(patience);
}

void HeadController::set_options(const control::LawOptions& law, const fusion::FuserOptions& fuser,
                                 Time watchdog) {
  const std::lock_guard guard(lock_);
  law_.set_options(law);
  confine_law();
  pilot_.set_options(fuser);
  timeout_ = watchdog;
  watchdog_.set_timeout(watchdog);
}

std::string HeadController::set_limits(const motion::Limits& limits, std::optional<Time> at) {
  const std::lock_guard guard(lock_);
  if (!runner_ || limits == asked_) return {};
  asked_ = limits;
  if (std::string wrong = motion::check(limits); !wrong.empty()) return wrong;
  setup_.limits = limits;
  confine_law();
  limits_wait_ = halted_;
  if (!halted_) runner_->limit(earliest(at), limits);
  return {};
}

void HeadController::set_clock_driven(bool on) {
  const std::lock_guard guard(lock_);
  clock_driven_ = on;
}

void HeadController::forget() {
  const std::lock_guard guard(lock_);
  newest_.reset();
  fresh_ = true;
  told_ = std::max(told_, published_);  // what was told happens before whatever comes now
  law_.reset();
  pilot_.reset();
  ended_ = false;
}

// A running time that went back (a flush, another base time) does not turn the head's time back.
HeadController::Time HeadController::head_time(Time running) {
  constexpr Time kJitter = milliseconds(100);
  if (running + epoch_ + kJitter < told_) epoch_ = told_ - running;
  told_ = std::max(told_, running + epoch_);
  return told_;
}

// When what is told now counts at the earliest, in the head's time: nothing that was told of its way becomes untrue.
HeadController::Time HeadController::earliest(std::optional<Time> at) {
  told_ = at && clock_driven_ ? head_time(*at) : std::max(told_, published_ - setup_.latency);
  return told_;
}

void HeadController::confine_law() {
  control::LawOptions options = law_.options();
  options.limits = setup_.limits;
  law_.set_options(options);
}

Pose HeadController::running(Pose pose) const {
  pose.from = std::max(Time::zero(), pose.from - epoch_);
  if (pose.until != motion::kNever) pose.until = std::max(pose.from, pose.until - epoch_);
  return pose;
}

void HeadController::remember(const std::vector<Pose>& poses) {
  for (const Pose& pose : poses) history_.add(pose);
}

// The pieces from `published_` on, the last one cut at `until` (kNever: only the first, as it is).
void HeadController::publish(const std::vector<Pose>& poses, Time until, DeferredNotifications& out) {
  if (poses.empty()) return;
  if (until == motion::kNever) {
    out.tell(running(poses.front()));
    return;
  }
  for (Pose pose : poses) {
    pose.until = std::max(pose.from, std::min(pose.until, until));
    out.tell(running(pose));
    published_ = pose.until;
    if (pose.until >= until) break;
  }
}

void HeadController::say(const char* state, std::string reason, Time head, DeferredNotifications& out) {
  if (g_str_equal(state, status_.state) && reason == status_.reason) return;
  status_ = {state, std::move(reason), running(history_.at(head)), std::max(Time::zero(), head - epoch_)};
  out.say(status_);
}

void HeadController::say_by_hand(Time head, DeferredNotifications& out) {
  if (manual_ && !halted_ && !faulty_) say("manual", hand_, head, out);
}

void HeadController::complain(const std::string& failure, Time head, DeferredNotifications& out) {
  if (failure.empty()) return;
  const bool known = std::exchange(faulty_, true);
  say("fault", failure, head, out);
  if (!known) out.say(Fault{failure});
}

// It cannot be opened: an error and no warning.
void HeadController::report_refusal(Time head, DeferredNotifications& out) {
  std::string why = runner_->refusal();
  if (why.empty()) return;
  faulty_ = true;
  say("fault", why, head, out);
  out.say(Refusal{std::move(why)});
}

// After an answer: is the head at fault, still or no longer?
void HeadController::check(const std::string& failure, Time head, DeferredNotifications& out) {
  if (!runner_ || !runner_->healthy()) {
    if (runner_) report_refusal(head, out);
    complain(failure, head, out);
    return;
  }
  if (std::exchange(faulty_, false)) say_by_hand(head, out);
}

HeadController::Answer HeadController::announce(Time at, DeferredNotifications& out) {
  std::unique_lock guard(lock_);
  const auto runner = runner_;
  if (!runner) return Answer::failed;
  const Time head = head_time(at);
  const Time from = fresh_ ? head : std::max(head, published_);
  const Time until = clock_driven_ ? motion::kNever : std::max(from, head + setup_.latency);
  // Live nobody waits, and tick() tells the rest soon.
  const drivers::HeadRunner::Patience patience = clock_driven_ ? kTickPatience : kFramePatience;
  guard.unlock();
  std::vector<Pose> poses;
  const Answer answer = runner->ask({}, from, from + setup_.latency + kAhead, poses, patience);
  guard.lock();
  if (answer == Answer::interrupted) return answer;
  fresh_ = false;
  // A driver that does not answer: then what is known of it.
  if (answer != Answer::done) poses.assign(1, history_.at(from));
  if (answer != Answer::done) poses[0].from = from;
  remember(poses);
  publish(poses, until, out);
  return answer;
}

HeadCommand HeadController::decide(const Frame& frame, Time now, DeferredNotifications& out) {
  HeadCommand command{now, {}, {}};
  if (halted_) return command;
  if (manual_) {
    say_by_hand(now, out);
    command.pan = wanted_.pan;
    command.tilt = wanted_.tilt;
    return command;
  }
  const Time taken = frame.running + epoch_;
  const Pose capture = frame.capture ? *frame.capture : history_.at(taken);
  const Pose ahead = history_.at(now + setup_.latency);
  const TargetSelector::Verdict verdict = pilot_.look(frame.buffer, frame.running, capture.pan.position);
  if (verdict.lost != 0) out.say(Lost{verdict.lost});
  const control::Order order = law_.update(verdict.wish, frame.lens, capture, ahead);
  command.pan = order.pan;
  command.tilt = order.tilt;
  if (!faulty_) say(word(order), verdict.reason, now, out);
  return command;
}

HeadController::Answer HeadController::frame(const Frame& frame, DeferredNotifications& out) {
  std::unique_lock guard(lock_);
  const auto runner = runner_;
  if (!runner) return Answer::failed;
  if (clock_driven_) {
    newest_ = frame.running;
    if (!frame.buffer || halted_) return Answer::done;
    const Time now = head_time(frame.now);
    watchdog_.feed(now);
    const HeadCommand command = decide(frame, now, out);
    if (!manual_) runner->command(command);
    return Answer::done;
  }

  if (silent_ && !runner->idle()) {  // blocked since a frame before: nothing is caught up with
    newest_ = frame.running;
    complain(kSilent, told_, out);
    return Answer::late;
  }
  // What was told of the head's way stays true: nothing given now changes it before `published_`.
  const Time now = std::max(head_time(frame.running), published_ - setup_.latency);
  const Time horizon = now + std::max(setup_.latency, frame.length) + kAhead;
  std::vector<Pose> poses;
  // Until here at least no frame came to decide by: until the one before this could have come, or the gap's end.
  const Time nobody = frame.buffer ? now - frame.length : now + frame.length;
  if (const Time deadline = watchdog_.deadline(); deadline < nobody) {
    const HeadCommand brake{std::max(deadline, published_ - setup_.latency), {}, {}};
    told_ = std::max(told_, brake.time);
    guard.unlock();
    const Answer answer = runner->ask(brake, brake.time, horizon, poses, kFramePatience);
    guard.lock();
    if (answer == Answer::interrupted) return answer;
    watchdog_.rest();
    remember(poses);
    stand(brake.time, out);
  }
  std::optional<HeadCommand> command;
  if (frame.buffer) command = decide(frame, now, out);
  const Time from = published_;
  guard.unlock();
  const Answer answer = runner->ask(command, from, horizon, poses, kFramePatience);
  guard.lock();
  if (answer == Answer::interrupted) return answer;
  newest_ = frame.running;
  if (frame.buffer) watchdog_.feed(now);
  silent_ = answer == Answer::late;
  if (silent_) {
    complain(kSilent, now, out);
    return answer;
  }
  check(runner->failure(), now, out);
  remember(poses);
  publish(poses, std::max(from, now + std::max(setup_.latency, frame.length)), out);
  return answer;
}

void HeadController::heed(const CerberusFusion& fusion, Time at, DeferredNotifications& out) {
  const std::lock_guard guard(lock_);
  // Frames alone keep a head going: one that waits for them moves for nobody.
  if (!runner_ || !clock_driven_ || halted_ || manual_ || !watchdog_.alive()) return;
  const Time decided = time_of(fusion.decided);
  if (decided > at + kHaste || decided < at - kStale) return;
  const std::optional<TargetSelector::Verdict> verdict = pilot_.heed(fusion);
  if (!verdict) return;
  const Time now = head_time(at);
  const Pose ahead = history_.at(now + setup_.latency);
  const control::Order order = law_.update(verdict->wish, {}, ahead, ahead);
  if (!faulty_) say(word(order), verdict->reason, now, out);
  runner_->command({now, order.pan, order.tilt});
}

HeadController::Time HeadController::tick(Time at, DeferredNotifications& out) {
  std::unique_lock guard(lock_);
  const auto runner = runner_;
  if (!runner) return at + kAtRest;
  const Time now = head_time(at);
  if (watchdog_.bites(now)) {
    runner->command({now, {}, {}});
    stand(now, out);
  }
  guard.unlock();
  std::vector<Pose> poses;
  const Answer answer = runner->ask({}, now, now + setup_.latency + kAhead, poses, kTickPatience);
  guard.lock();
  if (answer == Answer::late) {
    if (late_since_ == motion::kNever) late_since_ = now;
    if (now - late_since_ > kSilence) complain(kSilent, now, out);
    return at + kWhileMoving;
  }
  if (answer != Answer::interrupted) check(runner->failure(), now, out);
  if (poses.empty()) return at + kWhileMoving;
  late_since_ = motion::kNever;
  remember(poses);
  publish(poses, motion::kNever, out);
  const Pose& pose = poses.front();
  Time next = now + (pose.moving() ? kWhileMoving : kAtRest);
  next = std::max(now + milliseconds(1), std::min({next, pose.until, watchdog_.deadline()}));
  return next - epoch_;
}

void HeadController::halt(const char* reason, std::optional<Time> at, drivers::HeadRunner::Patience patience,
                          DeferredNotifications& out) {
  std::unique_lock guard(lock_);
  const auto runner = runner_;
  if (!runner || std::exchange(halted_, true)) return;
  const Time now = earliest(at);
  watchdog_.rest();
  law_.reset();
  guard.unlock();
  const Answer answer = runner->stop(now, patience);
  std::vector<Pose> poses;
  if (answer == Answer::done && clock_driven_) runner->ask({}, now, motion::kNever, poses, kTickPatience);
  guard.lock();
  remember(poses);
  for (const Pose& pose : poses) out.tell(running(pose));  // until it rests: in PAUSED nobody asks again
  if (answer == Answer::late) complain("the head does not answer: it may not have stopped", now, out);
  if (!faulty_) say("stopped", reason, now, out);
}

void HeadController::end(std::optional<Time> at, drivers::HeadRunner::Patience patience,
                         DeferredNotifications& out) {
  {
    const std::lock_guard guard(lock_);
    ended_ = true;
    pilot_.follow(0);
    lapse("its order was over with the stream");
  }
  halt("end of the stream", at, patience, out);
}

// What the application ordered is over. Who has the head in his hand keeps it: nobody else moves it, and it stands.
void HeadController::lapse(const char* reason) {
  if (!manual_) return;
  wanted_ = {};
  hand_ = reason;
}

// The watchdog has bitten.
void HeadController::stand(Time head, DeferredNotifications& out) {
  lapse("its order was over when no frame came");
  say("stopped", "no frame came for " + std::to_string(timeout_ / milliseconds(1)) + " ms", head, out);
}

void HeadController::resume(std::optional<Time> at, DeferredNotifications& out) {
  const std::lock_guard guard(lock_);
  if (ended_) return;
  halted_ = false;
  if (runner_ && std::exchange(limits_wait_, false)) runner_->limit(earliest(at), setup_.limits);
  if (runner_ && manual_ && clock_driven_ && at)
    runner_->command({head_time(*at), wanted_.pan, wanted_.tilt});
  say_by_hand(told_, out);
}

void HeadController::interrupt(bool on) {
  const std::lock_guard guard(lock_);
  if (runner_) runner_->interrupt(on);
}

std::optional<HeadController::Time> HeadController::newest() const {
  const std::lock_guard guard(lock_);
  return newest_;
}

}  // namespace cerberus::plugin
