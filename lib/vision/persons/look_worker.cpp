// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/persons/look_worker.h"

#include <utility>

namespace cerberus::vision {

void LookWorker::start(std::unique_ptr<WholeFrameDetector> detector) {
  stop();
  detector_ = std::move(detector);
  stage_ = Stage::idle;
  duration_ = {};
  thread_ = std::thread([this] { run(); });
}

void LookWorker::stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard guard(lock_);
    stage_ = Stage::ended;
  }
  changed_.notify_all();
  thread_.join();
  detector_.reset();
}

void LookWorker::begin() {
  {
    const std::lock_guard guard(lock_);
    stage_ = Stage::asked;
  }
  changed_.notify_all();
}

bool LookWorker::is_done() const {
  const std::lock_guard guard(lock_);
  return stage_ == Stage::done;
}

std::vector<PersonDetection>& LookWorker::wait() {
  std::unique_lock guard(lock_);
  changed_.wait(guard, [&] { return stage_ != Stage::asked; });
  stage_ = Stage::idle;
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return bodies_;
}

void LookWorker::run() {
  std::unique_lock guard(lock_);
  for (;;) {
    changed_.wait(guard, [&] { return stage_ == Stage::asked || stage_ == Stage::ended; });
    if (stage_ == Stage::ended) return;
    guard.unlock();
    refusal_.reset();
    std::exception_ptr failure;
    const auto begun = std::chrono::steady_clock::now();
    try {
      refusal_ = detector_->find(picture_.view(), bodies_);
    } catch (...) {
      failure = std::current_exception();
    }
    duration_ = std::chrono::steady_clock::now() - begun;
    guard.lock();
    failure_ = failure;
    if (stage_ == Stage::ended) return;
    stage_ = Stage::done;
    changed_.notify_all();
  }
}

}  // namespace cerberus::vision
