// SPDX-License-Identifier: LGPL-2.1-or-later
// Assigns what was found in each frame to the file that has the frame. Analysis and video come at different times, and
// neither a file's beginning nor its end is known when a frame is analysed: notes wait here until they are, and a file is
// complete once the analysis has passed its end.
//
// All times are running times. Not thread-safe.
#pragma once

#include <deque>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "record/event_recorder.h"

namespace cerberus::record {

// A picture, owned by a type that this library does not know. nullptr: none.
using Picture = std::shared_ptr<void>;

// What was found in one frame.
struct Note {
  Time time{};
  std::string line;                     // JSON, one object and a line feed; empty: none
  std::vector<std::uint32_t> tracks;    // identities
  std::vector<std::string_view> kinds;  // of the objects; texts that live as long as the program
  std::uint32_t people = 0;             // a group counts as two
  std::string rule;                     // of the fusion; empty: none that acts
  Picture picture;
  double score = 0;  // of the picture, see best_moment.h
};

// What was found in the frames of one file.
struct Findings {
  std::set<std::uint32_t> tracks;
  std::set<std::string_view> kinds;
  std::uint32_t people = 0;  // the most in one frame
  std::string rule;          // the first one that acted
  Picture picture;           // of the highest score
  double score = 0;
  Time shown{};  // running time of the picture
};

class JournalOutput {
 public:
  virtual ~JournalOutput() = default;
  // The next line of a file's JSON. `time` is the frame's, from the file's first frame on.
  virtual void write_line(std::uint32_t file, Time time, std::string_view line) = 0;
  // No more lines come: the file can be closed.
  virtual void complete(const FileEnd& end, Findings findings) = 0;
};

class FrameJournal {
 public:
  struct Parameters {
    // A picture replaces another one of the same file if its score is so many times higher. Chosen: bounds the copies
    // of frames to some tens an event. Guarded by the test of an object that approaches.
    double least_gain = 1.1;
    // Of pictures whose file is not known yet, one is kept for each such time, and so many in all. Chosen: a person who
    // crosses the picture is seen best for about a second; 12 reach beyond EventRecorder's most_lag. Guarded by the
    // test of the pictures that wait.
    Time picture_spacing = std::chrono::seconds(1);
    std::size_t most_pictures = 12;
    // Bytes of lines that wait. Derived: a minute at 25 lines of 5 kB a second. Guarded by the test of an analysis
    // without video.
    std::size_t most_bytes = 8 << 20;
  };

  explicit FrameJournal(JournalOutput& output) : output_(output) {}
  FrameJournal(JournalOutput& output, const Parameters& parameters)
      : output_(output), parameters_(parameters) {}

  // Whether a picture of the frame at `time` would be kept: ask before copying one.
  bool wants_picture(Time time, double score) const;
  void add(Note note);

  // What EventRecorder decides about files. written(): the file has all frames that are shown up to `time`.
  void open(const FileStart& start);
  void written(std::uint32_t file, Time time);
  void close(const FileEnd& end);
  // The file could not be written and is not completed; its notes are those of the file that begins again.
  void drop(std::uint32_t file);

  // The notes up to `reached` are there. No file to come begins before `kept`.
  void advance(Time reached, Time kept);
  // The next notes are of another stream or time: all closed files are completed, all notes forgotten.
  void reset();

  std::size_t notes() const { return notes_.size(); }
  std::size_t pictures() const;

 private:
  struct Entry {
    Note note;
    std::uint32_t file = 0;  // that has its line; 0: not assigned yet
  };
  struct Span {
    std::uint32_t file = 0;
    std::uint32_t event = 0;
    Time begin{}, written{};
    Time until = Time::max();  // first time of the event's next file
    bool closed = false;
    FileEnd end;
    Findings findings;
    bool has(Time time) const { return time >= begin && time < until && (!closed || time <= limit()); }
    Time limit() const { return until != Time::max() ? until : end.end; }
  };
  const Span* span_at(Time time) const;
  void assign(Entry& entry, Span& span);
  void assign_notes(Time reached);
  void complete_spans(Time reached);
  void drop_pictures();

  JournalOutput& output_;
  Parameters parameters_;
  std::deque<Entry> notes_;  // by time
  std::deque<Span> spans_;   // by begin
  std::size_t bytes_ = 0;
};

}  // namespace cerberus::record
