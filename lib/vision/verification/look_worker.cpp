// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/verification/look_worker.h"

#include <span>

namespace cerberus::vision {

void LookWorker::start(std::unique_ptr<PersonDetector> detector) {
  stop();
  detector_ = std::move(detector);
  stage_ = Stage::idle;
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

void LookWorker::begin(const LookRegions& regions) {
  {
    const std::lock_guard guard(lock_);
    regions_ = regions;
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
  return hits_;
}

void LookWorker::run() {
  std::unique_lock guard(lock_);
  for (;;) {
    changed_.wait(guard, [&] { return stage_ == Stage::asked || stage_ == Stage::ended; });
    if (stage_ == Stage::ended) return;
    guard.unlock();
    hits_.clear();
    refusal_.reset();
    std::exception_ptr failure;
    try {
      for (std::size_t i = 0; i < regions_.count && !refusal_; ++i) {
        const LookRegion& region = regions_.all[i];
        const std::size_t earlier = hits_.size();
        refusal_ = detector_->detect(pictures_[i].view(), region.scale, hits_);
        for (PersonDetection& hit : std::span(hits_).subspan(earlier))
          hit.box.x += region.x, hit.box.y += region.y;
      }
    } catch (...) {
      failure = std::current_exception();
    }
    guard.lock();
    failure_ = failure;
    if (stage_ == Stage::ended) return;
    stage_ = Stage::done;
    changed_.notify_all();
  }
}

}  // namespace cerberus::vision
