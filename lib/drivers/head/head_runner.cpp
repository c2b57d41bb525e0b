// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/head/head_runner.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <utility>

namespace cerberus::drivers {

namespace {

constexpr std::size_t kMostPieces = 64;
// A camera acknowledges a stop within a second, and a helper that is killed has stopped its head within half a second.
constexpr auto kLeasePatience = std::chrono::seconds(10);

struct Limiting {
  Time now{};
  motion::Limits limits;
};

struct Learnt {
  motion::SpeedMap pan, tilt;
};

struct Question {
  Time from{}, until{};
};

}  // namespace

// The state shared by owner and worker; the last reference destroys it. `lock` guards the members below it; if there is
// a worker, only the worker uses the head.
struct HeadRunner::Core {
  std::unique_ptr<Head> head;
  bool blocks = true;               // the head has a worker
  std::vector<motion::Pose> found;  // used like the head
  std::optional<Limiting> owed;     // used like the head: limits that it has refused so far
  std::shared_ptr<HeadLease> lease;
  Bell moved, refused;

  mutable std::mutex lock;
  std::condition_variable work, answer;
  struct Batch {
    std::optional<HeadSetup> open;
    std::optional<Limiting> limiting;
    std::optional<Learnt> learnt;
    std::optional<HeadCommand> command;
    std::optional<Time> stop, home;
    std::optional<Question> question;
    bool quit = false;
    // Returns whether the batch may change the head's trajectory.
    bool moves() const { return open || limiting || command || stop || home; }
    bool any() const { return moves() || learnt || question || quit; }
  } todo;
  unsigned long asked = 0, answered = 0;  // tickets
  unsigned interrupts = 0;
  bool ended = false, obeys = true, speaks = true;
  Failure failure;               // not reported yet
  unsigned order = 0;            // of the last command
  std::string unopened;          // used like the head: why it could not be opened
  std::string refusal;           // the same, not reported yet
  bool emergency = false;        // at the last request
  bool parted = false;           // not reported yet
  bool asking = false;           // a call of ask() waits
  bool failed = false;           // the last batch
  bool question_failed = false;  // that of the last question, whose answer is in `poses`
  std::vector<motion::Pose> poses;

  Core(std::function<void()> when_moved, std::function<void()> when_refused)
      : moved(std::move(when_moved)), refused(std::move(when_refused)) {}
  void run();
  void serve(std::unique_lock<std::mutex>& guard);
  unsigned long hand_over(std::unique_lock<std::mutex>& guard);
  std::string open(const HeadSetup& setup);
  std::string carry_out(const Batch& batch);
  void set_command(const HeadCommand& command);
};

// A later hold does not revoke a stop that still waits.
void HeadRunner::Core::set_command(const HeadCommand& command) {
  constexpr motion::AxisCommand kHold;
  const bool holds = command.pan == kHold && command.tilt == kHold;
  const bool keeps_stop = holds && (todo.stop || (todo.command && todo.command->stop));
  todo.stop.reset();
  todo.command = command;
  todo.command->stop = command.stop || keeps_stop;
}

std::string HeadRunner::Core::open(const HeadSetup& setup) {
  if (lease && !lease->wait(blocks ? kLeasePatience : Patience{}))
    return "it is still being stopped for the sink that drove it before: start this one again when it rests";
  return head->open(setup);
}

std::string HeadRunner::Core::carry_out(const Batch& batch) {
  if (batch.open) unopened = open(*batch.open);
  if (!unopened.empty()) return unopened;
  if (batch.stop) head->stop(*batch.stop);
  std::string failed;
  if (batch.open) owed.reset();
  if (batch.learnt) head->learn(batch.learnt->pan, batch.learnt->tilt);
  if (batch.limiting) owed = batch.limiting;
  if (owed && (batch.limiting || batch.command)) {
    // The limits take the earlier time of both, so that a command older than the limits is not stale.
    const Time now = batch.command ? std::min(owed->now, batch.command->time) : owed->now;
    failed = head->limit(now, owed->limits);
    if (failed.empty())
      owed.reset();
    else
      head->stop(now);
  }
  if (batch.command && failed.empty()) {
    failed = head->command(*batch.command);
    if (!failed.empty()) head->stop(batch.command->time);
  }
  if (batch.home && failed.empty()) failed = head->home(*batch.home);
  if (!batch.question) return failed;
  for (Time at = batch.question->from; found.size() < kMostPieces;) {
    motion::Pose& pose = found.emplace_back();
    if (std::string wrong = head->state(at, pose); !wrong.empty()) {
      found.pop_back();
      return failed.empty() ? wrong : failed;
    }
    if (pose.until <= at || pose.until >= batch.question->until) break;
    at = pose.until;
  }
  return failed;
}

// Executes the pending batch; `guard` holds the lock before and after.
void HeadRunner::Core::serve(std::unique_lock<std::mutex>& guard) {
  const Batch batch = std::exchange(todo, {});
  const unsigned long ticket = asked;
  if (blocks) guard.unlock();
  found.clear();
  std::string wrong = carry_out(batch);
  if (wrong.empty() && batch.question && !batch.moves()) wrong = head->fault();
  const bool pressed = head->emergency();
  const bool has_parted = head->parted();
  if (batch.quit) head->close();
  if (blocks) guard.lock();
  emergency = pressed;
  if (has_parted) {
    parted = true;
    todo.command.reset();
  }
  if (batch.command) order = batch.command->order;
  failed = !wrong.empty();
  if (failed) failure = {wrong, order};
  const bool failed_to_open = failed && batch.open;
  if (failed_to_open) refusal = unopened;
  if (batch.open || batch.limiting || batch.command || batch.home)
    obeys = !failed;
  else if (batch.question)
    speaks = !failed;
  if (batch.question) {
    poses.assign(found.begin(), found.end());
    question_failed = failed;
  }
  answered = ticket;
  if (batch.quit) {
    ended = true;
    lease.reset();
  }
  answer.notify_all();
  if (batch.quit || !batch.moves()) return;
  if (blocks) guard.unlock();
  (failed_to_open ? refused : moved).ring();
  if (blocks) guard.lock();
}

void HeadRunner::Core::run() {
  std::unique_lock guard(lock);
  while (!ended) {
    work.wait(guard, [this] { return todo.any(); });
    serve(guard);
  }
}

// Starts the execution of the pending batch. Returns its ticket.
unsigned long HeadRunner::Core::hand_over(std::unique_lock<std::mutex>& guard) {
  const unsigned long ticket = ++asked;
  if (blocks)
    work.notify_one();
  else
    serve(guard);
  return ticket;
}

HeadRunner::HeadRunner(std::unique_ptr<Head> head, std::shared_ptr<HeadLease> lease,
                       std::function<void()> moved, std::function<void()> refused)
    : core_(std::make_shared<Core>(std::move(moved), std::move(refused))), simulated_(head->simulated()) {
  core_->head = std::move(head);
  core_->lease = std::move(lease);
  core_->found.reserve(kMostPieces);
  core_->poses.reserve(kMostPieces);
  core_->blocks = core_->head->blocks();
  if (core_->blocks) worker_.emplace([core = core_] { core->run(); });
}

HeadRunner::~HeadRunner() {
  core_->moved.silence();
  core_->refused.silence();
  std::unique_lock guard(core_->lock);
  if (core_->lease) core_->lease->announce_return();
  core_->todo = {};
  core_->todo.quit = true;
  core_->hand_over(guard);
  guard.unlock();
  if (worker_) worker_->leave(close_patience_);
}

HeadRunner::Answer HeadRunner::wait(std::unique_lock<std::mutex>& guard, unsigned long ticket,
                                    Patience patience, bool interruptible) {
  const auto over = [&] { return core_->answered >= ticket || (interruptible && core_->interrupts > 0); };
  if (!core_->answer.wait_for(guard, patience, over)) return Answer::late;
  if (core_->answered < ticket) return Answer::interrupted;
  return core_->failed ? Answer::failed : Answer::done;
}

HeadRunner::Answer HeadRunner::open(const HeadSetup& setup, Patience patience) {
  std::unique_lock guard(core_->lock);
  core_->todo.open = setup;
  return wait(guard, core_->hand_over(guard), patience, false);
}

HeadRunner::Answer HeadRunner::stop(Time now, Patience patience) {
  std::unique_lock guard(core_->lock);
  core_->todo.command.reset();
  core_->todo.home.reset();
  core_->todo.stop = now;
  return wait(guard, core_->hand_over(guard), patience, false);
}

void HeadRunner::command(const HeadCommand& command) {
  std::unique_lock guard(core_->lock);
  core_->set_command(command);
  core_->hand_over(guard);
}

void HeadRunner::home(Time now) {
  std::unique_lock guard(core_->lock);
  core_->todo.home = now;
  core_->hand_over(guard);
}

void HeadRunner::limit(Time now, const motion::Limits& limits) {
  std::unique_lock guard(core_->lock);
  core_->todo.limiting = Limiting{now, limits};
  core_->hand_over(guard);
}

void HeadRunner::learn(const motion::SpeedMap& pan, const motion::SpeedMap& tilt) {
  std::unique_lock guard(core_->lock);
  core_->todo.learnt = Learnt{pan, tilt};
  core_->hand_over(guard);
}

HeadRunner::Answer HeadRunner::ask(const std::optional<HeadCommand>& command, Time from, Time until,
                                   std::vector<motion::Pose>& poses, Patience patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  std::unique_lock guard(core_->lock);
  // One call at a time, so that it receives its own answer. An interruption applies to the waiting calls, too.
  if (!core_->answer.wait_until(guard, deadline, [this] { return !core_->asking; })) return Answer::late;
  if (core_->blocks && core_->interrupts > 0) return Answer::interrupted;
  core_->asking = true;
  if (command) core_->set_command(*command);
  core_->todo.question = Question{from, until};
  const Answer answer =
      wait(guard, core_->hand_over(guard), deadline - std::chrono::steady_clock::now(), true);
  core_->asking = false;
  core_->answer.notify_all();
  if (answer != Answer::done && answer != Answer::failed) return answer;
  poses.assign(core_->poses.begin(), core_->poses.end());
  return core_->question_failed ? Answer::failed : Answer::done;
}

void HeadRunner::interrupt(bool on) {
  const std::lock_guard guard(core_->lock);
  if (on)
    ++core_->interrupts;
  else if (core_->interrupts > 0)
    --core_->interrupts;
  core_->answer.notify_all();
}

HeadRunner::Failure HeadRunner::failure() {
  const std::lock_guard guard(core_->lock);
  return std::exchange(core_->failure, {});
}

std::string HeadRunner::refusal() {
  const std::lock_guard guard(core_->lock);
  return std::exchange(core_->refusal, {});
}

bool HeadRunner::healthy() const {
  const std::lock_guard guard(core_->lock);
  return core_->obeys && core_->speaks;
}

bool HeadRunner::emergency() const {
  const std::lock_guard guard(core_->lock);
  return core_->emergency;
}

bool HeadRunner::parted() {
  const std::lock_guard guard(core_->lock);
  return std::exchange(core_->parted, false);
}

bool HeadRunner::idle() const {
  const std::lock_guard guard(core_->lock);
  return core_->answered == core_->asked;
}

}  // namespace cerberus::drivers
