// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/head/head_lease.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>

namespace cerberus::drivers {

namespace {

// The leases of each name and device in the order in which they were taken; only one that is the first of both may drive.
// This is the only state that the elements of a process share. Never destroyed: a driver that blocks may return its lease
// while the process ends.
struct Taken {
  std::mutex lock;
  std::condition_variable returned;
  std::map<std::string, std::deque<const HeadLease*>> heads;
};
Taken& taken() {
  static Taken& instance = *new Taken;
  return instance;
}

}  // namespace

std::shared_ptr<HeadLease> HeadLease::take(const std::string& name, const std::string& device) {
  const std::lock_guard guard(taken().lock);
  const std::shared_ptr<HeadLease> lease(new HeadLease);
  lease->keys_.push_back("name " + name);
  if (!device.empty()) lease->keys_.push_back("device " + device);
  for (const std::string& key : lease->keys_) {
    const auto leases = taken().heads.find(key);
    if (leases == taken().heads.end() || leases->second.back()->returns_) continue;
    lease->keys_.clear();
    return nullptr;
  }
  for (const std::string& key : lease->keys_) taken().heads[key].push_back(lease.get());
  return lease;
}

bool HeadLease::is_taken(const std::string& name) {
  const std::lock_guard guard(taken().lock);
  const auto leases = taken().heads.find("name " + name);
  return leases != taken().heads.end() && !leases->second.back()->returns_;
}

HeadLease::~HeadLease() {
  if (keys_.empty()) return;
  {
    const std::lock_guard guard(taken().lock);
    for (const std::string& key : keys_) {
      const auto leases = taken().heads.find(key);
      std::erase(leases->second, this);
      if (leases->second.empty()) taken().heads.erase(leases);
    }
  }
  taken().returned.notify_all();
}

bool HeadLease::is_first() const {
  return std::ranges::all_of(
      keys_, [this](const std::string& key) { return taken().heads.find(key)->second.front() == this; });
}

void HeadLease::announce_return() {
  {
    const std::lock_guard guard(taken().lock);
    returns_ = true;
  }
  taken().returned.notify_all();
}

bool HeadLease::wait(std::chrono::steady_clock::duration patience) const {
  std::unique_lock guard(taken().lock);
  taken().returned.wait_for(guard, patience, [&] { return returns_ || is_first(); });
  return !returns_ && is_first();
}

}  // namespace cerberus::drivers
