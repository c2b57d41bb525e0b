// SPDX-License-Identifier: LGPL-2.1-or-later
// Work that takes longer than the main loop may wait, as the hash of a password: one thread, in order.
#pragma once

#include <glib.h>

#include <functional>
#include <memory>

namespace cerberus::robot {

class BackgroundWork {
 public:
  // Jobs that wait at most: each of a password costs a tenth of a second and 19 MiB.
  static constexpr guint kMost = 8;

  BackgroundWork();
  // Waits for the jobs that were added, kMost at most; no `done` is called afterwards.
  ~BackgroundWork();
  BackgroundWork(const BackgroundWork&) = delete;
  BackgroundWork& operator=(const BackgroundWork&) = delete;

  // Calls `work` in the thread, then `done` in the main loop's. False: too many wait.
  bool add(std::function<void()> work, std::function<void()> done);

 private:
  struct Job;
  GThreadPool* pool_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  // main loop's thread
  guint waiting_ = 0;
};

}  // namespace cerberus::robot
