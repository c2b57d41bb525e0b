// SPDX-License-Identifier: LGPL-2.1-or-later
// One run of eventrecorder: turns buffers and events of its pads into the units, notes and triggers of lib/record. Every
// method may be called in any thread.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "frame_notes.hpp"
#include "record/time_filler.h"
#include "recorder_settings.hpp"

namespace cerberus::plugin {

inline constexpr int kAnalysisTrack = -1;

// A sink pad of the element, and where its stream is.
struct Input {
  GstPad* pad = nullptr;
  int track = kAnalysisTrack;  // 0: video; from 1: audio
  GstSegment segment;
  int format = -1;                     // of the encoded stream
  std::optional<record::Time> decode;  // of the newest unit
  bool eos = false;
  record::TimeFiller filler;
  bool untimed_reported = false;
  FrameNotes notes;  // of video and analysis
  Stamps stamps;     // of the analysis
};

class Session {
 public:
  explicit Session(Adjustable<RecorderSettings>& settings) : settings_(settings) {}

  // Pads come and go in every state.
  Input& add_input(GstPad* pad, int track);
  void remove_input(GstPad* pad);
  // The number of the next audio track, from 1.
  int next_audio_track();

  // Files can be written from begin() to end(). begin() returns what is wrong with the folder; an empty string: nothing.
  std::string begin(Writer::Report report, Writer::Warn warn);
  void end();

  // A pad's stream. False: the stream has no times, or the caps lack the picture's size. A buffer without a time takes the
  // place after the one before.
  bool set_caps(Input& input, GstCaps* caps);
  void set_segment(Input& input, GstEvent* event);
  void begin_stream(Input& input);
  void flush(Input& input);
  void gap(Input& input, GstEvent* event);
  bool add(Input& input, GstBuffer* buffer);
  // Waits for the disk where the stream is not live.
  void wait_for_disk(GstPad* pad);
  // Whether buffers came, and none of them had a time.
  bool lacks_times(const Input& input);
  // Returns whether all linked pads are at their end: then all files are closed.
  bool end_of_stream(Input& input);
  // Calls done() once the files that are closed are complete.
  void when_done(std::function<void()> done) { writer_.when_done(std::move(done)); }

  // Triggers.
  void start_event(const char* reason);
  void stop_event();
  void handle(GstMessage* message);
  void handle(GstEvent* event);

  void keep(const char* path, bool keep) { writer_.keep(path, keep); }
  void file_failed(std::uint32_t file, bool empty);

 private:
  std::string apply_settings();
  GstBuffer* timed(Input& input, GstBuffer* buffer, bool& hopeless);
  void apply(const Trigger& trigger, record::Time time);
  void add_note(Input& input, GstBuffer* buffer, const CerberusStamp& stamp, record::Time time);
  void advance_journal();
  bool add_video(Input& input, GstBuffer* buffer);
  bool add_audio(Input& input, GstBuffer* buffer);
  bool add_analysis(Input& input, GstBuffer* buffer);
  bool has_analysis() const;
  std::optional<Trigger> trigger_at(GstBuffer* buffer, record::Time time);
  std::string unplaced_fault();
  void restart();

  Adjustable<RecorderSettings>& settings_;
  Writer::Warn warn_;
  std::optional<bool> live_;  // of the video's streaming thread
  std::mutex lock_;           // of all that follows, but the writer
  Writer writer_;
  Files files_{writer_};
  record::EventRecorder recorder_{files_};
  std::vector<std::unique_ptr<Input>> inputs_;  // video first
  int tracks_ = 1;
  TriggerSettings triggers_;
  FrameNotes::Wanted wanted_;
  std::string camera_name_, zones_;
  double field_of_view_ = 0;
  bool unplaced_reported_ = false;
};

}  // namespace cerberus::plugin
