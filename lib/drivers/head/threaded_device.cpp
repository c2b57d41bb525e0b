// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/head/threaded_device.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <utility>

namespace cerberus::drivers {
namespace {

constexpr int kStop = 1, kLeave = 2, kRelease = 3;  // the strengths of a stop
constexpr std::size_t kMostSpeeds = 64;             // changes that are kept for a receiver that is late
constexpr std::chrono::milliseconds kMoment{100};   // for a device that is not in a call to end

struct Move {
  motion::AxisCommand pan, tilt;
};

struct Batch {
  std::optional<HeadSetup> open;
  std::optional<motion::Limits> limits;
  int stop = 0;
  std::optional<Move> move;
  std::optional<double> zoom;
  bool home = false, tick = false, quit = false;
  bool any() const { return open || limits || stop != 0 || move || zoom || home || tick || quit; }
};

// What the device said after its last call.
struct Report {
  std::string wrong;  // of open()
  HeadAbilities abilities;
  bool busy = false, stopping = false, emergency = false;
  std::string fault;
  Time next = motion::kNever;
};

// What is still to be taken.
struct News {
  std::optional<PoseLine> pose;
  std::deque<std::pair<SpeedsLine, Time>> speeds;  // each with the time from which its age counts
  std::optional<double> zoom;
  std::optional<HomedLine> homed;
};

}  // namespace

// The state that both threads share. `lock` guards what is below it; the device is the worker's.
struct ThreadedDevice::Core {
  std::unique_ptr<HeadDevice> device;
  int wake = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);

  std::mutex lock;
  std::condition_variable work, done;
  Batch todo;
  Time now{};    // the newest time that was passed
  Time since{};  // begin of the call that the device is in
  bool in_call = false;
  bool stops = false;  // and that call stops it
  bool hangs = false;
  Report report;
  News news;

  ~Core() {
    if (wake >= 0) ::close(wake);
  }
  bool idle() const { return !in_call && !todo.any(); }
  void run();
  Report carry_out(const Batch& batch, Time at, News& came);
};

Report ThreadedDevice::Core::carry_out(const Batch& batch, Time at, News& came) {
  Report said;
  if (batch.open) said.wrong = device->open(*batch.open, at);
  if (batch.limits) device->limit(*batch.limits, at);
  if (batch.stop == kStop) device->stop(at);
  if (batch.stop == kLeave) device->leave(at);
  if (batch.stop == kRelease) device->release(at);
  if (batch.move) device->move(batch.move->pan, batch.move->tilt, at);
  if (batch.home) device->home(at);
  if (batch.zoom) device->zoom(*batch.zoom, at);
  if (!said.wrong.empty()) return said;
  said.next = device->tick(at);
  said.abilities = device->abilities();
  said.busy = device->busy();
  said.stopping = device->stopping();
  said.emergency = device->emergency();
  said.fault = device->fault();
  came.pose = device->take_pose(at);
  while (const auto speeds = device->take_speeds(at)) came.speeds.emplace_back(*speeds, at);
  came.zoom = device->take_zoom();
  came.homed = device->take_homed(at);
  return said;
}

void ThreadedDevice::Core::run() {
  std::unique_lock guard(lock);
  for (;;) {
    work.wait(guard, [this] { return todo.any(); });
    const Batch batch = std::exchange(todo, {});
    if (batch.quit) return;
    const Time at = now;
    since = at;
    in_call = true;
    stops = batch.stop != 0;
    guard.unlock();
    News came;
    Report said = carry_out(batch, at, came);
    guard.lock();
    in_call = stops = false;
    report = std::move(said);
    hangs = hangs && !idle();
    if (came.pose) news.pose = came.pose;
    for (auto& speeds : came.speeds) news.speeds.push_back(std::move(speeds));
    while (news.speeds.size() > kMostSpeeds) news.speeds.pop_front();
    if (came.zoom) news.zoom = came.zoom;
    if (came.homed) news.homed = came.homed;
    done.notify_all();
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(wake, &one, sizeof one);
  }
}

ThreadedDevice::ThreadedDevice(std::unique_ptr<HeadDevice> device, std::string name, Patience patience)
    : core_(std::make_shared<Core>()), name_(std::move(name)), patience_(patience) {
  core_->device = std::move(device);
  worker_.emplace([core = core_] { core->run(); });
}

ThreadedDevice::~ThreadedDevice() {
  {
    const std::lock_guard guard(core_->lock);
    core_->todo = {};
    core_->todo.quit = true;
    core_->work.notify_one();
  }
  worker_->leave(kMoment);
}

std::string ThreadedDevice::check() const {
  return core_->device->check();  // before open(), when the worker does not use it
}

std::string ThreadedDevice::open(const HeadSetup& setup, Time now) {
  std::unique_lock guard(core_->lock);
  core_->todo.open = setup;
  core_->now = now;
  core_->work.notify_one();
  if (!core_->done.wait_for(guard, patience_, [this] { return core_->idle(); }))
    return name_ + " does not answer: check its cable, and what else uses it";
  return core_->report.wrong;
}

HeadAbilities ThreadedDevice::abilities() const {
  const std::lock_guard guard(core_->lock);
  return core_->report.abilities;
}

void ThreadedDevice::move(const motion::AxisCommand& pan, const motion::AxisCommand& tilt, Time now) {
  const std::lock_guard guard(core_->lock);
  core_->now = now;
  core_->todo.move = Move{pan, tilt};
  core_->todo.home = false;
  core_->work.notify_one();
}

void ThreadedDevice::limit(const motion::Limits& limits, Time now) {
  const std::lock_guard guard(core_->lock);
  core_->now = now;
  core_->todo.limits = limits;
  core_->work.notify_one();
}

void ThreadedDevice::post_stop(int strength, Time now) noexcept {
  const std::lock_guard guard(core_->lock);
  core_->now = now;
  core_->todo.stop = std::max(core_->todo.stop, strength);
  core_->todo.move.reset();
  core_->todo.zoom.reset();
  core_->todo.home = false;
  core_->work.notify_one();
}

void ThreadedDevice::stop(Time now) noexcept {
  post_stop(kStop, now);
}

void ThreadedDevice::leave(Time now) noexcept {
  post_stop(kLeave, now);
}

void ThreadedDevice::release(Time now) noexcept {
  post_stop(kRelease, now);
}

void ThreadedDevice::home(Time now) {
  const std::lock_guard guard(core_->lock);
  core_->now = now;
  core_->todo.home = true;
  core_->todo.move.reset();
  core_->work.notify_one();
}

void ThreadedDevice::zoom(double position, Time now) {
  const std::lock_guard guard(core_->lock);
  core_->now = now;
  core_->todo.zoom = position;
  core_->work.notify_one();
}

bool ThreadedDevice::idle() const {
  const std::lock_guard guard(core_->lock);
  return core_->idle();
}

bool ThreadedDevice::busy() const {
  const std::lock_guard guard(core_->lock);
  return core_->report.busy;
}

bool ThreadedDevice::stopping() const {
  const std::lock_guard guard(core_->lock);
  return core_->todo.stop != 0 || core_->stops || core_->report.stopping;
}

void ThreadedDevice::watch(std::vector<pollfd>& fds) const {
  fds.push_back({core_->wake, POLLIN, 0});
}

Time ThreadedDevice::tick(Time now) {
  std::uint64_t count;
  [[maybe_unused]] const ssize_t drained = ::read(core_->wake, &count, sizeof count);
  const std::lock_guard guard(core_->lock);
  core_->now = now;
  if (core_->in_call) {  // the worker wakes the loop at its end
    core_->hangs = core_->hangs || now - core_->since >= kHangs;
    return core_->hangs ? motion::kNever : core_->since + kHangs;
  }
  if (core_->todo.any()) return now + kHangs;
  if (now < core_->report.next) return core_->report.next;
  core_->todo.tick = true;
  core_->work.notify_one();
  return now + kHangs;
}

std::optional<PoseLine> ThreadedDevice::take_pose(Time) {
  const std::lock_guard guard(core_->lock);
  return std::exchange(core_->news.pose, std::nullopt);
}

bool ThreadedDevice::emergency() const {
  const std::lock_guard guard(core_->lock);
  return core_->report.emergency;
}

std::optional<SpeedsLine> ThreadedDevice::take_speeds(Time now) {
  const std::lock_guard guard(core_->lock);
  if (core_->news.speeds.empty()) return std::nullopt;
  auto [speeds, at] = core_->news.speeds.front();
  core_->news.speeds.pop_front();
  speeds.age += std::max(0.0, motion::seconds(now - at));
  return speeds;
}

std::optional<double> ThreadedDevice::take_zoom() {
  const std::lock_guard guard(core_->lock);
  return std::exchange(core_->news.zoom, std::nullopt);
}

std::optional<HomedLine> ThreadedDevice::take_homed(Time) {
  const std::lock_guard guard(core_->lock);
  return std::exchange(core_->news.homed, std::nullopt);
}

std::string ThreadedDevice::fault() const {
  const std::lock_guard guard(core_->lock);
  return core_->hangs ? name_ + " does not answer: check its cable, and what else uses it"
                      : core_->report.fault;
}

}  // namespace cerberus::drivers
