// SPDX-License-Identifier: LGPL-2.1-or-later
// Writes one file: a private pipeline of one appsrc a track, a muxer and a filesink. It is a pipeline of its own because
// a file begins and ends by itself, whatever state the recorder's pipeline is in. Its methods are called in one thread.
#pragma once

#include <gst/gst.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "record/event_recorder.h"

namespace cerberus::plugin {

// What a file is to be. Tracks: video first.
struct FileSpec {
  record::FileStart start;
  std::vector<std::shared_ptr<GstCaps>> caps;  // one a track; nullptr: not in this file
  std::string name;                            // below the folder of the recordings, without the ending
  bool mp4 = true;                             // else Matroska
  std::string camera;
  GstClockTime utc = GST_CLOCK_TIME_NONE;  // of the first frame, where it is known
  GstClockTime when = 0;                   // the same; else the system's clock when the file began
};

// What went wrong, in words for a user and for a developer.
struct FileFault {
  std::string text, detail;
  bool of_disk = false;  // else of what was to be written
};

class FilePipeline {
 public:
  // `ended(fault)` is called once, in a thread of the pipeline: the file is complete (no fault), or cannot be written.
  using Ended = std::function<void(std::shared_ptr<const FileFault>)>;

  FilePipeline(const FileSpec& spec, const std::string& path, Ended ended);
  ~FilePipeline();
  FilePipeline(const FilePipeline&) = delete;
  FilePipeline& operator=(const FilePipeline&) = delete;

  // Takes `buffer`, a writable one with times of the file. Never blocks.
  void push(int track, GstBuffer* buffer);
  // No more comes on a track, or on any: the file is completed.
  void end_track(int track);
  void finish();
  // Bytes that wait to be muxed.
  std::uint64_t level() const;
  // Bytes of the video that wait, and that were taken; audio may wait for the next frame.
  std::uint64_t video_level() const;
  std::uint64_t video_taken() const { return video_pushed_ - video_level(); }

 private:
  struct Track {
    GstElement* source = nullptr;  // of the pipeline; nullptr: not in this file
    GstClockTime last = 0;
    bool ended = false;
  };
  void build(const FileSpec& spec, const std::string& path);
  void report(GstMessage* message);

  GstElement* pipeline_;
  Ended ended_;
  std::vector<Track> tracks_;
  std::uint64_t video_pushed_ = 0;
};

}  // namespace cerberus::plugin
