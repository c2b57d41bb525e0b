// SPDX-License-Identifier: LGPL-2.1-or-later
#include "background_work.h"

#include <utility>

namespace cerberus::robot {

struct BackgroundWork::Job {
  std::function<void()> work, done;
  std::shared_ptr<bool> alive;
  guint* waiting;
};

BackgroundWork::BackgroundWork()
    : pool_(g_thread_pool_new(
          [](gpointer data, gpointer) {
            auto* job = static_cast<Job*>(data);
            job->work();
            g_main_context_invoke_full(
                nullptr, G_PRIORITY_DEFAULT,
                [](gpointer data) {
                  const Job& job = *static_cast<Job*>(data);
                  if (*job.alive) {
                    --*job.waiting;
                    job.done();
                  }
                  return static_cast<gboolean>(G_SOURCE_REMOVE);
                },
                job, [](gpointer data) { delete static_cast<Job*>(data); });
          },
          nullptr, 1, FALSE, nullptr)) {}

BackgroundWork::~BackgroundWork() {
  *alive_ = false;
  g_thread_pool_free(pool_, FALSE, TRUE);
}

bool BackgroundWork::add(std::function<void()> work, std::function<void()> done) {
  if (waiting_ >= kMost) return false;
  ++waiting_;
  g_thread_pool_push(pool_, new Job{std::move(work), std::move(done), alive_, &waiting_}, nullptr);
  return true;
}

}  // namespace cerberus::robot
