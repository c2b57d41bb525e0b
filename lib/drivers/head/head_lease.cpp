// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/head/head_lease.h"

#include <condition_variable>
#include <map>
#include <mutex>

namespace cerberus::drivers {

namespace {

struct Holder {
  const void* lease = nullptr;
  bool returns = false;
};

// The names in use, the only state that the elements of a process share. Never destroyed: a driver that blocks may
// return its lease while the process ends.
struct Taken {
  std::mutex lock;
  std::condition_variable returned;
  std::map<std::string, Holder> names;
};
Taken& taken() {
  static Taken& instance = *new Taken;
  return instance;
}

struct Lease {
  std::string name;
  explicit Lease(const std::string& n) : name(n) {}
  ~Lease() {
    {
      const std::lock_guard guard(taken().lock);
      taken().names.erase(name);
    }
    taken().returned.notify_all();
  }
};

}  // namespace

std::shared_ptr<void> lease_head(const std::string& name, std::chrono::milliseconds patience) {
  Taken& all = taken();
  std::unique_lock guard(all.lock);
  const auto until = std::chrono::steady_clock::now() + patience;
  const auto settled = [&] {
    const auto holder = all.names.find(name);
    return holder == all.names.end() || !holder->second.returns;
  };
  if (!all.returned.wait_until(guard, until, settled) || all.names.contains(name)) return nullptr;
  const auto lease = std::make_shared<Lease>(name);
  all.names[name] = {lease.get()};
  return lease;
}

void announce_return(const std::shared_ptr<void>& lease) {
  const std::lock_guard guard(taken().lock);
  for (auto& [name, holder] : taken().names) holder.returns = holder.returns || holder.lease == lease.get();
}

}  // namespace cerberus::drivers
