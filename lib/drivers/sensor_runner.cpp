// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/sensor_runner.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <utility>

namespace cerberus::drivers {

namespace {

constexpr std::size_t kMost = 1024;  // edges that nobody takes; then the oldest go
constexpr auto kClosePatience = std::chrono::milliseconds(80);

Time now() {
  return std::chrono::steady_clock::now().time_since_epoch();  // CLOCK_MONOTONIC
}

}  // namespace

// Shared by owner and worker; whoever is last destroys it. `lock` guards what is below it, and `sensor` is the worker's.
struct SensorRunner::Core {
  std::unique_ptr<Sensor> sensor;
  const int news = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);  // readable: there are edges, or an error
  const int quits = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);

  std::mutex lock;
  std::condition_variable over;
  bool ended = false;
  std::vector<SensorEdge> edges;
  SensorError error;

  Core() { edges.reserve(kMost); }
  ~Core() {
    for (const int fd : {news, quits})
      if (fd >= 0) ::close(fd);
  }
  Core(const Core&) = delete;
  Core& operator=(const Core&) = delete;

  void run();
  bool hear(const std::vector<SensorEdge>& found, SensorError wrong);
};

// False: nothing more will come.
bool SensorRunner::Core::hear(const std::vector<SensorEdge>& found, SensorError wrong) {
  const std::lock_guard guard(lock);
  const std::size_t room = kMost - std::min(found.size(), kMost);
  if (edges.size() > room) edges.erase(edges.begin(), edges.end() - static_cast<std::ptrdiff_t>(room));
  edges.insert(edges.end(), found.begin(), found.end());
  error = std::move(wrong);
  if (!found.empty() || error) ::eventfd_write(news, 1);
  return !error;
}

void SensorRunner::Core::run() {
  std::vector<SensorEdge> found;
  std::array<pollfd, 2> fds{{{quits, POLLIN, 0}, {sensor->fd(), POLLIN, 0}}};
  for (bool good = true;;) {
    if (::poll(fds.data(), good ? 2 : 1, -1) < 0) continue;  // EINTR
    if (fds[0].revents != 0) break;
    found.clear();
    SensorError wrong = sensor->read(now(), found);
    good = hear(found, std::move(wrong));
  }
  sensor->close();
  const std::lock_guard guard(lock);
  ended = true;
  over.notify_all();
}

SensorError SensorRunner::take(std::unique_ptr<Sensor> sensor, int count) {
  close();
  auto core = std::make_shared<Core>();
  if (core->news < 0 || core->quits < 0)
    return {SensorFault::gone, "No file descriptors are left to watch the sensors with.",
            std::strerror(errno)};
  if (SensorError error = sensor->read(now(), core->edges)) return error;
  for (int i = 0; i < count; ++i) places_.push_back(sensor->place(i));
  measures_ = sensor->measures();
  core->sensor = std::move(sensor);
  ::eventfd_write(core->news, 1);
  core_ = std::move(core);
  worker_ = std::thread([shared = core_] { shared->run(); });
  return {};
}

void SensorRunner::close() noexcept {
  if (!core_) return;
  std::unique_lock guard(core_->lock);
  ::eventfd_write(core_->quits, 1);
  const bool ended = core_->over.wait_for(guard, kClosePatience, [this] { return core_->ended; });
  guard.unlock();
  if (ended)
    worker_.join();
  else
    worker_.detach();
  core_.reset();
  places_.clear();
}

int SensorRunner::fd() const {
  return core_ ? core_->news : -1;
}

SensorError SensorRunner::read(Time, std::vector<SensorEdge>& edges) {
  if (!core_) return {SensorFault::gone, "The sensors are not open.", ""};
  const std::lock_guard guard(core_->lock);
  eventfd_t ignored = 0;
  ::eventfd_read(core_->news, &ignored);
  edges.insert(edges.end(), core_->edges.begin(), core_->edges.end());
  core_->edges.clear();
  return core_->error;
}

}  // namespace cerberus::drivers
