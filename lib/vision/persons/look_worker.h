// SPDX-License-Identifier: LGPL-2.1-or-later
// A detector on a thread of its own, one look at a time.
#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "vision/persons/person_picture.h"
#include "vision/persons/whole_frame_detector.h"

namespace cerberus::vision {

class LookWorker {
 public:
  LookWorker() = default;
  ~LookWorker() { stop(); }
  LookWorker(const LookWorker&) = delete;
  LookWorker& operator=(const LookWorker&) = delete;

  // Throws std::system_error where no thread can be made.
  void start(std::unique_ptr<WholeFrameDetector> detector);
  // Returns when a look in progress has ended; its result is dropped.
  void stop();
  // While it runs.
  bool sees_colours() const { return detector_->sees_colours(); }

  // The memory of the next look's picture: filled by the caller with the whole frame while no look is in progress.
  PictureCopy& picture() { return picture_; }
  // Begins a look at it. Call it only when none is in progress.
  void begin();
  // Whether the result of the last look is there.
  bool is_done() const;
  // Waits for the look in progress, and returns a box for each person, in pixels of the frame; they live until the next
  // begin(). Throws what the detector has thrown.
  std::vector<PersonDetection>& wait();
  // After wait(): how long the detector took.
  std::chrono::nanoseconds duration() const { return duration_; }
  // After wait(): why the detector cannot be used; nullopt: it can.
  const std::optional<std::string>& refusal() const { return refusal_; }

 private:
  enum class Stage { idle, asked, done, ended };
  void run();

  std::unique_ptr<WholeFrameDetector> detector_;
  PictureCopy picture_;
  std::vector<PersonDetection> bodies_;
  std::chrono::nanoseconds duration_{};
  std::optional<std::string> refusal_;
  std::exception_ptr failure_;
  mutable std::mutex lock_;  // of stage_
  std::condition_variable changed_;
  Stage stage_ = Stage::idle;
  std::thread thread_;
};

}  // namespace cerberus::vision
