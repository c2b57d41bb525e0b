// SPDX-License-Identifier: LGPL-2.1-or-later
// Decides which encoded units go into which file: pre-roll from a ring of whole GOPs, the event, its post-roll, joined
// events, and files that are split at keyframes where an event is longer than a file may be.
//
// Every unit from an event's first keyframe to its end goes into exactly one file. Where the pre-roll of a new event
// would reach into the one before, both are one event.
//
// All times are running times. The decisions are made at the time that both video and analysis have reached, so that a
// late analysis changes nothing but the size of the ring. Not thread-safe.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "record/event_cycle.h"
#include "record/gop_ring.h"

namespace cerberus::record {

struct FileStart {
  std::uint32_t file = 0;    // identity, from 1
  std::uint32_t event = 0;   // number of the event, from 1
  std::uint32_t part = 0;    // number of the file within the event, from 1
  Time origin{};             // earliest time in the file: time 0 of the file
  Time begin{};              // presentation of the first frame
  Time trigger{};            // the event's first trigger
  std::string reason;        // what it was
  std::vector<int> formats;  // one a track, video first; -1: not in this file
  std::size_t ring = 0;      // bytes in the ring, of which it takes a part at once
};

struct FileEnd {
  std::uint32_t file = 0;
  Time end{};         // presentation of the last frame
  bool last = false;  // of the event
};

// Writes the files. Track 0 is the video, the others are audio.
class FileWriter {
 public:
  virtual ~FileWriter() = default;
  virtual void open(const FileStart& start) = 0;
  virtual void write(std::uint32_t file, int track, const Unit& unit) = 0;
  virtual void close(const FileEnd& end) = 0;
};

struct Parameters {
  // How far the analysis may lag behind the video before the video decides alone, which bounds the ring. Derived: four
  // times the longest lookahead of x264enc at 25 frames a second (60 frames). Guarded by the test of a lost analysis.
  Time most_lag = std::chrono::seconds(10);
  // How long after a split audio of before is still awaited. Chosen: above the longest packet of AAC and Opus, 120 ms,
  // and a jitter buffer's 200 ms. Guarded by the test of late audio.
  Time audio_lateness = std::chrono::seconds(1);
  // How long after its time a trigger may arrive that is not the analysis's. Chosen: above the delay of a bus message
  // and of a sensor's debouncing. Guarded by the test of the end of the stream.
  Time trigger_delay = std::chrono::seconds(1);
  // Where the analysis's times fall back by more, its stream has begun anew. Chosen: above every reordering of frames
  // (16 frames of H.264 at 25 a second), below any seek. Guarded by the tests of times that fall back.
  Time most_reordering = std::chrono::seconds(1);
  // Pause after a file that failed. Chosen: a full disk is reported twelve times a minute at most.
  Time retry = std::chrono::seconds(5);
};

class EventRecorder {
 public:
  struct Settings {
    Time pre_roll = std::chrono::seconds(5);
    EventCycle::Settings cycle;
    Time longest_file{};                 // zero: no limit
    std::size_t most_bytes = 256 << 20;  // of encoded data in the ring
  };

  explicit EventRecorder(FileWriter& files, const Parameters& parameters = {})
      : files_(files), parameters_(parameters) {}

  void configure(const Settings& settings);

  void push_video(Unit unit);
  // `track` counts from 1. A track is in every file that begins after its format is known.
  void set_audio_format(int track, int format);
  void push_audio(int track, Unit unit);
  // An analysis will come; it has reported everything up to `time`; no more of it comes.
  void expect_analysis();
  // Times that fall back by more than Parameters::most_reordering begin anew, too.
  void analysed(Time time);
  void end_analysis();
  // Something happened at `time`, which counts once the video is there: an event begins, or the present one goes on.
  void trigger(Time time, std::string_view reason);
  // At once, and the event lasts until stop() of the same holder.
  void start(Time time, std::string_view reason, Holder holder = Holder::application);
  void stop(Time time, Holder holder = Holder::application);
  // A file could not be written; it is not closed any more. The event goes on in another file after a pause, which
  // begins with the same units if nothing of this one was written (`empty`).
  void file_failed(std::uint32_t file, bool empty);

  // No more units come: open files are closed.
  void finish();
  // Closes the open files and forgets the units and every time: the next ones are of another stream or time. An event
  // of start() goes on there in another file, from the first keyframe on; any other event ends.
  void reset();

  bool recording() const { return file_ != 0; }
  bool active() const { return cycle_.active(); }
  Time newest() const { return newest_; }  // decode time of the newest video unit
  // The time up to which the analysis of the video is there, or is awaited no more.
  Time reached() const { return analysed_ ? std::max(*analysed_, newest_ - parameters_.most_lag) : newest_; }
  // Presentation of the ring's oldest unit: no file to come begins before it.
  Time oldest() const { return video_.empty() ? Time::min() : video_[video_.begin()].presentation; }
  Time lag() const;  // of the analysis behind the video; below zero: ahead
  std::size_t bytes() const;

 private:
  struct AudioTrack {
    NumberedQueue<Unit> units;
    Number next = 0;  // the first one that no file has
    std::size_t bytes = 0;
    int format = -1;
    void pop();
  };
  AudioTrack& audio_track(int track);

  // Triggers that lie less than the post-roll apart.
  struct Triggers {
    Time first{}, last{};
    std::string reason;
  };

  void triggered(bool begins, std::string_view reason);
  void apply_triggers(Time until);
  Time decided() const;
  void advance(bool ending);
  void try_begin(bool ending);
  void begin_file(Number keyframe);
  void write_until(Time end);
  void write_audio(Time end);
  bool must_split(const Unit& unit) const;
  void split();
  bool is_over() const;
  void end_event();
  void close_file(bool last);
  void close_previous();
  void evict();

  FileWriter& files_;
  Parameters parameters_;
  Settings settings_;
  EventCycle cycle_;
  std::string reason_;
  NumberedQueue<Triggers> ahead_;  // of the video; in the order of time
  GopRing video_;
  std::vector<AudioTrack> audio_;

  Time newest_{};
  std::optional<Time> analysed_;  // nullopt: there is no analysis
  Number next_ = 0;               // the first video unit that no file has
  std::uint32_t event_ = 0, part_ = 0, last_file_ = 0;

  // The open file, 0 for none; and the one before it, while audio of its time may still come.
  std::uint32_t file_ = 0, previous_ = 0;
  FileStart start_;
  Number first_ = 0;      // its first video unit
  Time last_keyframe_{};  // decode time of its newest keyframe
  Time last_shown_{};     // presentation of its last frame
  Time previous_shown_{};
  std::optional<Time> retry_at_;
  bool begins_anew_ = false;  // the next unit is the first one of another time
};

}  // namespace cerberus::record
