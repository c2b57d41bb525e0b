// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/head_runner.h"

#include <condition_variable>
#include <mutex>
#include <utility>

namespace cerberus::drivers {

namespace {

constexpr std::size_t kMostPieces = 64;

struct Question {
  Time from{}, until{};
};

}  // namespace

// Shared by owner and worker; whoever is last destroys it. Locks: `lock` guards everything but the head (the worker's own)
// and `notify` (`notify_lock`); the two locks are never held together.
struct HeadRunner::Core {
  std::unique_ptr<Head> head;  // worker only
  std::shared_ptr<void> lease;
  std::mutex notify_lock;
  std::function<void()> notify;

  mutable std::mutex lock;
  std::condition_variable work, answer;
  struct Batch {
    std::optional<HeadSetup> open;
    std::optional<HeadCommand> command;
    std::optional<Time> stop;
    std::optional<Question> question;
    bool quit = false;
    bool any() const { return open || command || stop || question || quit; }
  } todo;
  unsigned long asked = 0, answered = 0;  // tickets
  bool interrupted = false, ended = false, obeys = true, speaks = true;
  std::string failure, last_failure;  // not yet told; of the last batch
  std::vector<control::Pose> poses;   // of the last question

  void run();
  std::string carry_out(const Batch& batch, std::vector<control::Pose>& found);
};

std::string HeadRunner::Core::carry_out(const Batch& batch, std::vector<control::Pose>& found) {
  if (batch.open)
    if (std::string wrong = head->open(*batch.open); !wrong.empty()) return wrong;
  if (batch.stop) head->stop(*batch.stop);
  std::string failed;
  if (batch.command) {
    failed = head->command(*batch.command);
    if (!failed.empty()) head->stop(batch.command->time);
  }
  if (!batch.question) return failed;
  for (Time at = batch.question->from; found.size() < kMostPieces;) {
    control::Pose& pose = found.emplace_back();
    if (std::string wrong = head->state(at, pose); !wrong.empty()) {
      found.pop_back();
      return failed.empty() ? wrong : failed;
    }
    if (pose.until <= at || pose.until >= batch.question->until) break;
    at = pose.until;
  }
  return failed;
}

void HeadRunner::Core::run() {
  std::vector<control::Pose> found;
  found.reserve(kMostPieces);
  std::unique_lock guard(lock);
  for (;;) {
    work.wait(guard, [this] { return todo.any(); });
    const Batch batch = std::exchange(todo, {});
    const unsigned long ticket = asked;
    guard.unlock();
    found.clear();
    const std::string failed = carry_out(batch, found);
    if (batch.quit) head->close();
    guard.lock();
    last_failure = failed;
    if (!failed.empty()) failure = failed;
    if (batch.open || batch.command)
      obeys = failed.empty();
    else if (batch.question)
      speaks = failed.empty();
    if (batch.question) poses.assign(found.begin(), found.end());
    answered = ticket;
    if (batch.quit) {
      ended = true;
      lease.reset();
      answer.notify_all();
      return;
    }
    answer.notify_all();
    if (!batch.open && !batch.command && !batch.stop) continue;
    guard.unlock();
    {
      const std::lock_guard quiet(notify_lock);
      if (notify) notify();
    }
    guard.lock();
  }
}

HeadRunner::HeadRunner(std::unique_ptr<Head> head, std::shared_ptr<void> lease, std::function<void()> notify)
    : core_(std::make_shared<Core>()), simulated_(head->simulated()) {
  core_->head = std::move(head);
  core_->lease = std::move(lease);
  core_->notify = std::move(notify);
  core_->poses.reserve(kMostPieces);
  worker_ = std::thread([core = core_] { core->run(); });
}

HeadRunner::~HeadRunner() {
  {
    const std::lock_guard quiet(core_->notify_lock);
    core_->notify = nullptr;
  }
  std::unique_lock guard(core_->lock);
  core_->todo = {};
  core_->todo.quit = true;
  ++core_->asked;
  core_->work.notify_one();
  const bool ended = core_->answer.wait_for(guard, close_patience_, [this] { return core_->ended; });
  guard.unlock();
  if (ended)
    worker_.join();
  else
    worker_.detach();
}

HeadRunner::Answer HeadRunner::wait(unsigned long ticket, Patience patience, bool interruptible) {
  std::unique_lock guard(core_->lock);
  const auto over = [&] { return core_->answered >= ticket || (interruptible && core_->interrupted); };
  if (!core_->answer.wait_for(guard, patience, over)) return Answer::late;
  if (core_->answered < ticket) return Answer::interrupted;
  return core_->last_failure.empty() ? Answer::done : Answer::failed;
}

HeadRunner::Answer HeadRunner::open(const HeadSetup& setup, Patience patience) {
  unsigned long ticket;
  {
    const std::lock_guard guard(core_->lock);
    core_->todo.open = setup;
    ticket = ++core_->asked;
    core_->work.notify_one();
  }
  return wait(ticket, patience, false);
}

HeadRunner::Answer HeadRunner::stop(Time now, Patience patience) {
  unsigned long ticket;
  {
    const std::lock_guard guard(core_->lock);
    core_->todo.command.reset();
    core_->todo.stop = now;
    ticket = ++core_->asked;
    core_->work.notify_one();
  }
  return wait(ticket, patience, false);
}

void HeadRunner::command(const HeadCommand& command) {
  const std::lock_guard guard(core_->lock);
  core_->todo.stop.reset();
  core_->todo.command = command;
  ++core_->asked;
  core_->work.notify_one();
}

HeadRunner::Answer HeadRunner::ask(const std::optional<HeadCommand>& command, Time from, Time until,
                                   std::vector<control::Pose>& poses, Patience patience) {
  unsigned long ticket;
  {
    const std::lock_guard guard(core_->lock);
    if (core_->interrupted) return Answer::interrupted;
    if (command) {
      core_->todo.stop.reset();
      core_->todo.command = command;
    }
    core_->todo.question = Question{from, until};
    ticket = ++core_->asked;
    core_->work.notify_one();
  }
  const Answer answer = wait(ticket, patience, true);
  if (answer != Answer::done && answer != Answer::failed) return answer;
  const std::lock_guard guard(core_->lock);
  poses.assign(core_->poses.begin(), core_->poses.end());
  return answer;
}

void HeadRunner::interrupt(bool on) {
  const std::lock_guard guard(core_->lock);
  core_->interrupted = on;
  core_->answer.notify_all();
}

std::string HeadRunner::failure() {
  const std::lock_guard guard(core_->lock);
  return std::exchange(core_->failure, {});
}

bool HeadRunner::healthy() const {
  const std::lock_guard guard(core_->lock);
  return core_->obeys && core_->speaks;
}

bool HeadRunner::idle() const {
  const std::lock_guard guard(core_->lock);
  return core_->answered == core_->asked;
}

}  // namespace cerberus::drivers
