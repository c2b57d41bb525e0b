// SPDX-License-Identifier: LGPL-2.1-or-later
// The groups of PIR sensors beside one video stream, and which thread waits for which: frames of a stream that is not
// live wait until every group covers their time, and a recorded group waits for the video. Thread-safe.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "fusion/sensor_snapshot.h"

namespace cerberus::fusion {

// One group. Guarded by the lock of its SensorInputs.
struct SensorSource {
  std::string name;  // for messages
  SensorHistory history;
  unsigned index = 0;  // its place among the groups
  int sensors = 0;     // 0: their number is not known yet
  bool linked = false;
  bool flushing = true;        // also while it is not active
  bool given_up = false;       // silent for too long: invalid, and not waited for, until the next reading
  std::optional<Time> spoken;  // time of the last reading; nothing: none since the video began
  std::optional<bool> live;    // nothing: not known. Changed by the group's own thread alone

  void forget();  // all but the name, the place, the link and the flush
};

// A group that has been silent for too long.
struct SilentSource {
  std::string name;
  bool ended;
};

class SensorInputs {
 public:
  // ---- video thread
  // A frame of `time` has come. It waits until every linked group covers `time`, for `max_wait` of real time at most
  // (Time::max(): without end, zero: not at all); groups that are still missing then are given up and added to
  // `silent`. False: the video was flushed meanwhile.
  bool frame_came(Time time, Time max_wait, std::vector<SilentSource>& silent);
  // For a video that does not wait: gives up the linked groups without a reading in the last `patience` before
  // `sensor_time`, but for recordings, whose last reading stays true.
  void give_up_silent(Time sensor_time, Time patience, std::vector<SilentSource>& silent);
  void begin_video();  // a new stream, or after a flush
  void end_video() { set(video_ended_, true); }
  void set_flushing(bool flushing) { set(flushing_, flushing); }
  bool flushing();
  // A seek goes upstream, to the groups first: until it has ended a group may have the readings of its new time while
  // frames of the old one still come, and no reading is forgotten. Each begin has its end; seeks may overlap.
  void begin_seek();
  void end_seek();

  // ---- the groups' threads
  std::mutex& lock() { return lock_; }
  void set(bool& flag, bool value);  // and wakes the threads that wait
  // With the lock held:
  void add_reading(SensorSource& source, Time until);  // the group is complete up to this time
  void end(SensorSource& source);                      // nothing more comes from it
  // Waits while a recorded group is so far ahead of the video that its reading can be stored later; false: the video
  // has ended.
  bool wait_for_video(std::unique_lock<std::mutex>& guard, const SensorSource& source, Time time);

  // ---- the groups by their places, with the lock held
  // Rules know sensors by their places: a group whose number of sensors is not known keeps the place of one sensor, and
  // so does a place without a group below one that has a group.
  // The place that is asked for, or the first free one; nothing: it is taken, or kMaxSensors or more.
  std::optional<unsigned> free_place(std::optional<std::uint64_t> wanted) const;
  void add(SensorSource& source);
  void drop(SensorSource& source);
  int places_besides(const SensorSource& source) const;

 protected:
  // Puts the readings at `sensor_time` in place of the snapshot's sensors, and forgets what no later frame can ask
  // for, unless a seek is in progress. With the lock held.
  void read(Time sensor_time, SensorSnapshot& snapshot);
  void forget();  // all but the groups' places; with the lock held

  std::mutex lock_;
  std::vector<SensorSource*> sources_;  // by place

 private:
  std::condition_variable news_;  // of anything here, and of the groups
  Time video_{};                  // the newest frame
  bool flushing_ = true;
  bool video_ended_ = false;
  int seeks_ = 0;  // in progress
};

}  // namespace cerberus::fusion
