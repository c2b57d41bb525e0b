// SPDX-License-Identifier: LGPL-2.1-or-later
// The base of every analysing element: frames pass unchanged, in place and without a copy; one at a time is passed to
// the element's Analyser with its context.
//
// The base decides what is not thinking: caps (progressive, 32 x 32 to 8192 x 8192: the pad templates), when history
// ends (see vision::FrameHistory and below), the camera's motion as found on the buffer, buffers that hold no picture,
// the property analysis-width, and that no exception leaves.
//
// A frame is `fresh` (every stage forgets the past) after start, a caps change, a flush, a new
// segment, DISCONT, a gap in time, a step back as wide as one, several buffers in a row without a
// usable picture, a cut seen by `cameramotion`, and when it is not known how the camera moved since
// the last frame seen here. Frames dropped between the stages, or in front of all, end nothing: see
// camera_path.hpp. Nor do small steps back, which are a matter of the timestamps only. A buffer with the flag GAP, as
// `videorate` marks duplicates, repeats the last picture: no stage looks at it, and the last result stands. A frame
// that the first stage recognises as such a duplicate gets the flag.
#pragma once

#include <gst/base/gstbasetransform.h>

#include <atomic>
#include <optional>

#include "cerberus/private/element.hpp"
#include "frame.hpp"

namespace cerberus::plugin {

// The last answer to elements upstream; if the answer changes, cerberus_analysis_answer_anew() is called.
template <typename T>
class Answer {
 public:
  T give(T answer) {
    given_ = answer;
    return answer;
  }
  bool outdated_by(T answer) const { return given_.load().value_or(answer) != answer; }

 private:
  std::atomic<std::optional<T>> given_{std::nullopt};
};

// An element's private struct implements this; all calls come from the streaming thread or a state change, never two
// at once, and no lock is held.
class Analyser {
 public:
  enum class Outcome {
    analysed,
    repeats,  // it repeats the last picture although the flag GAP is not on it
    unusable  // the buffer does not hold the picture of its caps
  };
  virtual ~Analyser() = default;
  // What start() would refuse of the settings; any thread.
  virtual std::string settings_fault() const { return {}; }
  // READY to PAUSED: begins in the initial state; returns false after posting an error. stop(): releases memory.
  virtual bool start() { return true; }
  virtual void stop() {}
  // Analyses one frame and attaches the results. If nothing was analysed, the frame is as it was.
  virtual Outcome analyse(Frame& frame) = 0;
  // Attaches the last result to a frame that repeats the last picture, which came `frame.seconds` ago.
  virtual void repeat(Frame&) {}
  // PAUSED to PLAYING, and back.
  virtual void play(bool) {}
  // A flush begins (from any thread), or has ended.
  virtual void flush(bool) {}
  // No further frame of the stream comes.
  virtual void end_of_stream() {}
  // Processes an event on its way upstream, which is passed on in any case. From any thread.
  virtual void upstream_event(GstEvent*) {}
  // Answers the query of record.hpp, from any thread: adds this element's flags; true: it is not passed downstream.
  virtual bool answer(GstQuery*) { return false; }
  // Returns true for an element that takes the looks of a person detector upstream, which asks, and will send them. Any thread.
  virtual bool take_looks() { return false; }
  // The frames are of other caps from now on.
  virtual void new_caps() {}
  // Returns true for the one element that measures the camera itself.
  virtual bool measures_camera() const { return false; }
};

struct AnalysisPrivate;
struct CerberusAnalysis : detail::Instance<GstBaseTransform, AnalysisPrivate> {};
struct CerberusAnalysisClass {
  GstBaseTransformClass parent_class;
};

// The parent type; its pad templates, caps and the property analysis-width are inherited.
GType cerberus_analysis_get_type();
// In type_init: `analyser` lives as long as the element.
void cerberus_analysis_init_with(CerberusAnalysis* self, Analyser* analyser);
// Makes elements upstream query again.
void cerberus_analysis_answer_anew(CerberusAnalysis* self);
// The property analysis-width.
int cerberus_analysis_width(const CerberusAnalysis* self);

}  // namespace cerberus::plugin
