// SPDX-License-Identifier: LGPL-2.1-or-later
// Runs a pipeline to the end of its file: progress meanwhile, Ctrl-C, and in plain words what went wrong.
#pragma once

#include <gst/gst.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <string>

#include "video_file.h"

namespace cerberus::demo {

class Job {
 public:
  // `pipeline` has the elements `fusion` (whose frames count), `json` and `mp4`, which stay the caller's. path: of the file;
  // empty where there is none.
  Job(GstElement* pipeline, std::string path, std::string folder, const VideoFile& video);
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  bool run();  // false: error() says why
  const std::string& error() const { return error_; }

  guint64 frames() const { return frames_; }
  double seconds() const;
  std::size_t objects() const;
  // Seconds of video that came, where the file says that it lasts notably longer and no one asked to stop; else 0.
  double ends_early_at() const;

 private:
  static GstPadProbeReturn on_frame(GstPad*, GstPadProbeInfo* info, gpointer job);
  static gboolean on_message(GstBus*, GstMessage* message, gpointer job);
  static gboolean on_interrupt(gpointer job);
  static gboolean on_progress(gpointer job);
  static gboolean on_watch(gpointer job);
  std::string explain(GstMessage* message) const;
  void end(std::string error);

  GstElement* pipeline_;
  std::string name() const { return path_.empty() ? "the patrol" : path_; }

  std::string path_, folder_, error_;
  VideoFile video_;
  GMainLoop* loop_ = nullptr;  // while it runs
  std::chrono::steady_clock::time_point started_;
  bool terminal_ = false, interrupted_ = false;
  guint64 watched_frames_ = 0;  // at the watchdog's last look
  int idle_ = 0;                // its looks since then without a new frame
  std::atomic<guint64> frames_ = 0;
  std::atomic<GstClockTime> position_ = 0;
  mutable std::mutex mutex_;
  std::set<gint> objects_;  // distinct identities so far
};

}  // namespace cerberus::demo
