// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/head/head_lease.h"

#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>

namespace cerberus::drivers {

namespace {

// The leases of each name in the order in which they were taken; only the first may drive. This is the only state that
// the elements of a process share. Never destroyed: a driver that blocks may return its lease while the process ends.
struct Taken {
  std::mutex lock;
  std::condition_variable returned;
  std::map<std::string, std::deque<const HeadLease*>> names;
};
Taken& taken() {
  static Taken& instance = *new Taken;
  return instance;
}

}  // namespace

std::shared_ptr<HeadLease> HeadLease::take(const std::string& name) {
  const std::lock_guard guard(taken().lock);
  auto& leases = taken().names[name];
  if (!leases.empty() && !leases.back()->returns_) return nullptr;
  const std::shared_ptr<HeadLease> lease(new HeadLease(name));
  leases.push_back(lease.get());
  return lease;
}

HeadLease::~HeadLease() {
  {
    const std::lock_guard guard(taken().lock);
    const auto leases = taken().names.find(name_);
    std::erase(leases->second, this);
    if (leases->second.empty()) taken().names.erase(leases);
  }
  taken().returned.notify_all();
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
  const auto first = [&] { return taken().names.find(name_)->second.front() == this; };
  taken().returned.wait_for(guard, patience, [&] { return returns_ || first(); });
  return !returns_ && first();
}

}  // namespace cerberus::drivers
