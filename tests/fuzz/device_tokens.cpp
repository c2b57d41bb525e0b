// SPDX-License-Identifier: LGPL-2.1-or-later
// The file of the page's devices. What is accepted are devices that the page may let in, and reads the same when it is
// written again; of what is refused nothing stays.
#include <cstdint>
#include <cstdlib>

#include "robot/page/devices.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cerberus::robot;
  Devices devices, again;
  if (!devices.restore({reinterpret_cast<const char*>(data), size})) {
    if (!devices.all().empty()) std::abort();
    return 0;
  }
  if (devices.all().size() > Devices::kMost) std::abort();
  if (!again.restore(devices.state()) || again.state() != devices.state()) std::abort();
  for (const Device& device : devices.all()) {
    const Device* found = again.named(device.name);
    if (found == nullptr || found->role != device.role || found->hash != device.hash) std::abort();
    if (device.role == Role::owner || device.role == Role::none || device.hash.size() != 64) std::abort();
  }
  return 0;
}
