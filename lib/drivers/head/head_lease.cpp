// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/head/head_lease.h"

#include <mutex>
#include <set>

namespace cerberus::drivers {

namespace {

// The names in use, the only state that the elements of a process share. Never destroyed: a driver that blocks may
// return its lease while the process ends.
struct Taken {
  std::mutex lock;
  std::set<std::string> names;
};
Taken& taken() {
  static Taken& instance = *new Taken;
  return instance;
}

struct Lease {
  std::string name;
  explicit Lease(const std::string& n) : name(n) {}
  ~Lease() {
    const std::lock_guard guard(taken().lock);
    taken().names.erase(name);
  }
};

}  // namespace

std::shared_ptr<void> lease_head(const std::string& name) {
  {
    const std::lock_guard guard(taken().lock);
    if (!taken().names.insert(name).second) return nullptr;
  }
  return std::make_shared<Lease>(name);
}

}  // namespace cerberus::drivers
