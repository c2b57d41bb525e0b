// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/head_controller.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cerberus::control {

namespace {

using drivers::HeadCommand;
using motion::Pose;
using std::chrono::milliseconds;

// The head's plan is read this far ahead; the next command changes it sooner.
constexpr motion::Time kAhead = std::chrono::seconds(1);
constexpr motion::Time kWhileMoving = milliseconds(20), kAtRest = milliseconds(200);
// The driver is queried every 20 ms; without an answer for this time it is at fault.
constexpr motion::Time kSilence = std::chrono::seconds(1);
constexpr char kOrderEnded[] = "the manual command ended: the head was at fault";
constexpr char kGoesRound[] = "goes round to meet the track on the other side";
constexpr char kSilent[] = "the head does not answer";
// A decision between frames is used if its time is at most kEarly after and at most kStale before now.
constexpr motion::Time kEarly = milliseconds(100), kStale = std::chrono::seconds(1);
// A reference that was not found is looked for again after this time. derived: longer than HelperHead looks for it.
constexpr motion::Time kHomePatience = std::chrono::seconds(60);
// A request to the base is repeated this often. derived: five times in the half second that it holds
constexpr motion::Time kAskAgain = milliseconds(100);
// A picture that is repeated for longer is too old to predict from.
constexpr auto kLongestBlind =
    std::chrono::duration_cast<motion::Time>(std::chrono::duration<double>(TargetFilter::kPause));
constexpr auto kTickPatience = milliseconds(10);
// This is long because results must not depend on the load of the machine; a state change interrupts the wait.
constexpr auto kFramePatience = std::chrono::seconds(10);

HeadState state_of(const Command& command) {
  switch (command.state) {
    case State::tracking:
      return command.limited ? HeadState::limited : HeadState::tracking;
    case State::turning:
      return command.limited ? HeadState::limited : HeadState::turning;
    case State::searching:
      return HeadState::searching;
    case State::zeroing:
      return HeadState::zeroing;
    case State::holding:
      break;
  }
  return HeadState::holding;
}

// A track that is only predicted is not.
bool is_seen(const Observation& frame, std::uint32_t id) {
  const auto found = std::ranges::find(frame.tracks, id, &fusion::Track::id);
  return found != frame.tracks.end() && found->state != fusion::TrackState::coasted;
}

}  // namespace

void HeadController::open(std::unique_ptr<drivers::HeadRunner> runner, const drivers::HeadSetup& setup) {
  const std::lock_guard guard(lock_);
  runner_ = std::move(runner);
  setup_ = setup;
  limits_wait_ = false;
  law_.reset();
  selector_.reset();
  selector_.follow(0);
  history_.clear();
  dead_time_.reset();
  pan_speeds_.reset(setup.pan_speeds, setup.limits.pan.speed);
  tilt_speeds_.reset(setup.tilt_speeds, setup.limits.tilt.speed);
  base_yaw_.reset();
  taken_.reset();
  zoom_.begin(setup.moves_zoom ? setup.zoom_table : motion::ZoomTable{});
  base_request_.end();
  base_asked_ = 0;
  watchdog_.rest();
  manual_ = {};
  faulty_ = silent_ = ended_ = homing_ = sees_turns_ = false;
  simulated_ = runner_->simulated();
  halted_ = fresh_ = true;
  latest_ = epoch_ = published_ = Time::zero();
  newest_.reset();
  late_since_ = motion::kNever;
  zoom_reported_ = gyro_reported_ = false;
  Pose start;
  start.pan.position = setup.pan;
  start.tilt.position = setup.tilt;
  history_.add(start);
  correction_.reset(start, setup.latency);
  status_ = {};
}

void HeadController::on_refusal(DeferredNotifications& out) {
  const std::lock_guard guard(lock_);
  if (runner_) report_refusal(latest_, out);
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
  selector_.set_options(fuser);
  timeout_ = watchdog;
  watchdog_.set_timeout(watchdog);
}

std::string HeadController::set_limits(const motion::Limits& limits, std::optional<Time> at) {
  const std::lock_guard guard(lock_);
  if (!runner_ || limits == setup_.limits) return {};
  if (std::string wrong = motion::check(limits); !wrong.empty()) return wrong;
  setup_.limits = limits;
  confine_law();
  limits_wait_ = halted_;
  if (!halted_) runner_->limit(earliest(at), correction_.limits(limits));
  return {};
}

void HeadController::set_manual_timeout(Time timeout) {
  const std::lock_guard guard(lock_);
  manual_timeout_ = timeout;
}

void HeadController::set_clock_driven(bool on) {
  const std::lock_guard guard(lock_);
  clock_driven_ = on;
}

void HeadController::forget() {
  const std::lock_guard guard(lock_);
  newest_.reset();
  fresh_ = true;
  latest_ = std::max(latest_, published_);  // published poses stay valid
  law_.reset();
  base_yaw_.reset();
  selector_.reset();
  ended_ = false;
}

// Converts running time to the head's time, which does not go back when running time does (a flush, another base time).
HeadController::Time HeadController::head_time(Time running) {
  constexpr Time kJitter = milliseconds(100);
  if (running + epoch_ + kJitter < latest_) epoch_ = latest_ - running;
  latest_ = std::max(latest_, running + epoch_);
  return latest_;
}

// Returns the earliest time for a new command, in the head's time: published poses stay valid.
HeadController::Time HeadController::earliest(std::optional<Time> at) {
  latest_ = at && clock_driven_ ? head_time(*at) : std::max(latest_, published_ - setup_.latency);
  return latest_;
}

void HeadController::confine_law() {
  control::LawOptions options = law_.options();
  options.limits = correction_.narrowed(setup_.limits);
  law_.set_options(options);
}

Pose HeadController::running(Pose pose) const {
  pose.from = std::max(Time::zero(), pose.from - epoch_);
  if (pose.until != motion::kNever) pose.until = std::max(pose.from, pose.until - epoch_);
  return pose;
}

// By how much the head is later there than the driver's pose of that time says. What it reports has a time of its own, of
// the report, whatever it makes of commands.
HeadController::Time HeadController::late_of(const Pose& pose) const {
  return pose.measured ? Time::zero() : dead_time_.late();
}

// The driver's own pose when the head was there.
Pose HeadController::driver_pose(Time taken) const {
  return correction_.driver_pose(taken - late_of(correction_.driver_pose(taken)));
}

// Shifts the driver's poses by their correction and by what was learnt of the dead time.
void HeadController::remember(std::vector<Pose>& poses) {
  if (poses.empty()) return;
  const Time late = late_of(poses.front());
  for (Pose& pose : poses) {
    correction_.add(pose);
    pose.from += late;
    if (pose.until != motion::kNever) pose.until += late;
    history_.add(pose);
  }
}

// When a command that is given at `now` takes effect, as told and as learnt.
HeadController::Time HeadController::effect_of(Time now) const {
  return now + setup_.latency + dead_time_.late();
}

std::optional<Turn> HeadController::picture_turn(const Frame& frame) const {
  if (!frame.motion || simulated_) return std::nullopt;  // the poses of a simulated head need no picture
  return head_turn(*frame.motion, frame.lens, correction_.position().value_or(motion::PanTilt{}));
}

// Returns the command of the manual override, given at `now`.
HeadCommand HeadController::manual_at(Time now) const {
  HeadCommand command = manual_.command();
  command.time = now;
  return command;
}

// Gives the driver a command in its own, uncorrected angles.
void HeadController::order(drivers::HeadCommand command) {
  correction_.to_driver(command);
  runner_->command(command);
}

void HeadController::learn_speeds(Time before, Time taken) {
  const std::optional<Turn>& seen = correction_.seen();
  const Pose from = correction_.driver_pose(before), to = correction_.driver_pose(taken);
  if (!seen || !to.by_speeds || !dead_time_.agrees()) return;
  const double dt = motion::seconds(taken - before);
  const auto learn = [dt](SpeedTable& table, const motion::AxisState& first, const motion::AxisState& last,
                          double turn) {
    if (first.speed == last.speed) table.add(dt, last.speed, turn / dt);
    return table.changed();
  };
  const bool pan = learn(pan_speeds_, from.pan, to.pan, seen->yaw);
  const bool tilt = learn(tilt_speeds_, from.tilt, to.tilt, seen->pitch);
  if (pan || tilt) runner_->learn(pan_speeds_.map(), tilt_speeds_.map());
}

// Corrects the pose of a head that reports none by the turn of the picture, and looks for a lost reference.
void HeadController::correct(const Frame& frame, Time now, DeferredNotifications& out) {
  if (frame.repeats) return;
  // Where nothing measures the picture, the reckoning is all that there is, and the reference no more lost than at first.
  sees_turns_ = sees_turns_ || (frame.motion && frame.lens.known());
  const auto is_lost = [this] { return sees_turns_ && correction_.lost(); };
  const bool lost = is_lost();
  const Time taken = frame.running + epoch_;
  const auto turn = picture_turn(frame);
  if (turn && taken_ && correction_.position())
    dead_time_.add(*taken_, taken, turn->yaw, correction_.reckoned(), setup_.latency);
  const auto before = std::exchange(taken_, taken);
  correction_.set_dead_time(setup_.latency + dead_time_.late());
  const Time late = late_of(correction_.driver_pose(taken));
  const bool base_known = frame.motion && base_is_known(*frame.motion);
  if (correction_.on_frame(taken - late, history_.at(effect_of(now)), turn, setup_.limits, base_known)) {
    confine_law();
    runner_->limit(now, correction_.limits(setup_.limits));
  }
  if (before) learn_speeds(*before - late, taken - late);
  if (correction_.ambiguous() && !std::exchange(gyro_reported_, true)) out.add(MissingGyro{});
  homing_ = homing_ && is_lost() && now - home_tried_ < kHomePatience;
  if (!is_lost() || (lost && now - home_tried_ < kHomePatience)) return;
  home_tried_ = now;
  homing_ = true;
  law_.reset();
  runner_->home(now);
  ask_base(0, now, out);
  report(HeadState::homing, "its pose is too uncertain: it looks for its reference", now, out);
}

double HeadController::field_of_view(Time running, double otherwise) const {
  const std::lock_guard guard(lock_);
  const double seen = runner_ ? history_.at(running + epoch_).field_of_view : 0;
  return seen > 0 ? seen : otherwise;
}

// Publishes the pieces from `published_` on, the last one cut at `until` (kNever: only the first, as it is).
void HeadController::publish(const std::vector<Pose>& poses, Time until, DeferredNotifications& out) {
  if (poses.empty()) return;
  if (std::isnan(poses.front().field_of_view) && !std::exchange(zoom_reported_, true)) out.add(UnknownZoom{});
  if (until == motion::kNever) {
    out.add(running(poses.front()));
    return;
  }
  for (Pose pose : poses) {
    pose.until = std::max(pose.from, std::min(pose.until, until));
    out.add(running(pose));
    published_ = pose.until;
    if (pose.until >= until) break;
  }
}

void HeadController::report(HeadState state, std::string reason, Time head, DeferredNotifications& out) {
  const bool waits = manual_.waits_for_order();
  if (state == status_.state && reason == status_.reason && waits == status_.waits_for_order) return;
  status_ = {state, std::move(reason), waits, running(history_.at(head)),
             std::max(Time::zero(), head - epoch_)};
  out.add(status_);
}

void HeadController::report_manual(Time head, DeferredNotifications& out) {
  if (!manual_.active() || halted_) return;
  if (manual_.authority() == Authority::emergency_stop)
    report(HeadState::stopped, manual_.reason(), head, out);
  else if (!faulty_)
    report(HeadState::manual, manual_.reason(), head, out);
}

// Takes over what the driver reports of its emergency stop.
void HeadController::watch_emergency(Time head, DeferredNotifications& out) {
  if (!runner_ || runner_->emergency() == (manual_.authority() == Authority::emergency_stop)) return;
  manual_.emergency(manual_.authority() != Authority::emergency_stop);
  law_.reset();
  ask_base(0, head, out);
  // A command that the head obeys ends its fault.
  if (manual_.authority() == Authority::manual && clock_driven_ && !halted_) order({head, {}, {}});
  report_manual(head, out);
}

void HeadController::watch_reports() {
  if (!runner_ || !runner_->parted()) return;
  homing_ = false;
  law_.reset();
  manual_.wait("its reports contradicted its commands: it waits for an order");
}

// What the head did not obey is not obeyed later: it may look elsewhere by then.
void HeadController::report_fault(const std::string& failure, bool ends_order, Time head,
                                  DeferredNotifications& out) {
  if (failure.empty()) return;
  const bool known = std::exchange(faulty_, true);
  if (!known) law_.reset();
  if (ends_order) manual_.expire(kOrderEnded);
  const bool ended = manual_.active() && manual_.reason() == kOrderEnded;
  report(HeadState::fault, ended ? failure + " (the manual command ended)" : failure, head, out);
  if (!known) out.add(Fault{failure});
}

// Reports a head that cannot be opened, which is an error and not a fault.
void HeadController::report_refusal(Time head, DeferredNotifications& out) {
  std::string why = runner_->refusal();
  if (why.empty()) return;
  faulty_ = true;
  report(HeadState::fault, why, head, out);
  out.add(Refusal{std::move(why)});
}

// Updates the fault state of the head after an answer of the driver.
void HeadController::check(const drivers::HeadRunner::Failure& failure, Time head,
                           DeferredNotifications& out) {
  if (!runner_ || !runner_->healthy()) {
    if (runner_) report_refusal(head, out);
    // An order that was given after that is not executed yet, and has a failure of its own.
    const bool of_order = failure.order != 0 && failure.order == manual_.command().order;
    report_fault(failure.what, of_order, head, out);
    return;
  }
  if (std::exchange(faulty_, false)) report_manual(head, out);
}

HeadController::Answer HeadController::announce(Time at, DeferredNotifications& out) {
  std::unique_lock guard(lock_);
  const auto runner = runner_;
  if (!runner) return Answer::failed;
  const Time head = head_time(at);
  const Time from = fresh_ ? head : std::max(head, published_);
  const Time until = clock_driven_ ? motion::kNever : std::max(from, head + setup_.latency);
  // With a clock-driven head this call does not wait long: tick() publishes the rest soon.
  const drivers::HeadRunner::Patience patience = clock_driven_ ? kTickPatience : kFramePatience;
  guard.unlock();
  std::vector<Pose> poses;
  const Answer answer = runner->ask({}, from, from + setup_.latency + kAhead, poses, patience);
  guard.lock();
  if (answer == Answer::interrupted) return answer;
  fresh_ = false;
  // Without an answer of the driver, publishes the last known pose.
  if (answer != Answer::done) poses.assign(1, correction_.driver_pose(from));
  if (answer != Answer::done) poses[0].from = from;
  remember(poses);
  publish(poses, until, out);
  return answer;
}

Moment HeadController::moment_of(const Frame& frame, Time now) {
  const Time taken = frame.repeats.value_or(frame.running) + epoch_;
  const auto estimate = correction_.position();
  Pose capture = frame.capture && !estimate ? *frame.capture : history_.at(taken);
  if (estimate) capture.pan.position = estimate->pan;
  if (estimate) capture.tilt.position = estimate->tilt;
  const double reported = frame.motion ? frame.motion->base_yaw : 0;
  const double reckoned = driver_pose(taken).pan.position;
  base_yaw_.on_frame(taken, reported, picture_turn(frame),
                     {capture.pan.position, reckoned, motion::seconds(setup_.latency)});
  const Time effect = effect_of(now);
  const Time blind =
      frame.repeats ? std::max(Time::zero(), frame.running - *frame.repeats - kLongestBlind) : Time::zero();
  Moment moment{capture,
                history_.at(effect),
                {motion::seconds(taken), motion::seconds(effect), motion::seconds(blind)},
                base_yaw_.at(effect - blind)};
  if (frame.picture.width > 0 && frame.lens.known())
    moment.view = 2 * std::atan(frame.picture.width / 2. / frame.lens.focal_length());
  moment.dead_time = motion::seconds(effect - now);
  return moment;
}

void HeadController::ask_base(double yaw_rate, Time now, DeferredNotifications& out) {
  if (yaw_rate == 0) base_request_.end();
  if (yaw_rate == 0 && base_asked_ == 0) return;
  if (yaw_rate != 0 && base_asked_ != 0 && now - base_asked_at_ < kAskAgain) return;
  base_asked_ = yaw_rate;
  base_asked_at_ = now;
  out.add(BaseTurnRequest{yaw_rate});
}

HeadCommand HeadController::decide(const Frame& frame, Time now, DeferredNotifications& out) {
  HeadCommand command{now, {}, {}};
  if (halted_) return command;
  if (manual_.active()) {
    manual_.lapse(now);
    report_manual(now, out);
    ask_base(0, now, out);
    return manual_at(now);
  }
  const Moment moment = moment_of(frame, now);
  const TargetSelector::Selection selection =
      selector_.on_frame(*frame.seen, frame.running, moment.capture.pan.position);
  if (selection.lost != 0) out.add(Lost{selection.lost});
  const Command axes = law_.update(selection.goal, frame.lens, moment);
  command.pan = axes.pan;
  command.tilt = axes.tilt;
  command.zoom = zoom_.on_frame(moment.times.taken, selection.goal, frame.seen->tracks, frame.picture,
                                history_.at(frame.repeats.value_or(frame.running) + epoch_).field_of_view);
  const LawOptions& options = law_.options();
  const bool seen =
      axes.target && !faulty_ && moment.times.blind == 0 && is_seen(*frame.seen, selection.goal.track);
  ask_base(
      seen ? base_request_.update(axes.target->pan, axes.target->rate, options.limits.pan, options.base_turn)
           : 0,
      now, out);
  if (!faulty_) report(state_of(axes), axes.round ? kGoesRound : selection.reason, now, out);
  return command;
}

HeadController::Answer HeadController::frame(const Frame& frame, DeferredNotifications& out) {
  std::unique_lock guard(lock_);
  const auto runner = runner_;
  if (!runner) return Answer::failed;
  if (clock_driven_) {
    newest_ = frame.running;
    const Time now = head_time(frame.now);
    watch_reports();
    end_expired_order(now, out);
    if (!frame.seen || halted_) return Answer::done;
    watchdog_.feed(now);
    if (!simulated_) correct(frame, now, out);
    if (homing_ && !manual_.active()) return Answer::done;
    const HeadCommand command = decide(frame, now, out);
    // A head at fault obeys no order, and shows that it works again by obeying a stop.
    if (!manual_.active() || (faulty_ && command.stop)) order(command);
    return Answer::done;
  }

  if (silent_ && !runner->idle()) {  // blocked since an earlier frame: this frame is skipped
    newest_ = frame.running;
    report_fault(kSilent, true, latest_, out);
    return Answer::late;
  }
  // Published poses stay valid: the command takes effect only after them.
  const Time now = std::max(head_time(frame.running), published_ - setup_.latency);
  const Time horizon = now + std::max(setup_.latency, frame.length) + kAhead;
  std::vector<Pose> poses;
  // Time until which at least no frame came: the expected time of the frame before this one, or the end of the gap.
  const Time unseen = frame.seen ? now - frame.length : now + frame.length;
  if (const Time deadline = watchdog_.deadline(); deadline < unseen) {
    const HeadCommand brake{std::max(deadline, published_ - setup_.latency), {}, {}, true};
    latest_ = std::max(latest_, brake.time);
    guard.unlock();
    const Answer answer = runner->ask(brake, brake.time, horizon, poses, kFramePatience);
    guard.lock();
    if (answer == Answer::interrupted) return answer;
    watchdog_.rest();
    remember(poses);
    on_timeout(brake.time, out);
  }
  std::optional<HeadCommand> command;
  if (frame.seen) command = decide(frame, now, out);
  const Time from = published_;
  guard.unlock();
  const Answer answer = runner->ask(command, from, horizon, poses, kFramePatience);
  guard.lock();
  if (answer == Answer::interrupted) return answer;
  newest_ = frame.running;
  if (frame.seen) watchdog_.feed(now);
  silent_ = answer == Answer::late;
  if (silent_) {
    report_fault(kSilent, true, now, out);
    return answer;
  }
  check(runner->failure(), now, out);
  watch_emergency(now, out);
  remember(poses);
  publish(poses, std::max(from, now + std::max(setup_.latency, frame.length)), out);
  return answer;
}

void HeadController::on_decision(const FusionDecision& decision, Time at, DeferredNotifications& out) {
  const std::lock_guard guard(lock_);
  watch_reports();
  // Only frames feed the watchdog: without them no decision moves the head.
  if (!runner_ || !clock_driven_ || halted_ || homing_ || manual_.active() || !watchdog_.alive()) return;
  if (!decision.decided || *decision.decided > at + kEarly || *decision.decided < at - kStale) return;
  const auto selection = selector_.on_decision(decision);
  if (!selection) return;
  const Time now = head_time(at);
  const Time effect = effect_of(now);
  const Pose ahead = history_.at(effect);
  const double then = motion::seconds(effect);
  Moment moment{ahead, ahead, {then, then}, {}};
  moment.dead_time = motion::seconds(effect - now);
  const Command command = law_.update(selection->goal, {}, moment);
  if (!faulty_) report(state_of(command), command.round ? kGoesRound : selection->reason, now, out);
  order({now, command.pan, command.tilt});
}

void HeadController::end_expired_order(Time now, DeferredNotifications& out) {
  if (halted_ || !manual_.lapse(now)) return;
  order(manual_at(now));
  report_manual(now, out);
}

HeadController::Time HeadController::tick(Time at, DeferredNotifications& out) {
  std::unique_lock guard(lock_);
  const auto runner = runner_;
  if (!runner) return at + kAtRest;
  const Time now = head_time(at);
  if (watchdog_.bites(now)) {
    homing_ = false;
    order({now, {}, {}, true});
    on_timeout(now, out);
  }
  end_expired_order(now, out);
  guard.unlock();
  std::vector<Pose> poses;
  const Answer answer = runner->ask({}, now, now + setup_.latency + kAhead, poses, kTickPatience);
  guard.lock();
  if (answer == Answer::late) {
    if (late_since_ == motion::kNever) late_since_ = now;
    if (now - late_since_ > kSilence) {
      const bool waits = manual_.active() && manual_.command().order != 0;
      report_fault(kSilent, true, now, out);
      if (waits) order(manual_at(now));  // in place of the order that the driver has not taken yet
    }
    return at + kWhileMoving;
  }
  if (answer != Answer::interrupted) {
    const drivers::HeadRunner::Failure failure = runner->failure();
    homing_ = homing_ && failure.what.empty();  // a head that cannot find its reference goes on without it
    check(failure, now, out);
  }
  watch_emergency(now, out);
  watch_reports();
  if (poses.empty()) return at + kWhileMoving;
  late_since_ = motion::kNever;
  remember(poses);
  publish(poses, motion::kNever, out);
  const Pose& pose = poses.front();
  Time next = now + (pose.moving() ? kWhileMoving : kAtRest);
  next =
      std::max(now + milliseconds(1), std::min({next, pose.until, watchdog_.deadline(), manual_.deadline()}));
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
  ask_base(0, now, out);
  homing_ = false;
  guard.unlock();
  const Answer answer = runner->stop(now, patience);
  std::vector<Pose> poses;
  if (answer == Answer::done && clock_driven_) runner->ask({}, now, motion::kNever, poses, kTickPatience);
  guard.lock();
  remember(poses);
  for (const Pose& pose : poses)
    out.add(running(pose));  // up to its rest: in PAUSED the driver is not queried again
  if (answer == Answer::late)
    report_fault("the head does not answer: it may not have stopped", true, now, out);
  if (!faulty_) report(HeadState::stopped, reason, now, out);
}

void HeadController::end(std::optional<Time> at, drivers::HeadRunner::Patience patience,
                         DeferredNotifications& out) {
  {
    const std::lock_guard guard(lock_);
    ended_ = true;
    selector_.follow(0);
    manual_.expire("the manual command ended with the stream");
  }
  halt("end of the stream", at, patience, out);
}

// Reports the expiry of the watchdog.
void HeadController::on_timeout(Time head, DeferredNotifications& out) {
  manual_.expire("the manual command ended: no frame came");
  law_.reset();  // what was planned is of a picture that is old
  ask_base(0, head, out);
  report(HeadState::stopped, "no frame came for " + std::to_string(timeout_ / milliseconds(1)) + " ms", head,
         out);
}

void HeadController::resume(std::optional<Time> at, DeferredNotifications& out) {
  const std::lock_guard guard(lock_);
  if (ended_) return;
  halted_ = false;
  if (runner_ && std::exchange(limits_wait_, false))
    runner_->limit(earliest(at), correction_.limits(setup_.limits));
  if (at && clock_driven_) manual_.lapse(head_time(*at));
  if (runner_ && manual_.active() && clock_driven_ && at) order(manual_at(head_time(*at)));
  report_manual(latest_, out);
}

void HeadController::interrupt(bool on) {
  const std::lock_guard guard(lock_);
  if (runner_) runner_->interrupt(on);
}

std::optional<HeadController::Time> HeadController::newest() const {
  const std::lock_guard guard(lock_);
  return newest_;
}

// Sends the application's command to a clock-driven head at once, else with the next frame.
void HeadController::apply_manual(std::optional<Time> at, DeferredNotifications& out) {
  law_.reset();
  const Time now = at && clock_driven_ ? head_time(*at) : latest_;
  ask_base(0, now, out);
  homing_ = false;
  // A driver that does not answer would take the order whenever it answers again.
  if (silent_ || now - late_since_ > kSilence) manual_.expire(kOrderEnded);
  if (clock_driven_ && !halted_) order(manual_at(now));
  if (manual_.authority() == Authority::emergency_stop)
    report_manual(now, out);
  else if (!faulty_)
    report(HeadState::manual, manual_.reason(), now, out);
}

bool HeadController::move(double pan, double tilt, bool relative, std::optional<Time> at,
                          DeferredNotifications& out) {
  const std::lock_guard guard(lock_);
  if (!runner_ || ended_) return false;
  const Time now = at && clock_driven_ ? head_time(*at) : std::max(latest_, published_);
  if (!manual_.move(pan, tilt, relative, history_.at(now), setup_.limits)) return false;
  if (manual_timeout_ > Time::zero()) manual_.expires(now + manual_timeout_);
  apply_manual(at, out);
  return true;
}

bool HeadController::turn(double pan, double tilt, std::optional<Time> at, DeferredNotifications& out) {
  const std::lock_guard guard(lock_);
  if (!runner_ || ended_ || !manual_.turn(pan, tilt)) return false;
  const Time now = at && clock_driven_ ? head_time(*at) : std::max(latest_, published_);
  // A longer time for moves does not lengthen a turn.
  const Time longest(kTurnTimeout);
  manual_.expires(now + (manual_timeout_ > Time::zero() ? std::min(manual_timeout_, longest) : longest));
  apply_manual(at, out);
  return true;
}

bool HeadController::stop(std::optional<Time> at, DeferredNotifications& out) {
  const std::lock_guard guard(lock_);
  if (!runner_) return false;
  manual_.stop();
  apply_manual(at, out);
  return true;
}

// Ends the manual override: decisions drive the head again.
void HeadController::end_manual(const char* reason, std::optional<Time> at, DeferredNotifications& out) {
  if (!manual_.end()) return;
  const Time now = at && clock_driven_ ? head_time(*at) : latest_;
  if (clock_driven_ && !halted_) order({now, {}, {}});
  report(HeadState::holding, reason, now, out);
}

bool HeadController::automatic(std::optional<Time> at, DeferredNotifications& out) {
  const std::lock_guard guard(lock_);
  if (!runner_ || manual_.authority() == Authority::emergency_stop) return false;
  selector_.follow(0);
  end_manual("automatic again", at, out);
  return true;
}

bool HeadController::follow(std::uint32_t id, std::optional<Time> at, DeferredNotifications& out,
                            bool decided) {
  const std::lock_guard guard(lock_);
  if (!runner_ || ended_ || id == 0 || manual_.authority() == Authority::emergency_stop) return false;
  selector_.follow(id, decided);
  law_.reset();  // another target
  end_manual("a track was chosen", at, out);
  return true;
}

}  // namespace cerberus::control
