// SPDX-License-Identifier: LGPL-2.1-or-later
// What pirfusion's pads share: what was heard of sensors, head and base, by running time, and who waits for whom. PIR
// threads and upstream events write; the video's thread reads,
// and, between two frames of a live one, the PIR threads do.
#pragma once

#include <cerberus/cerberus.h>

#include <array>
#include <condition_variable>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "fusion/sensor_history.h"
#include "fusion/sensor_snapshot.h"
#include "sensing/sectors.h"
#include "sensing/timeline.h"
#include "shared/told_base.hpp"

namespace cerberus::plugin {

using fusion::kInvalid;
using fusion::Reading;
using fusion::SensorArray;
using fusion::SensorHistory;
using fusion::SensorSnapshot;
using sensing::Timeline;

struct PirPad;

// A PIR pad that has been silent for too long.
struct SilentPad {
  std::string name;
  bool ended;
};

// Whether this is the head of that name; an empty name is any.
bool is_named(const CerberusPose& pose, const std::string& head);

// The lock is never held while something is pushed, queried or
// posted, and no GStreamer object's lock is taken under it.
class Inputs {
 public:
  // ---- video thread
  // A frame of `time` is here; with `max_wait` it waits until every linked PIR pad covers `time` or has been silent for
  // so long (those are added to `silent`, and given up until they speak). False: the video was flushed meanwhile.
  bool frame_came(Time time, std::optional<guint64> max_wait, std::vector<SilentPad>& silent);
  // Where nobody waits: gives up the linked PIR pads that have said nothing in the last `patience` before `heard`, but
  // for recordings, whose last word stays true.
  void give_up_silent(Time heard, Time patience, std::vector<SilentPad>& silent);

  // ---- whoever decides: the video thread, or a PIR thread between two frames (see decisions.hpp)
  // Pan of the head of this name (empty: any) and base at `time`, sensors at `heard`. What `frame` carries goes before
  // a pose event (by_event: they count), but after a base's: an application knows its robot. Forgets what no later frame
  // can ask for.
  SensorSnapshot at(Time time, Time heard, const std::string& head, bool by_event, GstBuffer* frame);
  // Brings the moment of the frame of `frame_time` up to `heard`: the sensors' readings; the pan by the newest pose
  // that was heard, unless the frame carried one that is not older; the base's rate, where an event has told it.
  void listen(Time heard, Time frame_time, const std::string& head, SensorSnapshot& moment);
  bool flushing();

  // ---- the video's events
  void begin_video();  // a new stream, or after a flush
  void end_video() { set(video_ended_, true); }
  void set_flushing(bool flushing) { set(flushing_, flushing); }  // also while the sink pad is not active

  // ---- upstream events
  void hear(const CerberusPose& pose);
  void hear_stranger(const CerberusPose& pose);  // of another head than the one that counts
  void hear_base(double degrees_a_second, Time from);

  // ---- PIR pads (those of pir_pad.hpp), counted in the order of their numbers. Rules know
  // sensors by their places, so a pad that has no caps yet keeps the place of one sensor, and
  // so does a number that no pad has, below one that a pad has. A new one with the number in
  // `name`, or the next free one; nullptr when it is taken, or 16 or more. Floating.
  GstPad* add_pad(const char* name, GstPadTemplate* pad_template);
  void drop_pad(GstPad* pad);
  std::vector<GstPad*> pads();  // with a reference each
  void forget();                // everything but the pads

  // ---- for the PIR pads, whose state the lock guards too
  std::function<void()> on_reading;  // of a live source, after it was told; set before there are pads
  std::mutex& lock() { return lock_; }
  void tell(PirPad& pad, Time until);           // it was heard of, up to this time; the lock is held
  void end(PirPad& pad);                        // it will say no more; the lock is held
  int places_besides(const PirPad& pad) const;  // as they are counted; the lock is held
  void set(bool& flag, bool value);             // and wake whoever waits
  // Waits while a PIR source is so far ahead of the video that it can do so later; false: the video has ended.
  bool wait_for_video(std::unique_lock<std::mutex>& guard, const PirPad& pad, Time time);

 private:
  void hear_sensors(Time heard, SensorSnapshot& moment);

  std::mutex lock_;
  std::condition_variable news_;  // of anything below, and of the pads
  std::vector<GstPad*> pads_;     // by number; the element owns them
  Timeline<CerberusPose> poses_;
  ToldBase base_;
  const char* stranger_ = nullptr;
  Time video_{};  // newest frame that came
  bool flushing_ = true;
  bool video_ended_ = false;
};

}  // namespace cerberus::plugin
