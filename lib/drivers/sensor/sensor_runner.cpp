// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/sensor/sensor_runner.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <utility>

namespace cerberus::drivers {

namespace {

constexpr std::size_t kMost =
    1024;  // largest number of edges that wait to be taken; beyond it the oldest are dropped
constexpr auto kClosePatience = std::chrono::milliseconds(30);
// Interval at which sensors are read without an event: the removal of a device does not always wake a poll on it.
constexpr int kLookMs = 100;

Time now() {
  return std::chrono::steady_clock::now().time_since_epoch();  // CLOCK_MONOTONIC
}

int new_event() {
  return ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
}

struct Leds {
  std::array<sensing::Presence, sensing::kMaxSensors> readings{};
  std::size_t count = 0;
};

}  // namespace

// The state shared by owner and worker; the last reference destroys it. `lock` guards the members below it. Only the
// worker uses `sensor`, or a recording until it is `opened`.
struct SensorRunner::Core {
  std::unique_ptr<Sensor> sensor;
  const int news = new_event();   // readable when the sensors are open, or edges or an error are available
  const int hints = new_event();  // wakes the worker to set LEDs or to end
  Bell refused;

  std::mutex lock;
  std::condition_variable over;
  bool opened = false, quits = false;
  std::optional<Leds> leds;
  std::vector<SensorEdge> edges;
  SensorError error;
  std::vector<std::string> places;
  std::string outage;
  bool measures = false, recorded = false;

  Core(std::unique_ptr<Sensor> taken, std::function<void()> when_refused)
      : sensor(std::move(taken)), refused(std::move(when_refused)) {
    edges.reserve(kMost);
    if (news >= 0 && hints >= 0) return;
    error = {SensorFault::gone, "No file descriptors are left to watch the sensors with.",
             std::strerror(errno)};
    opened = true;
  }
  ~Core() {
    for (const int fd : {news, hints})
      if (fd >= 0) ::close(fd);
  }
  Core(const Core&) = delete;
  Core& operator=(const Core&) = delete;

  void run(const SensorSetup& setup);
  bool open(const SensorSetup& setup);
  void watch(bool good);
  bool publish(const std::vector<SensorEdge>& found, SensorError wrong);
};

// False: nothing more will come.
bool SensorRunner::Core::publish(const std::vector<SensorEdge>& found, SensorError wrong) {
  std::string why = sensor->outage();
  const std::lock_guard guard(lock);
  const bool changed = why != outage;
  outage = std::move(why);
  const std::size_t room = kMost - std::min(found.size(), kMost);
  if (edges.size() > room) edges.erase(edges.begin(), edges.end() - static_cast<std::ptrdiff_t>(room));
  edges.insert(edges.end(), found.begin(), found.end());
  error = std::move(wrong);
  if (!found.empty() || error || changed) ::eventfd_write(news, 1);
  return !error;
}

// False: nothing more will come.
bool SensorRunner::Core::open(const SensorSetup& setup) {
  std::vector<SensorEdge> found;
  SensorError wrong = sensor->open(setup);
  const bool recording = sensor->recorded();
  if (!wrong && !recording) wrong = sensor->read(now(), found);
  const bool good = publish(found, std::move(wrong));
  {
    const std::lock_guard guard(lock);
    for (int i = 0; i < setup.sensors; ++i) places.push_back(sensor->place(i));
    measures = sensor->measures();
    recorded = recording;
    opened = true;
    ::eventfd_write(news, 1);
  }
  over.notify_all();
  if (!good) refused.ring();
  return good;
}

void SensorRunner::Core::watch(bool good) {
  std::vector<SensorEdge> found;
  std::array<pollfd, 2> fds{{{hints, POLLIN, 0}, {sensor->fd(), POLLIN, 0}}};
  for (;;) {
    fds[1].fd = sensor->fd();  // another one after an outage; -1, which poll() skips, during it
    if (::poll(fds.data(), good ? 2 : 1, good ? kLookMs : -1) < 0) continue;  // EINTR
    std::optional<Leds> lit;
    {
      const std::lock_guard guard(lock);
      if (quits) break;
      lit = std::exchange(leds, {});
      eventfd_t ignored = 0;
      ::eventfd_read(hints, &ignored);
    }
    if (!good) continue;
    SensorError wrong;
    found.clear();
    if (lit) wrong = sensor->show(std::span(lit->readings).first(lit->count));
    if (!wrong) wrong = sensor->read(now(), found);
    good = publish(found, std::move(wrong));
  }
  sensor->close();
}

void SensorRunner::Core::run(const SensorSetup& setup) {
  const bool good = open(setup);
  if (!recorded) watch(good);
}

void SensorRunner::begin(std::unique_ptr<Sensor> sensor, const SensorSetup& setup,
                         std::function<void()> refused) {
  close();
  core_ = std::make_shared<Core>(std::move(sensor), std::move(refused));
  if (!core_->opened) worker_.emplace([core = core_, setup] { core->run(setup); });
}

bool SensorRunner::opened(Patience patience) const {
  if (!core_) return true;
  std::unique_lock guard(core_->lock);
  return core_->over.wait_for(guard, patience, [this] { return core_->opened; });
}

SensorError SensorRunner::error() const {
  if (!core_) return {SensorFault::gone, "The sensors are not open.", ""};
  const std::lock_guard guard(core_->lock);
  return core_->error;
}

std::unique_ptr<Sensor> SensorRunner::recording() {
  if (!core_) return nullptr;
  const std::lock_guard guard(core_->lock);
  return core_->opened && core_->recorded && !core_->error ? std::move(core_->sensor) : nullptr;
}

void SensorRunner::close() noexcept {
  if (!core_) return;
  core_->refused.silence();
  {
    const std::lock_guard guard(core_->lock);
    core_->quits = true;
    ::eventfd_write(core_->hints, 1);
  }
  if (worker_) worker_->leave(kClosePatience);
  worker_.reset();
  core_.reset();
}

int SensorRunner::fd() const {
  return core_ ? core_->news : -1;
}

SensorError SensorRunner::read(Time, std::vector<SensorEdge>& edges) {
  if (!core_) return error();
  const std::lock_guard guard(core_->lock);
  eventfd_t ignored = 0;
  ::eventfd_read(core_->news, &ignored);
  edges.insert(edges.end(), core_->edges.begin(), core_->edges.end());
  core_->edges.clear();
  return core_->error;
}

SensorError SensorRunner::show(std::span<const sensing::Presence> readings) {
  if (!core_) return error();
  const std::lock_guard guard(core_->lock);
  Leds& leds = core_->leds.emplace();
  leds.count = std::min(readings.size(), leds.readings.size());
  std::copy_n(readings.begin(), leds.count, leds.readings.begin());
  ::eventfd_write(core_->hints, 1);
  return core_->error;
}

std::string SensorRunner::place(int sensor) const {
  if (!core_) return {};
  const std::lock_guard guard(core_->lock);
  const auto i = static_cast<std::size_t>(sensor);
  return i < core_->places.size() ? core_->places[i] : std::string();
}

bool SensorRunner::measures() const {
  if (!core_) return false;
  const std::lock_guard guard(core_->lock);
  return core_->measures;
}

std::string SensorRunner::outage() const {
  if (!core_) return {};
  const std::lock_guard guard(core_->lock);
  return core_->outage;
}

}  // namespace cerberus::drivers
